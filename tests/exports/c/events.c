#include <stdio.h>
#include <stdlib.h>
#include "plan.h"
int main(int n, char **word) {
    const size_t size = sym_instance_size(plan_plant());
    sym_instance *it = sym_instance_init(malloc(size), size, plan_plant());
    const double span = atof(word[1]), t_end = atof(word[2]);
    int i, k, times, status = SYM_FINISHED;
    if (it == NULL || n < 3) return 1;
    for (times = 0; times < 2; ++times) { /* a reset puts modes and events back, too */
        sym_instance_reset(it);
        for (k = 1; status == SYM_FINISHED && it->t < t_end - 1e-9; ++k) {
            int64_t row;
            status = sym_instance_advance(it, (double)k * span, 1e-3);
            for (row = 0; row < it->run.n_event_records && times == 1; ++row)
                printf("%s %.17g\n", plan_plant()->events->names[it->run.event_index[row]], it->run.event_t[row]);
        }
        if (times == 0) status = SYM_FINISHED;
    }
    printf("status %d\nq", status);
    for (i = 0; i < it->model->nq; ++i) printf(" %.17g", it->q[i]);
    for (i = 0; i < it->model->nv; ++i) printf(" %.17g", it->v[i]);
    printf("\n");
    return 0;
}
