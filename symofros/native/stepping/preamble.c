/* Simulation of SYMOFROS models: see the headers. */
#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 199309L /* clock_gettime, nanosleep */
#endif
#include <math.h>
#include "symofros_stepper.h"
#include "symofros_instance.h"
