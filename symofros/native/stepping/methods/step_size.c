/* Step-size control: error norm, controller, first step (docs/theory/simulation.md, (4)). */

/* Magnitudes of the entries of y at the present state, for relative errors: |q|, |v|, and 1 for a rotation. */
static void sym_state_magnitudes(const sym_run *r, double *magnitude) {
    const sym_system *s = r->system;
    int32_t i, k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t translations = seg->kind == SYM_SEGMENT_LINEAR ? seg->size : seg->kind == SYM_SEGMENT_POSE ? 3 : 0;
        const int32_t rotations = seg->kind == SYM_SEGMENT_LINEAR ? 0 : 3;
        for (i = 0; i < translations; ++i) magnitude[seg->v + i] = fabs(r->q[seg->q + i]);
        for (i = 0; i < rotations; ++i) magnitude[seg->v + translations + i] = 1.0;
    }
    for (i = 0; i < s->nv; ++i) magnitude[s->nv + i] = fabs(r->v[i]);
}

/* The bound of an error of entry l of y: atol + rtol times the larger magnitude of both ends. */
static double sym_error_scale(const sym_run *r, int32_t l, const double *magnitude, const double *y1) {
    double s = magnitude[l];
    if (l >= r->system->nv && fabs(y1[l]) > s) s = fabs(y1[l]);
    return r->atol + r->rtol * s;
}

/* Mean over y of (estimated error / bound)^2, for one set of weights. */
static double sym_mean_square_error(const sym_run *r, const sym_workspace *w, const double *weights, double h) {
    const int32_t n = 2 * r->system->nv;
    double sum = 0.0;
    int32_t i, l;
    for (l = 0; l < n; ++l) {
        double e = 0.0;
        for (i = 0; i < r->tableau.stages; ++i) e += weights[i] * w->k[SYM_INDEX(i, w->stage_stride, l)];
        e *= h / sym_error_scale(r, l, w->magnitude, w->y1);
        sum += e * e;
    }
    return sum / n;
}

/* Root mean square over y of the estimated error over its bound: a step is accepted up to 1. */
static double sym_error_norm(const sym_run *r, const sym_workspace *w, double h) {
    const double first = sym_mean_square_error(r, w, r->tableau.e, h);
    double second;
    if (r->tableau.n_estimates < 2) return sqrt(first);
    second = sym_mean_square_error(r, w, r->tableau.e2, h);
    return first == 0.0 ? 0.0 : first / sqrt(first + 0.01 * second);
}

/* The first step size, from the norms of state, slope and change of slope (Hairer, Norsett, Wanner I, II.4).
 * Returns 0 or a status. */
static int32_t sym_initial_step_size(sym_run *r, sym_workspace *w) {
    const int32_t nv = r->system->nv, n = 2 * nv;
    const double order = r->tableau.estimate_order + 1.0;
    double d0 = 0.0, d1 = 0.0, d2 = 0.0, h0, h1, largest;
    int32_t l, status;
    sym_state_magnitudes(r, w->magnitude);
    for (l = 0; l < nv; ++l) w->y1[l] = 0.0, w->y1[nv + l] = r->v[l];
    for (l = 0; l < n; ++l) {
        const double scale = sym_error_scale(r, l, w->magnitude, w->y1);
        d0 += (w->magnitude[l] / scale) * (w->magnitude[l] / scale);
        d1 += (w->k[l] / scale) * (w->k[l] / scale);
    }
    d0 = sqrt(d0 / n), d1 = sqrt(d1 / n);
    h0 = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;
    if (h0 > r->t_end - r->t && r->t_end > r->t) h0 = r->t_end - r->t;
    for (l = 0; l < nv; ++l) w->stage[l] = h0 * w->k[l], w->stage[nv + l] = r->v[l] + h0 * w->k[nv + l];
    status = sym_evaluate_slope(r, r->t + h0, w->stage, w->end_slope);
    if (status == SYM_CALLBACK_FAILED) return status;
    if (status != 0) {
        r->next_step = 1e-3 * h0;
        return 0;
    }
    for (l = 0; l < n; ++l) {
        const double scale = sym_error_scale(r, l, w->magnitude, w->y1), d = (w->end_slope[l] - w->k[l]) / scale;
        d2 += d * d;
    }
    d2 = sqrt(d2 / n) / h0;
    largest = d1 > d2 ? d1 : d2;
    h1 = largest <= 1e-15 ? (1e-6 > 1e-3 * h0 ? 1e-6 : 1e-3 * h0) : pow(0.01 / largest, 1.0 / order);
    r->next_step = 100.0 * h0 < h1 ? 100.0 * h0 : h1;
    return 0;
}

/* Limits of the controller, equation (4): safety factor, damping (the PI term), and how much h may change at once. */
#define SYM_STEP_SAFETY 0.9
#define SYM_STEP_DAMPING 0.04
#define SYM_STEP_GROWTH 8.0
#define SYM_STEP_SHRINK 0.2

/* The size of the step after one of size h with that error norm: a proportional-integral controller. */
static double sym_next_step_size(sym_run *r, double h, double error) {
    const double order = r->tableau.estimate_order + 1.0, exponent = 1.0 / order - 0.75 * SYM_STEP_DAMPING;
    double factor = SYM_STEP_GROWTH;
    if (error > 0.0) factor = SYM_STEP_SAFETY * pow(error, -exponent) * pow(r->previous_error, SYM_STEP_DAMPING);
    if (factor > SYM_STEP_GROWTH) factor = SYM_STEP_GROWTH;
    if (factor < SYM_STEP_SHRINK) factor = SYM_STEP_SHRINK;
    return h * factor;
}

/* Size of a state that has grown without bound: what follows is soon beyond what sym_all_finite allows. */
#define SYM_EXPLODED 1e80

/* Why adaptive steps have become too short: a motion without bound, which no step continues, or the tolerances. */
static int32_t sym_too_short(const sym_run *r) {
    int32_t i;
    for (i = 0; i < r->system->nq; ++i)
        if (fabs(r->q[i]) > SYM_EXPLODED) return SYM_DIVERGED;
    for (i = 0; i < r->system->nv; ++i)
        if (fabs(r->v[i]) > SYM_EXPLODED) return SYM_DIVERGED;
    return SYM_STEP_TOO_SMALL;
}

/* The step to try next: its length h and the time t1 at its end. Returns 0 or a status. */
static int32_t sym_propose_step(sym_run *r, sym_workspace *w, double *h, double *t1) {
    *h = r->adaptive ? r->next_step : r->h;
    *t1 = r->adaptive ? r->t + *h : sym_multiple(r->t_from + (double)(r->steps + 1 - r->n_from) * r->h, r->h);
    /* Of states too large for their squares not even the first step is a number. */
    if (r->adaptive && !(*h >= 16.0 * 2.2e-16 * fabs(r->t) + 1e-300)) return sym_too_short(r);
    if (*t1 >= r->t_end - 1e-9 * *h) *t1 = r->t_end; /* no sliver of a last step */
    if (r->adaptive && r->max_step > 0.0 && *t1 - r->t > r->max_step) *t1 = r->t + r->max_step;
    if (r->adaptive) {
        const double beyond = *t1 + 1e-9 * *h, stop = sym_next_stop(r->system, r->t, beyond);
        if (stop < beyond) *t1 = stop;
        if (r->met_at > sym_instant(r->t) && r->met_at < *t1) *t1 = r->met_at;
        sym_state_magnitudes(r, w->magnitude);
        *t1 = sym_end_by_inputs(r, w, *t1);
    }
    *h = *t1 - r->t;
    sym_begin_step(r->system, r->t, *t1);
    return 0;
}
