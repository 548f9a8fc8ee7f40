/* Instances of models: symofros_instance.h. */

/* A function of the model as a call at the system's evaluation point. Returns 0 where the model lacks it. */
static int32_t sym_instance_bind(sym_instance *instance, sym_arena *arena, sym_call *call, const char *name) {
    const sym_function *function = sym_find(instance->model, name, NULL);
    const sym_point point = sym_system_point(&instance->system);
    call->init = instance->model->init;
    return sym_bind_function(arena, call, function, instance->pre, instance->work, &point);
}

/* Lay out what judges the beams. Returns 0 where the model lacks a function for that. */
static int32_t sym_instance_allocate_beams(sym_instance *instance, sym_arena *arena) {
    const sym_plant *p = instance->plant;
    const size_t n = (size_t)p->n_beams, coordinates = (size_t)p->n_beam_coordinates;
    sym_system *s = &instance->system;
    sym_run *r = &instance->run;
    int32_t has_stiffness, has_mass, has_jacobian;
    if (n == 0) return 1;
    instance->beams = sym_allocate_bytes(arena, n * sizeof *instance->beams);
    instance->beam_scale = sym_allocate(arena, coordinates), instance->beam_reach = sym_allocate(arena, coordinates);
    if (arena->base != NULL) memcpy(instance->beams, p->beams, n * sizeof *instance->beams);
    s->n_beams = p->n_beams, s->beams = instance->beams;
    r->beam_limit = p->beam_limit, r->beam_scale = instance->beam_scale, r->beam_reach = instance->beam_reach;
    r->beam_error = sym_allocate(arena, n), r->beam_t = sym_allocate(arena, n), r->beam_q = sym_allocate(arena, coordinates);
    r->beam_reference = sym_allocate(arena, 2 * coordinates), r->beam_weight = sym_allocate(arena, (size_t)s->nv);
    r->beam_guard = sym_allocate_bytes(arena, n * sizeof *r->beam_guard);
    r->beam_works = sym_allocate(arena, 2 * SYM_BEAM_STATES * n);
    r->beam_change = sym_allocate(arena, (size_t)s->nv + (size_t)s->nc);
    has_stiffness = sym_instance_bind(instance, arena, &instance->beam_stiffness, "beam_stiffness");
    has_mass = sym_instance_bind(instance, arena, &s->mass_matrix, "mass_matrix");
    has_jacobian = s->nc == 0 || sym_instance_bind(instance, arena, &s->constraint_jacobian, "constraint_jacobian");
    r->elastic_stiffness = instance->beam_stiffness.out[2];
    return has_stiffness && has_mass && has_jacobian;
}

/* Numbers of the beams at the present parameters. */
static void sym_instance_prepare_beams(sym_instance *instance) {
    const sym_plant *p = instance->plant;
    const double *L = instance->beam_stiffness.out[0], *EI = instance->beam_stiffness.out[1];
    int32_t b, i;
    if (p->n_beams == 0) return;
    memset(instance->run.beam_reference, 0, 2 * (size_t)p->n_beam_coordinates * sizeof(double));
    memset(instance->run.beam_guard, 0, (size_t)p->n_beams * sizeof(sym_beam_guard));
    sym_evaluate(&instance->beam_stiffness);
    for (b = 0; b < p->n_beams; ++b) {
        sym_beam *beam = &instance->beams[b];
        const int32_t end = beam->first + beam->n;
        const double EI_z = EI[2 * b], EI_y = EI[2 * b + 1], least = EI_z < EI_y ? EI_z : EI_y;
        beam->EI_z = EI_z, beam->EI_y = EI_y;
        beam->contrast = beam->n_y > 0 && beam->n_z > 0 && least > 0.0 ? fabs(EI_z - EI_y) / least : 0.0;
        for (i = beam->first; i < end; ++i) {
            instance->beam_scale[i] = p->beam_displacements[i] ? 1.0 / L[b] : 1.0;
            instance->beam_reach[i] = p->beam_reach[i] * instance->beam_scale[i];
        }
    }
}

/* Values of an operand of formulas of time, for the search of their instants. */
static void sym_instance_operand(void *data, int32_t operand, int32_t n, const double *t, double *value) {
    sym_instance *instance = data;
    const double kept = *instance->system.t;
    int32_t i;
    for (i = 0; i < n; ++i) {
        *instance->system.t = t[i];
        sym_evaluate(&instance->operands);
        value[i] = instance->operands.out[0][operand];
    }
    *instance->system.t = kept;
}

/* Lay out what finds the instants of the model's formulas of time. */
static void sym_instance_allocate_instants(sym_instance *instance, sym_arena *arena) {
    sym_instant_search *search = &instance->instants;
    memset(search, 0, sizeof *search), memset(&instance->operands, 0, sizeof instance->operands);
    if (!sym_instance_bind(instance, arena, &instance->operands, "instant_operands")) return;
    search->n = (int32_t)sym_array_size(&instance->operands.function->out[0]);
    search->kind = instance->operands.out[1];
    search->evaluate = sym_instance_operand, search->data = instance;
    search->capacity = SYM_INSTANT_CAPACITY;
    search->memory = sym_allocate(arena, (size_t)SYM_INSTANT_ROWS * SYM_INSTANT_CAPACITY);
    instance->stops = sym_allocate(arena, SYM_INSTANT_CAPACITY);
    instance->system.stops = instance->stops;
}

#include "instance_events.c"

/* Lay out every array of the instance. Returns 0 where the model lacks a function that its method calls. */
static int32_t sym_instance_allocate(sym_instance *instance, sym_arena *arena) {
    const sym_model *m = instance->model;
    const sym_plant *p = instance->plant;
    sym_system *s = &instance->system;
    sym_run *r = &instance->run;
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv, nu = (size_t)m->nu, nc = (size_t)m->nc;
    int32_t has_forward_dynamics, has_project, has_terms, has_residual, has_momentum, has_beams;
    memset(s, 0, sizeof *s), memset(r, 0, sizeof *r);
    memset(&instance->beam_stiffness, 0, sizeof instance->beam_stiffness);
    s->nq = m->nq, s->nv = m->nv, s->nu = m->nu, s->nc = m->nc;
    s->n_segments = p->n_segments, s->segments = p->segments, s->on_speeds = p->on_speeds, s->group = p->group;
    s->n_quaternion_inputs = p->n_quaternion_inputs, s->quaternion_inputs = p->quaternion_inputs;
    sym_run_set_defaults(r);
    r->system = s, r->method = p->method, r->adaptive = p->adaptive && nv > 0, r->tableau = *p->tableau;
    r->rtol = p->rtol, r->atol = p->atol;
    instance->par = sym_allocate(arena, (size_t)m->npar), instance->pre = sym_allocate(arena, (size_t)m->npre);
    instance->work = sym_allocate(arena, sym_work(m));
    s->q = sym_allocate(arena, nq), s->v = sym_allocate(arena, nv);
    s->u = sym_allocate(arena, nu), s->t = sym_allocate(arena, 1);
    s->gains = instance->gains = sym_allocate(arena, 2 * nc);
    instance->u = sym_allocate(arena, nu), s->u_constant = instance->u;
    r->q = instance->q = sym_allocate(arena, nq), r->v = instance->v = sym_allocate(arena, nv);
    r->work = sym_allocate(arena, sym_run_work_size(r));
    r->pivots = sym_allocate_bytes(arena, 2 * (nv + nc) * sizeof *r->pivots);
    has_forward_dynamics = sym_instance_bind(instance, arena, &s->forward_dynamics, "forward_dynamics");
    s->a = instance->a = s->forward_dynamics.out[0], s->lam = instance->lam = s->forward_dynamics.out[1];
    s->rank = s->forward_dynamics.out[2];
    has_project = nc == 0 || sym_instance_bind(instance, arena, &s->project, "project");
    /* Of any method, for sym_instance_differentiate as well. */
    has_terms = sym_instance_bind(instance, arena, &s->implicit_terms, "implicit_terms");
    has_residual = sym_instance_bind(instance, arena, &s->residual, "residual");
    has_momentum = sym_instance_bind(instance, arena, &s->momentum, "momentum");
    has_beams = sym_instance_allocate_beams(instance, arena);
    sym_instance_allocate_instants(instance, arena);
    if (!sym_instance_allocate_events(instance, arena)) return 0;
    return has_forward_dynamics && has_project && has_beams && (has_terms || p->method <= SYM_METHOD_SEMI_IMPLICIT) &&
           (has_residual || p->method != SYM_METHOD_ALPHA) && (has_momentum || p->method != SYM_METHOD_VARIATIONAL);
}

SYM_EXPORT size_t sym_instance_size(const sym_plant *plant) {
    sym_instance draft;
    sym_arena arena = {NULL, 0};
    draft.plant = plant, draft.model = plant->model();
    sym_instance_allocate(&draft, &arena);
    return (sym_doubles(sizeof draft) + arena.used) * sizeof(double);
}

SYM_EXPORT sym_instance *sym_instance_init(void *memory, size_t size, const sym_plant *plant) {
    sym_instance *instance = memory;
    const sym_model *model = plant->model();
    sym_arena arena;
    if (memory == NULL || model->abi != SYM_ABI || size < sym_instance_size(plant)) return NULL;
    memset(memory, 0, size);
    instance->plant = plant, instance->model = model;
    arena.base = (double *)memory + sym_doubles(sizeof *instance), arena.used = 0;
    if (!sym_instance_allocate(instance, &arena)) return NULL;
    sym_instance_reset(instance);
    return instance;
}

SYM_EXPORT void sym_instance_reset(sym_instance *instance) {
    const sym_model *m = instance->model;
    const sym_plant *p = instance->plant;
    instance->t = 0.0, instance->run.h = 0.0;
    memcpy(instance->q, p->q_start, (size_t)m->nq * sizeof(double));
    memcpy(instance->v, p->v_start, (size_t)m->nv * sizeof(double));
    memcpy(instance->u, p->u_start, (size_t)m->nu * sizeof(double));
    memcpy(instance->par, m->par_default, (size_t)m->npar * sizeof(double));
    memset(instance->gains, 0, 2 * (size_t)m->nc * sizeof(double));
    if (p->n_beams > 0) memset(instance->run.beam_error, 0, (size_t)p->n_beams * sizeof(double));
    sym_clear_axial_loads(&instance->run);
    instance->project = m->nc > 0, instance->check_parameters = 1;
    sym_instance_forget_events(instance);
    (void)sym_instance_prepare(instance); /* the defaults are allowed */
}

/* Instants that were found are of other parameters. */
static void sym_instance_forget_stops(sym_instance *instance) {
    instance->system.n_stops = 0, instance->system.in_step = 0;
    instance->stops_begin = HUGE_VAL, instance->stops_end = -HUGE_VAL;
}

SYM_EXPORT int32_t sym_instance_prepare(sym_instance *instance) {
    instance->refused = instance->check_parameters ? instance->plant->violated(instance->par) : -1;
    if (instance->refused >= 0) return SYM_PARAMETERS_REFUSED;
    sym_hold_by_modes(&instance->system, instance->par);
    instance->model->init(instance->par, instance->pre);
    sym_prepare_call(&instance->system.events, instance->par), sym_prepare_call(&instance->system.contact_state, instance->par);
    sym_instance_prepare_beams(instance);
    sym_instance_forget_stops(instance);
    return 0;
}

/* Evaluation point <- the present state, its quaternions normalised. */
static void sym_instance_load_state(sym_instance *instance) {
    sym_system *s = &instance->system;
    instance->run.t = instance->t;
    sym_load_state(&instance->run);
    sym_normalize_quaternions(s);
    if (s->in_step && (instance->t < sym_before(s->first_stage) || instance->t > sym_instant(s->step_end))) s->in_step = 0;
    *s->t = sym_stage_time(s, instance->t);
}

/* Times the plant's step that instants are sought ahead at least, since a search over each short span of its own would cost
 * more than its steps; in the second half, a narrow part may begin before the middle that tells of it, and half as long
 * before, one may end behind its middle. */
#define SYM_AHEAD 1024.0
/* Share of a span that is no span of its own. */
#define SYM_AHEAD_REST 1e-6
/* Halvings of the span, where its instants do not fit into the memory; formulas that still have more are followed by no step. */
#define SYM_AHEAD_HALVINGS 20
/* Share of a step within which an event that acts twice acts without end. */
#define SYM_AT_ONCE 1e-6

/* A span from t to t_end, or as long as instants are sought ahead at least. */
static double sym_instance_span(const sym_instance *instance, double t, double t_end) {
    const double ahead = SYM_AHEAD * instance->plant->h;
    return t_end - t > ahead ? t_end - t : ahead;
}

/* Find the instants of the model's formulas from t on, to t_end if memory holds them. Returns up to when they are known. */
static double sym_instance_find_stops(sym_instance *instance, double t, double t_end) {
    double span = sym_instance_span(instance, t, t_end), known = t_end;
    int32_t n = -1, halvings;
    if (instance->operands.function == NULL || (t >= instance->stops_begin && t_end <= instance->stops_end)) return t_end;
    sym_evaluate(&instance->operands); /* their kinds */
    for (halvings = 0; halvings <= SYM_AHEAD_HALVINGS && n < 0; ++halvings, span *= 0.5) {
        n = sym_find_instants(&instance->instants, t - 0.5 * span, t + span, instance->stops);
        known = t + 0.5 * span;
        if ((halvings == 0 || t_end - known < SYM_AHEAD_REST * span) && known < t_end) known = t_end;
    }
    instance->system.n_stops = n > 0 ? n : 0;
    instance->stops_begin = t, instance->stops_end = known;
    return known < t_end ? known : t_end;
}

/* Bring the quaternions of the state to unit length, if they are off by more than rounding; what is not finite stays.
 * Returns 0, or SYM_NO_ROTATION where one is no rotation. */
static int32_t sym_instance_normalize(sym_instance *instance) {
    const sym_plant *plant = instance->plant;
    int32_t k;
    for (k = 0; k < plant->n_segments; ++k) {
        const sym_segment *segment = &plant->segments[k];
        double *p = instance->q + segment->q + (segment->kind == SYM_SEGMENT_POSE ? 3 : 0);
        if (segment->kind == SYM_SEGMENT_LINEAR || !(0.0 * p[0] + 0.0 * p[1] + 0.0 * p[2] + 0.0 * p[3] == 0.0)) continue;
        if (!sym_make_rotation(p)) return SYM_NO_ROTATION;
    }
    return 0;
}

SYM_EXPORT int32_t sym_instance_project(sym_instance *instance) {
    if (instance->refused >= 0) return SYM_PARAMETERS_REFUSED;
    if (sym_instance_normalize(instance) != 0) return SYM_NO_ROTATION;
    if (instance->model->nc == 0) return 0;
    instance->run.t = instance->t;
    return sym_project_state(&instance->run);
}

SYM_EXPORT int32_t sym_instance_judge_beams(sym_instance *instance) {
    int32_t status;
    instance->run.t = instance->t;
    status = sym_run_judge_beams(&instance->run);
    return status != 0 ? status : sym_judge_axial_loads(&instance->run);
}

SYM_EXPORT double sym_instance_beam_error(sym_instance *instance, int32_t beam) {
    return sym_run_beam_error(&instance->run, beam);
}

SYM_EXPORT int32_t sym_instance_accelerate(sym_instance *instance) {
    if (instance->refused >= 0) return SYM_PARAMETERS_REFUSED;
    sym_instance_load_state(instance);
    return sym_evaluate_acceleration(&instance->run);
}

SYM_EXPORT int32_t sym_instance_call(sym_instance *instance, const sym_function *function, double *const *out) {
    sym_call call;
    int32_t i;
    if (function == NULL || function->n_out > SYM_MAX_OUTPUTS || instance->refused >= 0) return 0;
    call.function = function, call.pre = instance->pre, call.work = instance->work;
    for (i = 0; i < function->n_out; ++i) call.out[i] = out[i];
    if (!sym_system_bind(&instance->system, &call)) return 0;
    sym_instance_load_state(instance);
    sym_evaluate_inputs(&instance->system);
    sym_evaluate(&call);
    return 1;
}

SYM_EXPORT double sym_instance_begin_step(sym_instance *instance, double t_end) {
    const double known = sym_instance_find_stops(instance, instance->t, t_end);
    const double stop = sym_next_stop(&instance->system, instance->t, known);
    sym_begin_step(&instance->system, instance->t, stop);
    return stop;
}

/* Adaptive steps in which nothing happens are looked into, as those of a run of that length are. */
static void sym_instance_look(sym_instance *instance, double span) {
    instance->run.look_every = instance->run.adaptive ? span / SYM_LOOKS : 0.0;
}

/* Integrate to t_end, between two instants of the model's formulas. Returns SYM_FINISHED or a status below zero. */
static int32_t sym_instance_advance_between(sym_instance *instance, double t_end, double h) {
    sym_run *r = &instance->run;
    const double span = t_end - instance->t, longest = h > 0.0 ? h : instance->plant->h;
    double count = 1.0;
    int32_t status;
    r->t0 = r->t = instance->t, r->t_end = t_end, r->project = instance->project && instance->model->nc > 0;
    if (r->adaptive) {
        if (!(r->h > 0.0)) r->h = h > 0.0 ? h : instance->plant->h;
    } else {
        if (longest > 0.0) count = ceil(span / longest * (1.0 - 1e-9));
        r->h = span / (count > 1.0 ? count : 1.0);
    }
    sym_instance_make_room(r);
    status = sym_instance_doubt_contacts(instance);
    if (status == 0) status = sym_run_start(r);
    while (status == SYM_RUNNING || status == SYM_RECORDS_FULL) {
        sym_instance_make_room(r);
        status = sym_run_advance(r, INT32_MAX);
    }
    if (r->adaptive) r->h = r->next_step; /* the next call continues with the controller's step */
    instance->t = status == SYM_FINISHED ? t_end : r->t;
    sym_instance_leave(instance);
    return status;
}

SYM_EXPORT int32_t sym_instance_advance(sym_instance *instance, double t_end, double h) {
    const double span = t_end - instance->t;
    int32_t status = SYM_FINISHED;
    if (instance->refused >= 0) return SYM_PARAMETERS_REFUSED;
    if (!(span > 0.0)) return span == 0.0 ? SYM_FINISHED : SYM_DIVERGED;
    if (sym_instance_normalize(instance) != 0) return SYM_NO_ROTATION;
    sym_run_end_step(&instance->run);
    instance->run.n_event_records = 0;
    instance->actions.at_once = instance->run.adaptive ? 0.0 : SYM_AT_ONCE * (h > 0.0 ? h : instance->plant->h);
    instance->system.longest_step = instance->run.adaptive ? 0.0 : h > 0.0 ? h : instance->plant->h;
    sym_instance_look(instance, sym_instance_span(instance, instance->t, t_end));
    while (status == SYM_FINISHED && instance->t < t_end) {
        double end = sym_instance_find_stops(instance, instance->t, t_end);
        if (!instance->run.adaptive) end = sym_next_stop(&instance->system, instance->t, end);
        status = sym_instance_advance_between(instance, end, h);
    }
    return status;
}
