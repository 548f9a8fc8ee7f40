/* What exported packages carry: the integrator, and instances of models. */
#include "integrator.c"
#include "instances/instance.c"
#include "instances/linearize.c"
#include "instances/selftest.c"
