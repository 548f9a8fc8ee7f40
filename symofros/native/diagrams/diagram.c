/* Instants and what lies between them: symofros_diagram.h. */

SYM_EXPORT int32_t sym_diagram_bind(sym_diagram *d, sym_call *call) {
    static const char *const names[] = {"q", "v", "u", "t", "a", "lam"};
    const double *places[6];
    int32_t k, i;
    places[0] = d->q, places[1] = d->v, places[2] = d->u, places[3] = d->t, places[4] = d->a, places[5] = d->lam;
    call->in[0] = call->pre;
    if (call->function->n_in > 10 || call->function->n_out > 8) return 0;
    for (k = 1; k < call->function->n_in; ++k) {
        call->in[k] = NULL;
        for (i = 0; i < 6; ++i)
            if (strcmp(call->function->in[k].name, names[i]) == 0) call->in[k] = places[i];
        if (call->in[k] == NULL) return 0;
    }
    return 1;
}

static double sym_instant_time(const sym_diagram *d, int64_t round, int64_t at) {
    return d->t0 + (double)(round * d->cycle + d->instant[at]) * d->base_n / d->base_d;
}

/* The states of the parts into the point, and what samples give at its time. */
static void sym_gather(sym_diagram *d, double t) {
    int32_t i;
    *d->t = t;
    for (i = 0; i < d->n_parts; ++i) {
        const sym_run *r = d->parts[i];
        memcpy(d->q + d->q_at[i], r->q, (size_t)r->scene->nq * sizeof(double));
        memcpy(d->v + d->v_at[i], r->v, (size_t)r->scene->nv * sizeof(double));
    }
    for (i = 0; i < d->n_signals; ++i) d->u[d->signals[i].input] = sym_sampled(&d->signals[i], t);
}

/* Accelerations and multipliers of the parts at their present states, under the present u. Returns a status. */
static int32_t sym_look_back(sym_diagram *d) {
    int32_t i, status;
    for (i = 0; i < d->n_parts; ++i) {
        sym_run *r = d->parts[i];
        sym_here(r);
        status = sym_accelerate(r);
        if (status != 0) {
            d->failed = i;
            return status;
        }
        memcpy(d->a + d->v_at[i], r->scene->a, (size_t)r->scene->nv * sizeof(double));
        memcpy(d->lam + d->c_at[i], r->scene->lam, (size_t)r->scene->nc * sizeof(double));
    }
    return 0;
}

static int32_t sym_diagram_record(sym_diagram *d) {
    const int64_t n = d->n_records;
    d->record_t[n] = *d->t;
    memcpy(d->record_q + n * d->nq, d->q, (size_t)d->nq * sizeof(double));
    memcpy(d->record_v + n * d->nv, d->v, (size_t)d->nv * sizeof(double));
    memcpy(d->record_u + n * d->nu, d->u, (size_t)d->nu * sizeof(double));
    ++d->n_records;
    return 0;
}

/* Stages at the point. Returns a status. */
static int32_t sym_stage_all(sym_diagram *d, const sym_stage *stages, int32_t n) {
    int32_t i;
    for (i = 0; i < n; ++i) {
        const sym_stage *stage = &stages[i];
        sym_evaluate(&stage->call);
        if (stage->opaque >= 0) {
            if (d->opaque(d->data, stage->opaque, *d->t, stage->call.out[0], d->u) != 0) return SYM_CALLBACK;
            continue;
        }
        memcpy(d->u, stage->call.out[0], (size_t)d->nu * sizeof(double));
        if (stage->call.function->n_out == 3) {
            memcpy(d->q, stage->call.out[1], (size_t)d->nq * sizeof(double));
            memcpy(d->v, stage->call.out[2], (size_t)d->nv * sizeof(double));
        }
    }
    return 0;
}

static void sym_diagram_pace(sym_diagram *d, double t) {
    const double due = d->clock0 + (t - d->t0) * d->pace, early = due - sym_clock();
    if (early > 0.0) sym_sleep(early);
    if (d->n_late < d->late_capacity) d->late[d->n_late++] = sym_clock() - due;
}

/* Whether constraints have engaged or let go since it was asked last. */
static int32_t sym_engages(sym_diagram *d) {
    int32_t i, changed = 0;
    for (i = 0; i < d->n_engaging; ++i) {
        const double now = d->u[d->engaging[i]];
        if (now != d->engaged[i]) changed = 1;
        d->engaged[i] = now;
    }
    return changed;
}

/* The parts onto their constraints, at once: a plastic impact. Returns a status. */
static int32_t sym_impact(sym_diagram *d, double t) {
    int32_t i, status;
    for (i = 0; i < d->n_parts; ++i) {
        if (!d->parts[i]->project) continue;
        status = sym_return(d->parts[i]);
        if (status != 0) {
            d->failed = i;
            return status;
        }
    }
    sym_gather(d, t);
    return 0;
}

/* The instant that is next, at time t. Returns a status. */
static int32_t sym_instant_now(sym_diagram *d, double t) {
    const sym_instant *now = &d->sets[d->set[d->at]];
    int32_t i, status;
    if (d->pace > 0.0) sym_diagram_pace(d, t);
    sym_gather(d, t);
    if (now->n > 0) {
        if (d->looks_back && (status = sym_look_back(d)) != 0) return status;
        status = sym_stage_all(d, now->stages, now->n);
        if (status == 0 && sym_engages(d)) status = sym_impact(d, t);
        if (status != 0) return status;
        for (i = 0; i < d->n_parts; ++i) d->parts[i]->fresh = 0;
    }
    if (now->records) sym_diagram_record(d);
    if (++d->at == d->n_instants) d->at = 0, ++d->round;
    return 0;
}

/* One part up to a time. Returns SYM_DONE or another status. */
static int32_t sym_part_until(sym_run *r, double t) {
    int32_t status = SYM_GOING;
    if (r->t >= t) return SYM_DONE;
    r->steps = 0, r->t0 = r->t, r->t_end = t;
    while (status == SYM_GOING) status = sym_advance(r, (int64_t)1 << 40);
    return status;
}

/* What a part has done since it was asked last. */
static void sym_tally(sym_diagram *d, sym_run *r) {
    d->steps += r->steps, d->rejected += r->rejected, d->evaluations += r->evaluations;
    r->steps = r->rejected = r->evaluations = 0;
}

/* A crossing stopped the motion: note it, change what it changes. Returns a status. */
static int32_t sym_crossing(sym_diagram *d, sym_run *stopped) {
    int32_t i, status;
    sym_gather(d, stopped->t);
    sym_diagram_record(d);
    d->found_t[d->n_found] = stopped->t;
    d->found_which[d->n_found++] = stopped->stopped_by;
    stopped->n_found = 0;
    if (d->looks_back && (status = sym_look_back(d)) != 0) return status;
    status = sym_stage_all(d, &d->crossings[stopped->stopped_by], 1);
    if (status != 0) return status;
    for (i = 0; i < d->n_parts; ++i) {
        sym_run *r = d->parts[i];
        memcpy(r->q, d->q + d->q_at[i], (size_t)r->scene->nq * sizeof(double));
        memcpy(r->v, d->v + d->v_at[i], (size_t)r->scene->nv * sizeof(double));
        r->fresh = 0;
        if (r->project && (status = sym_return(r)) != 0) {
            d->failed = i;
            return status;
        }
        sym_here(r);
        if (r->scene->n_events > 0 && (status = sym_event_values(r, r->event)) != 0) return status;
    }
    sym_gather(d, stopped->t);
    sym_diagram_record(d);
    return 0;
}

/* All parts up to a time, crossings on the way included. Returns SYM_DONE or another status. */
static int32_t sym_parts_until(sym_diagram *d, double t) {
    int32_t i, status = SYM_DONE;
    if (d->gang != NULL) return sym_gang_until(d, t);
    for (i = 0; i < d->n_parts && status == SYM_DONE; ++i) {
        sym_run *r = d->parts[i];
        do {
            if (d->n_found == d->found_capacity || d->capacity - d->n_records < 4) return SYM_FULL;
            status = sym_part_until(r, t);
            sym_tally(d, r);
            if (status == SYM_EVENT) {
                const int32_t fault = sym_crossing(d, r);
                if (fault != 0) return fault;
            }
        } while (status == SYM_EVENT);
        if (status != SYM_DONE) d->failed = i;
    }
    return status;
}

SYM_EXPORT int32_t sym_diagram_start(sym_diagram *d) {
    d->round = d->at = 0;
    d->ended = d->failed = 0;
    d->steps = d->rejected = d->evaluations = 0;
    d->n_records = d->n_found = d->n_late = 0;
    d->clock0 = d->pace > 0.0 ? sym_clock() : 0.0;
    sym_gather(d, d->t0);
    return 0;
}

SYM_EXPORT int32_t sym_diagram_advance(sym_diagram *d, int64_t instants) {
    int64_t i;
    for (i = 0; i < instants; ++i) {
        const double due = d->n_instants > 0 ? sym_instant_time(d, d->round, d->at) : HUGE_VAL;
        const double slack = 1e-9 * d->base_n / d->base_d;
        const int32_t last = due > d->t_end + slack;
        int32_t status;
        if (d->ended) return SYM_DONE;
        if (d->capacity - d->n_records < 4) return SYM_FULL;
        status = sym_parts_until(d, last || due > d->t_end ? d->t_end : due);
        if (status != SYM_DONE) return status;
        if (!last) {
            status = sym_instant_now(d, due > d->t_end ? d->t_end : due);
            if (status != 0) return status;
            if (due < d->t_end - slack) continue;
        }
        d->ended = 1;
        if (d->n_records == 0 || d->record_t[d->n_records - 1] < d->t_end) {
            sym_gather(d, d->t_end);
            sym_diagram_record(d);
        }
    }
    return d->ended ? SYM_DONE : SYM_GOING;
}
