/* How loads are shared by balls that stick, and systems of any rank (docs/theory/constraints.md, section 15, (48)). */

enum { SYM_MOST_CONTACTS = 16, SYM_MOST_FORCES = 3 * SYM_MOST_CONTACTS };
/* Share of the largest column that is rounding, where what others reach is taken off. */
#define SYM_LOST_COLUMN 1e-11
/* Share of the largest pivot down to which a system is solved as it is, with no thought of its rank. */
#define SYM_REGULAR 1e-5
/* Share of the load that is so much that how else it may be shared does not matter. */
#define SYM_AMPLE 0.05

/* Reflection (n, every stride-th entry of v) that turns v into a multiple of its first entry: v becomes its axis, whose square over
 * two is returned, 0 where v is that already; *first: what the first entry becomes. */
static double sym_reflection(int32_t n, double *v, int32_t stride, double *first) {
    double size = 0.0, rest = 0.0;
    int32_t i;
    for (i = 1; i < n; ++i) rest += v[stride * i] * v[stride * i];
    size = sqrt(v[0] * v[0] + rest);
    *first = v[0];
    if (rest == 0.0) return 0.0;
    *first = v[0] > 0.0 ? -size : size;
    v[0] -= *first;
    return 0.5 * (v[0] * v[0] + rest);
}

/* x of least norm with A x = y as far as that can be (n x n; A is lost), by reflections from both sides with the largest columns
 * first; null (n x the number returned): directions of x that change nothing. */
static int32_t sym_least_norm(int32_t n, double *A, const double *y, double *x, double *null) {
    double b[SYM_MOST_FORCES], z[SYM_MOST_FORCES], half[SYM_MOST_FORCES], diagonal[SYM_MOST_FORCES], largest = 0.0;
    int32_t column[SYM_MOST_FORCES], rank, i, j, k, l;
    for (i = 0; i < n; ++i) b[i] = y[i], column[i] = i;
    for (rank = 0; rank < n; ++rank) {
        double most = -1.0, along;
        int32_t across = rank;
        for (j = rank; j < n; ++j) {
            double square = 0.0;
            for (i = rank; i < n; ++i) square += A[n * i + j] * A[n * i + j];
            if (square > most) most = square, across = j;
        }
        most = sqrt(most);
        if (rank == 0) largest = most;
        if (!(most > SYM_LOST_COLUMN * largest)) break;
        for (i = 0; i < n; ++i) along = A[n * i + rank], A[n * i + rank] = A[n * i + across], A[n * i + across] = along;
        i = column[rank], column[rank] = column[across], column[across] = i;
        half[rank] = sym_reflection(n - rank, A + (n + 1) * rank, n, diagonal + rank);
        for (j = rank + 1; j <= n && half[rank] > 0.0; ++j) { /* the last one is b */
            double *of = j < n ? A + j : b;
            const int32_t step = j < n ? n : 1;
            for (along = 0.0, i = rank; i < n; ++i) along += A[n * i + rank] * of[step * i];
            for (along /= half[rank], i = rank; i < n; ++i) of[step * i] -= along * A[n * i + rank];
        }
    }
    for (k = rank - 1; k >= 0; --k) { /* what is right of the triangle moves into it; its diagonal is kept apart, axes in A */
        double v[SYM_MOST_FORCES + 1];
        v[0] = diagonal[k];
        memcpy(v + 1, A + n * k + rank, (size_t)(n - rank) * sizeof *v);
        half[k] = sym_reflection(n - rank + 1, v, 1, diagonal + k);
        A[(n + 1) * k] = v[0];
        memcpy(A + n * k + rank, v + 1, (size_t)(n - rank) * sizeof *v);
        for (i = 0; i < k && half[k] > 0.0; ++i) {
            double along = A[n * i + k] * v[0];
            for (j = rank; j < n; ++j) along += A[n * i + j] * v[1 + j - rank];
            along /= half[k], A[n * i + k] -= along * v[0];
            for (j = rank; j < n; ++j) A[n * i + j] -= along * v[1 + j - rank];
        }
    }
    for (l = 0; l <= (null != NULL ? n - rank : 0); ++l) { /* x, then each direction of null */
        double *to = l == 0 ? x : null + n * (l - 1);
        for (i = 0; i < n; ++i) z[i] = l > 0 && i == rank + l - 1 ? 1.0 : 0.0;
        for (k = rank - 1; k >= 0 && l == 0; --k) {
            for (z[k] = b[k], j = k + 1; j < rank; ++j) z[k] -= A[n * k + j] * z[j];
            z[k] /= diagonal[k];
        }
        for (k = 0; k < rank; ++k) {
            double along = A[(n + 1) * k] * z[k];
            if (half[k] == 0.0) continue;
            for (j = rank; j < n; ++j) along += A[n * k + j] * z[j];
            along /= half[k], z[k] -= along * A[(n + 1) * k];
            for (j = rank; j < n; ++j) z[j] -= along * A[n * k + j];
        }
        for (i = 0; i < n; ++i) to[column[i]] = z[i];
    }
    return n - rank;
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

