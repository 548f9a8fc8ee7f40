/* Fixed steps of many trajectories by columns: number k of slot i is entry (k, i), so that whatever is done to one slot is done
 * to all by vectors. The numbers are those of the steps by rows (batch_stepper.c), bit by bit: the same sums in the same order.
 * A step at which one slot needs more than that, because it ends, fails or records within the step, is made by rows. */

static void sym_batch_assign(sym_batch *b, int32_t slot, int64_t trajectory);
static void sym_batch_take_ahead(sym_batch *b, int32_t slot);
static int32_t sym_batch_knows(const sym_batch *b, int32_t slot, double t, double t1);

/* Whether steps are made by columns: of trees in scalar coordinates whose inputs are no functions of the caller's, by
 * explicit methods of fixed steps whose slopes no later step takes over. */
static int32_t sym_batch_has_columns(const sym_batch *b) {
    const sym_run *r = b->prototype;
    const sym_system *s = r->system;
    int32_t i, scalar = 1;
    for (i = 0; i < s->n_segments; ++i) scalar &= s->segments[i].kind == SYM_SEGMENT_LINEAR && s->segments[i].q == s->segments[i].v;
    return b->forward_dynamics.lanes != NULL && scalar && r->method <= SYM_METHOD_SEMI_IMPLICIT && !r->adaptive && !r->project &&
           r->tableau.fsal_stage == 0 && r->record_every == 0 && s->nc + s->n_beams + s->n_events == 0 &&
           s->n_quaternion_inputs == 0 && s->callback == NULL && (b->law.function == NULL || b->law.lanes != NULL);
}

/* Memory of the columns. Where they are evaluated, and what is summed, is memory of the rows. */
static void sym_columns_allocate(sym_batch *b, sym_arena *own, sym_arena *scratch) {
    const sym_system *s = b->prototype->system;
    const size_t slots = (size_t)b->slots;
    b->column_t = sym_allocate(own, slots), b->column_t0 = sym_allocate(own, slots);
    b->column_steps = sym_allocate(own, slots), b->column_record = sym_allocate(own, slots);
    b->column_u = sym_allocate(own, slots * (size_t)s->nu);
    b->column_slope = sym_allocate(scratch, slots * (size_t)s->nv), b->lost = sym_allocate(scratch, slots);
    b->forward_dynamics.column_work = sym_allocate(scratch, b->forward_dynamics.lanes->work);
    if (b->law.function != NULL) b->law.column_work = sym_allocate(scratch, b->law.lanes->work);
}

/* Point a function by columns at its inputs and outputs; those that differ from stage to stage are pointed anew. */
static void sym_columns_bind(const sym_batch *b, sym_batch_function *f) {
    const sym_function *function = f->function;
    const ptrdiff_t slots = b->slots;
    int32_t k;
    if (function == NULL) return;
    f->column_v = -1;
    f->column_in[0].at = (void *)f->in[0], f->column_in[0].step = 1, f->column_in[0].stride = (ptrdiff_t)f->in_stride[0];
    for (k = 1; k < function->n_in; ++k) {
        sym_strided *in = &f->column_in[k];
        in->at = f->in[k] == b->u ? b->column_u : (void *)f->in[k];
        if (f->in[k] == b->v) f->column_v = k;
        in->step = slots, in->stride = 1;
    }
    for (k = 0; k < function->n_out; ++k)
        f->column_out[k].at = f->out[k], f->column_out[k].step = slots, f->column_out[k].stride = 1;
}

/* The time at which a run records next; HUGE_VAL where there is none. */
static double sym_next_record(const sym_run *r) { return r->next_grid < r->n_grid ? r->grid[r->next_grid] : HUGE_VAL; }

/* Rows (n, size) of the slots in use <-> columns. */
static void sym_to_columns(const sym_batch *b, int32_t size, const double *rows, double *columns) {
    int32_t i, k;
    for (i = 0; i < b->n_active; ++i)
        for (k = 0; k < size; ++k) columns[SYM_INDEX(k, b->slots, i)] = rows[SYM_INDEX(i, size, k)];
}

/* States, times and inputs of the runs go into the columns. */
static void sym_columns_enter(sym_batch *b) {
    const sym_system *s = b->prototype->system;
    const int32_t nv = s->nv, slots = b->slots;
    int32_t i, k;
    memcpy(b->stage, b->states, (size_t)slots * 2 * (size_t)nv * sizeof *b->stage);
    sym_to_columns(b, 2 * nv, b->stage, b->states);
    b->n_begun = 0;
    for (i = 0; i < b->n_active; ++i) {
        const sym_run *r = b->runs + i;
        const double *u = b->u_constant.at + b->trajectory_of_slot[i] * b->u_constant.stride;
        b->column_t[i] = r->t, b->column_t0[i] = r->t0, b->column_steps[i] = (double)r->steps;
        b->column_record[i] = sym_next_record(r);
        for (k = 0; k < s->nu; ++k) b->column_u[SYM_INDEX(k, slots, i)] = u[k];
        b->n_begun += r->slope_valid;
        for (k = 0; k < nv && r->slope_valid; ++k)
            b->column_slope[SYM_INDEX(k, slots, i)] = b->k[SYM_INDEX(i, 2 * nv, nv + k)];
    }
    b->in_columns = 1;
}

/* The state of a slot in columns: q, then v. */
static void sym_column_state(const sym_batch *b, int32_t slot, double *q, double *v) {
    const int32_t nv = b->prototype->system->nv;
    int32_t k;
    for (k = 0; k < nv; ++k) {
        q[k] = b->states[SYM_INDEX(k, b->slots, slot)];
        v[k] = b->states[SYM_INDEX(nv + k, b->slots, slot)];
    }
}

/* All that steps by rows begin with goes back into the runs. */
static void sym_columns_leave(sym_batch *b) {
    const sym_system *prototype = b->prototype->system;
    const size_t nv = (size_t)prototype->nv;
    int32_t i, k;
    if (!b->in_columns) return;
    for (i = 0; i < b->n_active; ++i) {
        sym_run *r = b->runs + i;
        double *slope = b->k + (size_t)i * 2 * nv;
        double *state = b->stage + (size_t)i * 2 * nv;
        sym_batch_assign(b, i, b->trajectory_of_slot[i]);
        memcpy(b->systems[i].u, b->systems[i].u_constant, (size_t)prototype->nu * sizeof(double));
        sym_column_state(b, i, state, state + nv);
        r->t = b->column_t[i], r->steps = (int64_t)b->column_steps[i];
        if (!r->slope_valid) continue;
        memcpy(slope, state + nv, nv * sizeof *slope);
        for (k = 0; k < prototype->nv; ++k) slope[nv + (size_t)k] = b->column_slope[SYM_INDEX(k, b->slots, i)];
    }
    memcpy(b->states, b->stage, (size_t)b->slots * 2 * nv * sizeof *b->stage);
    b->in_columns = 0;
}

/* Lengths and ends of the next step. Returns whether none of the slots ends there or records within it. */
static int32_t sym_columns_propose(sym_batch *b) {
    const sym_run *r = b->prototype;
    const double h = r->h, last = r->t_end - 1e-9 * h, most = b->max_steps > 0 ? (double)b->max_steps : HUGE_VAL;
    int32_t i, n = b->n_active, special = 0;
    for (i = 0; i < n; ++i) {
        double t1 = b->column_t0[i] + (b->column_steps[i] + 1.0) * h;
        t1 = fabs(t1) < SYM_ROUNDED_ZERO * h ? 0.0 : t1; /* sym_multiple */
        b->t1[i] = t1, b->h[i] = t1 - b->column_t[i];
        special |= (t1 >= last) | (b->column_steps[i] + 1.0 >= most) | !sym_batch_knows(b, i, b->column_t[i], t1);
    }
    for (i = 0; i < n && r->n_grid > 0; ++i)
        special |= !((b->column_record[i] - b->column_t[i]) / b->h[i] > 1.0 - SYM_GRID_BEFORE);
    return special == 0;
}

/* Add to `lost` what is not zero where a number is none that a motion may have: sym_all_finite. */
static void sym_columns_check(sym_batch *b, int32_t size, const double *restrict x) {
    const int32_t n = b->n_active;
    double *restrict lost = b->lost;
    int32_t i, k;
    for (k = 0; k < size; ++k)
        for (i = 0; i < n; ++i) lost[i] += x[SYM_INDEX(k, b->slots, i)] * SYM_BEYOND_MOTION * 0.0;
}

/* Entries of q, or of v, in all columns. */
static size_t sym_columns_half(const sym_batch *b) { return (size_t)b->prototype->system->nv * (size_t)b->slots; }

/* Evaluate a function by columns at speeds v. */
static void sym_columns_call(const sym_batch *b, sym_batch_function *f, double *v) {
    if (f->column_v >= 0) f->column_in[f->column_v].at = v;
    f->lanes->batch((size_t)b->n_active, f->column_in, f->column_out, f->column_work);
}

/* Inputs that are sampled, at the times b->t, and those by formulas: sym_batch_evaluate_acceleration. */
static void sym_columns_evaluate_inputs(sym_batch *b, int32_t in_step, double *v) {
    const sym_system *s = b->prototype->system;
    const size_t slots = (size_t)b->slots;
    int32_t i, k;
    for (k = 0; k < s->n_signals; ++k) {
        double *u = b->column_u + (size_t)s->signals[k].input * slots;
        for (i = 0; i < b->n_active; ++i) {
            sym_signal signal = s->signals[k];
            signal.value += b->trajectory_of_slot[i] * b->signal_stride[k];
            u[i] = sym_signal_at(&signal, b->t[i], in_step ? b->t1[i] : HUGE_VAL);
        }
    }
    if (b->law.function == NULL) return;
    sym_columns_call(b, &b->law, v);
    for (k = 0; k < s->n_law; ++k)
        memcpy(b->column_u + (size_t)s->law_inputs[k] * slots, b->law.out[0] + (size_t)k * slots, slots * sizeof(double));
}

/* Slope number `stage`: its v is there, its q in b->q, its time in b->t; its accelerations are evaluated. */
static void sym_columns_evaluate(sym_batch *b, int32_t stage) {
    const int32_t nv = b->prototype->system->nv;
    double *v = b->k + (size_t)stage * 2 * sym_columns_half(b), *a = v + sym_columns_half(b);
    int32_t i, l;
    sym_columns_evaluate_inputs(b, stage > 0, v);
    b->forward_dynamics.column_out[0].at = a;
    sym_columns_call(b, &b->forward_dynamics, v);
    for (i = 0; i < b->n_active && stage == 0 && b->n_begun > 0; ++i)
        for (l = 0; l < nv && b->runs[i].slope_valid; ++l) a[SYM_INDEX(l, b->slots, i)] = b->column_slope[SYM_INDEX(l, b->slots, i)];
    sym_columns_check(b, nv, a);
}

/* y = (0, v) + h times the weighted sum of slopes: sym_batch_combine_slopes. Of a stage, theta becomes q (+) theta. */
static void sym_columns_combine(const sym_batch *b, int32_t stages, const double *weights, int32_t at_end, double *q1, double *v1) {
    const size_t half = sym_columns_half(b), slots = (size_t)b->slots;
    size_t i, l;
    sym_weighted_sum(2 * half, stages, weights, b->k, 2 * half, b->stage);
    for (l = 0; l < half; l += slots) {
        const double *restrict sum = b->stage + l, *restrict sum_v = b->stage + half + l, *restrict h = b->h;
        const double *restrict q = b->states + l, *restrict v = b->states + half + l;
        double *restrict q_to = q1 + l, *restrict v_to = v1 + l;
        if (at_end)
            for (i = 0; i < slots; ++i) q_to[i] = h[i] * sum[i] + 0.0;
        else
            for (i = 0; i < slots; ++i) q_to[i] = q[i] + (h[i] * sum[i] + 0.0); /* zero keeps the product rounded by itself */
        for (i = 0; i < slots; ++i) v_to[i] = h[i] * sum_v[i] + v[i];
    }
}

/* Times of stages at c, in parts of the step: sym_stage_time. */
static void sym_columns_place_times(sym_batch *b, double c) {
    const int32_t n = b->n_active, stops = b->ahead != NULL || b->prototype->system->n_stops > 0;
    int32_t i;
    for (i = 0; i < n; ++i) {
        double first = b->column_t[i], last = b->t1[i];
        const double t = first + c * b->h[i];
        if (stops) {
            sym_batch_take_ahead(b, i); /* another group may have had the slot */
            first = sym_first_time(b->systems + i, first), last = sym_last_time(b->systems + i, last);
        }
        b->t[i] = t > last ? last : t < first ? first : t;
    }
}

/* One stage: sym_batch_evaluate_stage. */
static void sym_columns_evaluate_stage(sym_batch *b, int32_t stage) {
    const sym_tableau *method = &b->prototype->tableau;
    sym_columns_combine(b, stage, method->a + (size_t)stage * (size_t)method->dense_stages, 0, b->q,
                        b->k + (size_t)stage * 2 * sym_columns_half(b));
    sym_columns_place_times(b, method->c[stage]);
    sym_columns_evaluate(b, stage);
}

/* y1 of semi-implicit Euler: sym_semi_implicit_step. */
static void sym_columns_semi_implicit(sym_batch *b) {
    const size_t half = sym_columns_half(b), slots = (size_t)b->slots;
    size_t i, l;
    for (l = 0; l < half; l += slots)
        for (i = 0; i < slots; ++i) b->y1[half + l + i] = b->states[half + l + i] + b->h[i] * b->k[half + l + i];
    for (l = 0; l < half; l += slots)
        for (i = 0; i < slots; ++i) b->y1[l + i] = b->h[i] * b->y1[half + l + i];
}

/* Record the states of slots at whose present time the grid records: sym_record_grid_at_end. */
static void sym_columns_record(sym_batch *b) {
    int32_t i;
    for (i = 0; i < b->n_active; ++i) {
        sym_run *r = b->runs + i;
        while (b->column_record[i] <= b->column_t[i] + SYM_GRID_AFTER * b->h[i]) {
            sym_column_state(b, i, r->system->q, r->system->v);
            *r->system->t = b->column_record[i];
            (void)sym_record(r); /* fails by a function of the caller's only */
            ++r->next_grid;
            b->column_record[i] = sym_next_record(r);
        }
    }
}

/* The states become y1, at the ends of the step. */
static void sym_columns_accept(sym_batch *b) {
    const size_t half = sym_columns_half(b);
    double *restrict q = b->states;
    const double *restrict theta = b->y1;
    size_t l;
    int32_t i, n = b->n_active, recorded = 0;
    for (l = 0; l < half; ++l) q[l] += theta[l];
    memcpy(b->states + half, b->y1 + half, half * sizeof *b->y1);
    for (i = 0; i < n; ++i) b->column_t[i] = b->t1[i], b->column_steps[i] += 1.0;
    for (i = 0; i < n && b->prototype->n_grid > 0; ++i) recorded |= b->column_record[i] <= b->t1[i] + SYM_GRID_AFTER * b->h[i];
    for (i = 0; i < n && b->n_begun > 0; ++i) b->runs[i].slope_valid = 0;
    b->n_begun = 0;
    if (recorded) sym_columns_record(b);
}

/* One step of all active trajectories. Returns 0, and nothing is changed, where it has to be made by rows. */
static int32_t sym_columns_step(sym_batch *b) {
    const sym_tableau *method = &b->prototype->tableau;
    const size_t half = sym_columns_half(b);
    int32_t i, stage, lost = 0;
    if (!sym_columns_propose(b)) return 0;
    memset(b->lost, 0, (size_t)b->slots * sizeof *b->lost);
    memcpy(b->q, b->states, half * sizeof *b->q), memcpy(b->k, b->states + half, half * sizeof *b->k);
    sym_columns_place_times(b, 0.0);
    sym_columns_evaluate(b, 0);
    for (stage = 1; stage < method->stages; ++stage) sym_columns_evaluate_stage(b, stage);
    if (b->prototype->method == SYM_METHOD_EXPLICIT) sym_columns_combine(b, method->stages, method->b, 1, b->y1, b->y1 + half);
    else sym_columns_semi_implicit(b);
    sym_columns_check(b, 2 * b->prototype->system->nv, b->y1);
    for (i = 0; i < b->n_active; ++i) lost |= b->lost[i] != 0.0;
    if (lost) return 0;
    sym_columns_accept(b);
    return 1;
}
