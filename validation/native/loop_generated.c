/* Loops over the states around generated C, state by state or by its batches: ours, CasADi's and SymPy's. */

#include "symofros_model.h"

#define LOOP_EXPORT __attribute__((visibility("default")))
enum { MOST = 16 };

/* cdef begin: what Python reads */
/* Inputs and outputs of one function: input i of the next state lies stride[i] doubles on. Outputs are kept one state
 * after the other, size[i] doubles each, where `keep` is set; else each lies over the one before. */
typedef struct loop_arrays {
    size_t n;
    int32_t n_in, n_out, keep;
    const double *const *in;
    const size_t *stride;
    double *const *out;
    const size_t *size;
    double *work;
    long long *iwork;
} loop_arrays;
/* The same in n blocks of so many states each: the arrays of one block after those of another. */
typedef struct loop_blocks {
    size_t n;
    int32_t n_in, n_out, keep;
    const size_t *states;
    const sym_strided *in, *out;
    double *work;
} loop_blocks;
/* cdef end */

static void first(const loop_arrays *s, const double **in, double **out) {
    int32_t k;
    for (k = 0; k < s->n_in; ++k) in[k] = s->in[k];
    for (k = 0; k < s->n_out; ++k) out[k] = s->out[k];
}

static void next(const loop_arrays *s, const double **in, double **out, size_t states) {
    int32_t k;
    for (k = 0; k < s->n_in; ++k) in[k] += states * s->stride[k];
    if (s->keep)
        for (k = 0; k < s->n_out; ++k) out[k] += states * s->size[k];
}

/* A function of symofros_model.h. */
LOOP_EXPORT void loop_eval(const sym_function *function, const loop_arrays *s, size_t rounds) {
    const double *in[MOST];
    double *out[MOST];
    size_t r, i;
    for (r = 0; r < rounds; ++r) {
        first(s, in, out);
        for (i = 0; i < s->n; ++i) {
            function->eval(in, out, s->work);
            next(s, in, out, 1);
        }
    }
}

/* The same by its batches of so many states. */
LOOP_EXPORT void loop_batch(const sym_function *function, const loop_arrays *s, size_t rounds, size_t block) {
    const double *in[MOST];
    double *out[MOST];
    size_t r, i;
    for (r = 0; r < rounds; ++r) {
        first(s, in, out);
        for (i = 0; i < s->n; i += block) {
            function->batch(s->n - i < block ? s->n - i : block, in, s->stride, out, s->work);
            next(s, in, out, block);
        }
    }
}

/* A function by vectors, its arrays as they lie. */
LOOP_EXPORT void loop_lanes(const sym_lanes *lanes, const loop_blocks *s, size_t rounds) {
    size_t r, i;
    for (r = 0; r < rounds; ++r)
        for (i = 0; i < s->n; ++i)
            lanes->batch(s->states[i], s->in + i * s->n_in, s->out + (s->keep ? i * s->n_out : 0), s->work);
}

/* A function as CasADi generates it. */
LOOP_EXPORT void loop_casadi(int (*function)(const double **, double **, long long *, double *, int), const loop_arrays *s,
                             size_t rounds) {
    const double *in[MOST];
    double *out[MOST];
    size_t r, i;
    for (r = 0; r < rounds; ++r) {
        first(s, in, out);
        for (i = 0; i < s->n; ++i) {
            function(in, out, s->iwork, s->work, 0);
            next(s, in, out, 1);
        }
    }
}
