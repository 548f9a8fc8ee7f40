/* symofros_crew.h - many trajectories of one model, a few of them in hand at a time. Written by hand; C99.
 *
 * Those in hand step together: each makes its own step of its own length, and the accelerations at one stage of all of
 * them are one call of the model's batch function, by vectors. Whoever is done makes room for the next. Apart from that
 * call everything is the code of a single run (run.c), so that a trajectory does not depend on its company.
 */
#ifndef SYMOFROS_CREW_H
#define SYMOFROS_CREW_H

#include "symofros_stepper.h"

/* cdef begin: what bindings read */
typedef struct sym_rows { /* one row a trajectory */
    const double *at;
    int64_t stride; /* doubles from one to the next; 0: one for all */
} sym_rows;

typedef struct sym_many { /* a function of the model, evaluated for all in hand at once */
    const sym_function *function; /* NULL: absent, or evaluated one by one */
    double *work;
    sym_rows pre;     /* the parameters' part of all trajectories */
    double *pre_here; /* (slots, npre) of those in hand; NULL where they are never evaluated together */
    double *out[8];   /* (slots, ...) each */
} sym_many;

typedef struct sym_crew {
    const sym_run *like;        /* settings, and the scene of a single run, which only this crew uses */
    sym_many forward, law, project;
    int32_t slots;              /* trajectories in hand at once, 2 at least */
    int32_t in_hand;            /* they fill the first slots */
    sym_scene *scenes;          /* (slots) */
    sym_run *runs;              /* (slots) */
    sym_signal *signals;        /* (slots, n_signals) */
    int64_t *whose;             /* (slots) which trajectory a slot holds */
    double *step, *end;         /* (slots) length of the present step, time at its end */
    int32_t *status;            /* (slots) how it fares */
    double *states;             /* (slots, nq + nv) present states of the runs */
    /* Their work, n = 2 nv: as in a single run, but for slopes (dense_stages, slots, n); (0, v), and n times the length
     * of the step, so that the sums of stages are loops over all. */
    double *y1, *stage, *size, *dense, *k, *base, *length;
    double *q, *v, *u, *t;      /* (slots, ...) the points at which functions are evaluated */
    sym_rows q0, v0, constant;  /* first states and constant inputs of all trajectories */
    const int64_t *signal_stride; /* (n_signals) doubles from the samples of one trajectory to those of the next */
    int64_t next, by, n;        /* this crew's trajectories: next, next + by, ... below n */
    int64_t max_steps;          /* of each; 0: any number */
    /* Results, a row a trajectory: how it ended, when and where; and what `like` records at its grid. */
    int32_t *ended;             /* below zero beforehand: it can't begin */
    double *last_t, *last_q, *last_v;
    int64_t *steps, *rejected;
    double *record_q, *record_v, *record_u;
} sym_crew;

/* Slots laid out, empty. */
void sym_crew_start(sym_crew *crew);
/* So many steps of each trajectory in hand. Returns 0 when all trajectories are done. */
int32_t sym_crew_advance(sym_crew *crew, int64_t rounds);
/* Put down what is in hand, as it is; what has not begun stays at its start. */
void sym_crew_stop(sym_crew *crew);
/* cdef end */

#endif
