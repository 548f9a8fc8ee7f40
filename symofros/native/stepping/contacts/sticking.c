/* Friction that sticks: which coordinates it holds, and how the others slide (docs/theory/constraints.md, section 14). */

#define SYM_HELD 2.0
/* Modes of a ball of a rigid contact. */
#define SYM_OPEN 0.0
#define SYM_SLIDES 1.0
#define SYM_STICKS 2.0

/* Values of all formulas at the evaluation point: what says whether constraints hold, then what is assigned, then
 * the most that friction takes at rest. */
static const double *sym_action_values(const sym_actions *a, const double *par) {
    sym_prepare_call(&a->values, par);
    sym_evaluate(&a->values);
    return a->values.out[0];
}

/* Whether each coordinate is held, by parameters. */
static void sym_hold_by_modes(const sym_system *s, const double *par) {
    int32_t i;
    for (i = 0; i < s->n_sticking; ++i) s->held[i] = par[s->sticking[i].mode] == SYM_HELD;
}

/* Let go of what is held: friction has no impulse in an instant. */
static void sym_let_go(const sym_system *s, double *par) {
    int32_t i;
    for (i = 0; i < s->n_sticking; ++i)
        if (par[s->sticking[i].mode] == SYM_HELD) par[s->sticking[i].mode] = 0.0;
}

/* Let contacts go for an instant in which events act: what touches is found again by where it is. */
static void sym_open_contacts(const sym_system *s, double *par) {
    int32_t i;
    for (i = 0; i < s->n_contacts; ++i) par[s->contacts[i].mode] = SYM_OPEN;
}

/* Times what counts as an instant within which strikes follow each other where they accumulate. */
#define SYM_ACCUMULATION 1e3
/* Speed, beside one and beside the fastest, that is rounding of rest [rad/s or m/s]. */
#define SYM_RESTS_AT 1e-12
/* Share of the most that friction takes at rest at which it lets go: the rounding of a multiplier. Share of accelerations
 * that is their rounding. */
#define SYM_BREAKAWAY_ROUNDING 1e-12
#define SYM_ACCELERATION_ROUNDING 1e-10
/* Rounds in which modes are changed all at once, beyond their number; most rounds. */
enum { SYM_ALL_AT_ONCE = 3, SYM_MOST_ROUNDS = 1000 };
#define SYM_MOST_REPEATS 20.0 /* how often a mode may end at one instant */

/* Share of the time since the begin of a motion that counts as an instant to actions, and of time itself, which is its rounding. */
#define SYM_SHARE_OF_MOTION 1e-9
#define SYM_TIME_ROUNDING 1e-13
#define SYM_NO_TIME 1e-200 /* so that it is above zero at t = 0 */

static double sym_run_one_instant(const sym_run *r, double t) {
    const double rounding = SYM_TIME_ROUNDING * fmax(fabs(t), SYM_NO_TIME);
    if (r->actions->at_once > 0.0) return r->actions->at_once;
    return fmax(SYM_SHARE_OF_MOTION * (t - r->acted_at[r->system->n_events]), rounding);
}

/* Time within which a strike follows the one before where they accumulate; e: its coefficient, (32c). Explicit Euler adds more
 * to shorter flights than the strike takes. */
SYM_EXPORT double sym_run_accumulation(const sym_run *r, double t, double e) {
    const double instant = SYM_ACCUMULATION * sym_run_one_instant(r, t);
    const int32_t adds = r->method == SYM_METHOD_EXPLICIT && r->tableau.stages == 1 && e < 1.0;
    return adds ? fmax(instant, 2.0 * r->h / (1.0 - e)) : instant;
}

/* Note when a motion begins, parts of which may be runs of their own. */
static void sym_note_begin(const sym_run *r) {
    double *begun = r->acted_at + r->system->n_events;
    if (*begun == -HUGE_VAL) *begun = r->t;
}

/* Count that a mode ends once more: acted_at runs ahead of time by a share of what counts as an instant each time. Returns 0
 * or a status. */
static int32_t sym_count_repeats(sym_run *r, int32_t event) {
    const double instant = sym_run_one_instant(r, r->t);
    double *at = r->acted_at + event;
    *at = (*at > r->t ? *at : r->t) + instant / SYM_MOST_REPEATS;
    return *at > r->t + instant ? SYM_ACTS_WITHOUT_END : 0;
}

/* The mode that a coordinate at rest has to have instead of its present one, by the accelerations and multipliers at the
 * evaluation point, (37); the present one where that agrees. breakaway: what friction takes at rest; size: of the acceleration. */
static double sym_mode_by_motion(const sym_system *s, const sym_sticking *of, double mode, double breakaway, double size) {
    const double lam = s->lam[of->row], a = s->a[of->v];
    if (mode == SYM_HELD) {
        if (fabs(lam) < breakaway * (1.0 - SYM_BREAKAWAY_ROUNDING)) return mode;
        return lam > 0.0 ? -1.0 : 1.0;
    }
    if (mode * a >= -SYM_ACCELERATION_ROUNDING * size) return mode;
    return breakaway > 0.0 ? SYM_HELD : -mode;
}

/* Accelerations and multipliers at the evaluation point by parameters that differ in modes. Returns 0 or a status. */
static int32_t sym_evaluate_modes(sym_run *r, const double *par) {
    sym_system *s = r->system;
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_prepare_call(&s->forward_dynamics, par);
    sym_evaluate(&s->forward_dynamics);
    return sym_complete_acceleration(r, par);
}

/* Modes of the coordinates at rest, those with a size of 0 or more: from all held on, they change until all agree with the
 * motion that they bring about; then one at a time, the first that does not. free_rank: of G where none is held. Returns 0
 * or a status. */
static int32_t sym_agree_on_modes(sym_run *r, double *par, const double *breakaway, double *size, int32_t free_rank) {
    const sym_system *s = r->system;
    int32_t i, round, changed, twice = 0;
    for (round = 0; round < SYM_MOST_ROUNDS; ++round) {
        const int32_t status = sym_evaluate_modes(r, par);
        int32_t spare = (int32_t)*s->rank - free_rank;
        if (status != 0) return status;
        for (i = 0; i < s->n_sticking; ++i) spare -= par[s->sticking[i].mode] == SYM_HELD;
        twice |= spare < 0;
        for (i = 0, changed = 0; i < s->n_sticking; ++i) {
            const sym_sticking *of = s->sticking + i;
            double *mode = par + of->mode, next;
            if (size[i] < 0.0) continue;
            if (fabs(s->a[of->v]) > size[i]) size[i] = fabs(s->a[of->v]);
            next = sym_mode_by_motion(s, of, *mode, breakaway[i], size[i]);
            if (next == *mode) continue;
            *mode = next, ++changed;
            if (round >= s->n_sticking + SYM_ALL_AT_ONCE) break;
        }
        if (changed == 0) return spare < 0 ? SYM_HELD_TWICE : 0;
    }
    return twice ? SYM_HELD_TWICE : SYM_MODES_UNDECIDED;
}

/* Choose the modes at the present state, whose speeds that are rounding of rest become zero. Returns 0 or a status, with the
 * modes as they were. */
static int32_t sym_choose_modes(sym_run *r) {
    const sym_actions *a = r->actions;
    const sym_system *s = r->system;
    const int32_t n = s->n_sticking;
    double *par = a->modes, *breakaway = par + a->npar, *size = breakaway + n, fastest = 1.0, gap;
    int32_t i, free_rank, status;
    memcpy(par, r->par, (size_t)a->npar * sizeof *par);
    sym_load_state(r);
    memcpy(breakaway, sym_action_values(a, par) + a->n_switches + a->n_assignments, (size_t)n * sizeof *breakaway);
    for (i = 0; i < s->nv; ++i)
        if (fabs(r->v[i]) > fastest) fastest = fabs(r->v[i]);
    for (i = 0; i < n; ++i) { /* as they are without friction at rest */
        double *v = r->v + s->sticking[i].v;
        const int32_t rests = fabs(*v) <= SYM_RESTS_AT * fastest;
        if (rests) *v = 0.0;
        par[s->sticking[i].mode] = rests ? 0.0 : *v > 0.0 ? 1.0 : -1.0, size[i] = rests ? 0.0 : -1.0;
    }
    sym_load_state(r);
    status = sym_evaluate_modes(r, par);
    free_rank = (int32_t)*s->rank;
    for (i = 0; i < n; ++i)
        if (size[i] == 0.0) size[i] = fabs(s->a[s->sticking[i].v]), par[s->sticking[i].mode] = SYM_HELD;
    if (status == 0) status = sym_agree_on_modes(r, par, breakaway, size, free_rank);
    if (status != 0) {
        sym_prepare_call(&s->forward_dynamics, r->par);
        return status;
    }
    sym_run_set_parameters(r, par);
    return sym_run_engage(r, &gap);
}
