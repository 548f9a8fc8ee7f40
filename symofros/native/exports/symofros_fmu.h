/* symofros_fmu.h - a model as a functional mock-up unit, apart from the version of the interface. Written by hand.
 *
 * Value references run through, in this order: time, q, v, rates of q, rates of v, u, par, lam, kinetic and potential
 * energy, then x, y, z of each output frame. Included by the file that names the model: it defines SYM_FMU_PLANT,
 * SYM_FMU_TOKEN, SYM_FMU_FRAMES, sym_fmu_frames[], sym_fmu_reach[]. What symofros_fmi.h calls is also in symofros_fmu_program.h.
 */
#include "symofros_fmu_codes.h"

typedef struct fmu_snapshot { /* followed by the numbers of fmu_parts */
    char hash[24];
    double t, h, stop, error, fastest;
    int32_t phase, has_stop, cosim, reserved;
} fmu_snapshot;

typedef struct fmu {
    sym_instance *instance;
    fmu_phase phase;
    int cosim, has_stop;
    int discarded; /* whether the last step was, as the motion ends within it */
    int rates_valid, parameters_valid; /* whether `rates` are of the present state, and `pre` of the present parameters */
    double stop;
    double *rates, *rate_derivatives; /* (nq + nv) */
    double *first; /* coordinates of the start before constraints move them (nq) */
    double *dq, *dv, *du, *dlam, *tangent;
    double *dpar, *par; /* direction, and parameters that are set aside (npar) */
    double *work, *frame_outputs;
    sym_instance *twin; /* makes fixed steps of Co-Simulation once more, of another length; NULL: steps bound their errors */
    double error, fastest; /* of speeds so far, at most, by that; largest speed: in the norm of the kinetic energy */
    const sym_function *pose[SYM_FMU_FRAMES + 1], *jacobian[SYM_FMU_FRAMES + 1];
    const sym_function *driven[SYM_FMU_FRAMES + 1]; /* by prescribed motions; NULL where there are none */
    const sym_function *kinetic, *potential;
    /* What the environment gave. */
    void *environment, *logger;
    char *name;
    int bending_noted, sequence_noted, steps_noted; /* whether the log already says that a beam bends much, that balls struck in
                                                     * sequence, that steps are too long */
    char message[256]; /* a remark for the log, on a derivative that there is none of, or on a step that is refused */
    void (*release)(void *);
} fmu;

/* Baumgarte's gains under an importer's integrator, which does not project onto constraints [1/s]. */
#define FMU_GAIN 20.0

static size_t fmu_group_start(const fmu *f, int what) {
    const sym_model *m = f->instance->model;
    const int32_t sizes[10] = {1, m->nq, m->nv, m->nq, m->nv, m->nu, m->npar, m->nc, 2, 3 * SYM_FMU_FRAMES};
    size_t first = 0;
    int i;
    for (i = 0; i < what; ++i) first += (size_t)sizes[i];
    return first;
}

enum { FMU_TIME, FMU_Q, FMU_V, FMU_DQ, FMU_DV, FMU_U, FMU_PAR, FMU_LAM, FMU_ENERGY, FMU_FRAME, FMU_END };

/* The group of a value reference, and its index there. */
static int fmu_find_variable(const fmu *f, size_t reference, size_t *index) {
    int what;
    for (what = FMU_END; what > 0; --what)
        if (reference >= fmu_group_start(f, what)) break;
    *index = reference - fmu_group_start(f, what);
    return what;
}

/* Doubles of the outputs of a frame's functions, for sym_instance_call: "frame_derivatives" has most, five matrices by q or
 * v (6, nv) and three by u (6, nu). */
static size_t fmu_frame_outputs(const sym_model *m) { return 30 * (size_t)m->nv + 18 * (size_t)m->nu; }

/* Lay out every array behind the struct: of the instance, of rates and of derivatives; and the name. */
static void fmu_layout(fmu *f, sym_arena *arena, const sym_plant *plant, int cosim, size_t name_length) {
    const sym_model *m = plant->model();
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv, size = sym_instance_size(plant);
    void *memory = sym_allocate_bytes(arena, size);
    void *more = cosim && !plant->adaptive ? sym_allocate_bytes(arena, size) : NULL;
    sym_instance draft; /* while the arena only counts */
    if (arena->base == NULL) {
        draft.model = m;
        f->work = sym_allocate(arena, sym_instance_differentiate_size(&draft));
    } else {
        f->instance = sym_instance_init(memory, size, plant);
        if (f->instance == NULL) return;
        f->twin = more == NULL ? NULL : sym_instance_init(more, size, plant);
        f->work = sym_allocate(arena, sym_instance_differentiate_size(f->instance));
    }
    f->rates = sym_allocate(arena, nq + nv), f->rate_derivatives = sym_allocate(arena, nq + nv);
    f->first = sym_allocate(arena, nq);
    f->dq = sym_allocate(arena, nq), f->dv = sym_allocate(arena, nv), f->du = sym_allocate(arena, (size_t)m->nu);
    f->dlam = sym_allocate(arena, (size_t)m->nc), f->tangent = sym_allocate(arena, nv);
    f->dpar = sym_allocate(arena, (size_t)m->npar), f->par = sym_allocate(arena, (size_t)m->npar);
    f->frame_outputs = sym_allocate(arena, fmu_frame_outputs(m));
    f->name = sym_allocate_bytes(arena, name_length + 1);
}

/* Why there is no unit: steps of an importer's look for no events. */
static int fmu_absent(int cosim) { return !cosim && SYM_FMU_PLANT()->events != NULL ? FMU_NOT_ALLOWED : FMU_NO_MEMORY; }

static fmu *fmu_new(int cosim, const char *name, void *(*allocate)(size_t, size_t), void (*release)(void *)) {
    const sym_plant *plant = SYM_FMU_PLANT();
    const sym_model *m = plant->model();
    const size_t length = name == NULL ? 0 : strlen(name);
    sym_arena arena = {NULL, 0};
    double *memory;
    fmu draft, *f;
    int i;
    if (fmu_absent(cosim) == FMU_NOT_ALLOWED) return NULL;
    fmu_layout(&draft, &arena, plant, cosim, length);
    memory = allocate(sym_doubles(sizeof *f) + arena.used, sizeof *memory);
    if (memory == NULL) return NULL;
    f = (fmu *)(void *)memory;
    memset(f, 0, sizeof *f);
    arena.base = memory + sym_doubles(sizeof *f), arena.used = 0;
    fmu_layout(f, &arena, plant, cosim, length);
    if (f->instance == NULL) {
        release(memory);
        return NULL;
    }
    if (length > 0) memcpy(f->name, name, length);
    f->name[length] = '\0';
    f->cosim = cosim, f->release = release, f->phase = FMU_INSTANTIATED;
    f->kinetic = sym_find(m, "kinetic_energy", NULL), f->potential = sym_find(m, "potential_energy", NULL);
    for (i = 0; i < SYM_FMU_FRAMES; ++i) {
        f->pose[i] = sym_find(m, "frame_pose", sym_fmu_frames[i]);
        f->jacobian[i] = sym_find(m, "frame_jacobian", sym_fmu_frames[i]);
        f->driven[i] = sym_find(m, "frame_derivatives", sym_fmu_frames[i]);
    }
    return f;
}

static double *fmu_time(const fmu *f) { return &f->instance->t; }

static void fmu_set_tolerance(fmu *f, double tolerance) {
    if (f->instance->run.adaptive) f->instance->run.rtol = tolerance;
}

/* The condition that parameters do not meet. */
static const char *fmu_condition(int which) { return SYM_FMU_PLANT()->conditions[which]; }

static size_t fmu_states(const fmu *f) { return (size_t)f->instance->model->nq + (size_t)f->instance->model->nv; }

static void fmu_put_states(fmu *f, const double *x) {
    const size_t nq = (size_t)f->instance->model->nq;
    memcpy(f->instance->q, x, nq * sizeof *x), memcpy(f->instance->v, x + nq, (fmu_states(f) - nq) * sizeof *x);
}

static void fmu_take_states(const fmu *f, double *x) {
    const size_t nq = (size_t)f->instance->model->nq;
    memcpy(x, f->instance->q, nq * sizeof *x), memcpy(x + nq, f->instance->v, (fmu_states(f) - nq) * sizeof *x);
}

/* Judge the bending of beams at the end of an importer's step. Returns 0, or a status beyond their theory. */
static int fmu_judge(fmu *f) { return sym_instance_judge_beams(f->instance); }

static void fmu_reset(fmu *f) {
    const int32_t nc = f->instance->model->nc;
    int32_t i;
    sym_instance_reset(f->instance);
    if (!f->cosim)
        for (i = 0; i < 2 * nc; ++i) f->instance->gains[i] = FMU_GAIN;
    f->phase = FMU_INSTANTIATED, f->rates_valid = 0, f->has_stop = 0, f->parameters_valid = 1;
    f->instance->run.rtol = f->instance->plant->rtol;
    f->bending_noted = f->sequence_noted = f->steps_noted = 0;
    f->error = f->fastest = 0.0;
}

/* What depends on parameters alone, for the present ones, if the description allows them. */
static int fmu_prepare(fmu *f) {
    if (f->parameters_valid) return FMU_OK;
    if (sym_instance_prepare(f->instance) != 0) return FMU_PARAMETERS + f->instance->refused;
    f->parameters_valid = 1;
    return FMU_OK;
}

/* Rates at the present state, evaluated when they are first asked for. */
static int fmu_refresh(fmu *f) {
    const int status = fmu_prepare(f);
    if (status != FMU_OK) return status;
    if (f->rates_valid) return FMU_OK;
    switch (sym_instance_rates(f->instance, f->rates)) {
    case 0: return f->rates_valid = 1, FMU_OK;
    case SYM_NO_ROTATION: return FMU_INPUT_NO_ROTATION;
    default: return FMU_SINGULAR;
    }
}

static int fmu_get(fmu *f, size_t reference, double *value) {
    sym_instance *instance = f->instance;
    size_t i;
    const int what = fmu_find_variable(f, reference, &i);
    double p[3], R[9], *out[2];
    if (what == FMU_END) return FMU_UNKNOWN;
    if (what == FMU_DQ || what == FMU_DV || what == FMU_LAM) {
        const int status = fmu_refresh(f);
        if (status != FMU_OK) return status;
    } else if (what != FMU_PAR) {
        const int status = fmu_prepare(f);
        if (status != FMU_OK) return status;
    }
    out[0] = p, out[1] = R;
    switch (what) {
    case FMU_TIME: *value = instance->t; break;
    case FMU_Q: *value = instance->q[i]; break;
    case FMU_V: *value = instance->v[i]; break;
    case FMU_DQ: *value = f->rates[i]; break;
    case FMU_DV: *value = f->rates[(size_t)instance->model->nq + i]; break;
    case FMU_U: *value = instance->u[i]; break;
    case FMU_PAR: *value = instance->par[i]; break;
    case FMU_LAM: *value = instance->lam[i]; break;
    case FMU_ENERGY:
        if (!sym_instance_call(instance, i == 0 ? f->kinetic : f->potential, out)) return FMU_UNKNOWN;
        *value = p[0];
        break;
    default:
        if (!sym_instance_call(instance, f->pose[i / 3], out)) return FMU_UNKNOWN;
        *value = p[i % 3];
    }
    return FMU_OK;
}

static int fmu_set(fmu *f, size_t reference, double value) {
    sym_instance *instance = f->instance;
    size_t i;
    const int what = fmu_find_variable(f, reference, &i), starting = f->phase <= FMU_INITIALISING;
    if (what == FMU_END) return FMU_UNKNOWN;
    if (!(value - value == 0.0) || f->phase == FMU_TERMINATED) return FMU_NOT_ALLOWED;
    if (what == FMU_Q && starting) instance->q[i] = value;
    else if (what == FMU_V && starting) instance->v[i] = value;
    else if (what == FMU_U) instance->u[i] = value;
    else if (what == FMU_PAR && f->phase != FMU_CONTINUOUS) instance->par[i] = value, f->parameters_valid = 0;
    else return FMU_NOT_ALLOWED;
    f->rates_valid = 0;
    return FMU_OK;
}

static int fmu_initialise(fmu *f) {
    int status = fmu_prepare(f);
    if (status != FMU_OK) return status;
    f->rates_valid = 0;
    memcpy(f->first, f->instance->q, (size_t)f->instance->model->nq * sizeof *f->first);
    status = sym_instance_project(f->instance);
    if (status != 0) return status == SYM_NO_ROTATION ? FMU_NO_ROTATION : FMU_SINGULAR;
    status = fmu_refresh(f);
    if (status != FMU_OK) return status;
    f->phase = f->cosim ? FMU_STEPPING : FMU_EVENT;
    return FMU_OK;
}

/* Change of a coordinate of the start, of one of order one, above which the log says that constraints moved it. Quaternions of
 * 1e-3 from unit length change by less. */
#define FMU_START_MOVED 2e-3

/* Write how far constraints moved the start. Returns whether that is worth telling. */
static int fmu_note_start(fmu *f) {
    const sym_instance *instance = f->instance;
    const int32_t nq = instance->model->nq;
    int32_t i, worst = 0;
    double most = 0.0;
    for (i = 0; i < nq; ++i) {
        const double moved = fabs(instance->q[i] - f->first[i]) / sym_fmu_reach[i];
        if (moved > most) most = moved, worst = i;
    }
    if (!(most > FMU_START_MOVED)) return 0;
    sprintf(f->message, "the start does not meet the constraints and was moved onto them: '%.60s' from %.9g to %.9g",
            instance->model->q_names[worst], f->first[worst], instance->q[worst]);
    return 1;
}

/* Begin to integrate from the present time, in Model Exchange: whether the importer has to stop somewhere since a formula of time
 * bends, jumps or changes fast there, or since instants are not known beyond -> *next. */
static int fmu_next_event(fmu *f, double *next) {
    sym_instance *instance = f->instance;
    const double t = instance->t, end = f->has_stop ? f->stop : t + 0.5 * sym_instance_span(instance, t, t);
    if (instance->operands.function == NULL || fmu_prepare(f) != FMU_OK || !(end > t)) return 0;
    *next = sym_instance_begin_step(instance, end);
    f->rates_valid = 0; /* those of a step that begins here */
    return *next < end || !f->has_stop;
}

/* Estimated error of the beams' theory from which the log says so. */
#define FMU_NOTED_ERROR 0.01

/* Write the message on the beam whose theory errs most. Returns whether that is new and worth telling. */
static int fmu_note_bending(fmu *f) {
    const sym_plant *plant = f->instance->plant;
    sym_run *r = &f->instance->run;
    int32_t b, worst = 0;
    double error;
    for (b = 1; b < plant->n_beams; ++b)
        if (sym_run_beam_error(r, b) > sym_run_beam_error(r, worst)) worst = b;
    error = plant->n_beams > 0 ? sym_run_beam_error(r, worst) : 0.0;
    if (!(error > FMU_NOTED_ERROR)) return 0;
    sprintf(f->message, "beam '%.60s' bends at t = %.6g s: second-order theory errs by about %.2g %% of the deflection",
            plant->beam_names[worst], r->beam_t[worst], 100.0 * error);
    return !f->bending_noted++;
}

/* Sum of errors of speeds, relative to the largest, from which the log says so: later motion has amplified the first of them
 * by as much as (18h) allows. */
#define FMU_STEP_ERROR 0.015

/* Write that steps are too long. Returns whether that is new and worth telling. */
static int fmu_note_steps(fmu *f) {
    if (!(f->error > FMU_STEP_ERROR * f->fastest) || f->steps_noted) return 0;
    sprintf(f->message, "steps of at most %.3g s do not determine the motion: beside others, twice or half as long, errors of its"
            " speeds add up to %.2g %% by t = %.6g s; export with a smaller dt, without dt, or with method='dopri5'",
            f->instance->plant->h, 100.0 * f->error / f->fastest, f->instance->t);
    return f->steps_noted = 1;
}

/* Write a remark on what has happened so far. Returns whether there is one that is new and worth telling. */
static int fmu_remark(fmu *f) {
    const double t = sym_instance_struck_in_sequence(f->instance);
    if (fmu_note_bending(f) || fmu_note_steps(f)) return 1;
    if (t == -HUGE_VAL || f->sequence_noted) return 0;
    sprintf(f->message, "balls of rigid contacts struck one after the other at t = %.6g s, as no motion was found in which they do at once", t);
    return f->sequence_noted = 1;
}

/* Number of events, where some act. */
static int32_t fmu_acting(const sym_instance *instance) { return instance->run.actions != NULL ? instance->system.n_events : 0; }

enum { FMU_PARTS = 6 };
typedef struct fmu_part { double *at; size_t size; } fmu_part;

/* Numbers that a motion goes on from: the state, inputs, parameters, when each event has acted last, rigid contacts. */
static void fmu_parts(const sym_instance *instance, fmu_part *parts) {
    const sym_model *m = instance->model;
    parts[0].at = instance->q, parts[0].size = (size_t)m->nq;
    parts[1].at = instance->v, parts[1].size = (size_t)m->nv;
    parts[2].at = instance->u, parts[2].size = (size_t)m->nu;
    parts[3].at = instance->par, parts[3].size = (size_t)m->npar;
    parts[4].at = instance->run.acted_at, parts[4].size = (size_t)fmu_acting(instance) + (instance->run.actions != NULL);
    parts[5].at = instance->system.contact_memory, parts[5].size = sym_instance_contact_size(instance);
}

/* Which events that act once have done so, by when each has acted last. */
static void fmu_recall_events(sym_instance *instance) {
    const sym_event_plan *plan = instance->plant->events;
    int32_t i;
    for (i = 0; i < fmu_acting(instance); ++i) {
        const int32_t spent = plan->once[i] && instance->run.acted_at[i] > -HUGE_VAL;
        instance->event_terminal[i] = spent ? -1 : plan->cut[i];
    }
}

/* The twin <- the motion at the begin of a step. Returns 0 without a twin, and once the log says that steps are too long. */
static int fmu_twin_begin(fmu *f) {
    fmu_part from[FMU_PARTS], to[FMU_PARTS];
    int i, prepared = 1;
    if (f->twin == NULL || f->kinetic == NULL || f->steps_noted) return 0;
    fmu_parts(f->instance, from), fmu_parts(f->twin, to);
    for (i = 0; i < FMU_PARTS; ++i) {
        if (from[i].size == 0) continue;
        if (i == 3) prepared = memcmp(to[i].at, from[i].at, from[i].size * sizeof(double)) == 0;
        memcpy(to[i].at, from[i].at, from[i].size * sizeof(double));
    }
    f->twin->t = f->instance->t;
    fmu_recall_events(f->twin);
    return prepared || sym_instance_prepare(f->twin) == 0;
}

/* Kinetic energy at the motion's configuration and so many times dv, by way of the twin. */
static double fmu_kinetic(fmu *f, double times, const double *dv) {
    sym_instance *twin = f->twin;
    double energy = 0.0, *out[1];
    int32_t i;
    out[0] = &energy;
    memcpy(twin->q, f->instance->q, (size_t)twin->model->nq * sizeof *twin->q);
    for (i = 0; i < twin->model->nv; ++i) twin->v[i] = times * dv[i];
    return sym_instance_call(twin, f->kinetic, out) ? energy : 0.0;
}

/* The root of dv^T M dv: what prescribed motions add to the kinetic energy is no part of it. */
static double fmu_norm(fmu *f, const double *dv) {
    const double square = fmu_kinetic(f, 1.0, dv) + fmu_kinetic(f, -1.0, dv) - 2.0 * fmu_kinetic(f, 0.0, dv);
    return sqrt(square > 0.0 ? square : 0.0);
}

/* Share of coordinates that rounding may change in a step: slower motion than that says nothing of steps. */
#define FMU_ROUNDING 1e-10

/* Make the communication step to t, which takes n steps, once more by the twin, in steps twice as long, or half as long where
 * n = 1. As forces that bend leave no method more than order one, the speeds at its end err by the difference, or by twice that.
 * What another number of events has made of them is no measure of it. */
static void fmu_twin_step(fmu *f, double t, double span, double n) {
    sym_instance *instance = f->instance, *twin = f->twin;
    const int32_t nq = instance->model->nq, nv = instance->model->nv;
    const double h = n > 1.0 ? 2.0 * span / n : 0.5 * span;
    double speed, largest = 0.0;
    int32_t i;
    if (sym_instance_advance(twin, t, h) != SYM_FINISHED) return;
    for (i = 0; i < nv; ++i) f->dv[i] = twin->v[i] - instance->v[i];
    for (i = 0; i < nq; ++i) largest = fabs(instance->q[i]) > largest ? fabs(instance->q[i]) : largest;
    if (twin->run.n_event_records == instance->run.n_event_records) f->error += (n > 1.0 ? 1.0 : 2.0) * fmu_norm(f, f->dv);
    speed = fmu_norm(f, instance->v);
    for (i = 0; i < nv; ++i) f->dv[i] = FMU_ROUNDING * largest / h;
    largest = fmu_norm(f, f->dv);
    speed = speed > largest ? speed : largest;
    f->fastest = speed > f->fastest ? speed : f->fastest;
}

/* One communication step, to time t. */
static int fmu_step(fmu *f, double t) {
    const double span = t - f->instance->t, n = ceil(span / f->instance->plant->h * (1.0 - 1e-9));
    const int again = fmu_twin_begin(f);
    int32_t status;
    const char *reason;
    f->rates_valid = 0;
    status = sym_instance_advance(f->instance, t, 0.0);
    if (status == SYM_FINISHED && again) fmu_twin_step(f, t, span, n);
    if (status == SYM_FINISHED) return FMU_OK;
    if (status == SYM_BEYOND_THEORY) return fmu_note_bending(f), FMU_BEYOND_THEORY;
    if (status == SYM_NO_ROTATION) return FMU_INPUT_NO_ROTATION;
    reason = fmu_reason(status);
    return reason == NULL ? FMU_SINGULAR : (strcpy(f->message, reason), FMU_BEYOND_THEORY);
}

/* The derivative of a frame's coordinate along f->dq and f->du. */
static int fmu_frame_derivative(fmu *f, size_t frame, size_t row, double *derivative) {
    sym_instance *instance = f->instance;
    const size_t nv = (size_t)instance->model->nv, nu = (size_t)instance->model->nu;
    double *out[8], *at = f->frame_outputs, sum = 0.0;
    size_t j;
    out[0] = f->frame_outputs;
    if (!sym_instance_call(instance, f->jacobian[frame], out)) return FMU_UNKNOWN;
    sym_instance_tangent(instance, f->dq, f->tangent);
    for (j = 0; j < nv; ++j) sum += f->frame_outputs[row * nv + j] * f->tangent[j];
    if (f->driven[frame] != NULL) { /* six rows each, by q or v or u: pose_by_u is the second */
        static const int of_inputs[8] = {0, 1, 0, 0, 1, 0, 0, 1};
        for (j = 0; j < 8; ++j) {
            out[j] = at;
            at += 6 * (of_inputs[j] ? nu : nv);
        }
        if (!sym_instance_call(instance, f->driven[frame], out)) return FMU_UNKNOWN;
        for (j = 0; j < nu; ++j) sum += out[1][row * nu + j] * f->du[j];
    }
    *derivative = sum;
    return FMU_OK;
}

/* Relative change of parameters, for differences of fourth order: their error and rounding are then below 1e-11. */
#define FMU_PARAMETER_STEP 1e-3

/* Add the derivatives of unknowns along f->dpar, states and inputs held: models have no functions for them. */
static int fmu_add_by_parameters(fmu *f, size_t n_unknown, const uint32_t *unknown, double *derivative) {
    static const double ways[4] = {1.0, -1.0, 2.0, -2.0}, weights[4] = {8.0, -8.0, -1.0, 1.0};
    const size_t npar = (size_t)f->instance->model->npar;
    double *const par = f->instance->par, change = 0.0, step, value;
    size_t i, j, k;
    int status = FMU_OK, restored;
    for (i = 0; i < npar; ++i) {
        const double relative = fabs(f->dpar[i]) / (par[i] == 0.0 ? 1.0 : fabs(par[i]));
        change = relative > change ? relative : change;
    }
    if (!(change > 0.0)) return FMU_OK;
    step = FMU_PARAMETER_STEP / change;
    memcpy(f->par, par, npar * sizeof *par);
    for (j = 0; j < 4 && status == FMU_OK; ++j) {
        for (i = 0; i < npar; ++i) par[i] = f->par[i] + ways[j] * step * f->dpar[i];
        f->parameters_valid = 0, f->rates_valid = 0;
        for (k = 0; k < n_unknown && status == FMU_OK; ++k) {
            status = fmu_get(f, unknown[k], &value);
            if (status == FMU_OK) derivative[k] += weights[j] / (12.0 * step) * value;
        }
    }
    memcpy(par, f->par, npar * sizeof *par);
    f->parameters_valid = 0, f->rates_valid = 0;
    restored = fmu_prepare(f);
    return status == FMU_OK ? restored : status;
}

static int fmu_not_differentiated(fmu *f, uint32_t reference, const char *rule) {
    sprintf(f->message, "no derivative with value reference %lu: %.160s", (unsigned long)reference, rule);
    return FMU_NOT_DIFFERENTIATED;
}

/* Directional derivatives of unknowns (rates, multipliers, outputs) along seeds of knowns: states and inputs, exact; while
 * the unit is initialised also parameters, by differences. */
static int fmu_differentiate(fmu *f, size_t n_unknown, const uint32_t *unknown, size_t n_known, const uint32_t *known,
                             const double *seed, double *derivative) {
    sym_instance *instance = f->instance;
    const sym_model *m = instance->model;
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv;
    size_t i, k;
    int status;
    memset(f->dq, 0, nq * sizeof(double)), memset(f->dv, 0, nv * sizeof(double));
    memset(f->du, 0, (size_t)m->nu * sizeof(double)), memset(f->dpar, 0, (size_t)m->npar * sizeof(double));
    for (k = 0; k < n_known; ++k) {
        const int what = fmu_find_variable(f, known[k], &i);
        if (!(seed[k] - seed[k] == 0.0)) return fmu_not_differentiated(f, known[k], "seeds are finite numbers");
        if (what == FMU_Q) f->dq[i] += seed[k];
        else if (what == FMU_V) f->dv[i] += seed[k];
        else if (what == FMU_U) f->du[i] += seed[k];
        else if (what == FMU_PAR && f->phase == FMU_INITIALISING) f->dpar[i] += seed[k];
        else
            return fmu_not_differentiated(f, known[k], what == FMU_PAR
                ? "parameters are knowns in initialisation mode alone"
                : "knowns are states and inputs, and in initialisation mode parameters");
    }
    status = fmu_refresh(f);
    if (status != FMU_OK) return status;
    if (sym_instance_differentiate(instance, f->dq, f->dv, f->du, f->rate_derivatives, f->dlam, f->work) != 0)
        return FMU_SINGULAR;
    for (k = 0; k < n_unknown; ++k) {
        switch (fmu_find_variable(f, unknown[k], &i)) {
        case FMU_Q: derivative[k] = f->dq[i]; break;
        case FMU_V: derivative[k] = f->dv[i]; break;
        case FMU_DQ: derivative[k] = f->rate_derivatives[i]; break;
        case FMU_DV: derivative[k] = f->rate_derivatives[nq + i]; break;
        case FMU_LAM: derivative[k] = f->dlam[i]; break;
        case FMU_FRAME:
            status = fmu_frame_derivative(f, i / 3, i % 3, &derivative[k]);
            if (status != FMU_OK) return status;
            break;
        default:
            return fmu_not_differentiated(f, unknown[k], "unknowns are states, their rates, multipliers and outputs");
        }
    }
    return fmu_add_by_parameters(f, n_unknown, unknown, derivative);
}

static size_t fmu_snapshot_size(const fmu *f) {
    fmu_part parts[FMU_PARTS];
    size_t sizes = 0;
    int i;
    fmu_parts(f->instance, parts);
    for (i = 0; i < FMU_PARTS; ++i) sizes += parts[i].size;
    return sizeof(fmu_snapshot) + sizes * sizeof(double);
}

static void fmu_save(const fmu *f, void *into) {
    const sym_instance *instance = f->instance;
    fmu_part parts[FMU_PARTS];
    char *at = (char *)into + sizeof(fmu_snapshot);
    fmu_snapshot head;
    int i;
    memset(&head, 0, sizeof head);
    strncpy(head.hash, instance->model->hash, sizeof head.hash - 1);
    head.t = instance->t, head.h = instance->run.h, head.stop = f->stop;
    head.error = f->error, head.fastest = f->fastest;
    head.phase = (int32_t)f->phase, head.has_stop = f->has_stop, head.cosim = f->cosim;
    memcpy(into, &head, sizeof head);
    fmu_parts(f->instance, parts);
    for (i = 0; i < FMU_PARTS; ++i) {
        if (parts[i].size == 0) continue;
        memcpy(at, parts[i].at, parts[i].size * sizeof(double));
        at += parts[i].size * sizeof(double);
    }
}

/* Whether a snapshot is of this model, and thus as long as this unit's are. */
static int fmu_owns(const fmu *f, const void *snapshot) {
    fmu_snapshot head;
    memcpy(&head, snapshot, sizeof head);
    return strncmp(head.hash, f->instance->model->hash, sizeof head.hash - 1) == 0;
}

/* Returns 0 where the snapshot is of another model or kind. */
static int fmu_load(fmu *f, const void *from) {
    sym_instance *instance = f->instance;
    fmu_part parts[FMU_PARTS];
    const char *at = (const char *)from + sizeof(fmu_snapshot);
    fmu_snapshot head;
    int i;
    memcpy(&head, from, sizeof head);
    if (!fmu_owns(f, from) || head.cosim != f->cosim) return 0;
    if (head.phase < 0 || head.phase > (int32_t)FMU_TERMINATED) return 0;
    instance->t = head.t, instance->run.h = head.h, f->stop = head.stop;
    f->error = head.error, f->fastest = head.fastest;
    f->phase = (fmu_phase)head.phase, f->has_stop = head.has_stop;
    fmu_parts(f->instance, parts);
    for (i = 0; i < FMU_PARTS; ++i) {
        if (parts[i].size == 0) continue;
        memcpy(parts[i].at, at, parts[i].size * sizeof(double));
        at += parts[i].size * sizeof(double);
    }
    fmu_recall_events(instance);
    f->parameters_valid = 0, f->rates_valid = 0;
    return 1;
}
