/* y = (q, v) as plain numbers, for integrators of others that keep a history of y. Quaternions are made of unit length
 * before they are used, and not in y, so that the history stays smooth. */

typedef struct sym_vector { /* SUNDIALS' serial vector, as far as it matters here */
    struct {
        int64_t length;
        int32_t own;
        double *data;
    } *content;
} sym_vector;

/* The scene's point from y. */
static void sym_unflatten(sym_scene *s, double t, const double *y) {
    int32_t k, i;
    memcpy(s->q, y, (size_t)s->nq * sizeof *y);
    memcpy(s->v, y + s->nq, (size_t)s->nv * sizeof *y);
    *s->t = t;
    for (k = 0; k < s->n_segments; ++k) {
        double *p = s->q + s->segments[k].q + (s->segments[k].kind == 2 ? 3 : 0), size = 0.0;
        if (s->segments[k].kind == 0) continue;
        for (i = 0; i < 4; ++i) size += p[i] * p[i];
        size = sqrt(size);
        for (i = 0; i < 4; ++i) p[i] /= size;
    }
}

/* y' = (N v, v'): CVRhsFn of SUNDIALS. 1: the step may be tried again, -1: the run is over. */
SYM_EXPORT int32_t sym_flat_slope(double t, void *y_vector, void *rate_vector, void *run) {
    sym_run *r = run;
    sym_scene *s = r->scene;
    const double *y = ((sym_vector *)y_vector)->content->data;
    double *rate = ((sym_vector *)rate_vector)->content->data;
    int32_t k, i, status;
    sym_unflatten(s, t, y);
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const double *v = s->v + seg->v, *w = seg->kind == 2 ? v + 3 : v, *p = y + seg->q + (seg->kind == 2 ? 3 : 0);
        double *into = rate + seg->q, c[3];
        if (seg->kind == 0) {
            memcpy(into, v, (size_t)seg->size * sizeof *v);
            continue;
        }
        if (seg->kind == 2) sym_rotate(s->q + seg->q + 3, v, into), into += 3;
        sym_cross(p, w, c);
        for (i = 0; i < 3; ++i) into[i] = 0.5 * (p[3] * w[i] + c[i]);
        into[3] = -0.5 * (p[0] * w[0] + p[1] * w[1] + p[2] * w[2]);
    }
    status = sym_accelerate(r);
    memcpy(rate + s->nq, s->a, (size_t)s->nv * sizeof *rate);
    return status == SYM_CALLBACK ? -1 : status != 0;
}

/* Values of the events: CVRootFn of SUNDIALS. */
SYM_EXPORT int32_t sym_flat_events(double t, void *y_vector, double *values, void *run) {
    sym_scene *s = ((sym_run *)run)->scene;
    sym_unflatten(s, t, ((sym_vector *)y_vector)->content->data);
    if (sym_inputs(s) != 0) return -1;
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
