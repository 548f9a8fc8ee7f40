/* Rates of an instance's state and their exact directional derivatives, for importers of FMUs. */

SYM_EXPORT int32_t sym_instance_rates(sym_instance *instance, double *rates) {
    sym_system *s = &instance->system;
    int32_t status;
    sym_instance_load_state(instance);
    sym_configuration_rate(s, instance->q, s->v, rates);
    status = sym_evaluate_acceleration(&instance->run);
    memcpy(rates + s->nq, s->a, (size_t)s->nv * sizeof *rates);
    return status;
}

/* The unit quaternion p / |p| of a quaternion of any length, and its change where that changes by dp. */
static void sym_unit_change(const double *p, const double *dp, double *unit, double *change) {
    double size = 0.0, along = 0.0;
    int32_t i;
    for (i = 0; i < 4; ++i) size += p[i] * p[i];
    size = sqrt(size);
    for (i = 0; i < 4; ++i) unit[i] = p[i] / size, along += unit[i] * dp[i];
    for (i = 0; i < 4; ++i) change[i] = (dp[i] - along * unit[i]) / size;
}

SYM_EXPORT void sym_instance_tangent(const sym_instance *instance, const double *dq, double *tangent) {
    const sym_system *s = &instance->system;
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t linear = seg->kind == SYM_SEGMENT_LINEAR ? seg->size : 0;
        const int32_t at = seg->kind == SYM_SEGMENT_POSE ? 3 : 0;
        const double *p = instance->q + seg->q + at, *dp = dq + seg->q + at;
        double *into = tangent + seg->v, unit[4], change[4], c[3];
        for (i = 0; i < linear; ++i) into[i] = dq[seg->q + i];
        if (seg->kind == SYM_SEGMENT_LINEAR) continue;
        sym_unit_change(p, dp, unit, change);
        sym_cross(unit, change, c); /* 2 conj(unit) change, its vector part */
        for (i = 0; i < 3; ++i) into[at + i] = 2.0 * (unit[3] * change[i] - change[3] * unit[i] - c[i]);
        if (seg->kind == SYM_SEGMENT_POSE) { /* a displacement in world axes, in those of the body */
            for (i = 0; i < 3; ++i) c[i] = -unit[i];
            unit[0] = c[0], unit[1] = c[1], unit[2] = c[2];
            sym_rotate(unit, dq + seg->q, into);
        }
    }
}

/* Directional derivative of N(q) v: bilinear in quaternion and speed, but for the rotation of a pose's linear velocity.
 * theta: the tangent vector of dq. */
static void sym_configuration_rate_derivative(sym_instance *instance, const double *dq, const double *dv,
                                              const double *theta, double *derivative) {
    sym_system *s = &instance->system;
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t at = seg->kind == SYM_SEGMENT_POSE ? 3 : 0;
        const double *p = instance->q + seg->q + at, *dp = dq + seg->q + at;
        const double *w = instance->v + seg->v + at, *dw = dv + seg->v + at;
        double *into = derivative + seg->q, by_p[4], by_w[4], by_R[3];
        if (seg->kind == SYM_SEGMENT_LINEAR) {
            memcpy(into, dv + seg->v, (size_t)seg->size * sizeof *into);
            continue;
        }
        sym_quaternion_rate(dp, w, by_p);
        sym_quaternion_rate(p, dw, by_w);
        for (i = 0; i < 4; ++i) into[at + i] = by_p[i] + by_w[i];
        if (seg->kind == SYM_SEGMENT_POSE) { /* d(R v) = R (theta x v + dv) */
            sym_cross(theta + seg->v + 3, instance->v + seg->v, by_R);
            for (i = 0; i < 3; ++i) by_R[i] += dv[seg->v + i];
            sym_rotate(s->q + seg->q + 3, by_R, into);
        }
    }
}

typedef struct sym_differentiate_workspace { /* n = nv + nc */
    double *matrix;                     /* (n, n) */
    double *scale;                      /* (n) */
    double *right, *solution, *scratch; /* (n) */
    double *theta;                      /* (nv) */
    double *du;                         /* (nu) */
} sym_differentiate_workspace;

static sym_differentiate_workspace sym_allocate_differentiate_workspace(const sym_instance *instance,
                                                                        sym_arena *arena) {
    const size_t nv = (size_t)instance->model->nv, n = nv + (size_t)instance->model->nc;
    sym_differentiate_workspace w;
    w.matrix = sym_allocate(arena, n * n), w.scale = sym_allocate(arena, n);
    w.right = sym_allocate(arena, n), w.solution = sym_allocate(arena, n);
    w.scratch = sym_allocate(arena, n), w.theta = sym_allocate(arena, nv);
    w.du = sym_allocate(arena, (size_t)instance->model->nu);
    return w;
}

SYM_EXPORT size_t sym_instance_differentiate_size(const sym_instance *instance) {
    sym_arena arena = {NULL, 0};
    sym_allocate_differentiate_workspace(instance, &arena);
    return arena.used;
}

SYM_EXPORT int32_t sym_instance_differentiate(sym_instance *instance, const double *dq, const double *dv,
                                              const double *du, double *rates, double *lam, double *work) {
    sym_system *s = &instance->system;
    int32_t *pivots = instance->run.pivots;
    const double *const *terms = (const double *const *)s->implicit_terms.out;
    const double *M = terms[SYM_TERM_M], *G = terms[SYM_TERM_G], *R_q = terms[SYM_TERM_R_Q];
    const double *R_v = terms[SYM_TERM_R_V], *R_u = terms[SYM_TERM_R_U], *rate_q = terms[SYM_TERM_RATE_Q];
    const int32_t nv = s->nv, nc = s->nc, nu = s->nu, n = nv + nc;
    sym_arena arena = {NULL, 0};
    sym_differentiate_workspace w;
    int32_t i, j, rank;
    if (s->implicit_terms.function == NULL) return SYM_SINGULAR;
    arena.base = work;
    w = sym_allocate_differentiate_workspace(instance, &arena);
    memcpy(w.du, du, (size_t)nu * sizeof *du);
    for (i = 0; i < s->n_quaternion_inputs; ++i) {
        const int32_t at = s->quaternion_inputs[i];
        double unit[4];
        sym_unit_change(instance->u + at, du + at, unit, w.du + at);
    }
    sym_instance_tangent(instance, dq, w.theta);
    sym_configuration_rate_derivative(instance, dq, dv, w.theta, rates);
    sym_evaluate(&s->implicit_terms);
    for (i = 0; i < n; ++i) {
        double sum = 0.0;
        for (j = 0; j < nv; ++j) sum -= R_q[SYM_INDEX(i, nv, j)] * w.theta[j] + R_v[SYM_INDEX(i, nv, j)] * dv[j];
        for (j = 0; j < nu; ++j) sum -= R_u[SYM_INDEX(i, nu, j)] * w.du[j];
        w.right[i] = sum;
        for (j = 0; j < nv; ++j)
            w.matrix[SYM_INDEX(i, n, j)] = i < nv ? M[SYM_INDEX(i, nv, j)] : G[SYM_INDEX(i - nv, nv, j)];
        for (j = nv; j < n; ++j) w.matrix[SYM_INDEX(i, n, j)] = i < nv ? -G[SYM_INDEX(j - nv, nv, i)] : 0.0;
    }
    for (i = 0; i < nc; ++i) { /* derivatives of Baumgarte's terms */
        const double alpha = s->gains[i], beta = s->gains[nc + i];
        double by_rate = 0.0, by_phi = 0.0;
        for (j = 0; j < nv; ++j) {
            by_rate += rate_q[SYM_INDEX(i, nv, j)] * w.theta[j] + G[SYM_INDEX(i, nv, j)] * dv[j];
            by_phi += G[SYM_INDEX(i, nv, j)] * w.theta[j];
        }
        w.right[nv + i] -= 2.0 * alpha * by_rate + (s->on_speeds[i] ? 0.0 : beta * beta * by_phi);
    }
    rank = sym_eliminate(nv, n, s->group, nc > 0 ? nv + (int32_t)*s->rank : nv, w.matrix, w.scale, pivots, pivots + n);
    if (rank < nv) return SYM_SINGULAR;
    sym_solve(n, rank, w.matrix, w.scale, pivots, pivots + n, w.right, w.solution, w.scratch);
    memcpy(rates + s->nq, w.solution, (size_t)nv * sizeof *rates);
    memcpy(lam, w.solution + nv, (size_t)nc * sizeof *lam);
    return 0;
}
