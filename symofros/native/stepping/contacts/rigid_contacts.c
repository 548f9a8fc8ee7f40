/* Rigid contacts with friction: impacts, and which mode each takes (docs/theory/constraints.md, section 15). */

enum { SYM_MOST_STRIKES = 10000, SYM_TILT = 6, SYM_SINE = 7 }; /* entries of a ball's state: of its normal, of a rim */
/* Slip up to which adaptive steps do not follow how its direction turns [m/s]. */
#define SYM_SLOW 1e-5
/* Share of the speed with which a ball began to slide that is left by the turning of its path where it comes to rest. */
#define SYM_SLIP_LEFT 1e-6
/* Distance by which a ball that grazes a plane may pass it, at first, and one that stays on it without a force: a gap of less
 * is known to too few digits for its rate [m]. */
#define SYM_GRAZES 1e-13
#define SYM_IDLES 1e-10
/* Cosine between a normal and its pole from which on a pole stays as it is. */
#define SYM_POLE_STAYS -0.25
/* Sine of the angle below which a rim lies on its plane, or a segment along its surface, and touches along a line. */
#define SYM_FLAT 0.01
/* Twice the acceleration towards a plane below which a ball is taken to rise above it from where rounding has put it [m/s^2]. */
#define SYM_STEEP 1e3

/* Balls that touch, at one instant. */
typedef struct sym_touching {
    int32_t of[SYM_MOST_CONTACTS]; /* their numbers */
    double u[SYM_MOST_FORCES];     /* velocities */
    double gap[SYM_MOST_CONTACTS];
    double apart[SYM_MOST_CONTACTS]; /* how far one may go below that, or the plane, by rounding, if it is open */
    int32_t struck[SYM_MOST_CONTACTS]; /* whether they have done so now: deeper strikes from bounce to bounce would give energy */
    int32_t returns; /* whether one that moves away would come back within an instant, and is held */
    sym_contact_problem problem;
} sym_touching;

/* Accelerations and multipliers at the evaluation point by other parameters, the inputs being known. Returns 0 or a status. */
static int32_t sym_try_contacts(sym_run *r, const double *par) {
    int32_t status;
    sym_prepare_call(&r->system->forward_dynamics, par);
    sym_evaluate(&r->system->forward_dynamics);
    status = sym_check_acceleration(r);
    return status != 0 ? status : sym_add_sliding(r, par);
}

/* u (3 n): what the velocities of the balls would be with the speeds v; the evaluation point stays. */
static void sym_velocities_of_balls(const sym_run *r, const sym_touching *at, const double *v, double *u) {
    const sym_system *s = r->system;
    double *kept = sym_scratch_of_contacts(r).v;
    int32_t i, k;
    memcpy(kept, s->v, (size_t)s->nv * sizeof *v), memcpy(s->v, v, (size_t)s->nv * sizeof *v);
    sym_evaluate(&s->contact_state);
    for (i = 0; i < at->problem.n; ++i)
        for (k = 0; k < 3; ++k) u[3 * i + k] = s->contact_state.out[0][SYM_CONTACT_ENTRIES * at->of[i] + 1 + k];
    memcpy(s->v, kept, (size_t)s->nv * sizeof *v);
}

/* W of the balls that touch at the evaluation point, and what unit forces on them add to the accelerations, (42), from par, in
 * which their modes are open. Returns 0 or a status. */
static int32_t sym_inertia_of_balls(sym_run *r, sym_touching *at, double *par) {
    const sym_system *s = r->system;
    const sym_contact_scratch scratch = sym_scratch_of_contacts(r);
    const int32_t n = 3 * at->problem.n, nv = s->nv;
    double first[SYM_MOST_FORCES], u[SYM_MOST_FORCES];
    int32_t i, j, l, status = sym_try_contacts(r, par);
    if (status != 0) return status;
    memcpy(scratch.free_a, s->a, (size_t)nv * sizeof *s->a);
    sym_velocities_of_balls(r, at, scratch.free_a, first);
    for (j = 0; j < n; ++j) {
        double *effect = scratch.effect + (size_t)j * (size_t)nv, *push = par + s->contacts[at->of[j / 3]].push[j % 3];
        *push = 1.0;
        status = sym_try_contacts(r, par);
        *push = 0.0;
        if (status != 0) return status;
        sym_velocities_of_balls(r, at, s->a, u);
        for (l = 0; l < nv; ++l) effect[l] = s->a[l] - scratch.free_a[l];
        for (i = 0; i < n; ++i) at->problem.W[n * i + j] = u[i] - first[i];
    }
    return 0;
}

/* Impulses P (3 n) on the balls change velocities and speeds. */
static void sym_add_impulses(sym_run *r, sym_touching *at, int32_t first, int32_t end, const double *P) {
    const sym_contact_scratch scratch = sym_scratch_of_contacts(r);
    const int32_t n = 3 * at->problem.n, nv = r->system->nv;
    int32_t i, j, l;
    for (j = first; j < end; ++j) {
        for (i = 0; i < n; ++i) at->u[i] += at->problem.W[n * i + j] * P[j - first];
        for (l = 0; l < nv; ++l) r->v[l] += scratch.effect[(size_t)j * (size_t)nv + (size_t)l] * P[j - first];
    }
}

/* Balls that strike without restitution do so at once; others, and those of which no such motion is found, in sequence, the fastest
 * first, until none approaches. Returns 0 or a status. */
static int32_t sym_strike(sym_run *r, sym_touching *at, double still, const double *e) {
    sym_contact_problem *p = &at->problem;
    const int32_t n = 3 * p->n;
    int32_t round, i, j, k, elastic = 0, alone = p->n == 1;
    for (i = 0; i < p->n; ++i) elastic |= e[i] > 0.0;
    memcpy(p->b, at->u, (size_t)n * sizeof *at->u);
    if (!elastic && !alone) {
        if (sym_solve_contacts(p, 0) == 0) {
            sym_add_impulses(r, at, 0, n, p->f);
            return 0;
        }
        *sym_struck_in_sequence(r->system) = r->t;
    }
    for (round = 0; round < SYM_MOST_STRIKES; ++round) {
        double W[9], P[3];
        int32_t status, most = 0;
        for (i = 1; i < p->n; ++i)
            if (at->u[3 * i + 2] < at->u[3 * most + 2]) most = i;
        if (!(at->u[3 * most + 2] < -still)) return 0;
        for (j = 0; j < 3; ++j)
            for (k = 0; k < 3; ++k) W[3 * j + k] = p->W[n * (3 * most + j) + 3 * most + k];
        status = sym_impact_of_ball(W, at->u + 3 * most, p->mu[most], e[most], P);
        if (status != 0) return status;
        sym_add_impulses(r, at, 3 * most, 3 * most + 3, P);
    }
    return SYM_NO_CONTACT_FORCE;
}

/* Poles by the normals at the evaluation point, in par: one that is far from its pole takes the other one. */
static void sym_choose_poles(const sym_system *s, double *par) {
    int32_t i, taken = 0;
    for (i = 0; i < s->n_contacts; ++i) {
        const double tilt = s->contact_state.out[0][SYM_CONTACT_ENTRIES * i + SYM_TILT];
        double *pole = par + s->contacts[i].pole;
        if (s->contacts[i].pole < 0 || *pole * tilt >= SYM_POLE_STAYS) continue;
        *pole = -*pole, taken = 1;
    }
    if (!taken) return;
    sym_prepare_call(&s->contact_state, par);
    sym_evaluate(&s->contact_state);
}

/* The events of a ball have been dealt with at the present time: changes within rounding are none from here on. */
static void sym_ball_settled(sym_run *r, int32_t ball) {
    double *acted_at = r->acted_at + sym_first_contact_event(r) + 2 * ball;
    acted_at[0] = fmax(acted_at[0], r->t), acted_at[1] = fmax(acted_at[1], r->t);
}

/* Balls that touch at the present state, which becomes the evaluation point, by their modes, by what has been met, and by where
 * they are. Returns 0 or a status: one has penetrated where a motion begins, too many touch, or one touches along a line. */
static int32_t sym_find_touching(sym_run *r, double *par, const double *met, int32_t begins, sym_touching *at) {
    const sym_system *s = r->system;
    int32_t i, k, n = 0, flat = 0;
    sym_load_state(r);
    if (sym_evaluate_inputs(r->system) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->contact_state);
    sym_choose_poles(s, par);
    for (i = 0; i < s->n_contacts; ++i) {
        const double *state = s->contact_state.out[0] + SYM_CONTACT_ENTRIES * i;
        if (begins && state[0] < -SYM_TOUCHING) return SYM_WRONG_CONTACT;
        if (par[s->contacts[i].mode] == SYM_OPEN && state[0] > SYM_TOUCHING && !(met != NULL && met[i] > 0.0)) continue;
        if (state[SYM_SINE] < SYM_FLAT) { /* open while others carry it, (40a) */
            if (state[0] < -SYM_TOUCHING) return SYM_FLAT_RIM;
            par[s->contacts[i].mode] = SYM_OPEN, par[s->contacts[i].apart] = SYM_LIES, flat = 1;
            sym_ball_settled(r, i);
            continue;
        }
        if (n == SYM_MOST_CONTACTS) return SYM_WRONG_CONTACT;
        at->of[n] = i, at->problem.mu[n] = state[4];
        at->problem.parts[n] = at->problem.slides[n] = 0, at->problem.d[2 * n] = 1.0, at->problem.d[2 * n + 1] = 0.0;
        at->apart[n] = met == NULL ? 0.0 : par[s->contacts[i].apart]; /* as it has become, where others are met */
        if (met != NULL && met[i] > 0.0) at->apart[n] = fmin(fmax(SYM_GRAZES, 2.0 * at->apart[n]), SYM_TOUCHING);
        at->gap[n] = state[0];
        for (k = 0; k < 3; ++k) at->u[3 * n + k] = state[1 + k];
        ++n;
    }
    at->problem.n = n;
    return flat && n == 0 ? SYM_FLAT_RIM : 0;
}

/* How the balls that touch move: which slide, and in which direction; which move away. Where a slip turns again within an instant
 * it vanishes in a spiral. */
static void sym_sort_touching(const sym_run *r, sym_touching *at, double still, const double *met, const double *par) {
    sym_contact_problem *p = &at->problem;
    int32_t i;
    for (i = 0; i < p->n; ++i) {
        const sym_rigid_contact *of = r->system->contacts + at->of[i];
        const double x = at->u[3 * i], y = at->u[3 * i + 1], slip = hypot(x, y);
        const int32_t turned = met != NULL && met[at->of[i]] < 0.0 && par[of->mode] == SYM_SLIDES;
        double *last = sym_ball_memory(r->system, at->of[i]) + 4;
        const int32_t again = r->t - *last <= SYM_ACCUMULATION * sym_run_one_instant(r, r->t);
        if (turned) *last = r->t;
        p->parts[i] = at->u[3 * i + 2] > still;
        p->slides[i] = slip > still && !(turned && (again || slip <= SYM_SLIP_LEFT * par[of->way[2]]));
        if (p->slides[i]) p->d[2 * i] = x / slip, p->d[2 * i + 1] = y / slip;
    }
}

/* b of the problem: accelerations of the points of contact without contact, against those where what rests sticks and the rest
 * stays on its plane. par: modes of the balls are open before and after. Returns 0 or a status. */
static int32_t sym_accelerations_of_balls(sym_run *r, sym_touching *at, double *par) {
    const sym_system *s = r->system;
    sym_contact_problem *p = &at->problem;
    double reference[SYM_MOST_FORCES];
    int32_t i, status = sym_try_contacts(r, par);
    if (status != 0) return status;
    sym_velocities_of_balls(r, at, s->a, p->b);
    for (i = 0; i < p->n; ++i)
        par[s->contacts[at->of[i]].mode] = p->parts[i] ? SYM_OPEN : !p->slides[i] && p->mu[i] > 0.0 ? SYM_STICKS : SYM_SLIDES;
    sym_prepare_call(&s->forward_dynamics, par); /* without friction */
    sym_evaluate(&s->forward_dynamics);
    status = sym_check_acceleration(r);
    if (status == 0) sym_velocities_of_balls(r, at, s->a, reference);
    for (i = 0; i < 3 * p->n && status == 0; ++i) p->b[i] = p->parts[i / 3] ? 0.0 : p->b[i] - reference[i];
    for (i = 0; i < p->n; ++i) par[s->contacts[at->of[i]].mode] = SYM_OPEN;
    return status;
}

/* Modes and forces of the balls that touch, of which those that come back within an instant do not move away: where strikes of
 * several balls accumulate, as of a box that rocks, (46a). Returns 0 or a status. */
static int32_t sym_solve_returning(sym_run *r, sym_touching *at, double *par) {
    sym_contact_problem *p = &at->problem;
    const double instant = SYM_ACCUMULATION * sym_run_one_instant(r, r->t);
    int32_t slow[SYM_MOST_CONTACTS], i, again = 1, status = 0;
    at->returns = 0;
    for (i = 0; i < p->n; ++i) {
        slow[i] = p->parts[i] && at->u[3 * i + 2] < SYM_SLOW;
        if (slow[i]) p->parts[i] = 0;
    }
    while (again) {
        again = 0;
        status = sym_accelerations_of_balls(r, at, par);
        if (status == 0) status = sym_solve_contacts(p, 1);
        for (i = 0; i < p->n; ++i) {
            const double a = p->W[(3 * p->n + 1) * (3 * i + 2)] * p->f[3 * i + 2]; /* what its force takes away */
            if (!slow[i] || (status == 0 && (p->mode[i] == SYM_OPEN || 2.0 * at->u[3 * i + 2] < a * instant))) continue;
            p->parts[i] = 1, slow[i] = 0, again = 1;
        }
    }
    for (i = 0; i < p->n; ++i) at->returns |= slow[i] && p->mode[i] != SYM_OPEN;
    return status;
}

/* Impacts of the balls that touch, then the modes in which they go on, in par, where they are open. Returns 0 or a status. */
static int32_t sym_decide_contacts(sym_run *r, sym_touching *at, const double *was, const double *met, double *par) {
    const sym_system *s = r->system;
    sym_contact_problem *p = &at->problem;
    double still, fastest = 1.0, e[SYM_MOST_CONTACTS];
    int32_t i, strikes = 0, status = sym_inertia_of_balls(r, at, par);
    for (i = 0; i < s->nv; ++i) fastest = fmax(fastest, fabs(r->v[i]));
    still = SYM_RESTS_AT * fastest;
    for (i = 0; i < p->n && status == 0; ++i) {
        const double since = r->t - sym_ball_memory(s, at->of[i])[3];
        const int32_t opened = was[s->contacts[at->of[i]].mode] == SYM_OPEN, approaches = at->u[3 * i + 2] < -still;
        e[i] = s->contact_state.out[0][SYM_CONTACT_ENTRIES * at->of[i] + 5];
        if (!opened || since <= sym_run_accumulation(r, r->t, e[i])) e[i] = 0.0;
        p->last[i] = was[s->contacts[at->of[i]].mode];
        if (!opened || approaches) at->apart[i] = 0.0;
        at->struck[i] = opened && approaches;
        if (at->struck[i]) sym_ball_memory(s, at->of[i])[3] = r->t;
        strikes |= approaches;
    }
    if (status == 0 && strikes) {
        status = sym_strike(r, at, still, e);
        sym_load_state(r);
        sym_velocities_of_balls(r, at, r->v, at->u);
    }
    if (status != 0) return status;
    sym_sort_touching(r, at, still, met, was);
    return sym_solve_returning(r, at, par);
}

/* The largest multiplier of constraints that are no contacts. */
static double sym_load_of_others(const sym_system *s) {
    double load = 0.0;
    int32_t i, j, k, is_contact;
    for (i = 0; i < s->nc; ++i) {
        for (j = 0, is_contact = 0; j < s->n_contacts; ++j)
            for (k = 0; k < 3; ++k) is_contact |= s->contacts[j].row[k] == i;
        if (!is_contact) load = fmax(load, fabs(s->lam[i]));
    }
    return load;
}

/* Whether an open ball stays on its surface without a force, (46b): neither its speed nor its acceleration takes it away or presses
 * it, or other constraints, by forces of up to `load`, hold it. */
static int32_t sym_is_idle(const sym_contact_problem *p, int32_t ball, double load) {
    const int32_t n = 3 * p->n, row = 3 * ball + 2;
    double c = p->b[row], size = fmax(fabs(c), p->size);
    int32_t j;
    if (p->mode[ball] != SYM_OPEN || p->parts[ball]) return 0;
    for (j = 0; j < n; ++j) c += p->W[n * row + j] * p->f[j], size += fabs(p->W[n * row + j] * p->f[j]);
    if (load > 0.0 && fmax(fabs(c), load * fabs(p->W[n * row + row])) <= SYM_HELD_POINTS) return 1;
    return fabs(c) <= SYM_FORCE_ROUNDING * size;
}

/* Impacts and modes of rigid contacts at the present state, as of sym_settle_contacts. *again: whether speeds of balls have been
 * taken, after which slips are others. */
static int32_t sym_settle_once(sym_run *r, const double *met, int32_t begins, int32_t *again) {
    sym_system *s = r->system;
    double *par = r->actions->modes, gap, load;
    sym_touching at;
    int32_t i, k, status;
    *again = 0;
    memcpy(par, r->par, (size_t)s->npar * sizeof *par);
    status = sym_find_touching(r, par, met, begins, &at);
    if (status == 0) *sym_modes_chosen(s) = 1.0;
    if (status != 0 || at.problem.n == 0) {
        sym_prepare_call(&s->contact_state, r->par); /* poles are as they were */
        return status;
    }
    for (i = 0; i < at.problem.n; ++i) {
        const sym_rigid_contact *of = s->contacts + at.of[i];
        par[of->mode] = SYM_OPEN;
        for (k = 0; k < 3; ++k) par[of->push[k]] = 0.0;
    }
    status = sym_decide_contacts(r, &at, r->par, met, par);
    if (status != 0) {
        sym_prepare_call(&s->forward_dynamics, r->par), sym_prepare_call(&s->contact_state, r->par);
        return status;
    }
    load = sym_load_of_others(s);
    for (i = 0; i < at.problem.n; ++i) {
        const sym_rigid_contact *of = s->contacts + at.of[i];
        const double *W = at.problem.W + 9 * i * at.problem.n + 3 * i;
        double *known = sym_ball_memory(s, at.of[i]);
        sym_ball_settled(r, at.of[i]);
        known[0] = at.problem.d[2 * i], known[1] = at.problem.d[2 * i + 1], known[2] = SYM_SLOW;
        if (!r->adaptive) known[2] = s->longest_step * at.problem.mu[i] * fmax(W[0], W[3 * at.problem.n + 1]) * fabs(at.problem.f[3 * i + 2]);
        if (sym_is_idle(&at.problem, i, load)) at.apart[i] = fmax(SYM_IDLES, at.apart[i]);
        par[of->mode] = at.problem.mode[i], par[of->apart] = at.apart[i];
        if (at.u[3 * i + 2] * at.u[3 * i + 2] < -SYM_STEEP * at.gap[i]) par[of->apart] = fmax(at.struck[i] ? 0.0 : SYM_GRAZES, at.apart[i]) - at.gap[i];
        for (k = 0; k < 2; ++k) par[of->way[k]] = at.problem.mu[i] > 0.0 ? at.problem.d[2 * i + k] : 0.0; /* (40) */
        par[of->way[2]] = at.problem.slides[i] ? hypot(at.u[3 * i], at.u[3 * i + 1]) : 0.0;
    }
    *sym_load_shared(s) = at.problem.shared, *again = at.returns;
    sym_run_set_parameters(r, par);
    return sym_run_engage(r, &gap);
}

/* Impacts and modes of rigid contacts at the present state. met (n_contacts): 1 where a ball has reached its plane or its force
 * has fallen to zero, -1 where another mode has ended, else 0; NULL: the motion begins. Returns 0 or a status, with the modes
 * as they were. */
static int32_t sym_settle_contacts(sym_run *r, const double *met) {
    int32_t again, status = sym_settle_once(r, met, met == NULL, &again);
    return status == 0 && again ? sym_settle_once(r, NULL, 0, &again) : status;
}

/* Where balls that stick share their load in more than one way, what all of them together have left takes the place of what
 * each has, in the values of events at the evaluation point. Returns 0 or a status. */
static int32_t sym_watch_shared_load(sym_run *r, double *values) {
    const sym_system *s = r->system;
    const sym_contact_scratch scratch = sym_scratch_of_contacts(r);
    double *par = r->actions->modes, f[SYM_MOST_FORCES], rank;
    sym_touching at;
    sym_contact_problem *p = &at.problem;
    int32_t i, k, shared, status;
    memcpy(par, r->par, (size_t)s->npar * sizeof *par);
    memcpy(scratch.kept_a, s->a, (size_t)s->nv * sizeof *s->a), memcpy(scratch.kept_lam, s->lam, (size_t)s->nc * sizeof *s->lam);
    rank = *s->rank;
    for (i = 0, p->n = 0; i < s->n_contacts; ++i) {
        const sym_rigid_contact *of = s->contacts + i;
        if (par[of->mode] != SYM_STICKS) continue;
        for (k = 0; k < 3; ++k) f[3 * p->n + k] = s->lam[of->row[k]];
        par[of->mode] = SYM_OPEN;
        p->mode[p->n] = SYM_STICKS, p->mu[p->n] = sym_friction_of(s, i), at.of[p->n++] = i;
    }
    if (p->n == 0) return 0;
    status = sym_inertia_of_balls(r, &at, par);
    memcpy(s->a, scratch.kept_a, (size_t)s->nv * sizeof *s->a), memcpy(s->lam, scratch.kept_lam, (size_t)s->nc * sizeof *s->lam);
    *s->rank = rank;
    sym_prepare_call(&s->forward_dynamics, r->par);
    if (status != 0) return status;
    for (i = 0; i < p->n; ++i) {
        double *value = values + sym_first_contact_event(r) + 2 * at.of[i];
        value[0] = value[1] = 1.0;
        if (i == 0) value[1] = sym_sticking_margin(p, p->mode, f, &shared) + 2.0 * SYM_MARGIN_ROUNDING; /* beyond doubt */
    }
    return 0;
}
