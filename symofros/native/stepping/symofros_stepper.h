/* symofros_stepper.h - stepping a SYMOFROS model through time. Written by hand; C99.
 *
 * A state is (q, v). Within a step it is held as y = (theta, v): theta are coordinates of the configuration manifold
 * about the q at which the step began, so that quaternions stay of unit length and every method is one of plain
 * vectors (docs/theory/simulation.md). Nothing here allocates: the caller owns every array.
 */
#ifndef SYMOFROS_STEPPER_H
#define SYMOFROS_STEPPER_H

#include "symofros_model.h"

/* cdef begin: what bindings read */
typedef struct sym_segment {
    int32_t kind;       /* 0 linear, 1 quaternion, 2 pose */
    int32_t q, v, size; /* first indices in q and v; number of coordinates of a linear segment */
} sym_segment;

typedef struct sym_signal { /* one input, sampled over time */
    int32_t input;          /* index in u */
    int32_t linear;         /* 1: straight lines between samples; 0: held until the next */
    int32_t n;
    const double *t, *value;
} sym_signal;

typedef struct sym_call { /* a function of a model, bound to the point it is evaluated at */
    const sym_function *function; /* NULL: absent */
    const double *pre;
    double *work;
    const double *in[10];
    double *out[8];
} sym_call;

typedef struct sym_tableau { /* a Runge-Kutta method */
    int32_t stages;          /* of a step and its error estimate */
    int32_t dense_stages;    /* the same and those that dense output adds */
    int32_t last;            /* the stage at the end of the step, whose slope the next step starts with; 0: none */
    int32_t error_order;     /* of the embedded solution */
    int32_t errors;          /* 0: no estimate, 1: e, 2: e and e2 combined as DOP853 does */
    int32_t degree;          /* of the dense output's polynomial; 0: cubic through the ends */
    const double *a;         /* (dense_stages, dense_stages), lower triangle */
    const double *b, *c;     /* (dense_stages) */
    const double *e, *e2;    /* (stages) */
    const double *dense;     /* (dense_stages, degree): coefficient of x^(j+1) for each stage */
    /* Of a Rosenbrock method, in whose terms a, b and e weigh the solutions of the stages' linear systems: */
    double gamma;
    const double *coupling;  /* (stages, stages) of earlier solutions, over h */
    const double *d;         /* (stages) of the derivative by time */
} sym_tableau;

typedef struct sym_scene {
    int32_t nq, nv, nu, nc, n_segments, n_signals, n_law, n_events;
    const sym_segment *segments;
    const sym_signal *signals;
    const int32_t *law_inputs;      /* (n_law) which inputs the law gives */
    const int32_t *event_direction; /* (n_events) 1 rising, -1 falling, 0 both */
    const int32_t *event_terminal;
    const double *constant;         /* (nu) inputs that nothing else gives */
    /* Inputs by a caller's function; not 0 stops the run. NULL: none. */
    int32_t (*callback)(void *data, double t, const double *q, const double *v, double *u);
    void *data;
    sym_call forward, law, events, project, terms, residual, momentum;
    const int32_t *on_speeds; /* (nc) whether a constraint binds speeds only */
    /* Where calls are evaluated: their inputs and outputs point here. */
    double *q, *v, *u, *t, *gains, *a, *lam, *rank;
} sym_scene;

typedef struct sym_run {
    sym_scene *scene;
    int32_t method;    /* SYM_METHOD_... */
    int32_t adaptive;
    int32_t project;   /* 1: back to the constraints after each step */
    int32_t every;     /* record each so many steps; 0: at `grid` only */
    sym_tableau tableau;
    double t0, t_end, h, rtol, atol, h_max;
    double rho;        /* generalised alpha: spectral radius at infinite frequency */
    double tolerance;  /* of the equations of an implicit step, relative */
    double pace;       /* seconds of clock a second of motion; 0: as fast as can be */
    const double *grid;
    int64_t n_grid, at_grid;
    /* The present state, and how the run fares. */
    double t, *q, *v;  /* (nq), (nv) */
    double *y;         /* work, sym_work_size doubles */
    int32_t *pivots;   /* 2 (nv + nc) */
    double *event;     /* 3 n_events: values at the present state, and work */
    double h_next, error_last;
    int64_t steps, rejected, evaluations, jacobians;
    int32_t rank_max, rank_min;
    double t_rank;     /* when the rank was lowest */
    int32_t fresh;     /* whether the slope at the present state is known */
    int32_t linear;    /* whether its derivatives are, which a rejected step leaves as they are */
    /* Pacing: the clock at the start, steps that came late, and by how much [s]. */
    double clock0, late_max, late_sum;
    int64_t late_steps, paced_steps;
    /* Records: row after row; full at capacity, which is n_grid at least. */
    int64_t capacity, n_records;
    double *record_t, *record_q, *record_v, *record_u;
    int64_t event_capacity, n_found;
    double *found_t, *found_q, *found_v;
    int32_t *found_which;
    int32_t stopped_by; /* the event that ended the run */
} sym_run;

/* Doubles that sym_run.y must hold. */
size_t sym_work_size(const sym_run *run);
/* Bind a call's inputs and outputs to the scene by their names; 0 where a name is unknown. */
int32_t sym_bind(sym_scene *scene, sym_call *call);
/* Evaluate the start; record it. Returns a status. */
int32_t sym_start(sym_run *run);
/* Go on for at most max_steps accepted or rejected steps. Returns a status. */
int32_t sym_advance(sym_run *run, int64_t max_steps);
/* For external integrators, whose states are y = (q, v). */
void sym_flat_rate(const sym_run *run, const double *q, const double *w, double *rate);
int32_t sym_flat_slope(sym_run *run, double t, const double *y, double *rate);
int32_t sym_flat_events(sym_run *run, double t, const double *y, double *values);
int32_t sym_flat_place(sym_run *run, double t, const double *y);
/* cdef end */

enum {
    SYM_GOING = 0,      /* max_steps are done */
    SYM_DONE = 1,       /* t_end is reached */
    SYM_FULL = 2,       /* the records are full: empty them, go on */
    SYM_EVENT = 3,      /* a terminal event */
    SYM_DIVERGED = -1,  /* a state or an acceleration is not finite */
    SYM_NO_MOTION = -2, /* no acceleration exists: singular beyond what constraints bind */
    SYM_TINY_STEP = -3, /* the error bound asks for steps below rounding */
    SYM_CALLBACK = -4,  /* the caller's function failed */
    SYM_NO_CONVERGENCE = -5, /* the equations of an implicit step were not solved */
    SYM_OFF = -6        /* the constraints could not be met again */
};

enum {
    SYM_METHOD_EXPLICIT = 0,
    SYM_METHOD_SEMI_IMPLICIT = 1,
    SYM_METHOD_ROSENBROCK = 2,
    SYM_METHOD_ALPHA = 3,
    SYM_METHOD_VARIATIONAL = 4
};

#endif
