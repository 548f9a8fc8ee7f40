/* loop.h - what a timed engine exports: its functions, each as a loop over the same states. C99 and C++.
 *
 * Results stay where the engine leaves them, each over the one before, as in a control loop; they are copied out only
 * where `results` is not NULL, which is how values are checked. */
#ifndef LOOP_H
#define LOOP_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* cdef begin: what Python reads */
/* n rows of each, in the engine's coordinates; the step of integrators [s]. */
typedef struct loop_states {
    size_t n;
    const double *q, *v, *a, *tau;
    double step;
} loop_states;

typedef struct loop_function {
    const char *name;    /* as in our generated code: "mass_matrix", ... */
    const char *variant; /* where the engine has several ways: "local", "world"; else "" */
    int32_t size;        /* doubles of result, a state */
    int32_t once;        /* one result for all states: where a motion ends */
    void (*run)(void *engine, const loop_states *states, size_t rounds, double *results);
} loop_function;

typedef struct loop_engine {
    void *engine;
    int32_t n;
    const loop_function *functions;
} loop_engine;
/* cdef end */

/* The engine's model of a file, about one body; NULL where it can't be read. Lives as long as the process. */
__attribute__((visibility("default"))) const loop_engine *loop_open(const char *path, int32_t body);

#ifdef __cplusplus
}
#endif
#endif
