/* Instants, and the motion of the parts between them: symofros_diagram.h. */

static sym_point sym_diagram_point(const sym_diagram *d) {
    static const char *const names[] = {"q", "v", "u", "t", "a", "lam"};
    sym_point point = {6, NULL, {NULL}};
    point.names = names;
    point.arrays[0] = d->q, point.arrays[1] = d->v, point.arrays[2] = d->u;
    point.arrays[3] = d->t, point.arrays[4] = d->a, point.arrays[5] = d->lam;
    return point;
}

SYM_EXPORT int32_t sym_diagram_bind(sym_diagram *d, sym_call *call) {
    const sym_point point = sym_diagram_point(d);
    return sym_bind_inputs(call, &point);
}

static double sym_instant_time(const sym_diagram *d, int64_t cycle, int64_t instant) {
    const int64_t ticks = cycle * d->cycle_ticks + d->instant_tick[instant];
    return sym_multiple(d->t0 + (double)ticks * d->base_numerator / d->base_denominator, d->base_numerator / d->base_denominator);
}

/* The diagram's point <- the states of the parts, and the signals at time t. */
static void sym_gather_states(sym_diagram *d, double t) {
    int32_t i;
    *d->t = t;
    for (i = 0; i < d->n_parts; ++i) {
        const sym_run *r = d->parts[i];
        memcpy(d->q + d->q_offset[i], r->q, (size_t)r->system->nq * sizeof(double));
        memcpy(d->v + d->v_offset[i], r->v, (size_t)r->system->nv * sizeof(double));
    }
    for (i = 0; i < d->n_signals; ++i) d->u[d->signals[i].input] = sym_signal_at(&d->signals[i], t, HUGE_VAL);
}

/* a, lam <- accelerations and multipliers of the parts at their present states, under the present u. Returns 0 or a
 * status. */
static int32_t sym_evaluate_parts(sym_diagram *d) {
    int32_t i, status;
    for (i = 0; i < d->n_parts; ++i) {
        sym_run *r = d->parts[i];
        sym_load_state(r);
        status = sym_evaluate_acceleration(r);
        if (status != 0) {
            d->failed_part = i;
            return status;
        }
        memcpy(d->a + d->v_offset[i], r->system->a, (size_t)r->system->nv * sizeof(double));
        memcpy(d->lam + d->c_offset[i], r->system->lam, (size_t)r->system->nc * sizeof(double));
    }
    return 0;
}

/* Most records between two checks of the capacity: both sides of a crossing, an instant, the end. */
enum { SYM_RECORDS_PER_INSTANT = 4 };

static int32_t sym_diagram_record(sym_diagram *d) {
    const int64_t n = d->n_records;
    d->record_t[n] = *d->t;
    memcpy(d->record_q + n * d->nq, d->q, (size_t)d->nq * sizeof(double));
    memcpy(d->record_v + n * d->nv, d->v, (size_t)d->nv * sizeof(double));
    memcpy(d->record_u + n * d->nu, d->u, (size_t)d->nu * sizeof(double));
    ++d->n_records;
    return 0;
}

/* Execute tasks at the diagram's point, one after the other. Returns 0 or a status. */
static int32_t sym_execute_tasks(sym_diagram *d, const sym_task *tasks, int32_t n) {
    int32_t i;
    for (i = 0; i < n; ++i) {
        const sym_task *task = &tasks[i];
        sym_evaluate(&task->call);
        if (task->callback >= 0) {
            if (d->callback(d->data, task->callback, *d->t, task->call.out[0], d->u) != 0) return SYM_CALLBACK_FAILED;
            continue;
        }
        memcpy(d->u, task->call.out[0], (size_t)d->nu * sizeof(double));
        if (task->call.function->n_out == 3) {
            memcpy(d->q, task->call.out[1], (size_t)d->nq * sizeof(double));
            memcpy(d->v, task->call.out[2], (size_t)d->nv * sizeof(double));
        }
    }
    return 0;
}

static void sym_diagram_wait_for_clock(sym_diagram *d, double t) {
    const double due = d->clock_start + (t - d->t0) * d->realtime_scale, early = due - sym_clock_seconds();
    if (early > 0.0) sym_sleep_seconds(early);
    if (d->n_lateness < d->lateness_capacity) d->lateness[d->n_lateness++] = sym_clock_seconds() - due;
}

/* Whether constraints have engaged or released since the last call. */
static int32_t sym_locks_changed(sym_diagram *d) {
    int32_t i, changed = 0;
    for (i = 0; i < d->n_locks; ++i) {
        const double now = d->u[d->lock_inputs[i]];
        if (now != d->lock_values[i]) changed = 1;
        if (now > d->lock_values[i]) d->engaged = i;
        d->lock_values[i] = now;
    }
    return changed;
}

/* Project a part whose constraints have just changed: a plastic impact. Returns 0 or a status. */
static int32_t sym_engage(sym_diagram *d, sym_run *r, double t) {
    double gap;
    const int32_t status = sym_run_engage(r, &gap);
    if (gap > d->engaged_gap) d->engaged_gap = gap, d->engaged_t = t;
    return status;
}

/* Project the parts onto their constraints at once. Returns 0 or a status. */
static int32_t sym_project_parts(sym_diagram *d, double t) {
    int32_t i, status;
    for (i = 0; i < d->n_parts; ++i) {
        if (!d->parts[i]->project) continue;
        status = sym_engage(d, d->parts[i], t);
        if (status != 0) {
            d->failed_part = i;
            return status;
        }
    }
    sym_gather_states(d, t);
    return 0;
}

/* Evaluate what is located anew. A crossing whose value tasks have carried through zero is met where the next step begins,
 * but not one whose own task was executed. Returns 0 or a status. */
static int32_t sym_look_anew(const sym_diagram *d, sym_run *r) {
    double *before = r->event_values + (SYM_EVENT_ROWS - 1) * r->system->n_events;
    int32_t i, status;
    int64_t row;
    if (r->system->n_events == 0) return 0;
    memcpy(before, r->event_values, (size_t)d->n_crossings * sizeof *before);
    for (row = r->first_met; row < r->met_end; ++row)
        if (r->event_t[row] == r->t && r->event_index[row] < d->n_crossings) before[r->event_index[row]] = 0.0;
    status = sym_restart_events(r);
    if (status != 0) return status;
    for (i = 0; i < d->n_crossings; ++i)
        if (sym_arrives_at_zero(r->system->event_direction[i], before[i], r->event_values[i])) r->event_values[i] = before[i];
    return 0;
}

/* Memory that begins by what signals are <- that. Returns 0 or a status. */
static int32_t sym_begin_memory(sym_diagram *d) {
    int32_t i, status = 0;
    d->begun = 1;
    if (d->begin_task == NULL) return 0;
    sym_gather_states(d, *d->t);
    if (d->reads_accelerations) status = sym_evaluate_parts(d);
    if (status == 0) status = sym_execute_tasks(d, d->begin_task, 1);
    for (i = 0; i < d->n_parts && status == 0; ++i) {
        d->parts[i]->slope_valid = 0;
        status = sym_look_anew(d, d->parts[i]);
    }
    return status;
}

/* Execute the next instant, at time t. Returns 0 or a status. */
static int32_t sym_execute_instant(sym_diagram *d, double t) {
    const sym_task_set *now = &d->task_sets[d->instant_set[d->next_instant]];
    int32_t i, status;
    if (d->realtime_scale > 0.0) sym_diagram_wait_for_clock(d, t);
    sym_gather_states(d, t);
    if (now->n > 0) {
        if (d->reads_accelerations && (status = sym_evaluate_parts(d)) != 0) return status;
        status = sym_execute_tasks(d, now->tasks, now->n);
        if (status == 0 && sym_locks_changed(d)) status = sym_project_parts(d, t);
        if (status != 0) return status;
        for (i = 0; i < d->n_parts; ++i) d->parts[i]->slope_valid = 0;
    }
    if (!d->begun && (status = sym_begin_memory(d)) != 0) return status;
    if (now->records) sym_diagram_record(d);
    if (++d->next_instant == d->n_instants) d->next_instant = 0, ++d->cycle;
    return 0;
}

/* Whether a part was stopped within a span by its own events: its steps then end where they would have. */
static int32_t sym_goes_on(const sym_run *r, double t) {
    return r->actions != NULL && r->t > r->t0 && r->t < r->t_end && r->t_end <= t;
}

/* Integrate one part to time t; steps of fixed length end at instants, too, and begin anew there. Returns SYM_FINISHED or
 * another status. */
static int32_t sym_advance_part(sym_run *r, double t) {
    int64_t steps = 0;
    int32_t status = SYM_FINISHED;
    while (status == SYM_FINISHED && r->t < t) {
        if (!sym_goes_on(r, t)) {
            r->t0 = r->t_from = r->t, r->t_end = r->adaptive ? t : sym_next_stop(r->system, r->t, t);
            r->steps = r->n_from = 0;
        }
        do {
            status = sym_run_advance(r, (int64_t)1 << 40);
        } while (status == SYM_RUNNING);
        steps += r->steps;
        r->n_from -= r->steps, r->steps = 0; /* a step's number counts from n_from on */
    }
    r->n_from += steps, r->steps = steps;
    return status;
}

/* Add a part's counters to the diagram's, and clear them. */
static void sym_add_counters(sym_diagram *d, sym_run *r) {
    d->steps += r->steps, d->rejected += r->rejected, d->evaluations += r->evaluations;
    r->n_from -= r->steps;
    r->steps = r->rejected = r->evaluations = 0;
}

/* What actions have set is memory of the diagram's. */
static void sym_keep_parameters(sym_diagram *d) {
    int32_t i;
    for (i = 0; i < d->n_kept; ++i) d->u[d->kept[i].input] = d->parts[d->kept[i].part]->par[d->kept[i].par];
}

/* Let go of what friction and rigid contacts hold in a part, whose modes are chosen anew afterwards. */
static void sym_let_go_of_part(sym_run *r) {
    double *par = r->actions->modes;
    memcpy(par, r->par, (size_t)r->actions->npar * sizeof *par);
    sym_let_go(r->system, par), sym_open_contacts(r->system, par);
    sym_run_set_parameters(r, par);
}

/* Execute the tasks of the crossings that stopped a part, all at the same time, one after the other. They may change inputs
 * and states. Returns 0 or a status. */
static int32_t sym_execute_crossings(sym_diagram *d, sym_run *stopped) {
    const int32_t has_modes = stopped->actions != NULL && stopped->system->n_sticking + stopped->system->n_contacts > 0;
    int32_t i, status, crossed = 0;
    int64_t row;
    for (row = stopped->first_met; row < stopped->met_end; ++row) crossed |= stopped->event_index[row] < d->n_crossings;
    if (!crossed) return 0;
    if (d->reads_accelerations && (status = sym_evaluate_parts(d)) != 0) return status;
    for (row = stopped->first_met; row < stopped->met_end; ++row) {
        if (stopped->event_index[row] >= d->n_crossings) continue;
        status = sym_execute_tasks(d, &d->crossing_tasks[stopped->event_index[row]], 1);
        if (status != 0) return status;
    }
    if (has_modes) sym_let_go_of_part(stopped);
    for (i = 0; i < d->n_parts; ++i) {
        sym_run *r = d->parts[i];
        memcpy(r->q, d->q + d->q_offset[i], (size_t)r->system->nq * sizeof(double));
        memcpy(r->v, d->v + d->v_offset[i], (size_t)r->system->nv * sizeof(double));
        r->slope_valid = 0;
        if (r->project && (status = sym_project_state(r)) != 0) {
            d->failed_part = i;
            return status;
        }
        if ((status = sym_look_anew(d, r)) != 0) return status;
    }
    return 0;
}

/* Events stopped a part, all at the same time: record them, execute the tasks of crossings, then the actions of mechanisms.
 * Returns 0, SYM_TERMINAL_EVENT where one ends the run, or a status below 0. */
static int32_t sym_handle_events(sym_diagram *d, int32_t part) {
    sym_run *stopped = d->parts[part];
    int32_t status, ends = 0;
    sym_gather_states(d, stopped->t);
    sym_diagram_record(d);
    status = sym_execute_crossings(d, stopped);
    if (status == 0 && stopped->actions != NULL) {
        const double t_end = stopped->t_end;
        sym_workspace w = sym_workspace_of(stopped);
        status = sym_run_act(stopped);
        if (status >= 0 && stopped->look_ahead != NULL && stopped->look_ahead(stopped->look_data) != 0) status = SYM_CALLBACK_FAILED;
        ends = status == SYM_TERMINAL_EVENT;
        if (d->t_end < HUGE_VAL) stopped->t_end = d->t_end; /* of the motion that begins */
        if (status >= 0) status = sym_begin_motion_anew(stopped, &w);
        stopped->t_end = t_end;
        if (status != 0) d->failed_part = part;
        sym_keep_parameters(d);
    }
    if (status != 0) return status;
    sym_gather_states(d, stopped->t);
    sym_diagram_record(d);
    return ends ? SYM_TERMINAL_EVENT : 0;
}

/* Stops at one instant after which crossings are said to bring each other about without end. */
enum { SYM_STOPS_AT_ONCE = 100 };

/* Integrate all parts to time t, handling crossings on the way. Returns SYM_FINISHED or another status. */
static int32_t sym_advance_parts(sym_diagram *d, double t) {
    int32_t i, status = SYM_FINISHED;
    if (d->advance_parallel != NULL) return d->advance_parallel(d, t);
    for (i = 0; i < d->n_parts && status == SYM_FINISHED; ++i) {
        sym_run *r = d->parts[i];
        do {
            if (r->event_capacity - r->n_event_records < r->system->n_events || d->capacity - d->n_records < SYM_RECORDS_PER_INSTANT) return SYM_RECORDS_FULL;
            status = sym_advance_part(r, t);
            sym_add_counters(d, r);
            if (status == SYM_TERMINAL_EVENT) {
                const int32_t at_once = r->t == *d->t, fault = sym_handle_events(d, i);
                d->stops = at_once ? d->stops + 1 : 0;
                if (d->stops > SYM_STOPS_AT_ONCE) return SYM_ACTS_WITHOUT_END;
                if (fault != 0) return fault;
            }
        } while (status == SYM_TERMINAL_EVENT);
        if (status == SYM_RECORDS_FULL) return status;
        if (status != SYM_FINISHED) d->failed_part = i;
    }
    return status;
}

SYM_EXPORT int32_t sym_diagram_start(sym_diagram *d) {
    d->cycle = d->next_instant = 0;
    d->finished = d->failed_part = d->begun = d->stops = 0;
    d->engaged = -1, d->engaged_gap = d->engaged_t = 0.0;
    d->steps = d->rejected = d->evaluations = 0;
    d->n_records = d->n_lateness = 0;
    d->clock_start = d->realtime_scale > 0.0 ? sym_clock_seconds() : 0.0;
    sym_keep_parameters(d);
    sym_gather_states(d, d->t0);
    return 0;
}

/* The end is recorded: what was recorded there, but for rounding of its time, is the end's, on both sides of an event. */
static void sym_record_end(sym_diagram *d, double slack) {
    int64_t n = d->n_records;
    if (n == 0 || d->record_t[n - 1] < d->t_end - slack) {
        sym_gather_states(d, d->t_end), sym_diagram_record(d);
        return;
    }
    while (n > 0 && d->record_t[n - 1] >= d->t_end - slack) d->record_t[--n] = d->t_end;
}

SYM_EXPORT int32_t sym_diagram_advance(sym_diagram *d, int64_t instants) {
    int64_t i;
    for (i = 0; i < instants; ++i) {
        const double due = d->n_instants > 0 ? sym_instant_time(d, d->cycle, d->next_instant) : HUGE_VAL;
        const double slack = 1e-9 * d->base_numerator / d->base_denominator; /* of rounding in t_end */
        const int32_t last = due > d->t_end + (d->before_end ? -slack : slack);
        int32_t status;
        if (d->finished) return SYM_FINISHED;
        if (d->capacity - d->n_records < SYM_RECORDS_PER_INSTANT) return SYM_RECORDS_FULL;
        if (!d->begun && due > d->t0 + slack && (status = sym_begin_memory(d)) != 0) return status;
        status = sym_advance_parts(d, last || due > d->t_end ? d->t_end : due);
        if (status != SYM_FINISHED) return status;
        if (!last) {
            status = sym_execute_instant(d, due > d->t_end ? d->t_end : due);
            if (status != 0) return status;
            if (due < d->t_end - slack) continue;
        }
        d->finished = 1;
        sym_record_end(d, slack);
    }
    return d->finished ? SYM_FINISHED : SYM_RUNNING;
}
