/* Methods that solve for the accelerations or the displacement of a step: generalized alpha and the variational midpoint
 * rule (docs/theory/simulation.md, sections 4 and 5; numbers in parentheses are its equations). */

/* Residuals at the evaluation point: R (nv), phi (nc), G v - b (nc). Returns 0 or a status. */
static int32_t sym_evaluate_residual(sym_run *r) {
    sym_system *s = r->system;
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->residual);
    ++r->evaluations;
    return sym_all_finite(s->nv, s->residual.out[0]) && sym_all_finite(s->nc, s->residual.out[1]) ? 0 : SYM_DIVERGED;
}

/* Generalized alpha: (7) for a and lam at the end of the step by modified Newton iteration, with (6) for theta and v.
 * history: the smoothed acceleration s_0, which the step replaces by s_1; and a_0. Returns 0 or a status. */
static int32_t sym_generalized_alpha_step(sym_run *r, sym_workspace *memory, double h) {
    enum { MAX_ITERATIONS = 25 };
    sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const double rho = r->spectral_radius, alpha_m = (2.0 * rho - 1.0) / (rho + 1.0), alpha_f = rho / (rho + 1.0);
    const double gamma = 0.5 + alpha_f - alpha_m, beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
    const double share = (1.0 - alpha_f) / (1.0 - alpha_m); /* d s_1 / d a_1 */
    const double by_q = h * h * beta * share, by_v = h * gamma * share; /* h^2 beta', h gamma' */
    const sym_implicit_workspace w = memory->implicit;
    double *y1 = memory->y1, *smooth = w.history, *a0 = w.history + nv, *smooth1 = w.time_slope;
    int32_t i, j, k, status, rank = 0;
    if (r->steps == 0) memcpy(smooth, s->a, (size_t)nv * sizeof *smooth);
    /* s->a, s->lam: those of the present state, and the initial guess of those at the end of the step. */
    memcpy(a0, s->a, (size_t)nv * sizeof *a0);
    for (k = 0; k < MAX_ITERATIONS; ++k) {
        double change = 0.0, speed = 0.0, largest_q = 0.0;
        for (i = 0; i < nv; ++i) {
            smooth1[i] = ((1.0 - alpha_f) * s->a[i] + alpha_f * a0[i] - alpha_m * smooth[i]) / (1.0 - alpha_m);
            y1[i] = h * r->v[i] + h * h * ((0.5 - beta) * smooth[i] + beta * smooth1[i]);
            y1[nv + i] = r->v[i] + h * ((1.0 - gamma) * smooth[i] + gamma * smooth1[i]);
        }
        sym_twist_to_displacement(s, y1);
        sym_retract(s, r->q, y1, s->q);
        memcpy(s->v, y1 + nv, (size_t)nv * sizeof *y1);
        *s->t = r->t + h;
        status = sym_evaluate_residual(r);
        if (status != 0) return status;
        if (k == 0 || k == 4 || k == 12) { /* modified Newton: a new matrix only where convergence is slow */
            const double *const *terms = (const double *const *)s->implicit_terms.out;
            const double *M = terms[SYM_TERM_M], *G = terms[SYM_TERM_G];
            const double *R_q = terms[SYM_TERM_R_Q], *R_v = terms[SYM_TERM_R_V], *rate_q = terms[SYM_TERM_RATE_Q];
            status = sym_evaluate_jacobian(r);
            if (status != 0) return status;
            for (i = 0; i < nv; ++i) {
                for (j = 0; j < nv; ++j) {
                    const size_t at = (size_t)i * nv + j;
                    w.matrix[(size_t)i * n + j] = M[at] + by_v * R_v[at] + by_q * R_q[at];
                }
                for (j = 0; j < nc; ++j) w.matrix[(size_t)i * n + nv + j] = -G[(size_t)j * nv + i];
            }
            for (i = 0; i < nc; ++i) {
                for (j = 0; j < nv; ++j) {
                    const double g = G[(size_t)i * nv + j], by_rate = by_q / by_v * rate_q[(size_t)i * nv + j];
                    w.matrix[(size_t)(nv + i) * n + j] = s->on_speeds[i] ? g + by_rate : g;
                }
                for (j = 0; j < nc; ++j) w.matrix[(size_t)(nv + i) * n + nv + j] = 0.0;
            }
            rank = sym_eliminate(n, w.matrix, r->pivots, r->pivots + n);
            if (rank < nv) return SYM_SINGULAR;
        }
        for (i = 0; i < nv; ++i) w.right[i] = -s->residual.out[0][i];
        for (i = 0; i < nc; ++i)
            w.right[nv + i] = s->on_speeds[i] ? -s->residual.out[2][i] / by_v : -s->residual.out[1][i] / by_q;
        sym_solve(n, rank, w.matrix, r->pivots, r->pivots + n, w.right, w.solution, w.scratch);
        for (i = 0; i < nv; ++i) {
            s->a[i] += w.solution[i];
            change = fabs(w.solution[i]) * by_v > change ? fabs(w.solution[i]) * by_v : change;
            speed = fabs(y1[nv + i]) > speed ? fabs(y1[nv + i]) : speed;
        }
        for (i = 0; i < nc; ++i) s->lam[i] += w.solution[nv + i];
        for (i = 0; i < s->nq; ++i) largest_q = fabs(s->q[i]) > largest_q ? fabs(s->q[i]) : largest_q;
        if (!sym_all_finite(n, w.solution)) return SYM_DIVERGED;
        /* phi is known to some rounding errors of q, hence the speeds to those over h. */
        if (change <= r->newton_tolerance * (1.0 + speed) + (nc > 0 ? 1e-15 * (1.0 + largest_q) / h : 0.0)) {
            memcpy(smooth, smooth1, (size_t)nv * sizeof *smooth);
            return 0;
        }
    }
    return SYM_NO_CONVERGENCE;
}

/* out = ad(theta)^T p, with ad(theta) x the commutator of the twists theta and x, segment by segment; zero for linear
 * coordinates, which commute. */
static void sym_adjoint_transposed(const sym_system *s, const double *theta, const double *p, double *out) {
    int32_t k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t i = seg->v;
        double c[3];
        int32_t l;
        if (seg->kind == SYM_SEGMENT_LINEAR) {
            for (l = 0; l < seg->size; ++l) out[i + l] = 0.0;
        } else if (seg->kind == SYM_SEGMENT_QUATERNION) { /* ad^T p = -w x p */
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

/* The tangent maps of (8), transposed, by their series in ad = ad(theta), cut after the sixth power:
 *     out = dexp_(sign theta)^T p     = sum_k sign^k (ad^T)^k p / (k + 1)!             where inverse is 0
 *     out = dexpinv_(sign theta)^T p  = sum_k sign^k B_k (ad^T)^k p / k!, B_1 = -1/2   where inverse is 1
 * Exact to rounding for |theta| < 0.1. power, next: work (nv) each. */
static void sym_tangent_transposed(const sym_system *s, const double *theta, double sign, int32_t inverse,
                                   const double *p, double *out, double *power, double *next) {
    /* |B_k| / k! with the sign of B_k, but for k = 1, and 1 / (k + 1)! */
    static const double bernoulli[7] = {1.0, 0.5, 1.0 / 12.0, 0.0, -1.0 / 720.0, 0.0, 1.0 / 30240.0};
    static const double factorial[7] = {1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0};
    int32_t k, i;
    memcpy(power, p, (size_t)s->nv * sizeof *power);
    memcpy(out, p, (size_t)s->nv * sizeof *out);
    for (k = 1; k < 7; ++k) {
        const double sign_k = k % 2 ? sign : 1.0; /* B_k = 0 for odd k > 1 */
        const double c = inverse ? (k == 1 ? -sign_k * bernoulli[1] : bernoulli[k]) : sign_k * factorial[k];
        sym_adjoint_transposed(s, theta, power, next);
        memcpy(power, next, (size_t)s->nv * sizeof *power);
        for (i = 0; i < s->nv; ++i) out[i] += c * power[i];
    }
}

/* The discrete momenta (8) at both ends of a step by theta: start = mu_0, end = mu_1. p and F are evaluated at the middle
 * of the step, q_0 (+) theta/2, with v = theta/h. work: 5 nv. Returns 0 or a status. */
static int32_t sym_discrete_momenta(sym_run *r, double h, const double *theta, double *start, double *end, double *work) {
    sym_system *s = r->system;
    const int32_t nv = s->nv;
    const double *p = s->momentum.out[0], *F = s->momentum.out[1];
    double *half = work, *force = half + nv, *power = force + nv, *next = power + nv, *sum = next + nv;
    int32_t i;
    for (i = 0; i < nv; ++i) half[i] = 0.5 * theta[i], s->v[i] = theta[i] / h;
    memcpy(sum, half, (size_t)nv * sizeof *sum);
    sym_twist_to_displacement(s, sum);
    sym_retract(s, r->q, sum, s->q);
    *s->t = r->t + 0.5 * h;
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->momentum);
    ++r->evaluations;
    /* mu_0 = dexpinv_theta^T (p - h/2 dexp_(theta/2)^T F) */
    sym_tangent_transposed(s, half, 1.0, 0, F, force, power, next);
    for (i = 0; i < nv; ++i) sum[i] = p[i] - 0.5 * h * force[i];
    sym_tangent_transposed(s, theta, 1.0, 1, sum, start, power, next);
    /* mu_1 = dexpinv_(-theta)^T (p + h/2 dexp_(-theta/2)^T F) */
    sym_tangent_transposed(s, half, -1.0, 0, F, force, power, next);
    for (i = 0; i < nv; ++i) sum[i] = p[i] + 0.5 * h * force[i];
    sym_tangent_transposed(s, theta, -1.0, 1, sum, end, power, next);
    return sym_all_finite(nv, start) && sym_all_finite(nv, end) ? 0 : SYM_DIVERGED;
}

/* The variational midpoint rule: theta from mu_0(theta) = M(q_0) v_0 by modified Newton iteration, with the Jacobian
 * M/h + R_v/2 + (h/4) R_q of mu_0 to leading order; then v_1 = M(q_1)^-1 mu_1. Returns 0 or a status. */
static int32_t sym_variational_step(sym_run *r, sym_workspace *memory, double h) {
    enum { MAX_ITERATIONS = 50 };
    sym_system *s = r->system;
    const int32_t nv = s->nv;
    const sym_implicit_workspace w = memory->implicit;
    double *y1 = memory->y1, *start = w.time_slope, *end = start + nv, *p0 = w.history, *work = w.stages;
    int32_t i, j, k, status, rank = 0;
    sym_load_state(r);
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->momentum);
    memcpy(p0, s->momentum.out[0], (size_t)nv * sizeof *p0); /* M(q_0) v_0 */
    for (i = 0; i < nv; ++i) y1[i] = h * r->v[i]; /* theta, until it has converged */
    for (k = 0; k < MAX_ITERATIONS; ++k) {
        double change = 0.0, extent = 0.0;
        status = sym_discrete_momenta(r, h, y1, start, end, work);
        if (status != 0) return status;
        if (k == 0 || k == 8 || k == 20) {
            const double *const *terms = (const double *const *)s->implicit_terms.out;
            const double *M = terms[SYM_TERM_M], *R_q = terms[SYM_TERM_R_Q], *R_v = terms[SYM_TERM_R_V];
            memset(s->a, 0, (size_t)nv * sizeof *s->a);
            status = sym_evaluate_jacobian(r);
            if (status != 0) return status;
            for (i = 0; i < nv; ++i)
                for (j = 0; j < nv; ++j) {
                    const size_t at = (size_t)i * nv + j;
                    w.matrix[at] = M[at] / h + 0.5 * R_v[at] + 0.25 * h * R_q[at];
                }
            rank = sym_eliminate(nv, w.matrix, r->pivots, r->pivots + nv);
            if (rank < nv) return SYM_SINGULAR;
        }
        for (i = 0; i < nv; ++i) w.right[i] = p0[i] - start[i];
        sym_solve(nv, rank, w.matrix, r->pivots, r->pivots + nv, w.right, w.solution, w.scratch);
        if (!sym_all_finite(nv, w.solution)) return SYM_DIVERGED;
        for (i = 0; i < nv; ++i) {
            y1[i] += w.solution[i];
            change = fabs(w.solution[i]) > change ? fabs(w.solution[i]) : change;
            extent = fabs(y1[i]) > extent ? fabs(y1[i]) : extent;
        }
        if (change <= r->newton_tolerance * extent + 1e-300) break;
    }
    if (k == MAX_ITERATIONS) return SYM_NO_CONVERGENCE;
    status = sym_discrete_momenta(r, h, y1, start, end, work);
    if (status != 0) return status;
    sym_twist_to_displacement(s, y1);
    sym_retract(s, r->q, y1, s->q);
    *s->t = r->t + h;
    sym_evaluate(&s->momentum); /* for M at the end of the step */
    memcpy(w.matrix, s->momentum.out[2], (size_t)nv * nv * sizeof(double));
    rank = sym_eliminate(nv, w.matrix, r->pivots, r->pivots + nv);
    if (rank < nv) return SYM_SINGULAR;
    sym_solve(nv, rank, w.matrix, r->pivots, r->pivots + nv, end, y1 + nv, w.scratch);
    return 0;
}
