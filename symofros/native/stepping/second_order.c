/* Generalised alpha, and the variational midpoint rule. */

/* What the unknowns of an implicit step are at: R (nv), phi (nc), rate (nc) at the scene's point. */
static int32_t sym_residual(sym_run *r) {
    sym_scene *s = r->scene;
    if (sym_inputs(s) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->residual);
    ++r->evaluations;
    return sym_finite(s->nv, s->residual.out[0]) && sym_finite(s->nc, s->residual.out[1]) ? 0 : SYM_DIVERGED;
}

/* M a + h - Q - G^T lam = 0, phi = 0 (or G v = b) at the end of the step, for a and lam. */
static int32_t sym_alpha_step(sym_run *r, double h, double *y1, double *rest) {
    enum { LONGEST = 25 };
    sym_scene *s = r->scene;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const double alpha_m = (2.0 * r->rho - 1.0) / (r->rho + 1.0), alpha_f = r->rho / (r->rho + 1.0);
    const double gamma = 0.5 + alpha_f - alpha_m, beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
    const double share = (1.0 - alpha_f) / (1.0 - alpha_m), by_q = h * h * beta * share, by_v = h * gamma * share;
    sym_scratch w = sym_scratch_of(r, rest);
    double *smooth = w.held, *a0 = w.held + nv, *smooth1 = w.slope_t;
    int32_t i, j, k, status, rank = 0;
    if (r->steps == 0) memcpy(smooth, s->a, (size_t)nv * sizeof *smooth);
    /* s->a, s->lam: of the present state, and the first guess for the next. */
    memcpy(a0, s->a, (size_t)nv * sizeof *a0);
    for (k = 0; k < LONGEST; ++k) {
        double change = 0.0, extent = 0.0, reach = 0.0;
        for (i = 0; i < nv; ++i) {
            smooth1[i] = ((1.0 - alpha_f) * s->a[i] + alpha_f * a0[i] - alpha_m * smooth[i]) / (1.0 - alpha_m);
            y1[i] = h * r->v[i] + h * h * ((0.5 - beta) * smooth[i] + beta * smooth1[i]);
            y1[nv + i] = r->v[i] + h * ((1.0 - gamma) * smooth[i] + gamma * smooth1[i]);
        }
        sym_unroll(s, y1);
        sym_retract(s, r->q, y1, s->q);
        memcpy(s->v, y1 + nv, (size_t)nv * sizeof *y1);
        *s->t = r->t + h;
        status = sym_residual(r);
        if (status != 0) return status;
        if (k == 0 || k == 4 || k == 12) { /* modified Newton: the matrix anew only where progress is slow */
            const double *M = s->terms.out[0], *G = s->terms.out[1], *R_q = s->terms.out[2], *R_v = s->terms.out[3];
            const double *rate_q = s->terms.out[5];
            status = sym_terms(r);
            if (status != 0) return status;
            for (i = 0; i < nv; ++i) {
                for (j = 0; j < nv; ++j)
                    w.matrix[(size_t)i * n + j] = M[(size_t)i * nv + j] + by_v * R_v[(size_t)i * nv + j] + by_q * R_q[(size_t)i * nv + j];
                for (j = 0; j < nc; ++j) w.matrix[(size_t)i * n + nv + j] = -G[(size_t)j * nv + i];
            }
            for (i = 0; i < nc; ++i) {
                for (j = 0; j < nv; ++j) {
                    const double g = G[(size_t)i * nv + j];
                    w.matrix[(size_t)(nv + i) * n + j] = s->on_speeds[i] ? g + by_q / by_v * rate_q[(size_t)i * nv + j] : g;
                }
                for (j = 0; j < nc; ++j) w.matrix[(size_t)(nv + i) * n + nv + j] = 0.0;
            }
            rank = sym_eliminate(n, w.matrix, r->pivots, r->pivots + n);
            if (rank < nv) return SYM_NO_MOTION;
        }
        for (i = 0; i < nv; ++i) w.right[i] = -s->residual.out[0][i];
        for (i = 0; i < nc; ++i)
            w.right[nv + i] = s->on_speeds[i] ? -s->residual.out[2][i] / by_v : -s->residual.out[1][i] / by_q;
        sym_solve(n, rank, w.matrix, r->pivots, r->pivots + n, w.right, w.found, w.work);
        for (i = 0; i < nv; ++i) {
            s->a[i] += w.found[i];
            change = fabs(w.found[i]) * by_v > change ? fabs(w.found[i]) * by_v : change;
            extent = fabs(y1[nv + i]) > extent ? fabs(y1[nv + i]) : extent;
        }
        for (i = 0; i < nc; ++i) s->lam[i] += w.found[nv + i];
        for (i = 0; i < s->nq; ++i) reach = fabs(s->q[i]) > reach ? fabs(s->q[i]) : reach;
        if (!sym_finite(n, w.found)) return SYM_DIVERGED;
        /* phi is known to some rounding errors of q, and so are the speeds over h. */
        if (change <= r->tolerance * (1.0 + extent) + (nc > 0 ? 1e-15 * (1.0 + reach) / h : 0.0)) {
            memcpy(smooth, smooth1, (size_t)nv * sizeof *smooth);
            return 0;
        }
    }
    return SYM_NO_CONVERGENCE;
}

/* The transpose of the chart's tangent map applied to p, by its series in the adjoint of theta: sum of B_k / k! ad^k for
 * "inverse" (B_1 = -sign / 2), of sign^k ad^k / (k + 1)! otherwise. Exact to rounding while |theta| < 0.1. */
static void sym_adjoint_transposed(const sym_scene *s, const double *theta, const double *p, double *out) {
    int32_t k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t i = seg->v;
        double c[3];
        int32_t l;
        if (seg->kind == 0) {
            for (l = 0; l < seg->size; ++l) out[i + l] = 0.0;
        } else if (seg->kind == 1) { /* ad^T p = -w x p */
            sym_cross(p + i, theta + i, out + i);
        } else { /* ad of (v, w): (w x v' + v x w', w x w'); transposed */
            double d[3];
            sym_cross(p + i, theta + i + 3, c);
            sym_cross(p + i, theta + i, d);
            sym_cross(p + i + 3, theta + i + 3, out + i + 3);
            for (l = 0; l < 3; ++l) out[i + 3 + l] += d[l], out[i + l] = c[l];
        }
    }
}

static void sym_tangent_transposed(const sym_scene *s, const double *theta, double sign, int32_t inverse, const double *p,
                                   double *out, double *once, double *twice) {
    static const double bernoulli[7] = {1.0, 0.5, 1.0 / 12.0, 0.0, -1.0 / 720.0, 0.0, 1.0 / 30240.0};
    static const double factorial[7] = {1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0};
    int32_t k, i;
    memcpy(once, p, (size_t)s->nv * sizeof *once);
    memcpy(out, p, (size_t)s->nv * sizeof *out);
    for (k = 1; k < 7; ++k) {
        const double power = k % 2 ? sign : 1.0;
        const double c = inverse ? (k == 1 ? -power * bernoulli[1] : bernoulli[k]) : power * factorial[k];
        sym_adjoint_transposed(s, theta, once, twice);
        memcpy(once, twice, (size_t)s->nv * sizeof *once);
        for (i = 0; i < s->nv; ++i) out[i] += c * once[i];
    }
}

/* Momenta at both ends of the step theta: docs/theory/simulation.md, section 5. */
static int32_t sym_momenta(sym_run *r, double h, const double *theta, double *start, double *end, double *work) {
    sym_scene *s = r->scene;
    const int32_t nv = s->nv;
    double *half = work, *force = half + nv, *once = force + nv, *twice = once + nv, *sum = twice + nv;
    int32_t i;
    for (i = 0; i < nv; ++i) half[i] = 0.5 * theta[i], s->v[i] = theta[i] / h;
    memcpy(sum, half, (size_t)nv * sizeof *sum);
    sym_unroll(s, sum);
    sym_retract(s, r->q, sum, s->q);
    *s->t = r->t + 0.5 * h;
    if (sym_inputs(s) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->momentum);
    ++r->evaluations;
    sym_tangent_transposed(s, half, 1.0, 0, s->momentum.out[1], force, once, twice);
    for (i = 0; i < nv; ++i) sum[i] = s->momentum.out[0][i] - 0.5 * h * force[i];
    sym_tangent_transposed(s, theta, 1.0, 1, sum, start, once, twice);
    sym_tangent_transposed(s, half, -1.0, 0, s->momentum.out[1], force, once, twice);
    for (i = 0; i < nv; ++i) sum[i] = s->momentum.out[0][i] + 0.5 * h * force[i];
    sym_tangent_transposed(s, theta, -1.0, 1, sum, end, once, twice);
    return sym_finite(nv, start) && sym_finite(nv, end) ? 0 : SYM_DIVERGED;
}

/* theta with the momentum at the start of the step as it is; then the speeds that the momentum at its end stands for. */
static int32_t sym_variational_step(sym_run *r, double h, double *y1, double *rest) {
    enum { LONGEST = 50 };
    sym_scene *s = r->scene;
    const int32_t nv = s->nv;
    sym_scratch w = sym_scratch_of(r, rest);
    double *start = w.slope_t, *end = start + nv, *given = w.held, *work = w.u;
    int32_t i, j, k, status, rank = 0;
    sym_here(r);
    if (sym_inputs(s) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->momentum);
    memcpy(given, s->momentum.out[0], (size_t)nv * sizeof *given);
    for (i = 0; i < nv; ++i) y1[i] = h * r->v[i];
    for (k = 0; k < LONGEST; ++k) {
        double change = 0.0, extent = 0.0;
        status = sym_momenta(r, h, y1, start, end, work);
        if (status != 0) return status;
        if (k == 0 || k == 8 || k == 20) {
            const double *M = s->terms.out[0], *R_q = s->terms.out[2], *R_v = s->terms.out[3];
            memset(s->a, 0, (size_t)nv * sizeof *s->a);
            status = sym_terms(r);
            if (status != 0) return status;
            for (i = 0; i < nv; ++i)
                for (j = 0; j < nv; ++j) {
                    const size_t at = (size_t)i * nv + j;
                    w.matrix[at] = M[at] / h + 0.5 * R_v[at] + 0.25 * h * R_q[at];
                }
            rank = sym_eliminate(nv, w.matrix, r->pivots, r->pivots + nv);
            if (rank < nv) return SYM_NO_MOTION;
        }
        for (i = 0; i < nv; ++i) w.right[i] = given[i] - start[i];
        sym_solve(nv, rank, w.matrix, r->pivots, r->pivots + nv, w.right, w.found, w.work);
        if (!sym_finite(nv, w.found)) return SYM_DIVERGED;
        for (i = 0; i < nv; ++i) {
            y1[i] += w.found[i];
            change = fabs(w.found[i]) > change ? fabs(w.found[i]) : change;
            extent = fabs(y1[i]) > extent ? fabs(y1[i]) : extent;
        }
        if (change <= r->tolerance * extent + 1e-300) break;
    }
    if (k == LONGEST) return SYM_NO_CONVERGENCE;
    status = sym_momenta(r, h, y1, start, end, work);
    if (status != 0) return status;
    sym_unroll(s, y1);
    sym_retract(s, r->q, y1, s->q);
    *s->t = r->t + h;
    sym_evaluate(&s->momentum); /* for M at the end of the step */
    memcpy(w.matrix, s->momentum.out[2], (size_t)nv * nv * sizeof(double));
    rank = sym_eliminate(nv, w.matrix, r->pivots, r->pivots + nv);
    if (rank < nv) return SYM_NO_MOTION;
    sym_solve(nv, rank, w.matrix, r->pivots, r->pivots + nv, end, y1 + nv, w.work);
    return 0;
}
