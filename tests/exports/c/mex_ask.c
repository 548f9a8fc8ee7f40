#include "arm_mex.c"
/* A call a line, of one process. */
int main(void) {
    unsigned m, n, i, k, count, wanted;
    while (scanf("%u %u", &count, &wanted) == 2) {
        mxArray *out[8] = {NULL};
        const mxArray *in[8];
        for (k = 0; k < count; ++k) {
            mxArray *a;
            if (scanf("%u %u", &m, &n) != 2) return 2;
            in[k] = a = mxCreateDoubleMatrix(m, n, mxREAL);
            for (i = 0; i < m * n; ++i) if (scanf("%lf", &a->x[i]) != 1) return 2;
        }
        mexFunction((int)wanted, out, (int)count, in);
        for (k = 0; k < wanted; ++k) {
            printf("%u %u", (unsigned)out[k]->m, (unsigned)out[k]->n);
            for (i = 0; i < out[k]->m * out[k]->n; ++i) printf(" %.17g", out[k]->x[i]);
            printf("\n");
        }
    }
    return 0;
}
