/* Binding and evaluating a model's functions; the inputs; the right-hand side y' = f(t, y). */

typedef struct sym_point { /* the arrays at which functions are evaluated, by the names of functions' inputs */
    int32_t n;
    const char *const *names;
    const double *arrays[SYM_MAX_INPUTS];
} sym_point;

static sym_point sym_system_point(const sym_system *s) {
    static const char *const names[] = {"q", "v", "u", "t", "gains", "a", "lam"};
    sym_point point = {7, NULL, {NULL}};
    point.names = names;
    point.arrays[0] = s->q, point.arrays[1] = s->v, point.arrays[2] = s->u, point.arrays[3] = s->t;
    point.arrays[4] = s->gains, point.arrays[5] = s->a, point.arrays[6] = s->lam;
    return point;
}

/* Index of an input of that name; -1 where the point has none. */
static int32_t sym_point_index(const sym_point *point, const char *name) {
    int32_t i;
    for (i = 0; i < point->n; ++i)
        if (strcmp(name, point->names[i]) == 0) return i;
    return -1;
}

/* Point a call's inputs at arrays. Returns 0 where one is unknown or there are too many inputs or outputs. */
static int32_t sym_bind_inputs(sym_call *call, const sym_point *point) {
    int32_t k;
    if (call->function->n_in > SYM_MAX_INPUTS || call->function->n_out > SYM_MAX_OUTPUTS) return 0;
    call->in[0] = call->pre;
    for (k = 1; k < call->function->n_in; ++k) {
        const int32_t i = sym_point_index(point, call->function->in[k].name);
        if (i < 0) return 0;
        call->in[k] = point->arrays[i];
    }
    return 1;
}

SYM_EXPORT int32_t sym_system_bind(sym_system *s, sym_call *call) {
    const sym_point point = sym_system_point(s);
    return sym_bind_inputs(call, &point);
}

/* Make a call of a model function: inputs at the point, outputs in memory of the arena. Returns 0 where the function is
 * absent (NULL) or asks for what the point does not hold. */
static int32_t sym_bind_function(sym_arena *arena, sym_call *call, const sym_function *function, const double *pre,
                                 double *work, const sym_point *point) {
    int32_t i;
    call->function = function, call->pre = pre, call->work = work;
    if (function == NULL || function->n_out > SYM_MAX_OUTPUTS) return 0;
    for (i = 0; i < function->n_out; ++i) call->out[i] = sym_allocate(arena, sym_array_size(&function->out[i]));
    return arena->base == NULL || sym_bind_inputs(call, point);
}

static void sym_evaluate(const sym_call *call) {
    call->function->eval((const double *const *)call->in, (double *const *)call->out, call->work);
}

/* The part of a function's work that depends on parameters alone, at other parameters. */
static void sym_prepare_call(const sym_call *call, const double *par) {
    if (call->function != NULL && call->init != NULL) call->init(par, (double *)call->pre);
}

/* Instants that differ by less, relative to themselves, are one: multiples of a step and of a period of samples. */
#define SYM_SAME_INSTANT 2e-15
/* The same for zero, no share of which is above it [s]. */
#define SYM_SAME_AS_ZERO 1e-300

/* The last instant that is the same as t, the last one before it: bounds of samples that begin at t, or before it. */
static double sym_instant(double t) { return t + (SYM_SAME_INSTANT * fabs(t) + SYM_SAME_AS_ZERO); }
static double sym_before(double t) { return t - (SYM_SAME_INSTANT * fabs(t) + SYM_SAME_AS_ZERO); }

/* A multiple of a period that is zero but for rounding: that of the start time, which is no share of zero, is left out. */
#define SYM_ROUNDED_ZERO 1e-12
static double sym_multiple(double t, double period) { return fabs(t) < SYM_ROUNDED_ZERO * period ? 0.0 : t; }

/* How many of n instants, in order, begin up to time t. */
static int32_t sym_instants_begun(const double *instants, int32_t n, double t) {
    int32_t begun = 0, end = n;
    while (begun < end) {
        const int32_t middle = begun + (end - begun) / 2;
        if (instants[middle] <= t) begun = middle + 1;
        else end = middle;
    }
    return begun;
}

/* How many of a signal's samples begin up to time t. */
static int32_t sym_samples_begun(const sym_signal *signal, double t) {
    return sym_instants_begun(signal->t, signal->n, t);
}

/* The value of a signal at time t: the first one before its samples, the last one after them. Held samples that begin at
 * `end`, where the step under way ends, or later do not count yet; HUGE_VAL between steps. */
static double sym_signal_at(const sym_signal *signal, double t, double end) {
    const int32_t last = signal->n - 1;
    int32_t low;
    double x;
    if (!signal->linear) {
        const double bound = end < HUGE_VAL && sym_before(end) < sym_instant(t) ? sym_before(end) : sym_instant(t);
        low = sym_samples_begun(signal, bound);
        return signal->value[low > 0 ? low - 1 : 0];
    }
    if (t <= signal->t[0]) return signal->value[0];
    if (t >= signal->t[last]) return signal->value[last];
    low = sym_samples_begun(signal, t) - 1;
    x = (t - signal->t[low]) / (signal->t[low + 1] - signal->t[low]);
    return signal->value[low] + x * (signal->value[low + 1] - signal->value[low]);
}

/* The first instant after t, up to t1, at which a held signal changes or formulas ask for a stop; t1 where there is none. */
static double sym_next_stop(const sym_system *s, double t, double t1) {
    int32_t i, k = sym_instants_begun(s->stops, s->n_stops, sym_instant(t));
    if (k < s->n_stops && s->stops[k] < t1) t1 = s->stops[k];
    for (i = 0; i < s->n_signals; ++i) {
        const sym_signal *signal = &s->signals[i];
        if (signal->linear) continue;
        for (k = sym_samples_begun(signal, sym_instant(t)); k < signal->n && signal->t[k] < t1; ++k) {
            if (k == 0 || signal->value[k] == signal->value[k - 1]) continue;
            t1 = signal->t[k];
            break;
        }
    }
    return t1;
}

/* Whether a formula asks for a stop at time t. */
static int32_t sym_stops_at(const sym_system *s, double t) {
    const int32_t k = sym_instants_begun(s->stops, s->n_stops, sym_instant(t)) - 1;
    return k >= 0 && s->stops[k] > sym_before(t);
}

/* Whether an input that is held changes at time t, or a formula may. */
static int32_t sym_changes_at(const sym_system *s, double t) {
    int32_t i;
    if (s->held_anew || sym_stops_at(s, t)) return 1;
    for (i = 0; i < s->n_signals; ++i) {
        const sym_signal *signal = &s->signals[i];
        const int32_t k = signal->linear ? 0 : sym_samples_begun(signal, sym_instant(t)) - 1;
        if (k > 0 && signal->t[k] > sym_before(t) && signal->value[k] != signal->value[k - 1]) return 1;
    }
    return 0;
}

/* The time at which functions are evaluated for the slope that a step from t begins with: after a jump of a formula. */
static double sym_first_time(const sym_system *s, double t) { return sym_stops_at(s, t) ? sym_instant(t) : t; }

/* The time at which they are evaluated for the last stages of a step to t1: before a jump. */
static double sym_last_time(const sym_system *s, double t1) { return sym_stops_at(s, t1) ? sym_before(t1) : t1; }

/* A step from t to t1 begins: what begins at t1 counts from the next step on. */
static void sym_begin_step(sym_system *s, double t, double t1) {
    s->in_step = 1, s->step_end = t1;
    s->first_stage = sym_first_time(s, t);
    s->last_stage = sym_last_time(s, t1);
}

/* The time at which functions are evaluated for a stage at time t. */
static double sym_stage_time(const sym_system *s, double t) {
    if (!s->in_step) return t;
    return t > s->last_stage ? s->last_stage : t < s->first_stage ? s->first_stage : t;
}

/* The inputs that depend on time alone, at the evaluation point. */
static void sym_evaluate_signals(sym_system *s) {
    int32_t i;
    memcpy(s->u, s->u_constant, (size_t)s->nu * sizeof *s->u);
    for (i = 0; i < s->n_signals; ++i)
        s->u[s->signals[i].input] = sym_signal_at(&s->signals[i], *s->t, s->in_step ? s->step_end : HUGE_VAL);
}

/* The difference of time by which rates are taken. */
static double sym_time_difference(double t) { return sqrt(2.2e-16 * (fabs(t) > 1e-5 ? fabs(t) : 1e-5)); }

/* Deviation from unit length up to which a quaternion counts as a rotation written in few digits. */
#define SYM_QUATERNION_TOLERANCE 1e-3

/* Deviation of a squared length from one that is rounding: 16 units of it. Division by the length leaves 4 at most. */
#define SYM_QUATERNION_ROUNDING 3.6e-15

/* Whether four numbers are a rotation, up to a length that they are divided by. */
static int32_t sym_is_rotation(const double *p, double *length) {
    *length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    return fabs(*length - 1.0) <= SYM_QUATERNION_TOLERANCE;
}

/* Bring four numbers near a rotation to it: those off by more than rounding. Returns whether they are near one. */
static int32_t sym_make_rotation(double *p) {
    double length;
    int32_t i;
    if (!sym_is_rotation(p, &length)) return 0;
    if (!(fabs(length * length - 1.0) <= SYM_QUATERNION_ROUNDING))
        for (i = 0; i < 4; ++i) p[i] /= length;
    return 1;
}

/* Bring the quaternions among the inputs at the evaluation point to unit length, which chords between samples and numbers
 * of few digits miss; sym_check_inputs refuses others. */
static void sym_normalize_inputs(sym_system *s) {
    int32_t k;
    for (k = 0; k < s->n_quaternion_inputs; ++k) (void)sym_make_rotation(s->u + s->quaternion_inputs[k]);
}

/* All inputs at the evaluation point. Not 0: the caller's function failed. */
static int32_t sym_evaluate_inputs(sym_system *s) {
    int32_t i, failed = 0;
    if (s->callback != NULL) {
        failed = s->callback(s->data, *s->t, s->q, s->v, s->u);
    } else {
        sym_evaluate_signals(s);
        if (s->law.function != NULL) {
            sym_evaluate(&s->law);
            for (i = 0; i < s->n_law; ++i) s->u[s->law_inputs[i]] = s->law.out[0][i];
        }
    }
    sym_normalize_inputs(s);
    return failed;
}

/* Times a number beyond some 1e100 it overflows. Such a state is no motion any more in any unit, and the squares in its
 * energies overflow soon, though it is itself a number. */
#define SYM_BEYOND_MOTION 1e208
/* The same as a bound. */
#define SYM_LARGEST_OF_MOTION 1e100

/* Whether all are numbers of a size that a motion may have. */
static int32_t sym_all_finite(int32_t n, const double *x) {
    double s = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) s += x[i] * SYM_BEYOND_MOTION * 0.0;
    return s == 0.0;
}

/* Check the quaternions among the inputs at the evaluation point. Returns 0 or SYM_NO_ROTATION. */
static int32_t sym_check_inputs(const sym_system *s) {
    double length;
    int32_t k;
    for (k = 0; k < s->n_quaternion_inputs; ++k)
        if (!sym_is_rotation(s->u + s->quaternion_inputs[k], &length)) return SYM_NO_ROTATION;
    return 0;
}

/* Count and check the accelerations just evaluated. Returns 0 or a status. */
static int32_t sym_check_acceleration(sym_run *r) {
    const sym_system *s = r->system;
    ++r->evaluations;
    if (sym_check_inputs(s) != 0) return SYM_NO_ROTATION;
    if (s->nc > 0 && *s->rank < 0.0) return SYM_SINGULAR;
    return sym_all_finite(s->nv, s->a) ? 0 : SYM_DIVERGED;
}

static int32_t sym_add_sliding(sym_run *r, const double *par);

/* What is to be done once accelerations are evaluated by parameters: check them, and add friction of balls that slide. Returns
 * 0 or a status. */
static int32_t sym_complete_acceleration(sym_run *r, const double *par) {
    const int32_t status = sym_check_acceleration(r);
    return status != 0 || r->system->n_contacts == 0 ? status : sym_add_sliding(r, par);
}

/* Accelerations and multipliers at the evaluation point, inputs included. Returns 0 or a status. */
static int32_t sym_evaluate_acceleration(sym_run *r) {
    sym_system *s = r->system;
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(&s->forward_dynamics);
    return sym_complete_acceleration(r, r->par);
}

/* Evaluation point <- the present state. */
static void sym_load_state(sym_run *r) {
    sym_system *s = r->system;
    memcpy(s->q, r->q, (size_t)s->nq * sizeof *s->q);
    memcpy(s->v, r->v, (size_t)s->nv * sizeof *s->v);
    *s->t = r->t;
}

/* Evaluation point <- the present state, as the start of a step. */
static void sym_load_start(sym_run *r) {
    sym_load_state(r);
    *r->system->t = sym_first_time(r->system, r->t);
}

/* Evaluation point <- y = (theta, v) in the chart about r->q, at time t. */
static void sym_load_chart_state(sym_run *r, double t, const double *y) {
    sym_system *s = r->system;
    int32_t i;
    sym_retract(s, r->q, y, s->q);
    memcpy(s->v, y + s->nv, (size_t)s->nv * sizeof *y);
    for (i = 0; i < s->n_sticking; ++i)
        if (s->held[i]) s->v[s->sticking[i].v] = 0.0;
    *s->t = t;
}

/* dy = f(t, y), the accelerations at the evaluation point being those of y. */
static void sym_slope_of_acceleration(const sym_system *s, const double *y, double *dy) {
    sym_chart_rate(s, y, y + s->nv, dy);
    memcpy(dy + s->nv, s->a, (size_t)s->nv * sizeof *dy);
}

/* dy = f(t, y), in the chart about r->q. Returns 0 or a status. */
static int32_t sym_evaluate_slope(sym_run *r, double t, const double *y, double *dy) {
    int32_t status;
    sym_load_chart_state(r, sym_stage_time(r->system, t), y);
    status = sym_evaluate_acceleration(r);
    sym_slope_of_acceleration(r->system, y, dy);
    return status;
}

/* Largest |phi| after a projection that counts as closed. */
#define SYM_CLOSURE_TOLERANCE 1e-6

/* Project the evaluation point onto the constraints. Returns 0 or a status. */
static int32_t sym_project_point(sym_system *s) {
    const sym_call *project = &s->project; /* q, v, |phi|, rank */
    int32_t i;
    if (sym_evaluate_inputs(s) != 0) return SYM_CALLBACK_FAILED;
    sym_evaluate(project);
    if (!(project->out[3][0] >= 0.0)) return SYM_SINGULAR;
    if (!(project->out[2][0] < SYM_CLOSURE_TOLERANCE)) return SYM_PROJECTION_FAILED;
    for (i = 0; i < s->n_sticking; ++i)
        if (s->held[i]) project->out[0][s->sticking[i].q] = s->q[s->sticking[i].q], project->out[1][s->sticking[i].v] = 0.0;
    memcpy(s->q, project->out[0], (size_t)s->nq * sizeof *s->q);
    memcpy(s->v, project->out[1], (size_t)s->nv * sizeof *s->v);
    return 0;
}

/* Count the energy that a projection took, and that of the motion. Returns 0 or SYM_ENERGY_LOST (docs/theory/simulation.md,
 * section 6). */
static int32_t sym_judge_projection(sym_run *r, const double *energies) {
    r->lost_energy += energies[0];
    if (energies[1] > r->kinetic_energy) r->kinetic_energy = energies[1];
    return r->lost_energy > r->loss_limit * r->kinetic_energy ? SYM_ENERGY_LOST : 0;
}

/* The present state <- the evaluation point. */
static void sym_store_state(sym_run *r) {
    const sym_system *s = r->system;
    memcpy(r->q, s->q, (size_t)s->nq * sizeof *r->q);
    memcpy(r->v, s->v, (size_t)s->nv * sizeof *r->v);
}

/* Project the present state onto the constraints. Returns 0 or a status. */
static int32_t sym_project_state(sym_run *r) {
    int32_t status;
    sym_load_state(r);
    status = sym_project_point(r->system);
    if (status == 0) sym_store_state(r);
    return status;
}

/* Largest |phi| by weight that engaging closes by moving bodies, which no force does (docs/theory/diagrams.md). */
#define SYM_ENGAGE_TOLERANCE 1e-3

SYM_EXPORT int32_t sym_run_engage(sym_run *r, double *gap) {
    int32_t status;
    sym_load_state(r); /* the inputs are those of the instant */
    status = sym_project_point(r->system);
    *gap = r->system->project.out[5][0];
    if (*gap > SYM_ENGAGE_TOLERANCE) return SYM_ENGAGED_APART;
    if (status == 0) sym_store_state(r);
    return status;
}

/* Evaluation point <- y = (theta, v) in the chart about r->q at time t, projected where the run projects. Returns 0 or a
 * status. */
static int32_t sym_load_projected_state(sym_run *r, double t, const double *y) {
    sym_load_chart_state(r, t, y);
    return r->project ? sym_project_point(r->system) : 0;
}
