/* A model against reference points: for each function in turn, and for each point, inputs and then outputs. */

#define SYM_ERROR_FLOOR 1e-3 /* outputs below this are compared with it: they may be all rounding */

SYM_EXPORT size_t sym_selftest_size(const sym_model *m) {
    size_t most = 0;
    int32_t i, k;
    for (i = 0; i < m->n_functions; ++i) {
        size_t outputs = 0;
        for (k = 0; k < m->functions[i].n_out; ++k) outputs += sym_array_size(&m->functions[i].out[k]);
        if (outputs > most) most = outputs;
    }
    return (size_t)m->npre + 1 + sym_work(m) + most;
}

/* The larger of `worst` and the largest error of n entries, relative to the largest one; infinite for NaN. */
static double sym_max_relative_error(size_t n, const double *computed, const double *expected, double worst) {
    double largest = SYM_ERROR_FLOOR;
    size_t i;
    for (i = 0; i < n; ++i) largest = fabs(expected[i]) > largest ? fabs(expected[i]) : largest;
    for (i = 0; i < n; ++i) {
        const double error = fabs(computed[i] - expected[i]) / largest;
        if (!(error <= worst)) worst = error == error ? error : HUGE_VAL;
    }
    return worst;
}

SYM_EXPORT double sym_selftest(const sym_model *m, int32_t points, const double *reference, size_t count,
                               double *memory) {
    double *pre = memory, *work = pre + m->npre + 1, *outputs = work + sym_work(m), worst = 0.0;
    const double *at = reference;
    int32_t i, k, point;
    m->init(m->par_default, pre);
    for (i = 0; i < m->n_functions; ++i)
        for (point = 0; point < points; ++point) {
            const sym_function *f = &m->functions[i];
            const double *in[SYM_MAX_INPUTS];
            double *out[SYM_MAX_OUTPUTS], *into = outputs;
            if (f->n_in > SYM_MAX_INPUTS || f->n_out > SYM_MAX_OUTPUTS) return HUGE_VAL;
            in[0] = pre;
            for (k = 1; k < f->n_in; ++k) in[k] = at, at += sym_array_size(&f->in[k]);
            for (k = 0; k < f->n_out; ++k) out[k] = into, into += sym_array_size(&f->out[k]);
            f->eval(in, out, work);
            for (k = 0; k < f->n_out; ++k) {
                worst = sym_max_relative_error(sym_array_size(&f->out[k]), out[k], at, worst);
                at += sym_array_size(&f->out[k]);
            }
        }
    return at == reference + count ? worst : HUGE_VAL;
}
