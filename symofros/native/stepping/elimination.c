/* Linear systems of any rank: Gaussian elimination with complete pivoting. */

/* Relative to the largest pivot: smaller ones count as zero, and the system as of lower rank. */
#define SYM_PIVOT_TOLERANCE 1e-13

/* Factors A (n x n, row by row) in place; p and c become the permutations of rows and columns. Returns the rank. */
static int32_t sym_eliminate(int32_t n, double *A, int32_t *p, int32_t *c) {
    int32_t i, j, k, rank = 0;
    double largest = 0.0;
    for (i = 0; i < n; ++i) p[i] = c[i] = i;
    for (k = 0; k < n; ++k) {
        int32_t row = k, column = k;
        double best = -1.0;
        for (i = k; i < n; ++i)
            for (j = k; j < n; ++j)
                if (fabs(A[(size_t)i * n + j]) > best) best = fabs(A[(size_t)i * n + j]), row = i, column = j;
        if (k == 0) largest = best;
        if (!(best > SYM_PIVOT_TOLERANCE * largest)) break;
        ++rank;
        if (row != k) {
            for (j = 0; j < n; ++j) {
                const double s = A[(size_t)k * n + j];
                A[(size_t)k * n + j] = A[(size_t)row * n + j], A[(size_t)row * n + j] = s;
            }
            i = p[k], p[k] = p[row], p[row] = i;
        }
        if (column != k) {
            for (i = 0; i < n; ++i) {
                const double s = A[(size_t)i * n + k];
                A[(size_t)i * n + k] = A[(size_t)i * n + column], A[(size_t)i * n + column] = s;
            }
            i = c[k], c[k] = c[column], c[column] = i;
        }
        for (i = k + 1; i < n; ++i) {
            double *r = A + (size_t)i * n;
            const double *pivot = A + (size_t)k * n, s = r[k] / pivot[k];
            if (s == 0.0) continue;
            r[k] = s;
            for (j = k + 1; j < n; ++j) r[j] -= s * pivot[j];
        }
    }
    return rank;
}

/* x with A x = b, zero in the components that the rank leaves free; work: n doubles. */
static void sym_solve(int32_t n, int32_t rank, const double *A, const int32_t *p, const int32_t *c, const double *b,
                      double *x, double *work) {
    int32_t i, j;
    for (i = 0; i < rank; ++i) {
        double s = b[p[i]];
        for (j = 0; j < i; ++j) s -= A[(size_t)i * n + j] * work[j];
        work[i] = s;
    }
    for (i = rank - 1; i >= 0; --i) {
        double s = work[i];
        for (j = i + 1; j < rank; ++j) s -= A[(size_t)i * n + j] * work[j];
        work[i] = s / A[(size_t)i * n + i];
    }
    for (i = 0; i < n; ++i) x[c[i]] = i < rank ? work[i] : 0.0;
}
