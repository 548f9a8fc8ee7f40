/* Fixed steps of many trajectories by columns: number k of slot i is entry (k, i), so that whatever is done to one slot is done
 * to all by vectors. The numbers are those of the steps by rows (batch_stepper.c), bit by bit: the same sums in the same order.
 * A step at which one slot needs more than that, because it ends, fails or records within the step, is made by rows. */

static void sym_batch_assign(sym_batch *b, int32_t slot, int64_t trajectory);
static void sym_batch_combine_slopes(const sym_batch *b, int32_t n, int32_t stages, const double *weights, double *restrict y);

/* Whether steps are made by columns: of trees in scalar coordinates under constant inputs, by explicit methods of fixed steps
 * whose slopes no later step takes over. */
static int32_t sym_batch_has_columns(const sym_batch *b) {
    const sym_run *r = b->prototype;
    const sym_system *s = r->system;
    int32_t i, scalar = 1;
    for (i = 0; i < s->n_segments; ++i) scalar &= s->segments[i].kind == SYM_SEGMENT_LINEAR && s->segments[i].q == s->segments[i].v;
    return b->lanes != NULL && scalar && r->method <= SYM_METHOD_SEMI_IMPLICIT && !r->adaptive && !r->project &&
           r->tableau.fsal_stage == 0 && r->record_every == 0 && s->nc + s->n_beams + s->n_signals + s->n_stops == 0 &&
           s->n_quaternion_inputs == 0 && s->law.function == NULL && s->callback == NULL;
}

/* Memory of the columns. Where they are evaluated, and what is summed, is memory of the rows. */
static void sym_columns_allocate(sym_batch *b, sym_arena *own, sym_arena *scratch) {
    const sym_system *s = b->prototype->system;
    const size_t slots = (size_t)b->slots;
    b->column_u = sym_allocate(own, slots * (size_t)s->nu);
    b->column_t = sym_allocate(own, slots), b->column_t0 = sym_allocate(own, slots);
    b->column_steps = sym_allocate(own, slots), b->column_record = sym_allocate(own, slots);
    b->column_slope = sym_allocate(scratch, slots * (size_t)s->nv), b->lost = sym_allocate(scratch, slots);
    b->column_work = sym_allocate(scratch, b->lanes->work);
}

/* Point the accelerations by columns at their inputs and outputs; those that differ from stage to stage are pointed anew. */
static void sym_columns_bind(sym_batch *b) {
    const sym_batch_function *f = &b->forward_dynamics;
    const sym_function *function = f->function;
    const ptrdiff_t slots = b->slots;
    int32_t k;
    b->column_in[0].at = (void *)f->in[0], b->column_in[0].step = 1, b->column_in[0].stride = (ptrdiff_t)f->in_stride[0];
    for (k = 1; k < function->n_in; ++k) {
        sym_strided *in = &b->column_in[k];
        in->at = f->in[k] == b->u ? b->column_u : (void *)f->in[k];
        if (f->in[k] == b->v) in->at = b->stage + b->prototype->system->nv * slots;
        in->step = slots, in->stride = 1;
    }
    for (k = 0; k < function->n_out; ++k)
        b->column_out[k].at = f->out[k], b->column_out[k].step = slots, b->column_out[k].stride = 1;
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
    double special = 0.0;
    int32_t i;
    for (i = 0; i < b->n_active; ++i) {
        double t1 = b->column_t0[i] + (b->column_steps[i] + 1.0) * h;
        t1 = fabs(t1) < SYM_ROUNDED_ZERO * h ? 0.0 : t1; /* sym_multiple */
        b->t1[i] = t1, b->h[i] = t1 - b->column_t[i];
        special += t1 >= last || b->column_steps[i] + 1.0 >= most ? 1.0 : 0.0;
        special += (b->column_record[i] - b->column_t[i]) / b->h[i] > 1.0 - SYM_GRID_BEFORE ? 0.0 : 1.0;
    }
    return special == 0.0;
}

/* Add to `lost` what is not zero where a number is none that a motion may have: sym_all_finite. */
static void sym_columns_check(sym_batch *b, int32_t size, const double *restrict x) {
    const int32_t n = b->n_active;
    double *restrict lost = b->lost;
    int32_t i, k;
    for (k = 0; k < size; ++k)
        for (i = 0; i < n; ++i) lost[i] += x[SYM_INDEX(k, b->slots, i)] * SYM_BEYOND_MOTION * 0.0;
}

/* Slope number `stage`, whose (theta, v) is in b->stage, its q in b->q, its time in b->t. */
static void sym_columns_evaluate(sym_batch *b, int32_t stage) {
    const size_t nv = (size_t)b->prototype->system->nv, half = nv * (size_t)b->slots;
    double *k = b->k + (size_t)stage * 2 * half, *a = k + half;
    int32_t i, l;
    b->column_out[0].at = a;
    memcpy(k, b->stage + half, half * sizeof *k);
    b->lanes->batch((size_t)b->n_active, b->column_in, b->column_out, b->column_work);
    for (i = 0; i < b->n_active && stage == 0 && b->n_begun > 0; ++i)
        for (l = 0; l < (int32_t)nv && b->runs[i].slope_valid; ++l) a[SYM_INDEX(l, b->slots, i)] = b->column_slope[SYM_INDEX(l, b->slots, i)];
    sym_columns_check(b, (int32_t)nv, a);
}

/* Evaluation points of a stage that is not the first. */
static void sym_columns_load_stage(sym_batch *b, int32_t stage) {
    const sym_tableau *method = &b->prototype->tableau;
    const size_t half = (size_t)b->prototype->system->nv * (size_t)b->slots;
    const double *restrict theta = b->stage, *restrict q = b->states, c = method->c[stage];
    double *restrict at = b->q;
    size_t l;
    int32_t i;
    sym_batch_combine_slopes(b, b->slots, stage, method->a + (size_t)stage * (size_t)method->dense_stages, b->stage);
    for (l = 0; l < half; ++l) at[l] = q[l] + theta[l];
    for (i = 0; i < b->n_active; ++i) {
        const double first = b->column_t[i], last = b->t1[i], t = first + c * b->h[i];
        b->t[i] = t > last ? last : t < first ? first : t; /* sym_stage_time */
    }
}

/* y0 = (0, v) and the lengths of the step, and the evaluation points of the first stage. */
static void sym_columns_begin_step(sym_batch *b) {
    const size_t half = (size_t)b->prototype->system->nv * (size_t)b->slots, slots = (size_t)b->slots;
    size_t l;
    memset(b->y0, 0, half * sizeof *b->y0);
    memcpy(b->y0 + half, b->states + half, half * sizeof *b->y0);
    memcpy(b->stage + half, b->states + half, half * sizeof *b->stage);
    memcpy(b->q, b->states, half * sizeof *b->q);
    memcpy(b->t, b->column_t, slots * sizeof *b->t);
    for (l = 0; l < 2 * half; l += slots) memcpy(b->length + l, b->h, slots * sizeof *b->length);
    memset(b->lost, 0, slots * sizeof *b->lost);
}

/* y1 of semi-implicit Euler: sym_semi_implicit_step. */
static void sym_columns_semi_implicit(sym_batch *b) {
    const size_t half = (size_t)b->prototype->system->nv * (size_t)b->slots;
    const double *restrict h = b->length, *restrict v = b->states + half, *restrict a = b->k + half;
    double *restrict theta = b->y1, *restrict v1 = b->y1 + half;
    size_t l;
    for (l = 0; l < half; ++l) v1[l] = v[l] + h[l] * a[l];
    for (l = 0; l < half; ++l) theta[l] = h[l] * v1[l];
}

/* Record the states of slots at whose present time the grid records: sym_record_grid_at_end. */
static void sym_columns_record(sym_batch *b) {
    const sym_system *s = b->prototype->system;
    int32_t i, k;
    for (i = 0; i < b->n_active; ++i) {
        sym_run *r = b->runs + i;
        while (b->column_record[i] <= b->column_t[i] + SYM_GRID_AFTER * b->h[i]) {
            const int64_t n = r->n_records++;
            r->record_t[n] = b->column_record[i];
            sym_column_state(b, i, r->record_q + n * s->nq, r->record_v + n * s->nv);
            for (k = 0; k < s->nu; ++k) r->record_u[n * s->nu + k] = b->column_u[SYM_INDEX(k, b->slots, i)];
            ++r->next_grid;
            b->column_record[i] = sym_next_record(r);
        }
    }
}

/* The states become y1, at the ends of the step. */
static void sym_columns_accept(sym_batch *b) {
    const size_t half = (size_t)b->prototype->system->nv * (size_t)b->slots;
    double *restrict q = b->states, recorded = 0.0;
    const double *restrict theta = b->y1;
    size_t l;
    int32_t i;
    for (l = 0; l < half; ++l) q[l] += theta[l];
    memcpy(b->states + half, b->y1 + half, half * sizeof *b->y1);
    for (i = 0; i < b->n_active; ++i) {
        b->column_t[i] = b->t1[i], b->column_steps[i] += 1.0;
        recorded += b->column_record[i] <= b->t1[i] + SYM_GRID_AFTER * b->h[i] ? 1.0 : 0.0;
    }
    for (i = 0; i < b->n_active && b->n_begun > 0; ++i) b->runs[i].slope_valid = 0;
    b->n_begun = 0;
    if (recorded > 0.0) sym_columns_record(b);
}

/* One step of all active trajectories. Returns 0, and nothing is changed, where it has to be made by rows. */
static int32_t sym_columns_step(sym_batch *b) {
    const sym_tableau *method = &b->prototype->tableau;
    double lost = 0.0;
    int32_t i, stage;
    if (!sym_columns_propose(b)) return 0;
    sym_columns_begin_step(b);
    sym_columns_evaluate(b, 0);
    for (stage = 1; stage < method->stages; ++stage) {
        sym_columns_load_stage(b, stage);
        sym_columns_evaluate(b, stage);
    }
    if (b->prototype->method == SYM_METHOD_EXPLICIT) sym_batch_combine_slopes(b, b->slots, method->stages, method->b, b->y1);
    else sym_columns_semi_implicit(b);
    sym_columns_check(b, 2 * b->prototype->system->nv, b->y1);
    for (i = 0; i < b->n_active; ++i) lost += b->lost[i];
    if (!(lost == 0.0)) return 0;
    sym_columns_accept(b);
    return 1;
}
