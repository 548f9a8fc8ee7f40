/* Implicit methods: Rosenbrock, generalised alpha, the variational midpoint rule (docs/theory/simulation.md, 3 to 5).
 *
 * All rest on the residual R = (M a + h - Q - G^T lam; G a - gamma) and its derivatives at the scene's point, which the
 * function "implicit_terms" gives: M (nv nv), G (nc nv), R_q, R_v (nv + nc, nv), R_u (nv + nc, nu), rate_q (nc, nv). */

typedef struct sym_scratch {
    double *matrix, *right, *found, *work, *held, *u, *slope_t;
} sym_scratch;

static size_t sym_implicit_size(const sym_run *r) {
    const size_t n = (size_t)r->scene->nv + (size_t)r->scene->nc, nv = (size_t)r->scene->nv;
    if (r->method <= SYM_METHOD_SEMI_IMPLICIT) return 0;
    return n * n + 3 * n + 4 * nv + 2 * nv * ((size_t)r->tableau.stages + 3);
}

static sym_scratch sym_scratch_of(const sym_run *r, double *rest) {
    const size_t nv = (size_t)r->scene->nv, n = nv + (size_t)r->scene->nc;
    sym_scratch s;
    s.matrix = rest;
    s.right = s.matrix + n * n;
    s.found = s.right + n;
    s.work = s.found + n;
    s.slope_t = s.work + n;
    s.held = s.slope_t + 2 * nv;
    s.u = s.held + 2 * nv;
    return s;
}

/* Derivatives at the scene's point, those of a law of inputs included. */
static int32_t sym_terms(sym_run *r) {
    sym_scene *s = r->scene;
    const int32_t nv = s->nv, rows = nv + s->nc;
    double *R_q, *R_v;
    int32_t i, j, k;
    sym_evaluate(&s->terms);
    ++r->jacobians;
    R_q = s->terms.out[2], R_v = s->terms.out[3];
    if (s->law.function != NULL) {
        const double *u_q = s->law.out[1], *u_v = s->law.out[2], *R_u = s->terms.out[4];
        for (i = 0; i < rows; ++i)
            for (k = 0; k < s->n_law; ++k) {
                const double by = R_u[(size_t)i * s->nu + s->law_inputs[k]];
                if (by == 0.0) continue;
                for (j = 0; j < nv; ++j) {
                    R_q[(size_t)i * nv + j] += by * u_q[(size_t)k * nv + j];
                    R_v[(size_t)i * nv + j] += by * u_v[(size_t)k * nv + j];
                }
            }
    }
    return sym_finite(rows * nv, R_q) && sym_finite(rows * nv, R_v) ? 0 : SYM_DIVERGED;
}

/* (g X + R_v) y for X = M above G; out has nv + nc rows. */
static void sym_weighted(const sym_run *r, double g, const double *y, double *out) {
    const sym_scene *s = r->scene;
    const int32_t nv = s->nv, nc = s->nc;
    const double *M = s->terms.out[0], *G = s->terms.out[1], *R_v = s->terms.out[3];
    int32_t i, j;
    for (i = 0; i < nv + nc; ++i) {
        const double *X = i < nv ? M + (size_t)i * nv : G + (size_t)(i - nv) * nv, *V = R_v + (size_t)i * nv;
        double sum = 0.0;
        for (j = 0; j < nv; ++j) sum += (g * X[j] + V[j]) * y[j];
        out[i] = sum;
    }
}

/* The matrix of a Rosenbrock step, over g^2: R_q + (g X + R_v) (g - T), and -G^T beside it for multipliers over g^2, so
 * that no step is too short for pivots to be told from rounding. T is the derivative of the chart's rate. */
static int32_t sym_rosenbrock_matrix(sym_run *r, double g, sym_scratch *w) {
    const sym_scene *s = r->scene;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const double *G = s->terms.out[1], *R_q = s->terms.out[2];
    int32_t i, j;
    for (j = 0; j < nv; ++j) {
        memset(w->found, 0, (size_t)n * sizeof(double));
        memset(w->work, 0, (size_t)nv * sizeof(double));
        w->found[j] = 1.0;
        sym_chart_rate_by_theta(s, r->v, w->found, -1.0, w->work); /* -T e_j */
        w->work[j] += g;
        sym_weighted(r, g, w->work, w->right);
        for (i = 0; i < n; ++i) w->matrix[(size_t)i * n + j] = (w->right[i] + R_q[(size_t)i * nv + j]) / (g * g);
    }
    for (i = 0; i < nv; ++i)
        for (j = 0; j < nc; ++j) w->matrix[(size_t)i * n + nv + j] = -G[(size_t)j * nv + i];
    for (i = nv; i < n; ++i)
        for (j = nv; j < n; ++j) w->matrix[(size_t)i * n + j] = 0.0;
    return sym_eliminate(n, w->matrix, r->pivots, r->pivots + n);
}

/* U with (g - J) U = (r1, r2), J the derivative of f: by elimination of all but its upper half. */
static void sym_rosenbrock_solve(sym_run *r, double g, int32_t rank, sym_scratch *w, const double *right, double *U) {
    const sym_scene *s = r->scene;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const double *M = s->terms.out[0], *G = s->terms.out[1];
    int32_t i, j;
    sym_weighted(r, g, right, w->right);
    for (i = 0; i < n; ++i) {
        const double *X = i < nv ? M + (size_t)i * nv : G + (size_t)(i - nv) * nv;
        for (j = 0; j < nv; ++j) w->right[i] += X[j] * right[nv + j];
        w->right[i] /= g * g;
    }
    sym_solve(n, rank, w->matrix, r->pivots, r->pivots + n, w->right, w->found, w->work);
    for (i = 0; i < nv; ++i) U[i] = w->found[i], U[nv + i] = g * w->found[i] - right[i];
    sym_chart_rate_by_theta(s, r->v, w->found, -1.0, U + nv);
}

/* The derivative of f by time, by a difference; zero where nothing depends on time but through fixed inputs. */
static int32_t sym_slope_by_time(sym_run *r, const double *k, double *y, double *found) {
    const int32_t n = 2 * r->scene->nv;
    const double step = sqrt(2.2e-16 * (fabs(r->t) > 1e-5 ? fabs(r->t) : 1e-5));
    int32_t l, status;
    memset(y, 0, (size_t)n * sizeof *y);
    memcpy(y + r->scene->nv, r->v, (size_t)r->scene->nv * sizeof *y);
    status = sym_slope(r, r->t + step, y, found);
    if (status != 0) return status;
    for (l = 0; l < n; ++l) found[l] = (found[l] - k[l]) / step;
    return 0;
}

static int32_t sym_rosenbrock_step(sym_run *r, double h, const double *k, double *y1, double *y, const double *size,
                                   double *rest, double *error) {
    const sym_tableau *m = &r->tableau;
    const int32_t nv = r->scene->nv, n = 2 * nv;
    const double g = 1.0 / (h * m->gamma);
    sym_scratch w = sym_scratch_of(r, rest);
    double *U = w.u, sum = 0.0;
    int32_t i, j, l, status = 0, rank;
    if (!r->linear) { /* the scene is at the present state, a and lam included, as sym_first_slope left it */
        status = sym_terms(r);
        if (status == 0) status = sym_slope_by_time(r, k, y, w.slope_t);
        if (status != 0) return status;
        r->linear = 1;
    }
    rank = sym_rosenbrock_matrix(r, g, &w);
    if (rank < nv) return SYM_NO_CONVERGENCE;
    for (i = 0; i < m->stages; ++i) {
        const double *a = m->a + (size_t)i * m->stages, *c = m->coupling + (size_t)i * m->stages;
        memset(y, 0, (size_t)nv * sizeof *y);
        memcpy(y + nv, r->v, (size_t)nv * sizeof *y);
        for (j = 0; j < i; ++j)
            for (l = 0; l < n; ++l) y[l] += a[j] * U[(size_t)j * n + l];
        if (i == 0) memcpy(y1, k, (size_t)n * sizeof *y1);
        else status = sym_slope(r, r->t + m->c[i] * h, y, y1);
        if (status != 0) return status;
        for (l = 0; l < n; ++l) y1[l] += h * m->d[i] * w.slope_t[l];
        for (j = 0; j < i; ++j)
            for (l = 0; l < n; ++l) y1[l] += c[j] / h * U[(size_t)j * n + l];
        sym_rosenbrock_solve(r, g, rank, &w, y1, U + (size_t)i * n);
    }
    memset(y1, 0, (size_t)nv * sizeof *y1);
    memcpy(y1 + nv, r->v, (size_t)nv * sizeof *y1);
    for (i = 0; i < m->stages; ++i)
        for (l = 0; l < n; ++l) y1[l] += m->b[i] * U[(size_t)i * n + l];
    if (!r->adaptive) return 0;
    for (l = 0; l < n; ++l) {
        double e = 0.0;
        for (i = 0; i < m->stages; ++i) e += m->e[i] * U[(size_t)i * n + l];
        e /= sym_scale(r, l, size, y1);
        sum += e * e;
    }
    *error = sqrt(sum / n);
    return 0;
}
