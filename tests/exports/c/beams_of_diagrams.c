#include <stdio.h>
#include <stdlib.h>
#include "bench.h"
int main(void) {
    const size_t size = sym_program_size(bench_program());
    sym_program_instance *it = sym_program_init(malloc(size), size, bench_program());
    int i, j;
    if (it == NULL || sym_program_advance(it, 0.1) < 0) return 1;
    for (i = 0; i < it->program->n_parts; ++i)
        for (j = 0; j < it->parts[i]->plant->n_beams; ++j) printf("%.17g\n", sym_instance_beam_error(it->parts[i], j));
    it->par[0] = 0.0;
    i = sym_program_prepare(it);
    printf("%d %d\n", i, sym_program_advance(it, 0.2));
    free(it);
    return 0;
}
