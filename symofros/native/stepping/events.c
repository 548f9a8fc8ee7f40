/* Events: zeros of formulas along the dense output. */

/* Values of all events at the evaluation point. Returns 0 or a status. */
static int32_t sym_event_values(sym_run *r, double *values) {
    const sym_system *s = r->system;
    if (sym_evaluate_inputs(r->system) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->events);
    memcpy(values, s->events.out[0], (size_t)s->n_events * sizeof *values);
    return 0;
}

/* The value of one event at the evaluation point; NaN where the inputs fail. */
static double sym_event_value(sym_run *r, int32_t which) {
    if (sym_evaluate_inputs(r->system) != 0) return NAN;
    sym_evaluate(&r->system->events);
    return r->system->events.out[0][which];
}

/* Whether the sign changes in that direction. */
static int32_t sym_crosses_zero(int32_t direction, double before, double after) {
    if (direction >= 0 && before < 0.0 && after >= 0.0) return 1;
    return direction <= 0 && before > 0.0 && after <= 0.0;
}

/* The x in [0, 1] at which an event is zero, by the Illinois method (regula falsi whose retained end is halved).
 * Returns 0 or a status. */
static int32_t sym_locate_event(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, int32_t which,
                                double before, double after, double *x) {
    double a = 0.0, b = 1.0, fa = before, fb = after;
    int32_t i, side = 0;
    for (i = 0; i < 100 && b - a > 4e-16 && fb != 0.0; ++i) {
        double c = (fa * b - fb * a) / (fa - fb), f;
        int32_t status;
        if (!(c > a && c < b)) c = 0.5 * (a + b);
        status = sym_load_state_within_step(r, w, h, dense_ready, c);
        if (status != 0) return status;
        f = sym_event_value(r, which);
        if (!(f == f)) return SYM_DIVERGED;
        if ((f < 0.0) == (fa < 0.0) && f != 0.0) {
            a = c, fa = f;
            if (side == 1) fb *= 0.5;
            side = 1;
        } else {
            b = c, fb = f;
            if (side == -1) fa *= 0.5;
            side = -1;
        }
    }
    *x = b;
    return 0;
}

/* Events of the step just made, at whose end the evaluation point is: recorded in the order of time, up to the first
 * terminal one, whose x is returned in *stop_x. r->event_values becomes the values at the end; the rest of it is work.
 * Returns 0 or a status. */
static int32_t sym_find_events(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double *stop_x) {
    sym_system *s = r->system;
    double *values = r->event_values, *after = values + s->n_events;
    double *met_x = after, *met_index = after + s->n_events; /* met_x overwrites what has been read of after */
    int32_t i, status, n = 0;
    *stop_x = 2.0;
    r->terminal_event = -1;
    status = sym_event_values(r, after);
    if (status != 0) return status;
    for (i = 0; i < s->n_events; ++i) {
        const double before = values[i];
        double x;
        values[i] = after[i];
        if (!sym_crosses_zero(s->event_direction[i], before, values[i])) continue;
        status = sym_locate_event(r, w, h, dense_ready, i, before, values[i], &x);
        if (status != 0) return status;
        if (s->event_terminal[i] && x < *stop_x) *stop_x = x, r->terminal_event = i;
        met_x[n] = x, met_index[n] = (double)i;
        ++n;
    }
    for (;;) { /* record the earliest that is left, until there is none before stop_x */
        int32_t first = -1;
        for (i = 0; i < n; ++i)
            if (met_x[i] <= *stop_x && (first < 0 || met_x[i] < met_x[first])) first = i;
        if (first < 0) return 0;
        status = sym_load_state_within_step(r, w, h, dense_ready, met_x[first]);
        if (status != 0) return status;
        r->event_t[r->n_event_records] = *s->t;
        r->event_index[r->n_event_records] = (int32_t)met_index[first];
        memcpy(r->event_q + r->n_event_records * s->nq, s->q, (size_t)s->nq * sizeof(double));
        memcpy(r->event_v + r->n_event_records * s->nv, s->v, (size_t)s->nv * sizeof(double));
        ++r->n_event_records;
        met_x[first] = 3.0; /* beyond any stop_x: recorded */
    }
}
