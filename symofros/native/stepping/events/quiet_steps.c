/* Accepted steps in which next to nothing happens (docs/theory/simulation.md, (3d)): they grow without bound, and what acts
 * for a small part of one may lie between its stages. A few points of each are looked at along the dense output. */

/* Intervals of a run in each of which a quiet step is looked into. */
#define SYM_LOOKS 64
/* Error norm up to which a step is quiet. */
#define SYM_QUIET 1e-2
/* Times the bound of a step's error that an acceleration may change the speeds by, if it lasted, before it counts as met. */
#define SYM_MET 10.0
/* Difference of x by which the dense output is differentiated. */
#define SYM_DENSE_DIFFERENCE 1e-4

/* Norm, as of (4), of what the accelerations at x of the step just tried would add to the speeds beyond the dense output's own
 * rate, over the whole step. Returns 0 or a status. */
static int32_t sym_unseen_acceleration(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double x, double *norm) {
    const int32_t nv = r->system->nv;
    double *rate = w->unseen, *y = w->unseen + nv, sum = 0.0;
    int32_t l, status;
    status = sym_dense_output(r, w, h, dense_ready, x - SYM_DENSE_DIFFERENCE, y);
    if (status != 0) return status;
    for (l = 0; l < nv; ++l) rate[l] = -y[nv + l];
    (void)sym_dense_output(r, w, h, dense_ready, x + SYM_DENSE_DIFFERENCE, y);
    for (l = 0; l < nv; ++l) rate[l] = (rate[l] + y[nv + l]) / (2.0 * SYM_DENSE_DIFFERENCE);
    (void)sym_dense_output(r, w, h, dense_ready, x, y);
    sym_load_chart_state(r, r->t + x * h, y);
    status = sym_evaluate_acceleration(r);
    if (status != 0) return status;
    for (l = 0; l < nv; ++l) {
        const double e = (h * r->system->a[l] - rate[l]) / sym_error_scale(r, nv + l, w->magnitude, w->y1);
        sum += e * e;
    }
    *norm = sqrt(sum / (2 * nv));
    return 0;
}

/* Look within the step of length h just tried, whose error norm is that: a point for each interval of r->look_every, of places
 * that differ from step to step. Where something acts that the stages have not seen, the next steps end there. Returns
 * whether nothing does, or a status below 0. */
static int32_t sym_look_within_step(sym_run *r, sym_workspace *w, double h, double error) {
    const int32_t n = r->look_every > 0.0 && error <= SYM_QUIET ? (int32_t)(h / r->look_every) : 0;
    const double offset = fmod(0.6180339887498949 * (double)(r->steps + 1 - r->n_from), 1.0);
    int32_t i, status, dense_ready = 0;
    if (n > 0) { /* where the dense output takes its last slope */
        if (sym_load_projected_state(r, r->system->step_end, w->y1) != 0) return 1; /* accepting the step says so */
        sym_store_end_state(r->system, w);
    }
    for (i = 0; i < n; ++i) {
        const double x = (i + 0.05 + 0.9 * offset) / n;
        double norm = 0.0;
        status = sym_unseen_acceleration(r, w, h, &dense_ready, x, &norm);
        if (status == SYM_CALLBACK_FAILED) return status;
        if (status != 0 || !(norm <= SYM_MET)) {
            r->met_at = r->t + x * h;
            return 0;
        }
    }
    return 1;
}
