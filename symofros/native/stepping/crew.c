/* Many trajectories, the accelerations of those in hand by one call: symofros_crew.h. */

/* Where a slot's work lies. */
static sym_memory sym_crew_memory(const sym_crew *c, int32_t slot) {
    const size_t n = 2 * (size_t)c->like->scene->nv, at = (size_t)slot * n;
    sym_memory m;
    m.y1 = c->y1 + at, m.stage = c->stage + at, m.size = c->size + at, m.end = c->dense + at, m.k = c->k + at;
    m.rest = NULL;
    m.step = (size_t)c->slots * n;
    return m;
}

SYM_EXPORT void sym_crew_start(sym_crew *c) {
    const sym_scene *like = c->like->scene;
    int32_t i;
    for (i = 0; i < c->slots; ++i) {
        sym_scene *s = c->scenes + i;
        sym_run *r = c->runs + i;
        *s = *like;
        *r = *c->like;
        s->q = c->q + (size_t)i * s->nq, s->v = c->v + (size_t)i * s->nv, s->u = c->u + (size_t)i * s->nu, s->t = c->t + i;
        s->a = c->forward.out[0] + (size_t)i * s->nv;
        s->lam = c->forward.out[1] + (size_t)i * s->nc, s->rank = c->forward.out[2] + i;
        s->forward.out[0] = s->a, s->forward.out[1] = s->lam, s->forward.out[2] = s->rank;
        s->signals = c->signals + (size_t)i * s->n_signals;
        memcpy(c->signals + (size_t)i * s->n_signals, like->signals, (size_t)s->n_signals * sizeof *like->signals);
        r->scene = s;
        r->q = c->states + (size_t)i * ((size_t)s->nq + (size_t)s->nv), r->v = r->q + s->nq;
    }
    c->in_hand = 0;
}

/* The parameters' part of a trajectory into a slot: for calls of its own, and for those of all. */
static void sym_crew_prepare(sym_many *many, sym_scene *scene, sym_call *call, int32_t slot, int64_t which) {
    if (call->function == NULL) return;
    call->pre = many->pre.at + which * many->pre.stride;
    sym_bind(scene, call);
    if (many->pre.stride != 0 && many->pre_here != NULL)
        memcpy(many->pre_here + slot * many->pre.stride, call->pre, (size_t)many->pre.stride * sizeof(double));
}

/* Inputs and parameters of a trajectory into a slot. */
static void sym_crew_give(sym_crew *c, int32_t slot, int64_t which) {
    const sym_scene *like = c->like->scene;
    sym_scene *s = c->scenes + slot;
    int32_t k;
    c->whose[slot] = which;
    s->constant = c->constant.at + which * c->constant.stride;
    for (k = 0; k < like->n_signals; ++k)
        c->signals[(size_t)slot * like->n_signals + k].value = like->signals[k].value + which * c->signal_stride[k];
    sym_crew_prepare(&c->forward, s, &s->forward, slot, which);
    sym_crew_prepare(&c->law, s, &s->law, slot, which);
    sym_crew_prepare(&c->project, s, &s->project, slot, which);
}

/* How a trajectory ended, and where. */
static void sym_crew_note(sym_crew *c, int64_t which, int32_t status, double t, const double *q, const double *v) {
    const sym_scene *s = c->like->scene;
    c->ended[which] = status;
    c->last_t[which] = t;
    memcpy(c->last_q + which * s->nq, q, (size_t)s->nq * sizeof *q);
    memcpy(c->last_v + which * s->nv, v, (size_t)s->nv * sizeof *v);
}

/* What the last slot in hand holds moves to another. */
static void sym_crew_move(sym_crew *c, int32_t to) {
    const int32_t from = c->in_hand - 1;
    sym_run *r = c->runs + to, *other = c->runs + from;
    const sym_run places = *r;
    const sym_scene *s = places.scene, *left = other->scene;
    const sym_memory m = sym_crew_memory(c, to), last = sym_crew_memory(c, from);
    *r = *other;
    r->scene = places.scene, r->q = places.q, r->v = places.v;
    memcpy(r->q, other->q, ((size_t)s->nq + (size_t)s->nv) * sizeof *r->q);
    memcpy(m.size, last.size, 2 * (size_t)s->nv * sizeof *m.size);
    memcpy(m.k, last.k, 2 * (size_t)s->nv * sizeof *m.k);
    memcpy(s->q, left->q, (size_t)s->nq * sizeof *s->q);
    memcpy(s->v, left->v, (size_t)s->nv * sizeof *s->v);
    memcpy(s->u, left->u, (size_t)s->nu * sizeof *s->u);
    *s->t = *left->t;
    sym_crew_give(c, to, c->whose[from]);
    c->step[to] = c->step[from], c->end[to] = c->end[from], c->status[to] = c->status[from];
}

/* Put down what a slot holds; the last one fills it. */
static void sym_crew_put(sym_crew *c, int32_t slot, int32_t status) {
    const sym_run *r = c->runs + slot;
    const int64_t which = c->whose[slot];
    sym_crew_note(c, which, status, r->t, r->q, r->v);
    c->steps[which] = r->steps;
    c->rejected[which] = r->rejected;
    if (slot != c->in_hand - 1) sym_crew_move(c, slot);
    --c->in_hand;
}

/* Take up the next trajectory; its first slope and step are found by itself, in the single run's work. */
static void sym_crew_take(sym_crew *c) {
    const int32_t slot = c->in_hand++;
    const int64_t which = c->next;
    sym_run *r = c->runs + slot;
    const sym_scene *s = r->scene;
    int32_t status = c->ended[which];
    c->next += c->by;
    sym_crew_give(c, slot, which);
    memcpy(r->q, c->q0.at + which * c->q0.stride, (size_t)s->nq * sizeof *r->q);
    memcpy(r->v, c->v0.at + which * c->v0.stride, (size_t)s->nv * sizeof *r->v);
    r->t = r->t0;
    r->steps = r->rejected = 0;
    r->record_q = c->record_q + which * r->capacity * s->nq;
    r->record_v = c->record_v + which * r->capacity * s->nv;
    r->record_u = c->record_u + which * r->capacity * s->nu;
    if (status == 0 && !(sym_finite(s->nq, r->q) && sym_finite(s->nv, r->v))) status = SYM_DIVERGED;
    if (status == 0) status = sym_start(r);
    if (status == 0 && r->t >= r->t_end) status = SYM_DONE;
    memcpy(sym_crew_memory(c, slot).k, sym_lay_out(r).k, 2 * (size_t)s->nv * sizeof(double));
    if (status != 0) sym_crew_put(c, slot, status);
}

/* A function at the points of all in hand. One alone goes in company: a batch of one is evaluated as a single state is,
 * and the bits of a trajectory would depend on when the others end. */
static void sym_crew_evaluate(const sym_crew *c, const sym_many *many) {
    static const char *const names[] = {"q", "v", "u", "t", "gains"};
    const sym_scene *s = c->like->scene;
    const sym_function *f = many->function;
    const double *places[5], *in[10];
    size_t strides[5], stride[10];
    int32_t i, k;
    places[0] = c->q, places[1] = c->v, places[2] = c->u, places[3] = c->t, places[4] = s->gains;
    strides[0] = (size_t)s->nq, strides[1] = (size_t)s->nv, strides[2] = (size_t)s->nu, strides[3] = 1, strides[4] = 0;
    in[0] = many->pre.stride == 0 ? many->pre.at : many->pre_here;
    stride[0] = (size_t)many->pre.stride;
    for (k = 1; k < f->n_in; ++k)
        for (i = 0; i < 5; ++i)
            if (strcmp(f->in[k].name, names[i]) == 0) in[k] = places[i], stride[k] = strides[i];
    f->batch(c->in_hand > 1 ? (size_t)c->in_hand : 2, in, stride, many->out, many->work);
}

/* Inputs and accelerations at the points of all in hand. Constant inputs are there since a trajectory was taken up. */
static void sym_crew_accelerate(sym_crew *c) {
    int32_t i, k;
    if (c->like->scene->n_signals > 0)
        for (i = 0; i < c->in_hand; ++i) sym_samples(c->scenes + i);
    if (c->law.function != NULL) {
        const int32_t n = c->scenes->n_law;
        sym_crew_evaluate(c, &c->law);
        for (i = 0; i < c->in_hand; ++i)
            for (k = 0; k < n; ++k) c->scenes[i].u[c->scenes->law_inputs[k]] = c->law.out[0][(size_t)i * n + k];
    }
    sym_crew_evaluate(c, &c->forward);
}

/* k[0] of all in hand that lack it. */
static void sym_crew_first_slopes(sym_crew *c) {
    int32_t i, wanted = 0;
    for (i = 0; i < c->in_hand; ++i) {
        if (c->runs[i].fresh) continue;
        sym_here(c->runs + i);
        ++wanted;
    }
    if (wanted > 0) sym_crew_accelerate(c);
    for (i = 0; i < c->in_hand; ++i) {
        sym_run *r = c->runs + i;
        const sym_memory m = sym_crew_memory(c, i);
        int32_t status = 0;
        if (!r->fresh) {
            status = sym_accelerated(r);
            sym_begin_slopes(r, m.k);
        }
        c->status[i] = status != 0 ? status : sym_first_slope(r, m.k);
    }
}

/* Steps of all in hand begin: (0, v) and their lengths, as often as y has entries. */
static void sym_crew_begin(sym_crew *c) {
    const int32_t nv = c->like->scene->nv, n = 2 * nv;
    int32_t i, l;
    for (i = 0; i < c->in_hand; ++i) {
        double *base = c->base + (size_t)i * n, *length = c->length + (size_t)i * n;
        for (l = 0; l < nv; ++l) base[l] = 0.0, base[nv + l] = c->runs[i].v[l];
        for (l = 0; l < n; ++l) length[l] = c->step[i];
    }
}

/* y = (0, v) + h sum of weighted slopes, of all in hand: sym_moved. */
static void sym_crew_moved(const sym_crew *c, int32_t stages, const double *weights, double *restrict y) {
    const size_t n = 2 * (size_t)c->like->scene->nv, size = (size_t)c->in_hand * n;
    const double *restrict base = c->base, *restrict length = c->length;
    size_t l;
    sym_sum(size, stages, weights, c->k, (size_t)c->slots * n, y);
    for (l = 0; l < size; ++l) y[l] = length[l] * y[l] + base[l];
}

/* A stage of all in hand. */
static void sym_crew_stage(sym_crew *c, int32_t stage) {
    const sym_tableau *method = &c->like->tableau;
    int32_t i;
    sym_crew_moved(c, stage, method->a + (size_t)stage * method->dense_stages, c->stage);
    for (i = 0; i < c->in_hand; ++i) {
        sym_run *r = c->runs + i;
        sym_place(r, r->t + method->c[stage] * c->step[i], sym_crew_memory(c, i).stage);
    }
    sym_crew_accelerate(c);
    for (i = 0; i < c->in_hand; ++i) {
        sym_run *r = c->runs + i;
        const sym_memory m = sym_crew_memory(c, i);
        const int32_t status = sym_accelerated(r);
        if (c->status[i] == 0) c->status[i] = status; /* one that has failed goes on in company, for nothing */
        sym_rate(r->scene, m.stage, m.k + (size_t)stage * m.step);
    }
}

/* One step of all in hand: planned, tried, and taken or not. Whoever is done is put down; slots from the last to the
 * first, so that what fills a slot has been seen to. */
static void sym_crew_round(sym_crew *c) {
    int32_t i, stage;
    sym_crew_first_slopes(c);
    for (i = c->in_hand - 1; i >= 0; --i) {
        sym_memory m = sym_crew_memory(c, i);
        if (c->status[i] == 0) c->status[i] = sym_plan(c->runs + i, &m, c->step + i, c->end + i);
        if (c->status[i] != 0) sym_crew_put(c, i, c->status[i]);
    }
    if (c->in_hand == 0) return;
    sym_crew_begin(c);
    for (stage = 1; stage < c->like->tableau.stages; ++stage) sym_crew_stage(c, stage);
    if (c->like->method == SYM_METHOD_EXPLICIT) sym_crew_moved(c, c->like->tableau.stages, c->like->tableau.b, c->y1);
    for (i = c->in_hand - 1; i >= 0; --i) {
        sym_run *r = c->runs + i;
        sym_memory m = sym_crew_memory(c, i);
        int32_t status = c->status[i];
        double error = 0.0;
        if (r->method == SYM_METHOD_SEMI_IMPLICIT) sym_semi_implicit_step(r, c->step[i], m.k, m.y1);
        if (status == 0) status = sym_examine(r, &m, c->step[i], &error);
        status = sym_judge(r, &m, c->step[i], c->end[i], status, error);
        if (status == 0 && r->t >= r->t_end) status = SYM_DONE;
        if (status != 0 || (c->max_steps > 0 && r->steps >= c->max_steps)) sym_crew_put(c, i, status);
    }
}

SYM_EXPORT int32_t sym_crew_advance(sym_crew *c, int64_t rounds) {
    int64_t done;
    for (done = 0; done < rounds; ++done) {
        while (c->in_hand < c->slots && c->next < c->n) sym_crew_take(c);
        if (c->in_hand == 0) return 0;
        sym_crew_round(c);
    }
    return c->in_hand > 0 || c->next < c->n;
}

SYM_EXPORT void sym_crew_stop(sym_crew *c) {
    while (c->in_hand > 0) sym_crew_put(c, c->in_hand - 1, SYM_GOING);
    for (; c->next < c->n; c->next += c->by) {
        const double *q = c->q0.at + c->next * c->q0.stride, *v = c->v0.at + c->next * c->v0.stride;
        sym_crew_note(c, c->next, SYM_GOING, c->like->t0, q, v);
    }
}
