/* Calls the routines of native/model with scratch of exactly the size that their macros state, under sanitizers, and prints
 * the results. Appended to the routines' text. */
#include <stdio.h>
#include <stdlib.h>

enum { NQ = 3, N = 3, M_ = 2 };

static double *scratch(size_t n) { return malloc(n * sizeof(double)); }

static void print(const char *name, size_t n, const double *x) {
    size_t i;
    printf("%s", name);
    for (i = 0; i < n; ++i) printf(" %.17g", x[i]);
    printf("\n");
}

static void copy(double *to, const double *from, size_t n) { memcpy(to, from, n * sizeof *to); }

/* A mass matrix that is singular alone: no inertia along the third speed, which the second condition binds. */
static const double MASS[N * N] = {2, 0.5, 0, 0.5, 1, 0, 0, 0, 0};
static const double G[M_ * N] = {1, 1, 0, 0, 1, 2};
static const short group[M_] = {0, 1}, unit[M_] = {SYM_ROW_FORMULA, SYM_ROW_FORMULA}, speed[N] = {0, 0, 0};
static const sym_measures MEASURES = {group, unit, speed};
static const double FORCE[N] = {1, -2, 3}, RIGHT[M_] = {0.7, -0.4};

static void dynamics_terms(const double *const *in, double *const *out, double *work) {
    (void)in, (void)work;
    copy(out[0], MASS, N * N), copy(out[1], FORCE, N), copy(out[2], G, M_ * N), copy(out[3], RIGHT, M_);
}

/* phi = G q - RIGHT and phi' = G v. */
static void projection_terms(const double *const *in, double *const *out, double *work) {
    int i, j;
    (void)work;
    copy(out[0], MASS, N * N), copy(out[1], G, M_ * N);
    for (i = 0; i < M_; ++i) {
        out[2][i] = 1.0, out[3][i] = -RIGHT[i], out[4][i] = 0.0;
        for (j = 0; j < N; ++j) out[3][i] += G[i * N + j] * in[1][j], out[4][i] += G[i * N + j] * in[2][j];
    }
}

static void move(const double *const *in, double *const *out, double *work) {
    int i;
    (void)work;
    for (i = 0; i < NQ; ++i) out[0][i] = in[1][i] + in[2][i];
}

/* q0 = 0 and q0 (1 + q1) = 0: rank 1 on the constraints, 2 beside them. in: pre, q, v, u, gains, t. */
static void beside_terms(const double *const *in, double *const *out, double *work) {
    static const double inertia[N * N] = {2, 0, 0, 0, 1, 0, 0, 0, 1.5};
    const double *q = in[1], *v = in[2], g[M_ * N] = {1, 0, 0, 1 + q[1], q[0], 0};
    (void)work;
    copy(out[0], inertia, N * N), copy(out[1], FORCE, N), copy(out[2], g, M_ * N);
    out[3][0] = 0.0, out[3][1] = -2.0 * v[0] * v[1];
    out[4][0] = out[4][1] = 1.0, out[5][0] = q[0], out[5][1] = q[0] * (1 + q[1]);
}

/* q0 = 0, q0 + q3/20 = 0 and q3^2 (1 + q1) = 0, which binds nothing more where they hold; beyond q1 = 1/2 q2 = 0. A step
 * that divides by what the third leaves of q1 leads there. */
enum { SIZE = 4 };
static const short own_group[SIZE] = {0, 1, 2, 3}, own_unit[SIZE] = {SYM_ROW_FORMULA, SYM_ROW_FORMULA, SYM_ROW_FORMULA, SYM_ROW_FORMULA};
static const short own_speed[SIZE] = {0, 0, 0, 0};
static const sym_measures OWN_MEASURES = {own_group, own_unit, own_speed};

static void fading_terms(const double *const *in, double *const *out, double *work) {
    const double *q = in[1], beyond = q[1] >= 0.5;
    const double g[SIZE * SIZE] = {1, 0, 0, 0, 1, 0, 0, 0.05, 0, q[3] * q[3], 0, 2 * q[3] * (1 + q[1]), 0, 0, beyond, 0};
    int i;
    (void)work;
    memset(out[0], 0, SIZE * SIZE * sizeof(double)), memset(out[1], 0, SIZE * sizeof(double));
    copy(out[2], g, SIZE * SIZE), memset(out[3], 0, SIZE * sizeof(double));
    for (i = 0; i < SIZE; ++i) out[0][i * SIZE + i] = out[4][i] = 1.0;
    out[5][0] = q[0], out[5][1] = q[0] + 0.05 * q[3], out[5][2] = q[3] * q[3] * (1 + q[1]), out[5][3] = beyond * q[2];
}

static void move_all(const double *const *in, double *const *out, double *work) {
    int i;
    (void)work;
    for (i = 0; i < SIZE; ++i) out[0][i] = in[1][i] + in[2][i];
}

/* Ranks that sym_motion gives beside those constraints, over three distances from them and SWEEP of the fading row. */
enum { SWEEP = 24, SIZES = 3 };

static void print_fading_ranks(void) {
    static const sym_form form = {SIZE * SIZE, SIZE * SIZE, sym_constrained, sym_row_sizes, sym_clear_row};
    const double none[1] = {0}, idle[SIZE] = {0};
    double ranks[SIZES * SWEEP], a[SIZE], lam[SIZE], *results[3], *work;
    int i, j;
    work = scratch(2 * SIZE * SIZE + SYM_MOTION_WORK(SIZE, SIZE, SIZE) + SYM_CONSTRAINED_WORK(SIZE, SIZE));
    for (i = 0; i < SIZES; ++i)
        for (j = 0; j < SWEEP; ++j) {
            const double q[SIZE] = {pow(10, -3 - i), 0, 0, 2e-4 * pow(1.5, j)};
            const double *const in[6] = {none, q, idle, none, none, none};
            results[0] = a, results[1] = lam, results[2] = ranks + i * SWEEP + j;
            sym_motion(SIZE, SIZE, SIZE, &OWN_MEASURES, &form, fading_terms, move_all, in, results, work);
        }
    print("fading_ranks", SIZES * SWEEP, ranks), free(work);
}

/* dR/dx of one x with N columns: minus the identity above zeros. */
static void slopes(const double *const *in, double *const *out, double *work) {
    int i;
    (void)in, (void)work;
    memset(out[0], 0, (N + M_) * N * sizeof(double));
    for (i = 0; i < N; ++i) out[0][i * N + i] = -1.0;
}

/* More columns than the factors take: dR/dx and (omega . R)_zx of small whole numbers, (omega . R)_xx = 0. */
enum { K_ = 60, OWN = 100 };

static void many_slopes(const double *const *in, double *const *out, double *work) {
    int i, j;
    (void)in, (void)work;
    for (i = 0; i < N + M_; ++i)
        for (j = 0; j < K_; ++j) out[0][i * K_ + j] = (7 * i + 3 * j) % 5 - 2;
}

/* A function may write all of its own scratch, behind its results as well. */
static void curvature(const double *const *in, double *const *out, double *work) {
    int i, j;
    (void)in;
    memset(out[0], 0, K_ * K_ * sizeof(double));
    for (i = 0; i < N + M_; ++i)
        for (j = 0; j < K_; ++j) out[1][i * K_ + j] = (3 * i + 5 * j) % 7 - 3;
    for (i = 0; i < OWN; ++i) work[i] = NAN;
}

/* -(L^T L)^-1 X by blocks: L of small whole numbers with zeros below its diagonal, X with k columns. */
static void solve_by_blocks(int n, int k) {
    double *L = scratch((size_t)(n * n)), *X = scratch((size_t)(n * k)), *work = scratch(SYM_BLOCKS_WORK((size_t)n));
    char name[32];
    int i, j;
    for (i = 0; i < n; ++i) {
        for (j = 0; j < n; ++j) L[i * n + j] = j < i ? (3 * i + 5 * j) % 4 - 1 : j == i ? 2 + i % 3 : NAN;
        for (j = 0; j < k; ++j) X[i * k + j] = (5 * i + 3 * j) % 7 - 3;
    }
    sym_block_factor(n, L, work + 8 * (n + 3));
    sym_less_solved(n, k, work + 8 * (n + 3), X, work);
    sprintf(name, "blocks_%d_%d", n, k), print(name, (size_t)(n * k), X);
    free(L), free(X), free(work);
}

int main(void) {
    const double q0[NQ] = {0.3, 0.1, -0.2}, v0[N] = {1, 2, 3}, none[1] = {0};
    const double *const in[5] = {none, q0, v0, none, none};
    const int columns[1] = {N};
    const double beside[NQ] = {1e-5, 0.1, -0.2}, still[N] = {0, 2, 3};
    const double *const at[6] = {none, beside, still, none, none, none};
    const double *const weighed[7] = {none, q0, v0, none, none, FORCE, RIGHT};
    static double hessian[K_ * K_];
    static const sym_form form = {N * N, M_ * N, sym_constrained, sym_row_sizes, sym_clear_row};
    double rank, gap, *results[3];
    sym_ranking ranking = sym_rank_anew(M_);
    double energies[2], A[N * N], B[M_ * N], r[N], c[M_], q[NQ], v[N], residual, derivative[(N + M_) * N], *out[1], *work;
    copy(A, MASS, N * N), copy(B, G, M_ * N), copy(r, FORCE, N), copy(c, RIGHT, M_);
    work = scratch(SYM_CONSTRAINED_WORK(N, M_));
    printf("rank %d\n", sym_constrained(N, M_, &MEASURES, A, r, B, c, &ranking, work));
    print("a", N, r), print("lam", M_, c), free(work);
    copy(A, MASS, N * N), copy(B, G, M_ * N), copy(r, FORCE, N), copy(c, RIGHT, M_);
    work = scratch(SYM_NULL_SPACE_WORK(N, M_));
    printf("null_rank %d\n", sym_null_space(N, M_, &MEASURES, A, r, B, c, &ranking, work));
    print("null_a", N, r), print("null_lam", M_, c), free(work);
    work = scratch(SYM_PROJECT_WORK(NQ, N, M_) + SYM_CONSTRAINED_WORK(N, M_));
    printf("project_rank %d\n", sym_project(NQ, N, M_, 0, &MEASURES, projection_terms, move, in, q, v, &residual, energies, &gap, work));
    print("q", NQ, q), print("v", N, v), print("residual", 1, &residual), print("gap", 1, &gap), free(work);
    work = scratch(N * N + M_ * N + SYM_MOTION_WORK(NQ, N, M_) + SYM_CONSTRAINED_WORK(N, M_));
    results[0] = r, results[1] = c, results[2] = &rank;
    sym_motion(NQ, N, M_, &MEASURES, &form, beside_terms, move, at, results, work);
    print("motion_a", N, r), print("motion_lam", M_, c), print("motion_rank", 1, &rank), free(work);
    print_fading_ranks();
    work = scratch(SYM_DIFFERENTIATE_WORK(N, M_) + SYM_KKT_SOLVE_WORK(N, M_, N));
    out[0] = derivative;
    sym_differentiate(N, M_, &MEASURES, 1, columns, dynamics_terms, slopes, in, out, work);
    print("derivative", (N + M_) * N, derivative), free(work);
    work = scratch(SYM_HESSIAN_WORK(N, M_, K_) + SYM_KKT_SOLVE_WORK(N, M_, K_) + OWN);
    out[0] = hessian;
    sym_hessian(N, M_, K_, &MEASURES, dynamics_terms, many_slopes, curvature, weighed, out, work);
    print("hessian", K_ * K_, hessian), free(work);
    for (int n = 1; n < 10; ++n) solve_by_blocks(n, 1), solve_by_blocks(n, 8), solve_by_blocks(n, 19);
    return 0;
}
