/* y = (q, v) as plain numbers, for integrators of others that keep a history of y. Quaternions are made of unit length
 * before they are used, and not in y, so that the history stays smooth. */

/* The scene's quaternions of unit length. */
static void sym_unit_quaternions(sym_scene *s) {
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        double *p = s->q + s->segments[k].q + (s->segments[k].kind == 2 ? 3 : 0), size = 0.0;
        if (s->segments[k].kind == 0) continue;
        for (i = 0; i < 4; ++i) size += p[i] * p[i];
        size = sqrt(size);
        for (i = 0; i < 4; ++i) p[i] /= size;
    }
}

/* The scene's point from y. */
static void sym_unflatten(sym_scene *s, double t, const double *y) {
    memcpy(s->q, y, (size_t)s->nq * sizeof *y);
    memcpy(s->v, y + s->nq, (size_t)s->nv * sizeof *y);
    *s->t = t;
    sym_unit_quaternions(s);
}

/* p' = p w / 2, for any length of p. */
static void sym_quaternion_rate(const double *p, const double *w, double *rate) {
    double c[3];
    int i;
    sym_cross(p, w, c);
    for (i = 0; i < 3; ++i) rate[i] = 0.5 * (p[3] * w[i] + c[i]);
    rate[3] = -0.5 * (p[0] * w[0] + p[1] * w[1] + p[2] * w[2]);
}

/* Rate N w at the scene's configuration; q: the same configuration, its quaternions of any length. */
static void sym_configuration_rate(const sym_scene *s, const double *q, const double *w, double *rate) {
    int32_t k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t at = seg->kind == 2 ? 3 : 0;
        const double *v = w + seg->v;
        if (seg->kind == 0) {
            memcpy(rate + seg->q, v, (size_t)seg->size * sizeof *v);
            continue;
        }
        if (seg->kind == 2) sym_rotate(s->q + seg->q + 3, v, rate + seg->q);
        sym_quaternion_rate(q + seg->q + at, v + at, rate + seg->q + at);
    }
}

/* Rate N w of a configuration whose quaternions may have any length; the scene stands at the same configuration. */
SYM_EXPORT void sym_flat_rate(const sym_run *r, const double *q, const double *w, double *rate) {
    sym_configuration_rate(r->scene, q, w, rate);
}

/* Rate y' = (N v, v') of a state; the status of the accelerations. */
SYM_EXPORT int32_t sym_flat_slope(sym_run *r, double t, const double *y, double *rate) {
    sym_scene *s = r->scene;
    int32_t status;
    sym_unflatten(s, t, y);
    sym_configuration_rate(s, y, s->v, rate);
    status = sym_accelerate(r);
    memcpy(rate + s->nq, s->a, (size_t)s->nv * sizeof *rate);
    return status;
}

/* Values of the events at a state. */
SYM_EXPORT int32_t sym_flat_events(sym_run *r, double t, const double *y, double *values) {
    sym_scene *s = r->scene;
    sym_unflatten(s, t, y);
    if (sym_inputs(s) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->events);
    memcpy(values, s->events.out[0], (size_t)s->n_events * sizeof *values);
    return 0;
}

/* The present state becomes y, and the scene's inputs those of that state. */
SYM_EXPORT int32_t sym_flat_place(sym_run *r, double t, const double *y) {
    sym_unflatten(r->scene, t, y);
    memcpy(r->q, r->scene->q, (size_t)r->scene->nq * sizeof *y);
    memcpy(r->v, r->scene->v, (size_t)r->scene->nv * sizeof *y);
    r->t = t;
    return sym_inputs(r->scene) != 0 ? SYM_CALLBACK : 0;
}
