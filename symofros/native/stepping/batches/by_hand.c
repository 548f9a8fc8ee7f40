/* Runs that are stepped by hand: symofros_hand.h. */

/* Inputs u that are held from the present state on. What was evaluated there with others is not valid any more. */
static void sym_hold(sym_run *r, const int32_t *held, int32_t n, const double *u, double *constant) {
    int32_t i, changed = 0;
    for (i = 0; i < n; ++i) changed |= constant[held[i]] != u[i];
    if (!changed) return;
    for (i = 0; i < n; ++i) constant[held[i]] = u[i];
    r->slope_valid = r->jacobian_valid = 0;
    r->system->held_anew = 1;
}

/* Note the inputs from the present state on. */
static void sym_hand_note(sym_hand *hand) {
    const int32_t nu = hand->run->system->nu;
    hand->noted_t[hand->n] = hand->run->t;
    memcpy(hand->noted_u + hand->n * nu, hand->u, (size_t)nu * sizeof *hand->u);
    ++hand->n;
}

/* Whether the mark that is wanted is reached. */
static int32_t sym_hand_is_there(const sym_hand *hand) {
    const sym_run *r = hand->run;
    return r->adaptive ? r->t >= r->t_end : r->steps >= hand->target;
}

SYM_EXPORT int32_t sym_hand_go_on(sym_hand *hand) {
    sym_run *r = hand->run;
    int32_t status = SYM_RUNNING;
    if (hand->status != SYM_RUNNING) return hand->status;
    if (r->adaptive) r->t_end = sym_multiple(r->t0 + (double)hand->target * hand->dt, hand->dt);
    while (status == SYM_RUNNING && !sym_hand_is_there(hand))
        status = sym_run_advance(r, r->adaptive ? INT32_MAX : hand->target - r->steps);
    if (status == SYM_FINISHED) status = SYM_RUNNING;
    if (status == SYM_RECORDS_FULL) return status;
    hand->status = status;
    if (status != SYM_RUNNING) return status;
    hand->mark = hand->target;
    return hand->n >= hand->capacity || r->n_event_records > 0 ? SYM_RECORDS_FULL : SYM_RUNNING;
}

SYM_EXPORT int32_t sym_hand_step(sym_hand *hand, const double *u, int64_t steps) {
    int32_t i;
    if (hand->status != SYM_RUNNING) return SYM_CALLBACK_FAILED;
    if (u != NULL) {
        double zero = 0.0;
        for (i = 0; i < hand->n_held; ++i) zero += 0.0 * u[i];
        if (zero != 0.0) return SYM_CALLBACK_FAILED;
        sym_hold(hand->run, hand->held, hand->n_held, u, hand->u);
    }
    if (!hand->started || hand->run->system->held_anew) sym_hand_note(hand);
    if (!hand->started) {
        hand->started = 1;
        hand->status = sym_run_start(hand->run);
    }
    hand->target = hand->mark + steps;
    return sym_hand_go_on(hand);
}

/* Active trajectories of a group take the slots, which other groups had before, and hold inputs, others if they are given. */
static void sym_hand_batch_hold(const sym_hand_batch *hand, sym_batch *b, const double *u) {
    const int32_t nu = b->prototype->system->nu;
    int32_t i;
    for (i = 0; i < b->n_active; ++i) {
        const int64_t k = b->trajectory_of_slot[i];
        sym_batch_assign(b, i, k);
        if (u != NULL) sym_hold(b->runs + i, hand->held, hand->n_held, u + k * hand->n_held, hand->u + k * nu);
        memcpy(b->systems[i].u, hand->u + k * nu, (size_t)nu * sizeof *u);
    }
}

/* The same where states are in columns. */
static void sym_hand_columns_hold(const sym_hand_batch *hand, sym_batch *b, const double *u) {
    const int32_t nu = b->prototype->system->nu, n = hand->n_held;
    int32_t i, l;
    for (i = 0; u != NULL && i < b->n_active; ++i) {
        const int64_t k = b->trajectory_of_slot[i];
        for (l = 0; l < n; ++l) {
            const double value = u[k * n + l];
            hand->u[k * nu + hand->held[l]] = b->column_u[SYM_INDEX(hand->held[l], b->slots, i)] = value;
        }
    }
}

/* A trajectory begins, or begins anew; one whose status says that it can't keeps that. */
static void sym_hand_batch_begin(const sym_hand_batch *hand, sym_batch *b, int64_t k, const double *u) {
    double *constant = hand->u + k * b->prototype->system->nu;
    int32_t i;
    for (i = 0; i < b->n_active && b->trajectory_of_slot[i] != k; ++i) {}
    if (i < b->n_active) sym_batch_retire(b, i, b->final_status[k]);
    for (i = 0; u != NULL && i < hand->n_held; ++i) constant[hand->held[i]] = u[k * hand->n_held + i];
    b->next = k;
    sym_batch_activate_next(b);
}

/* Times, states and numbers of steps of the active trajectories go where the caller reads them. */
static void sym_hand_batch_store(sym_batch *b) {
    const int32_t nv = b->prototype->system->nv;
    int32_t i;
    for (i = 0; i < b->n_active; ++i) {
        const int64_t k = b->trajectory_of_slot[i];
        const sym_run *r = b->runs + i;
        if (b->in_columns) {
            b->final_t[k] = b->column_t[i], b->steps[k] = (int64_t)b->column_steps[i];
            sym_column_state(b, i, b->final_q + k * nv, b->final_v + k * nv);
        } else {
            sym_batch_store_result(b, k, SYM_RUNNING, r->t, r->q, r->v);
            b->steps[k] = r->steps;
        }
    }
}

/* A group takes inputs, and those of its trajectories begin that are to. */
static void sym_hand_begin_group(const sym_hand_batch *hand, sym_batch *b, int64_t first, const double *u) {
    int32_t begins = 0;
    int64_t k;
    for (k = first; k < b->n; ++k) begins |= hand->begins[k];
    if (begins) sym_columns_leave(b);
    if (b->in_columns) sym_hand_columns_hold(hand, b, u);
    else sym_hand_batch_hold(hand, b, u);
    for (k = first; begins && k < b->n; ++k) {
        if (!hand->begins[k]) continue;
        hand->begins[k] = 0;
        sym_hand_batch_begin(hand, b, k, u);
    }
    b->next = b->n;
}

SYM_EXPORT int32_t sym_hand_batch_go_on(sym_hand_batch *hand, const double *u) {
    while (hand->group < hand->n_groups) {
        sym_batch *b = hand->groups + hand->group;
        if (!hand->begun) {
            if (!sym_batch_can_record(b)) return SYM_RECORDS_FULL;
            sym_hand_begin_group(hand, b, hand->first_of_group, u);
            b->left = hand->steps, hand->begun = 1;
        }
        if (sym_batch_advance(b, b->left) == SYM_RECORDS_FULL) return SYM_RECORDS_FULL;
        sym_hand_batch_store(b);
        hand->first_of_group = b->n, hand->begun = 0, ++hand->group;
    }
    return 0;
}

SYM_EXPORT int32_t sym_hand_batch_step(sym_hand_batch *hand, const double *u, int64_t steps) {
    hand->group = 0, hand->begun = 0, hand->first_of_group = hand->first, hand->steps = steps;
    return sym_hand_batch_go_on(hand, u);
}
