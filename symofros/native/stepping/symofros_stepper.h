/* symofros_stepper.h - numerical integration of a SYMOFROS model over time. Written by hand; C99.
 *
 * A state is (q, v). Within a step it is held as y = (theta, v): theta are local coordinates (a chart) of the
 * configuration manifold about the q at which the step began, so that quaternions stay of unit length and every method
 * is one of plain vectors (docs/theory/simulation.md, section 1). Nothing here allocates: the caller owns every array.
 * Constants and status codes stand here alone; Python reads them from the cdef part.
 */
#ifndef SYMOFROS_STEPPER_H
#define SYMOFROS_STEPPER_H

#include "symofros_model.h"

/* cdef begin: what bindings read */
typedef enum sym_status {
    SYM_RUNNING = 0,             /* max_steps are done, t_end is not reached */
    SYM_FINISHED = 1,            /* t_end is reached */
    SYM_RECORDS_FULL = 2,        /* empty the records, then continue */
    SYM_TERMINAL_EVENT = 3,      /* a terminal event ended the run */
    SYM_DIVERGED = -1,           /* a state or an acceleration is not finite */
    SYM_SINGULAR = -2,           /* no acceleration exists: the mass matrix is singular beyond what constraints bind */
    SYM_STEP_TOO_SMALL = -3,     /* the error bound asks for steps below rounding */
    SYM_CALLBACK_FAILED = -4,    /* a function of the caller's failed */
    SYM_NO_CONVERGENCE = -5,     /* the equations of an implicit step were not solved */
    SYM_PROJECTION_FAILED = -6,  /* the state could not be projected onto the constraints */
    SYM_BEYOND_THEORY = -7,      /* a beam is bent beyond second-order theory */
    SYM_ENERGY_LOST = -8,        /* projection onto the constraints has taken the motion's energy */
    SYM_PARAMETERS_REFUSED = -9, /* parameters violate a condition of the description; of instances only */
    SYM_NO_ROTATION = -10,       /* a quaternion is not of unit length: of inputs, or of an instance's state */
    SYM_ENGAGED_APART = -11,     /* conditions that engage are not fulfilled */
    SYM_ACTION_REFUSED = -12,    /* an event's action sets what is not allowed, or its restitution lets nothing strike */
    SYM_ACTS_WITHOUT_END = -13,  /* an event's action brings the event about again at the same instant, or bodies to rest */
    SYM_MODES_UNDECIDED = -14,   /* no modes of friction that sticks agree with what they bring about */
    SYM_HELD_TWICE = -15,        /* friction holds what it or constraints hold already: what it takes is not determined */
    SYM_WRONG_CONTACT = -16,     /* a contact that rests is penetrated, or holds by a force that draws */
    SYM_NO_CONTACT_FORCE = -17,  /* no forces of rigid contacts with friction were found that agree with their motion */
    SYM_CONTACTS_AMBIGUOUS = -18, /* several motions agree with Coulomb's law at rigid contacts */
    SYM_FLAT_RIM = -19           /* a rim lies on its plane, a segment along its surface, or a rim touches a cylinder at two points: no single one */
} sym_status;

typedef enum sym_method {
    SYM_METHOD_EXPLICIT = 0,     /* explicit Runge-Kutta */
    SYM_METHOD_SEMI_IMPLICIT = 1, /* semi-implicit (symplectic) Euler */
    SYM_METHOD_ROSENBROCK = 2,
    SYM_METHOD_ALPHA = 3,        /* generalized alpha */
    SYM_METHOD_VARIATIONAL = 4   /* variational midpoint rule */
} sym_method;

typedef enum sym_segment_kind {
    SYM_SEGMENT_LINEAR = 0,      /* any number of scalar coordinates */
    SYM_SEGMENT_QUATERNION = 1,  /* x, y, z, w; 3 speeds */
    SYM_SEGMENT_POSE = 2         /* position, then quaternion; 6 speeds: linear, then angular, in body axes */
} sym_segment_kind;

enum { SYM_MAX_BEAM_COORDINATES = 120, SYM_BEAM_STATES = 16 };
enum { SYM_MAX_INPUTS = 10, SYM_MAX_OUTPUTS = 10 }; /* of a model function that is called here; "pre" is an input */

typedef struct sym_segment {
    int32_t kind;       /* sym_segment_kind */
    int32_t q, v, size; /* first indices in q and v; number of coordinates of a linear segment */
} sym_segment;

typedef struct sym_signal { /* one input, sampled over time */
    int32_t input;          /* index in u */
    int32_t linear;         /* 1: linear interpolation; 0: each sample is held until the next begins */
    int32_t n;
    const double *t, *value;
} sym_signal;

typedef struct sym_beam { /* one elastic body: angles of its sections are linear in its elastic coordinates */
    int32_t q, v, first;         /* first index in q, in v, in beam_scale and beam_q */
    int32_t n, n_y, n_z, n_twist; /* number of coordinates, in all and by direction */
    int32_t blocks;              /* number of blocks of eight stations */
    const double *angles;        /* (blocks, n_y + n_z + n_twist, 8): yaw, pitch and twist per scaled coordinate [rad] */
    double EI_z, EI_y;           /* stiffness against n_y and n_z at mid-length */
    double negligible;           /* error up to which no step is looked for */
    double contrast;             /* |EI_z - EI_y| over the smaller; 0 where bending is rigid in a plane */
} sym_beam;

typedef struct sym_beam_guard { /* how far a beam is bent in the norm of its kind: docs/theory/beams.md (26d) [rad] */
    int32_t norm;                /* which one; 0: the beam was not judged yet */
    int32_t leading;             /* the coordinate that adds most to it where it was evaluated last; -1: none is of use */
    double evaluated;            /* the norm there */
    double margin;               /* by which the norm may grow since the beam was judged last until it is again */
    double largest, target;      /* norms of the largest error so far, and of the one beyond which a step is judged: */
    double least, limit;         /* between that of a negligible error and that of the limit */
    double beam_limit;           /* the limit that this is of */
    double of_yaw, of_pitch, of_twist; /* how norms weigh squares of angles */
} sym_beam_guard;

typedef struct sym_call { /* a model function with the arrays it reads and writes */
    const sym_function *function; /* NULL: absent */
    const double *pre;
    double *work;
    const double *in[SYM_MAX_INPUTS];
    double *out[SYM_MAX_OUTPUTS];
    void (*init)(const double *par, double *pre); /* of the function's model, where parameters change in a run; or NULL */
} sym_call;

typedef struct sym_sticking { /* a coordinate with friction that sticks (docs/theory/constraints.md, section 14) */
    int32_t q, v;  /* its index in q, of its rate in v */
    int32_t mode;  /* parameter: 1, -1: it slides forwards, backwards; SYM_HELD; 0: its friction is smooth */
    int32_t row;   /* of G, which holds it */
} sym_sticking;

/* Entries a ball of a rigid contact: of its state, and of its memory. */
typedef enum sym_contact_sizes { SYM_CONTACT_ENTRIES = 8, SYM_BALL_ENTRIES = 5 } sym_contact_sizes;

typedef struct sym_rigid_contact { /* a ball of a rigid contact (docs/theory/constraints.md, section 15) */
    int32_t mode;    /* parameter: SYM_OPEN, SYM_SLIDES, SYM_STICKS */
    int32_t push[3]; /* parameters: a further force on the ball, along the axes of contact */
    int32_t way[3];  /* parameters: x, y of the direction in which it has begun to slide, and its speed then */
    int32_t apart;   /* parameter: how far it may pass the surface, open, by rounding */
    int32_t pole;    /* parameter: sign of the pole; -1: of a plane */
    int32_t row[3];  /* of G, which hold it along the axes of contact */
} sym_rigid_contact;

typedef struct sym_assignment { /* what one action sets */
    int32_t event;
    int32_t is_speed, index; /* of a speed, else of a parameter */
    int32_t value;           /* number of the formula that gives it */
} sym_assignment;

typedef struct sym_switch { /* a constraint that engages and releases; the formula of the same number says whether it holds */
    int32_t moment;            /* whether it holds the pose of the moment, by parameters: */
    int32_t n_offsets;
    const int32_t *row, *place; /* (n_offsets) row of phi, and its offset */
    const int32_t *rotation;   /* (4) x, y, z, w; NULL: it holds none */
    int32_t pose;              /* number of the first of the calls of its two frames */
} sym_switch;

/* What the events of a run do. Functions are bound to its evaluation point, and have parameters' parts of their own. */
typedef struct sym_actions {
    int32_t npar, n_assignments, n_switches;
    int32_t first_mode;              /* the event at which the first mode of friction that sticks ends; the others follow */
    const sym_assignment *assignments; /* in the order in which they are stated */
    const sym_switch *switches;
    const int32_t *acts, *once;      /* (n_events) whether one has an action; whether it has it once only */
    const double *restitution;       /* (n_events) Newton's coefficient; below 0: none */
    const int32_t *opens;            /* (n_events) the event at which a contact that came to rest by this one opens; below 0: none */
    int32_t (*refuses)(void *data, const double *par); /* whether parameters are not allowed */
    void *data;
    double at_once;                  /* an event that acts twice within this time acts without end [s]; 0: a share of the time so far */
    sym_call values, constraint;     /* formulas: of switches, assignments, the most that friction takes at rest; phi */
    sym_call *poses;                 /* p, R of frames */
    double *engaged;                 /* (n_switches) scratch */
    double *modes;                   /* (npar + 2 n_sticking + n_contacts) scratch */
} sym_actions;

/* What the action at a row of events has done. */
typedef struct sym_done {
    double *acted;                   /* 1; SYM_RESTS; 0: nothing; a status: failed */
    double *gap;                     /* as of sym_run_engage */
    double *in_sequence;             /* whether balls of rigid contacts struck so, as no motion was found in which they do at once */
    double *u;                       /* (nu) inputs by which it acted */
    double *v_set, *v_after;         /* (nv) speeds that it set; those that the impact left */
    double *q_after;                 /* (nq) */
    double *par, *par_set;           /* (npar) parameters before, and those that it set */
} sym_done;

typedef struct sym_tableau { /* coefficients of a Runge-Kutta or Rosenbrock method */
    int32_t stages;          /* of a step and its error estimate */
    int32_t dense_stages;    /* the same and those that dense output adds */
    int32_t fsal_stage;      /* "first same as last": its slope is the first of the next step; 0: none */
    int32_t estimate_order;  /* order of the embedded solution */
    int32_t n_estimates;     /* 0: none, 1: e, 2: e and e2, combined as DOP853 does */
    int32_t dense_degree;    /* degree of the dense output's polynomial; 0: cubic Hermite through both ends */
    const double *a;         /* (dense_stages, dense_stages), lower triangle */
    const double *b, *c;     /* (dense_stages) */
    const double *e, *e2;    /* (stages) */
    const double *dense;     /* (dense_stages, dense_degree): coefficient of x^(j+1) for each stage */
    /* Rosenbrock methods, where a, b and e weigh the solutions U of the stages' linear systems: */
    double gamma;
    const double *coupling;  /* (stages, stages) weights of earlier U in a stage's right side, over h */
    const double *d;         /* (stages) weights of the partial derivative by time */
} sym_tableau;

/* The differential equations of one model: its functions bound to one evaluation point, its inputs, its events. */
typedef struct sym_system {
    int32_t nq, nv, nu, nc, n_segments, n_signals, n_law, n_events, n_beams, n_quaternion_inputs, n_stops;
    const sym_segment *segments;
    const sym_beam *beams;          /* (n_beams) */
    const sym_signal *signals;
    /* (n_stops) instants, in order, at which adaptive steps end: kinks, jumps and narrow parts of formulas of time. */
    const double *stops;
    int32_t n_event_instants;
    const double *event_instants; /* (n_event_instants) those of formulas of time in events, which are looked at there, in order */
    const int32_t *law_inputs;      /* (n_law) indices in u of the inputs that the law gives */
    const int32_t *quaternion_inputs; /* (n_quaternion_inputs) first indices in u of quaternions that prescribe motions */
    const int32_t *event_direction; /* (n_events) 1 rising, -1 falling, 0 both */
    int32_t *event_terminal;        /* (n_events) 1: the event ends the run; 2: acts; -2: counts once; -1: is not looked for any more */
    const double *u_constant;       /* (nu) inputs that nothing else gives */
    /* Inputs by a function of the caller's; not 0 stops the run. NULL: none. */
    int32_t (*callback)(void *data, double t, const double *q, const double *v, double *u);
    void *data;
    sym_call forward_dynamics, law, events, project, implicit_terms, residual, momentum, mass_matrix, constraint_jacobian;
    const int32_t *on_speeds; /* (nc) whether a constraint binds speeds only (nonholonomic) */
    const int32_t *group;     /* (nc) first condition of those that share their sizes (docs/theory/constraints.md, section 10) */
    /* The evaluation point: inputs and outputs of the calls above. */
    double *q, *v, *u, *t, *gains, *a, *lam, *rank;
    /* Whether the evaluation point lies within a step under way, the time at its end, and the first and last times at which a
     * stage evaluates: held samples and jumps of formulas count from their instant on, in the step that begins there
     * (docs/theory/simulation.md, section 1). */
    int32_t in_step;
    int32_t held_anew; /* 1: the caller has changed u_constant at the present state; a step's end clears it */
    double step_end, first_stage, last_stage;
    int32_t events_free_of_inputs; /* 1: no event needs the inputs, which cost a call of the caller's */
    int32_t n_sticking;
    const sym_sticking *sticking; /* (n_sticking) coordinates with friction that sticks, and whether one is held now: */
    int32_t *held;                /* it stays as it is, and at rest, exactly */
    int32_t n_contacts;
    const sym_rigid_contact *contacts; /* (n_contacts) balls of rigid contacts */
    /* One output, SYM_CONTACT_ENTRIES of each: its distance, its velocity against the surface (3), its coefficients of
     * friction and of restitution, the normal's component along z of the surface's frame, and the sine of the angle of a rim
     * or segment with what it would touch along a line. */
    sym_call contact_state;
    int32_t npar;
    double longest_step;               /* of fixed steps [s] */
    /* (sym_contact_memory_size) of each ball its direction at the last end of a step with a slip (2), the slip up to which it
     * stays so [m/s], the instant of the last strike [s]; then whether modes have been chosen in this motion, and whether balls
     * that stick share their load in more than one way, and when balls struck in sequence last because no motion was found in which
     * they do at once [s], below all times: never. */
    double *contact_memory;
    double *contact_work;              /* sym_contact_work_size entries of scratch */
    int32_t events_of_reactions;   /* 1: events read accelerations or multipliers, which are evaluated with them */
} sym_system;

typedef enum sym_event_sizes { SYM_EVENT_NODES = 5, SYM_EVENT_EARLIER = 11, SYM_EVENT_UNSURE = 18, SYM_EVENT_ROWS = 22 } sym_event_sizes;

/* Events along one step (docs/theory/simulation.md, section 2), sought between x = 0, its start, and x = 1, its end. */
typedef struct sym_event_search {
    int32_t n;                    /* number of events */
    const int32_t *direction;     /* (n) 1 rising, -1 falling, 0 both */
    int32_t (*evaluate)(void *data, double x, double *values); /* values of all events (n) at x; returns 0 or a status */
    void *data;
    /* (SYM_EVENT_ROWS, n): values at the end of the step before; row SYM_EVENT_EARLIER, at its start or NaN; row SYM_EVENT_UNSURE,
     * changes that are rounding. */
    double *memory;
    int32_t short_step;           /* whether events far from zero need no look within the step */
    double longest;               /* interval between two points at which an event is looked at */
    double h;                     /* length of the step [s] */
    int32_t looks;                /* whether the rates of events are looked at that are far from zero */
    int32_t start_changes;        /* whether values at x = 0 may differ from those at the end of the step before */
    double t;                     /* start of the step [s] */
    int32_t n_instants;
    const double *instants;       /* (n_instants) in order [s]: where events are looked at, besides others */
    int32_t taken;                /* event that was returned last; -1: none */
    int32_t touched, unresolved;  /* the event that turns nearest to zero, one too fast to follow; -1: none */
    double touched_x, touched_share; /* where it turns, and its share there of its largest value in the step */
} sym_event_search;

/* What an operand of a formula of time does where it is small (docs/theory/simulation.md, (3a)). */
typedef enum sym_instant_kind {
    SYM_INSTANT_KINK = 0,   /* the formula bends or jumps where it passes zero */
    SYM_INSTANT_NARROW = 1, /* the formula has a narrow part where it is small, zero or not */
    SYM_INSTANT_END = 2     /* the same, but a zero is where the formula ends */
} sym_instant_kind;

/* Rows of a search's memory, and their length in packages. */
typedef enum sym_instant_sizes { SYM_INSTANT_ROWS = 11, SYM_INSTANT_CAPACITY = 2048 } sym_instant_sizes;

/* Instants of formulas of time, by the values of their operands. */
typedef struct sym_instant_search {
    int32_t n;          /* number of operands, those of inner formulas first */
    const double *kind; /* (n) sym_instant_kind of each */
    void (*evaluate)(void *data, int32_t operand, int32_t n, const double *t, double *value); /* at times (n) */
    void *data;
    int32_t capacity;   /* most instants, and most points at which an operand is looked at: more than 1025 */
    double *memory;     /* (SYM_INSTANT_ROWS, capacity) */
} sym_instant_search;

/* One integration of a system: method, settings, present state, records. */
typedef struct sym_run {
    sym_system *system;
    int32_t method;       /* sym_method */
    int32_t adaptive;
    int32_t project;      /* 1: project onto the constraints after each step */
    int32_t record_every; /* record each so many steps; 0: at `grid` only */
    sym_tableau tableau;
    double t0, t_end, h, rtol, atol, max_step;
    double spectral_radius;  /* of generalized alpha at infinite frequency */
    double newton_tolerance; /* of the equations of an implicit step, relative */
    double realtime_scale;   /* seconds of clock per second of simulated time; 0: as fast as possible */
    const double *grid;      /* (n_grid) times at which to record */
    int64_t n_grid, next_grid;
    /* The present state. */
    double t, *q, *v;
    double *work;          /* sym_run_work_size doubles */
    int32_t *pivots;       /* 2 (nv + nc) */
    double *event_values;  /* (SYM_EVENT_ROWS, n_events): at the present state, then work */
    double next_step, previous_error; /* of the step-size controller */
    double look_every; /* interval of time at which quiet steps are looked into [s]; 0: none are */
    double met_at;     /* where something was met there: steps up to it end there */
    int64_t steps, rejected, evaluations, jacobians;
    int32_t rank, rank_max, rank_min; /* of the constraints' Jacobian: at the beginning of the step, so far */
    double t_rank_min;
    int32_t slope_valid;    /* whether the slope at the present state is known */
    int32_t jacobian_valid; /* whether its derivatives are; they outlive a rejected step */
    /* Real time: the clock at the start, steps that began late, and by how much [s]. */
    double clock_start, late_max, late_sum;
    int64_t late_steps, paced_steps;
    /* Bending of the beams, each at the accepted state where its theory errs most: the estimated relative error, when,
     * and the elastic coordinates. The caller clears beam_error. */
    double loss_limit;         /* share of the largest kinetic energy that projections may take */
    double lost_energy, kinetic_energy; /* taken by projections; the largest so far [J] */
    double beam_limit;         /* error beyond which the run ends */
    const double *beam_scale;  /* 1/L of coordinates that are displacements, else 1 */
    const double *beam_reach;  /* largest angle per coordinate */
    double *beam_error, *beam_t, *beam_q;
    /* Of each beam the scaled elastic coordinates where it was evaluated last, then their weights in its norm; what follows
     * (n_beams): zeros at first, and where a beam's length changes. */
    double *beam_reference;
    sym_beam_guard *beam_guard;
    /* (nv) Changes of norms by coordinates; the way in these norms since beams were judged, of the last step, and up to which
     * none is to be judged. */
    double *beam_weight;
    double beam_way, beam_step_way, beam_margin;
    /* Axial loads of the beams, in states of the motion that are kept as those for the diagnosis are: the work of the
     * elastic stiffness (nv, nv) and of the tangent stiffness. NULL: nothing is known of them here. */
    const double *elastic_stiffness;
    double *beam_works;     /* (SYM_BEAM_STATES, n_beams, 2) */
    double *beam_change;    /* (nv + nc) scratch */
    int64_t beam_wait, beam_stride; /* steps until the next one is kept, and between two of them */
    int32_t beam_states;
    /* Records, row after row; full at capacity, which is n_grid at least. */
    int64_t capacity, n_records;
    double *record_t, *record_q, *record_v, *record_u;
    /* Ends of steps for the diagnosis: each diagnostic_stride-th and the last; thinned when full. Capacity 0: none. */
    int64_t diagnostic_capacity, n_diagnostic, diagnostic_stride;
    int32_t diagnostic_between; /* whether the last one kept lies between two strides */
    double *diagnostic_t, *diagnostic_q, *diagnostic_v, *diagnostic_u;
    int64_t event_capacity, n_event_records;
    double *event_t, *event_q, *event_v;
    int32_t *event_index;
    int32_t terminal_event; /* index of the event that ended the run */
    /* Actions of events; NULL: none. Where `acts` they are done on the way, else the run ends before them: sym_run_act. */
    const sym_actions *actions;
    int32_t acts;
    /* Finds the instants of formulas of time anew, by the parameters after actions that diagrams do. Not 0: that failed. */
    int32_t (*look_ahead)(void *data);
    void *look_data;
    double *par, *acted_at;        /* (npar) present parameters; (n_events + 1) when each event has acted last, and the begin */
    double *event_done;            /* (event_capacity, sym_done_size) */
    int64_t first_met, met_end;    /* rows of the events at which the run has been cut last: first, behind the last */
    double t_from;                 /* fixed steps end at multiples of h from there on, */
    int64_t n_from;                /* after so many steps */
    int32_t touched_event, unresolved_event; /* what sym_event_search noted first, and when; -1: nothing */
    double touched_t, unresolved_t;
} sym_run;

/* Settings that have a default in one place, whoever fills the rest. */
void sym_run_set_defaults(sym_run *run);
/* Doubles that sym_run.work must hold. */
size_t sym_run_work_size(const sym_run *run);
/* Point a call's inputs at the system's evaluation point, by their names. Returns 0 where one is unknown, or there are
 * too many inputs or outputs. */
int32_t sym_system_bind(sym_system *system, sym_call *call);
/* Evaluate the initial state and record it. Returns a status. */
int32_t sym_run_start(sym_run *run);
/* At most max_steps further steps, accepted or rejected. Returns a status. */
int32_t sym_run_advance(sym_run *run, int64_t max_steps);
/* Take the present state onto constraints that have just changed, a plastic impact (docs/theory/constraints.md, (31)); *gap: |phi|
 * by weight that this closes. Returns 0 or a status. */
int32_t sym_run_engage(sym_run *run, double *gap);
/* At the events at which the run has been cut: do their actions, one after the other. Returns 0, SYM_TERMINAL_EVENT where one
 * of them ends the run, or a status below 0, the state then being that before the action that failed. */
int32_t sym_run_act(sym_run *run);
/* Time within which strikes of coefficient e follow each other at t where they accumulate [s]. */
double sym_run_accumulation(const sym_run *run, double t, double e);
/* Parameters (npar) from now on, of a run with actions. */
void sym_run_set_parameters(sym_run *run, const double *par);
/* Doubles of a row of run->event_done, and where one's numbers are. */
size_t sym_done_size(const sym_run *run);
/* Doubles of sym_system's contact_work and contact_memory. */
size_t sym_contact_work_size(const sym_system *system);
size_t sym_contact_memory_size(const sym_system *system);
/* A motion begins in which balls of rigid contacts have neither struck nor slid: modes will be chosen. */
void sym_run_forget_contacts(sym_run *run);
sym_done sym_run_done(const sym_run *run, int64_t row);
/* Compare the present state's beams with the limit, and keep the largest error of each. Returns 0 or SYM_BEYOND_THEORY. */
int32_t sym_run_judge_beams(sym_run *run);
/* Judge beams in the present state that wait for the next step: the largest errors are complete then. */
void sym_run_settle_beams(sym_run *run);
/* Estimated error of a beam's theory, the largest so far, amplified by its axial loads. */
double sym_run_beam_error(sym_run *run, int32_t beam);
/* For external integrators, whose states are y = (q, v) with quaternions of any length; each returns a status. */
/* The present state becomes y, normalised, and the system's inputs those of that state. */
int32_t sym_run_set_state(sym_run *run, double t, const double *y);
/* Rate y' = (N v, v') of a state (nq + nv). */
int32_t sym_run_rate(sym_run *run, double t, const double *y, double *rate);
/* A step from t begins that may last until t1, or is over: held samples and jumps of formulas at t1 count after it only. */
void sym_run_begin_step(sym_run *run, double t, double t1);
void sym_run_end_step(sym_run *run);
/* The first instant after t, up to t1, at which a step has to end; t1 where there is none. */
double sym_run_next_stop(const sym_run *run, double t, double t1);
/* Instants (capacity) within a span at which steps have to end, in order. Returns how many, or -1 where they do not fit. */
int32_t sym_find_instants(const sym_instant_search *search, double t0, double t_end, double *instants);
/* Values of the events (n_events) at a state. */
int32_t sym_run_event_values(sym_run *run, double t, const double *y, double *values);
/* Tell the search the length h of a step [s], the largest way of a coordinate in it [rad or m], and its number. */
void sym_event_search_set_step(sym_event_search *search, double t, double h, double way, int64_t step);
/* Begin the search in one step, whose search->memory begins with the values at the end of the step before; the values at its
 * own end are row SYM_EVENT_NODES - 1 afterwards. Returns 0 or a status. */
int32_t sym_event_search_begin(sym_event_search *search);
/* The events in the order of time, one a call: which, and where; -1: there is none any more. Returns 0 or a status. */
int32_t sym_event_search_next(sym_event_search *search, int32_t *which, double *x);
/* Whether event i, not yet met up to x, has arrived at zero there by that value: within rounding, at the same time. */
int32_t sym_event_is_met(const sym_event_search *search, int32_t i, double x, double value);
/* Rate N(q) w (nq) at the evaluation point, which is at the same configuration q. */
void sym_run_configuration_rate(const sym_run *run, const double *q, const double *w, double *rate);
/* Linearise the motion about the present state in the subspace of the first directions that the motion excites, by
 * differences of the size of a step of length h. moving (nv): 0 at speeds that are states of forces or blocks, which have
 * scales of their own, 2 at rotations, which turn by little however far bodies fly, 1 at others; basis: (dimension + 5, 2 nv), of which the first rows become an orthonormal basis of changes
 * (theta, h v); matrix (dimension, dimension): h times the derivative in that basis; motion (dimension): components of the
 * motion of one step. Returns the number of directions, at most `dimension` <= 2 nv, or a status below 0. */
int32_t sym_run_spectrum(sym_run *run, double h, const int32_t *moving, int32_t dimension, double *basis, double *matrix,
                         double *motion);
/* Inputs u (n, nu) and accelerations a (n, nv) at n states of the motion, each projected first where the run projects; NaN
 * where there are none. Returns 0, or SYM_CALLBACK_FAILED. */
int32_t sym_run_accelerations(sym_run *run, int64_t n, const double *t, const double *q, const double *v, double *u,
                              double *a);
/* States at shares x (m) of intervals, by their numbers (m), between states t (n), q, v of the motion with accelerations a
 * (n, nv): their times t_x (m), q_x, v_x, and accelerations a_x (m, nv) of the cubics through the ends; work: 3 nv doubles. */
void sym_run_path(const sym_run *run, const double *t, const double *q, const double *v, const double *a, int64_t m,
                  const int64_t *interval, const double *x, double *work, double *t_x, double *q_x, double *v_x, double *a_x);
/* cdef end */

#endif
