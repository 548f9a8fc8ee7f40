/* Explicit Runge-Kutta methods by their tableau, and semi-implicit Euler. y has 2 nv entries. */

/* sum = weights[0] k_0 + ... + weights[stages - 1] k_(stages - 1), of n entries each. */
static void sym_weighted_sum(size_t n, int32_t stages, const double *weights, const double *k, size_t stride,
                             double *restrict sum) {
    int32_t j, empty = 1;
    size_t l;
    for (j = 0; j < stages; ++j) {
        const double weight = weights[j], *restrict kj = k + (size_t)j * (size_t)stride;
        if (weight == 0.0) continue;
        if (empty)
            for (l = 0; l < n; ++l) sum[l] = 0.0 + weight * kj[l];
        else
            for (l = 0; l < n; ++l) sum[l] += weight * kj[l];
        empty = 0;
    }
    if (empty) memset(sum, 0, n * sizeof *sum);
}

/* y = (0, v) + h times the weighted sum of slopes. */
static void sym_combine_slopes(const sym_run *r, const sym_workspace *w, double h, int32_t stages,
                               const double *weights, double *y) {
    const int32_t nv = r->system->nv;
    int32_t l;
    sym_weighted_sum(2 * (size_t)nv, stages, weights, w->k, w->stage_stride, y);
    for (l = 0; l < nv; ++l) {
        y[l] *= h;
        y[nv + l] = h * y[nv + l] + r->v[l];
    }
}

/* Slopes of the stages first to end - 1; those of the stages before are known. Returns 0 or a status. */
static int32_t sym_evaluate_stages(sym_run *r, const sym_workspace *w, double h, int32_t first, int32_t end) {
    const sym_tableau *method = &r->tableau;
    int32_t i, status;
    for (i = first; i < end; ++i) {
        sym_combine_slopes(r, w, h, i, method->a + (size_t)i * (size_t)method->dense_stages, w->stage);
        status = sym_evaluate_slope(r, r->t + method->c[i] * h, w->stage, w->k + (size_t)i * (size_t)w->stage_stride);
        if (status != 0) return status;
    }
    return 0;
}

/* v1 = v + h v', theta1 = h v1: symplectic for a constant mass matrix, one evaluation a step. */
static void sym_semi_implicit_step(const sym_run *r, double h, const double *k, double *y1) {
    const int32_t nv = r->system->nv;
    int32_t l;
    for (l = 0; l < nv; ++l) {
        y1[nv + l] = r->v[l] + h * k[nv + l];
        y1[l] = h * y1[nv + l];
    }
}
