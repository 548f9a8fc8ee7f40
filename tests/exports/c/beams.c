#include <stdio.h>
#include <stdlib.h>
#include "cantilever.h"
int main(void) {
    const size_t size = sym_instance_size(cantilever_plant());
    sym_instance *it = sym_instance_init(malloc(size), size, cantilever_plant());
    double t_end;
    int i, checks;
    while (scanf("%d", &checks) == 1) {
        sym_instance_reset(it);
        it->check_parameters = checks;
        for (i = 0; i < CANTILEVER_NPAR; ++i) if (scanf("%lf", &it->par[i]) != 1) return 2;
        for (i = 0; i < CANTILEVER_NQ; ++i) if (scanf("%lf", &it->q[i]) != 1) return 2;
        if (scanf("%lf", &t_end) != 1) return 2;
        (void)sym_instance_prepare(it);
        const int status = sym_instance_advance(it, t_end, t_end / 200);
        printf("%d %.17g %s\n", status, sym_instance_beam_error(it, 0),
               it->refused < 0 ? "" : it->plant->conditions[it->refused]);
    }
    free(it);
    return 0;
}
