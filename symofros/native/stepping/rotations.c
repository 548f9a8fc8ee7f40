/* Unit quaternions and rotation vectors; rollouts on graphics processors use them as well. */

/* Quaternion (x, y, z, w) of the rotation vector w. */
static void sym_quaternion_exp(const double *w, double *quaternion) {
    const double angle2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], angle = sqrt(angle2);
    /* Below 1e-4 the series is exact to rounding and the closed form loses digits. */
    const double f = angle < 1e-4 ? 0.5 - angle2 / 48.0 : sin(0.5 * angle) / angle;
    quaternion[0] = f * w[0], quaternion[1] = f * w[1], quaternion[2] = f * w[2], quaternion[3] = cos(0.5 * angle);
}

/* c = a b, normalised. */
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

/* y = R(quaternion) x */
static void sym_rotate(const double *quaternion, const double *x, double *y) {
    double t[3], s[3];
    int i;
    sym_cross(quaternion, x, t);
    for (i = 0; i < 3; ++i) t[i] *= 2.0;
    sym_cross(quaternion, t, s);
    for (i = 0; i < 3; ++i) y[i] = x[i] + quaternion[3] * t[i] + s[i];
}

/* Rate of the rotation vector theta at angular velocity w, (2): w + theta x w / 2 + c theta x (theta x w). */
static void sym_rotation_vector_rate(const double *theta, const double *w, double *rate) {
    const double angle2 = theta[0] * theta[0] + theta[1] * theta[1] + theta[2] * theta[2], angle = sqrt(angle2);
    const double c = angle < 1e-3 ? 1.0 / 12.0 + angle2 / 720.0 : (1.0 - 0.5 * angle / tan(0.5 * angle)) / angle2;
    double cross[3], cross_cross[3];
    int i;
    sym_cross(theta, w, cross);
    sym_cross(theta, cross, cross_cross);
    for (i = 0; i < 3; ++i) rate[i] = w[i] + 0.5 * cross[i] + c * cross_cross[i];
}
