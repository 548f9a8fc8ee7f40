/* Explicit Runge-Kutta methods by their tableau, and semi-implicit Euler. Slopes k: (dense_stages, n), n = 2 nv. */

/* The y of stage i, those before it being known. */
static void sym_stage(const sym_run *r, double h, int32_t i, const double *k, double *y) {
    const sym_tableau *m = &r->tableau;
    const int32_t nv = r->scene->nv, n = 2 * nv;
    const double *a = m->a + (size_t)i * m->dense_stages;
    int32_t j, l;
    memset(y, 0, (size_t)n * sizeof *y);
    for (j = 0; j < i; ++j) {
        const double s = a[j], *kj = k + (size_t)j * n;
        if (s != 0.0)
            for (l = 0; l < n; ++l) y[l] += s * kj[l];
    }
    for (l = 0; l < n; ++l) y[l] *= h;
    for (l = 0; l < nv; ++l) y[nv + l] += r->v[l];
}

/* Stages first to end - 1, those before them being known. */
static int32_t sym_stages(sym_run *r, double h, int32_t first, int32_t end, double *k, double *y) {
    int32_t i, status;
    for (i = first; i < end; ++i) {
        sym_stage(r, h, i, k, y);
        status = sym_slope(r, r->t + r->tableau.c[i] * h, y, k + (size_t)i * 2 * r->scene->nv);
        if (status != 0) return status;
    }
    return 0;
}

/* y at the end of the step, its stages being known. */
static void sym_explicit_sum(const sym_run *r, double h, const double *k, double *y1) {
    const sym_tableau *m = &r->tableau;
    const int32_t nv = r->scene->nv, n = 2 * nv;
    int32_t i, l;
    memset(y1, 0, (size_t)n * sizeof *y1);
    for (i = 0; i < m->stages; ++i) {
        const double s = m->b[i], *ki = k + (size_t)i * n;
        if (s != 0.0)
            for (l = 0; l < n; ++l) y1[l] += s * ki[l];
    }
    for (l = 0; l < n; ++l) y1[l] *= h;
    for (l = 0; l < nv; ++l) y1[nv + l] += r->v[l];
}

/* v1 = v + h v', then q1 = q moved by h v1: symplectic for constant mass, one evaluation a step. */
static void sym_semi_implicit_step(const sym_run *r, double h, const double *k, double *y1) {
    const int32_t nv = r->scene->nv;
    int32_t l;
    for (l = 0; l < nv; ++l) {
        y1[nv + l] = r->v[l] + h * k[nv + l];
        y1[l] = h * y1[nv + l];
    }
}

/* Sizes of the entries of y at the present state: a coordinate's own; 1 for a rotation. */
static void sym_sizes(const sym_run *r, double *size) {
    const sym_scene *s = r->scene;
    int32_t i, k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t n = seg->kind == 0 ? seg->size : 3 * seg->kind;
        for (i = 0; i < n; ++i)
            size[seg->v + i] = seg->kind == 0 || (seg->kind == 2 && i < 3) ? fabs(r->q[seg->q + i]) : 1.0;
    }
    for (i = 0; i < s->nv; ++i) size[s->nv + i] = fabs(r->v[i]);
}

/* What an error of entry l of y is measured by. */
static double sym_scale(const sym_run *r, int32_t l, const double *size, const double *y1) {
    double s = size[l];
    if (l >= r->scene->nv && fabs(y1[l]) > s) s = fabs(y1[l]);
    return r->atol + r->rtol * s;
}

static double sym_embedded(const sym_run *r, const double *weights, double h, const double *k, const double *size,
                           const double *y1) {
    const int32_t n = 2 * r->scene->nv;
    double sum = 0.0;
    int32_t i, l;
    for (l = 0; l < n; ++l) {
        double e = 0.0;
        for (i = 0; i < r->tableau.stages; ++i) e += weights[i] * k[(size_t)i * n + l];
        e *= h / sym_scale(r, l, size, y1);
        sum += e * e;
    }
    return sum / n;
}

/* Root mean square of the estimated error over its bound. */
static double sym_explicit_error(const sym_run *r, double h, const double *k, const double *size, const double *y1) {
    const double first = sym_embedded(r, r->tableau.e, h, k, size, y1);
    double second;
    if (r->tableau.errors < 2) return sqrt(first);
    second = sym_embedded(r, r->tableau.e2, h, k, size, y1);
    return first == 0.0 ? 0.0 : first / sqrt(first + 0.01 * second);
}
