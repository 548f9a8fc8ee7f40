/* symofros_hand.h - a run that its caller steps by hand: inputs held over each step. Written by hand; C99.
 *
 * The steps are those of run.c; what is kept here is who gives the inputs, and how far a call goes. Inputs are noted where
 * they change, so that the run can be made once more.
 */
#ifndef SYMOFROS_HAND_H
#define SYMOFROS_HAND_H

#include "symofros_batch.h"

/* cdef begin: what bindings read */
typedef struct sym_hand {
    sym_run *run;
    int32_t status;        /* SYM_RUNNING, or why no step is made any more */
    int32_t started;       /* 0: the next call is the first; sym_run_start comes before it */
    int32_t n_held;
    const int32_t *held;   /* (n_held) indices in u of the inputs that the caller gives */
    double *u;             /* (nu) the system's u_constant */
    double dt;             /* time between two marks, at which calls end [s]; fixed steps are of that length */
    int64_t mark, target;  /* number of the mark that was reached last, and of the one to reach */
    int64_t capacity, n;   /* of what is noted: less than capacity between two calls */
    double *noted_t, *noted_u; /* (capacity), (capacity, nu): u from then on */
} sym_hand;

/* Hold inputs u (n_held) from now on, those before if NULL, and make so many steps. Returns SYM_RUNNING where they are made;
 * SYM_RECORDS_FULL where events or notes have to be taken, before sym_hand_go_on; SYM_CALLBACK_FAILED, with nothing done,
 * where an input is not finite or the status is not SYM_RUNNING; else a status that ends the run. */
int32_t sym_hand_step(sym_hand *hand, const double *u, int64_t steps);
/* The steps that are left. */
int32_t sym_hand_go_on(sym_hand *hand);

typedef struct sym_hand_batch { /* trajectories that go on together, one thread's part of them */
    sym_batch *groups;     /* (n_groups) as many slots as trajectories each */
    int32_t n_groups;
    int32_t n_held;
    const int32_t *held;   /* (n_held) as in sym_hand */
    int64_t first, n;      /* trajectories: first, first + 1, ... below n */
    double *u;             /* (all trajectories, nu) u_constant of the groups */
    int32_t *begins;       /* (all trajectories) whether it begins at the next step, at q0, v0, t0 of the groups */
    int32_t group;         /* the one that steps; n_groups: none */
    int32_t begun;         /* whether it has taken inputs, and its trajectories have begun */
    int64_t first_of_group, steps;
} sym_hand_batch;

/* Hold inputs u (all trajectories, n_held) from now on, those before if NULL, and make so many steps of each trajectory that
 * can go on; then its t, q, v, status are where the groups have their results. Returns 0, or SYM_RECORDS_FULL where events
 * have to be taken before sym_hand_batch_go_on. */
int32_t sym_hand_batch_step(sym_hand_batch *hand, const double *u, int64_t steps);
/* The steps that are left. */
int32_t sym_hand_batch_go_on(sym_hand_batch *hand, const double *u);
/* cdef end */

#endif
