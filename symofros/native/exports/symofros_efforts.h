/* symofros_efforts.h - inverse dynamics with chosen actuators, loops closed: docs/theory/constraints.md, section 11.
 *
 *     const int32_t actuators[] = {0, SYM_ON_SPEED(2)};      // input 0, and an effort on the joint of speed 2
 *     double *memory = malloc(NAME_actuator_efforts_size(2) * sizeof *memory);
 *     const int32_t redundant =
 *         NAME_actuator_efforts(pre, q, v, a, u, t, 2, actuators, NULL, efforts, lam, memory);
 */
#ifndef SYMOFROS_EFFORTS_H
#define SYMOFROS_EFFORTS_H

#include "symofros_model.h"

/* An actuator that acts on a speed's joint; inputs are their own numbers. */
#define SYM_ON_SPEED(index) (-1 - (index))

/* What NAME_actuator_efforts returns, beside the number of independent combinations of efforts that move nothing. */
enum {
    SYM_EFFORTS_UNKNOWN = -1,      /* an actuator is no input or speed, or named twice; or a function is missing */
    SYM_EFFORTS_INCONSISTENT = -2, /* the motion violates phi = 0, G v = b or G a = gamma */
    SYM_EFFORTS_SINGULAR = -3,     /* the mass matrix has no inverse on the motions that constraints allow */
    SYM_EFFORTS_SHORT = -4,        /* the actuators can't produce the motion */
    SYM_EFFORTS_NOT_LINEAR = -5    /* forces are not linear in an actuator's input */
};

#endif
