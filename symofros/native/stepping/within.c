/* What lies within a step: dense output, events, records asked for at times. */

/* Dense output: y at x in [0, 1] of the step that has just been made. */
static int32_t sym_dense(sym_run *r, sym_memory *m, double h, int32_t *ready, double x, double *y) {
    const sym_tableau *tableau = &r->tableau;
    const int32_t nv = r->scene->nv, n = 2 * nv;
    int32_t i, j, l, status;
    if (r->method == SYM_METHOD_EXPLICIT && tableau->degree > 0) {
        if (!*ready) {
            status = sym_stages(r, m, h, tableau->stages, tableau->dense_stages);
            if (status != 0) return status;
            *ready = 1;
        }
        memset(y, 0, (size_t)n * sizeof *y);
        for (i = 0; i < tableau->dense_stages; ++i) {
            const double *p = tableau->dense + (size_t)i * tableau->degree;
            double s = 0.0;
            for (j = tableau->degree - 1; j >= 0; --j) s = (s + p[j]) * x;
            if (s != 0.0)
                for (l = 0; l < n; ++l) y[l] += h * s * m->k[(size_t)i * m->step + l];
        }
        for (l = 0; l < nv; ++l) y[nv + l] += r->v[l];
        return 0;
    }
    if (!*ready) { /* the cubic through both ends and their slopes */
        status = sym_slope(r, r->t + h, m->y1, m->end);
        if (status != 0) return status;
        *ready = 1;
    }
    for (l = 0; l < n; ++l) {
        const double y0 = l < nv ? 0.0 : r->v[l - nv], d = m->y1[l] - y0;
        const double f0 = h * m->k[l], f1 = h * m->end[l];
        y[l] = y0 + x * (f0 + x * ((3.0 * d - 2.0 * f0 - f1) + x * (f0 + f1 - 2.0 * d)));
    }
    return 0;
}

/* Record the scene's point. */
static int32_t sym_record(sym_run *r) {
    const sym_scene *s = r->scene;
    const int64_t i = r->n_records;
    if (sym_inputs(r->scene) != 0) return SYM_CALLBACK;
    r->record_t[i] = *s->t;
    memcpy(r->record_q + i * s->nq, s->q, (size_t)s->nq * sizeof(double));
    memcpy(r->record_v + i * s->nv, s->v, (size_t)s->nv * sizeof(double));
    memcpy(r->record_u + i * s->nu, s->u, (size_t)s->nu * sizeof(double));
    ++r->n_records;
    return 0;
}

/* All events at the scene's point. */
static int32_t sym_event_values(sym_run *r, double *values) {
    const sym_scene *s = r->scene;
    if (sym_inputs(r->scene) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->events);
    memcpy(values, s->events.out[0], (size_t)s->n_events * sizeof *values);
    return 0;
}

static double sym_event_value(sym_run *r, int32_t which) {
    if (sym_inputs(r->scene) != 0) return NAN;
    sym_evaluate(&r->scene->events);
    return r->scene->events.out[0][which];
}

static int32_t sym_crosses(int32_t direction, double before, double after) {
    if (direction >= 0 && before < 0.0 && after >= 0.0) return 1;
    return direction <= 0 && before > 0.0 && after <= 0.0;
}

/* The x at which an event is zero, by the Illinois method on the dense output. */
static int32_t sym_locate(sym_run *r, sym_memory *m, double h, int32_t *ready, int32_t which, double before,
                          double after, double *x) {
    double a = 0.0, b = 1.0, fa = before, fb = after;
    int32_t i, side = 0;
    for (i = 0; i < 100 && b - a > 4e-16 && fb != 0.0; ++i) {
        double c = (fa * b - fb * a) / (fa - fb), f;
        int32_t status;
        if (!(c > a && c < b)) c = 0.5 * (a + b);
        status = sym_dense(r, m, h, ready, c, m->stage);
        if (status != 0) return status;
        sym_place(r, r->t + c * h, m->stage);
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

/* Events of the step just made, which ends at t1, in the order of time up to the first terminal one, whose x is
 * returned through it. r->event: the values at t1; then, for each event met, its x; then which it is. */
static int32_t sym_events(sym_run *r, sym_memory *m, double h, double t1, int32_t *ready, double *stop_x) {
    sym_scene *s = r->scene;
    int32_t i, status, n = 0;
    *stop_x = 2.0;
    r->stopped_by = -1;
    sym_place(r, t1, m->y1);
    status = sym_event_values(r, r->event + s->n_events);
    if (status != 0) return status;
    for (i = 0; i < s->n_events; ++i) { /* n <= i: what is written over has been read */
        const double before = r->event[i], after = r->event[s->n_events + i];
        double x;
        r->event[i] = after;
        if (!sym_crosses(s->event_direction[i], before, after)) continue;
        status = sym_locate(r, m, h, ready, i, before, after, &x);
        if (status != 0) return status;
        if (s->event_terminal[i] && x < *stop_x) *stop_x = x, r->stopped_by = i;
        r->event[s->n_events + n] = x;
        r->event[2 * s->n_events + n] = (double)i;
        ++n;
    }
    for (;;) { /* the earliest that is left */
        int32_t best = -1, which;
        for (i = 0; i < n; ++i)
            if (r->event[s->n_events + i] <= *stop_x &&
                (best < 0 || r->event[s->n_events + i] < r->event[s->n_events + best]))
                best = i;
        if (best < 0) return 0;
        which = (int32_t)r->event[2 * s->n_events + best];
        status = sym_dense(r, m, h, ready, r->event[s->n_events + best], m->stage);
        if (status != 0) return status;
        sym_place(r, r->t + r->event[s->n_events + best] * h, m->stage);
        r->found_t[r->n_found] = *s->t;
        r->found_which[r->n_found] = which;
        memcpy(r->found_q + r->n_found * s->nq, s->q, (size_t)s->nq * sizeof(double));
        memcpy(r->found_v + r->n_found * s->nv, s->v, (size_t)s->nv * sizeof(double));
        ++r->n_found;
        r->event[s->n_events + best] = 3.0;
    }
}

/* Records asked for at times within the step. */
static int32_t sym_grid(sym_run *r, sym_memory *m, double h, int32_t *ready, double up_to) {
    while (r->at_grid < r->n_grid && r->grid[r->at_grid] <= r->t + up_to * h * (1.0 + 1e-12)) {
        const double x = (r->grid[r->at_grid] - r->t) / h;
        int32_t status;
        if (x > 1.0 - 1e-9) {
            sym_place(r, r->grid[r->at_grid], m->y1);
        } else {
            status = sym_dense(r, m, h, ready, x, m->stage);
            if (status != 0) return status;
            sym_place(r, r->grid[r->at_grid], m->stage);
        }
        status = sym_record(r);
        if (status != 0) return status;
        ++r->at_grid;
    }
    return 0;
}
