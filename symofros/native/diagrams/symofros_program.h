/* symofros_program.h - a diagram as a program of its own: constants that are generated, and memory that the caller owns.
 * Written by hand; C99.
 *
 *     void *memory = malloc(sym_program_size(square_program()));
 *     sym_assembly *square = sym_program_in(memory, size, square_program());
 *     status = sym_program_advance(square, 0.001);   // on to that time; square->signals are those of then
 *
 * After sym_program_in nothing allocates. Set square->par and call sym_program_prepare to change parameters.
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
    const int32_t *q_at, *v_at, *c_at;
    const double *u_start;
    int32_t n_signals, n_engaging, n_crossings, looks_back;
    const sym_signal *signals;                    /* inputs by samples over time */
    const int32_t *engaging;
    const int32_t *directions, *all_end;          /* (n_crossings) 1 rising, -1 falling, 0 both; ones */
    double base_n, base_d;                        /* instants: multiples of base_n / base_d seconds */
    int64_t cycle, n_instants;
    const int64_t *instant;
    const int32_t *set;
    int32_t n_sets, n_outputs;
    const char *const *due;                       /* (n_sets) the function of each set */
    const char *const *output_names;              /* (n_outputs) of the entries of `signals` */
} sym_program;

typedef struct sym_assembly {
    const sym_program *program;
    sym_diagram diagram;
    sym_instance **parts;
    double *par;      /* (npar) */
    double *pre;      /* what depends on parameters alone, for instants */
    double *signals;  /* (n_outputs) at the present time */
    sym_stage *stages, *crossings;
    sym_instant *sets;
    sym_call outputs;
} sym_assembly;

/* Bytes that an assembly needs, aligned as doubles and pointers are. */
size_t sym_program_size(const sym_program *program);
/* An assembly in that memory, at its start; NULL where the memory is too small or a first state closes no loop. */
sym_assembly *sym_program_in(void *memory, size_t size, const sym_program *program);
/* What depends on parameters alone. */
void sym_program_prepare(sym_assembly *it);
/* On to a time, instants on the way included. Returns SYM_DONE or a status below zero. */
int32_t sym_program_advance(sym_assembly *it, double t);

#ifdef __cplusplus
}
#endif
#endif
