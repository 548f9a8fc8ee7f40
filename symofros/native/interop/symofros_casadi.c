/* Functions of a model by CasADi's interface of external functions: the model's C text and stepping/state/rotations.c stand
 * before this one, the functions of that interface after it (symofros/interop/casadi.py writes them). Its whole numbers are
 * as in C that CasADi generates: long long, or what its option "casadi_int" says; acados has int. */
#ifndef casadi_int
#define casadi_int long long int
#endif
#define SYM_CASADI_MOST 16

/* A run of coordinates: linear ones, or a quaternion behind `places` coordinates of a place. */
typedef struct sym_casadi_segment {
    int32_t q, v, places, quaternion;
} sym_casadi_segment;

/* What an array of the model becomes: itself; derivatives by the speeds' motions made those by coordinates, of a matrix
 * row by row, of a vector, of second derivatives; or these for each unit vector of weights, one below the other. */
enum { SYM_CASADI_PLAIN, SYM_CASADI_ROWS, SYM_CASADI_GRADIENT, SYM_CASADI_HESSIAN, SYM_CASADI_HESSIANS };

typedef struct sym_casadi_source {
    const char *function, *frame; /* frame NULL: of the whole model */
    int32_t array, kind;
    const char *gradient, *weights; /* of second derivatives: the function whose first array is the gradient by q, NULL
                                     * where there are no quaternions; the input of the weights */
    int32_t n_weights;
} sym_casadi_source;

/* One output: entries of a source, gathered into columns. */
typedef struct sym_casadi_output {
    int32_t source; /* -1: none */
    casadi_int count;
    const casadi_int *gather; /* (count) index of each nonzero in the array, which is row by row */
} sym_casadi_output;

/* All of one external function. */
typedef struct sym_casadi_plan {
    int32_t n_in, n_out, n_sources, n_segments;
    const char *const *names; /* (n_in) what the model calls each input, or "" of what is not read */
    const sym_casadi_output *outputs;
    const sym_casadi_source *sources;
    const sym_casadi_segment *segments;
} sym_casadi_plan;

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

/* The most entries that the outputs of one function have. */
static size_t sym_casadi_results(const sym_model *model) {
    size_t most = 0;
    int32_t i, k;
    for (i = 0; i < model->n_functions; ++i) {
        size_t total = 0;
        for (k = 0; k < model->functions[i].n_out; ++k) total += sym_casadi_size(&model->functions[i].out[k]);
        if (total > most) most = total;
    }
    return most;
}

/* Doubles that making a source takes, its own array among them. */
static size_t sym_casadi_made(const sym_model *model, const sym_casadi_source *source) {
    const sym_function *f = sym_find(model, source->function, source->frame);
    const size_t nq = (size_t)model->nq, nv = (size_t)model->nv;
    size_t rows, wide;
    if (f == NULL || source->kind == SYM_CASADI_PLAIN) return 0;
    rows = (size_t)f->out[source->array].rows, wide = rows + nq - nv;
    if (source->kind == SYM_CASADI_ROWS) return rows * nq;
    if (source->kind == SYM_CASADI_GRADIENT) return nq;
    return (size_t)source->n_weights + nq + rows * wide + (size_t)(source->n_weights ? source->n_weights : 1) * wide * wide;
}

/* Doubles of scratch: pre, parameters, zeros for what is not given, unit quaternions, outputs of two functions, what they
 * become, work. */
static size_t sym_casadi_work(const sym_model *model, const sym_casadi_plan *plan) {
    size_t most = 0;
    int32_t i;
    for (i = 0; i < plan->n_sources; ++i) {
        const size_t made = sym_casadi_made(model, &plan->sources[i]);
        if (made > most) most = made;
    }
    return (size_t)model->npre + sym_casadi_largest(model) + (size_t)(model->npar + model->nq) +
           2 * sym_casadi_results(model) + most + sym_work(model);
}

static double sym_casadi_square(const double *p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]; }

/* q with quaternions of unit length: docs/theory/linear.md, (24). */
static void sym_casadi_unit(const sym_casadi_plan *plan, int32_t nq, const double *q, double *unit) {
    int32_t s, i;
    memcpy(unit, q, (size_t)nq * sizeof *q);
    for (s = 0; s < plan->n_segments; ++s) {
        double *p = unit + plan->segments[s].q + plan->segments[s].places, length;
        if (!plan->segments[s].quaternion) continue;
        length = sqrt(sym_casadi_square(p));
        for (i = 0; i < 4; ++i) p[i] /= length;
    }
}

/* Derivatives by coordinates of those along the speeds' motions, (26): entries `step` apart. */
static void sym_casadi_by_q(const sym_casadi_plan *plan, const double *q, const double *unit, const double *along,
                            double *by, size_t step) {
    int32_t s, i;
    for (s = 0; s < plan->n_segments; ++s) {
        const sym_casadi_segment *seg = &plan->segments[s];
        const double *p = q + seg->q + seg->places, *x = along + (size_t)seg->v * step;
        double *y = by + (size_t)seg->q * step, w[3], turned[3], factor;
        if (seg->quaternion && seg->places) {
            for (i = 0; i < 3; ++i) w[i] = x[(size_t)i * step];
            sym_rotate(unit + seg->q + seg->places, w, turned);
            for (i = 0; i < 3; ++i) y[(size_t)i * step] = turned[i];
        } else
            for (i = 0; i < seg->places; ++i) y[(size_t)i * step] = x[(size_t)i * step];
        if (!seg->quaternion) continue;
        x += (size_t)seg->places * step, y += (size_t)seg->places * step;
        for (i = 0; i < 3; ++i) w[i] = x[(size_t)i * step];
        factor = 2.0 / sym_casadi_square(p);
        sym_cross(p, w, turned);
        for (i = 0; i < 3; ++i) y[(size_t)i * step] = factor * (p[3] * w[i] + turned[i]);
        y[3 * step] = -factor * (p[0] * w[0] + p[1] * w[1] + p[2] * w[2]);
    }
}

/* Second derivatives H (n x n), q first, along the speeds' motions; made (wide x wide) those by coordinates, (27) and (28).
 * half: n x wide; slope (nq): the gradient by coordinates. */
static void sym_casadi_hessian(const sym_casadi_plan *plan, const double *q, const double *unit, size_t n, size_t nv,
                               size_t wide, const double *H, const double *slope, double *half, double *made) {
    const size_t nq = wide - n + nv;
    size_t i, j;
    int32_t s, a, b;
    for (i = 0; i < n; ++i) {
        sym_casadi_by_q(plan, q, unit, H + i * n, half + i * wide, 1);
        memcpy(half + i * wide + nq, H + i * n + nv, (n - nv) * sizeof *H);
    }
    for (j = 0; j < wide; ++j) sym_casadi_by_q(plan, q, unit, half + j, made + j, wide);
    memcpy(made + nq * wide, half + nv * wide, (n - nv) * wide * sizeof *H);
    for (s = 0; s < plan->n_segments; ++s) {
        const sym_casadi_segment *seg = &plan->segments[s];
        const int32_t o = seg->q + seg->places;
        const double *p = q + o, *g = slope + o, square = seg->quaternion ? sym_casadi_square(p) : 1.0;
        if (!seg->quaternion) continue;
        for (a = 0; a < 4; ++a)
            for (b = 0; b <= a; ++b) {
                double *lower = made + (size_t)(o + a) * wide + o + b, *upper = made + (size_t)(o + b) * wide + o + a;
                *lower = *upper = 0.5 * (*lower + *upper) - (p[a] * g[b] + p[b] * g[a]) / square;
            }
        for (a = 0; a < 4; ++a) /* A turn moves the axes of the place, a change of place no axes. */
            for (b = seg->q; b < o; ++b) made[(size_t)b * wide + o + a] = made[(size_t)(o + a) * wide + b];
    }
}

/* What a call has at hand. */
typedef struct sym_casadi_call {
    const sym_model *model;
    const sym_casadi_plan *plan;
    const double **arg, *pre, *zeros, *unit, *q;
    const char *weights; /* an input that `weighed` stands for, or NULL */
    const double *weighed;
    double *work;
} sym_casadi_call;

/* Evaluate a function; its outputs lie in `values`, one behind the other. Returns 0, or 1 where the model lacks it. */
static int sym_casadi_evaluate(const sym_casadi_call *call, const sym_function *f, double **out, double *values) {
    const double *in[SYM_CASADI_MOST];
    int32_t i, k;
    if (f == NULL || f->n_in > SYM_CASADI_MOST || f->n_out > SYM_CASADI_MOST) return 1;
    in[0] = call->pre;
    for (k = 1; k < f->n_in; ++k) {
        const char *name = f->in[k].name;
        in[k] = call->zeros;
        for (i = 0; i < call->plan->n_in; ++i)
            if (strcmp(call->plan->names[i], name) == 0 && call->arg[i] != NULL) in[k] = call->arg[i];
        if (strcmp(name, "q") == 0) in[k] = call->unit;
        if (call->weights != NULL && strcmp(name, call->weights) == 0) in[k] = call->weighed;
    }
    for (k = 0; k < f->n_out; ++k) out[k] = values, values += sym_casadi_size(&f->out[k]);
    f->eval(in, out, call->work);
    return 0;
}

/* Second derivatives under the weights of the call, made those by coordinates. */
static int sym_casadi_second(const sym_casadi_call *call, const sym_casadi_source *source, const sym_function *f,
                             double *values, double *slope, double *half, double *made) {
    const size_t nq = (size_t)call->model->nq, nv = (size_t)call->model->nv;
    const size_t n = (size_t)f->out[source->array].rows, wide = n + nq - nv;
    double *out[SYM_CASADI_MOST], *gradient[SYM_CASADI_MOST], *after = values + sym_casadi_results(call->model);
    if (sym_casadi_evaluate(call, f, out, values)) return 1;
    if (source->gradient != NULL) {
        const sym_function *first = sym_find(call->model, source->gradient, source->frame);
        if (sym_casadi_evaluate(call, first, gradient, after)) return 1;
        sym_casadi_by_q(call->plan, call->q, call->unit, gradient[0], slope, 1);
    }
    sym_casadi_hessian(call->plan, call->q, call->unit, n, nv, wide, out[source->array], slope, half, made);
    return 0;
}

/* The array of a source, NULL where the model lacks a function. values: outputs of two functions; made: what they become. */
static const double *sym_casadi_array(sym_casadi_call *call, const sym_casadi_source *source, double *values, double *made) {
    const sym_function *f = sym_find(call->model, source->function, source->frame);
    const size_t nq = (size_t)call->model->nq, nv = (size_t)call->model->nv;
    double *out[SYM_CASADI_MOST], *slope, *half, *unit_weights;
    size_t rows, wide, i;
    int32_t k;
    if (f == NULL) return NULL;
    rows = (size_t)f->out[source->array].rows, wide = rows + nq - nv;
    if (source->kind <= SYM_CASADI_GRADIENT) {
        if (sym_casadi_evaluate(call, f, out, values)) return NULL;
        if (source->kind == SYM_CASADI_PLAIN) return out[source->array];
        if (source->kind == SYM_CASADI_GRADIENT) rows = 1;
        for (i = 0; i < rows; ++i)
            sym_casadi_by_q(call->plan, call->q, call->unit, out[source->array] + i * nv, made + i * nq, 1);
        return made;
    }
    unit_weights = made, slope = unit_weights + source->n_weights, half = slope + nq, made = half + rows * wide;
    if (source->kind == SYM_CASADI_HESSIAN)
        return sym_casadi_second(call, source, f, values, slope, half, made) ? NULL : made;
    for (k = 0; k < source->n_weights; ++k) {
        memset(unit_weights, 0, (size_t)source->n_weights * sizeof *unit_weights);
        unit_weights[k] = 1.0;
        call->weights = source->weights, call->weighed = unit_weights;
        if (sym_casadi_second(call, source, f, values, slope, half, made + (size_t)k * wide * wide)) return NULL;
    }
    call->weights = NULL;
    return made;
}

/* What is not given is zero. Outputs of one source stand together. Returns 0, or 1 where the model lacks a function. */
static int sym_casadi_run(const sym_model *model, const sym_casadi_plan *plan, const double **arg, double **res, double *w) {
    const size_t npar = (size_t)model->npar, largest = sym_casadi_largest(model);
    double *pre = w, *par = pre + model->npre, *zeros = par + npar, *unit = zeros + largest, *values = unit + model->nq;
    double *work = values + 2 * sym_casadi_results(model), *made = work + sym_work(model);
    sym_casadi_call call = {model, plan, arg, pre, zeros, unit, zeros, NULL, NULL, work};
    const double *array = NULL;
    int32_t i, o, at = -1;
    memset(par, 0, (npar + largest) * sizeof(double));
    for (i = 0; i < plan->n_in; ++i) {
        if (strcmp(plan->names[i], "par") == 0 && arg[i] != NULL) memcpy(par, arg[i], npar * sizeof(double));
        if (strcmp(plan->names[i], "q") == 0 && arg[i] != NULL) call.q = arg[i];
    }
    model->init(par, pre);
    sym_casadi_unit(plan, model->nq, call.q, unit);
    for (o = 0; o < plan->n_out; ++o) {
        const sym_casadi_output *output = &plan->outputs[o];
        casadi_int j;
        if (res[o] == NULL || output->count == 0) continue;
        if (output->source != at) array = sym_casadi_array(&call, &plan->sources[output->source], values, made);
        if (array == NULL) return 1;
        at = output->source;
        for (j = 0; j < output->count; ++j) res[o][j] = array[output->gather[j]];
    }
    return 0;
}
