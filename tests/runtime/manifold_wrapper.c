#define SYM_ANALYSIS
#include <math.h>
#include <string.h>
#include "symofros_stepper.h"
#include "manifold.c"
static sym_system system_of(int32_t n, const int32_t *segments) {
    sym_system s;
    memset(&s, 0, sizeof s);
    s.n_segments = n, s.segments = (const sym_segment *)segments;
    return s;
}
SYM_EXPORT void retracted(int32_t n, const int32_t *segments, const double *q0, const double *theta, double *q) {
    sym_system s = system_of(n, segments);
    sym_retract(&s, q0, theta, q);
}
SYM_EXPORT void chart_rates(int32_t n, const int32_t *segments, const double *theta, const double *v, double *rate) {
    sym_system s = system_of(n, segments);
    sym_chart_rate(&s, theta, v, rate);
}
SYM_EXPORT void coordinates(int32_t n, const int32_t *segments, const double *q0, const double *q1, double *theta) {
    sym_system s = system_of(n, segments);
    sym_chart_coordinates(&s, q0, q1, theta);
}
SYM_EXPORT void rates(int32_t n, const int32_t *segments, double *q, const double *v, double *rate) {
    sym_system s = system_of(n, segments);
    s.q = q;
    sym_normalize_quaternions(&s);
    sym_configuration_rate(&s, q, v, rate);
}
SYM_EXPORT void displacements(int32_t n, const int32_t *segments, double *theta) {
    sym_system s = system_of(n, segments);
    sym_twist_to_displacement(&s, theta);
}
