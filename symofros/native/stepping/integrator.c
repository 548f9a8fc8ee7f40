/* The integrator: symofros_stepper.h. */
#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 199309L /* clock_gettime, nanosleep */
#endif
#include <math.h>
#include "symofros_stepper.h"
#include "symofros_instance.h"
#include "arena.c"
#include "manifold.c"
#include "system.c"
#include "formula_instants.c"
#include "elimination.c"
#include "workspace.c"
#include "explicit.c"
#include "input_moments.c"
#include "step_size.c"
#include "rosenbrock.c"
#include "second_order.c"
#include "real_time.c"
#include "beams.c"
#include "axial_loads.c"
#include "dense_output.c"
#include "event_search.c"
#include "events.c"
#include "quiet_steps.c"
#include "diagnostic.c"
#include "actions.c"
#include "run.c"
#include "external_rhs.c"
