/* Functions of a model by CasADi's interface of external functions: the model's C text stands before this one, the
 * functions of that interface after it (symofros/interop/casadi.py writes them). Its whole numbers are as in C that CasADi
 * generates: long long, or what its option "casadi_int" says; acados has int. */
#ifndef casadi_int
#define casadi_int long long int
#endif
#define SYM_CASADI_MOST 16

/* One output: an array of a function of the model, whose entries are gathered into columns. */
typedef struct sym_casadi_output {
    const char *function, *frame; /* frame NULL: of the whole model */
    int32_t array;
    casadi_int count;
    const casadi_int *gather; /* (count) index of each nonzero in the array, which is row by row */
} sym_casadi_output;

static size_t sym_casadi_size(const sym_array *array) { return (size_t)array->rows * (size_t)array->cols; }

/* The most entries that one input has, 1 at least. */
static size_t sym_casadi_largest(const sym_model *model) {
    size_t largest = 1;
    int32_t i, k;
    for (i = 0; i < model->n_functions; ++i)
        for (k = 0; k < model->functions[i].n_in; ++k) {
            const size_t size = sym_casadi_size(&model->functions[i].in[k]);
            if (size > largest) largest = size;
        }
    return largest;
}

/* Doubles of scratch: pre, parameters, zeros for what is not given, outputs of one function, its work. */
static size_t sym_casadi_work(const sym_model *model) {
    size_t most = 0;
    int32_t i, k;
    for (i = 0; i < model->n_functions; ++i) {
        size_t total = 0;
        for (k = 0; k < model->functions[i].n_out; ++k) total += sym_casadi_size(&model->functions[i].out[k]);
        if (total > most) most = total;
    }
    return (size_t)model->npre + sym_casadi_largest(model) + (size_t)model->npar + most + sym_work(model);
}

/* names (n): what the model calls each entry of arg, or "" of what is not read; what is not given is zero. Outputs of one
 * function stand together. Returns 0, or 1 where the model lacks a function. */
static int sym_casadi_call(const sym_model *model, const char *const *names, int32_t n, const sym_casadi_output *outputs,
                           int32_t n_outputs, const double **arg, double **res, double *w) {
    const size_t npar = (size_t)model->npar, largest = sym_casadi_largest(model);
    double *pre = w, *par = pre + model->npre, *zeros = par + npar, *values = zeros + largest, *work = values;
    double *out[SYM_CASADI_MOST];
    const double *in[SYM_CASADI_MOST];
    const sym_function *evaluated = NULL;
    int32_t i, k, o;
    memset(par, 0, (npar + largest) * sizeof(double));
    for (i = 0; i < n; ++i)
        if (strcmp(names[i], "par") == 0 && arg[i] != NULL) memcpy(par, arg[i], npar * sizeof(double));
    model->init(par, pre);
    for (o = 0; o < n_outputs; ++o) {
        const sym_casadi_output *output = &outputs[o];
        const sym_function *f;
        casadi_int j;
        if (res[o] == NULL || output->count == 0) continue;
        f = sym_find(model, output->function, output->frame);
        if (f == NULL || f->n_in > SYM_CASADI_MOST || f->n_out > SYM_CASADI_MOST) return 1;
        if (f != evaluated) {
            in[0] = pre;
            for (k = 1; k < f->n_in; ++k) {
                in[k] = zeros;
                for (i = 0; i < n; ++i)
                    if (strcmp(names[i], f->in[k].name) == 0 && arg[i] != NULL) in[k] = arg[i];
            }
            for (k = 0, work = values; k < f->n_out; ++k) out[k] = work, work += sym_casadi_size(&f->out[k]);
            f->eval(in, out, work);
            evaluated = f;
        }
        for (j = 0; j < output->count; ++j) res[o][j] = out[output->array][output->gather[j]];
    }
    return 0;
}
