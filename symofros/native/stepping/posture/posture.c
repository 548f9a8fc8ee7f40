/* Damped least squares (Levenberg, Marquardt) on targets of frames and conditions of loops, within limits
 * (docs/theory/constraints.md, section 9). */

/* Damping, relative to the norm of J: first value, factors after a good step and a bad one, and the value at which no step
 * is left. */
#define SYM_DAMPING 1e-3
#define SYM_DAMPING_RELAX 0.2
#define SYM_DAMPING_TIGHTEN 8.0
#define SYM_DAMPING_MOST 1e8
/* Relative gain of a step that is rounding. */
#define SYM_SMALLEST_GAIN 1e-16
/* A start is given up where so many steps do not take this share of its error: the guess, whose branch is wanted, and
 * drawn starts, of which the first are many and quick. */
#define SYM_STALLED 20
#define SYM_MIN_SHARE 0.1
#define SYM_STALLED_QUICK 8
#define SYM_MIN_SHARE_QUICK 0.3
#define SYM_QUICK_STARTS 48
/* Largest entry of a step [rad, m]. */
#define SYM_LARGEST_STEP 0.5
/* Share of a diagonal entry of J J^T that is added to it, so that rows that repeat each other leave a pivot. */
#define SYM_GRAM_ROUNDING 1e-14
/* Frobenius norm of R^T R - 1 that rounding leaves: such a matrix stays as it is, so that a pose that was settled is settled. */
#define SYM_ROTATION_ROUNDING 4e-15

static void sym_posture_lay_out(sym_posture *p, sym_arena *arena) {
    const size_t nq = (size_t)p->system->nq, nv = (size_t)p->system->nv;
    size_t m, smaller;
    int32_t k;
    p->wishes = 0;
    for (k = 0; k < p->n_targets; ++k) p->wishes += 3 * (p->targets[k].position + p->targets[k].rotation);
    p->m = p->wishes + p->n_conditions;
    m = (size_t)p->m, smaller = m < nv ? m : nv;
    p->kept = sym_allocate(arena, SYM_POSTURE_KEPT * nq), p->kept_square = sym_allocate(arena, SYM_POSTURE_KEPT);
    p->round = sym_allocate(arena, SYM_POSTURE_ROUND * nq), p->round_met = sym_allocate(arena, SYM_POSTURE_ROUND);
    p->low = sym_allocate(arena, nv), p->high = sym_allocate(arena, nv);
    p->e = sym_allocate(arena, m), p->e_tried = sym_allocate(arena, m);
    p->J = sym_allocate(arena, m * nv), p->A = sym_allocate(arena, smaller * smaller), p->y = sym_allocate(arena, smaller);
    p->wish = sym_allocate(arena, nv), p->step = sym_allocate(arena, nv), p->theta = sym_allocate(arena, nv);
    p->tried = sym_allocate(arena, nq), p->movable = sym_allocate(arena, nv), p->depends = sym_allocate(arena, m * nv);
    p->packed = sym_allocate(arena, m * nv), p->columns = sym_allocate_bytes(arena, nv * sizeof(int32_t));
}

SYM_EXPORT size_t sym_posture_size(sym_posture *p) {
    sym_arena arena = {NULL, 0};
    sym_posture_lay_out(p, &arena);
    return arena.used;
}

SYM_EXPORT void sym_posture_start(sym_posture *p, double *memory) {
    sym_arena arena = {NULL, 0};
    arena.base = memory;
    sym_posture_lay_out(p, &arena);
}

/* R <- R (3 - R^T R) / 2, twice: the nearest rotation, from one that is so to seven digits. */
static void sym_nearest_rotation(double *R) {
    int32_t pass, i, j, k;
    for (pass = 0; pass < 2; ++pass) {
        double S[9], X[9];
        for (i = 0; i < 3; ++i)
            for (j = 0; j < 3; ++j) S[3 * i + j] = 1.5 * (i == j) - 0.5 * (R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j]);
        for (i = 0; i < 3; ++i)
            for (j = 0; j < 3; ++j)
                for (X[3 * i + j] = 0.0, k = 0; k < 3; ++k) X[3 * i + j] += R[3 * i + k] * S[3 * k + j];
        memcpy(R, X, sizeof X);
    }
}

SYM_EXPORT int64_t sym_posture_poses(int64_t first, int64_t n, double most, double *poses) {
    for (; first < n; ++first) {
        double *p = poses + SYM_POSTURE_POSE * first, *R = p + 3, off = 0.0, c[3];
        int32_t i, j;
        for (i = 0; i < 3; ++i)
            for (j = 0; j < 3; ++j) {
                const double s = R[i] * R[j] + R[3 + i] * R[3 + j] + R[6 + i] * R[6 + j] - (i == j);
                off += s * s;
            }
        sym_cross(R, R + 3, c);
        if (!(off <= most * most) || !(c[0] * R[6] + c[1] * R[7] + c[2] * R[8] > 0.0)) return first;
        for (i = 0; i < 3; ++i)
            if (!(fabs(p[i]) < HUGE_VAL)) return first;
        if (off > SYM_ROTATION_ROUNDING * SYM_ROTATION_ROUNDING) sym_nearest_rotation(R);
    }
    return n;
}

/* e <- log(W R^T), W wanted: axis times angle, the angle in [0, pi]; (18b). */
static void sym_rotation_missing(const double *W, const double *R, double *e) {
    double E[9], sine, cosine, angle, size = 0.0;
    int32_t i, j, k;
    for (i = 0; i < 3; ++i)
        for (j = 0; j < 3; ++j) {
            E[3 * i + j] = 0.0;
            for (k = 0; k < 3; ++k) E[3 * i + j] += W[3 * i + k] * R[3 * j + k];
        }
    e[0] = 0.5 * (E[7] - E[5]), e[1] = 0.5 * (E[2] - E[6]), e[2] = 0.5 * (E[3] - E[1]);
    sine = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]), cosine = 0.5 * (E[0] + E[4] + E[8] - 1.0);
    if (sine <= 1e-7 && cosine > 0.0) return;
    angle = atan2(sine, cosine);
    if (!(sine <= 1e-7)) {
        for (i = 0; i < 3; ++i) e[i] *= angle / sine;
        return;
    }
    /* Half a turn: the axis is a column of E + 1. */
    for (i = 0, k = 0; i < 3; ++i) k = E[4 * i] > E[4 * k] ? i : k;
    for (i = 0; i < 3; ++i) e[i] = E[3 * i + k] + (i == k), size += e[i] * e[i];
    for (i = 0; i < 3; ++i) e[i] *= angle / sqrt(size);
}

/* Angular rows w (3, n) of a Jacobian <- those of the rotation vector that is missing: w + e x w / 2 + c e x (e x w), (18c). */
static void sym_rotation_rows(const double *e, int32_t n, double *w) {
    const double squared = e[0] * e[0] + e[1] * e[1] + e[2] * e[2], half = 0.5 * sqrt(squared);
    const double c = half < 5e-3 ? 1.0 / 12.0 + squared / 720.0 : (1.0 - half / tan(half)) / squared;
    int32_t j;
    for (j = 0; j < n; ++j) {
        const double a[3] = {w[j], w[n + j], w[2 * n + j]};
        double once[3], twice[3];
        int32_t i;
        sym_cross(e, a, once), sym_cross(e, once, twice);
        for (i = 0; i < 3; ++i) w[i * n + j] = a[i] + 0.5 * once[i] + c * twice[i];
    }
}

/* e at q. The evaluation point is there afterwards. */
static void sym_posture_error(sym_posture *p, const double *q, double *e) {
    sym_system *s = p->system;
    int32_t k, i;
    if (q != s->q) memcpy(s->q, q, (size_t)s->nq * sizeof *q);
    for (k = 0; k < p->n_targets; ++k) {
        const sym_target *target = &p->targets[k];
        const double *wanted = p->wanted + SYM_POSTURE_POSE * k;
        sym_evaluate(&target->pose);
        if (target->position) {
            for (i = 0; i < 3; ++i) e[i] = wanted[i] - target->pose.out[0][i];
            e += 3;
        }
        if (target->rotation) {
            sym_rotation_missing(wanted + 3, target->pose.out[1], e);
            e += 3;
        }
    }
    if (p->n_conditions == 0) return;
    sym_evaluate(&p->constraint);
    for (i = 0; i < p->n_conditions; ++i) e[i] = -p->constraint.out[0][p->conditions[i]];
}

/* J at the evaluation point, where e is known. */
static void sym_posture_jacobian(sym_posture *p, const double *e, double *J) {
    const int32_t nv = p->system->nv;
    const size_t block = 3 * (size_t)nv;
    int32_t k, i;
    for (k = 0; k < p->n_targets; ++k) {
        const sym_target *target = &p->targets[k];
        sym_evaluate(&target->jacobian);
        if (target->position) {
            memcpy(J, target->jacobian.out[0], block * sizeof *J);
            J += block, e += 3;
        }
        if (target->rotation) {
            memcpy(J, target->jacobian.out[0] + block, block * sizeof *J);
            sym_rotation_rows(e, nv, J);
            J += block, e += 3;
        }
    }
    if (p->n_conditions == 0) return;
    sym_evaluate(&p->system->constraint_jacobian);
    for (i = 0; i < p->n_conditions; ++i, J += nv)
        memcpy(J, p->system->constraint_jacobian.out[0] + SYM_INDEX(p->conditions[i], nv, 0), (size_t)nv * sizeof *J);
}

SYM_EXPORT void sym_posture_residual(sym_posture *p, const double *q, double *e, double *J) {
    sym_posture_error(p, q, e);
    if (J != NULL) sym_posture_jacobian(p, e, J);
}

SYM_EXPORT void sym_posture_limit(const sym_posture *p, double *q) {
    const sym_system *s = p->system;
    int32_t k, i;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *of = &s->segments[k];
        if (of->kind != SYM_SEGMENT_LINEAR) continue;
        for (i = 0; i < of->size; ++i) {
            double *x = q + of->q + i;
            if (!p->free[of->v + i]) continue;
            if (*x < p->lower[of->q + i]) *x = p->lower[of->q + i];
            if (*x > p->upper[of->q + i]) *x = p->upper[of->q + i];
        }
    }
}

/* p->movable <- 1 for free speeds, 0 for those that would push a coordinate through its limit. */
static void sym_posture_movable(sym_posture *p, const double *q) {
    const sym_system *s = p->system;
    int32_t k, i;
    for (k = 0; k < s->nv; ++k) p->movable[k] = p->free[k];
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *of = &s->segments[k];
        if (of->kind != SYM_SEGMENT_LINEAR) continue;
        for (i = 0; i < of->size; ++i) {
            const double x = q[of->q + i], push = p->wish[of->v + i];
            if ((x <= p->lower[of->q + i] && push < 0.0) || (x >= p->upper[of->q + i] && push > 0.0))
                p->movable[of->v + i] = 0.0;
        }
    }
}

static double sym_squared_norm(int32_t n, const double *x) {
    double s = 0.0;
    int32_t i;
    for (i = 0; i < n; ++i) s += x[i] * x[i];
    return s;
}

/* Solve A x = b in place, A symmetric (n, n), lower triangle, by Cholesky's factors; a pivot that is no more is left out. */
static void sym_solve_gram(int32_t n, double *A, double *b) {
    int32_t i, j, k;
    for (j = 0; j < n; ++j) {
        double *row = A + SYM_INDEX(j, n, 0), pivot = row[j];
        for (k = 0; k < j; ++k) pivot -= row[k] * row[k];
        row[j] = pivot > 0.0 ? 1.0 / sqrt(pivot) : 0.0;
        for (i = j + 1; i < n; ++i) {
            double *other = A + SYM_INDEX(i, n, 0), s = other[j];
            for (k = 0; k < j; ++k) s -= other[k] * row[k];
            other[j] = s * row[j];
        }
    }
    for (i = 0; i < n; ++i) {
        for (k = 0; k < i; ++k) b[i] -= A[SYM_INDEX(i, n, k)] * b[k];
        b[i] *= A[SYM_INDEX(i, n, i)];
    }
    for (i = n - 1; i >= 0; --i) {
        for (k = i + 1; k < n; ++k) b[i] -= A[SYM_INDEX(k, n, i)] * b[k];
        b[i] *= A[SYM_INDEX(i, n, i)];
    }
}

/* Packs the columns of J that may move and are not zero: p->columns, p->packed (m, n). */
static void sym_posture_pack(sym_posture *p) {
    const int32_t m = p->m, nv = p->system->nv;
    int32_t i, k, n = 0;
    for (k = 0; k < nv; ++k) {
        double size = 0.0;
        for (i = 0; p->movable[k] != 0.0 && i < m; ++i) size += fabs(p->J[SYM_INDEX(i, nv, k)]);
        if (size > 0.0) p->columns[n++] = k;
    }
    for (i = 0; i < m; ++i)
        for (k = 0; k < n; ++k) p->packed[SYM_INDEX(i, n, k)] = p->J[SYM_INDEX(i, nv, p->columns[k])];
    p->n_packed = n;
}

/* p->step <- the least |J step - e|^2 + mu^2 |step|^2 of the packed columns, mu = damping |J|: (18d), by the smaller of
 * J J^T and J^T J. */
static void sym_posture_step(sym_posture *p, double damping) {
    const int32_t m = p->m, n = p->n_packed, by_rows = m <= n, size = by_rows ? m : n;
    const double *J = p->packed, mu = damping * damping * sym_squared_norm(m * n, J) + 1e-300;
    double *A = p->A, *y = p->y;
    int32_t i, j, k;
    for (i = 0; i < size; ++i)
        for (j = 0; j <= i; ++j) {
            double s = 0.0;
            if (by_rows)
                for (k = 0; k < n; ++k) s += J[i * n + k] * J[j * n + k];
            else
                for (k = 0; k < m; ++k) s += J[k * n + i] * J[k * n + j];
            A[i * size + j] = i == j ? s * (1.0 + SYM_GRAM_ROUNDING) + mu : s;
        }
    for (i = 0; i < size; ++i) y[i] = by_rows ? p->e[i] : p->wish[p->columns[i]];
    sym_solve_gram(size, A, y);
    memset(p->step, 0, (size_t)p->system->nv * sizeof *p->step);
    for (k = 0; k < n; ++k) {
        double s = by_rows ? 0.0 : y[k];
        for (i = 0; by_rows && i < m; ++i) s += J[i * n + k] * y[i];
        p->step[p->columns[k]] = s;
    }
}

/* Notes the largest errors of e; returns whether all are within their bounds. */
static int32_t sym_posture_judge(sym_posture *p, const double *e) {
    int32_t i, met = 1;
    p->error = p->gap = 0.0;
    for (i = 0; i < p->m; ++i) {
        double *largest = i < p->wishes ? &p->error : &p->gap;
        if (!(fabs(e[i]) <= (i < p->wishes ? p->tolerance : p->closed))) met = 0;
        if (!(fabs(e[i]) <= *largest)) *largest = fabs(e[i]);
    }
    return p->met = met;
}

/* J and wish = J^T e at the evaluation point. Returns whether they are finite. */
static int32_t sym_posture_gradient(sym_posture *p) {
    const int32_t nv = p->system->nv;
    double sum = 0.0;
    int32_t i, k;
    sym_posture_jacobian(p, p->e, p->J);
    for (k = 0; k < nv; ++k) p->wish[k] = 0.0;
    for (i = 0; i < p->m; ++i)
        for (k = 0; k < nv; ++k) {
            p->wish[k] += p->J[SYM_INDEX(i, nv, k)] * p->e[i];
            sum += fabs(p->J[SYM_INDEX(i, nv, k)]);
        }
    return sum < HUGE_VAL;
}

/* p->tried <- the configuration after the step, shortened to the most that counts, within limits. */
static void sym_posture_try(sym_posture *p) {
    const int32_t nv = p->system->nv;
    double largest = 0.0;
    int32_t k;
    for (k = 0; k < nv; ++k) largest = fabs(p->step[k]) > largest ? fabs(p->step[k]) : largest;
    if (largest > SYM_LARGEST_STEP)
        for (k = 0; k < nv; ++k) p->step[k] *= SYM_LARGEST_STEP / largest;
    sym_retract(p->system, p->q, p->step, p->tried);
    sym_posture_limit(p, p->tried);
}

/* Steps from p->q, given up where `stalled` of them do not take this share of the error. Returns whether they meet. */
static int32_t sym_posture_follow(sym_posture *p, int32_t most, int32_t stalled, double share) {
    const int32_t nq = p->system->nq;
    double damping = SYM_DAMPING, square, judged, gain;
    int32_t count = 0, fresh = 0;
    sym_posture_limit(p, p->q);
    sym_posture_error(p, p->q, p->e);
    square = judged = sym_squared_norm(p->m, p->e);
    while (!sym_posture_judge(p, p->e) && count < most && square < HUGE_VAL) {
        if (!fresh && !sym_posture_gradient(p)) break;
        if (!fresh) sym_posture_movable(p, p->q), sym_posture_pack(p);
        sym_posture_step(p, damping);
        sym_posture_try(p);
        sym_posture_error(p, p->tried, p->e_tried);
        ++count;
        gain = square - sym_squared_norm(p->m, p->e_tried);
        fresh = !(gain > 0.0); /* J is that of q still */
        if (!fresh) {
            const double before = square;
            memcpy(p->q, p->tried, (size_t)nq * sizeof *p->q);
            memcpy(p->e, p->e_tried, (size_t)p->m * sizeof *p->e);
            square -= gain, damping *= SYM_DAMPING_RELAX;
            if (gain <= SYM_SMALLEST_GAIN * before) {
                sym_posture_judge(p, p->e);
                break;
            }
        } else {
            damping *= SYM_DAMPING_TIGHTEN;
            if (damping > SYM_DAMPING_MOST || gain == 0.0) break;
        }
        if (count % stalled == 0) {
            if (square > (1.0 - share) * (1.0 - share) * judged) {
                sym_posture_judge(p, p->e);
                break;
            }
            judged = square;
        }
    }
    p->steps += count;
    return p->met;
}

SYM_EXPORT int32_t sym_posture_descend(sym_posture *p, int32_t most) {
    return sym_posture_follow(p, most, SYM_STALLED, SYM_MIN_SHARE);
}
