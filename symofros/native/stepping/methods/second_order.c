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

static double sym_largest(int32_t n, const double *x) {
    double largest = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) largest = fabs(x[i]) > largest ? fabs(x[i]) : largest;
    return largest;
}

/* The equations of one implicit step in unknowns x (n), of which the first nv say how far a correction moves: */
typedef struct sym_step_equations {
    int32_t n;
    double h;
    /* Minus the residual at x -> w.right, and y1 of x. Returns 0 or a status. */
    int32_t (*residual)(sym_run *r, sym_workspace *memory, double h, const double *x);
    /* Factors of the Jacobian at the x of the last residual. Returns its rank, or a status below 0. */
    int32_t (*factor)(sym_run *r, sym_workspace *memory, double h);
    /* Size of a correction (n), and the size that counts as rounding at the x of the last residual. */
    double (*size)(const sym_run *r, double h, const double *correction);
    double (*rounding)(const sym_run *r, const sym_workspace *memory, double h);
} sym_step_equations;

/* Modified Newton iteration from x, with a new matrix at iterations `again` only. Returns 0 or a status. */
static int32_t sym_modified_newton(sym_run *r, sym_workspace *memory, const sym_step_equations *e, double *x,
                                   int32_t most, const int32_t again[3]) {
    const sym_implicit_workspace w = memory->implicit;
    int32_t i, k, rank = 0;
    for (k = 0; k < most; ++k) {
        int32_t status = e->residual(r, memory, e->h, x);
        if (status != 0) return status;
        if (k == again[0] || k == again[1] || k == again[2]) {
            rank = e->factor(r, memory, e->h);
            if (rank < r->system->nv) return rank < 0 ? rank : SYM_SINGULAR;
        }
        sym_solve(e->n, rank, w.matrix, w.scale, r->pivots, r->pivots + e->n, w.right, w.solution, w.scratch);
        if (!sym_all_finite(e->n, w.solution)) return SYM_DIVERGED;
        for (i = 0; i < e->n; ++i) x[i] += w.solution[i];
        if (e->size(r, e->h, w.solution) <= e->rounding(r, memory, e->h)) return 0;
    }
    return SYM_NO_CONVERGENCE;
}

/* Newton iteration with damping from x, for forces that change within a step, such as friction through zero speed: each
 * correction is halved until the next one by the same matrix is smaller (Deuflhard's natural monotonicity test, which
 * knows no units). Returns 0 or a status. */
static int32_t sym_damped_newton(sym_run *r, sym_workspace *memory, const sym_step_equations *e, double *x) {
    enum { MAX_ITERATIONS = 100, MAX_HALVINGS = 40 };
    const sym_implicit_workspace w = memory->implicit;
    int32_t i, k, halvings;
    for (k = 0; k < MAX_ITERATIONS; ++k) {
        double share = 1.0, size;
        int32_t rank, status = e->residual(r, memory, e->h, x);
        if (status != 0) return status;
        rank = e->factor(r, memory, e->h);
        if (rank < r->system->nv) return rank < 0 ? rank : SYM_SINGULAR;
        sym_solve(e->n, rank, w.matrix, w.scale, r->pivots, r->pivots + e->n, w.right, w.correction, w.scratch);
        if (!sym_all_finite(e->n, w.correction)) return SYM_DIVERGED;
        size = e->size(r, e->h, w.correction);
        if (size <= e->rounding(r, memory, e->h)) {
            for (i = 0; i < e->n; ++i) x[i] += w.correction[i];
            return 0;
        }
        for (halvings = 0; halvings < MAX_HALVINGS; ++halvings, share *= 0.5) {
            for (i = 0; i < e->n; ++i) w.tried[i] = x[i] + share * w.correction[i];
            if (e->residual(r, memory, e->h, w.tried) != 0) continue;
            sym_solve(e->n, rank, w.matrix, w.scale, r->pivots, r->pivots + e->n, w.right, w.solution, w.scratch);
            if (e->size(r, e->h, w.solution) <= (1.0 - 0.25 * share) * size) break;
        }
        if (halvings == MAX_HALVINGS) return SYM_NO_CONVERGENCE;
        memcpy(x, w.tried, (size_t)e->n * sizeof *x);
    }
    return SYM_NO_CONVERGENCE;
}

/* Constants of generalized alpha for a step h: of (6), and h^2 beta', h gamma'. */
typedef struct sym_alpha {
    double alpha_m, alpha_f, gamma, beta, by_q, by_v;
} sym_alpha;

static sym_alpha sym_alpha_of(const sym_run *r, double h) {
    const double rho = r->spectral_radius;
    sym_alpha c;
    double share; /* d s_1 / d a_1 */
    c.alpha_m = (2.0 * rho - 1.0) / (rho + 1.0), c.alpha_f = rho / (rho + 1.0);
    c.gamma = 0.5 + c.alpha_f - c.alpha_m, c.beta = 0.25 * (c.gamma + 0.5) * (c.gamma + 0.5);
    share = (1.0 - c.alpha_f) / (1.0 - c.alpha_m);
    c.by_q = h * h * c.beta * share, c.by_v = h * c.gamma * share;
    return c;
}

static int32_t sym_alpha_residual(sym_run *r, sym_workspace *memory, double h, const double *x) {
    sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc;
    const sym_alpha c = sym_alpha_of(r, h);
    const sym_implicit_workspace w = memory->implicit;
    const double *smooth = w.history, *a0 = w.history + nv;
    double *y1 = memory->y1, *smooth1 = w.time_slope;
    int32_t i, status;
    memcpy(s->a, x, (size_t)nv * sizeof *x), memcpy(s->lam, x + nv, (size_t)nc * sizeof *x);
    for (i = 0; i < nv; ++i) {
        smooth1[i] = ((1.0 - c.alpha_f) * s->a[i] + c.alpha_f * a0[i] - c.alpha_m * smooth[i]) / (1.0 - c.alpha_m);
        y1[i] = h * r->v[i] + h * h * ((0.5 - c.beta) * smooth[i] + c.beta * smooth1[i]);
        y1[nv + i] = r->v[i] + h * ((1.0 - c.gamma) * smooth[i] + c.gamma * smooth1[i]);
    }
    sym_twist_to_displacement(s, y1);
    sym_retract(s, r->q, y1, s->q);
    memcpy(s->v, y1 + nv, (size_t)nv * sizeof *y1);
    *s->t = sym_stage_time(s, r->t + h);
    status = sym_evaluate_residual(r);
    if (status != 0) return status;
    for (i = 0; i < nv; ++i) w.right[i] = -s->residual.out[0][i];
    for (i = 0; i < nc; ++i)
        w.right[nv + i] = s->on_speeds[i] ? -s->residual.out[2][i] / c.by_v : -s->residual.out[1][i] / c.by_q;
    return 0;
}

static int32_t sym_alpha_factor(sym_run *r, sym_workspace *memory, double h) {
    sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc, n = nv + nc;
    const sym_alpha c = sym_alpha_of(r, h);
    const sym_implicit_workspace w = memory->implicit;
    const double *const *terms = (const double *const *)s->implicit_terms.out;
    const double *M = terms[SYM_TERM_M], *G = terms[SYM_TERM_G];
    const double *R_q = terms[SYM_TERM_R_Q], *R_v = terms[SYM_TERM_R_V], *rate_q = terms[SYM_TERM_RATE_Q];
    const int32_t status = sym_evaluate_jacobian(r);
    int32_t i, j;
    if (status != 0) return status;
    for (i = 0; i < nv; ++i) {
        for (j = 0; j < nv; ++j) {
            const size_t at = SYM_INDEX(i, nv, j);
            w.matrix[SYM_INDEX(i, n, j)] = M[at] + c.by_v * R_v[at] + c.by_q * R_q[at];
        }
        for (j = 0; j < nc; ++j) w.matrix[SYM_INDEX(i, n, nv + j)] = -G[SYM_INDEX(j, nv, i)];
    }
    for (i = 0; i < nc; ++i) {
        for (j = 0; j < nv; ++j) {
            const double g = G[SYM_INDEX(i, nv, j)], by_rate = c.by_q / c.by_v * rate_q[SYM_INDEX(i, nv, j)];
            w.matrix[SYM_INDEX(nv + i, n, j)] = s->on_speeds[i] ? g + by_rate : g;
        }
        for (j = 0; j < nc; ++j) w.matrix[SYM_INDEX(nv + i, n, nv + j)] = 0.0;
    }
    return sym_eliminate(nv, n, s->group, nv + r->rank, w.matrix, w.scale, r->pivots, r->pivots + n);
}

/* The change of speeds. */
static double sym_alpha_size(const sym_run *r, double h, const double *correction) {
    return sym_alpha_of(r, h).by_v * sym_largest(r->system->nv, correction);
}

/* phi is known to some rounding errors of q, hence the speeds to those over h. */
static double sym_alpha_rounding(const sym_run *r, const sym_workspace *memory, double h) {
    const sym_system *s = r->system;
    const double speed = sym_largest(s->nv, memory->y1 + s->nv), largest_q = sym_largest(s->nq, s->q);
    return r->newton_tolerance * (1.0 + speed) + (s->nc > 0 ? 1e-15 * (1.0 + largest_q) / h : 0.0);
}

/* Generalized alpha: (7) for a and lam at the end of the step by Newton iteration, with (6) for theta and v.
 * history: the smoothed acceleration s_0, which the step replaces by s_1; and a_0. Returns 0 or a status. */
static int32_t sym_generalized_alpha_step(sym_run *r, sym_workspace *memory, double h) {
    static const int32_t again[3] = {0, 4, 12}; /* a new matrix only where convergence is slow */
    sym_system *s = r->system;
    const int32_t nv = s->nv, nc = s->nc;
    const sym_implicit_workspace w = memory->implicit;
    sym_step_equations e;
    double *x = w.unknowns, *guess = x + nv + nc;
    int32_t i, status;
    e.n = nv + nc, e.h = h, e.residual = sym_alpha_residual, e.factor = sym_alpha_factor;
    e.size = sym_alpha_size, e.rounding = sym_alpha_rounding;
    if (r->steps <= r->n_from || sym_changes_at(s, r->t)) memcpy(w.history, s->a, (size_t)nv * sizeof *w.history);
    /* s->a, s->lam: those of the present state, and the initial guess of those at the end of the step. */
    memcpy(w.history + nv, s->a, (size_t)nv * sizeof *w.history);
    memcpy(guess, s->a, (size_t)nv * sizeof *x), memcpy(guess + nv, s->lam, (size_t)nc * sizeof *x);
    memcpy(x, guess, (size_t)e.n * sizeof *x);
    status = sym_modified_newton(r, memory, &e, x, 25, again);
    if (status == SYM_NO_CONVERGENCE) {
        memcpy(x, guess, (size_t)e.n * sizeof *x);
        status = sym_damped_newton(r, memory, &e, x);
    }
    if (status == SYM_NO_CONVERGENCE) { /* from a stop: a force that falls with speed has solutions on either side */
        memcpy(x, guess, (size_t)e.n * sizeof *x);
        status = sym_alpha_residual(r, memory, h, x);
        if (status != 0) return status;
        for (i = 0; i < nv; ++i) x[i] -= memory->y1[nv + i] / sym_alpha_of(r, h).by_v;
        status = sym_damped_newton(r, memory, &e, x);
    }
    if (status != 0) return status;
    memcpy(s->a, x, (size_t)nv * sizeof *x), memcpy(s->lam, x + nv, (size_t)nc * sizeof *x);
    memcpy(w.history, w.time_slope, (size_t)nv * sizeof *w.history);
    return 0;
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
    *s->t = sym_stage_time(s, r->t + 0.5 * h);
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

static int32_t sym_variational_residual(sym_run *r, sym_workspace *memory, double h, const double *x) {
    const int32_t nv = r->system->nv;
    const sym_implicit_workspace w = memory->implicit;
    double *start = w.time_slope;
    int32_t i, status;
    memcpy(memory->y1, x, (size_t)nv * sizeof *x);
    status = sym_discrete_momenta(r, h, memory->y1, start, start + nv, w.stages);
    if (status != 0) return status;
    for (i = 0; i < nv; ++i) w.right[i] = w.history[i] - start[i];
    return 0;
}

/* The Jacobian M/h + R_v/2 + (h/4) R_q of mu_0, to leading order. */
static int32_t sym_variational_factor(sym_run *r, sym_workspace *memory, double h) {
    sym_system *s = r->system;
    const int32_t nv = s->nv;
    const sym_implicit_workspace w = memory->implicit;
    const double *const *terms = (const double *const *)s->implicit_terms.out;
    const double *M = terms[SYM_TERM_M], *R_q = terms[SYM_TERM_R_Q], *R_v = terms[SYM_TERM_R_V];
    int32_t status, i;
    memset(s->a, 0, (size_t)nv * sizeof *s->a);
    status = sym_evaluate_jacobian(r);
    if (status != 0) return status;
    for (i = 0; i < nv * nv; ++i) w.matrix[i] = M[i] / h + 0.5 * R_v[i] + 0.25 * h * R_q[i];
    return sym_eliminate(nv, nv, NULL, nv, w.matrix, w.scale, r->pivots, r->pivots + nv);
}

static double sym_variational_size(const sym_run *r, double h, const double *correction) {
    (void)h;
    return sym_largest(r->system->nv, correction);
}

static double sym_variational_rounding(const sym_run *r, const sym_workspace *memory, double h) {
    (void)h;
    return r->newton_tolerance * sym_largest(r->system->nv, memory->y1) + 1e-300;
}

/* The variational midpoint rule: theta from mu_0(theta) = M(q_0) v_0 by Newton iteration; then
 * v_1 = M(q_1)^-1 mu_1. Returns 0 or a status. */
static int32_t sym_variational_step(sym_run *r, sym_workspace *memory, double h) {
    static const int32_t again[3] = {0, 8, 20};
    sym_system *s = r->system;
    const int32_t nv = s->nv;
    const sym_implicit_workspace w = memory->implicit;
    double *y1 = memory->y1, *start = w.time_slope, *end = start + nv, *x = w.unknowns;
    sym_step_equations e;
    int32_t i, status, rank;
    e.n = nv, e.h = h, e.residual = sym_variational_residual, e.factor = sym_variational_factor;
    e.size = sym_variational_size, e.rounding = sym_variational_rounding;
    sym_load_state(r);
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->momentum);
    memcpy(w.history, s->momentum.out[0], (size_t)nv * sizeof *w.history); /* M(q_0) v_0 */
    for (i = 0; i < nv; ++i) x[i] = h * r->v[i]; /* theta, until it has converged */
    status = sym_modified_newton(r, memory, &e, x, 50, again);
    if (status == SYM_NO_CONVERGENCE) {
        for (i = 0; i < nv; ++i) x[i] = h * r->v[i];
        status = sym_damped_newton(r, memory, &e, x);
    }
    if (status == SYM_NO_CONVERGENCE) { /* from a stop, as above */
        memset(x, 0, (size_t)nv * sizeof *x);
        status = sym_damped_newton(r, memory, &e, x);
    }
    if (status != 0) return status;
    memcpy(y1, x, (size_t)nv * sizeof *x);
    status = sym_discrete_momenta(r, h, y1, start, end, w.stages);
    if (status != 0) return status;
    sym_twist_to_displacement(s, y1);
    sym_retract(s, r->q, y1, s->q);
    *s->t = sym_stage_time(s, r->t + h);
    sym_evaluate(&s->momentum); /* for M at the end of the step */
    memcpy(w.matrix, s->momentum.out[2], (size_t)nv * (size_t)nv * sizeof(double));
    rank = sym_eliminate(nv, nv, NULL, nv, w.matrix, w.scale, r->pivots, r->pivots + nv);
    if (rank < nv) return SYM_SINGULAR;
    sym_solve(nv, rank, w.matrix, w.scale, r->pivots, r->pivots + nv, end, y1 + nv, w.scratch);
    return 0;
}
