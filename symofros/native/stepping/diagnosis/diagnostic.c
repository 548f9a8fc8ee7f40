/* Ends of steps kept for the diagnosis of a run, whatever it records: docs/theory/simulation.md, section 8. */

/* Row <- the present state, with the inputs there. Those of a function of the caller's are the ones it gave last. */
static void sym_store_diagnostic_state(sym_run *r, int64_t row) {
    sym_system *s = r->system;
    if (s->callback == NULL && (s->n_signals > 0 || s->law.function != NULL)) {
        sym_load_state(r);
        (void)sym_evaluate_inputs(s); /* fails by a callback only */
    }
    r->diagnostic_t[row] = r->t;
    memcpy(r->diagnostic_q + row * s->nq, r->q, (size_t)s->nq * sizeof(double));
    memcpy(r->diagnostic_v + row * s->nv, r->v, (size_t)s->nv * sizeof(double));
    memcpy(r->diagnostic_u + row * s->nu, s->u, (size_t)s->nu * sizeof(double));
}

static void sym_move_row(double *table, int64_t to, int64_t from, int32_t width) {
    memcpy(table + to * width, table + from * width, (size_t)width * sizeof(double));
}

/* Every other state stays, and half as many of the following steps are kept. */
static void sym_thin_diagnostic_states(sym_run *r) {
    const sym_system *s = r->system;
    int64_t i;
    r->n_diagnostic = (r->n_diagnostic + 1) / 2;
    for (i = 1; i < r->n_diagnostic; ++i) {
        sym_move_row(r->diagnostic_t, i, 2 * i, 1);
        sym_move_row(r->diagnostic_q, i, 2 * i, s->nq);
        sym_move_row(r->diagnostic_v, i, 2 * i, s->nv);
        sym_move_row(r->diagnostic_u, i, 2 * i, s->nu);
    }
    r->diagnostic_stride *= 2;
}

/* Keep the present state, the end of step number r->steps, if it is one of those kept or the last one. The last one gives
 * way to the next where the run goes on, as in runs of one step after the other: only each stride-th fills the table. */
static void sym_keep_diagnostic_state(sym_run *r, int32_t last) {
    const int32_t between = r->steps % r->diagnostic_stride != 0;
    if (r->diagnostic_capacity < 2 || (between && !last)) return;
    if (r->diagnostic_between) --r->n_diagnostic;
    r->diagnostic_between = 0;
    if (r->n_diagnostic == r->diagnostic_capacity) {
        sym_thin_diagnostic_states(r);
        if (!last && r->steps % r->diagnostic_stride != 0) return;
    }
    r->diagnostic_between = r->steps % r->diagnostic_stride != 0;
    sym_store_diagnostic_state(r, r->n_diagnostic++);
}

/* Accelerations and inputs at states of the motion (n), each projected first where the run projects. A state without
 * accelerations gets NaN. Returns 0, or SYM_CALLBACK_FAILED. */
SYM_EXPORT int32_t sym_run_accelerations(sym_run *r, int64_t n, const double *t, const double *q, const double *v, double *u,
                                         double *a) {
    sym_system *s = r->system;
    int64_t i;
    int32_t k, status;
    for (i = 0; i < n; ++i) {
        memcpy(s->q, q + i * s->nq, (size_t)s->nq * sizeof *q);
        memcpy(s->v, v + i * s->nv, (size_t)s->nv * sizeof *v);
        *s->t = t[i];
        status = r->project ? sym_project_point(s) : 0;
        if (status == 0) status = sym_evaluate_acceleration(r);
        if (status == SYM_CALLBACK_FAILED) return status;
        memcpy(u + i * s->nu, s->u, (size_t)s->nu * sizeof *u);
        for (k = 0; k < s->nv; ++k) a[i * s->nv + k] = status == 0 ? s->a[k] : NAN;
    }
    return 0;
}
