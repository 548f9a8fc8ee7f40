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
    const int32_t bending = beam->n_y + beam->n_z, n = beam->n;
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

/* The larger of two numbers; of a second one that is none the first. */
static double sym_larger(double most, double x) { return x > most ? x : most; }

/* The same of a beam that bends in the x-y plane alone. */
static void sym_planar_beam_angles(const sym_beam *beam, const double *x, double largest[4]) {
    const double *angles = beam->angles, *end = x + beam->n_y, *at;
    double most = 0.0;
    int32_t block;
    for (block = 0; block < beam->blocks; ++block) {
        double a = 0.0, b = 0.0, c = 0.0, d = 0.0;
        for (at = x; at < end; ++at, angles += 4)
            a += angles[0] * *at, b += angles[1] * *at, c += angles[2] * *at, d += angles[3] * *at;
        most = sym_larger(sym_larger(sym_larger(sym_larger(most, a * a), b * b), c * c), d * d);
    }
    largest[0] = largest[2] = most, largest[1] = largest[3] = 0.0;
}

/* By which factor a beam's error may lie above the largest one before a step that goes on in the same direction is judged. */
#define SYM_BEAM_SLACK 1.04

/* The change of angles, of a slope and a twist whose squares are given, at which a beam's error may reach a given one: not
 * before (26d). Without twist this inverts (24). */
static double sym_change_to_error(const sym_beam *beam, double slope, double twist, double error) {
    const double weight = beam->contrast / SYM_BEAM_SLOPE_ERROR, y = 0.5 * SYM_BEAM_LARGE_SLOPE / SYM_BEAM_SLOPE_ERROR * error;
    const double square = error / SYM_BEAM_SLOPE_ERROR * (weight > 0.0 ? 1.0 : y + sqrt(1.0 + y * y));
    const double left = square - slope - weight * twist;
    double b;
    if (!(left > 0.0)) return 0.0;
    if (!(weight > 0.0)) return sqrt(square) - sqrt(slope);
    b = sqrt(slope) + weight * sqrt(twist);
    return left / (b + sqrt(b * b + (1.0 + weight) * left));
}

/* The largest that angles can be by the change of n elastic coordinates since the angles were evaluated last: each one's
 * largest angle counts, whatever its sign. */
static double sym_beam_change(int32_t n, const double *reach, const double *reference, const double *q) {
    double change = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) change += reach[i] * fabs(q[i] - reference[i]);
    return change;
}

/* Evaluate a beam's error in a configuration, and keep it if it is the largest. Returns 0 or SYM_BEYOND_THEORY. */
static int32_t sym_evaluate_beam(sym_run *r, int32_t b, double t, const double *configuration) {
    const sym_beam *beam = &r->system->beams[b];
    sym_beam_guard *guard = &r->beam_guard[b];
    const int32_t n = beam->n;
    const double *q = configuration + beam->q, *scale = r->beam_scale + beam->first;
    double x[SYM_MAX_BEAM_COORDINATES], largest[4], *reference = r->beam_reference + beam->first, error, judged;
    int32_t i;
    for (i = 0; i < n; ++i) x[i] = scale[i] * q[i], reference[i] = q[i];
    if (n == beam->n_y) sym_planar_beam_angles(beam, x, largest);
    else sym_beam_angles(beam, x, largest);
    error = sym_beam_error(beam, largest[0], largest[1], largest[2], largest[3]);
    if (error > r->beam_error[b]) {
        r->beam_error[b] = error, r->beam_t[b] = t;
        for (i = 0; i < n; ++i) r->beam_q[beam->first + i] = q[i];
    }
    judged = SYM_BEAM_SLACK * r->beam_error[b];
    if (judged < beam->negligible) judged = beam->negligible;
    if (judged > r->beam_limit) judged = r->beam_limit;
    guard->settled = sym_change_to_error(beam, largest[2], largest[3], r->beam_error[b]);
    guard->judged = sym_change_to_error(beam, largest[2], largest[3], judged);
    guard->pending = 0.0;
    return error > r->beam_limit ? SYM_BEYOND_THEORY : 0;
}

SYM_EXPORT int32_t sym_run_judge_beams(sym_run *r) {
    const sym_system *s = r->system;
    int32_t b, status = 0;
    for (b = 0; b < s->n_beams; ++b) {
        const sym_beam *beam = &s->beams[b];
        const double *reach = r->beam_reach + beam->first, *reference = r->beam_reference + beam->first;
        if (sym_beam_change(beam->n, reach, reference, r->q + beam->q) <= r->beam_guard[b].settled) continue;
        if (sym_evaluate_beam(r, b, r->t, r->q) != 0) status = SYM_BEYOND_THEORY;
    }
    return status;
}

SYM_EXPORT void sym_run_settle_beams(sym_run *r) {
    int32_t b;
    for (b = 0; b < r->system->n_beams; ++b)
        if (r->beam_guard[b].pending > 0.0) (void)sym_evaluate_beam(r, b, r->t, r->q);
}

/* Judge a beam at the end (t, q) of an accepted step, whose angles have changed by more than is settled, while the present
 * state is still the begin of the step. Returns 0 or SYM_BEYOND_THEORY. */
static int32_t sym_judge_farther(sym_run *r, int32_t b, double t, const double *q, double change) {
    const sym_beam *beam = &r->system->beams[b];
    sym_beam_guard *guard = &r->beam_guard[b];
    if (change < guard->pending) { /* the begin was the farthest */
        (void)sym_evaluate_beam(r, b, r->t, r->q);
        change = sym_beam_change(beam->n, r->beam_reach + beam->first, r->beam_reference + beam->first, q + beam->q);
    }
    if (change > guard->judged) return sym_evaluate_beam(r, b, t, q);
    guard->pending = change > guard->settled ? change : 0.0;
    return 0;
}

/* Judge the end (t, q) of an accepted step while the present state is still its begin (26d). Returns 0 or
 * SYM_BEYOND_THEORY. */
static int32_t sym_judge_step(sym_run *r, double t, const double *q) {
    const double *reach = r->beam_reach, *reference = r->beam_reference;
    int32_t b, status = 0;
    for (b = 0; b < r->system->n_beams; ++b) {
        const sym_beam *beam = r->system->beams + b;
        sym_beam_guard *guard = r->beam_guard + b;
        const double change = sym_beam_change(beam->n, reach, reference, q + beam->q);
        reach += beam->n, reference += beam->n;
        if (change <= guard->settled && !(guard->pending > 0.0)) continue;
        if (change >= guard->pending && change <= guard->judged) guard->pending = change;
        else if (sym_judge_farther(r, b, t, q, change) != 0) status = SYM_BEYOND_THEORY;
    }
    return status;
}
