/* Right-hand side and events for external integrators (SUNDIALS), whose multistep formulas keep a history of y: y = (q, v) as
 * a flat vector instead of charts. Quaternions are normalised at the evaluation point and not in y, so that the history
 * stays smooth. */

/* Normalise the quaternions of the evaluation point. */
static void sym_normalize_quaternions(sym_system *s) {
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        double *p = s->q + s->segments[k].q + (s->segments[k].kind == SYM_SEGMENT_POSE ? 3 : 0), size = 0.0;
        if (s->segments[k].kind == SYM_SEGMENT_LINEAR) continue;
        for (i = 0; i < 4; ++i) size += p[i] * p[i];
        size = sqrt(size);
        for (i = 0; i < 4; ++i) p[i] /= size;
    }
}

/* Evaluation point <- y = (q, v) at time t. */
static void sym_load_flat_state(sym_system *s, double t, const double *y) {
    memcpy(s->q, y, (size_t)s->nq * sizeof *y);
    memcpy(s->v, y + s->nq, (size_t)s->nv * sizeof *y);
    *s->t = t;
    sym_normalize_quaternions(s);
}

/* Rate of a quaternion p of any length at angular velocity w: p' = p w / 2. */
static void sym_quaternion_rate(const double *p, const double *w, double *rate) {
    double c[3];
    int i;
    sym_cross(p, w, c);
    for (i = 0; i < 3; ++i) rate[i] = 0.5 * (p[3] * w[i] + c[i]);
    rate[3] = -0.5 * (p[0] * w[0] + p[1] * w[1] + p[2] * w[2]);
}

/* Rate N(q) w at the configuration of the evaluation point; q: the same one, with quaternions of any length. */
static void sym_configuration_rate(const sym_system *s, const double *q, const double *w, double *rate) {
    int32_t k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t at = seg->kind == SYM_SEGMENT_POSE ? 3 : 0;
        const double *v = w + seg->v;
        if (seg->kind == SYM_SEGMENT_LINEAR) {
            memcpy(rate + seg->q, v, (size_t)seg->size * sizeof *v);
            continue;
        }
        if (seg->kind == SYM_SEGMENT_POSE) sym_rotate(s->q + seg->q + 3, v, rate + seg->q);
        sym_quaternion_rate(q + seg->q + at, v + at, rate + seg->q + at);
    }
}

SYM_EXPORT void sym_run_configuration_rate(const sym_run *r, const double *q, const double *w, double *rate) {
    sym_configuration_rate(r->system, q, w, rate);
}

SYM_EXPORT int32_t sym_run_rate(sym_run *r, double t, const double *y, double *rate) {
    sym_system *s = r->system;
    int32_t status;
    sym_load_flat_state(s, t, y);
    sym_configuration_rate(s, y, s->v, rate);
    status = sym_evaluate_acceleration(r);
    memcpy(rate + s->nq, s->a, (size_t)s->nv * sizeof *rate);
    return status;
}

SYM_EXPORT int32_t sym_run_event_values(sym_run *r, double t, const double *y, double *values) {
    sym_load_flat_state(r->system, t, y);
    return sym_event_values(r, values);
}

SYM_EXPORT int32_t sym_run_set_state(sym_run *r, double t, const double *y) {
    sym_load_flat_state(r->system, t, y);
    memcpy(r->q, r->system->q, (size_t)r->system->nq * sizeof *y);
    memcpy(r->v, r->system->v, (size_t)r->system->nv * sizeof *y);
    r->t = t;
    return sym_evaluate_inputs(r->system) != 0 ? SYM_CALLBACK_FAILED : 0;
}
