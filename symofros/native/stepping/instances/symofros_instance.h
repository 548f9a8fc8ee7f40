/* symofros_instance.h - one simulated model with its parameters, state and integrator, in memory that the caller owns.
 * Written by hand; C99. The contract with exported packages.
 *
 *     void *memory = malloc(sym_instance_size(arm_plant()));   // or a static array of that many bytes
 *     sym_instance *arm = sym_instance_init(memory, size, arm_plant());
 *     arm->u[0] = 1.5;                                         // inputs, held until they are changed
 *     status = sym_instance_advance(arm, t_end, 1e-3);         // arm->t, arm->q, arm->v move on
 *
 * Quaternions of arm->q may be of any length where a function, accelerations, rates or derivatives are asked for: these
 * are evaluated at the quaternions divided by their lengths. After sym_instance_init nothing allocates, and nothing is
 * shared between instances: each may live in a thread of its own. A status below zero is one of SYM_DIVERGED ...
 * SYM_NO_ROTATION (symofros_stepper.h).
 */
#ifndef SYMOFROS_INSTANCE_H
#define SYMOFROS_INSTANCE_H

#include "symofros_stepper.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sym_event_plan { /* events of a package, and what they do: symofros_stepper.h */
    int32_t n;
    const char *const *names;             /* (n) */
    const int32_t *direction, *cut;       /* (n) as sym_system's event_direction, event_terminal at first */
    const int32_t *acts, *once;           /* (n) as in sym_actions, as what follows */
    const double *restitution;
    const int32_t *opens;
    int32_t n_assignments, n_switches, n_poses;
    const sym_assignment *assignments;
    const sym_switch *switches;
    const char *const *pose_frames;       /* (n_poses) frames whose relative rotation is held */
    int32_t n_sticking, first_mode;       /* friction that sticks; the event at which the first mode of it ends */
    const sym_sticking *sticking;
    const sym_model *(*formulas)(void);   /* a function of the values of the events, of parameters' parts of its own */
    const sym_model *(*actions)(void);    /* the same of switches and assignments; NULL: no event acts */
    int32_t n_contacts;                   /* balls of rigid contacts, whose modes' ends follow those of friction */
    const sym_rigid_contact *contacts;
    const sym_model *(*contact_state)(void); /* as in sym_system; NULL: there are none */
} sym_event_plan;

typedef struct sym_plant { /* constants that a package generates besides the model's functions */
    const sym_model *(*model)(void);
    int32_t n_segments;
    const sym_segment *segments;
    const int32_t *on_speeds;             /* (nc) whether a constraint binds speeds only */
    const int32_t *group;                 /* (nc) first condition of those that share their sizes */
    const char *const *constraint_names;  /* (nc) */
    const double *q_start, *v_start, *u_start;
    int32_t n_frames;
    const char *const *frame_names;       /* (n_frames) those that functions were generated for */
    const char *method_name;              /* of the stepping method: */
    int32_t method, adaptive;
    const sym_tableau *tableau;
    double h, rtol, atol;                 /* step [s], or the first one of an adaptive method; its error bounds */
    int32_t n_beams, n_beam_coordinates;
    const sym_beam *beams;                /* (n_beams) what judges their bending: sym_run_judge_beams */
    const char *const *beam_names;
    const int32_t *beam_displacements;    /* (n_beam_coordinates) whether each counts by the beam's length */
    const double *beam_reach;             /* (n_beam_coordinates) largest angle, of a displacement by the length */
    double beam_limit;
    /* The first condition that parameters (npar) violate, -1: none; what each condition asks for, in words. */
    int32_t (*violated)(const double *par);
    const char *const *conditions;
    int32_t n_quaternion_inputs;
    const int32_t *quaternion_inputs;     /* (n_quaternion_inputs) first indices in u, as in sym_system */
    const sym_event_plan *events;         /* NULL: none */
} sym_plant;

typedef struct sym_instance {
    const sym_plant *plant;
    const sym_model *model;
    double t, *q, *v;   /* the present state: (nq), (nv) */
    double *u;          /* (nu) inputs */
    double *par;        /* (npar) parameters: call sym_instance_prepare after a change */
    int32_t check_parameters; /* 1, the default: sym_instance_prepare judges them; 0: it takes them as they come */
    int32_t refused;    /* index in plant->conditions of the condition that they violate; -1: none is known of */
    double *a, *lam;    /* (nv), (nc) of sym_instance_accelerate */
    double *gains;      /* (2 nc) Baumgarte's: alpha of each, then beta of each [1/s]; zero by default */
    int32_t project;    /* 1: project onto the constraints after each step; the default of models that have some */
    double *pre, *work; /* for calls of the model's functions: (npre), and scratch for any of them */
    sym_beam *beams;    /* (n_beams) at the present parameters, as are scale, reach and stiffness in `run` */
    double *beam_scale, *beam_reach;
    sym_call beam_stiffness;
    sym_call operands;  /* of the model's own formulas of time; without a function where they have no instants */
    sym_instant_search instants;
    double *stops;      /* (instants.capacity) instants that are known, from one time up to another */
    double stops_begin, stops_end;
    sym_actions actions; /* where events act; `par` and its parts are then those that they have left */
    int32_t *event_terminal; /* (events) */
    double *left_at;    /* (1 + nq + nv) of rigid contacts: t, q, v at the end of the last motion */
    sym_system system;
    sym_run run;
} sym_instance;

/* Bytes that an instance needs, aligned as doubles and pointers are. */
size_t sym_instance_size(const sym_plant *plant);
/* An instance in that memory, reset; NULL where the memory is too small or the model of another ABI. */
sym_instance *sym_instance_init(void *memory, size_t size, const sym_plant *plant);
/* Parameters, state and inputs as at the start. */
void sym_instance_reset(sym_instance *instance);
/* Evaluate what depends on parameters alone. Returns 0, or SYM_PARAMETERS_REFUSED where they violate a condition of the
 * description (instance->refused): nothing moves then until this is called with parameters that are allowed. */
int32_t sym_instance_prepare(sym_instance *instance);
/* Project the state onto the constraints, after its quaternions, which are near unit length (1e-3), were divided by
 * their lengths. Returns 0 or a status. */
int32_t sym_instance_project(sym_instance *instance);
/* Judge how far the beams of the present state bend, as sym_instance_advance does. Returns 0 or SYM_BEYOND_THEORY. */
int32_t sym_instance_judge_beams(sym_instance *instance);
/* Estimated error of a beam's theory since the reset, relative to its deflection, axial loads included. */
double sym_instance_beam_error(sym_instance *instance, int32_t beam);
/* When balls of rigid contacts without restitution have last struck one after the other in this motion, since no motion was found
 * in which they do at once: where it goes on depends on their order (docs/theory/constraints.md, section 15). -HUGE_VAL: never. */
double sym_instance_struck_in_sequence(const sym_instance *instance);
/* Accelerations and multipliers at the present state. Returns 0 or a status. */
int32_t sym_instance_accelerate(sym_instance *instance);
/* Integrate to t_end by steps of at most h (0: the plant's), from quaternions that are near unit length (1e-3), which
 * have it then. Steps end where the model's formulas of time bend, jump or change fast. Events act on the way: parameters,
 * speeds, constraints that engage. Those that were met are rows 0 to run.n_event_records - 1 of run.event_index (of
 * plant->events->names), event_t, event_q, event_v, the first ones gone where there were more than run.event_capacity.
 * Returns SYM_FINISHED, SYM_TERMINAL_EVENT where an event ends the motion at instance->t, or a status below zero. */
int32_t sym_instance_advance(sym_instance *instance, double t_end, double h);
/* For integrators of others: the first instant after the present time, up to t_end, at which a step has to end because a
 * formula of time bends, jumps or changes fast; t_end where there is none. The functions of a step between two such instants
 * are those after the first and before the second; past the second, this is called anew. */
double sym_instance_begin_step(sym_instance *instance, double t_end);
/* Evaluate one function of the model at the present state; out: its outputs in order. Returns 0 where it is absent, or
 * asks for an input that an instance does not hold, or parameters are refused. */
int32_t sym_instance_call(sym_instance *instance, const sym_function *function, double *const *out);
/* Doubles of instance->system.contact_memory, all that is kept of rigid contacts from one motion to the next. */
size_t sym_instance_contact_size(const sym_instance *instance);
/* Rates of q and v (nq + nv) at the present state. Returns 0 or a status. */
int32_t sym_instance_rates(sym_instance *instance, double *rates);
/* Exact directional derivatives at the present state, after sym_instance_rates: along dq (nq), dv (nv), du (nu) those of
 * the rates (nq + nv) and of lam (nc). work: sym_instance_differentiate_size doubles. Returns 0 or a status. */
size_t sym_instance_differentiate_size(const sym_instance *instance);
int32_t sym_instance_differentiate(sym_instance *instance, const double *dq, const double *dv, const double *du,
                                   double *rates, double *lam, double *work);
/* The tangent vector (nv) of the configuration manifold that a change dq (nq) stands for. */
void sym_instance_tangent(const sym_instance *instance, const double *dq, double *tangent);
/* The largest error of a model at reference points, relative to the largest entry of each output: of each function in
 * turn and each point, inputs and then outputs. memory: sym_selftest_size doubles. Infinite where the points are of
 * another model. */
size_t sym_selftest_size(const sym_model *model);
double sym_selftest(const sym_model *model, int32_t points, const double *reference, size_t count, double *memory);
/* A monotonic clock [s], and a sleep. */
double sym_seconds(void);
void sym_wait(double seconds);

#ifdef __cplusplus
}
#endif
#endif
