#include <stdio.h>
#include <stdlib.h>
#include "plan.h"
/* A box that is drawn from one instant on, then lifted or thrown up by hand. */
static void tell(const sym_instance *it, int status) {
    int i;
    printf("status %d, in sequence at %g s\nq", status, sym_instance_struck_in_sequence(it));
    for (i = 0; i < it->model->nq; ++i) printf(" %.17g", it->q[i]);
    for (i = 0; i < it->model->nv; ++i) printf(" %.17g", it->v[i]);
    printf("\n");
}
int main(int n, char **word) {
    const size_t size = sym_instance_size(plan_plant());
    sym_instance *it = sym_instance_init(malloc(size), size, plan_plant());
    int i, status = SYM_FINISHED;
    if (it == NULL || n < 3) return 1;
    for (i = 1; i <= 10 && status == SYM_FINISHED; ++i) status = sym_instance_advance(it, 0.01 * i, 1e-3);
    it->u[0] = atof(word[1]);
    for (; i <= 20 && status == SYM_FINISHED; ++i) status = sym_instance_advance(it, 0.01 * i, 1e-3);
    tell(it, status);
    it->u[0] = 0.0, it->q[2] += atof(word[2]), it->v[2] += n > 3 ? atof(word[3]) : 0.0;
    for (; i <= 30 && status == SYM_FINISHED; ++i) status = sym_instance_advance(it, 0.01 * i, 1e-3);
    tell(it, status);
    return 0;
}
