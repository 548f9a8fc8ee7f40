/* How axial loads amplify the error of beams in a motion: docs/theory/beams.md, (26a) and (26c). */

/* Error of the slope alone below which no axial load is looked for; angle [rad] by which sections are turned for differences
 * of forces, and the angle below which nothing is deformed; least share of the elastic work that the tangent stiffness counts
 * with. */
#define SYM_BEAM_UNAMPLIFIED 1e-5
#define SYM_BEAM_LEAST_TURN 1e-100
#define SYM_BEAM_TURN 1e-4
#define SYM_BEAM_LEAST_WORK 1e-9
/* Share of a run's evaluations that may look at axial loads. */
#define SYM_BEAM_SHARE 0.005
/* States from which on axial loads may end a run: a single one may be a passing one. */
#define SYM_BEAM_LASTING 4

/* Nothing is known of the motion. */
static void sym_clear_axial_loads(sym_run *r) {
    const double stages = r->tableau.stages > 0 ? r->tableau.stages : 1.0;
    r->beam_states = 0, r->beam_wait = 1;
    r->beam_stride = (int64_t)ceil((2.0 * r->system->n_beams + 1.0) / (SYM_BEAM_SHARE * stages));
}

/* a (nv) and lam (nc) at the evaluation point, which is the present state with a beam's deformation times a factor. */
static void sym_accelerate_deformed(sym_run *r, const sym_beam *beam, double factor) {
    sym_system *s = r->system;
    const int32_t n = beam->n;
    int32_t i;
    sym_load_state(r);
    for (i = 0; i < n; ++i) s->q[beam->q + i] *= factor;
    (void)sym_evaluate_inputs(s);
    sym_evaluate(&s->forward_dynamics);
}

/* Works of a beam's elastic and tangent stiffness in the present state, whose M and G are evaluated (26c). */
static void sym_axial_works(sym_run *r, const sym_beam *beam, double works[2]) {
    const sym_system *s = r->system;
    const int32_t nv = s->nv, n = beam->n;
    const double *x = r->q + beam->q, *reach = r->beam_reach + beam->first;
    double *change = r->beam_change, turned = 0.0, step;
    int32_t i, k;
    works[0] = works[1] = 0.0;
    for (i = 0; i < n; ++i) turned += reach[i] * fabs(x[i]);
    if (!(turned > SYM_BEAM_LEAST_TURN)) return;
    step = SYM_BEAM_TURN / turned;
    sym_accelerate_deformed(r, beam, 1.0 + step);
    memcpy(change, s->a, (size_t)nv * sizeof *change);
    if (s->nc > 0) memcpy(change + nv, s->lam, (size_t)s->nc * sizeof *change);
    sym_accelerate_deformed(r, beam, 1.0 - step);
    for (k = 0; k < nv; ++k) change[k] -= s->a[k];
    for (k = 0; k < s->nc; ++k) change[nv + k] -= s->lam[k];
    for (i = 0; i < n; ++i) {
        const size_t row = (size_t)(beam->v + i) * (size_t)nv;
        for (k = 0; k < n; ++k) works[0] += x[i] * r->elastic_stiffness[row + (size_t)(beam->v + k)] * x[k];
        for (k = 0; k < nv; ++k) works[1] -= x[i] * s->mass_matrix.out[0][row + (size_t)k] * change[k];
        for (k = 0; k < s->nc; ++k)
            works[1] += x[i] * s->constraint_jacobian.out[0][(size_t)k * (size_t)nv + (size_t)(beam->v + i)] * change[nv + k];
    }
    works[1] /= 2.0 * step;
}

/* The amplification of a beam's error (26a). */
static double sym_beam_amplification(const sym_run *r, int32_t beam) {
    double elastic = 0.0, total = 0.0;
    int32_t k;
    for (k = 0; k < r->beam_states; ++k) {
        const double *works = r->beam_works + 2 * ((size_t)k * (size_t)r->system->n_beams + (size_t)beam);
        elastic += works[0], total += works[1];
    }
    if (!(elastic > 0.0) || !isfinite(total)) return 1.0;
    total = fabs(total);
    return elastic / (total > SYM_BEAM_LEAST_WORK * elastic ? total : SYM_BEAM_LEAST_WORK * elastic);
}

SYM_EXPORT double sym_run_beam_error(sym_run *r, int32_t beam) {
    sym_run_settle_beams(r);
    return r->beam_error[beam] * 0.25 * (sym_beam_amplification(r, beam) + 3.0);
}

/* Every other state stays, and half as many of the following ones are looked at. */
static void sym_thin_beam_states(sym_run *r) {
    const size_t row = 2 * (size_t)r->system->n_beams;
    int32_t k;
    r->beam_states /= 2, r->beam_stride *= 2;
    for (k = 1; k < r->beam_states; ++k)
        memcpy(r->beam_works + (size_t)k * (size_t)row, r->beam_works + 2 * (size_t)k * (size_t)row, row * sizeof(double));
}

/* Look at the axial loads of the present state, after its bending was judged. Returns 0 or SYM_BEYOND_THEORY. */
static int32_t sym_look_at_axial_loads(sym_run *r) {
    sym_system *s = r->system;
    double largest = 0.0;
    int32_t b;
    if (r->elastic_stiffness == NULL) return 0;
    sym_run_settle_beams(r);
    for (b = 0; b < s->n_beams; ++b)
        if (r->beam_error[b] > largest) largest = r->beam_error[b];
    if (r->beam_states == SYM_BEAM_STATES) sym_thin_beam_states(r);
    r->beam_wait = r->beam_stride;
    if (largest < SYM_BEAM_UNAMPLIFIED) return 0;
    sym_load_state(r);
    (void)sym_evaluate_inputs(s);
    sym_evaluate(&s->mass_matrix);
    if (s->nc > 0) sym_evaluate(&s->constraint_jacobian);
    for (b = 0; b < s->n_beams; ++b)
        sym_axial_works(r, &s->beams[b], r->beam_works + 2 * ((size_t)r->beam_states * (size_t)s->n_beams + (size_t)b));
    ++r->beam_states;
    sym_load_state(r);
    for (b = 0; b < s->n_beams && r->beam_states >= SYM_BEAM_LASTING; ++b)
        if (sym_run_beam_error(r, b) > r->beam_limit) return SYM_BEYOND_THEORY;
    return 0;
}

/* The same if the state is one of those kept. */
static int32_t sym_judge_axial_loads(sym_run *r) {
    return --r->beam_wait == 0 ? sym_look_at_axial_loads(r) : 0;
}
