/* An exported diagram: integrator, instants and program, without threads. */
#include "../stepping/symofros_stepper.c"
#include "symofros_program.h"
#include <stdio.h>
#include "diagram.c"
#include "program.c"
