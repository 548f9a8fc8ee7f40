/* Inputs, and the right-hand side y' = f(t, y). */

SYM_EXPORT int32_t sym_bind(sym_scene *s, sym_call *call) {
    static const char *const names[] = {"q", "v", "u", "t", "gains", "a", "lam"};
    const double *places[7];
    int32_t k, i;
    places[0] = s->q, places[1] = s->v, places[2] = s->u, places[3] = s->t;
    places[4] = s->gains, places[5] = s->a, places[6] = s->lam;
    call->in[0] = call->pre;
    if (call->function->n_in > 10 || call->function->n_out > 8) return 0;
    for (k = 1; k < call->function->n_in; ++k) {
        call->in[k] = NULL;
        for (i = 0; i < 7; ++i)
            if (strcmp(call->function->in[k].name, names[i]) == 0) call->in[k] = places[i];
        if (call->in[k] == NULL) return 0;
    }
    return 1;
}

static void sym_evaluate(const sym_call *call) {
    call->function->eval((const double *const *)call->in, (double *const *)call->out, call->work);
}

static double sym_sampled(const sym_signal *signal, double t) {
    int32_t low = 0, high = signal->n - 1;
    double x;
    if (t <= signal->t[0]) return signal->value[0];
    if (t >= signal->t[high]) return signal->value[high];
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        if (signal->t[middle] <= t) low = middle;
        else high = middle;
    }
    if (!signal->linear) return signal->value[low];
    x = (t - signal->t[low]) / (signal->t[high] - signal->t[low]);
    return signal->value[low] + x * (signal->value[high] - signal->value[low]);
}

/* The inputs that depend on time alone, at the scene's point (q, v, t). */
static void sym_samples(sym_scene *s) {
    int32_t i;
    memcpy(s->u, s->constant, (size_t)s->nu * sizeof *s->u);
    for (i = 0; i < s->n_signals; ++i) s->u[s->signals[i].input] = sym_sampled(&s->signals[i], *s->t);
}

/* The inputs at the scene's point. */
static int32_t sym_inputs(sym_scene *s) {
    int32_t i;
    if (s->callback != NULL) return s->callback(s->data, *s->t, s->q, s->v, s->u);
    sym_samples(s);
    if (s->law.function != NULL) {
        sym_evaluate(&s->law);
        for (i = 0; i < s->n_law; ++i) s->u[s->law_inputs[i]] = s->law.out[0][i];
    }
    return 0;
}

static int32_t sym_finite(int32_t n, const double *x) {
    double s = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) s += x[i] * 0.0;
    return s == 0.0;
}

/* What to say of accelerations just evaluated. Returns 0 or a status. */
static int32_t sym_accelerated(sym_run *r) {
    const sym_scene *s = r->scene;
    ++r->evaluations;
    if (s->nc > 0 && *s->rank < 0.0) return SYM_NO_MOTION;
    return sym_finite(s->nv, s->a) ? 0 : SYM_DIVERGED;
}

/* Accelerations and multipliers at the scene's point, inputs included. Returns 0 or a status. */
static int32_t sym_accelerate(sym_run *r) {
    sym_scene *s = r->scene;
    if (sym_inputs(s) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->forward);
    return sym_accelerated(r);
}

/* The scene's point: y of the present chart at time t. */
static void sym_place(sym_run *r, double t, const double *y) {
    sym_retract(r->scene, r->q, y, r->scene->q);
    memcpy(r->scene->v, y + r->scene->nv, (size_t)r->scene->nv * sizeof *y);
    *r->scene->t = t;
}

/* dy = f(t, y), the scene's accelerations being those of y. */
static void sym_rate(const sym_scene *s, const double *y, double *dy) {
    sym_chart_rate(s, y, y + s->nv, dy);
    memcpy(dy + s->nv, s->a, (size_t)s->nv * sizeof *dy);
}

/* dy = f(t, y), in the chart about r->q. */
static int32_t sym_slope(sym_run *r, double t, const double *y, double *dy) {
    int32_t status;
    sym_place(r, t, y);
    status = sym_accelerate(r);
    sym_rate(r->scene, y, dy);
    return status;
}

/* The scene's point becomes the present state. */
static void sym_here(sym_run *r) {
    sym_scene *s = r->scene;
    memcpy(s->q, r->q, (size_t)s->nq * sizeof *s->q);
    memcpy(s->v, r->v, (size_t)s->nv * sizeof *s->v);
    *s->t = r->t;
}

/* The present state back onto the constraints; what is left of phi above 1e-6 counts as lost. */
static int32_t sym_return(sym_run *r) {
    sym_scene *s = r->scene;
    sym_here(r);
    if (sym_inputs(s) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->project);
    if (!(s->project.out[3][0] >= 0.0)) return SYM_NO_MOTION;
    if (!(s->project.out[2][0] < 1e-6)) return SYM_OFF;
    memcpy(r->q, s->project.out[0], (size_t)s->nq * sizeof *r->q);
    memcpy(r->v, s->project.out[1], (size_t)s->nv * sizeof *r->v);
    return 0;
}
