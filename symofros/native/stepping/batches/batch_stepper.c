/* Many trajectories, whose accelerations are evaluated by one call: symofros_batch.h. */

/* Outputs and inputs of a function for all slots. Returns 0 where an input is unknown. */
static int32_t sym_batch_bind(sym_batch *b, sym_arena *own, sym_arena *scratch, sym_batch_function *f) {
    const sym_system *s = b->prototype->system;
    const sym_function *function = f->function;
    sym_point point = sym_system_point(s);
    size_t strides[5];
    int32_t i, k;
    if (function == NULL) return 1;
    f->pre_active = sym_allocate(own, (size_t)b->slots * (size_t)f->pre.stride);
    f->work = sym_allocate(scratch, function->work);
    for (i = 0; i < function->n_out; ++i)
        f->out[i] = sym_allocate(scratch, (size_t)b->slots * sym_array_size(&function->out[i]));
    point.n = 5; /* q, v, u, t, gains */
    point.arrays[0] = b->q, point.arrays[1] = b->v, point.arrays[2] = b->u, point.arrays[3] = b->t;
    strides[0] = (size_t)s->nq, strides[1] = (size_t)s->nv, strides[2] = (size_t)s->nu, strides[3] = 1, strides[4] = 0;
    f->in[0] = f->pre.stride == 0 ? f->pre.at : f->pre_active, f->in_stride[0] = (size_t)f->pre.stride;
    for (k = 1; k < function->n_in; ++k) {
        i = sym_point_index(&point, function->in[k].name);
        if (i < 0) return 0;
        f->in[k] = point.arrays[i], f->in_stride[k] = strides[i];
    }
    return 1;
}

/* Lay out every array of the slots: what is kept between steps, and what a step under way needs. Where the last slope of a
 * step is the first of the next, as events make it as well, all is kept. Returns 0 where a function asks for an unknown input. */
static int32_t sym_batch_allocate(sym_batch *b, sym_arena *own, sym_arena *shared) {
    const sym_system *s = b->prototype->system;
    sym_arena *scratch = b->prototype->tableau.fsal_stage > 0 || s->n_events > 0 ? own : shared;
    const size_t slots = (size_t)b->slots, nq = (size_t)s->nq, nv = (size_t)s->nv, m = 2 * nv;
    const size_t slopes = b->prototype->tableau.dense_stages > 1 ? (size_t)b->prototype->tableau.dense_stages : 1;
    b->systems = sym_allocate_bytes(scratch, slots * sizeof *b->systems);
    b->runs = sym_allocate_bytes(own, slots * sizeof *b->runs);
    b->trajectory_of_slot = sym_allocate_bytes(own, slots * sizeof *b->trajectory_of_slot);
    b->status = sym_allocate_bytes(scratch, slots * sizeof *b->status);
    b->h = sym_allocate(scratch, slots), b->t1 = sym_allocate(scratch, slots);
    b->q = sym_allocate(scratch, slots * nq), b->v = sym_allocate(scratch, slots * nv);
    b->t = sym_allocate(scratch, slots);
    b->states = sym_allocate(own, slots * (nq + nv));
    b->event_values = sym_allocate(own, slots * SYM_EVENT_ROWS * (size_t)s->n_events);
    b->held = sym_allocate_bytes(own, slots * (size_t)s->n_sticking * sizeof *b->held);
    b->y1 = sym_allocate(scratch, slots * m), b->stage = sym_allocate(scratch, slots * m);
    b->magnitude = sym_allocate(scratch, slots * m), b->end_slope = sym_allocate(scratch, slots * m);
    b->k = sym_allocate(scratch, slopes * slots * m);
    b->y0 = sym_allocate(scratch, slots * m), b->length = sym_allocate(scratch, slots * m);
    if (!sym_batch_has_columns(b)) b->forward_dynamics.lanes = NULL;
    else sym_columns_allocate(b, own, scratch);
    /* Where there are slots enough, all above begins at lines of cache. */
    b->u = sym_allocate(scratch, slots * (size_t)s->nu);
    b->signals = sym_allocate_bytes(scratch, slots * (size_t)s->n_signals * sizeof *b->signals);
    b->end_state = sym_allocate(scratch, nq + nv), b->unseen = sym_allocate(scratch, 3 * nv);
    b->defects = sym_allocate_defects(s, scratch).impulse; /* the first of them */
    return sym_batch_bind(b, own, scratch, &b->forward_dynamics) && sym_batch_bind(b, own, scratch, &b->law);
}

SYM_EXPORT size_t sym_batch_size(const sym_batch *batch, size_t *shared) {
    sym_batch draft = *batch;
    sym_arena own = {NULL, 0}, scratch = {NULL, 0};
    sym_batch_allocate(&draft, &own, &scratch);
    *shared = scratch.used;
    return own.used;
}

SYM_EXPORT int32_t sym_batch_start(sym_batch *b, double *memory, double *shared) {
    const sym_system *prototype = b->prototype->system;
    sym_arena own = {NULL, 0}, scratch = {NULL, 0};
    int32_t i;
    own.base = memory, scratch.base = shared;
    if (!sym_batch_allocate(b, &own, &scratch)) return 0;
    for (i = 0; i < b->slots; ++i) {
        sym_system *s = b->systems + i;
        sym_run *r = b->runs + i;
        *s = *prototype;
        *r = *b->prototype;
        s->q = b->q + (size_t)i * (size_t)s->nq, s->v = b->v + (size_t)i * (size_t)s->nv;
        s->u = b->u + (size_t)i * (size_t)s->nu, s->t = b->t + i;
        s->a = b->forward_dynamics.out[0] + (size_t)i * (size_t)s->nv;
        s->lam = b->forward_dynamics.out[1] + (size_t)i * (size_t)s->nc, s->rank = b->forward_dynamics.out[2] + i;
        s->forward_dynamics.out[0] = s->a, s->forward_dynamics.out[1] = s->lam, s->forward_dynamics.out[2] = s->rank;
        if (s->law.function != NULL) sym_system_bind(s, &s->law);
        if (s->project.function != NULL) sym_system_bind(s, &s->project);
        if (s->events.function != NULL) sym_system_bind(s, &s->events);
        if (s->contact_state.function != NULL) sym_system_bind(s, &s->contact_state);
        r->event_values = b->event_values + SYM_INDEX(i, SYM_EVENT_ROWS, 0) * (size_t)s->n_events;
        s->held = b->held + (size_t)i * (size_t)s->n_sticking;
        sym_system_bind(s, &s->forward_dynamics);
        s->signals = b->signals + (size_t)i * (size_t)s->n_signals;
        if (s->n_signals > 0) memcpy(s->signals, prototype->signals, (size_t)s->n_signals * sizeof *b->signals);
        r->system = s;
        r->q = b->states + (size_t)i * ((size_t)s->nq + (size_t)s->nv), r->v = r->q + s->nq;
    }
    b->n_active = b->in_columns = b->n_begun = 0;
    if (b->forward_dynamics.lanes != NULL) sym_columns_bind(b, &b->forward_dynamics), sym_columns_bind(b, &b->law);
    return 1;
}

/* What one slot has of a table (slots, 2 nv). */
static double *sym_batch_row(const sym_batch *b, double *table, int32_t slot) {
    return table + (size_t)slot * 2 * (size_t)b->prototype->system->nv;
}

/* Working memory of one slot. */
static sym_workspace sym_batch_workspace(const sym_batch *b, int32_t slot) {
    const size_t m = 2 * (size_t)b->prototype->system->nv, at = (size_t)slot * (size_t)m;
    sym_arena defects = {NULL, 0};
    sym_workspace w;
    w.y1 = b->y1 + at, w.stage = b->stage + at, w.magnitude = b->magnitude + at, w.end_slope = b->end_slope + at;
    w.end_state = b->end_state, w.unseen = b->unseen;
    w.k = b->k + at, w.stage_stride = (size_t)b->slots * (size_t)m;
    defects.base = b->defects;
    w.defects = sym_allocate_defects(b->prototype->system, &defects);
    memset(&w.implicit, 0, sizeof w.implicit);
    return w;
}

/* A function of one slot takes the parameters of a trajectory: for its own calls, and for those of all slots. */
static void sym_batch_set_parameters(sym_batch_function *f, sym_call *call, int32_t slot, int64_t trajectory) {
    if (call->function == NULL) return;
    call->pre = call->in[0] = f->pre.at + trajectory * f->pre.stride;
    if (f->pre.stride != 0 && f->pre_active != NULL)
        memcpy(f->pre_active + slot * f->pre.stride, call->pre, (size_t)f->pre.stride * sizeof(double));
}

/* A run takes the memory of a trajectory in which it records, and in which its beams are judged. */
static void sym_batch_place(const sym_batch *b, sym_run *r, int64_t trajectory) {
    const sym_system *s = r->system;
    const int64_t n = s->n_beams, coordinates = b->n_beam_coordinates;
    r->record_q = b->record_q + trajectory * r->capacity * s->nq;
    r->record_v = b->record_v + trajectory * r->capacity * s->nv;
    r->record_u = b->record_u + trajectory * r->capacity * s->nu;
    r->beam_scale = b->beam_scale.at + trajectory * b->beam_scale.stride;
    r->beam_reach = b->beam_reach.at + trajectory * b->beam_reach.stride;
    r->beam_error = b->beam_error + trajectory * n, r->beam_t = b->beam_t + trajectory * n;
    r->beam_q = b->beam_q + trajectory * coordinates, r->beam_reference = b->beam_reference + 2 * trajectory * coordinates;
    r->beam_guard = b->beam_guard + trajectory * n, r->beam_weight = b->beam_weight + trajectory * s->nv;
    if (r->actions == NULL) return;
    r->par = b->par + trajectory * r->actions->npar, r->acted_at = b->acted_at + trajectory * (s->n_events + 1);
    r->system->contact_memory = b->contact_memory + trajectory * (int64_t)sym_contact_memory_size(s);
}

/* All functions of a slot take the parameters of a trajectory. */
static void sym_batch_set_all_parameters(sym_batch *b, sym_system *s, int32_t slot, int64_t trajectory) {
    sym_batch_set_parameters(&b->forward_dynamics, &s->forward_dynamics, slot, trajectory);
    sym_batch_set_parameters(&b->law, &s->law, slot, trajectory);
    sym_batch_set_parameters(&b->project, &s->project, slot, trajectory);
    sym_batch_set_parameters(&b->events, &s->events, slot, trajectory);
    sym_batch_set_parameters(&b->contact_state, &s->contact_state, slot, trajectory);
}

/* A slot takes what is known ahead of its trajectory. */
static void sym_batch_take_ahead(sym_batch *b, int32_t slot) {
    sym_system *s = b->systems + slot;
    const sym_ahead *ahead;
    if (b->ahead == NULL) return;
    ahead = b->ahead + b->trajectory_of_slot[slot];
    s->n_stops = ahead->n_stops, s->stops = ahead->stops;
    s->n_event_instants = ahead->n_event_instants, s->event_instants = ahead->event_instants;
}

/* Whether a step of a slot's trajectory from t to t1 lies in the span for which that is. */
static int32_t sym_batch_knows(const sym_batch *b, int32_t slot, double t, double t1) {
    const sym_ahead *ahead = b->ahead == NULL ? NULL : b->ahead + b->trajectory_of_slot[slot];
    return ahead == NULL || (ahead->begin <= t && t1 <= ahead->known);
}

/* A slot takes the inputs, parameters and memory of a trajectory. */
static void sym_batch_assign(sym_batch *b, int32_t slot, int64_t trajectory) {
    const sym_system *prototype = b->prototype->system;
    sym_system *s = b->systems + slot;
    sym_signal *signals = b->signals + (size_t)slot * (size_t)prototype->n_signals;
    int32_t k;
    b->trajectory_of_slot[slot] = trajectory;
    sym_batch_take_ahead(b, slot);
    sym_batch_place(b, b->runs + slot, trajectory);
    s->u_constant = b->u_constant.at + trajectory * b->u_constant.stride;
    for (k = 0; k < prototype->n_signals; ++k)
        signals[k].value = prototype->signals[k].value + trajectory * b->signal_stride[k];
    if (s->n_events > 0) s->event_terminal = b->event_terminal + trajectory * s->n_events;
    if (s->n_sticking > 0) sym_hold_by_modes(s, b->runs[slot].par);
    sym_batch_set_all_parameters(b, s, slot, trajectory);
}

static void sym_batch_store_result(sym_batch *b, int64_t trajectory, int32_t status, double t, const double *q,
                                   const double *v) {
    const sym_system *s = b->prototype->system;
    b->final_status[trajectory] = status;
    b->final_t[trajectory] = t;
    memcpy(b->final_q + trajectory * s->nq, q, (size_t)s->nq * sizeof *q);
    memcpy(b->final_v + trajectory * s->nv, v, (size_t)s->nv * sizeof *v);
}

/* Move the trajectory of the last active slot to another slot. */
static void sym_batch_move_last(sym_batch *b, int32_t to) {
    const int32_t from = b->n_active - 1;
    sym_run *r = b->runs + to, *last = b->runs + from;
    const sym_run slot = *r; /* keeps the slot's arrays */
    const sym_system *s = slot.system, *last_system = last->system;
    const sym_workspace w = sym_batch_workspace(b, to), last_w = sym_batch_workspace(b, from);
    *r = *last;
    r->system = slot.system, r->q = slot.q, r->v = slot.v, r->event_values = slot.event_values;
    memcpy(r->event_values, last->event_values, SYM_EVENT_ROWS * (size_t)s->n_events * sizeof *r->q);
    memcpy(r->q, last->q, ((size_t)s->nq + (size_t)s->nv) * sizeof *r->q);
    memcpy(w.magnitude, last_w.magnitude, 2 * (size_t)s->nv * sizeof *w.magnitude);
    memcpy(w.k, last_w.k, 2 * (size_t)s->nv * sizeof *w.k);
    memcpy(s->q, last_system->q, (size_t)s->nq * sizeof *s->q);
    memcpy(s->v, last_system->v, (size_t)s->nv * sizeof *s->v);
    memcpy(s->u, last_system->u, (size_t)s->nu * sizeof *s->u);
    *s->t = *last_system->t;
    sym_batch_assign(b, to, b->trajectory_of_slot[from]);
    b->h[to] = b->h[from], b->t1[to] = b->t1[from], b->status[to] = b->status[from];
}

/* End the trajectory of a slot; the last active one takes the slot. */
static void sym_batch_retire(sym_batch *b, int32_t slot, int32_t status) {
    sym_run *r = b->runs + slot;
    const int64_t trajectory = b->trajectory_of_slot[slot];
    sym_run_settle_beams(r);
    sym_batch_store_result(b, trajectory, status, r->t, r->q, r->v);
    b->steps[trajectory] = r->steps;
    b->rejected[trajectory] = r->rejected;
    if (slot != b->n_active - 1) sym_batch_move_last(b, slot);
    --b->n_active;
}

/* Nothing is known of the beams of a run yet. */
static void sym_batch_forget_beams(const sym_batch *b, sym_run *r) {
    const size_t n = (size_t)r->system->n_beams, coordinates = (size_t)b->n_beam_coordinates, nv = (size_t)r->system->nv;
    memset(r->beam_error, 0, n * sizeof *r->beam_error), memset(r->beam_t, 0, n * sizeof *r->beam_t);
    memset(r->beam_q, 0, coordinates * sizeof *r->beam_q);
    memset(r->beam_reference, 0, 2 * coordinates * sizeof *r->beam_reference);
    memset(r->beam_guard, 0, n * sizeof *r->beam_guard), memset(r->beam_weight, 0, nv * sizeof *r->beam_weight);
}

/* Rows of events that one slot may fill in a step. */
static int64_t sym_batch_share(const sym_batch *b) { return 4 * (int64_t)b->prototype->system->n_events; }

/* Whether the records can take the events of a step of all slots, and of the start of a trajectory in each. */
static int32_t sym_batch_can_record(const sym_batch *b) {
    const sym_run *p = b->prototype;
    const int64_t share = sym_batch_share(b);
    return share == 0 || p->event_capacity - p->n_event_records >= b->slots * (share + 1);
}

/* The events that a run has met behind those that are known are of that trajectory. */
static void sym_batch_count_events(sym_batch *b, const sym_run *r, int64_t trajectory) {
    sym_run *p = b->prototype;
    while (p->n_event_records < r->n_event_records) b->event_trajectory[p->n_event_records++] = trajectory;
}

/* What is known ahead of a slot's trajectory is looked for anew, from time t on. Returns 0 or a status. */
static int32_t sym_batch_look_ahead(sym_batch *b, int32_t slot, double t) {
    const int64_t trajectory = b->trajectory_of_slot[slot];
    if (b->ahead == NULL) return 0;
    if (b->look_ahead(b->data, trajectory, t) != 0) return SYM_CALLBACK_FAILED;
    sym_batch_take_ahead(b, slot);
    return 0;
}

/* Activate the next trajectory; its first slope and step size are evaluated alone, in the prototype's memory. */
static void sym_batch_activate_next(sym_batch *b) {
    const int32_t slot = b->n_active++;
    const int64_t trajectory = b->next;
    sym_run *r = b->runs + slot;
    const sym_system *s = r->system;
    int32_t status = b->final_status[trajectory];
    b->next += b->stride;
    sym_batch_assign(b, slot, trajectory);
    memcpy(r->q, b->q0.at + trajectory * b->q0.stride, (size_t)s->nq * sizeof *r->q);
    memcpy(r->v, b->v0.at + trajectory * b->v0.stride, (size_t)s->nv * sizeof *r->v);
    r->t = r->t0 = b->t0 != NULL ? b->t0[trajectory] : b->prototype->t0;
    r->steps = r->rejected = 0;
    sym_batch_forget_beams(b, r);
    if (s->n_contacts > 0) sym_run_forget_contacts(r);
    if (status == 0 && !(sym_all_finite(s->nq, r->q) && sym_all_finite(s->nv, r->v))) status = SYM_DIVERGED;
    r->n_event_records = b->prototype->n_event_records, r->event_capacity = b->prototype->event_capacity;
    if (status == 0) status = sym_batch_look_ahead(b, slot, r->t);
    if (status == 0) status = sym_run_start(r);
    sym_batch_count_events(b, r, trajectory);
    if (s->n_sticking + s->n_contacts > 0) sym_batch_set_all_parameters(b, b->systems + slot, slot, trajectory); /* modes have been chosen */
    if (status == 0 && r->t >= r->t_end) status = SYM_FINISHED;
    memcpy(sym_batch_workspace(b, slot).k, sym_workspace_of(r).k, 2 * (size_t)s->nv * sizeof(double));
    if (status != 0) sym_batch_retire(b, slot, status);
}

/* Evaluate a function at the states of all active trajectories. A single one is padded to two: a batch of one would be
 * evaluated by other code, and the bits of a trajectory would depend on when the others end. */
static void sym_batch_evaluate(const sym_batch *b, const sym_batch_function *f) {
    const size_t n = b->n_active > 1 ? (size_t)b->n_active : 2;
    f->function->batch(n, (const double *const *)f->in, f->in_stride, (double *const *)f->out, f->work);
}

/* Inputs and accelerations at all active evaluation points. Constant inputs are there since a trajectory was activated. */
static void sym_batch_evaluate_acceleration(sym_batch *b) {
    int32_t i, k;
    if (b->prototype->system->n_signals > 0)
        for (i = 0; i < b->n_active; ++i) sym_evaluate_signals(b->systems + i);
    if (b->law.function != NULL) {
        const int32_t n = b->systems->n_law;
        sym_batch_evaluate(b, &b->law);
        for (i = 0; i < b->n_active; ++i)
            for (k = 0; k < n; ++k) b->systems[i].u[b->systems->law_inputs[k]] = b->law.out[0][SYM_INDEX(i, n, k)];
    }
    for (i = 0; i < b->n_active; ++i) sym_normalize_inputs(b->systems + i);
    sym_batch_evaluate(b, &b->forward_dynamics);
}

/* k[0] of all active trajectories whose slope is not valid. */
static void sym_batch_first_slopes(sym_batch *b) {
    int32_t i, missing = 0;
    for (i = 0; i < b->n_active; ++i) {
        if (b->runs[i].slope_valid) continue;
        sym_load_start(b->runs + i);
        ++missing;
    }
    if (missing > 0) sym_batch_evaluate_acceleration(b);
    for (i = 0; i < b->n_active; ++i) {
        sym_run *r = b->runs + i;
        double *k = sym_batch_row(b, b->k, i);
        int32_t status = 0;
        if (!r->slope_valid) {
            status = sym_complete_acceleration(r, r->par);
            sym_store_first_slope(r, k);
        }
        b->status[i] = status != 0 ? status : sym_first_slope(r, k);
    }
}

/* y0 = (0, v) and the step length, as often as y has entries, of all active trajectories. */
static void sym_batch_begin_step(sym_batch *b) {
    const int32_t nv = b->prototype->system->nv, m = 2 * nv;
    int32_t i, l;
    for (i = 0; i < b->n_active; ++i) {
        double *y0 = b->y0 + (size_t)i * (size_t)m, *length = b->length + (size_t)i * (size_t)m;
        for (l = 0; l < nv; ++l) y0[l] = 0.0, y0[nv + l] = b->runs[i].v[l];
        for (l = 0; l < m; ++l) length[l] = b->h[i];
    }
}

/* y = (0, v) + h times the weighted sum of slopes, of all active trajectories: sym_combine_slopes. */
static void sym_batch_combine_slopes(const sym_batch *b, int32_t stages, const double *weights, double *restrict y) {
    const size_t m = 2 * (size_t)b->prototype->system->nv, size = (size_t)b->n_active * m;
    const double *restrict y0 = b->y0, *restrict length = b->length;
    size_t l;
    sym_weighted_sum(size, stages, weights, b->k, (size_t)b->slots * m, y);
    for (l = 0; l < size; ++l) y[l] = length[l] * y[l] + y0[l];
}

/* One stage of all active trajectories. One that has failed is evaluated on, to no effect, until the step ends. */
static void sym_batch_evaluate_stage(sym_batch *b, int32_t stage) {
    const sym_tableau *method = &b->prototype->tableau;
    double *k = sym_batch_row(b, b->k, stage * b->slots);
    int32_t i;
    sym_batch_combine_slopes(b, stage, method->a + (size_t)stage * (size_t)method->dense_stages, b->stage);
    for (i = 0; i < b->n_active; ++i) {
        sym_run *r = b->runs + i;
        sym_load_chart_state(r, sym_stage_time(r->system, r->t + method->c[stage] * b->h[i]), sym_batch_row(b, b->stage, i));
    }
    sym_batch_evaluate_acceleration(b);
    for (i = 0; i < b->n_active; ++i) {
        sym_run *r = b->runs + i;
        const int32_t status = sym_complete_acceleration(r, r->par);
        if (b->status[i] == 0) b->status[i] = status;
        sym_slope_of_acceleration(r->system, sym_batch_row(b, b->stage, i), sym_batch_row(b, k, i));
    }
}

/* Do the actions of the events at which a slot's step has been cut, in the place of the prototype, whose functions are bound to
 * its own memory. Returns 0 or a status. */
static int32_t sym_batch_act(sym_batch *b, int32_t slot) {
    sym_run *p = b->prototype, *r = b->runs + slot;
    sym_system *s = r->system;
    const sym_run own = *p;
    const sym_system own_system = *p->system;
    const int64_t trajectory = b->trajectory_of_slot[slot];
    const size_t npar = (size_t)r->actions->npar;
    int32_t status;
    p->t = r->t, p->t0 = r->t0, p->steps = r->steps, p->acted_at = r->acted_at;
    p->t_from = r->t_from, p->n_from = r->n_from;
    p->first_met = r->first_met, p->met_end = r->met_end, p->event_values = r->event_values;
    memcpy(p->q, r->q, (size_t)s->nq * sizeof *p->q), memcpy(p->v, r->v, (size_t)s->nv * sizeof *p->v);
    p->system->contact_memory = s->contact_memory, p->system->u_constant = s->u_constant, p->system->signals = s->signals, p->system->event_terminal = s->event_terminal;
    sym_run_set_parameters(p, r->par);
    status = sym_run_act(p);
    memcpy(r->q, p->q, (size_t)s->nq * sizeof *p->q), memcpy(r->v, p->v, (size_t)s->nv * sizeof *p->v);
    r->steps = p->steps, r->t_from = p->t_from, r->n_from = p->n_from;
    memcpy(r->par, p->par, npar * sizeof *r->par);
    p->t = own.t, p->t0 = own.t0, p->steps = own.steps, p->acted_at = own.acted_at;
    p->t_from = own.t_from, p->n_from = own.n_from;
    p->event_values = own.event_values;
    *p->system = own_system;
    if (status < 0) return status;
    sym_prepare_call(&s->forward_dynamics, r->par), sym_prepare_call(&s->law, r->par);
    sym_prepare_call(&s->project, r->par), sym_prepare_call(&s->events, r->par), sym_prepare_call(&s->contact_state, r->par);
    sym_hold_by_modes(s, r->par);
    sym_batch_set_all_parameters(b, s, slot, trajectory);
    return sym_batch_look_ahead(b, slot, r->t) != 0 ? SYM_CALLBACK_FAILED : status;
}

/* After a step of a slot that was cut, with that status: actions are done, and what is left of a step of fixed length is made
 * alone, in the prototype's memory. Returns 0 or a status. */
static int32_t sym_batch_finish_step(sym_batch *b, int32_t slot, int32_t status, int64_t steps) {
    sym_run *r = b->runs + slot;
    sym_workspace w = sym_workspace_of(r);
    do {
        if (status == SYM_TERMINAL_EVENT) {
            status = r->actions != NULL ? sym_record_grid_after_actions(r, sym_batch_act(b, slot)) : status;
            if (status != 0) return status;
            status = sym_begin_motion_anew(r, &w);
        }
        while (status == 0 && !r->adaptive && r->steps < steps) status = sym_run_advance(r, 1);
    } while (status == SYM_TERMINAL_EVENT);
    memcpy(sym_batch_workspace(b, slot).k, w.k, 2 * (size_t)r->system->nv * sizeof(double));
    return status == SYM_RECORDS_FULL ? SYM_ACTS_WITHOUT_END : status;
}

/* Accept or reject the step of a slot: sym_accept_or_reject, its events beside those of the others. */
static int32_t sym_batch_accept_or_reject(sym_batch *b, int32_t slot, sym_workspace *w, int32_t status, double error) {
    sym_run *r = b->runs + slot, *p = b->prototype;
    const int64_t steps = r->steps + 1;
    r->n_event_records = p->n_event_records, r->event_capacity = p->event_capacity - slot * sym_batch_share(b);
    status = sym_accept_or_reject(r, w, b->h[slot], b->t1[slot], status, error);
    if (r->system->n_events == 0) return status;
    if (status == SYM_TERMINAL_EVENT || (status == 0 && !r->adaptive && r->steps < steps))
        status = sym_batch_finish_step(b, slot, status, steps);
    sym_batch_count_events(b, r, b->trajectory_of_slot[slot]);
    return status;
}

/* One step of all active trajectories: proposed, tried, accepted or rejected. Those that end are retired, from the last
 * slot to the first, so that the trajectory that moves into a slot has been treated. */
static void sym_batch_step(sym_batch *b) {
    const sym_tableau *method = &b->prototype->tableau;
    int32_t i, stage;
    sym_batch_first_slopes(b);
    for (i = b->n_active - 1; i >= 0; --i) {
        sym_workspace w = sym_batch_workspace(b, i);
        if (b->status[i] == 0 && !sym_batch_knows(b, i, b->runs[i].t, b->runs[i].t + b->runs[i].h))
            b->status[i] = sym_batch_look_ahead(b, i, b->runs[i].t);
        if (b->status[i] == 0) b->status[i] = sym_propose_step(b->runs + i, &w, b->h + i, b->t1 + i);
        if (b->status[i] != 0) sym_batch_retire(b, i, b->status[i]);
    }
    if (b->n_active == 0) return;
    sym_batch_begin_step(b);
    for (stage = 1; stage < method->stages; ++stage) sym_batch_evaluate_stage(b, stage);
    if (b->prototype->method == SYM_METHOD_EXPLICIT) sym_batch_combine_slopes(b, method->stages, method->b, b->y1);
    for (i = b->n_active - 1; i >= 0; --i) {
        sym_run *r = b->runs + i;
        sym_workspace w = sym_batch_workspace(b, i);
        int32_t status = b->status[i];
        double error = 0.0;
        if (r->method == SYM_METHOD_SEMI_IMPLICIT) sym_semi_implicit_step(r, b->h[i], w.k, w.y1);
        if (status == 0) status = sym_estimate_error(r, &w, b->h[i], &error);
        status = sym_batch_accept_or_reject(b, i, &w, status, error);
        r->system->in_step = 0;
        if (status == 0 && r->t >= r->t_end) status = SYM_FINISHED;
        if (status != 0 || (b->max_steps > 0 && r->steps >= b->max_steps)) sym_batch_retire(b, i, status);
    }
}

SYM_EXPORT int32_t sym_batch_advance(sym_batch *b, int64_t max_steps) {
    for (b->left = max_steps; b->left > 0; --b->left) {
        if (!sym_batch_can_record(b)) return SYM_RECORDS_FULL;
        if (b->n_active < b->slots && b->next < b->n) sym_columns_leave(b);
        while (b->n_active < b->slots && b->next < b->n) {
            if (!sym_batch_can_record(b)) return SYM_RECORDS_FULL;
            sym_batch_activate_next(b);
        }
        if (b->n_active == 0) return 0;
        if (b->forward_dynamics.lanes != NULL) {
            if (!b->in_columns) sym_columns_enter(b);
            if (sym_columns_step(b)) continue;
            sym_columns_leave(b);
        }
        sym_batch_step(b);
    }
    return b->n_active > 0 || b->next < b->n ? 1 : 0;
}

SYM_EXPORT void sym_batch_stop(sym_batch *b) {
    sym_columns_leave(b);
    while (b->n_active > 0) sym_batch_retire(b, b->n_active - 1, SYM_RUNNING);
    for (; b->next < b->n; b->next += b->stride) {
        const double *q = b->q0.at + b->next * b->q0.stride, *v = b->v0.at + b->next * b->v0.stride;
        sym_batch_store_result(b, b->next, SYM_RUNNING, b->prototype->t0, q, v);
    }
}
