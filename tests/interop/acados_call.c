#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* Whole numbers and the memory's argument are of the types of acados, int and void *; of CasADi, long long and int. */
typedef struct {
    int (*fun)(const double **, double **, int *, double *, void *);
    int (*work)(int *, int *, int *, int *);
    const int *(*sparsity_in)(int), *(*sparsity_out)(int);
    int (*n_in)(void), (*n_out)(void);
} external;
#define DECLARE(f) int f(const double **, double **, int *, double *, void *); \
    int f##_work(int *, int *, int *, int *); \
    const int *f##_sparsity_in(int), *f##_sparsity_out(int); int f##_n_in(void), f##_n_out(void);
#define LIST(f) {f, f##_work, f##_sparsity_in, f##_sparsity_out, f##_n_in, f##_n_out},
FUNCTIONS(DECLARE)
static const external functions[] = {FUNCTIONS(LIST)};
/* Entries of a pattern: dense by columns where its third number is 1, else rows of each column. */
static int entries(const int *s) { return s[2] == 1 ? s[0] * s[1] : s[2 + s[1]]; }
enum { BEHIND = 1000 }; /* numbers behind the scratch, which no function may write */
int main(void) {
    size_t f;
    for (f = 0; f < sizeof functions / sizeof *functions; ++f) {
        const external *each = &functions[f];
        int guard[6] = {-7, 0, 0, 0, 0, -7}, i, k; /* numbers of another size would be written over the guards */
        const double **in;
        double **out, *work;
        int *iw;
        if (each->work(guard + 1, guard + 2, guard + 3, guard + 4) || guard[0] != -7 || guard[5] != -7) return 1;
        in = calloc((size_t)guard[1] + 1, sizeof *in), out = calloc((size_t)guard[2] + 1, sizeof *out);
        iw = calloc((size_t)guard[3] + 1, sizeof *iw), work = calloc((size_t)guard[4] + BEHIND, sizeof *work);
        for (k = 0; k < BEHIND; ++k) work[guard[4] + k] = -7.0;
        for (i = 0; i < each->n_in(); ++i) {
            const int n = entries(each->sparsity_in(i));
            double *x = calloc((size_t)n + 1, sizeof *x);
            for (k = 0; k < n; ++k)
                if (scanf("%lf", x + k) != 1) return 2;
            in[i] = x;
        }
        for (i = 0; i < each->n_out(); ++i) out[i] = calloc((size_t)entries(each->sparsity_out(i)) + 1, sizeof **out);
        if (each->fun(in, out, iw, work, 0)) return 3;
        for (k = 0; k < BEHIND; ++k)
            if (work[guard[4] + k] != -7.0) return 4;
        for (i = 0; i < each->n_out(); ++i) {
            const int *s = each->sparsity_out(i), *colind = s + 2, *row = colind + s[1] + 1;
            int c, at = 0;
            printf("%ld %ld", (long)s[0], (long)s[1]);
            for (c = 0; c < s[1]; ++c)
                for (k = s[2] == 1 ? 0 : colind[c]; k < (s[2] == 1 ? s[0] : colind[c + 1]); ++k)
                    printf(" %ld %ld %.17g", (long)(s[2] == 1 ? k : row[k]), (long)c, out[i][at++]);
            printf("\n");
        }
    }
    return 0;
}
