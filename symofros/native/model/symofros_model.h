/* symofros_model.h - the C interface of every SYMOFROS model. Written by hand; C99.
 *
 * A model is one constant struct, reached through its one exported symbol:
 *
 *     const sym_model *NAME_model(void);
 *
 * Nothing here allocates, keeps state or is shared between calls: functions are re-entrant, and many models live in
 * one process. Usage:
 *
 *     const sym_model *model = panda_model();
 *     const sym_function *dynamics = sym_find(model, "dynamics", NULL);
 *     double pre[...];                        // model->npre doubles
 *     model->init(model->par_default, pre);   // once per set of parameters
 *     const double *in[] = {pre, q, v, u, t}; // in the order of dynamics->in
 *     double *out[] = {M, h, Q};              // in the order of dynamics->out; may not overlap inputs or each other
 *     double work[...];                       // dynamics->work doubles, at least
 *     dynamics->eval(in, out, work);
 *
 * All quantities are SI, angles in radians; matrices are row by row. Quaternions (x, y, z, w) in q and u are of unit
 * length, which no function checks or restores: results err by about twice the deviation. Divide those that an
 * integrator of your own has moved by their lengths; sym_instance_project and all that evaluates at the state of an
 * instance (symofros_instance.h) do so.
 */
#ifndef SYMOFROS_MODEL_H
#define SYMOFROS_MODEL_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SYM_ABI 1u

/* Index of entry (i, j) of a matrix of n columns, row by row. */
#define SYM_INDEX(i, n, j) ((size_t)(i) * (size_t)(n) + (size_t)(j))

/* cdef begin: what bindings read */
typedef struct sym_array {
    const char *name; /* "q", "M", ... */
    int32_t rank;     /* 0 scalar, 1 vector, 2 matrix */
    int32_t rows;     /* entries = rows * cols; both 1 for a scalar */
    int32_t cols;     /* 1 for a vector */
} sym_array;

typedef struct sym_function {
    const char *name;     /* "mass_matrix", "frame_jacobian", ... */
    const char *frame;    /* the frame it is about, or NULL */
    int32_t n_in, n_out;
    const sym_array *in;  /* in[0] is always "pre" */
    const sym_array *out;
    size_t work;          /* doubles of scratch */
    void (*eval)(const double *const *in, double *const *out, double *work);
    /* n states; in_stride[i] is the distance between states of input i in doubles, 0 to use one for all;
     * outputs are written one state after the other. */
    void (*batch)(size_t n, const double *const *in, const size_t *in_stride, double *const *out, double *work);
} sym_function;

/* One array of a batch in any layout: entry k of state i is number k * step + i * stride from `at` on. Row by row:
 * step 1, stride = entries; column by column, the batch as the fast axis: stride 1; one input for all: stride 0. */
typedef struct sym_strided {
    void *at;
    ptrdiff_t step, stride;
} sym_strided;

/* A function by vectors: several states at once, one in each lane; columns are read and written in place. */
typedef struct sym_lanes {
    int32_t bytes;   /* of a number in inputs and outputs: 8, or 4; "pre" is of doubles always */
    int32_t own;     /* whether each state may have its own "pre"; else its stride is 0 */
    size_t work;     /* doubles of scratch */
    /* n states; NULL where there is no such code */
    void (*batch)(size_t n, const sym_strided *in, const sym_strided *out, double *work);
} sym_lanes;

typedef struct sym_model {
    uint32_t abi;          /* SYM_ABI; first, so that it can be read before anything else */
    uint32_t size;         /* sizeof(sym_model) of the generator */
    const char *name;
    const char *hash;      /* of description, options and generator */
    const char *generator; /* "symofros 0.1.0" */
    int32_t nq, nv, nu, npar, nc, npre;
    const char *const *q_names, *const *v_names, *const *u_names, *const *par_names;
    const double *par_default;
    const double *q_neutral;
    void (*init)(const double *par, double *pre);
    int32_t n_functions;
    const sym_function *functions;
    const sym_lanes *lanes; /* of each function, or NULL; added later: there if `size` says so */
} sym_model;

/* A model whose forces have states: the last nz speeds, each beside an idle coordinate, its integral, the last ones of q; their
 * rates are the last accelerations. A model is one if `size` says so: sym_nz. */
typedef struct sym_stateful_model {
    sym_model model;
    int32_t nz;
} sym_stateful_model;
/* cdef end */

#if defined(__GNUC__) || defined(__clang__)
#define SYM_NOINLINE __attribute__((noinline))
#elif defined(_MSC_VER)
#define SYM_NOINLINE __declspec(noinline)
#else
#define SYM_NOINLINE
#endif
/* Whoever includes models in a library of his own defines this as nothing. */
#if defined(SYM_EXPORT)
#elif defined(__GNUC__) || defined(__clang__)
#define SYM_EXPORT __attribute__((visibility("default")))
#elif defined(_MSC_VER)
#define SYM_EXPORT __declspec(dllexport)
#else
#define SYM_EXPORT
#endif

/* The function of that name (and frame, NULL for none); NULL where the model was generated without it. */
static inline const sym_function *sym_find(const sym_model *model, const char *name, const char *frame) {
    int32_t i;
    for (i = 0; i < model->n_functions; ++i) {
        const sym_function *f = &model->functions[i];
        const int same_frame = frame == NULL ? f->frame == NULL : f->frame != NULL && strcmp(f->frame, frame) == 0;
        if (same_frame && strcmp(f->name, name) == 0) return f;
    }
    return NULL;
}

/* Doubles of scratch that any function of the model can do with. */
static inline size_t sym_work(const sym_model *model) {
    size_t most = 1;
    int32_t i;
    for (i = 0; i < model->n_functions; ++i)
        if (model->functions[i].work > most) most = model->functions[i].work;
    return most;
}

/* Number of states of forces. */
static inline int32_t sym_nz(const sym_model *model) {
    return model->size >= sizeof(sym_stateful_model) ? ((const sym_stateful_model *)(const void *)model)->nz : 0;
}

static inline double sym_sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x; }
/* 1 from zero on, else 0; NaN stays. */
static inline double sym_step(double x) { return x >= 0.0 ? 1.0 : x < 0.0 ? 0.0 : x; }

#ifdef __cplusplus
}
#endif
#endif
