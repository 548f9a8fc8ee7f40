/* The integration loop: one step after the other, each tried, then accepted or rejected. */

/* k[0] <- slope at the present state, whose accelerations have just been evaluated. */
static void sym_store_first_slope(sym_run *r, double *k) {
    const int32_t nv = r->system->nv;
    memcpy(k, r->v, (size_t)nv * sizeof *k);
    memcpy(k + nv, r->system->a, (size_t)nv * sizeof *k);
    r->slope_valid = 1, r->jacobian_valid = 0;
}

/* k[0] <- slope at the present state, unless it is known. Notes the rank of the constraints. Returns 0 or a status. */
static int32_t sym_first_slope(sym_run *r, double *k) {
    int32_t status = 0;
    if (!r->slope_valid) {
        sym_load_start(r);
        status = sym_evaluate_acceleration(r);
        if (status == 0) sym_store_first_slope(r, k);
    }
    if (r->system->nc > 0 && status == 0) {
        const int32_t rank = (int32_t)*r->system->rank;
        r->rank = rank;
        if (rank > r->rank_max) r->rank_max = rank;
        if (rank < r->rank_min) r->rank_min = rank, r->t_rank_min = r->t;
    }
    return status;
}

/* The error norm of an explicit step whose y1 is known. Returns 0 or a status. */
static int32_t sym_estimate_error(sym_run *r, const sym_workspace *w, double h, double *error) {
    *error = r->adaptive ? sym_error_norm(r, w, h) : 0.0;
    return sym_check_end_of_step(r, w->y1) ? 0 : SYM_DIVERGED;
}

/* y1 and the error norm of an explicit step whose stages are known. Returns 0 or a status. */
static int32_t sym_finish_explicit_step(sym_run *r, sym_workspace *w, double h, double *error) {
    if (r->method == SYM_METHOD_EXPLICIT) sym_combine_slopes(r, w, h, r->tableau.stages, r->tableau.b, w->y1);
    else sym_semi_implicit_step(r, h, w->k, w->y1);
    return sym_estimate_error(r, w, h, error);
}

/* One attempt at a step of length h: y1, and the error norm where the method estimates one. Returns 0 or a status. */
static int32_t sym_try_step(sym_run *r, sym_workspace *w, double h, double *error) {
    int32_t status;
    *error = 0.0;
    if (r->method == SYM_METHOD_EXPLICIT || r->method == SYM_METHOD_SEMI_IMPLICIT) {
        status = sym_evaluate_stages(r, w, h, 1, r->tableau.stages);
        return status != 0 ? status : sym_finish_explicit_step(r, w, h, error);
    }
    if (r->method == SYM_METHOD_ROSENBROCK) {
        status = sym_rosenbrock_step(r, w, h, error);
    } else if (r->method == SYM_METHOD_ALPHA) {
        status = sym_generalized_alpha_step(r, w, h);
    } else {
        status = sym_variational_step(r, w, h);
    }
    if (status == 0 && !sym_check_end_of_step(r, w->y1)) status = SYM_DIVERGED;
    return status;
}

/* Of generalized alpha: dissipates high frequencies of beams and keeps low ones (docs/theory/simulation.md, section 4). */
#define SYM_SPECTRAL_RADIUS 0.8
/* Newton's iterations converge quadratically near the end: two digits above rounding cost no further one. */
#define SYM_NEWTON_TOLERANCE 1e-12

SYM_EXPORT void sym_run_set_defaults(sym_run *r) {
    r->spectral_radius = SYM_SPECTRAL_RADIUS;
    r->loss_limit = INFINITY;
    r->newton_tolerance = SYM_NEWTON_TOLERANCE;
}

/* A motion begins at the present state: its first slope, and the size of an adaptive method's first step. Returns 0 or a
 * status. */
static int32_t sym_begin_motion(sym_run *r, sym_workspace *w) {
    int32_t status;
    r->previous_error = 1.0, r->met_at = -HUGE_VAL;
    r->lost_energy = r->kinetic_energy = 0.0;
    status = sym_run_judge_beams(r);
    if (status != 0) return status;
    status = sym_first_slope(r, w->k);
    if (status != 0) return status;
    sym_keep_diagnostic_state(r, 0);
    status = sym_restart_events(r);
    if (status == 0) status = sym_check_contacts(r);
    if (status != 0) return status;
    r->next_step = r->h;
    if (!r->adaptive || r->h > 0.0) return 0;
    status = sym_initial_step_size(r, w);
    if (r->method == SYM_METHOD_ROSENBROCK) r->slope_valid = 0; /* the Jacobian is evaluated at the present state */
    return status;
}

SYM_EXPORT int32_t sym_run_start(sym_run *r) {
    sym_workspace w = sym_workspace_of(r);
    sym_system *s = r->system;
    r->slope_valid = 0;
    r->steps = r->rejected = r->evaluations = r->jacobians = 0;
    r->n_records = r->next_grid = 0;
    r->n_diagnostic = 0, r->diagnostic_stride = 1, r->diagnostic_between = 0;
    r->rank = 0, r->rank_max = -1, r->rank_min = s->nc + 1;
    r->terminal_event = r->touched_event = r->unresolved_event = -1;
    r->clock_start = r->realtime_scale > 0.0 ? sym_clock_seconds() : 0.0;
    r->t_from = r->t0, r->n_from = 0;
    if (r->actions != NULL) sym_note_begin(r);
    if (s->n_sticking > 0 && r->actions != NULL) {
        const int32_t status = sym_choose_modes(r);
        if (status != 0) return status;
    }
    if (s->n_contacts > 0 && r->actions != NULL) {
        const int32_t status = sym_begin_contacts(r);
        if (status != 0) return status;
    }
    sym_load_state(r);
    {
        const int32_t status = r->record_every > 0 ? sym_record(r) : sym_record_grid_at_end(r, r->h);
        if (status != 0) return status;
    }
    return sym_begin_motion(r, &w);
}

/* After actions the motion begins anew. Returns 0 or a status. */
static int32_t sym_begin_motion_anew(sym_run *r, sym_workspace *w) {
    r->slope_valid = r->jacobian_valid = 0;
    if (r->look_every > 0.0 && r->look_every < HUGE_VAL) r->look_every = (r->t_end - r->t) / SYM_LOOKS;
    return sym_begin_motion(r, w);
}

/* The times of the grid that are the instant of actions, which are done, with that status. Returns it, or another one. */
static int32_t sym_record_grid_after_actions(sym_run *r, int32_t status) {
    const int32_t records = r->record_every == 0 && (status == 0 || status == SYM_TERMINAL_EVENT);
    const int32_t recorded = records ? sym_record_grid_at_end(r, r->h) : 0;
    return recorded != 0 ? recorded : status;
}

/* After a step that ended at events: do their actions, where the run does, and go on. Returns SYM_RECORDS_FULL, so that the
 * caller sees it, or a status. */
static int32_t sym_go_on_from_events(sym_run *r, sym_workspace *w) {
    int32_t status = sym_record_grid_after_actions(r, sym_run_act(r));
    if (status != 0) return status;
    status = sym_begin_motion_anew(r, w);
    return status != 0 ? status : SYM_RECORDS_FULL;
}

/* The present state <- the end of the step, at time t1. */
static void sym_set_end_state(sym_run *r, const sym_workspace *w, double t1) {
    const sym_system *s = r->system;
    memcpy(r->q, w->end_state, (size_t)s->nq * sizeof *r->q);
    memcpy(r->v, w->end_state + s->nq, (size_t)s->nv * sizeof *r->v);
    r->t = t1;
    if (s->n_contacts > 0) sym_keep_directions(r);
    r->system->in_step = r->system->held_anew = 0;
}

/* Whether event i is of a ball of a rigid contact that has been open, and meets its surface. */
static int32_t sym_ball_meets(const sym_run *r, int32_t i) {
    const int32_t first = r->system->n_contacts > 0 ? sym_first_contact_event(r) : i + 1;
    return i >= first && (i - first) % 2 == 0 && r->par[r->system->contacts[(i - first) / 2].mode] == SYM_OPEN;
}

/* Whether actions are done at the events at which the step has been cut, and whether bodies strike there: speeds are set. */
static int32_t sym_acts_at_cut(const sym_run *r, int32_t *strikes) {
    int32_t acts = 0;
    int64_t row;
    *strikes = 0;
    if (r->actions == NULL) return 0;
    for (row = r->n_event_records - 1; row >= r->first_met && r->event_t[row] >= r->event_t[r->n_event_records - 1]; --row) {
        const int32_t which = r->event_index[row];
        acts |= r->actions->acts[which] != 0;
        *strikes |= sym_sets_speeds(r, which) || sym_ball_meets(r, which);
    }
    return acts;
}

/* Evaluation point <- the state at x, where the step just made has been cut. Bodies strike with the rate of the path along which
 * they have met; a method of order 1 has speeds that differ from it by a share of h v' (docs/theory/simulation.md, (4d)). Returns 0
 * or a status. */
static int32_t sym_load_state_at_cut(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double x, int32_t strikes) {
    const int32_t nv = r->system->nv;
    const int32_t first_order = r->method <= SYM_METHOD_ROSENBROCK && r->tableau.stages == 1;
    double *rate = w->magnitude;
    int32_t l, status;
    if (!strikes || !first_order || x == 0.0 || x == 1.0) return sym_load_state_within_step(r, w, h, dense_ready, x);
    status = sym_dense_output(r, w, h, dense_ready, x, w->stage);
    if (status != 0) return status;
    sym_chart_rate(r->system, w->stage, w->stage + nv, rate);
    for (l = 0; l < nv; ++l)
        w->stage[nv + l] += sym_cubic_slope(x, w->y1[l] / h, w->k[l], w->end_slope[l]) - rate[l];
    return sym_load_projected_state(r, r->t + x * h, w->stage);
}

/* An accepted step from r->t to t1: its end, projected; events and records on the way to it; the new state. Records and
 * events are states of the path that is integrated: what lies between two ends of steps is projected as these are.
 * Returns 0 or a status. */
static int32_t sym_accept_step(sym_run *r, sym_workspace *w, double h, double t1) {
    sym_system *s = r->system;
    const int32_t nv = s->nv, fsal = r->method == SYM_METHOD_EXPLICIT && r->tableau.fsal_stage > 0;
    int32_t dense_ready = 0, status, beyond, cut = 0, ended = 0, acts = 0, strikes = 0;
    double stop_x = 2.0, energies[2] = {0.0, 0.0};
    status = sym_load_projected_state(r, t1, w->y1);
    if (status != 0) return status;
    if (r->project) memcpy(energies, s->project.out[4], sizeof energies);
    sym_store_end_state(s, w);
    if (s->n_events > 0) {
        status = sym_find_events(r, w, h, &dense_ready, &stop_x);
        if (status != 0) return status;
        cut = stop_x <= 1.0, ended = r->terminal_event >= 0, acts = ended && sym_acts_at_cut(r, &strikes);
        if (cut && r->project) memcpy(energies, s->project.out[4], sizeof energies); /* what lies behind is not gone through */
    }
    if (r->project) status = sym_judge_projection(r, energies);
    if (status != 0) return status;
    if (r->record_every == 0) {
        const double up_to = cut ? stop_x : 1.0, same = acts ? SYM_GRID_ACTED * fabs(r->t + stop_x * h) / h : 0.0;
        status = sym_record_grid_within_step(r, w, h, &dense_ready, up_to - same);
        if (status != 0) return status;
    }
    if (cut) {
        status = sym_load_state_at_cut(r, w, h, &dense_ready, stop_x, strikes);
        if (status != 0) return status;
        sym_store_end_state(s, w);
        t1 = *s->t, r->beam_step_way = HUGE_VAL;
    }
    beyond = sym_judge_step(r, t1, w->end_state);
    sym_set_end_state(r, w, t1);
    r->slope_valid = 0;
    /* First same as last, but in the chart about the new state, where theta' = v. */
    if (!cut && !sym_changes_at(s, t1)) {
        const double *slope = NULL;
        if (fsal && !r->project) slope = w->k + SYM_INDEX(r->tableau.fsal_stage, w->stage_stride, 0);
        else if (!fsal && dense_ready && s->n_events > 0 && r->method <= SYM_METHOD_SEMI_IMPLICIT) slope = w->end_slope;
        if (slope != NULL) {
            memcpy(w->k + nv, slope + nv, (size_t)nv * sizeof(double));
            memcpy(w->k, r->v, (size_t)nv * sizeof(double));
            r->slope_valid = 1;
        }
    }
    if (!cut || ended) ++r->steps; /* else a step of fixed length goes on to its end */
    if (cut) { /* not the state that sym_find_events evaluated */
        status = sym_restart_events(r);
        if (status != 0) return status;
    }
    if (r->record_every == 0) { /* at actions, by what does them: the state of an instant is the one after them */
        status = acts ? 0 : sym_record_grid_at_end(r, h);
        if (status != 0) return status;
    } else if (r->steps % r->record_every == 0 || r->t >= r->t_end || ended || beyond != 0) {
        sym_load_state(r);
        status = sym_record(r);
        if (status != 0) return status;
    }
    if (!cut || ended) sym_keep_diagnostic_state(r, r->t >= r->t_end || ended);
    if (beyond == 0) beyond = sym_judge_axial_loads(r);
    if (r->realtime_scale > 0.0) sym_wait_for_clock(r);
    if (ended) r->met_end = r->n_event_records;
    return beyond != 0 ? beyond : ended ? SYM_TERMINAL_EVENT : 0;
}

/* Whether one more step fits into the records. */
static int32_t sym_records_fit(const sym_run *r) {
    const int32_t records = r->record_every == 0 || r->n_records < r->capacity; /* a grid fits as a whole */
    return records && r->n_event_records + r->system->n_events <= r->event_capacity;
}

/* The step that was tried is not taken. What the constraints' rank was in its stages says nothing of the motion. */
static void sym_reject_step(sym_run *r, double next_step) {
    ++r->rejected, r->next_step = next_step;
    if (r->system->nc > 0) *r->system->rank = r->rank;
}

/* After a step was tried, with that status and error norm: accept it, or reject it and shorten the next one. Returns 0
 * or a status. */
static int32_t sym_accept_or_reject(sym_run *r, sym_workspace *w, double h, double t1, int32_t status, double error) {
    if (status == SYM_CALLBACK_FAILED || status == SYM_NO_ROTATION) return status;
    if (r->adaptive && (status != 0 || !(error <= 1.0))) {
        sym_reject_step(r, status != 0 || !(error == error) ? 0.25 * h : sym_next_step_size(r, h, error));
        return 0;
    }
    if (status != 0) return status;
    if (r->adaptive && (status = sym_look_within_step(r, w, h, error)) <= 0) {
        if (status == 0) sym_reject_step(r, h);
        return status;
    }
    if (r->adaptive) {
        const double proposed = r->next_step;
        r->next_step = sym_next_step_size(r, h, error);
        if (2.0 * h < proposed && r->next_step < proposed) r->next_step = proposed; /* cut at a sample, not by its error */
        r->previous_error = error > 1e-4 ? error : 1e-4; /* one lucky step does not steer the next */
    }
    return sym_accept_step(r, w, h, t1);
}

SYM_EXPORT int32_t sym_run_advance(sym_run *r, int64_t max_steps) {
    sym_workspace w = sym_workspace_of(r);
    int64_t done;
    for (done = 0; done < max_steps; ++done) {
        double h, error, t1;
        int32_t status;
        if (r->t >= r->t_end) return SYM_FINISHED;
        if (!sym_records_fit(r)) return SYM_RECORDS_FULL;
        status = sym_first_slope(r, w.k);
        if (status == 0) status = sym_propose_step(r, &w, &h, &t1);
        if (status != 0) return status;
        status = sym_try_step(r, &w, h, &error);
        status = sym_accept_or_reject(r, &w, h, t1, status, error);
        r->system->in_step = 0;
        if (status == SYM_TERMINAL_EVENT && r->acts) status = sym_go_on_from_events(r, &w);
        if (status != 0) return status;
    }
    return r->t >= r->t_end ? SYM_FINISHED : SYM_RUNNING;
}
