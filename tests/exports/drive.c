/* The program of a diagram, driven line by line: time and inputs in, outputs out. Words of the command line are names of
 * parameters, each followed by its value; a time before the last one begins anew. */
#include <stdio.h>
#include <stdlib.h>
#include "symofros_program.h"

const sym_program *PROGRAM(void);

int main(int argc, char **argv) {
    const sym_program *p = PROGRAM();
    const size_t size = sym_program_size(p);
    void *memory = malloc(size);
    sym_program_instance *it = sym_program_init(memory, size, p);
    double t, last = 0.0;
    int32_t i, word;
    if (it == NULL) return 2;
    for (word = 1; word + 1 < argc; word += 2) {
        const int32_t which = sym_program_parameter(p, argv[word]);
        if (which < 0) return 3;
        it->par[which] = strtod(argv[word + 1], NULL);
    }
    if (argc > 1 && sym_program_start(it) < 0) return 4;
    while (scanf("%lf", &t) == 1) {
        for (i = 0; i < p->n_inputs; ++i)
            if (scanf("%lf", &it->inputs[i]) != 1) return 5;
        if (t < last && sym_program_start(it) < 0) return 4;
        last = t;
        if (sym_program_advance(it, t) < 0) return 6;
        for (i = 0; i < p->n_outputs; ++i) printf("%a ", it->signals[i]);
        printf("\n");
    }
    free(memory);
    return 0;
}
