/* symofros_tape.h - programs that are interpreted: functions of a model as instructions, behind the same interface as
 * compiled ones. Between tape.c and Python; the instructions are written by generator/codegen/tape.py.
 *
 * Registers are doubles. Those of numbers come first; an instruction names its operation, the register that it writes
 * and those that it reads. One sequence serves single states and batches, where each register holds SYM_TAPE_WIDTH states.
 */
#ifndef SYMOFROS_TAPE_H
#define SYMOFROS_TAPE_H

#include "symofros_model.h"

/* cdef begin: what bindings read */
enum sym_tape_sizes {
    SYM_TAPE_WIDTH = 16,   /* states of a batch that are evaluated side by side */
    SYM_TAPE_SLOTS = 1024, /* functions that a process holds at a time */
    SYM_TAPE_ARRAYS = 16   /* most inputs or outputs of a function, "pre" included */
};

/* Operations; d, a, b, c, e are registers. Arithmetic stands in runs: the operation, how many, then these of each. */
enum sym_tape_operation {
    SYM_TAPE_END,
    SYM_TAPE_LOAD,      /* input, count, then (entry, d) each: d = in[input][entry] */
    SYM_TAPE_STORE,     /* output, count, then (entry, a) each: out[output][entry] = a */
    SYM_TAPE_STORE_NEG, /* the same with -a */
    SYM_TAPE_CLEAR,     /* output: all zero */
    SYM_TAPE_ADD,       /* d a b */
    SYM_TAPE_SUB,       /* d a b: a - b */
    SYM_TAPE_MUL,       /* d a b */
    SYM_TAPE_DIV,       /* d a b */
    SYM_TAPE_MUL_ADD,   /* d a b c: a b + c, each rounded */
    SYM_TAPE_MUL_SUB,   /* d a b c: a b - c */
    SYM_TAPE_SUB_MUL,   /* d a b c: c - a b */
    SYM_TAPE_MULS_ADD,  /* d a b c e: a b + c e */
    SYM_TAPE_MULS_SUB,  /* d a b c e: a b - c e */
    SYM_TAPE_NEG,       /* d a */
    SYM_TAPE_SINCOS,    /* count, then (sine, cosine, angle) each, up to 8 */
    SYM_TAPE_SQRT,      /* d a */
    SYM_TAPE_EXP,       /* d a */
    SYM_TAPE_LOG,       /* d a */
    SYM_TAPE_TAN,       /* d a */
    SYM_TAPE_ASIN,      /* d a */
    SYM_TAPE_ACOS,      /* d a */
    SYM_TAPE_ATAN,      /* d a */
    SYM_TAPE_SINH,      /* d a */
    SYM_TAPE_COSH,      /* d a */
    SYM_TAPE_TANH,      /* d a */
    SYM_TAPE_ABS,       /* d a */
    SYM_TAPE_SIGN,      /* d a */
    SYM_TAPE_FLOOR,     /* d a */
    SYM_TAPE_STEP,      /* d a: 1 from zero on, else 0 */
    SYM_TAPE_POW,       /* d a b */
    SYM_TAPE_ATAN2,     /* d a b */
    SYM_TAPE_MIN,       /* d a b */
    SYM_TAPE_MAX        /* d a b */
};

/* Routines of native/model that finish a function. */
enum sym_tape_routine {
    SYM_TAPE_PLAIN, /* none does */
    SYM_TAPE_CONSTRAINED,
    SYM_TAPE_NULL_SPACE,
    SYM_TAPE_PROJECT,
    SYM_TAPE_DIFFERENTIATE,
    SYM_TAPE_RESPONSES,
    SYM_TAPE_TRANSPOSE,
    SYM_TAPE_HESSIAN
};

typedef struct sym_tape {
    int32_t routine;
    /* Of one that none finishes. */
    const uint32_t *code;
    const double *numbers; /* (n_numbers) */
    const int32_t *sizes;  /* (n_out) doubles of each output */
    int32_t n_numbers, n_registers, n_in, n_out;
    /* Of one that a routine finishes: its arguments, as native/model has them. */
    int32_t terms, parts[2];  /* slots */
    int32_t nq, nv, nc, extra; /* extra: n_facing of project, k of hessian, inputs of differentiate */
    const int32_t *columns;    /* of differentiate */
    const short *group, *unit, *speed;
} sym_tape;

/* A slot for a tape, which has to stay where it is until it is released; -1 where all are taken. */
int32_t sym_tape_place(const sym_tape *tape);
void sym_tape_release(int32_t slot);
/* The code of `function`: one state, and batches. Its work is n_registers * SYM_TAPE_WIDTH doubles, or the routine's. */
void sym_tape_bind(int32_t slot, sym_function *function);
/* The same of a model's parameters, from a tape with one input and one output. */
void sym_tape_bind_parameters(int32_t slot, sym_model *model);
/* cdef end */

#endif
