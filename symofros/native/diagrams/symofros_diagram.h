/* symofros_diagram.h - the integration of a block diagram: parts that move independently between instants, and tasks that
 * are executed at those. Written by hand; C99. The caller owns every array. */
#ifndef SYMOFROS_DIAGRAM_H
#define SYMOFROS_DIAGRAM_H

#include "symofros_stepper.h"

/* cdef begin: what bindings read */
typedef struct sym_task { /* a function that is evaluated at the diagram's point */
    sym_call call;
    int32_t callback; /* the caller's block that takes the output; -1: the outputs are the new u (and q, v) */
} sym_task;

typedef struct sym_task_set { /* what is due at one instant */
    int32_t n, records;       /* number of tasks; whether the instant is recorded */
    const sym_task *tasks;
} sym_task_set;

typedef struct sym_kept { /* a parameter that actions of events change, which tasks read as memory */
    int32_t part, par, input; /* whose; its index in par of the parts, in u */
    int32_t from;             /* index in par of what it begins with */
} sym_kept;

typedef struct sym_diagram {
    int32_t n_parts, n_signals, n_crossings;
    int32_t reads_accelerations; /* whether tasks read a and lam */
    int32_t nq, nv, nu, nc;
    sym_run **parts;
    const int32_t *q_offset, *v_offset, *c_offset; /* (n_parts) first index of each part's q, v, lam */
    const sym_signal *signals;
    int32_t n_locks;
    const int32_t *lock_inputs; /* (n_locks) entries of u that engage constraints: a change projects the parts */
    double *lock_values;        /* (n_locks) their last values */
    int32_t engaged;            /* the lock that engaged last, -1: none */
    int32_t n_kept;
    const sym_kept *kept;       /* (n_kept) */
    double engaged_gap, engaged_t; /* largest |phi| by weight that engaging has closed, and when; of the last, if it failed */
    /* The point at which tasks are evaluated. */
    double *q, *v, *u, *t, *a, *lam;
    /* Instants: t0 + ticks of base_numerator / base_denominator seconds, the same in each cycle. */
    double t0, t_end, base_numerator, base_denominator;
    int64_t cycle_ticks, n_instants;
    const int64_t *instant_tick; /* (n_instants) ticks from the start of a cycle */
    const int32_t *instant_set;  /* (n_instants) index of the set that is due */
    const sym_task_set *task_sets;
    const sym_task *crossing_tasks; /* (n_crossings) executed where an event of that index ends a part's motion; those
                                     * after them are events of mechanisms */
    const sym_task *begin_task; /* executed once, after the first instant if that is at t0; NULL: none */
    /* A block of the caller's at an instant: reads its inputs, writes its outputs into u; not 0 stops the run. */
    int32_t (*callback)(void *data, int32_t block, double t, const double *inputs, double *u);
    void *data;
    /* Progress: cycles done, and the index of the next instant in the cycle. */
    int64_t cycle, next_instant;
    int32_t finished, begun;
    int32_t stops; /* at the present instant */
    int32_t failed_part; /* whose integration ended the run */
    int64_t steps, rejected, evaluations;
    /* Records, row after row. Events are recorded by their parts. */
    int64_t capacity, n_records;
    double *record_t, *record_q, *record_v, *record_u;
    /* Real time: seconds of clock per second of simulated time, 0: as fast as possible; how late instants began [s]. */
    double realtime_scale, clock_start;
    int64_t lateness_capacity, n_lateness;
    double *lateness;
    /* Advances the parts by several threads; NULL: one after the other (thread_pool.c). */
    int32_t (*advance_parallel)(struct sym_diagram *diagram, double t);
    struct sym_thread_pool *pool;
    int32_t before_end; /* whether instants of t_end are left to the next call */
} sym_diagram;

/* Point a call's inputs at the diagram's point. Returns 0 where one is unknown. */
int32_t sym_diagram_bind(sym_diagram *diagram, sym_call *call);
/* The first instant; the parts have been started. Returns a status. */
int32_t sym_diagram_start(sym_diagram *diagram);
/* At most that many instants further. Returns a status of symofros_stepper.h. */
int32_t sym_diagram_advance(sym_diagram *diagram, int64_t instants);
/* Let threads share the parts; returns 0 where none can be started. */
int32_t sym_diagram_start_threads(sym_diagram *diagram, int32_t threads);
void sym_diagram_stop_threads(sym_diagram *diagram);
/* cdef end */

#endif
