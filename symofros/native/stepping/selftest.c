/* A model against reference points: for each function in turn, and for each point, inputs and then outputs. */

#define SYM_SMALL 1e-3 /* outputs below this are compared with it: they may be all rounding */

static size_t sym_entries(const sym_array *array) { return (size_t)array->rows * (size_t)array->cols; }

SYM_EXPORT size_t sym_selftest_size(const sym_model *m) {
    size_t most = 0;
    int32_t i, k;
    for (i = 0; i < m->n_functions; ++i) {
        size_t outputs = 0;
        for (k = 0; k < m->functions[i].n_out; ++k) outputs += sym_entries(&m->functions[i].out[k]);
        if (outputs > most) most = outputs;
    }
    return (size_t)m->npre + 1 + sym_work(m) + most;
}

static double sym_worst(size_t n, const double *found, const double *wanted, double worst) {
    double largest = SYM_SMALL;
    size_t i;
    for (i = 0; i < n; ++i) largest = fabs(wanted[i]) > largest ? fabs(wanted[i]) : largest;
    for (i = 0; i < n; ++i) {
        const double error = fabs(found[i] - wanted[i]) / largest;
        if (!(error <= worst)) worst = error == error ? error : HUGE_VAL;
    }
    return worst;
}

SYM_EXPORT double sym_selftest(const sym_model *m, int32_t points, const double *reference, size_t count, double *memory) {
    double *pre = memory, *work = pre + m->npre + 1, *outputs = work + sym_work(m), worst = 0.0;
    const double *at = reference;
    int32_t i, k, point;
    m->init(m->par_default, pre);
    for (i = 0; i < m->n_functions; ++i)
        for (point = 0; point < points; ++point) {
            const sym_function *f = &m->functions[i];
            const double *in[10];
            double *out[10], *into = outputs;
            if (f->n_in > 10 || f->n_out > 10) return HUGE_VAL;
            in[0] = pre;
            for (k = 1; k < f->n_in; ++k) in[k] = at, at += sym_entries(&f->in[k]);
            for (k = 0; k < f->n_out; ++k) out[k] = into, into += sym_entries(&f->out[k]);
            f->eval(in, out, work);
            for (k = 0; k < f->n_out; ++k) {
                worst = sym_worst(sym_entries(&f->out[k]), out[k], at, worst);
                at += sym_entries(&f->out[k]);
            }
        }
    return at == reference + count ? worst : HUGE_VAL;
}
