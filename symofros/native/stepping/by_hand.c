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
