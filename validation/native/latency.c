/* How long calls of a C package take, one by one. Compiled with -DNAME=...: see validation/studies/exports.py.
 *
 *     latency CALLS    prints, for each kind: name, median, 99.9 %, longest [ns], then counts by powers of two
 */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "symofros_instance.h"

#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)
const sym_plant *JOIN(NAME, _plant)(void);

enum { BINS = 28 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static int compare(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

static void tell(const char *name, float *taken, long n) {
    long bins[BINS] = {0}, i;
    for (i = 0; i < n; ++i) {
        int bin = 0;
        while (bin < BINS - 1 && taken[i] >= (float)(2L << bin)) ++bin;
        ++bins[bin];
    }
    qsort(taken, (size_t)n, sizeof *taken, compare);
    printf("%s %.0f %.0f %.0f", name, taken[n / 2], taken[(long)(0.999 * (double)n)], taken[n - 1]);
    for (i = 0; i < BINS; ++i) printf(" %ld", bins[i]);
    printf("\n");
}

int main(int argc, char **argv) {
    const long calls = argc > 1 ? atol(argv[1]) : 1000;
    const size_t size = sym_instance_size(JOIN(NAME, _plant)());
    void *memory = malloc(size);
    sym_instance *instance = sym_instance_init(memory, size, JOIN(NAME, _plant)());
    const int32_t nv = instance == NULL ? 0 : instance->model->nv;
    float *taken = malloc((size_t)calls * sizeof *taken);
    double *M = malloc((size_t)(nv * nv + 2 * nv + 1) * sizeof *M), *out[3], last;
    const sym_function *dynamics;
    long i;
    if (instance == NULL || taken == NULL || M == NULL) return 2;
    dynamics = sym_find(instance->model, "dynamics", NULL);
    out[0] = M, out[1] = M + nv * nv, out[2] = out[1] + nv;
    last = now();
    for (i = 0; i < calls; ++i) {
        const double start = now();
        taken[i] = (float)(start - last), last = start;
    }
    tell("clock", taken, calls);
    for (i = 0; i < calls; ++i) {
        const double start = now();
        instance->q[i % instance->model->nq] += 1e-6;
        sym_instance_call(instance, dynamics, out);
        taken[i] = (float)(now() - start);
    }
    tell("dynamics", taken, calls);
    for (i = 0; i < calls; ++i) {
        const double start = now();
        instance->q[i % instance->model->nq] += 1e-6;
        sym_instance_accelerate(instance);
        taken[i] = (float)(now() - start);
    }
    tell("forward_dynamics", taken, calls);
    sym_instance_reset(instance);
    for (i = 0; i < calls; ++i) {
        const double start = now();
        if (sym_instance_advance(instance, (double)(i % 1000 + 1) * 1e-3, 1e-3) != SYM_FINISHED || i % 1000 == 999)
            sym_instance_reset(instance);
        taken[i] = (float)(now() - start);
    }
    tell("rk4_step", taken, calls);
    free(M), free(taken), free(memory);
    return 0;
}
