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

/* Stations of a block; loops of four are what compilers make vectors of. */
enum { SYM_BEAM_BLOCK = 8 };

/* The larger of two numbers; of a second one that is none the first. */
static double sym_larger(double most, double x) { return x > most ? x : most; }

/* The largest of a number and of those of a block. */
static double sym_largest_of_block(const double block[SYM_BEAM_BLOCK], double most) {
    double larger[4];
    int32_t l;
    for (l = 0; l < 4; ++l) larger[l] = sym_larger(block[l], block[4 + l]);
    for (l = 0; l < 2; ++l) larger[l] = sym_larger(larger[l], larger[2 + l]);
    return sym_larger(sym_larger(most, larger[0]), larger[1]);
}

/* The angle of one direction at the stations of a block, squared. */
static void sym_square_angles(int32_t n, const double *angles, const double *x, double square[SYM_BEAM_BLOCK]) {
    double a[4] = {0.0, 0.0, 0.0, 0.0}, b[4] = {0.0, 0.0, 0.0, 0.0};
    int32_t i, l;
    for (i = 0; i < n; ++i, angles += SYM_BEAM_BLOCK) {
        for (l = 0; l < 4; ++l) a[l] += angles[l] * x[i];
        for (l = 0; l < 4; ++l) b[l] += angles[4 + l] * x[i];
    }
    for (l = 0; l < 4; ++l) square[l] = a[l] * a[l];
    for (l = 0; l < 4; ++l) square[4 + l] = b[l] * b[l];
}

/* Squares of the largest angles of a beam: yaw, pitch, slope, twist. */
static void sym_beam_angles(const sym_beam *beam, const double *x, double largest[4]) {
    const int32_t n_y = beam->n_y, n_z = beam->n_z, n_twist = beam->n_twist;
    const double *angles = beam->angles, *end = angles + (size_t)beam->blocks * SYM_BEAM_BLOCK * (size_t)beam->n;
    int32_t l;
    largest[0] = largest[1] = largest[2] = largest[3] = 0.0;
    while (angles < end) {
        double yaw[SYM_BEAM_BLOCK], pitch[SYM_BEAM_BLOCK], twist[SYM_BEAM_BLOCK];
        sym_square_angles(n_y, angles, x, yaw);
        angles += SYM_BEAM_BLOCK * n_y;
        sym_square_angles(n_z, angles, x + n_y, pitch);
        angles += SYM_BEAM_BLOCK * n_z;
        sym_square_angles(n_twist, angles, x + n_y + n_z, twist);
        angles += SYM_BEAM_BLOCK * n_twist;
        largest[0] = sym_largest_of_block(yaw, largest[0]);
        largest[1] = sym_largest_of_block(pitch, largest[1]);
        for (l = 0; l < SYM_BEAM_BLOCK; ++l) yaw[l] += pitch[l];
        largest[2] = sym_largest_of_block(yaw, largest[2]);
        largest[3] = sym_largest_of_block(twist, largest[3]);
    }
}

/* The square of the largest slope of a beam that bends in the x-y plane alone. */
static double sym_planar_slope(const sym_beam *beam, const double *x) {
    const int32_t n = beam->n;
    const double *angles = beam->angles;
    double most = 0.0;
    int32_t block, i, l;
    for (block = beam->blocks; block > 0; --block) {
        double a[4] = {0.0, 0.0, 0.0, 0.0}, b[4] = {0.0, 0.0, 0.0, 0.0};
        for (i = 0; i < n; ++i, angles += SYM_BEAM_BLOCK) {
            for (l = 0; l < 4; ++l) a[l] += angles[l] * x[i];
            for (l = 0; l < 4; ++l) b[l] += angles[4 + l] * x[i];
        }
        for (l = 0; l < 4; ++l) a[l] *= a[l];
        for (l = 0; l < 4; ++l) b[l] *= b[l];
        for (l = 0; l < 4; ++l) a[l] = sym_larger(a[l], b[l]);
        for (l = 0; l < 2; ++l) a[l] = sym_larger(a[l], a[l + 2]);
        most = sym_larger(sym_larger(most, a[0]), a[1]);
    }
    return most;
}

/* By which factor a beam's error may lie above the largest one before a step is judged, and its root: as (24) grows with the
 * square of the slope at most, the factor of norms that stays below. */
#define SYM_BEAM_SLACK 1.10
#define SYM_BEAM_NORM_SLACK 1.0488

/* The norm of (26d) that an error has at least. Without twist this inverts (24). */
static double sym_norm_of_error(const sym_beam *beam, double error) {
    const double y = 0.5 * SYM_BEAM_LARGE_SLOPE / SYM_BEAM_SLOPE_ERROR * error;
    return sqrt(error / SYM_BEAM_SLOPE_ERROR * (beam->contrast > 0.0 ? 1.0 : y + sqrt(1.0 + y * y)));
}

/* The norm by which a beam is judged: the slope; with a contrast of stiffness the smaller of (26d). */
enum { SYM_BEAM_UNKNOWN = 0, SYM_BEAM_SLOPE, SYM_BEAM_UNTWISTED, SYM_BEAM_TWISTED };

/* The square of the norm (26d) from those of the largest angles: of the smaller one where there are two; which one. */
static double sym_beam_norm(const sym_beam *beam, const sym_beam_guard *guard, const double largest[4], int32_t *norm) {
    double untwisted, twisted;
    *norm = SYM_BEAM_SLOPE;
    if (!(beam->contrast > 0.0)) return largest[2];
    untwisted = largest[2] + guard->of_twist * largest[3];
    twisted = guard->of_yaw * largest[0] + guard->of_pitch * largest[1];
    *norm = twisted < untwisted ? SYM_BEAM_TWISTED : SYM_BEAM_UNTWISTED;
    return twisted < untwisted ? twisted : untwisted;
}

/* From here on changes of a beam's coordinates count in that norm. */
static void sym_set_beam_norm(sym_run *r, int32_t b, int32_t norm) {
    const sym_beam *beam = &r->system->beams[b];
    sym_beam_guard *guard = &r->beam_guard[b];
    const double *reach = r->beam_reach + beam->first, *scale = r->beam_scale + beam->first;
    const double yaw = norm == SYM_BEAM_TWISTED ? guard->of_yaw : 1.0, pitch = norm == SYM_BEAM_TWISTED ? guard->of_pitch : 1.0;
    const double twist = norm == SYM_BEAM_UNTWISTED ? guard->of_twist : 0.0;
    double *weight = r->beam_weight + beam->v, *scaled_weight = r->beam_reference + 2 * beam->first + beam->n;
    int32_t i;
    for (i = 0; i < beam->n; ++i) {
        weight[i] = reach[i] * sqrt(i < beam->n_y ? yaw : i < beam->n_y + beam->n_z ? pitch : twist);
        scaled_weight[i] = weight[i] / scale[i];
    }
    guard->norm = norm;
}

/* Beyond which norm a step is judged, from that of the largest error. */
static void sym_set_beam_target(sym_beam_guard *guard) {
    const double target = SYM_BEAM_NORM_SLACK * guard->largest;
    guard->target = target < guard->least ? guard->least : target > guard->limit ? guard->limit : target;
}

/* What a beam is judged by, at first and where the limit has changed. */
static void sym_start_beam(const sym_run *r, int32_t b) {
    const sym_beam *beam = &r->system->beams[b];
    sym_beam_guard *guard = &r->beam_guard[b];
    const double difference = fabs(beam->EI_z - beam->EI_y) / SYM_BEAM_SLOPE_ERROR;
    guard->of_twist = beam->contrast / SYM_BEAM_SLOPE_ERROR;
    guard->of_yaw = 1.0 + (beam->contrast > 0.0 ? difference / beam->EI_z : 0.0);
    guard->of_pitch = 1.0 + (beam->contrast > 0.0 ? difference / beam->EI_y : 0.0);
    guard->largest = sym_norm_of_error(beam, r->beam_error[b]);
    guard->least = sym_norm_of_error(beam, beam->negligible);
    guard->limit = sym_norm_of_error(beam, r->beam_limit), guard->beam_limit = r->beam_limit;
    guard->evaluated = HUGE_VAL, guard->leading = -1;
    sym_set_beam_target(guard);
}

/* Keep the error of a beam, from squares of its largest angles, if it is the largest one so far. Returns 0 or
 * SYM_BEYOND_THEORY. */
static int32_t sym_keep_beam(sym_run *r, int32_t b, double t, const double *q, const double largest[4]) {
    const sym_beam *beam = r->system->beams + b;
    sym_beam_guard *guard = r->beam_guard + b;
    const double error = sym_beam_error(beam, largest[0], largest[1], largest[2], largest[3]);
    double *kept = r->beam_q + beam->first;
    int32_t i;
    if (!(error > r->beam_error[b])) return 0;
    r->beam_error[b] = error, r->beam_t[b] = t;
    for (i = 0; i < beam->n; ++i) kept[i] = q[i];
    guard->largest = beam->contrast > 0.0 ? sym_norm_of_error(beam, error) : guard->evaluated;
    sym_set_beam_target(guard);
    return error > r->beam_limit ? SYM_BEYOND_THEORY : 0;
}

/* Which of a beam's coordinates adds most to its norm. */
static int32_t sym_leading_coordinate(int32_t n, const double *weight, const double *x) {
    double most = 0.0;
    int32_t i, leading = 0;
    for (i = 0; i < n; ++i)
        if (weight[i] * fabs(x[i]) > most) most = weight[i] * fabs(x[i]), leading = i;
    return leading;
}

/* Evaluate the norm of a beam with elastic coordinates q, and its error where that may be the largest one. Returns 0 or
 * SYM_BEYOND_THEORY. */
static int32_t sym_evaluate_beam(sym_run *r, int32_t b, double t, const double *q) {
    const sym_beam *beam = r->system->beams + b;
    sym_beam_guard *guard = r->beam_guard + b;
    const double *scale = r->beam_scale + beam->first;
    double *x = r->beam_reference + 2 * beam->first, largest[4], square;
    int32_t i, norm = SYM_BEAM_SLOPE;
    for (i = 0; i < beam->n; ++i) x[i] = scale[i] * q[i];
    if (beam->n == beam->n_y) {
        square = largest[0] = largest[2] = sym_planar_slope(beam, x), largest[1] = largest[3] = 0.0;
    } else {
        sym_beam_angles(beam, x, largest);
        square = sym_beam_norm(beam, guard, largest, &norm);
    }
    guard->evaluated = sqrt(square), guard->leading = -1;
    if (norm != guard->norm) sym_set_beam_norm(r, b, norm);
    if (guard->evaluated > guard->largest) return sym_keep_beam(r, b, t, q, largest);
    guard->leading = sym_leading_coordinate(beam->n, x + beam->n, x);
    return 0;
}

/* A bound of a beam's norm from where it was evaluated last, by the change of its elastic coordinates q since then (26d). */
static double sym_bound_by_change(const sym_run *r, int32_t b, const double *q) {
    const sym_beam *beam = r->system->beams + b;
    const double *x = r->beam_reference + 2 * beam->first, *weight = x + beam->n, *scale = r->beam_scale + beam->first;
    double bound = r->beam_guard[b].evaluated;
    int32_t i;
    for (i = 0; i < beam->n; ++i) bound += weight[i] * fabs(scale[i] * q[i] - x[i]);
    return bound;
}

/* The same by a multiple of the deformation there, which has no bound where the leading coordinate is zero (26e). */
static double sym_bound_by_shape(const sym_run *r, int32_t b, const double *q) {
    const sym_beam *beam = r->system->beams + b;
    const int32_t leading = r->beam_guard[b].leading;
    const double *x = r->beam_reference + 2 * beam->first, *weight = x + beam->n, *scale = r->beam_scale + beam->first;
    double share, bound;
    int32_t i;
    if (x[leading] == 0.0) return HUGE_VAL;
    share = scale[leading] * q[leading] / x[leading], bound = fabs(share) * r->beam_guard[b].evaluated;
    for (i = 0; i < beam->n; ++i) bound += weight[i] * fabs(scale[i] * q[i] - share * x[i]);
    return bound;
}

/* Judge a beam whose norm may be larger than is to be judged. Returns 0 or SYM_BEYOND_THEORY. */
static int32_t sym_judge_beam(sym_run *r, int32_t b, double t, const double *q) {
    sym_beam_guard *guard = r->beam_guard + b;
    int32_t status;
    if (guard->leading >= 0) {
        guard->margin = guard->target - sym_bound_by_shape(r, b, q);
        if (guard->margin >= 0.0) return 0;
    }
    status = sym_evaluate_beam(r, b, t, q);
    guard->margin = guard->target - guard->evaluated;
    return status;
}

/* Judge the beams in a configuration q, which is no farther from where they were judged last than the way since then. Returns
 * 0 or SYM_BEYOND_THEORY. */
static int32_t sym_judge_beams(sym_run *r, double t, const double *q) {
    const double way = r->beam_way;
    double margin = HUGE_VAL;
    int32_t b, status = 0;
    for (b = 0; b < r->system->n_beams; ++b) {
        sym_beam_guard *guard = r->beam_guard + b;
        guard->margin -= way;
        if (guard->margin < 0.0) status |= sym_judge_beam(r, b, t, q + r->system->beams[b].q);
        if (guard->margin < margin) margin = guard->margin;
    }
    r->beam_way = 0.0, r->beam_margin = r->project && b > 0 ? -1.0 : margin; /* projections change the end of each step */
    return status;
}

/* The same whatever way the beams went. */
static int32_t sym_judge_beams_anew(sym_run *r, double t, const double *q) {
    int32_t b;
    for (b = 0; b < r->system->n_beams; ++b) {
        sym_beam_guard *guard = r->beam_guard + b;
        if (guard->norm == SYM_BEAM_UNKNOWN || guard->beam_limit != r->beam_limit) sym_start_beam(r, b);
        guard->margin = guard->target - sym_bound_by_change(r, b, q + r->system->beams[b].q);
    }
    r->beam_way = 0.0;
    return sym_judge_beams(r, t, q);
}

SYM_EXPORT int32_t sym_run_judge_beams(sym_run *r) { return sym_judge_beams_anew(r, r->t, r->q); }

SYM_EXPORT void sym_run_settle_beams(sym_run *r) {
    int32_t b;
    for (b = 0; b < r->system->n_beams; ++b) {
        sym_beam_guard *guard = r->beam_guard + b;
        const double *q = r->q + r->system->beams[b].q;
        if (guard->norm == SYM_BEAM_UNKNOWN || sym_bound_by_change(r, b, q) <= guard->largest) continue;
        (void)sym_evaluate_beam(r, b, r->t, q);
        guard->margin = guard->target - guard->evaluated + r->beam_way; /* the way that is counted off later */
    }
}

/* Judge the end (t, q) of an accepted step, whose way is that of its y1 unless it was changed afterwards: it is infinite then
 * (26d). Returns 0 or SYM_BEYOND_THEORY. */
static int32_t sym_judge_step(sym_run *r, double t, const double *q) {
    r->beam_way += r->beam_step_way;
    if (r->beam_way <= r->beam_margin) return 0;
    return r->project || r->beam_way >= HUGE_VAL ? sym_judge_beams_anew(r, t, q) : sym_judge_beams(r, t, q);
}

/* Whether all of y1, the end of a step, are numbers of a size that a motion may have; its way in the norms of the beams. */
static int32_t sym_check_end_of_step(sym_run *r, const double *y1) {
    const int32_t nv = r->system->nv;
    const double *weight = r->beam_weight;
    double size = 0.0, way = 0.0;
    int32_t i;
    if (r->system->n_beams == 0) return sym_all_finite(2 * nv, y1);
    for (i = 0; i < nv; ++i) {
        const double moved = fabs(y1[i]);
        size += moved, way += weight[i] * moved;
        size += fabs(y1[nv + i]);
    }
    r->beam_step_way = way;
    return size <= SYM_LARGEST_OF_MOTION;
}
