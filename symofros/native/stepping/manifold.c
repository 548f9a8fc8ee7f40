/* The configuration manifold: q = q0 + theta, and how theta changes. docs/theory/simulation.md, (1) to (3). */

static void sym_turn(const double *w, double *quaternion) {
    const double angle2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], angle = sqrt(angle2);
    /* Below 1e-4 the series is exact to rounding and the closed form loses digits. */
    const double f = angle < 1e-4 ? 0.5 - angle2 / 48.0 : sin(0.5 * angle) / angle;
    quaternion[0] = f * w[0], quaternion[1] = f * w[1], quaternion[2] = f * w[2], quaternion[3] = cos(0.5 * angle);
}

static void sym_quaternion_product(const double *a, const double *b, double *c) {
    const double x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
    const double y = a[3] * b[1] + a[1] * b[3] + a[2] * b[0] - a[0] * b[2];
    const double z = a[3] * b[2] + a[2] * b[3] + a[0] * b[1] - a[1] * b[0];
    const double w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
    const double s = 1.0 / sqrt(x * x + y * y + z * z + w * w);
    c[0] = s * x, c[1] = s * y, c[2] = s * z, c[3] = s * w;
}

static void sym_cross(const double *a, const double *b, double *c) {
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    c[0] = x, c[1] = y, c[2] = z;
}

/* R(quaternion) x */
static void sym_rotate(const double *quaternion, const double *x, double *y) {
    double t[3], s[3];
    int i;
    sym_cross(quaternion, x, t);
    for (i = 0; i < 3; ++i) t[i] *= 2.0;
    sym_cross(quaternion, t, s);
    for (i = 0; i < 3; ++i) y[i] = x[i] + quaternion[3] * t[i] + s[i];
}

/* q = q0 moved by theta: of a pose, theta = (shift in the axes of q0; rotation vector). */
static void sym_retract(const sym_scene *scene, const double *q0, const double *theta, double *q) {
    int s, i;
    for (s = 0; s < scene->n_segments; ++s) {
        const sym_segment *seg = &scene->segments[s];
        const double *a = q0 + seg->q, *x = theta + seg->v;
        double *b = q + seg->q, turn[4], shift[3];
        if (seg->kind == 0) {
            for (i = 0; i < seg->size; ++i) b[i] = a[i] + x[i];
        } else if (seg->kind == 1) {
            sym_turn(x, turn);
            sym_quaternion_product(a, turn, b);
        } else {
            sym_rotate(a + 3, x, shift);
            for (i = 0; i < 3; ++i) b[i] = a[i] + shift[i];
            sym_turn(x + 3, turn);
            sym_quaternion_product(a + 3, turn, b + 3);
        }
    }
}

/* Twists of poses in theta become shifts, in place: what the constant velocity theta moves in unit time,
 * v + A w x v + B w x (w x v). */
static void sym_unroll(const sym_scene *scene, double *theta) {
    int k, i;
    for (k = 0; k < scene->n_segments; ++k) {
        const sym_segment *seg = &scene->segments[k];
        double *v = theta + seg->v, once[3], twice[3];
        const double *w = v + 3;
        double angle2, angle, A, B;
        if (seg->kind != 2) continue;
        angle2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], angle = sqrt(angle2);
        A = angle < 1e-4 ? 0.5 - angle2 / 24.0 : (1.0 - cos(angle)) / angle2;
        B = angle < 1e-2 ? 1.0 / 6.0 - angle2 / 120.0 + angle2 * angle2 / 5040.0 : (angle - sin(angle)) / (angle2 * angle);
        sym_cross(w, v, once);
        sym_cross(w, once, twice);
        for (i = 0; i < 3; ++i) v[i] += A * once[i] + B * twice[i];
    }
}

/* w -> the rate of the rotation vector theta: w + theta x w / 2 + c theta x (theta x w). */
static void sym_vector_rate(const double *theta, const double *w, double *rate) {
    const double angle2 = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2], angle = sqrt(angle2);
    const double c = angle < 1e-3 ? 1.0 / 12.0 + angle2 / 720.0 : (1.0 - 0.5 * angle / tan(0.5 * angle)) / angle2;
    double once[3], twice[3];
    int i;
    sym_cross(theta, w, once);
    sym_cross(theta, once, twice);
    for (i = 0; i < 3; ++i) rate[i] = w[i] + 0.5 * once[i] + c * twice[i];
}

/* The rate of theta where the speeds are v. */
static void sym_chart_rate(const sym_scene *scene, const double *theta, const double *v, double *rate) {
    int s;
    for (s = 0; s < scene->n_segments; ++s) {
        const sym_segment *seg = &scene->segments[s];
        const int k = seg->v;
        double turn[4];
        if (seg->kind == 0) {
            memcpy(rate + k, v + k, (size_t)seg->size * sizeof *rate);
        } else if (seg->kind == 1) {
            sym_vector_rate(theta + k, v + k, rate + k);
        } else {
            sym_turn(theta + k + 3, turn);
            sym_rotate(turn, v + k, rate + k);
            sym_vector_rate(theta + k + 3, v + k + 3, rate + k + 3);
        }
    }
}

/* The derivative of that rate by theta at theta = 0, times x: -w x_rotation / 2 and so on. Adds s times it to out. */
static void sym_chart_rate_by_theta(const sym_scene *scene, const double *v, const double *x, double s, double *out) {
    int k, i;
    for (k = 0; k < scene->n_segments; ++k) {
        const sym_segment *seg = &scene->segments[k];
        const int w = seg->kind == 2 ? seg->v + 3 : seg->v;
        double c[3];
        if (seg->kind == 0) continue;
        sym_cross(x + w, v + w, c);
        for (i = 0; i < 3; ++i) out[w + i] += 0.5 * s * c[i];
        if (seg->kind == 2) {
            sym_cross(x + w, v + seg->v, c);
            for (i = 0; i < 3; ++i) out[seg->v + i] += s * c[i];
        }
    }
}
