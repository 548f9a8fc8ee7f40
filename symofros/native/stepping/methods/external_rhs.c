/* Right-hand side and events for external integrators (SUNDIALS), whose multistep formulas keep a history of y: y = (q, v) as
 * a flat vector instead of charts. Quaternions are normalised at the evaluation point and not in y, so that the history
 * stays smooth. */

/* Evaluation point <- y = (q, v) at time t. */
static void sym_load_flat_state(sym_system *s, double t, const double *y) {
    memcpy(s->q, y, (size_t)s->nq * sizeof *y);
    memcpy(s->v, y + s->nq, (size_t)s->nv * sizeof *y);
    *s->t = t;
    sym_normalize_quaternions(s);
}

SYM_EXPORT void sym_run_begin_step(sym_run *r, double t, double t1) { sym_begin_step(r->system, t, t1); }

SYM_EXPORT void sym_run_end_step(sym_run *r) { r->system->in_step = 0; }

SYM_EXPORT double sym_run_next_stop(const sym_run *r, double t, double t1) { return sym_next_stop(r->system, t, t1); }

SYM_EXPORT void sym_run_configuration_rate(const sym_run *r, const double *q, const double *w, double *rate) {
    sym_configuration_rate(r->system, q, w, rate);
}

SYM_EXPORT int32_t sym_run_rate(sym_run *r, double t, const double *y, double *rate) {
    sym_system *s = r->system;
    int32_t status;
    sym_load_flat_state(s, sym_stage_time(s, t), y);
    sym_configuration_rate(s, y, s->v, rate);
    status = sym_evaluate_acceleration(r);
    memcpy(rate + s->nq, s->a, (size_t)s->nv * sizeof *rate);
    return status;
}

SYM_EXPORT int32_t sym_run_event_values(sym_run *r, double t, const double *y, double *values) {
    sym_load_flat_state(r->system, t, y);
    return sym_event_values(r, values);
}

SYM_EXPORT int32_t sym_run_set_state(sym_run *r, double t, const double *y) {
    sym_load_flat_state(r->system, sym_stage_time(r->system, t), y);
    sym_store_state(r);
    r->t = *r->system->t;
    return sym_evaluate_inputs(r->system) != 0 ? SYM_CALLBACK_FAILED : 0;
}
