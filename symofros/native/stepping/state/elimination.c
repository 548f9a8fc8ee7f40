/* Linear systems of any rank: equations of motion above conditions, by Gaussian elimination with complete pivoting. */

/* Relative to the largest pivot of the scaled system: smaller ones count as zero, and the system as of lower rank. */
#define SYM_PIVOT_TOLERANCE 1e-13
/* The same of pivots beyond the rank that the conditions have where they are fulfilled: beside it, they say nothing
 * (docs/theory/constraints.md, section 4). */
#define SYM_PIVOT_DOUBT 1e-3
/* Share of the largest entry of a column in all conditions below which an entry is rounding of the sum that it is. */
#define SYM_ENTRY_ROUNDING 1e-12

/* A power of two near 1/sqrt(x), and 1 for x = 0: scaling by it does not round. */
static double sym_inverse_root(double x) {
    int exponent;
    if (!(x > 0.0)) return 1.0;
    (void)frexp(x, &exponent);
    return ldexp(1.0, -exponent / 2);
}

/* Whether condition i, a row of A, is rounding alone, such as what a planar loop says of the direction across its plane. */
static int32_t sym_condition_is_void(int32_t nv, int32_t n, const double *A, int32_t i) {
    int32_t j, k;
    for (j = 0; j < nv; ++j) {
        double largest = 0.0;
        for (k = nv; k < n; ++k) largest = fabs(A[SYM_INDEX(k, n, j)]) > largest ? fabs(A[SYM_INDEX(k, n, j)]) : largest;
        if (fabs(A[SYM_INDEX(i, n, j)]) > SYM_ENTRY_ROUNDING * largest) return 0;
    }
    return 1;
}

/* scale (n): each speed in units of its own inertia, each condition by the largest size in its group in these units, or 0
 * where it is void (docs/theory/simulation.md, section 3). */
static void sym_natural_scale(int32_t nv, int32_t n, const int32_t *group, const double *A, double *scale) {
    int32_t i, j;
    for (j = 0; j < nv; ++j) scale[j] = sym_inverse_root(fabs(A[SYM_INDEX(j, n, j)]));
    for (i = nv; i < n; ++i) {
        double size = 0.0;
        for (j = 0; j < nv; ++j) {
            const double entry = fabs(A[SYM_INDEX(i, n, j)]) * scale[j];
            size = entry > size ? entry : size;
        }
        j = nv + group[i - nv]; /* the first row of its group */
        scale[i] = 0.0;
        if (size > scale[j]) scale[j] = size;
    }
    for (i = n - 1; i >= nv; --i) { /* first rows after the others of their groups */
        const double size = scale[nv + group[i - nv]];
        scale[i] = sym_condition_is_void(nv, n, A, i) ? 0.0 : sym_inverse_root(size * size);
    }
}

/* Factors A (n x n, row by row; nv equations of motion, then conditions with their multipliers) in place, scaled; p and c
 * become the permutations of rows and columns. group (n - nv): sym_system. known: the rank where the conditions are
 * fulfilled. Returns the rank. */
static int32_t sym_eliminate(int32_t nv, int32_t n, const int32_t *group, int32_t known, double *A, double *scale, int32_t *p, int32_t *c) {
    int32_t i, j, k, rank = 0;
    double largest = 0.0;
    sym_natural_scale(nv, n, group, A, scale);
    for (i = 0; i < n; ++i) {
        for (j = 0; j < n; ++j) A[SYM_INDEX(i, n, j)] *= scale[i] * scale[j];
        p[i] = c[i] = i;
    }
    for (k = 0; k < n; ++k) {
        int32_t row = k, column = k;
        double best = -1.0;
        for (i = k; i < n; ++i)
            for (j = k; j < n; ++j)
                if (fabs(A[SYM_INDEX(i, n, j)]) > best) best = fabs(A[SYM_INDEX(i, n, j)]), row = i, column = j;
        if (k == 0) largest = best;
        if (!(best > (k < known ? SYM_PIVOT_TOLERANCE : SYM_PIVOT_DOUBT) * largest)) break;
        ++rank;
        if (row != k) {
            for (j = 0; j < n; ++j) {
                const double s = A[SYM_INDEX(k, n, j)];
                A[SYM_INDEX(k, n, j)] = A[SYM_INDEX(row, n, j)], A[SYM_INDEX(row, n, j)] = s;
            }
            i = p[k], p[k] = p[row], p[row] = i;
        }
        if (column != k) {
            for (i = 0; i < n; ++i) {
                const double s = A[SYM_INDEX(i, n, k)];
                A[SYM_INDEX(i, n, k)] = A[SYM_INDEX(i, n, column)], A[SYM_INDEX(i, n, column)] = s;
            }
            i = c[k], c[k] = c[column], c[column] = i;
        }
        for (i = k + 1; i < n; ++i) {
            double *r = A + (size_t)i * (size_t)n;
            const double *pivot = A + (size_t)k * (size_t)n, s = r[k] / pivot[k];
            if (s == 0.0) continue;
            r[k] = s;
            for (j = k + 1; j < n; ++j) r[j] -= s * pivot[j];
        }
    }
    return rank;
}

/* x with A x = b, zero in the components that the rank leaves free; work: n doubles. */
static void sym_solve(int32_t n, int32_t rank, const double *A, const double *scale, const int32_t *p, const int32_t *c,
                      const double *b, double *x, double *work) {
    int32_t i, j;
    for (i = 0; i < rank; ++i) {
        double s = scale[p[i]] * b[p[i]];
        for (j = 0; j < i; ++j) s -= A[SYM_INDEX(i, n, j)] * work[j];
        work[i] = s;
    }
    for (i = rank - 1; i >= 0; --i) {
        double s = work[i];
        for (j = i + 1; j < rank; ++j) s -= A[SYM_INDEX(i, n, j)] * work[j];
        work[i] = s / A[SYM_INDEX(i, n, i)];
    }
    for (i = 0; i < n; ++i) x[c[i]] = i < rank ? scale[c[i]] * work[i] : 0.0;
}
