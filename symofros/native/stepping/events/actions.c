/* Actions of events: what they set, the constraints that engage, the impact (docs/theory/constraints.md, section 13). */
SYM_EXPORT void sym_run_set_parameters(sym_run *r, const double *par) {
    const sym_system *s = r->system;
    const sym_call *calls[] = {&s->forward_dynamics, &s->law,      &s->events,      &s->project,
                               &s->implicit_terms,   &s->residual, &s->momentum,    &s->mass_matrix,
                               &s->constraint_jacobian, &s->contact_state};
    size_t i;
    memcpy(r->par, par, (size_t)r->actions->npar * sizeof *par);
    sym_hold_by_modes(r->system, par);
    for (i = 0; i < sizeof calls / sizeof *calls; ++i) sym_prepare_call(calls[i], par);
    r->slope_valid = r->jacobian_valid = 0;
}

/* Quaternion (x, y, z, w) of the rotation R_B^T R_A, by its largest entry, which loses no digits. */
static void sym_relative_rotation(const double *R_B, const double *R_A, double *quaternion) {
    double R[9], outer[16], largest = -HUGE_VAL;
    int32_t i, j, row = 0;
    for (i = 0; i < 3; ++i)
        for (j = 0; j < 3; ++j) R[3 * i + j] = R_B[i] * R_A[j] + R_B[3 + i] * R_A[3 + j] + R_B[6 + i] * R_A[6 + j];
    for (i = 0; i < 3; ++i) { /* 4 q q^T */
        const int32_t k = (i + 1) % 3, l = (i + 2) % 3;
        outer[5 * i] = R[4 * i] - R[4 * k] - R[4 * l] + 1.0;
        outer[4 * i + k] = outer[4 * k + i] = R[3 * i + k] + R[3 * k + i];
        outer[4 * i + 3] = outer[12 + i] = R[3 * l + k] - R[3 * k + l];
    }
    outer[15] = R[0] + R[4] + R[8] + 1.0;
    for (i = 0; i < 4; ++i)
        if (outer[5 * i] > largest) largest = outer[5 * i], row = i;
    for (i = 0, largest = 0.0; i < 4; ++i) largest += outer[4 * row + i] * outer[4 * row + i];
    for (i = 0; i < 4; ++i) quaternion[i] = outer[4 * row + i] / sqrt(largest);
}

/* Parameters with which a constraint is fulfilled at the evaluation point, (29) and (30). */
static void sym_hold_pose(const sym_actions *a, const sym_switch *of, double *par) {
    const sym_call *poses = a->poses + of->pose;
    int32_t i;
    for (i = 0; i < of->n_offsets; ++i) par[of->place[i]] = 0.0;
    if (of->rotation != NULL) {
        double quaternion[4];
        for (i = 0; i < 2; ++i) sym_prepare_call(poses + i, par), sym_evaluate(poses + i); /* p, R of A and of B */
        sym_relative_rotation(poses[1].out[1], poses[0].out[1], quaternion);
        for (i = 0; i < 4; ++i) par[of->rotation[i]] = quaternion[i];
    }
    sym_prepare_call(&a->constraint, par);
    sym_evaluate(&a->constraint);
    for (i = 0; i < of->n_offsets; ++i) par[of->place[i]] = a->constraint.out[0][of->row[i]];
}

/* Parameters and speeds as the action of an event sets them by the state at the evaluation point, poses that engage now
 * held. Returns how many constraints engage. */
static int32_t sym_assign(const sym_run *r, int32_t event, double *par, double *speeds) {
    const sym_actions *a = r->actions;
    const double *values = sym_action_values(a, r->par);
    double *before = a->engaged;
    int32_t i, rises = 0;
    for (i = 0; i < a->n_switches; ++i) before[i] = values[i];
    for (i = 0; i < a->n_assignments; ++i) {
        const sym_assignment *of = a->assignments + i;
        if (of->event == event) (of->is_speed ? speeds : par)[of->index] = values[of->value];
    }
    values = sym_action_values(a, par);
    for (i = 0; i < a->n_switches; ++i) before[i] = values[i] - before[i];
    for (i = 0; i < a->n_switches; ++i) {
        if (!(before[i] > 0.0)) continue;
        ++rises;
        if (a->switches[i].moment) sym_hold_pose(a, a->switches + i, par);
    }
    return rises;
}

SYM_EXPORT sym_done sym_run_done(const sym_run *r, int64_t row) {
    const sym_system *s = r->system;
    const size_t npar = (size_t)r->actions->npar, nv = (size_t)s->nv;
    sym_done done;
    done.acted = r->event_done + (size_t)row * sym_done_size(r), done.gap = done.acted + 1, done.in_sequence = done.acted + 2;
    done.u = done.acted + 3;
    done.v_set = done.u + s->nu, done.v_after = done.v_set + nv, done.q_after = done.v_after + nv;
    done.par = done.q_after + s->nq, done.par_set = done.par + npar;
    return done;
}

SYM_EXPORT size_t sym_done_size(const sym_run *r) {
    const sym_system *s = r->system;
    return 3 + (size_t)s->nu + 2 * (size_t)s->nv + (size_t)s->nq + 2 * (size_t)r->actions->npar;
}

/* Whether bodies that an impact without rebound has brought to rest on each other part again: the force that would hold them
 * together draws against the impulse, (32a). Parameters become those before the action. Returns 0 or a status. */
static int32_t sym_parts_again(sym_run *r, const sym_done *done) {
    const sym_system *s = r->system;
    const int32_t nv = s->nv;
    double along = 0.0, size = 0.0, *held = done->q_after; /* its room, of nq >= nv entries, is free until the end */
    int32_t i, status;
    sym_load_state(r);
    status = sym_evaluate_acceleration(r);
    if (status != 0) return status;
    memcpy(held, s->a, (size_t)nv * sizeof *held);
    sym_run_set_parameters(r, done->par);
    sym_let_go(s, r->par), sym_open_contacts(s, r->par), sym_hold_by_modes(s, r->par); /* modes are chosen later */
    sym_load_state(r);
    status = sym_evaluate_modes(r, r->par);
    if (status != 0) return status;
    for (i = 0; i < nv; ++i) {
        const double impulse = r->v[i] - done->v_set[i], force = held[i] - s->a[i];
        along += impulse * force, size += fabs(impulse) * (fabs(held[i]) + fabs(s->a[i]));
    }
    return along < -SYM_ACCELERATION_ROUNDING * size ? 0 : SYM_ACTS_WITHOUT_END;
}

/* What has become of the last of strikes that accumulate. */
#define SYM_RESTS 2.0

/* A contact that presses stays: parameters are those that its action has set. The force by which it will open has to
 * press as well. Returns 0 or a status. */
static int32_t sym_rest(sym_run *r, int32_t opens, const sym_done *done) {
    const sym_system *s = r->system;
    double *values = r->event_values + (SYM_EVENT_ROWS - 1) * s->n_events;
    int32_t status;
    sym_run_set_parameters(r, done->par_set);
    sym_load_state(r);
    status = sym_event_values(r, values);
    if (status != 0) return status;
    return values[opens] > 0.0 ? 0 : SYM_ACTION_REFUSED;
}

/* Parameters and speeds that an action has set take effect: the constraints that hold now take the speeds onto them; e is
 * Newton's coefficient of those that strike. Returns 0 or a status, with nothing changed then. */
static int32_t sym_impact(sym_run *r, double e, int32_t opens, const sym_done *done) {
    const size_t nv = (size_t)r->system->nv;
    int32_t status = 0, rests = 0;
    size_t i;
    sym_run_set_parameters(r, done->par_set);
    memcpy(done->v_after, r->v, nv * sizeof *r->v);
    memcpy(r->v, done->v_set, nv * sizeof *r->v);
    if (r->system->nc > 0) status = sym_run_engage(r, done->gap);
    if (status == 0 && e == 0.0) {
        status = sym_parts_again(r, done);
        if (status == SYM_ACTS_WITHOUT_END && opens >= 0) status = sym_rest(r, opens, done), rests = status == 0;
    }
    if (status != 0) memcpy(r->v, done->v_after, nv * sizeof *r->v);
    for (i = 0; status == 0 && e >= 0.0 && i < nv; ++i) r->v[i] += e * (r->v[i] - done->v_set[i]); /* (32) */
    if (status != 0 || (e >= 0.0 && !rests)) sym_run_set_parameters(r, done->par);
    if (status != 0) return status;
    memcpy(done->q_after, r->q, (size_t)r->system->nq * sizeof *r->q);
    memcpy(done->v_after, r->v, nv * sizeof *r->v);
    *done->acted = rests ? SYM_RESTS : 1.0;
    return 0;
}

/* Do the action of one event at the present state. Returns 0 or a status, with nothing changed then. */
static int32_t sym_act(sym_run *r, int32_t event, const sym_done *done) {
    const sym_actions *a = r->actions;
    sym_system *s = r->system;
    const int32_t opens = a->opens[event];
    double e = a->restitution[event];
    const size_t par_size = (size_t)a->npar * sizeof(double), v_size = (size_t)s->nv * sizeof(double);
    int32_t engaging, refused;
    memcpy(done->par, r->par, par_size), memcpy(done->par_set, r->par, par_size), memcpy(done->v_set, r->v, v_size);
    if (opens >= 0 && r->t - r->acted_at[event] <= sym_run_accumulation(r, r->t, e)) e = 0.0;
    else if (r->t - r->acted_at[event] <= sym_run_one_instant(r, r->t)) return SYM_ACTS_WITHOUT_END;
    r->acted_at[event] = r->t;
    sym_load_state(r);
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    memcpy(done->u, s->u, (size_t)s->nu * sizeof *s->u);
    engaging = sym_assign(r, event, done->par_set, done->v_set);
    refused = !sym_all_finite(s->nv, done->v_set) || (e >= 0.0 && engaging == 0);
    if (refused || a->refuses(a->data, done->par_set) != 0) {
        sym_run_set_parameters(r, done->par); /* functions may share the part that poses were prepared in */
        return SYM_ACTION_REFUSED;
    }
    sym_let_go(s, done->par_set), sym_open_contacts(s, done->par_set);
    return sym_impact(r, e, opens, done);
}

/* Rows of a step's events -> those at which it has been cut, in the order in which the events are stated. */
static void sym_sort_met(sym_run *r) {
    int64_t i, k;
    while (r->first_met < r->met_end && r->event_t[r->first_met] < r->t) ++r->first_met;
    for (i = r->first_met + 1; i < r->met_end; ++i) {
        const int32_t which = r->event_index[i];
        for (k = i; k > r->first_met && r->event_index[k - 1] > which; --k) r->event_index[k] = r->event_index[k - 1];
        r->event_index[k] = which;
    }
}

/* Share of a step within which the end of one is another's. */
#define SYM_AT_MARK 1e-9

/* Steps of fixed length stay where they were: the next one ends where the one that was cut, and is counted, would have. */
static void sym_move_marks(sym_run *r) {
    const double mark = sym_multiple(r->t_from + (double)(r->steps - r->n_from) * r->h, r->h), left = mark - r->t;
    if (r->adaptive || left <= SYM_AT_MARK * r->h) {
        r->t_from = r->t, r->n_from = r->steps;
        return;
    }
    --r->steps; /* counts when it ends */
    r->n_from = r->steps;
    if (r->h - left <= SYM_AT_MARK * r->h) r->t_from = r->t;
    else r->t_from = mark, ++r->n_from;
}

/* What has become of a mode, or of the run, at a row of events. */
static void sym_note_modes(const sym_run *r, const sym_done *done, int32_t status) {
    const sym_system *s = r->system;
    memcpy(done->par_set, r->par, (size_t)r->actions->npar * sizeof *r->par);
    memcpy(done->u, s->u, (size_t)s->nu * sizeof *r->v), memcpy(done->v_after, r->v, (size_t)s->nv * sizeof *r->v);
    memcpy(done->q_after, r->q, (size_t)s->nq * sizeof *r->q);
    *done->acted = status == 0 ? 1.0 : status;
}

/* What has become of the modes at a row of events that one of a rigid contact's ball is. */
static void sym_note_contact(const sym_run *r, const sym_done *done, int32_t ball) {
    const int32_t mode = r->system->contacts[ball].mode;
    sym_note_modes(r, done, 0);
    *done->in_sequence = *sym_struck_in_sequence(r->system) == r->t;
    if (done->par[mode] == SYM_OPEN && done->par_set[mode] != SYM_OPEN) *done->acted = SYM_RESTS;
}

/* Modes of rigid contacts where a motion begins; balls that strike there do so at an event of the first of them. Returns 0 or a
 * status. */
static int32_t sym_begin_contacts(sym_run *r) {
    const sym_system *s = r->system;
    const int64_t row = r->n_event_records;
    const sym_done done = sym_run_done(r, row);
    int32_t i, status;
    if (*sym_modes_chosen(s) != 0.0) return 0; /* a run that goes on from events, or after records */
    memcpy(done.par, r->par, (size_t)s->npar * sizeof *r->par);
    memcpy(done.v_set, r->v, (size_t)s->nv * sizeof *r->v);
    status = sym_settle_contacts(r, NULL);
    for (i = 0; i < s->n_contacts && status == 0 && row < r->event_capacity; ++i) {
        if (sym_ball_memory(s, i)[3] != r->t) continue;
        r->event_t[row] = r->t, r->event_index[row] = sym_first_contact_event(r) + 2 * i;
        memcpy(r->event_q + row * s->nq, r->q, (size_t)s->nq * sizeof *r->q);
        memcpy(r->event_v + row * s->nv, done.v_set, (size_t)s->nv * sizeof *r->v);
        *done.gap = 0.0;
        sym_note_contact(r, &done, i);
        r->n_event_records = row + 1;
        break;
    }
    return status;
}

/* Choose the modes of friction that sticks, or of rigid contacts, anew after the events at which the run has been cut. Returns
 * 0 or a status. */
static int32_t sym_end_modes(sym_run *r) {
    const sym_actions *a = r->actions;
    const sym_system *s = r->system;
    const int32_t first = a->first_mode, first_contact = sym_first_contact_event(r);
    double *met = a->modes + a->npar + 2 * s->n_sticking;
    int32_t i, status = 0, struck = 0;
    int64_t row;
    for (i = 0; i < s->n_contacts; ++i) met[i] = 0.0;
    for (row = r->first_met; row < r->met_end; ++row) {
        const int32_t which = r->event_index[row];
        const sym_done done = sym_run_done(r, row);
        if (which < first) continue;
        if (which >= first_contact) {
            double *of = met + (which - first_contact) / 2;
            if (*of <= 0.0) *of = (which - first_contact) % 2 ? -1.0 : 1.0;
        }
        memcpy(done.par, r->par, (size_t)r->actions->npar * sizeof *r->par);
        memcpy(done.v_set, r->v, (size_t)r->system->nv * sizeof *r->v);
        if (status == 0) status = sym_count_repeats(r, which);
    }
    if (status == 0 && s->n_sticking > 0) status = sym_choose_modes(r);
    if (status == 0 && s->n_contacts > 0) status = sym_settle_contacts(r, met);
    for (row = r->first_met; row < r->met_end; ++row) {
        const sym_done done = sym_run_done(r, row);
        const int32_t ball = r->event_index[row] >= first_contact ? (r->event_index[row] - first_contact) / 2 : -1;
        if (status != 0 ? row + 1 < r->met_end : r->event_index[row] < first) continue;
        if (status == 0 && ball >= 0) sym_note_contact(r, &done, ball);
        else sym_note_modes(r, &done, status);
        /* What each ball loses that strikes with others is not known: the first event has it all. */
        if (struck) memcpy(done.v_set, r->v, (size_t)s->nv * sizeof *r->v);
        struck |= ball >= 0;
    }
    return status;
}

SYM_EXPORT int32_t sym_run_act(sym_run *r) {
    const sym_system *s = r->system;
    int32_t ended = 0, status = 0;
    int64_t row;
    sym_sort_met(r);
    for (row = r->first_met; row < r->met_end; ++row) {
        const int32_t which = r->event_index[row];
        const sym_done done = sym_run_done(r, row);
        *done.acted = *done.gap = *done.in_sequence = 0.0;
        memcpy(r->event_q + row * s->nq, r->q, (size_t)s->nq * sizeof *r->q);
        memcpy(r->event_v + row * s->nv, r->v, (size_t)s->nv * sizeof *r->v);
        ended |= s->event_terminal[which] == 1;
        if (status != 0 || !r->actions->acts[which] || which >= r->actions->first_mode) continue;
        status = sym_act(r, which, &done);
        if (status == 0 && r->actions->once[which]) s->event_terminal[which] = -1;
        if (status != 0) *done.acted = status;
    }
    if (status == 0 && s->n_sticking + s->n_contacts > 0) status = sym_end_modes(r);
    if (status != 0) return status;
    sym_move_marks(r);
    return ended ? SYM_TERMINAL_EVENT : 0;
}
