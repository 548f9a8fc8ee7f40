/* Forces of several balls on surfaces by Coulomb's law: a small problem with cones, at the level of accelerations or of speeds
 * (docs/theory/constraints.md, section 15, (46) and (47)). */

enum { SYM_DIRECT_TURNS = 25, SYM_MOST_REFINEMENTS = 12 };
/* Difference of angles by which rates are taken; angle that is rounding [rad]. */
#define SYM_ANGLE_STEP 1e-7
#define SYM_ANGLE_ROUNDING 1e-15
/* Shares that are rounding: of a normal force, of what a ball's point does, of what cones have left where several balls share a
 * load. */
#define SYM_FORCE_ROUNDING 1e-12
#define SYM_CONTACT_ROUNDING 1e-10
#define SYM_MARGIN_ROUNDING 1e-9
/* What points that other constraints hold do by rounding [m/s^2, m/s]. */
#define SYM_HELD_POINTS 1e-13

typedef struct sym_contact_problem { /* c = W f + b, of n balls: x, y and normal of each */
    int32_t n;
    double W[SYM_MOST_FORCES * SYM_MOST_FORCES], b[SYM_MOST_FORCES], mu[SYM_MOST_CONTACTS];
    int32_t parts[SYM_MOST_CONTACTS];   /* whether one moves away, and feels no force */
    int32_t slides[SYM_MOST_CONTACTS];  /* whether one slides in a direction that is known: */
    double d[2 * SYM_MOST_CONTACTS];
    double size;                        /* of b */
    double last[SYM_MOST_CONTACTS];     /* modes of the motion before: a guess */
    /* The solution: modes, forces, c, and the motion that follows. */
    double mode[SYM_MOST_CONTACTS], f[SYM_MOST_FORCES], c[SYM_MOST_FORCES];
    int32_t shared;                     /* whether balls that stick share their load in more than one way */
} sym_contact_problem;

/* What balls that stick have left of their cones with the forces f (3 n), over their load; *shared: whether they share it in
 * more than one way. */
static double sym_sticking_margin(const sym_contact_problem *p, const double *mode, const double *f, int32_t *shared) {
    double A[SYM_MOST_FORCES * SYM_MOST_FORCES], null[SYM_MOST_FORCES * SYM_MOST_FORCES], x[SYM_MOST_FORCES];
    double own[SYM_MOST_FORCES], mu[SYM_MOST_CONTACTS];
    const double none[SYM_MOST_FORCES] = {0.0};
    int32_t which[SYM_MOST_CONTACTS], n = 0, i, j, k, l, count, idle = 0;
    *shared = 0;
    for (i = 0; i < p->n; ++i)
        if (mode[i] == SYM_STICKS) which[n++] = i;
    if (n == 0) return HUGE_VAL;
    for (i = 0; i < n; ++i) {
        mu[i] = p->mu[which[i]];
        for (k = 0; k < 3; ++k) {
            own[3 * i + k] = f[3 * which[i] + k];
            for (j = 0; j < n; ++j)
                for (l = 0; l < 3; ++l)
                    A[3 * n * (3 * i + k) + 3 * j + l] = p->W[3 * p->n * (3 * which[i] + k) + 3 * which[j] + l];
        }
    }
    count = sym_least_norm(3 * n, A, none, x, null);
    for (j = 0; j < count;) { /* directions in which nothing moves and no force acts, as across a plane mechanism, are left out */
        double *direction = null + 3 * n * j;
        int32_t normal = 0;
        for (i = 0; i < n; ++i) normal |= fabs(direction[3 * i + 2]) > SYM_CONTACT_ROUNDING;
        for (i = 0, idle = !normal; i < 3 * n && idle; ++i) {
            const double *row = p->W + 3 * p->n * (3 * which[i / 3] + i % 3);
            idle = fabs(direction[i]) <= SYM_CONTACT_ROUNDING || row[3 * which[i / 3] + i % 3] <= SYM_CONTACT_ROUNDING * p->W[3 * p->n * (3 * which[i / 3] + 2) + 3 * which[i / 3] + 2];
        }
        if (!idle) {
            ++j;
            continue;
        }
        --count;
        memcpy(direction, null + 3 * n * count, (size_t)(3 * n) * sizeof *direction);
    }
    *shared = count > 0;
    return sym_shared_margin(n, count, mu, own, null);
}

/* Motion c of a ball by forces f on all. */
static void sym_motion_of_ball(const sym_contact_problem *p, const double *f, int32_t ball, double *c) {
    int32_t j, k;
    for (k = 0; k < 3; ++k) {
        const double *row = p->W + 3 * p->n * (3 * ball + k);
        for (j = 0, c[k] = p->b[3 * ball + k]; j < 3 * p->n; ++j) c[k] += row[j] * f[j];
    }
}

/* Forces and c where the balls have modes, directions of those that begin to slide included: the balls that stick do not move,
 * those that slide stay on their planes, (47). */
static void sym_forces_of_modes(sym_contact_problem *p) {
    double A[SYM_MOST_FORCES * SYM_MOST_FORCES], regular[SYM_MOST_FORCES * SYM_MOST_FORCES], y[SYM_MOST_FORCES] = {0.0}, x[SYM_MOST_FORCES];
    int32_t ball[SYM_MOST_FORCES], axis[SYM_MOST_FORCES], m = 0, i, j, k;
    const int32_t n = 3 * p->n;
    for (i = 0; i < p->n; ++i) {
        if (p->mode[i] == SYM_OPEN) continue;
        for (k = p->mode[i] == SYM_STICKS ? 0 : 2; k < 3; ++k) ball[m] = i, axis[m++] = k;
    }
    for (i = 0; i < m; ++i) {
        const double *row = p->W + n * (3 * ball[i] + axis[i]);
        y[i] = -p->b[3 * ball[i] + axis[i]];
        for (j = 0; j < m; ++j) {
            const double *d = p->d + 2 * ball[j];
            A[m * i + j] = row[3 * ball[j] + axis[j]];
            if (p->mode[ball[j]] == SYM_SLIDES)
                A[m * i + j] -= p->mu[ball[j]] * (row[3 * ball[j]] * d[0] + row[3 * ball[j] + 1] * d[1]);
        }
    }
    memcpy(regular, A, (size_t)(m * m) * sizeof *A);
    if (!sym_solve_regular(m, regular, y, x)) (void)sym_least_norm(m, A, y, x, NULL);
    for (i = 0; i < n; ++i) p->f[i] = 0.0;
    for (i = 0; i < m; ++i) {
        p->f[3 * ball[i] + axis[i]] = x[i];
        if (p->mode[ball[i]] != SYM_SLIDES) continue;
        for (k = 0; k < 2; ++k) p->f[3 * ball[i] + k] = -p->mu[ball[i]] * x[i] * p->d[2 * ball[i] + k];
    }
    for (i = 0; i < p->n; ++i) sym_motion_of_ball(p, p->f, i, p->c + 3 * i);
}

/* Whether modes agree with the motion that they bring about, (46). */
static int32_t sym_modes_agree(sym_contact_problem *p) {
    const double tolerance = SYM_CONTACT_ROUNDING * p->size;
    double largest = 0.0, margin;
    int32_t i;
    for (i = 0; i < p->n; ++i) largest = fmax(largest, fabs(p->f[3 * i + 2]));
    for (i = 0; i < p->n; ++i) {
        const double *c = p->c + 3 * i, *d = p->d + 2 * i;
        if (p->parts[i]) continue;
        if (p->mode[i] == SYM_OPEN) {
            if (c[2] < -tolerance) return 0;
            continue;
        }
        if (fabs(c[2]) > tolerance || (p->mode[i] == SYM_STICKS && hypot(c[0], c[1]) > tolerance)) return 0;
        if (p->mode[i] == SYM_STICKS) continue;
        if (!(p->f[3 * i + 2] > SYM_FORCE_ROUNDING * largest)) return 0;
        if (p->mu[i] > 0.0 && !p->slides[i] && (c[0] * d[0] + c[1] * d[1] < -tolerance || fabs(c[0] * d[1] - c[1] * d[0]) > tolerance)) return 0;
    }
    margin = sym_sticking_margin(p, p->mode, p->f, &p->shared);
    return margin > (p->shared ? SYM_MARGIN_ROUNDING : SYM_FORCE_ROUNDING);
}

/* What balls that slide do with forces on them alone, c = R f + r, those that stick not moving: for many directions of one set
 * of modes, (47a). */
typedef struct sym_sliding_problem {
    int32_t n, ball[SYM_MOST_CONTACTS];
    int32_t regular; /* whether forces on the balls that stick are determined; if not, there is no R */
    double R[SYM_MOST_FORCES * SYM_MOST_FORCES], r[SYM_MOST_FORCES];
} sym_sliding_problem;

/* That of the problem's modes. */
static void sym_reduce_to_sliding(const sym_contact_problem *p, sym_sliding_problem *at) {
    double A[SYM_MOST_FORCES * SYM_MOST_FORCES], copy[SYM_MOST_FORCES * SYM_MOST_FORCES], y[SYM_MOST_FORCES], x[SYM_MOST_FORCES];
    int32_t sticks[SYM_MOST_FORCES], m = 0, rows, i, j, k;
    const int32_t n = 3 * p->n;
    at->n = 0, at->regular = 1;
    for (i = 0; i < p->n; ++i) {
        if (p->mode[i] == SYM_SLIDES) at->ball[at->n++] = i;
        for (k = 0; k < 3 && p->mode[i] == SYM_STICKS; ++k) sticks[m++] = 3 * i + k;
    }
    rows = 3 * at->n;
    for (i = 0; i < m; ++i)
        for (j = 0; j < m; ++j) A[m * i + j] = p->W[n * sticks[i] + sticks[j]];
    for (j = 0; j <= rows; ++j) { /* the last column is r */
        const int32_t from = j < rows ? 3 * at->ball[j / 3] + j % 3 : -1;
        for (i = 0; i < m; ++i) y[i] = from < 0 ? p->b[sticks[i]] : p->W[n * sticks[i] + from];
        memcpy(copy, A, (size_t)(m * m) * sizeof *A);
        if (m > 0 && !sym_solve_regular(m, copy, y, x)) {
            at->regular = 0;
            return;
        }
        for (i = 0; i < rows; ++i) {
            const int32_t row = 3 * at->ball[i / 3] + i % 3;
            double c = from < 0 ? p->b[row] : p->W[n * row + from];
            for (k = 0; k < m; ++k) c -= p->W[n * row + sticks[k]] * x[k];
            if (from < 0) at->r[i] = c;
            else at->R[rows * i + j] = c;
        }
    }
}

/* Forces and c of the balls that slide, in the directions of the problem, and of no others; at: NULL, or no R: of all. */
static void sym_motion_of_sliding(sym_contact_problem *p, const sym_sliding_problem *at) {
    double A[SYM_MOST_CONTACTS * SYM_MOST_CONTACTS], y[SYM_MOST_CONTACTS], x[SYM_MOST_CONTACTS], f[SYM_MOST_FORCES];
    const int32_t n = at != NULL ? at->n : 0, rows = 3 * n;
    int32_t i, j;
    for (i = 0; i < n && at->regular; ++i) {
        const double *row = at->R + rows * (3 * i + 2);
        y[i] = -at->r[3 * i + 2];
        for (j = 0; j < n; ++j) {
            const double *d = p->d + 2 * at->ball[j];
            A[n * i + j] = row[3 * j + 2] - p->mu[at->ball[j]] * (row[3 * j] * d[0] + row[3 * j + 1] * d[1]);
        }
    }
    if (at == NULL || !at->regular || !sym_solve_regular(n, A, y, x)) {
        sym_forces_of_modes(p);
        return;
    }
    for (i = 0; i < n; ++i) {
        const double *d = p->d + 2 * at->ball[i], drag = p->mu[at->ball[i]] * x[i];
        f[3 * i] = -drag * d[0], f[3 * i + 1] = -drag * d[1], f[3 * i + 2] = x[i];
        memcpy(p->f + 3 * at->ball[i], f + 3 * i, 3 * sizeof *f);
    }
    for (i = 0; i < rows; ++i) {
        double *c = p->c + 3 * at->ball[i / 3] + i % 3;
        for (j = 0, *c = at->r[i]; j < rows; ++j) *c += at->R[rows * i + j] * f[j];
    }
}

typedef struct sym_ball_in_problem { /* a ball that begins to slide, the others staying */
    sym_contact_problem *problem;
    const sym_sliding_problem *sliding;
    int32_t ball;
} sym_ball_in_problem;

/* Its c, where it slides in the direction d. */
static double sym_c_of_direction(void *data, const double *d, double *along) {
    const sym_ball_in_problem *of = (const sym_ball_in_problem *)data;
    const double *c = of->problem->c + 3 * of->ball;
    memcpy(of->problem->d + 2 * of->ball, d, 2 * sizeof *d);
    sym_motion_of_sliding(of->problem, of->sliding);
    *along = of->problem->f[3 * of->ball + 2] > 0.0 ? c[0] * d[0] + c[1] * d[1] : -1.0; /* planes do not draw */
    return c[0] * d[1] - c[1] * d[0];
}

/* Angle from what a ball leaves to the direction in which it begins to slide, as a sine; zero where it leaves nothing. */
static double sym_off_direction(const sym_contact_problem *p, int32_t ball) {
    const double *c = p->c + 3 * ball, *d = p->d + 2 * ball, size = hypot(c[0], c[1]);
    if (!(size > 0.0)) return 0.0;
    return c[0] * d[0] + c[1] * d[1] > 0.0 ? (c[0] * d[1] - c[1] * d[0]) / size : 1.0;
}

static void sym_turn_direction(double *d, double angle) {
    const double x = d[0], y = d[1], cosine = cos(angle), sine = sin(angle), size = hypot(x, y);
    d[0] = (cosine * x - sine * y) / size, d[1] = (sine * x + cosine * y) / size;
}

/* Turn balls that begin to slide, in number order, so that friction opposes what they leave, by Newton's method with differences:
 * the angle by which each is off falls to rounding. */
static void sym_refine_directions(sym_contact_problem *p, const sym_sliding_problem *at, int32_t count, const int32_t *which) {
    double J[SYM_MOST_CONTACTS * SYM_MOST_CONTACTS], off[SYM_MOST_CONTACTS], turn[SYM_MOST_CONTACTS], d[2 * SYM_MOST_CONTACTS];
    int32_t round, i, j;
    for (round = 0; round < SYM_MOST_REFINEMENTS; ++round) {
        double largest = 0.0;
        sym_motion_of_sliding(p, at);
        for (i = 0; i < count; ++i) off[i] = sym_off_direction(p, which[i]), largest = fmax(largest, fabs(off[i]));
        if (!(largest > SYM_ANGLE_ROUNDING) || (round > 0 && largest > 0.5)) return;
        memcpy(d, p->d, sizeof d);
        for (j = 0; j < count; ++j) {
            sym_turn_direction(p->d + 2 * which[j], SYM_ANGLE_STEP);
            sym_motion_of_sliding(p, at);
            for (i = 0; i < count; ++i) J[count * i + j] = (sym_off_direction(p, which[i]) - off[i]) / SYM_ANGLE_STEP;
            memcpy(p->d, d, sizeof d);
        }
        (void)sym_least_norm(count, J, off, turn, NULL);
        for (i = 0; i < count; ++i) sym_turn_direction(p->d + 2 * which[i], -fmax(-0.5, fmin(0.5, turn[i])));
    }
    sym_motion_of_sliding(p, at);
}

/* Whether modes agree, as they are or, better, once directions are refined. */
static int32_t sym_agree_refined(sym_contact_problem *p, int32_t count, const int32_t *which) {
    sym_contact_problem first;
    sym_forces_of_modes(p);
    if (!sym_modes_agree(p)) return 0;
    first = *p;
    if (count > 0) sym_refine_directions(p, NULL, count, which);
    if (!sym_modes_agree(p)) *p = first;
    return 1;
}

/* Turn balls that begin to slide to what they leave. Returns whether one turns. */
static int32_t sym_turn_directions(sym_contact_problem *p, int32_t count, const int32_t *which) {
    int32_t i, turns = 0;
    for (i = 0; i < count; ++i) {
        const double *c = p->c + 3 * which[i], size = hypot(c[0], c[1]);
        double *d = p->d + 2 * which[i], was[2] = {d[0], d[1]};
        if (!(size > SYM_CONTACT_ROUNDING * p->size)) continue;
        d[0] = c[0] / size, d[1] = c[1] / size;
        turns |= hypot(d[0] - was[0], d[1] - was[1]) > SYM_CONTACT_ROUNDING;
    }
    return turns;
}

/* Whether friction opposes what balls that begin to slide leave. */
static int32_t sym_directions_agree(const sym_contact_problem *p, int32_t count, const int32_t *which) {
    const double tolerance = 2.0 * SYM_CONTACT_ROUNDING * p->size;
    int32_t i;
    for (i = 0; i < count; ++i) {
        const double *c = p->c + 3 * which[i], *d = p->d + 2 * which[i];
        if (c[0] * d[0] + c[1] * d[1] < -tolerance || fabs(c[0] * d[1] - c[1] * d[0]) > tolerance) return 0;
    }
    return 1;
}

/* Whether modes agree once balls that begin to slide do so against their friction, found from the directions of the problem on:
 * of several by Newton's method, where these are near, else by iteration, which leads away from some solutions however near. */
static int32_t sym_try_modes(sym_contact_problem *p) {
    double d[2 * SYM_MOST_CONTACTS];
    int32_t which[SYM_MOST_CONTACTS], count = 0, i, round, turns = 1;
    sym_sliding_problem at;
    for (i = 0; i < p->n; ++i)
        if (p->mode[i] == SYM_SLIDES && !p->slides[i] && p->mu[i] > 0.0) which[count++] = i;
    if (count == 0) return sym_agree_refined(p, 0, which);
    sym_reduce_to_sliding(p, &at);
    if (count > 1) {
        memcpy(d, p->d, sizeof d);
        sym_refine_directions(p, &at, count, which);
        if (sym_directions_agree(p, count, which) && sym_agree_refined(p, count, which)) return 1;
        memcpy(p->d, d, sizeof d);
    }
    for (round = 0; round < SYM_DIRECT_TURNS && turns; ++round) {
        sym_motion_of_sliding(p, &at);
        if (sym_directions_agree(p, count, which) && sym_agree_refined(p, count, which)) return 1;
        turns = sym_turn_directions(p, count, which);
    }
    if (!turns && count > 1) return 0;
    if (count == 1) {
        sym_ball_in_problem ball = {p, &at, which[0]};
        if (!sym_find_direction(sym_c_of_direction, &ball, p->d + 2 * which[0])) return 0;
    } else {
        sym_refine_directions(p, &at, count, which);
    }
    return sym_agree_refined(p, count, which);
}
