#include <stdio.h>
#include <stdlib.h>
#include "NAME.h"
int main(int argc, char **argv) {
    const size_t size = sym_instance_size(NAME_plant());
    sym_instance *it = sym_instance_init(malloc(size), size, NAME_plant());
    const double steps = atof(argv[1]), h = atof(argv[2]);
    double *arrays[4];
    int i, status;
    arrays[0] = it->q, arrays[1] = it->v, arrays[2] = it->u, arrays[3] = it->par;
    for (i = 4; i + 2 < argc; i += 3) arrays[atoi(argv[i])][atoi(argv[i + 1])] = atof(argv[i + 2]);
    if (sym_instance_prepare(it) != 0) return 2;
    if (atoi(argv[3]) == 0) it->system.n_beams = 0, it->run.elastic_stiffness = NULL;
    status = sym_instance_advance(it, steps * h, h);
    printf("%d %.6g\n", status, it->system.n_beams > 0 ? sym_instance_beam_error(it, 0) : 0.0);
    free(it);
    return 0;
}
