/* The configuration manifold: retraction q = q0 (+) theta and the rate of theta. docs/theory/simulation.md, (1), (2). */
#include "rotations.c"

/* q = q0 (+) theta, (1). Of a pose, theta = (displacement in the axes of q0; rotation vector). */
static void sym_retract(const sym_system *system, const double *q0, const double *theta, double *q) {
    int s, i;
    for (s = 0; s < system->n_segments; ++s) {
        const sym_segment *seg = &system->segments[s];
        const double *a = q0 + seg->q, *x = theta + seg->v;
        double *b = q + seg->q;
        if (seg->kind == SYM_SEGMENT_LINEAR) {
            for (i = 0; i < seg->size; ++i) b[i] = a[i] + x[i];
        } else if (seg->kind == SYM_SEGMENT_QUATERNION)
            sym_retract_quaternion(a, x, b);
        else
            sym_retract_pose(a, x, b);
    }
    for (i = 0; i < system->n_sticking; ++i)
        if (system->held[i]) q[system->sticking[i].q] = q0[system->sticking[i].q];
}

#ifdef SYM_ANALYSIS /* of the library that Python loads */
/* theta <- the coordinates of configuration q in the chart about q0: the inverse of sym_retract. */
static void sym_chart_coordinates(const sym_system *system, const double *q0, const double *q, double *theta) {
    int s, i;
    for (s = 0; s < system->n_segments; ++s) {
        const sym_segment *seg = &system->segments[s];
        const double *a = q0 + seg->q, *b = q + seg->q;
        double *x = theta + seg->v;
        if (seg->kind == SYM_SEGMENT_LINEAR) {
            for (i = 0; i < seg->size; ++i) x[i] = b[i] - a[i];
        } else if (seg->kind == SYM_SEGMENT_QUATERNION)
            sym_chart_coordinates_quaternion(a, b, x);
        else
            sym_chart_coordinates_pose(a, b, x);
    }
}
#endif

/* Twists (v, w) of poses in theta become displacements in place: those of the screw motion with constant twist in unit
 * time. */
static void sym_twist_to_displacement(const sym_system *system, double *theta) {
    int k;
    for (k = 0; k < system->n_segments; ++k) {
        double *twist = theta + system->segments[k].v;
        if (system->segments[k].kind == SYM_SEGMENT_POSE) sym_twist_to_displacement_pose(twist, twist);
    }
}

/* Rate of theta at speeds v, (2). */
static void sym_chart_rate(const sym_system *system, const double *theta, const double *v, double *rate) {
    int s;
    for (s = 0; s < system->n_segments; ++s) {
        const sym_segment *seg = &system->segments[s];
        const int k = seg->v;
        if (seg->kind == SYM_SEGMENT_LINEAR)
            memcpy(rate + k, v + k, (size_t)seg->size * sizeof *rate);
        else if (seg->kind == SYM_SEGMENT_QUATERNION)
            sym_chart_rate_quaternion(theta + k, v + k, rate + k);
        else
            sym_chart_rate_pose(theta + k, v + k, rate + k);
    }
}

/* out += s T x, where T is the derivative of that rate by theta at theta = 0: -[w]/2 for rotations, -[v] beside it for
 * positions. */
static void sym_chart_rate_jacobian(const sym_system *system, const double *v, const double *x, double s, double *out) {
    int k, i;
    for (k = 0; k < system->n_segments; ++k) {
        const sym_segment *seg = &system->segments[k];
        const int w = seg->kind == SYM_SEGMENT_POSE ? seg->v + 3 : seg->v;
        double c[3];
        if (seg->kind == SYM_SEGMENT_LINEAR) continue;
        sym_cross(x + w, v + w, c);
        for (i = 0; i < 3; ++i) out[w + i] += 0.5 * s * c[i];
        if (seg->kind == SYM_SEGMENT_POSE) {
            sym_cross(x + w, v + seg->v, c);
            for (i = 0; i < 3; ++i) out[seg->v + i] += s * c[i];
        }
    }
}

/* Normalise the quaternions of the evaluation point. */
static void sym_normalize_quaternions(sym_system *s) {
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        double *p = s->q + s->segments[k].q + (s->segments[k].kind == SYM_SEGMENT_POSE ? 3 : 0), size = 0.0;
        if (s->segments[k].kind == SYM_SEGMENT_LINEAR) continue;
        for (i = 0; i < 4; ++i) size += p[i] * p[i];
        size = sqrt(size);
        for (i = 0; i < 4; ++i) p[i] /= size;
    }
}

/* Rate N(q) w at the configuration of the evaluation point; q: the same one, with quaternions of any length. */
static void sym_configuration_rate(const sym_system *s, const double *q, const double *w, double *rate) {
    int32_t k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t at = seg->kind == SYM_SEGMENT_POSE ? 3 : 0;
        const double *v = w + seg->v;
        if (seg->kind == SYM_SEGMENT_LINEAR) {
            memcpy(rate + seg->q, v, (size_t)seg->size * sizeof *v);
            continue;
        }
        if (seg->kind == SYM_SEGMENT_POSE) sym_rotate(s->q + seg->q + 3, v, rate + seg->q);
        sym_quaternion_rate(q + seg->q + at, v + at, rate + seg->q + at);
    }
}
