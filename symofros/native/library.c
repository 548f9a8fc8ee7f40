/* What Python loads: integrator, batches, runs stepped by hand, diagrams and their threads, as one library. */
#define SYM_ANALYSIS
#include "stepping/integrator.c"
#include "stepping/spectrum.c"
#include "symofros_batch.h"
#include "stepping/batch_columns.c"
#include "stepping/batch_stepper.c"
#include "symofros_hand.h"
#include "stepping/by_hand.c"
#include "symofros_diagram.h"
#include "diagrams/diagram.c"
#include "diagrams/thread_pool.c"
