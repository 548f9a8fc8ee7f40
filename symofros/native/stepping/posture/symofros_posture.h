/* symofros_posture.h - postures at which frames are where they are wanted (docs/theory/constraints.md, section 9).
 * Written by hand; C99. The caller owns every array.
 */
#ifndef SYMOFROS_POSTURE_H
#define SYMOFROS_POSTURE_H

#include "symofros_stepper.h"

/* cdef begin: what bindings read */
/* Starts of one round; drawn ends that are kept; numbers of a wanted pose: p (3), R (3, 3). */
typedef enum sym_posture_sizes { SYM_POSTURE_ROUND = 8, SYM_POSTURE_KEPT = 2, SYM_POSTURE_POSE = 12 } sym_posture_sizes;

/* What a speed is of: the numbers of symofros/base/measures.py. */
typedef enum sym_speed_kind { SYM_SPEED_TRANSLATION = 0, SYM_SPEED_ROTATION = 1, SYM_SPEED_OTHER = 2 } sym_speed_kind;

typedef struct sym_target { /* a frame that is wanted somewhere */
    int32_t position, rotation; /* whether its position and its rotation are */
    sym_call pose, jacobian;    /* p, R; J (6, nv) */
} sym_target;

/* A search for a posture: targets e_t and conditions phi are rows of one residual e = (e_t; phi), m in all. */
typedef struct sym_posture {
    /* By the caller. */
    sym_system *system;         /* sizes, segments, evaluation point, constraint_jacobian */
    sym_call constraint;        /* phi */
    int32_t n_targets, n_conditions;
    sym_target *targets;
    const int32_t *conditions;  /* (n_conditions) rows of phi that bind coordinates */
    const double *wanted;       /* (n_targets, SYM_POSTURE_POSE) */
    const int32_t *free;        /* (nv) whether a speed may be used */
    const int32_t *kind;        /* (nv) sym_speed_kind */
    const int32_t *periodic;    /* (nq) whether a coordinate is an angle */
    const double *lower, *upper; /* (nq) limits, of coordinates whose rates are speeds */
    const double *draws;        /* (n_draws, nv) of drawn starts: shares of windows; rotation vectors */
    int32_t n_draws;
    double tolerance, closed;   /* largest errors of targets and of conditions that count as met */
    /* Results; q is the start beforehand. */
    double *q;                  /* (nq) */
    int32_t met;
    int64_t steps, starts;      /* taken, and followed, so far */
    double error, gap;          /* largest error of targets, of conditions */
    /* By sym_posture_start. */
    int32_t m, wishes;          /* rows; those of targets, which come first */
    int32_t n_kept;
    double *kept, *kept_square; /* (SYM_POSTURE_KEPT, nq), (SYM_POSTURE_KEPT): drawn ends that miss by least */
    double *round;              /* (SYM_POSTURE_ROUND, nq): ends of the present round */
    double *round_met;          /* (SYM_POSTURE_ROUND): not 0: it is a solution */
    double *low, *high;         /* (nv) windows that starts are drawn in */
    double *e, *e_tried, *J, *A, *y;
    double *wish, *step, *theta, *tried, *movable, *depends;
    int32_t n_packed, *columns; /* columns of J that may move and are not zero: their number and indices, */
    double *packed;             /* and (m, n_packed) they themselves */
} sym_posture;

/* Many searches with the same targets' frames. */
typedef struct sym_posture_batch {
    size_t wanted_stride, guess_stride; /* doubles from one search's to the next's; 0: one for all */
    const double *wanted, *guess;
    int32_t most, most_drawn;   /* steps from a guess, from a drawn start */
    int32_t n_starts;           /* most starts of one search */
    double *q, *error, *gap;    /* (n, nq), (n), (n) */
    int32_t *met;               /* (n) */
    int64_t *steps, *starts;    /* (n) */
} sym_posture_batch;

/* Poses (n, SYM_POSTURE_POSE) as wanted ones: finite, their matrices the rotations nearest to them. Returns the number of the
 * first, from `first` on, that is not finite or whose matrix misses a rotation by more than `most` in the Frobenius norm of
 * R^T R - 1; n where there is none. */
int64_t sym_posture_poses(int64_t first, int64_t n, double most, double *poses);
/* Doubles of memory that a search needs. */
size_t sym_posture_size(sym_posture *p);
/* Lay it out. */
void sym_posture_start(sym_posture *p, double *memory);
/* e (m) at a configuration (nq), and J (m, nv), with e' = -J v; J may be NULL. */
void sym_posture_residual(sym_posture *p, const double *q, double *e, double *J);
/* Damped least squares from q, at most so many steps: p->q, met, error, gap. */
int32_t sym_posture_descend(sym_posture *p, int32_t most);
/* q (nq) with free coordinates moved to their limits where they are beyond them. */
void sym_posture_limit(const sym_posture *p, double *q);
/* Windows about a guess within the limits, for the drawn starts that follow. Returns 0 where no speed is of use. */
int32_t sym_posture_windows(sym_posture *p, const double *guess);
/* A round of n starts from number `first` on: p->round, p->round_met. */
void sym_posture_round(sym_posture *p, const double *guess, int32_t first, int32_t n, int32_t most);
/* p->q <- the solution of that round that is nearest to a configuration, angles turned towards the guess; returns whether
 * there is one. */
int32_t sym_posture_nearest(sym_posture *p, const double *guess, const double *near, int32_t n);
/* Rounds until one has a solution, from start `first` to `end`: p->q. */
int32_t sym_posture_again(sym_posture *p, const double *guess, const double *near, int32_t first, int32_t end, int32_t most);
/* Searches `first` to `end` of a batch. */
void sym_posture_batch_run(sym_posture *p, const sym_posture_batch *batch, int64_t first, int64_t end);
/* cdef end */

#endif
