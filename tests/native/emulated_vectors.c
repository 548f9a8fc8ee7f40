#include "symofros_model.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
const sym_model *test_model(void);
int main(void) {
    const sym_model *m = test_model();
    double *pre = calloc((size_t)m->npre + 1, sizeof(double));
    long compared = 0, wrong = 0;
    m->init(m->par_default, pre);
    for (int f = 0; f < m->n_functions; ++f) {
        const sym_function *one = m->functions + f;
        double *work = aligned_alloc(64, (one->work / 8 + 1) * 64);
        for (size_t n = 1; n <= 20; ++n) {
            const double *in[8], *at[8];
            double *all[8], *single[8], *place[8];
            size_t stride[8];
            for (int i = 0; i < one->n_in; ++i) {
                const size_t size = (size_t)(one->in[i].rows * one->in[i].cols);
                double *x = malloc((n * size + 1) * sizeof(double));
                for (size_t k = 0; k < n * size; ++k) x[k] = sin(1.0 + (double)k * 0.7 + f + i);
                in[i] = i == 0 ? pre : x;
                stride[i] = i == 0 ? 0 : size;
            }
            for (int i = 0; i < one->n_out; ++i) {
                const size_t size = (size_t)(one->out[i].rows * one->out[i].cols);
                all[i] = calloc(n * size + 1, sizeof(double));
                single[i] = calloc(n * size + 1, sizeof(double));
            }
            one->batch(n, in, stride, all, work);
            for (size_t k = 0; k < n; ++k) {
                for (int i = 0; i < one->n_in; ++i) at[i] = in[i] + k * stride[i];
                for (int i = 0; i < one->n_out; ++i)
                    place[i] = single[i] + k * (size_t)(one->out[i].rows * one->out[i].cols);
                one->eval(at, place, work);
            }
            for (int i = 0; i < one->n_out; ++i) {
                const size_t bytes = n * (size_t)(one->out[i].rows * one->out[i].cols) * sizeof(double);
                compared += (long)(bytes / sizeof(double));
                wrong += memcmp(all[i], single[i], bytes) != 0;
            }
        }
    }
    printf("%ld %ld\n", compared, wrong);
    return wrong != 0;
}
