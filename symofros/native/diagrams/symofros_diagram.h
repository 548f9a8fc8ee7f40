/* symofros_diagram.h - a diagram in time: parts that move by themselves between instants, and what happens at those.
 * Written by hand; C99. The caller owns every array.
 */
#ifndef SYMOFROS_DIAGRAM_H
#define SYMOFROS_DIAGRAM_H

#include "symofros_stepper.h"

/* cdef begin: what bindings read */
typedef struct sym_stage {
    sym_call call;    /* evaluated at the diagram's point */
    int32_t opaque;   /* the caller's block that hears its output; -1: its outputs are the new u (and q, v) */
} sym_stage;

typedef struct sym_instant { /* what is due together */
    int32_t n, records;      /* stages; whether the instant is recorded */
    const sym_stage *stages;
} sym_instant;

typedef struct sym_diagram {
    int32_t n_parts, n_signals, n_crossings, looks_back;
    int32_t nq, nv, nu, nc;
    sym_run **parts;
    const int32_t *q_at, *v_at, *c_at;  /* where each part's q, v, lam lie */
    const sym_signal *signals;
    int32_t n_engaging;
    const int32_t *engaging;  /* entries of u whose change takes the parts onto their constraints */
    double *engaged;          /* (n_engaging) what they were */
    /* The point at which stages are evaluated, and what they leave. */
    double *q, *v, *u, *t, *a, *lam;
    /* Instants: multiples k of base_n / base_d seconds after t0, alike in each cycle. */
    double t0, t_end, base_n, base_d;
    int64_t cycle, n_instants;
    const int64_t *instant;
    const int32_t *set;
    const sym_instant *sets;
    const sym_stage *crossings;
    /* A caller's block at an instant: reads what it hears, writes its outputs into u; not 0 stops the run. */
    int32_t (*opaque)(void *data, int32_t which, double t, const double *heard, double *u);
    void *data;
    /* The present: which instant is next, and whether it lies ahead or is due now. */
    int64_t round, at;
    int32_t ended, failed; /* the part whose motion ended the run */
    int64_t steps, rejected, evaluations;
    /* Records, row after row. */
    int64_t capacity, n_records;
    double *record_t, *record_q, *record_v, *record_u;
    int64_t found_capacity, n_found;
    double *found_t;
    int32_t *found_which;
    /* Keeping pace: seconds of clock a second of motion, 0: as fast as can be; how late each instant began [s]. */
    double pace, clock0;
    int64_t late_capacity, n_late;
    double *late;
    /* Threads that share the parts; NULL: none. */
    struct sym_gang *gang;
} sym_diagram;

/* The first instant; the parts have been started. Returns a status. */
int32_t sym_diagram_start(sym_diagram *d);
/* At most so many instants further. Returns a status of symofros_stepper.h. */
int32_t sym_diagram_advance(sym_diagram *d, int64_t instants);
/* Bind a stage's inputs to the diagram's point; 0 where a name is unknown. */
int32_t sym_diagram_bind(sym_diagram *d, sym_call *call);
/* Let so many threads share the parts; 0 where there are no threads to be had. */
int32_t sym_diagram_hire(sym_diagram *d, int32_t threads);
void sym_diagram_dismiss(sym_diagram *d);
/* cdef end */

#endif
