/* What exported packages carry: the integrator, and instances of models. */
#include "integrator.c"
#include "instance.c"
#include "linearize.c"
#include "selftest.c"
