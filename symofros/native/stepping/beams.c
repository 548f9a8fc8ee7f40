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

/* The larger of a number and a magnitude. */
static double sym_larger(double most, double x) { return fabs(x) > most ? fabs(x) : most; }

/* The same of a beam that bends in the x-y plane alone. */
static void sym_planar_beam_angles(const sym_beam *beam, const double *x, double largest[4]) {
    const double *angles = beam->angles;
    double most = 0.0;
    int32_t block, i;
    for (block = 0; block < beam->blocks; ++block) {
        double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
        for (i = 0; i < beam->n_y; ++i, angles += 4)
            a += angles[0] * x[i], b += angles[1] * x[i], c += angles[2] * x[i], d += angles[3] * x[i];
        most = sym_larger(sym_larger(sym_larger(sym_larger(most, a), b), c), d);
    }
    largest[0] = largest[2] = most * most, largest[1] = largest[3] = 0.0;
}

/* The largest that angles can be by a change of the elastic coordinates: each one's largest angle counts, whatever its sign. */
static double sym_beam_change(int32_t n, const double *reach, const double *q, const double *reference) {
    double change = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) change += reach[i] * fabs(q[i] - reference[i]);
    return change;
}

/* An upper bound of a beam's error that costs little, by the change since its angles were evaluated last. */
static double sym_beam_error_bound(const sym_run *r, int32_t b, const double *q) {
    const sym_beam *beam = &r->system->beams[b];
    const int32_t bending = beam->n_y + beam->n_z;
    const double *reach = r->beam_reach + beam->first, *reference = r->beam_reference + 2 * r->system->n_beams + beam->first;
    const double slope = r->beam_reference[2 * b] + sym_beam_change(bending, reach, q, reference);
    double bound = SYM_BEAM_SLOPE_ERROR * slope * slope, twist;
    if (beam->contrast > 0.0) {
        twist = r->beam_reference[2 * b + 1] +
                sym_beam_change(beam->n_twist, reach + bending, q + bending, reference + bending);
        bound += beam->contrast * twist * twist;
    }
    return bound;
}

SYM_EXPORT int32_t sym_run_judge_beams(sym_run *r) {
    const sym_system *s = r->system;
    double x[SYM_MAX_BEAM_COORDINATES], largest[4];
    int32_t b, i, status = 0;
    for (b = 0; b < s->n_beams; ++b) {
        const sym_beam *beam = &s->beams[b];
        const int32_t n = beam->n_y + beam->n_z + beam->n_twist;
        const double *q = r->q + beam->q, *scale = r->beam_scale + beam->first;
        double error, *reference = r->beam_reference + 2 * s->n_beams + beam->first;
        if (sym_beam_error_bound(r, b, q) <= r->beam_error[b]) continue;
        for (i = 0; i < n; ++i) x[i] = scale[i] * q[i], reference[i] = q[i];
        if (n == beam->n_y) sym_planar_beam_angles(beam, x, largest);
        else sym_beam_angles(beam, x, largest);
        r->beam_reference[2 * b] = sqrt(largest[2]), r->beam_reference[2 * b + 1] = sqrt(largest[3]);
        error = sym_beam_error(beam, largest[0], largest[1], largest[2], largest[3]);
        if (error > r->beam_error[b]) {
            r->beam_error[b] = error, r->beam_t[b] = r->t;
            for (i = 0; i < n; ++i) r->beam_q[beam->first + i] = q[i];
        }
        if (error > r->beam_limit) status = SYM_BEYOND_THEORY;
    }
    return status;
}
