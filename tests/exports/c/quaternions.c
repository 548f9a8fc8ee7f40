#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "hopper.h"
static double q[HOPPER_NQ], v[HOPPER_NV];
static void place(sym_instance *it) {
    sym_instance_reset(it);
    memcpy(it->q, q, sizeof q), memcpy(it->v, v, sizeof v);
}
static void show(int status, const double *x, int n) {
    printf("%d", status);
    for (int i = 0; i < n; ++i) printf(" %.17g", x[i]);
    printf("\n");
}
int main(void) {
    const size_t size = sym_instance_size(hopper_plant());
    sym_instance *it = sym_instance_init(malloc(size), size, hopper_plant());
    int i;
    while (scanf("%lf", &q[0]) == 1) {
        for (i = 1; i < HOPPER_NQ; ++i) if (scanf("%lf", &q[i]) != 1) return 2;
        for (i = 0; i < HOPPER_NV; ++i) if (scanf("%lf", &v[i]) != 1) return 2;
        place(it);
        i = sym_instance_accelerate(it);
        show(i, it->a, HOPPER_NV);
        place(it);
        i = sym_instance_project(it);
        show(i, it->q, HOPPER_NQ);
        place(it);
        i = sym_instance_advance(it, 0.02, 1e-3);
        show(i, it->q, HOPPER_NQ);
    }
    for (i = 0; i < 2; ++i) { /* a mass: nothing is made of it */
        place(it);
        it->par[0] = i == 0 ? -1.0 : sqrt(-1.0);
        printf("%d", sym_instance_prepare(it));
        printf(" %d", sym_instance_accelerate(it));
        printf(" %d", sym_instance_project(it));
        printf(" %d\n", sym_instance_advance(it, 0.02, 1e-3));
    }
    free(it);
    return 0;
}
