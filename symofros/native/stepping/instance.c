/* Instances: symofros_instance.h. */

typedef struct sym_cursor { /* through the memory; base NULL: only counts */
    double *base;
    size_t used;
} sym_cursor;

static double *sym_take(sym_cursor *at, size_t n) {
    double *found = at->base == NULL ? NULL : at->base + at->used;
    at->used += n > 0 ? n : 1;
    return found;
}

/* A function of the model as a call at the scene's point; outputs that are not placed get memory of their own. */
static int32_t sym_install(sym_instance *it, sym_cursor *at, sym_call *call, const char *name, double *const *placed) {
    int32_t i;
    call->function = sym_find(it->model, name, NULL);
    if (call->function == NULL) return 0;
    call->pre = it->pre, call->work = it->work;
    if (call->function->n_out > 8) return 0;
    for (i = 0; i < call->function->n_out; ++i) {
        const sym_array *out = &call->function->out[i];
        call->out[i] = placed != NULL ? placed[i] : sym_take(at, (size_t)out->rows * (size_t)out->cols);
    }
    return at->base == NULL || sym_bind(&it->scene, call);
}

/* Every array of the instance; 0 where the model lacks a function that its method calls. */
static int32_t sym_furnish(sym_instance *it, sym_cursor *at) {
    const sym_model *m = it->model;
    const sym_plant *p = it->plant;
    sym_scene *s = &it->scene;
    sym_run *r = &it->run;
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv, nu = (size_t)m->nu, nc = (size_t)m->nc;
    double *solved[3];
    int32_t ok;
    memset(s, 0, sizeof *s), memset(r, 0, sizeof *r);
    s->nq = m->nq, s->nv = m->nv, s->nu = m->nu, s->nc = m->nc;
    s->n_segments = p->n_segments, s->segments = p->segments, s->on_speeds = p->on_speeds;
    r->scene = s, r->method = p->method, r->adaptive = p->adaptive, r->tableau = *p->tableau;
    r->rtol = p->rtol, r->atol = p->atol, r->rho = 0.8, r->tolerance = 1e-12;
    it->par = sym_take(at, (size_t)m->npar), it->pre = sym_take(at, (size_t)m->npre);
    it->work = sym_take(at, sym_work(m));
    s->q = sym_take(at, nq), s->v = sym_take(at, nv), s->u = sym_take(at, nu), s->t = sym_take(at, 1);
    s->gains = it->gains = sym_take(at, 2 * nc);
    s->a = it->a = sym_take(at, nv), s->lam = it->lam = sym_take(at, nc), s->rank = sym_take(at, 1);
    it->u = sym_take(at, nu), s->constant = it->u;
    r->q = it->q = sym_take(at, nq), r->v = it->v = sym_take(at, nv);
    r->y = sym_take(at, sym_work_size(r));
    r->pivots = (int32_t *)(void *)sym_take(at, nv + nc); /* 2 (nv + nc) of half a double's size */
    r->event = sym_take(at, 3);
    solved[0] = s->a, solved[1] = s->lam, solved[2] = s->rank;
    ok = sym_install(it, at, &s->forward, "forward_dynamics", solved);
    ok = ok && (nc == 0 || sym_install(it, at, &s->project, "project", NULL));
    sym_install(it, at, &s->terms, "implicit_terms", NULL); /* also the exact changes */
    sym_install(it, at, &s->residual, "residual", NULL);
    sym_install(it, at, &s->momentum, "momentum", NULL);
    if (p->method > SYM_METHOD_SEMI_IMPLICIT) ok = ok && s->terms.function != NULL;
    if (p->method == SYM_METHOD_ALPHA) ok = ok && s->residual.function != NULL;
    if (p->method == SYM_METHOD_VARIATIONAL) ok = ok && s->momentum.function != NULL;
    return ok;
}

/* Where the arrays begin: behind the struct, on a boundary of doubles. */
static size_t sym_head(void) { return (sizeof(sym_instance) + sizeof(double) - 1) / sizeof(double); }

SYM_EXPORT size_t sym_instance_size(const sym_plant *plant) {
    sym_instance draft;
    sym_cursor at = {NULL, 0};
    draft.plant = plant, draft.model = plant->model();
    sym_furnish(&draft, &at);
    return (sym_head() + at.used) * sizeof(double);
}

SYM_EXPORT sym_instance *sym_instance_in(void *memory, size_t size, const sym_plant *plant) {
    sym_instance *it = memory;
    sym_cursor at = {NULL, 0};
    const sym_model *model = plant->model();
    if (memory == NULL || model->abi != SYM_ABI || size < sym_instance_size(plant)) return NULL;
    memset(memory, 0, size);
    it->plant = plant, it->model = model;
    at.base = (double *)memory + sym_head();
    if (!sym_furnish(it, &at)) return NULL;
    sym_instance_reset(it);
    return it;
}

SYM_EXPORT void sym_instance_reset(sym_instance *it) {
    const sym_model *m = it->model;
    const sym_plant *p = it->plant;
    it->t = 0.0, it->run.h = 0.0;
    memcpy(it->q, p->q_start, (size_t)m->nq * sizeof(double));
    memcpy(it->v, p->v_start, (size_t)m->nv * sizeof(double));
    memcpy(it->u, p->u_start, (size_t)m->nu * sizeof(double));
    memcpy(it->par, m->par_default, (size_t)m->npar * sizeof(double));
    memset(it->gains, 0, 2 * (size_t)m->nc * sizeof(double));
    it->projects = m->nc > 0;
    sym_instance_prepare(it);
}

SYM_EXPORT void sym_instance_prepare(sym_instance *it) { it->model->init(it->par, it->pre); }

/* The scene's point becomes the present state, its quaternions of unit length. */
static void sym_instance_here(sym_instance *it) {
    it->run.t = it->t;
    sym_here(&it->run);
    sym_unit_quaternions(&it->scene);
}

SYM_EXPORT int32_t sym_instance_close(sym_instance *it) {
    if (it->model->nc == 0) return 0;
    it->run.t = it->t;
    return sym_return(&it->run);
}

SYM_EXPORT int32_t sym_instance_accelerate(sym_instance *it) {
    sym_instance_here(it);
    return sym_accelerate(&it->run);
}

SYM_EXPORT int32_t sym_instance_call(sym_instance *it, const sym_function *function, double *const *out) {
    sym_call call;
    int32_t i;
    if (function == NULL || function->n_out > 8) return 0;
    call.function = function, call.pre = it->pre, call.work = it->work;
    for (i = 0; i < function->n_out; ++i) call.out[i] = out[i];
    if (!sym_bind(&it->scene, &call)) return 0;
    sym_instance_here(it);
    sym_inputs(&it->scene);
    sym_evaluate(&call);
    return 1;
}

SYM_EXPORT int32_t sym_instance_advance(sym_instance *it, double t_end, double h) {
    sym_run *r = &it->run;
    const double span = t_end - it->t, longest = h > 0.0 ? h : it->plant->h;
    double count = 1.0;
    int32_t status;
    if (!(span > 0.0)) return span == 0.0 ? SYM_DONE : SYM_DIVERGED;
    r->t0 = r->t = it->t, r->t_end = t_end, r->project = it->projects && it->model->nc > 0;
    if (r->adaptive) {
        if (!(r->h > 0.0)) r->h = h > 0.0 ? h : it->plant->h;
    } else {
        if (longest > 0.0) count = ceil(span / longest * (1.0 - 1e-9));
        r->h = span / (count > 1.0 ? count : 1.0);
    }
    status = sym_start(r);
    while (status == SYM_GOING) status = sym_advance(r, INT32_MAX);
    if (r->adaptive) r->h = r->h_next; /* the next call goes on with the size that was found */
    it->t = status == SYM_DONE ? t_end : r->t;
    return status;
}

SYM_EXPORT int32_t sym_instance_rates(sym_instance *it, double *rates) {
    sym_scene *s = &it->scene;
    int32_t status;
    sym_instance_here(it);
    sym_configuration_rate(s, it->q, s->v, rates);
    status = sym_accelerate(&it->run);
    memcpy(rates + s->nq, s->a, (size_t)s->nv * sizeof *rates);
    return status;
}

SYM_EXPORT void sym_instance_tangent(const sym_instance *it, const double *dq, double *tangent) {
    const sym_scene *s = &it->scene;
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t linear = seg->kind == 0 ? seg->size : 0, at = seg->kind == 2 ? 3 : 0;
        const double *p = it->q + seg->q + at, *dp = dq + seg->q + at;
        double *into = tangent + seg->v, size = 0.0, unit[4], change[4], c[3], along = 0.0;
        for (i = 0; i < linear; ++i) into[i] = dq[seg->q + i];
        if (seg->kind == 0) continue;
        for (i = 0; i < 4; ++i) size += p[i] * p[i];
        size = sqrt(size);
        for (i = 0; i < 4; ++i) unit[i] = p[i] / size, along += unit[i] * dp[i];
        for (i = 0; i < 4; ++i) change[i] = (dp[i] - along * unit[i]) / size; /* of the unit quaternion */
        sym_cross(unit, change, c); /* 2 conj(unit) change, its vector part */
        for (i = 0; i < 3; ++i) into[at + i] = 2.0 * (unit[3] * change[i] - change[3] * unit[i] - c[i]);
        if (seg->kind == 2) { /* a shift in world axes, seen in the body */
            for (i = 0; i < 3; ++i) c[i] = -unit[i];
            unit[0] = c[0], unit[1] = c[1], unit[2] = c[2];
            sym_rotate(unit, dq + seg->q, into);
        }
    }
}

/* Changes of N(q) v: bilinear in quaternion and speed but for the rotation of a pose's linear velocity. */
static void sym_configuration_change(sym_instance *it, const double *dq, const double *dv, const double *theta,
                                     double *change) {
    sym_scene *s = &it->scene;
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t at = seg->kind == 2 ? 3 : 0;
        const double *p = it->q + seg->q + at, *dp = dq + seg->q + at;
        const double *w = it->v + seg->v + at, *dw = dv + seg->v + at;
        double *into = change + seg->q, one[4], two[4], turned[3];
        if (seg->kind == 0) {
            memcpy(into, dv + seg->v, (size_t)seg->size * sizeof *into);
            continue;
        }
        sym_quaternion_rate(dp, w, one);
        sym_quaternion_rate(p, dw, two);
        for (i = 0; i < 4; ++i) into[at + i] = one[i] + two[i];
        if (seg->kind == 2) { /* d(R v) = R (theta x v + dv) */
            sym_cross(theta + seg->v + 3, it->v + seg->v, turned);
            for (i = 0; i < 3; ++i) turned[i] += dv[seg->v + i];
            sym_rotate(s->q + seg->q + 3, turned, into);
        }
    }
}

SYM_EXPORT int32_t sym_instance_changes(sym_instance *it, const double *dq, const double *dv, const double *du,
                                        double *rates, double *lam, double *matrix) {
    sym_scene *s = &it->scene;
    const int32_t nv = s->nv, nc = s->nc, nu = s->nu, n = nv + nc;
    double *right = matrix + (size_t)n * n, *found = right + n, *work = found + n, *theta = work + n;
    int32_t i, j, rank;
    if (s->terms.function == NULL) return SYM_NO_MOTION;
    sym_instance_tangent(it, dq, theta);
    sym_configuration_change(it, dq, dv, theta, rates);
    sym_evaluate(&s->terms);
    {
        const double *M = s->terms.out[0], *G = s->terms.out[1], *R_q = s->terms.out[2], *R_v = s->terms.out[3];
        const double *R_u = s->terms.out[4], *rate_q = s->terms.out[5];
        for (i = 0; i < n; ++i) {
            double sum = 0.0;
            for (j = 0; j < nv; ++j) sum -= R_q[(size_t)i * nv + j] * theta[j] + R_v[(size_t)i * nv + j] * dv[j];
            for (j = 0; j < nu; ++j) sum -= R_u[(size_t)i * nu + j] * du[j];
            right[i] = sum;
            for (j = 0; j < nv; ++j)
                matrix[(size_t)i * n + j] = i < nv ? M[(size_t)i * nv + j] : G[(size_t)(i - nv) * nv + j];
            for (j = nv; j < n; ++j) matrix[(size_t)i * n + j] = i < nv ? -G[(size_t)(j - nv) * nv + i] : 0.0;
        }
        for (i = 0; i < nc; ++i) { /* what Baumgarte's terms add to the right side */
            const double alpha = s->gains[i], beta = s->gains[nc + i];
            double by_rate = 0.0, by_phi = 0.0;
            for (j = 0; j < nv; ++j) {
                by_rate += rate_q[(size_t)i * nv + j] * theta[j] + G[(size_t)i * nv + j] * dv[j];
                by_phi += G[(size_t)i * nv + j] * theta[j];
            }
            right[nv + i] -= 2.0 * alpha * by_rate + (s->on_speeds[i] ? 0.0 : beta * beta * by_phi);
        }
    }
    rank = sym_eliminate(n, matrix, it->run.pivots, it->run.pivots + n);
    if (rank < nv) return SYM_NO_MOTION;
    sym_solve(n, rank, matrix, it->run.pivots, it->run.pivots + n, right, found, work);
    memcpy(rates + s->nq, found, (size_t)nv * sizeof *rates);
    memcpy(lam, found + nv, (size_t)nc * sizeof *lam);
    return 0;
}

SYM_EXPORT double sym_seconds(void) { return sym_clock(); }
SYM_EXPORT void sym_wait(double seconds) { sym_sleep(seconds); }
