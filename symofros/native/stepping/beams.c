/* How far the beams of a state bend, and what second-order theory errs there: docs/theory/beams.md, section 6. */

/* Error over the square of the largest slope, and where it begins to grow as the slope itself (24). */
#define SYM_BEAM_SLOPE_ERROR 0.457
#define SYM_BEAM_LARGE_SLOPE 0.47

/* Estimated relative error of a beam's deflection from squares of its largest angles: of the slope in the planes x-y and
 * x-z, of both together, of the twist (24), (25). */
static double sym_beam_error(const sym_beam *beam, double yaw, double pitch, double slope, double twist) {
    const double bending = SYM_BEAM_SLOPE_ERROR * slope / sqrt(1.0 + SYM_BEAM_LARGE_SLOPE * slope);
    const double stiffness = beam->EI_y * pitch + beam->EI_z * yaw; /* of the bending, times its square */
    double contrast;
    if (!(twist > 0.0 && beam->n_y > 0 && beam->n_z > 0 && stiffness > 0.0)) return bending;
    contrast = fabs(beam->EI_z - beam->EI_y) * fabs(pitch - yaw) / stiffness;
    return bending + contrast * twist * slope / (slope + twist);
}

/* Sum of coefficients times coordinates. */
static double sym_beam_angle(int32_t n, const double *coefficients, const double *x) {
    double s = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) s += coefficients[i] * x[i];
    return s;
}

/* Squares of the largest angles of a beam: yaw, pitch, slope, twist. */
static void sym_beam_angles(const sym_beam *beam, const double *x, double largest[4]) {
    const int32_t n = beam->n_y + beam->n_z + beam->n_twist;
    int32_t station, k;
    for (k = 0; k < 4; ++k) largest[k] = 0.0;
    for (station = 0; station < beam->stations; ++station) {
        const double *row = beam->angles + (size_t)station * n;
        const double yaw = sym_beam_angle(beam->n_y, row, x);
        const double pitch = sym_beam_angle(beam->n_z, row + beam->n_y, x + beam->n_y);
        const double twist = sym_beam_angle(beam->n_twist, row + beam->n_y + beam->n_z, x + beam->n_y + beam->n_z);
        double squares[4];
        squares[0] = yaw * yaw, squares[1] = pitch * pitch, squares[2] = squares[0] + squares[1];
        squares[3] = twist * twist;
        for (k = 0; k < 4; ++k)
            if (squares[k] > largest[k]) largest[k] = squares[k];
    }
}

SYM_EXPORT int32_t sym_run_judge_beams(sym_run *r) {
    const sym_system *s = r->system;
    double x[SYM_MAX_BEAM_COORDINATES], largest[4];
    int32_t b, i, status = 0;
    for (b = 0; b < s->n_beams; ++b) {
        const sym_beam *beam = &s->beams[b];
        const int32_t n = beam->n_y + beam->n_z + beam->n_twist;
        const double *q = r->q + beam->q, *scale = r->beam_scale + beam->first;
        double error;
        for (i = 0; i < n; ++i) x[i] = scale[i] * q[i];
        sym_beam_angles(beam, x, largest);
        error = sym_beam_error(beam, largest[0], largest[1], largest[2], largest[3]);
        if (error > r->beam_error[b]) {
            r->beam_error[b] = error, r->beam_t[b] = r->t;
            memcpy(r->beam_q + beam->first, q, (size_t)n * sizeof *q);
        }
        if (error > r->beam_limit) status = SYM_BEYOND_THEORY;
    }
    return status;
}
