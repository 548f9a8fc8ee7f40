/* symofros_batch.h - many trajectories of one model, some of them active at a time. Written by hand; C99.
 *
 * Active trajectories step together, each by its own step size; the accelerations at one stage of all of them are one
 * call of the model's batch function, by vectors. A trajectory that ends frees its slot for the next. Apart from that call
 * everything is the code of a single run (run.c), so that no trajectory depends on the others; where steps are simple, all of
 * a step is done by vectors, with the same numbers (batch_columns.c).
 */
#ifndef SYMOFROS_BATCH_H
#define SYMOFROS_BATCH_H

#include "symofros_stepper.h"

/* cdef begin: what bindings read */
typedef struct sym_batch_rows { /* one row per trajectory */
    const double *at;
    int64_t stride; /* doubles from one row to the next; 0: one row for all */
} sym_batch_rows;

typedef struct sym_batch_function { /* a model function that is evaluated for all active trajectories at once */
    const sym_function *function; /* NULL: absent, or evaluated one by one */
    const sym_lanes *lanes;       /* the same by vectors of doubles, for steps by columns; NULL: steps by rows alone */
    sym_batch_rows pre;           /* the parameters' part, of all trajectories */
    /* By sym_batch_start: memory, and where the inputs of all slots lie. */
    double *pre_active; /* (slots, npre) where trajectories have parameters of their own */
    double *work;
    const double *in[SYM_MAX_INPUTS];
    size_t in_stride[SYM_MAX_INPUTS];
    double *out[SYM_MAX_OUTPUTS]; /* (slots, ...) each */
    sym_strided column_in[SYM_MAX_INPUTS], column_out[SYM_MAX_OUTPUTS]; /* the same by columns, (..., slots) each */
    int32_t column_v;             /* number of the input v; -1: none */
    double *column_work;
} sym_batch_function;

typedef struct sym_ahead { /* what is known ahead of the formulas of time of one trajectory, as in sym_system */
    double begin, known; /* the span for which it is [s] */
    int32_t n_stops, n_event_instants;
    const double *stops, *event_instants;
} sym_ahead;

typedef struct sym_batch {
    /* By the caller. */
    /* Settings, and the system of a single run, which only this batch uses; its table of events holds those that were met. */
    sym_run *prototype;
    sym_batch_function forward_dynamics, law, project, events, contact_state;
    int64_t *event_trajectory; /* (event_capacity of the prototype) whose event each row is */
    double *par, *acted_at;    /* (n, npar), (n, n_events + 1) of trajectories whose events have actions */
    int32_t *event_terminal;   /* (n, n_events) */
    double *contact_memory;    /* (n, sym_contact_memory_size) */
    int32_t slots;            /* most trajectories active at once; 2 at least */
    sym_batch_rows q0, v0, u_constant; /* initial states and constant inputs of all trajectories */
    const double *t0;         /* (n) first times; NULL: that of the prototype for all */
    const int64_t *signal_stride; /* (n_signals) doubles from the samples of one trajectory to those of the next */
    int64_t next, stride, n;  /* trajectories of this batch: next, next + stride, ... below n */
    int64_t max_steps;        /* of each trajectory; 0: any number */
    sym_ahead *ahead;         /* (n); NULL: the instants of the prototype are those of all trajectories, to the end */
    /* Finds those of a trajectory from time t on, by its present parameters. Returns 0, or another number where that failed. */
    int32_t (*look_ahead)(void *data, int64_t trajectory, double t);
    void *data;
    /* Results, one row per trajectory: final status, time, state; steps; what the prototype's grid records. */
    int32_t *final_status;    /* below zero beforehand: the trajectory can't start */
    double *final_t, *final_q, *final_v;
    int64_t *steps, *rejected;
    double *record_q, *record_v, *record_u;
    double *beam_error, *beam_t, *beam_q, *beam_reference, *beam_weight; /* of each trajectory, as in sym_run */
    sym_beam_guard *beam_guard;
    sym_batch_rows beam_scale, beam_reach;
    int64_t n_beam_coordinates; /* of all beams */
    /* By sym_batch_start: the slots. The active trajectories occupy the first ones. */
    int32_t n_active;
    int64_t left;                 /* steps that are left of those asked for */
    double *event_values;         /* (slots, SYM_EVENT_ROWS, n_events) */
    int32_t *held;                /* (slots, n_sticking) */
    sym_system *systems;          /* (slots) */
    sym_run *runs;                /* (slots) */
    sym_signal *signals;          /* (slots, n_signals) */
    int64_t *trajectory_of_slot;  /* (slots) */
    int32_t *status;              /* (slots) of the present step */
    double *h, *t1;               /* (slots) length of the present step, time at its end */
    double *q, *v, *u, *t;        /* (slots, ...) evaluation points; constant inputs are there from a trajectory's start on */
    double *states;               /* (slots, nq + nv) present states of the runs */
    /* Working memory as in a single run, with m = 2 nv entries of y: (slots, m), slopes k (dense_stages, slots, m).
     * Row by row: y0 = (0, v), and the step length m times, so that sums of stages are loops over all slots. */
    double *y1, *stage, *magnitude, *end_slope, *k, *y0, *length;
    double *end_state, *unseen; /* (nq + nv), (3 nv) while one slot accepts its step */
    double *defects;   /* of the inputs while one slot proposes its step: input_moments.c */
    /* Steps by columns: number k of slot i is entry (k, i) of (size, slots). */
    int32_t in_columns; /* whether `states` is (nq + nv, slots), and times and numbers of steps are not in the runs but here: */
    int32_t n_begun;    /* number of slots whose first slope is known */
    double *column_t, *column_t0, *column_steps, *column_record, *column_u; /* (slots) each, time of the next record; (nu, slots) */
    double *column_slope, *lost; /* (nv, slots) first accelerations that are known; (slots) not zero: a number is none */
} sym_batch;

/* Doubles of memory that the slots take; *shared: those of them that hold nothing between two calls, so that batches of one
 * thread may share them. */
size_t sym_batch_size(const sym_batch *batch, size_t *shared);
/* Lay the slots out in memory, none of them active. Returns 0 where a function asks for an unknown input. */
int32_t sym_batch_start(sym_batch *batch, double *memory, double *shared);
/* At most max_steps further steps of each active trajectory. Returns 0 when all trajectories have ended, SYM_RECORDS_FULL
 * where events have to be taken, batch->left steps before the end. */
int32_t sym_batch_advance(sym_batch *batch, int64_t max_steps);
/* End all active trajectories where they are, and the others at their initial states. */
void sym_batch_stop(sym_batch *batch);
/* cdef end */

#endif
