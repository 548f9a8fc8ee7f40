/* Rosenbrock methods (docs/theory/simulation.md, section 3), and the Jacobian that all implicit methods use.
 *
 * They rest on the residual R = (M a + h - Q - G^T lam; G a - gamma) and its derivatives at the evaluation point. The model
 * function "implicit_terms" gives M (nv, nv), G (nc, nv), R_q and R_v (nv + nc, nv), R_u (nv + nc, nu), and rate_q (nc, nv),
 * the derivative of G v - b by q. */
enum { SYM_TERM_M, SYM_TERM_G, SYM_TERM_R_Q, SYM_TERM_R_V, SYM_TERM_R_U, SYM_TERM_RATE_Q };

static void sym_evaluate_sliding_terms(sym_run *r);
static void sym_add_drag(const sym_run *r, double *matrix);

/* Derivatives of the residual at the evaluation point, through the inputs that a law gives as well. Returns 0 or a
 * status. */
static int32_t sym_evaluate_jacobian(sym_run *r) {
    sym_system *s = r->system;
    const int32_t nv = s->nv, rows = nv + s->nc;
    double *R_q, *R_v;
    int32_t i, j, k;
    if (s->n_contacts > 0) sym_evaluate_sliding_terms(r);
    else sym_evaluate(&s->implicit_terms);
    ++r->jacobians;
    R_q = s->implicit_terms.out[SYM_TERM_R_Q], R_v = s->implicit_terms.out[SYM_TERM_R_V];
    if (s->law.function != NULL) {
        const double *u_q = s->law.out[1], *u_v = s->law.out[2], *R_u = s->implicit_terms.out[SYM_TERM_R_U];
        for (i = 0; i < rows; ++i)
            for (k = 0; k < s->n_law; ++k) {
                const double by = R_u[SYM_INDEX(i, s->nu, s->law_inputs[k])];
                if (by == 0.0) continue;
                for (j = 0; j < nv; ++j) {
                    R_q[SYM_INDEX(i, nv, j)] += by * u_q[SYM_INDEX(k, nv, j)];
                    R_v[SYM_INDEX(i, nv, j)] += by * u_v[SYM_INDEX(k, nv, j)];
                }
            }
    }
    return sym_all_finite(rows * nv, R_q) && sym_all_finite(rows * nv, R_v) ? 0 : SYM_DIVERGED;
}

/* out = (g X + R_v) y (nv + nc) for X = M above G. */
static void sym_apply_rate_jacobian(const sym_run *r, double g, const double *y, double *out) {
    const sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc;
    const double *M = s->implicit_terms.out[SYM_TERM_M], *G = s->implicit_terms.out[SYM_TERM_G], *R_v = s->implicit_terms.out[SYM_TERM_R_V];
    int32_t i, j;
    for (i = 0; i < nv + nc; ++i) {
        const double *X = i < nv ? M + SYM_INDEX(i, nv, 0) : G + SYM_INDEX(i - nv, nv, 0), *V = R_v + SYM_INDEX(i, nv, 0);
        double sum = 0.0;
        for (j = 0; j < nv; ++j) sum += (g * X[j] + V[j]) * y[j];
        out[i] = sum;
    }
}

/* Factors of the matrix of (5) over g^2: R_q + (g X + R_v) (g - T), and -G^T beside it for multipliers over g^2. The
 * division keeps pivots of very short steps above rounding. T is the derivative of the chart's rate by theta. Returns the
 * rank. */
static int32_t sym_rosenbrock_matrix(sym_run *r, double g, sym_implicit_workspace *w) {
    const sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const double *G = s->implicit_terms.out[SYM_TERM_G], *R_q = s->implicit_terms.out[SYM_TERM_R_Q];
    int32_t i, j;
    for (j = 0; j < nv; ++j) {
        memset(w->solution, 0, (size_t)n * sizeof(double));
        memset(w->scratch, 0, (size_t)nv * sizeof(double));
        w->solution[j] = 1.0;
        sym_chart_rate_jacobian(s, r->v, w->solution, -1.0, w->scratch); /* -T e_j */
        w->scratch[j] += g;
        sym_apply_rate_jacobian(r, g, w->scratch, w->right);
        for (i = 0; i < n; ++i) w->matrix[SYM_INDEX(i, n, j)] = (w->right[i] + R_q[SYM_INDEX(i, nv, j)]) / (g * g);
    }
    for (i = 0; i < nv; ++i)
        for (j = 0; j < nc; ++j) w->matrix[SYM_INDEX(i, n, nv + j)] = -G[SYM_INDEX(j, nv, i)];
    if (s->n_contacts > 0) sym_add_drag(r, w->matrix);
    for (i = nv; i < n; ++i)
        for (j = nv; j < n; ++j) w->matrix[SYM_INDEX(i, n, j)] = 0.0;
    return sym_eliminate(nv, n, s->group, nv + r->rank, w->matrix, w->scale, r->pivots, r->pivots + n);
}

/* U = (U_1, U_2) with (g - J) U = right = (r_1, r_2), J the Jacobian of f: U_1 less r_1/g by (5a), then U_2, which is not
 * a difference of speeds. */
static void sym_rosenbrock_solve(sym_run *r, double g, int32_t rank, sym_implicit_workspace *w, const double *right,
                                 double *U) {
    const sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const double *M = s->implicit_terms.out[SYM_TERM_M], *G = s->implicit_terms.out[SYM_TERM_G];
    const double *R_q = s->implicit_terms.out[SYM_TERM_R_Q];
    double *turned = w->correction; /* T r_1/g */
    int32_t i, j;
    memset(turned, 0, (size_t)nv * sizeof(double));
    sym_chart_rate_jacobian(s, r->v, right, 1.0 / g, turned);
    sym_apply_rate_jacobian(r, g, turned, w->right);
    for (i = 0; i < n; ++i) {
        const double *X = i < nv ? M + SYM_INDEX(i, nv, 0) : G + SYM_INDEX(i - nv, nv, 0), *stiff = R_q + SYM_INDEX(i, nv, 0);
        for (j = 0; j < nv; ++j) w->right[i] += X[j] * right[nv + j] - stiff[j] * right[j] / g;
        w->right[i] /= g * g;
    }
    sym_solve(n, rank, w->matrix, w->scale, r->pivots, r->pivots + n, w->right, w->solution, w->scratch);
    for (i = 0; i < nv; ++i) {
        U[i] = w->solution[i] + right[i] / g;
        U[nv + i] = g * w->solution[i] - turned[i];
    }
    sym_chart_rate_jacobian(s, r->v, w->solution, -1.0, U + nv);
}

/* Partial derivative of f by time at the present state, by a forward difference. k: the slope there; y: work. Returns 0
 * or a status. */
static int32_t sym_slope_time_derivative(sym_run *r, const double *k, double *y, double *derivative) {
    const int32_t n = 2 * r->system->nv;
    const double step = sym_time_difference(r->t);
    int32_t l, status;
    memset(y, 0, (size_t)n * sizeof *y);
    memcpy(y + r->system->nv, r->v, (size_t)r->system->nv * sizeof *y);
    status = sym_evaluate_slope(r, r->t + step, y, derivative);
    if (status != 0) return status;
    for (l = 0; l < n; ++l) derivative[l] = (derivative[l] - k[l]) / step;
    return 0;
}

/* One step: y1, and the error norm where the method estimates one. Returns 0 or a status. */
static int32_t sym_rosenbrock_step(sym_run *r, sym_workspace *w, double h, double *error) {
    const sym_tableau *method = &r->tableau;
    const int32_t nv = r->system->nv, n = 2 * nv;
    const double g = 1.0 / (h * method->gamma);
    const double *k = w->k, *time_slope = w->implicit.time_slope;
    double *y1 = w->y1, *y = w->stage, *U = w->implicit.stages, sum = 0.0;
    int32_t i, j, l, status = 0, rank;
    if (!r->jacobian_valid) { /* the evaluation point is at the present state, a and lam too, after sym_first_slope */
        status = sym_evaluate_jacobian(r);
        if (status == 0) status = sym_slope_time_derivative(r, k, y, w->implicit.time_slope);
        if (status != 0) return status;
        r->jacobian_valid = 1;
    }
    rank = sym_rosenbrock_matrix(r, g, &w->implicit);
    if (rank < nv) return SYM_NO_CONVERGENCE;
    for (i = 0; i < method->stages; ++i) {
        const double *a = method->a + SYM_INDEX(i, method->stages, 0), *c = method->coupling + SYM_INDEX(i, method->stages, 0);
        memset(y, 0, (size_t)nv * sizeof *y);
        memcpy(y + nv, r->v, (size_t)nv * sizeof *y);
        for (j = 0; j < i; ++j)
            for (l = 0; l < n; ++l) y[l] += a[j] * U[SYM_INDEX(j, n, l)];
        if (i == 0) memcpy(y1, k, (size_t)n * sizeof *y1); /* y1 serves as the right side */
        else status = sym_evaluate_slope(r, r->t + method->c[i] * h, y, y1);
        if (status != 0) return status;
        for (l = 0; l < n; ++l) y1[l] += h * method->d[i] * time_slope[l];
        for (j = 0; j < i; ++j)
            for (l = 0; l < n; ++l) y1[l] += c[j] / h * U[SYM_INDEX(j, n, l)];
        sym_rosenbrock_solve(r, g, rank, &w->implicit, y1, U + (size_t)i * (size_t)n);
    }
    memset(y1, 0, (size_t)nv * sizeof *y1);
    memcpy(y1 + nv, r->v, (size_t)nv * sizeof *y1);
    for (i = 0; i < method->stages; ++i)
        for (l = 0; l < n; ++l) y1[l] += method->b[i] * U[SYM_INDEX(i, n, l)];
    if (!r->adaptive) return 0;
    for (l = 0; l < n; ++l) {
        double e = 0.0;
        for (i = 0; i < method->stages; ++i) e += method->e[i] * U[SYM_INDEX(i, n, l)];
        e /= sym_error_scale(r, l, w->magnitude, y1);
        sum += e * e;
    }
    *error = sqrt(sum / n);
    return 0;
}
