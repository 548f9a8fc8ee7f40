#include <stdio.h>
#include <stdlib.h>
int main(void) {
    const sym_model *m = row_model();
    int angle, i, k;
    for (angle = 1; angle >= 0; --angle)
        for (i = 0; i < m->n_functions; ++i) {
            const sym_function *f = &m->functions[i];
            double *in[8], *out[8], *work = malloc(f->work * sizeof *work);
            int j;
            for (k = 0; k < f->n_in; ++k) {
                in[k] = calloc((size_t)f->in[k].rows * f->in[k].cols + 1, sizeof(double));
                for (j = 0; j < f->in[k].rows && k == 1; ++j) in[k][j] = m->q_names[j][1] == 'r' ? angle : -angle;
            }
            if (m->npre > 0) m->init(m->par_default, in[0]);
            for (k = 0; k < f->n_out; ++k) out[k] = malloc(((size_t)f->out[k].rows * f->out[k].cols) * sizeof(double));
            f->eval((const double *const *)in, out, work);
            for (k = 0; k < f->n_out; ++k) {
                if (!strcmp(f->out[k].name, "rank")) printf("%g\n", out[k][0]);
                free(out[k]);
            }
            for (k = 0; k < f->n_in; ++k) free(in[k]);
            free(work);
        }
    return 0;
}
