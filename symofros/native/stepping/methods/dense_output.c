/* States between the ends of a step: dense output, and records at given times. */

/* The end of the step <- the evaluation point. */
static void sym_store_end_state(const sym_system *s, sym_workspace *w) {
    memcpy(w->end_state, s->q, (size_t)s->nq * sizeof *s->q);
    memcpy(w->end_state + s->nq, s->v, (size_t)s->nv * sizeof *s->v);
}

/* Evaluation point <- the end of the step just made. */
static void sym_load_end_state(sym_run *r, const sym_workspace *w) {
    sym_system *s = r->system;
    memcpy(s->q, w->end_state, (size_t)s->nq * sizeof *s->q);
    memcpy(s->v, w->end_state + s->nq, (size_t)s->nv * sizeof *s->v);
    *s->t = s->step_end;
}

/* The cubic on [0, 1] from 0 to d, with slopes f0 and f1 at its ends. */
static double sym_cubic(double x, double d, double f0, double f1) {
    return x * (f0 + x * ((3.0 * d - 2.0 * f0 - f1) + x * (f0 + f1 - 2.0 * d)));
}

/* Its slope at x. */
static double sym_cubic_slope(double x, double d, double f0, double f1) {
    return f0 + x * (2.0 * (3.0 * d - 2.0 * f0 - f1) + x * 3.0 * (f0 + f1 - 2.0 * d));
}

/* y at x in [0, 1] of the step that has just been made, of length h. *dense_ready: whether what the polynomial needs besides
 * the step has been evaluated. Returns 0 or a status. */
static int32_t sym_dense_output(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double x, double *y) {
    const sym_tableau *tableau = &r->tableau;
    const int32_t nv = r->system->nv, n = 2 * nv;
    int32_t i, j, l, status;
    if (r->method == SYM_METHOD_EXPLICIT && tableau->dense_degree > 0) {
        if (!*dense_ready) {
            status = sym_evaluate_stages(r, w, h, tableau->stages, tableau->dense_stages);
            if (status != 0) return status;
            *dense_ready = 1;
        }
        memset(y, 0, (size_t)n * sizeof *y);
        for (i = 0; i < tableau->dense_stages; ++i) {
            const double *p = tableau->dense + (size_t)i * (size_t)tableau->dense_degree;
            double s = 0.0;
            for (j = tableau->dense_degree - 1; j >= 0; --j) s = (s + p[j]) * x;
            if (s != 0.0)
                for (l = 0; l < n; ++l) y[l] += h * s * w->k[SYM_INDEX(i, w->stage_stride, l)];
        }
        for (l = 0; l < nv; ++l) y[nv + l] += r->v[l];
        return 0;
    }
    if (!*dense_ready) { /* cubic Hermite interpolation needs the slope at the end */
        sym_load_end_state(r, w);
        *r->system->t = sym_stage_time(r->system, *r->system->t);
        status = sym_evaluate_acceleration(r);
        sym_slope_of_acceleration(r->system, w->y1, w->end_slope);
        if (status != 0) return status;
        *dense_ready = 1;
    }
    for (l = 0; l < n; ++l) {
        const double y0 = l < nv ? 0.0 : r->v[l - nv];
        y[l] = y0 + sym_cubic(x, w->y1[l] - y0, h * w->k[l], h * w->end_slope[l]);
    }
    return 0;
}

/* Evaluation point <- the state at x in [0, 1] of the step just made, projected where the run projects; at its ends just
 * the states there. Returns 0 or a status. */
static int32_t sym_load_state_within_step(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double x) {
    int32_t status;
    if (x == 0.0) return sym_load_start(r), 0;
    if (x == 1.0) return sym_load_end_state(r, w), 0;
    status = sym_dense_output(r, w, h, dense_ready, x, w->stage);
    return status != 0 ? status : sym_load_projected_state(r, r->t + x * h, w->stage);
}

/* Record the evaluation point. Returns 0 or a status. */
static int32_t sym_record(sym_run *r) {
    const sym_system *s = r->system;
    const int64_t i = r->n_records;
    if (sym_evaluate_inputs(r->system) != 0) return SYM_CALLBACK_FAILED;
    r->record_t[i] = *s->t;
    memcpy(r->record_q + i * s->nq, s->q, (size_t)s->nq * sizeof(double));
    memcpy(r->record_v + i * s->nv, s->v, (size_t)s->nv * sizeof(double));
    memcpy(r->record_u + i * s->nu, s->u, (size_t)s->nu * sizeof(double));
    ++r->n_records;
    return 0;
}

/* Shares of a step within which a time of the grid is that of the step's end, on either side of it. */
#define SYM_GRID_BEFORE 1e-9
#define SYM_GRID_AFTER 1e-12
/* A time of the grid this near before actions, as a share of itself, is their instant: trajectories.py, _SAME_INSTANT. */
#define SYM_GRID_ACTED 1e-14

/* Record the times of the grid within the step just made, up to x_max and before its end. Returns 0 or a status. */
static int32_t sym_record_grid_within_step(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double x_max) {
    while (r->next_grid < r->n_grid) {
        const double x = (r->grid[r->next_grid] - r->t) / h;
        int32_t status;
        if (x > x_max || x > 1.0 - SYM_GRID_BEFORE) return 0;
        status = sym_load_state_within_step(r, w, h, dense_ready, x);
        if (status != 0) return status;
        *r->system->t = r->grid[r->next_grid];
        status = sym_record(r);
        if (status != 0) return status;
        ++r->next_grid;
    }
    return 0;
}

/* Record the times of the grid that are the present one, which ends a step of length h. Returns 0 or a status. */
static int32_t sym_record_grid_at_end(sym_run *r, double h) {
    while (r->next_grid < r->n_grid && r->grid[r->next_grid] <= r->t + SYM_GRID_AFTER * h) {
        int32_t status;
        sym_load_state(r);
        *r->system->t = r->grid[r->next_grid];
        status = sym_record(r);
        if (status != 0) return status;
        ++r->next_grid;
    }
    return 0;
}
