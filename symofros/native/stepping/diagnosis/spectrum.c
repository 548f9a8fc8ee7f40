/* What a step of length h sees of the spectrum: a Krylov subspace of the derivative of the slope by the state
 * (docs/theory/simulation.md, section 8). States are scaled, x = (theta, h (v - v_0)), so that the eigenvalues are those
 * of h times the linearised motion. A speed that is a state of a force or a block has a scale of its own in place of h,
 * and its integral, the idle coordinate beside it, stays: neither has the units of the motion. */

/* Whether changes are brought back onto the constraints, as a motion has none that leave them. The way by which gains pull
 * it back is known without looking. */
static int32_t sym_keeps_to_constraints(const sym_system *s) { return s->nc > 0 && s->project.function != NULL; }

/* y = (theta, v) <- the nearest one on the constraints. Returns 0 or a status. */
static int32_t sym_project_chart_state(sym_run *r, double *y) {
    sym_system *s = r->system;
    int32_t status;
    sym_load_chart_state(r, r->t, y);
    status = sym_project_point(s);
    sym_chart_coordinates(s, r->q, s->q, y);
    memcpy(y + s->nv, s->v, (size_t)s->nv * sizeof *y);
    return status;
}

/* The state <- the nearest one on the constraints: about another one, where gains or nothing keep the run to them, what is
 * nearest is no smooth function where conditions repeat each other on the constraints alone. y: work (2 nv). Returns 0 or a
 * status. */
static int32_t sym_start_on_constraints(sym_run *r, double *y) {
    const sym_system *s = r->system;
    int32_t status;
    memset(y, 0, (size_t)s->nv * sizeof *y);
    memcpy(y + s->nv, r->v, (size_t)s->nv * sizeof *y);
    status = sym_project_chart_state(r, y);
    if (status != 0) return status;
    memcpy(r->q, s->q, (size_t)s->nq * sizeof *r->q);
    memcpy(r->v, s->v, (size_t)s->nv * sizeof *r->v);
    return 0;
}

/* slope = h scale (theta', v') at x, (16a). y: work (2 nv). Returns 0 or a status. */
static int32_t sym_scaled_slope(sym_run *r, double h, const double *scale, const double *x, double *y, double *slope) {
    const int32_t nv = r->system->nv;
    int32_t i, status;
    for (i = 0; i < nv; ++i) y[i] = scale[i] * x[i], y[nv + i] = r->v[i] + x[nv + i] / scale[nv + i];
    if (sym_keeps_to_constraints(r->system) && (status = sym_project_chart_state(r, y)) != 0) return status;
    status = sym_evaluate_slope(r, r->t, y, slope);
    for (i = 0; i < 2 * nv; ++i) slope[i] *= h * scale[i];
    return status;
}

/* scale (2 nv) <- that of theta and v, and slope <- that at the state, by these. Of the speeds that are states, none is to
 * change by more in a step than the motion does, as what is differenced has its size. y: work (2 nv). Returns 0 or a status. */
static int32_t sym_scales(sym_run *r, double h, const int32_t *moving, double *scale, double *y, double *slope) {
    const int32_t nv = r->system->nv;
    double size = 0.0;
    int32_t i, status;
    for (i = 0; i < nv; ++i) scale[i] = moving[i] ? 1.0 : 0.0, scale[nv + i] = moving[i] ? h : 1.0;
    memset(y + 2 * nv, 0, 2 * (size_t)nv * sizeof *y);
    status = sym_scaled_slope(r, h, scale, y + 2 * nv, y, slope);
    if (status != 0) return status;
    for (i = 0; i < nv; ++i)
        if (moving[i]) size += slope[i] * slope[i] + slope[nv + i] * slope[nv + i];
    size = sqrt(size);
    for (i = nv; i < 2 * nv && size > 0.0; ++i)
        if (!moving[i - nv] && fabs(slope[i]) > size) scale[i] = size / fabs(slope[i]), slope[i] *= scale[i];
    return 0;
}

/* The components of x (n) along the rows of an orthonormal basis, taken out of x; twice for the sake of rounding. */
static void sym_orthogonalize(int32_t n, int32_t rows, const double *basis, double *x, double *components) {
    int32_t pass, i, l;
    for (i = 0; i < rows; ++i) components[i] = 0.0;
    for (pass = 0; pass < 2; ++pass)
        for (i = 0; i < rows; ++i) {
            const double *b = basis + (size_t)i * (size_t)n;
            double s = 0.0;
            for (l = 0; l < n; ++l) s += b[l] * x[l];
            for (l = 0; l < n; ++l) x[l] -= s * b[l];
            components[i] += s;
        }
}

/* Make x (n) of unit length; returns the length it had. */
static double sym_normalize(int32_t n, double *x) {
    double s = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) s += x[i] * x[i];
    s = sqrt(s);
    for (i = 0; i < n && s > 0.0; ++i) x[i] /= s;
    return s;
}

/* Share of the first vector that has no special direction, so that modes without motion are seen, too. */
#define SYM_SPECTRUM_MIXTURE 1e-3
/* Least change of a coordinate for a difference, relative to the largest one: its error by rounding is 1e-8. */
#define SYM_SPECTRUM_LEAST_CHANGE 1e-8
/* Most where changes are projected: one of a length is to be small against mechanisms of a tenth of a millimetre, beyond
 * which the nearest posture on the constraints is another one. */
#define SYM_SPECTRUM_PROJECTED_CHANGE 1e-6

/* basis[0] <- the direction of the motion, mixed with others. Returns the change of the state by the motion of a step,
 * or the most that is projected. */
static double sym_first_direction(const sym_run *r, int32_t n, const double *slope, double *first) {
    double size, largest = 1.0;
    uint32_t seed = 1;
    int32_t i;
    memcpy(first, slope, (size_t)n * sizeof *first);
    size = sym_normalize(n, first);
    for (i = 0; i < n; ++i) {
        seed = seed * 1664525u + 1013904223u;
        first[i] += SYM_SPECTRUM_MIXTURE * ((double)seed / 2147483648.0 - 1.0);
    }
    sym_normalize(n, first);
    for (i = 0; i < r->system->nq; ++i) largest = fabs(r->q[i]) > largest ? fabs(r->q[i]) : largest;
    if (sym_keeps_to_constraints(r->system) && size > SYM_SPECTRUM_PROJECTED_CHANGE * largest)
        size = SYM_SPECTRUM_PROJECTED_CHANGE * largest;
    return size > SYM_SPECTRUM_LEAST_CHANGE * largest ? size : SYM_SPECTRUM_LEAST_CHANGE * largest;
}

/* Least rotation by which a change may turn [rad], where the motion of a step turns by less: that of metres says nothing of
 * radians, as a body that flies by kilometres in a step does not turn by thousands of radians. */
#define SYM_SPECTRUM_TURN 1e-4

/* The size of the rotations among a change x (2 nv) of the state. */
static double sym_turned(int32_t nv, const int32_t *moving, const double *x) {
    double s = 0.0;
    int32_t i;
    for (i = 0; i < nv; ++i)
        if (moving[i] == 2) s += x[i] * x[i] + x[nv + i] * x[nv + i];
    return sqrt(s);
}

SYM_EXPORT int32_t sym_run_spectrum(sym_run *r, double h, const int32_t *moving, int32_t dimension, double *basis,
                                    double *matrix, double *motion) {
    const int32_t n = 2 * r->system->nv;
    double *slope = basis + (size_t)dimension * (size_t)n, *scale = slope + n, *next = scale + n, *y = next + n, *x = y + n;
    double most, turn, change, length;
    int32_t i, j, k, status;
    memset(matrix, 0, (size_t)dimension * (size_t)dimension * sizeof *matrix);
    status = sym_keeps_to_constraints(r->system) ? sym_start_on_constraints(r, y) : 0;
    if (status == 0) status = sym_scales(r, h, moving, scale, y, slope);
    if (status != 0) return status;
    most = sym_first_direction(r, n, slope, basis);
    turn = sym_turned(n / 2, moving, slope);
    if (!(turn > SYM_SPECTRUM_TURN)) turn = SYM_SPECTRUM_TURN;
    for (j = 0; j < dimension; ++j) {
        change = sym_turned(n / 2, moving, basis + (size_t)j * (size_t)n);
        change = most * change > turn ? turn / change : most;
        for (i = 0; i < n; ++i) x[i] = change * basis[SYM_INDEX(j, n, i)];
        status = sym_scaled_slope(r, h, scale, x, y, next);
        if (status != 0) return status;
        for (i = 0; i < n; ++i) next[i] = (next[i] - slope[i]) / change;
        sym_orthogonalize(n, j + 1, basis, next, motion); /* motion: work until the end */
        for (k = 0; k <= j; ++k) matrix[SYM_INDEX(k, dimension, j)] = motion[k];
        length = sym_normalize(n, next);
        if (j + 1 == dimension || !(length > 0.0)) break; /* at 0 the subspace is invariant, and the rest of matrix 0 */
        matrix[SYM_INDEX(j + 1, dimension, j)] = length;
        memcpy(basis + (size_t)(j + 1) * n, next, (size_t)n * sizeof *next);
    }
    dimension = j + 1 < dimension ? j + 1 : dimension;
    sym_orthogonalize(n, dimension, basis, slope, motion);
    return dimension;
}
