/* Directional derivatives of a package's instance against central differences of its rates, along random directions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "driven.h"

enum { MOST = 64 };

static double random_number(void) { return 2.0 * rand() / (double)RAND_MAX - 1.0; }

static void shifted(sym_instance *instance, const double *from, const double *along, double h, double *rates) {
    const int32_t nq = instance->model->nq, nv = instance->model->nv, nu = instance->model->nu;
    int32_t i;
    for (i = 0; i < nq; ++i) instance->q[i] = from[i] + h * along[i];
    for (i = 0; i < nv; ++i) instance->v[i] = from[nq + i] + h * along[nq + i];
    for (i = 0; i < nu; ++i) instance->u[i] = from[nq + nv + i] + h * along[nq + nv + i];
    if (sym_instance_rates(instance, rates) != 0) exit(2);
}

int main(void) {
    const size_t size = sym_instance_size(driven_plant());
    void *memory = malloc(size);
    sym_instance *instance = sym_instance_init(memory, size, driven_plant());
    double from[MOST], along[MOST], up[MOST], down[MOST], exact[MOST], lam[MOST], *work, worst = 0.0;
    int32_t i, round, nq, nv, nu;
    if (instance == NULL || sym_instance_prepare(instance) != 0) return 2;
    nq = instance->model->nq, nv = instance->model->nv, nu = instance->model->nu;
    work = malloc(sizeof *work * sym_instance_differentiate_size(instance));
    for (round = 0; round < 5; ++round) {
        memcpy(from, instance->q, sizeof *from * (size_t)nq);
        memcpy(from + nq, instance->v, sizeof *from * (size_t)nv);
        memcpy(from + nq + nv, instance->u, sizeof *from * (size_t)nu);
        for (i = 0; i < nv; ++i) from[nq + i] += 0.1 * random_number();
        for (i = 0; i < nq + nv + nu; ++i) along[i] = random_number();
        shifted(instance, from, along, 0.0, up);
        if (sym_instance_differentiate(instance, along, along + nq, along + nq + nv, exact, lam, work) != 0) return 3;
        shifted(instance, from, along, 1e-6, up);
        shifted(instance, from, along, -1e-6, down);
        for (i = 0; i < nq + nv; ++i) {
            const double error = fabs((up[i] - down[i]) / 2e-6 - exact[i]);
            if (error > worst) worst = error;
        }
        shifted(instance, from, along, 0.0, up);
    }
    printf("%.3g\n", worst);
    free(work);
    free(memory);
    return 0;
}
