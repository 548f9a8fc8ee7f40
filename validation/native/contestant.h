/* contestant.h - what one side of a timing is to the driver: a shared library with the functions below. C99.
 *
 * The driver opens each side's model once, runs every function over all states once with `out` to have the results
 * compared, and then again and again without `out` to have it timed.
 */
#ifndef CONTESTANT_H
#define CONTESTANT_H

#include <stddef.h>

#if defined(__cplusplus)
#define CONTESTANT_LINKAGE extern "C"
#else
#define CONTESTANT_LINKAGE
#endif
#define CONTESTANT_EXPORT CONTESTANT_LINKAGE __attribute__((visibility("default")))

/* Evaluate n states.
 *
 * in:  arrays of n rows, in the side's own conventions: in[0] = q, in[1] = v.
 * out: NULL: results stay in the side's own memory, those of later states in place of those of earlier ones.
 *      Otherwise arrays of n rows: the results, in the order of the function's name.
 */
typedef void contestant_function(void *self, size_t n, const double *const *in, double *const *out);

/* A model, or NULL with the reason in `error`; `variant` is what else the side wants to know. */
CONTESTANT_EXPORT void *contestant_open(const char *model, const char *variant, char *error, size_t size);

/* The function of that name ("mass_matrix", "bias", "mass_matrix_and_bias"), or NULL. */
CONTESTANT_EXPORT contestant_function *contestant_find(void *self, const char *name);

#endif
