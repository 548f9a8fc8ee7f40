/* Forces of several balls on planes by Coulomb's law: a small problem with cones, at the level of accelerations or of speeds
 * (docs/theory/constraints.md, section 15, (46) to (48)). */

enum { SYM_MOST_CONTACTS = 8, SYM_MOST_FORCES = 3 * SYM_MOST_CONTACTS, SYM_MOST_SWEEPS = 60, SYM_UNIQUE_UP_TO = 4, SYM_DIRECT_TURNS = 25, SYM_MOST_REFINEMENTS = 12 };
/* Difference of angles by which rates are taken; angle that is rounding [rad]. */
#define SYM_ANGLE_STEP 1e-7
#define SYM_ANGLE_ROUNDING 1e-15
/* Shares that are rounding: of singular values, of a normal force, of what a ball's point does; by which two motions differ;
 * of what cones have left where several balls share a load. */
#define SYM_SINGULAR_VALUE 1e-11
#define SYM_NO_COLUMN 1e-27 /* the square of one, of two columns */
/* Share of the largest pivot down to which a system is solved as it is, with no thought of its rank. */
#define SYM_REGULAR 1e-5
#define SYM_FORCE_ROUNDING 1e-12
#define SYM_CONTACT_ROUNDING 1e-10
#define SYM_DIFFERENT 1e-6
#define SYM_MARGIN_ROUNDING 1e-9
/* Share of the load that is so much that how else it may be shared does not matter. */
#define SYM_AMPLE 0.05

typedef struct sym_contact_problem { /* c = W f + b, of n balls: x, y and normal of each */
    int32_t n;
    double W[SYM_MOST_FORCES * SYM_MOST_FORCES], b[SYM_MOST_FORCES], mu[SYM_MOST_CONTACTS];
    int32_t parts[SYM_MOST_CONTACTS];   /* whether one moves away, and feels no force */
    int32_t slides[SYM_MOST_CONTACTS];  /* whether one slides in a direction that is known: */
    double d[2 * SYM_MOST_CONTACTS];
    double size;                        /* of b */
    /* The solution: modes, forces, c, and the motion that follows. */
    double mode[SYM_MOST_CONTACTS], f[SYM_MOST_FORCES], c[SYM_MOST_FORCES];
    int32_t shared;                     /* whether balls that stick share their load in more than one way */
} sym_contact_problem;

/* Singular values of A (n x n, row by row) by rotations of its columns: A becomes U S, column by column orthogonal, V (n x n)
 * has A_before = U S V^T. Returns the largest. */
static double sym_singular_values(int32_t n, double *A, double *V, double *values) {
    double largest = 0.0, total = 0.0;
    int32_t i, j, k, sweep, turned = 1;
    for (i = 0; i < n * n; ++i) V[i] = i % (n + 1) == 0, total += A[i] * A[i];
    for (sweep = 0; sweep < SYM_MOST_SWEEPS && turned; ++sweep) {
        turned = 0;
        for (j = 0; j < n; ++j)
            for (k = j + 1; k < n; ++k) {
                double a = 0.0, b = 0.0, along = 0.0, zeta, t, cosine, sine;
                for (i = 0; i < n; ++i) {
                    const double x = A[n * i + j], y = A[n * i + k];
                    a += x * x, b += y * y, along += x * y;
                }
                if (fabs(along) <= 1e-15 * sqrt(a * b) || a + b <= SYM_NO_COLUMN * total) continue;
                turned = 1;
                zeta = (b - a) / (2.0 * along);
                t = copysign(1.0, zeta) / (fabs(zeta) + hypot(1.0, zeta));
                cosine = 1.0 / hypot(1.0, t), sine = t * cosine;
                for (i = 0; i < n; ++i) {
                    const double x = A[n * i + j], y = A[n * i + k], p = V[n * i + j], q = V[n * i + k];
                    A[n * i + j] = cosine * x - sine * y, A[n * i + k] = sine * x + cosine * y;
                    V[n * i + j] = cosine * p - sine * q, V[n * i + k] = sine * p + cosine * q;
                }
            }
    }
    for (j = 0; j < n; ++j) {
        double square = 0.0;
        for (i = 0; i < n; ++i) square += A[n * i + j] * A[n * i + j];
        values[j] = sqrt(square);
        if (values[j] > largest) largest = values[j];
    }
    return largest;
}

/* x of least norm with A x = y as far as that can be (n x n; A is lost); null (n x the number returned): directions of x that
 * change nothing. */
static int32_t sym_least_norm(int32_t n, double *A, const double *y, double *x, double *null) {
    double V[SYM_MOST_FORCES * SYM_MOST_FORCES], values[SYM_MOST_FORCES];
    const double largest = sym_singular_values(n, A, V, values);
    int32_t i, j, count = 0;
    for (i = 0; i < n; ++i) x[i] = 0.0;
    for (j = 0; j < n; ++j) {
        double along = 0.0;
        if (!(values[j] > SYM_SINGULAR_VALUE * largest)) {
            if (null != NULL)
                for (i = 0; i < n; ++i) null[n * count + i] = V[n * i + j];
            ++count;
            continue;
        }
        for (i = 0; i < n; ++i) along += A[n * i + j] * y[i];
        along /= values[j] * values[j];
        for (i = 0; i < n; ++i) x[i] += V[n * i + j] * along;
    }
    return count;
}

/* x (n) with A x = y by elimination with complete pivoting, A being lost. Returns 0 where a pivot says that A is near to a
 * matrix of lower rank. */
static int32_t sym_solve_regular(int32_t n, double *A, const double *y, double *x) {
    double b[SYM_MOST_FORCES], first = 0.0;
    int32_t column[SYM_MOST_FORCES], i, j, k;
    for (i = 0; i < n; ++i) b[i] = y[i], column[i] = i;
    for (k = 0; k < n; ++k) {
        int32_t row = k, across = k;
        for (i = k; i < n; ++i)
            for (j = k; j < n; ++j)
                if (fabs(A[n * i + j]) > fabs(A[n * row + across])) row = i, across = j;
        if (k == 0) first = fabs(A[n * row + across]);
        if (!(fabs(A[n * row + across]) > SYM_REGULAR * first)) return 0;
        for (j = 0; j < n; ++j) {
            const double entry = A[n * k + j];
            A[n * k + j] = A[n * row + j], A[n * row + j] = entry;
        }
        for (i = 0; i < n; ++i) {
            const double entry = A[n * i + k];
            A[n * i + k] = A[n * i + across], A[n * i + across] = entry;
        }
        i = column[k], column[k] = column[across], column[across] = i;
        x[0] = b[k], b[k] = b[row], b[row] = x[0];
        for (i = k + 1; i < n; ++i) {
            const double factor = A[n * i + k] / A[n * k + k];
            for (j = k + 1; j < n; ++j) A[n * i + j] -= factor * A[n * k + j];
            b[i] -= factor * b[k];
        }
    }
    for (k = n - 1; k >= 0; --k) {
        for (j = k + 1; j < n; ++j) b[k] -= A[n * k + j] * b[j];
        b[k] /= A[n * k + k];
    }
    for (k = 0; k < n; ++k) x[column[k]] = b[k];
    return 1;
}

/* The barrier of sym_shared_margin at x = (y, s): its value, HUGE_VAL outside, and gradient and Hessian where they are wanted. */
static double sym_margin_barrier(int32_t n, int32_t k, const double *mu, const double *f, const double *null, double load, double weight,
                                 const double *x, double *gradient, double *hessian) {
    const double s = x[k], left = load - s;
    double value = -weight * s;
    int32_t i, j, l, m = k + 1;
    if (!(left > 0.0)) return HUGE_VAL;
    value -= log(left);
    if (gradient != NULL) {
        for (j = 0; j < m * m; ++j) hessian[j] = 0.0;
        for (j = 0; j < k; ++j) gradient[j] = 0.0;
        gradient[k] = -weight + 1.0 / left, hessian[m * m - 1] = 1.0 / (left * left);
    }
    for (i = 0; i < n; ++i) {
        double z[3], rows[3][SYM_MOST_FORCES + 1], g[SYM_MOST_FORCES + 1], square;
        for (l = 0; l < 3; ++l) {
            z[l] = f[3 * i + l];
            for (j = 0; j < k; ++j) rows[l][j] = null[3 * n * j + 3 * i + l], z[l] += rows[l][j] * x[j];
            rows[l][k] = 0.0;
        }
        for (j = 0; j < k; ++j) rows[2][j] *= mu[i];
        rows[2][k] = -1.0;
        z[2] = mu[i] * z[2] - s;
        square = z[2] * z[2] - z[0] * z[0] - z[1] * z[1];
        if (!(z[2] > 0.0 && square > 0.0)) return HUGE_VAL;
        value -= log(square);
        if (gradient == NULL) continue;
        for (j = 0; j < m; ++j) {
            g[j] = 2.0 * (z[2] * rows[2][j] - z[0] * rows[0][j] - z[1] * rows[1][j]) / square;
            gradient[j] -= g[j];
        }
        for (j = 0; j < m; ++j)
            for (l = 0; l < m; ++l) {
                const double across = rows[0][j] * rows[0][l] + rows[1][j] * rows[1][l];
                hessian[m * j + l] += g[j] * g[l] - 2.0 * (rows[2][j] * rows[2][l] - across) / square;
            }
    }
    return value;
}

/* What the cones of n balls that stick have left, over their load, where it is shared as well as can be: the largest share s of
 * the load with |f_t| <= mu f_n - s for all, over forces f + null y (3 n, and k directions), by Newton's method with a
 * logarithmic barrier, (48). */
static double sym_shared_margin(int32_t n, int32_t k, const double *mu, const double *f, const double *null) {
    double x[SYM_MOST_FORCES + 1], next[SYM_MOST_FORCES + 1], gradient[SYM_MOST_FORCES + 1], step[SYM_MOST_FORCES + 1];
    double hessian[(SYM_MOST_FORCES + 1) * (SYM_MOST_FORCES + 1)], load = 0.0, least = HUGE_VAL, weight;
    int32_t i, j, round, m = k + 1;
    for (i = 0; i < n; ++i) {
        load += fabs(f[3 * i]) + fabs(f[3 * i + 1]) + fabs(f[3 * i + 2]);
        least = fmin(least, mu[i] * f[3 * i + 2] - hypot(f[3 * i], f[3 * i + 1]));
    }
    if (load == 0.0) return 0.0;
    if (k == 0 || least > SYM_AMPLE * load) return least / load;
    for (j = 0; j < k; ++j) x[j] = 0.0;
    x[k] = fmin(least, 0.5 * load) - load;
    for (weight = 1.0 / load; weight < 1e12 / load; weight *= 20.0)
        for (round = 0; round < 50; ++round) {
            const double value = sym_margin_barrier(n, k, mu, f, null, load, weight, x, gradient, hessian);
            double decrease = 0.0, part = 1.0;
            for (j = 0; j < m; ++j) hessian[m * j + j] *= 1.0 + 1e-14;
            { /* Cholesky's factors; the barrier is convex */
                int32_t a, b, c;
                for (a = 0; a < m; ++a)
                    for (b = 0; b <= a; ++b) {
                        double sum = hessian[m * a + b];
                        for (c = 0; c < b; ++c) sum -= hessian[m * a + c] * hessian[m * b + c];
                        hessian[m * a + b] = a == b ? sqrt(sum > 0.0 ? sum : 1e-300) : sum / hessian[m * b + b];
                    }
                for (a = 0; a < m; ++a) {
                    step[a] = -gradient[a];
                    for (c = 0; c < a; ++c) step[a] -= hessian[m * a + c] * step[c];
                    step[a] /= hessian[m * a + a];
                }
                for (a = m - 1; a >= 0; --a) {
                    for (c = a + 1; c < m; ++c) step[a] -= hessian[m * c + a] * step[c];
                    step[a] /= hessian[m * a + a];
                }
            }
            for (j = 0; j < m; ++j) decrease -= gradient[j] * step[j];
            if (!(decrease > 1e-12)) break;
            for (; part > 1e-10; part *= 0.5) {
                for (j = 0; j < m; ++j) next[j] = x[j] + part * step[j];
                if (sym_margin_barrier(n, k, mu, f, null, load, weight, next, NULL, NULL) <= value - 0.1 * part * decrease) break;
            }
            if (!(part > 1e-10)) break;
            for (j = 0; j < m; ++j) x[j] = next[j];
        }
    return x[k] / load;
}

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
    for (i = 0; i < n; ++i) {
        p->c[i] = p->b[i];
        for (j = 0; j < n; ++j) p->c[i] += p->W[n * i + j] * p->f[j];
    }
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

typedef struct sym_ball_in_problem { /* a ball that begins to slide, the others staying */
    sym_contact_problem *problem;
    int32_t ball;
} sym_ball_in_problem;

/* Its c, where it slides in the direction d. */
static double sym_c_of_direction(void *data, const double *d, double *along) {
    const sym_ball_in_problem *of = (const sym_ball_in_problem *)data;
    const double *c = of->problem->c + 3 * of->ball;
    memcpy(of->problem->d + 2 * of->ball, d, 2 * sizeof *d);
    sym_forces_of_modes(of->problem);
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
static void sym_refine_directions(sym_contact_problem *p, int32_t count, const int32_t *which) {
    double J[SYM_MOST_CONTACTS * SYM_MOST_CONTACTS], off[SYM_MOST_CONTACTS], turn[SYM_MOST_CONTACTS], d[2 * SYM_MOST_CONTACTS];
    int32_t round, i, j;
    for (round = 0; round < SYM_MOST_REFINEMENTS; ++round) {
        double largest = 0.0;
        sym_forces_of_modes(p);
        for (i = 0; i < count; ++i) off[i] = sym_off_direction(p, which[i]), largest = fmax(largest, fabs(off[i]));
        if (!(largest > SYM_ANGLE_ROUNDING) || (round > 0 && largest > 0.5)) return;
        memcpy(d, p->d, sizeof d);
        for (j = 0; j < count; ++j) {
            sym_turn_direction(p->d + 2 * which[j], SYM_ANGLE_STEP);
            sym_forces_of_modes(p);
            for (i = 0; i < count; ++i) J[count * i + j] = (sym_off_direction(p, which[i]) - off[i]) / SYM_ANGLE_STEP;
            memcpy(p->d, d, sizeof d);
        }
        (void)sym_least_norm(count, J, off, turn, NULL);
        for (i = 0; i < count; ++i) sym_turn_direction(p->d + 2 * which[i], -fmax(-0.5, fmin(0.5, turn[i])));
    }
    sym_forces_of_modes(p);
}

/* Whether modes agree, as they are or, better, once directions are refined. */
static int32_t sym_agree_refined(sym_contact_problem *p, int32_t count, const int32_t *which) {
    sym_contact_problem first;
    if (!sym_modes_agree(p)) return 0;
    first = *p;
    if (count > 0) sym_refine_directions(p, count, which);
    if (!sym_modes_agree(p)) *p = first;
    return 1;
}

/* Whether modes agree once balls that begin to slide do so against their friction, found by iteration. */
static int32_t sym_try_modes(sym_contact_problem *p) {
    int32_t which[SYM_MOST_CONTACTS], count = 0, i, round;
    for (i = 0; i < p->n; ++i)
        if (p->mode[i] == SYM_SLIDES && !p->slides[i] && p->mu[i] > 0.0) which[count++] = i;
    for (round = 0; round < SYM_DIRECT_TURNS; ++round) {
        int32_t turns = 0;
        sym_forces_of_modes(p);
        if (sym_agree_refined(p, count, which)) return 1;
        for (i = 0; i < count; ++i) {
            const double *c = p->c + 3 * which[i], size = hypot(c[0], c[1]);
            double *d = p->d + 2 * which[i], was[2] = {d[0], d[1]};
            if (!(size > SYM_CONTACT_ROUNDING * p->size)) continue;
            d[0] = c[0] / size, d[1] = c[1] / size;
            turns |= hypot(d[0] - was[0], d[1] - was[1]) > SYM_CONTACT_ROUNDING;
        }
        if (!turns && count > 1) return 0;
        if (!turns) break;
    }
    if (count == 1) {
        sym_ball_in_problem ball = {p, which[0]};
        (void)sym_find_direction(sym_c_of_direction, &ball, p->d + 2 * which[0]);
        sym_forces_of_modes(p);
    } else {
        sym_refine_directions(p, count, which);
    }
    return sym_agree_refined(p, count, which);
}

/* Whether normal forces on the balls that do not part are determined, by the other forces. */
static int32_t sym_normals_are_determined(const sym_contact_problem *p) {
    double A[SYM_MOST_CONTACTS * SYM_MOST_CONTACTS], x[SYM_MOST_CONTACTS];
    const double none[SYM_MOST_CONTACTS] = {0.0};
    int32_t which[SYM_MOST_CONTACTS], m = 0, i, j;
    for (i = 0; i < p->n; ++i)
        if (!p->parts[i]) which[m++] = i;
    for (i = 0; i < m; ++i)
        for (j = 0; j < m; ++j) A[m * i + j] = p->W[3 * p->n * (3 * which[i] + 2) + 3 * which[j] + 2];
    return m < 2 || sym_least_norm(m, A, none, x, NULL) == 0;
}

/* Modes that agree with Coulomb's law, those with more contact first. Where only one motion may do so all are tried: of up to
 * SYM_UNIQUE_UP_TO balls whose normal forces are determined. Returns 0 or a status. */
static int32_t sym_solve_contacts(sym_contact_problem *p, int32_t unique) {
    const int32_t n = 3 * p->n;
    double d[2 * SYM_MOST_CONTACTS];
    int32_t choices[SYM_MOST_CONTACTS], count = 1, code, i, found = 0;
    sym_contact_problem first;
    for (i = 0, p->size = 0.0; i < n; ++i) p->size = fmax(p->size, fabs(p->b[i]));
    for (i = 0; i < p->n; ++i) p->mode[i] = p->parts[i] ? SYM_OPEN : p->slides[i] || p->mu[i] == 0.0 ? SYM_SLIDES : SYM_STICKS;
    sym_forces_of_modes(p); /* friction that keeps a ball from sliding shows where it begins to */
    for (i = 0; i < p->n; ++i) {
        const double x = p->f[3 * i], y = p->f[3 * i + 1], drag = hypot(x, y);
        choices[i] = p->parts[i] ? 1 : p->slides[i] || p->mu[i] == 0.0 ? 2 : 3;
        count *= choices[i];
        if (!p->slides[i]) p->d[2 * i] = drag > 0.0 ? -x / drag : 1.0, p->d[2 * i + 1] = drag > 0.0 ? -y / drag : 0.0;
    }
    memcpy(d, p->d, sizeof d);
    unique = unique && p->n <= SYM_UNIQUE_UP_TO && sym_normals_are_determined(p);
    for (code = 0; code < count; ++code) {
        int32_t left = code, different = 0;
        for (i = p->n - 1; i >= 0; --i) p->mode[i] = (double)(choices[i] - 1 - left % choices[i]), left /= choices[i];
        memcpy(p->d, d, sizeof d);
        if (!sym_try_modes(p)) continue;
        if (!found) {
            found = 1, first = *p;
            if (!unique) return 0;
            continue;
        }
        for (i = 0; i < n; ++i) different |= fabs(p->c[i] - first.c[i]) > SYM_DIFFERENT * p->size;
        if (different) return SYM_CONTACTS_AMBIGUOUS;
    }
    if (!found) return SYM_NO_CONTACT_FORCE;
    *p = first;
    return 0;
}
