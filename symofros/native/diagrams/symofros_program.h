/* symofros_program.h - an exported block diagram: generated constants, and memory that the caller owns. Written by hand;
 * C99.
 *
 *     void *memory = malloc(sym_program_size(square_program()));
 *     sym_program_instance *square = sym_program_init(memory, size, square_program());
 *     square->inputs[SQUARE_IN_GOAL] = 1.0;          // what enters holds until it is set anew
 *     status = sym_program_advance(square, 0.001);   // square->signals are those of that time
 *
 * After sym_program_init nothing allocates; a copy of the memory, put back in its place, is the program as it was. Set
 * square->par and call sym_program_prepare to change parameters; those that actions of events change, by sym_program_set. The header of a program names the entries of its arrays.
 */
#ifndef SYMOFROS_PROGRAM_H
#define SYMOFROS_PROGRAM_H

#include "symofros_diagram.h"
#include "symofros_instance.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sym_program {
    const char *name;
    const sym_model *(*instants)(void);           /* functions due_i, crossed_i, signals */
    int32_t n_parts;
    const sym_plant *(*const *parts)(void);
    const int32_t *q_offset, *v_offset, *c_offset; /* (n_parts) first index of each part's q, v, lam */
    const double *u_start;
    int32_t n_signals, n_locks, n_crossings, reads_accelerations;
    const sym_signal *signals;                    /* inputs by samples over time */
    const int32_t *lock_inputs;                   /* (n_locks) entries of u that engage constraints */
    double base_numerator, base_denominator;      /* instants: multiples of this fraction of a second */
    int64_t cycle_ticks, n_instants;
    const int64_t *instant_tick;                  /* (n_instants) from the start of a cycle */
    const int32_t *instant_set;                   /* (n_instants) index of the set that is due */
    int32_t n_sets, n_outputs;
    const char *const *set_functions;             /* (n_sets) name of each set's function */
    const char *const *output_names;              /* (n_outputs) names of the entries of `signals` */
    const char *const *output_units;              /* (n_outputs) "" for none */
    int32_t n_inputs;
    const char *const *input_names, *const *input_units; /* (n_inputs) of the entries of `inputs` */
    int32_t n_kept;
    const sym_kept *kept;                         /* (n_kept) parameters that actions of events change */
} sym_program;

typedef struct sym_program_instance {
    const sym_program *program;
    sym_diagram diagram;
    sym_instance **parts;
    double *par;        /* (npar) */
    double *pre, *work; /* of the instants' model: what depends on parameters alone, and scratch */
    double *signals;    /* (n_outputs) at the present time */
    sym_task *tasks, *crossing_tasks, begin_task;
    sym_task_set *task_sets;
    sym_call outputs;
    double *inputs;     /* (n_inputs) what enters; set them before sym_program_advance, which holds them */
} sym_program_instance;

/* Bytes that an instance needs, aligned as doubles and pointers are. */
size_t sym_program_size(const sym_program *program);
/* An instance in that memory, at its start; NULL where the memory is too small, or an initial state can't be projected onto
 * the constraints. */
sym_program_instance *sym_program_init(void *memory, size_t size, const sym_program *program);
/* Evaluate what depends on parameters alone; those that events of mechanisms set begin with what `par` says, and are memory
 * from then on, which sym_program_set sets. Returns 0, or SYM_PARAMETERS_REFUSED where they violate a condition of a
 * model's description: nothing moves then (a part's check_parameters = 0 takes them as they come). */
int32_t sym_program_prepare(sym_program_instance *instance);
/* The condition of a description that parameters violate, in words; NULL where they violate none. */
const char *sym_program_refused(const sym_program_instance *instance);
/* Integrate to time t, executing instants on the way, that of t included: blocks sampled there read the inputs as they are
 * now, and sym_program_advance(instance, 0.0) executes those of the start. Steps end where formulas of time bend, jump or
 * change fast. Events of mechanisms act on the way; those of the call are the rows of the run of their part, as
 * sym_instance_advance has them. Returns SYM_FINISHED, SYM_TERMINAL_EVENT where one ends the motion, or a status below zero:
 * SYM_DIVERGED at once, with nothing moved, where t is before the present time or no number. */
int32_t sym_program_advance(sym_program_instance *instance, double t);
/* The same, but what is sampled at t waits for the next call, and `signals` are left: inputs that are set between
 * sym_program_approach(instance, t) and sym_program_advance(instance, t) are read by blocks sampled at t, and held from there
 * on, while the mechanisms have moved to t under those before. */
int32_t sym_program_approach(sym_program_instance *instance, double t);
/* signals <- outputs at the present time, of the inputs as they are now, while what is sampled holds. Returns 0 or a status
 * below zero. */
int32_t sym_program_evaluate(sym_program_instance *instance);
/* Begin at t = 0 with the present parameters and inputs, as sym_program_init did with the first ones; once it has moved,
 * states and memory are those of the first start again. Returns 0 or a status below zero. */
int32_t sym_program_start(sym_program_instance *instance);
/* Index of a run-time parameter in `par` by its name in the diagram, such as "pd.kp[0]"; -1 where there is none. */
int32_t sym_program_parameter(const sym_program *program, const char *name);
/* Set a run-time parameter by its index in `par`, at once also where actions of events have changed it; sym_program_prepare
 * takes it. */
void sym_program_set(sym_program_instance *instance, int32_t i, double value);
/* The present value of a run-time parameter by its index in `par`: what an action of an event has set it to, once that has acted. */
double sym_program_present(const sym_program_instance *instance, int32_t i);

#ifdef __cplusplus
}
#endif
#endif
