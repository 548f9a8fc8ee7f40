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
    if (!(twist > 0.0 && beam->contrast > 0.0 && stiffness > 0.0)) return bending;
    contrast = fabs(beam->EI_z - beam->EI_y) * fabs(pitch - yaw) / stiffness;
    return bending + contrast * twist * slope / (slope + twist);
}

/* The angle of one direction at four stations; loops of four are what compilers make vectors of. */
static void sym_beam_angle(int32_t n, const double *angles, const double *x, double angle[4]) {
    int32_t i, l;
    for (l = 0; l < 4; ++l) angle[l] = 0.0;
    for (i = 0; i < n; ++i)
        for (l = 0; l < 4; ++l) angle[l] += angles[4 * i + l] * x[i];
}

/* largest <- the larger of both, at four stations. */
static void sym_beam_keep_largest(const double square[4], double largest[4]) {
    int32_t l;
    for (l = 0; l < 4; ++l) largest[l] = square[l] > largest[l] ? square[l] : largest[l];
}

/* Squares of the largest angles of a beam: yaw, pitch, slope, twist. */
static void sym_beam_angles(const sym_beam *beam, const double *x, double largest[4]) {
    const int32_t bending = beam->n_y + beam->n_z, n = bending + beam->n_twist;
    double squares[4][4] = {{0.0}};
    int32_t block, k, l;
    for (block = 0; block < beam->blocks; ++block) {
        const double *angles = beam->angles + (size_t)block * 4 * n;
        double angle[4][4];
        sym_beam_angle(beam->n_y, angles, x, angle[0]);
        sym_beam_angle(beam->n_z, angles + 4 * beam->n_y, x + beam->n_y, angle[1]);
        sym_beam_angle(beam->n_twist, angles + 4 * bending, x + bending, angle[3]);
        for (l = 0; l < 4; ++l) {
            angle[0][l] *= angle[0][l], angle[1][l] *= angle[1][l], angle[3][l] *= angle[3][l];
            angle[2][l] = angle[0][l] + angle[1][l];
        }
        for (k = 0; k < 4; ++k) sym_beam_keep_largest(angle[k], squares[k]);
    }
    for (k = 0; k < 4; ++k) {
        largest[k] = squares[k][0];
        for (l = 1; l < 4; ++l)
            if (squares[k][l] > largest[k]) largest[k] = squares[k][l];
    }
}

/* An upper bound of a beam's error that costs little: each coordinate's largest angle counts, whatever its sign. */
static double sym_beam_error_bound(const sym_beam *beam, const double *reach, const double *q) {
    const int32_t bending = beam->n_y + beam->n_z;
    double slope = 0.0, twist = 0.0;
    int32_t i;
    for (i = 0; i < bending; ++i) slope += reach[i] * fabs(q[i]);
    for (i = bending; i < bending + beam->n_twist; ++i) twist += reach[i] * fabs(q[i]);
    return SYM_BEAM_SLOPE_ERROR * slope * slope + beam->contrast * twist * twist;
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
        if (sym_beam_error_bound(beam, r->beam_reach + beam->first, q) <= r->beam_error[b]) continue;
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
