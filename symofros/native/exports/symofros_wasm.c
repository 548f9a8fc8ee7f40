/* What a WebAssembly module shows of a model to JavaScript (symofros_wasm.mjs): pointers are numbers there.
 *
 * Memory comes from js_allocate; structs of the model are read through the calls below, so that no layout is known twice. */
#define SYM_JS(name) __attribute__((export_name(#name))) name

/* Of this model, written beside it. */
static const sym_plant *sym_js_plant(void);
static double sym_js_selftest(void);

double *SYM_JS(js_allocate)(size_t bytes) { return malloc(bytes); }
void SYM_JS(js_free)(void *memory) { free(memory); }
double SYM_JS(js_selftest)(void) { return sym_js_selftest(); }

/* Sizes and constants of the model: npre, scratch; defaults of parameters, neutral coordinates, start. */
size_t SYM_JS(js_size)(int32_t what) {
    const sym_model *model = sym_js_plant()->model();
    return what == 0 ? (size_t)model->npre : sym_work(model);
}
const double *SYM_JS(js_constant)(int32_t what) {
    const sym_plant *plant = sym_js_plant();
    const sym_model *model = plant->model();
    const double *const constants[] = {model->par_default, model->q_neutral, plant->q_start, plant->v_start, plant->u_start};
    return constants[what];
}
void SYM_JS(js_prepare)(const double *par, double *pre) { sym_js_plant()->model()->init(par, pre); }

/* Functions by their index: names, and arrays with their sizes; index -1 and names NULL at the ends. */
int32_t SYM_JS(js_functions)(void) { return sym_js_plant()->model()->n_functions; }
static const sym_function *sym_js_function(int32_t i) { return &sym_js_plant()->model()->functions[i]; }
const char *SYM_JS(js_function_name)(int32_t i) { return sym_js_function(i)->name; }
const char *SYM_JS(js_function_frame)(int32_t i) { return sym_js_function(i)->frame; }
int32_t SYM_JS(js_arrays)(int32_t i, int32_t out) { return out ? sym_js_function(i)->n_out : sym_js_function(i)->n_in; }
static const sym_array *sym_js_array(int32_t i, int32_t out, int32_t k) {
    return out ? &sym_js_function(i)->out[k] : &sym_js_function(i)->in[k];
}
const char *SYM_JS(js_array_name)(int32_t i, int32_t out, int32_t k) { return sym_js_array(i, out, k)->name; }
int32_t SYM_JS(js_array_rows)(int32_t i, int32_t out, int32_t k) { return sym_js_array(i, out, k)->rows; }
int32_t SYM_JS(js_array_cols)(int32_t i, int32_t out, int32_t k) { return sym_js_array(i, out, k)->cols; }
void SYM_JS(js_evaluate)(int32_t i, const double *const *in, double *const *out, double *work) {
    sym_js_function(i)->eval(in, out, work);
}
void SYM_JS(js_batch)(int32_t i, size_t n, const double *const *in, const size_t *stride, double *const *out, double *work) {
    sym_js_function(i)->batch(n, in, stride, out, work);
}

/* Instances, and their arrays in the order q, v, u, par, a, lam, pre. */
sym_instance *SYM_JS(js_instance)(void) {
    const size_t size = sym_instance_size(sym_js_plant());
    void *memory = malloc(size);
    return memory == NULL ? NULL : sym_instance_init(memory, size, sym_js_plant());
}
double *SYM_JS(js_array)(sym_instance *s, int32_t what) {
    double *const arrays[] = {s->q, s->v, s->u, s->par, s->a, s->lam, s->pre};
    return arrays[what];
}
double SYM_JS(js_time)(const sym_instance *s) { return s->t; }
void SYM_JS(js_set_time)(sym_instance *s, double t) { s->t = t; }
void SYM_JS(js_reset)(sym_instance *s) { sym_instance_reset(s); }
int32_t SYM_JS(js_set_parameters)(sym_instance *s) { return sym_instance_prepare(s); }
const char *SYM_JS(js_refused)(const sym_instance *s) { return s->refused < 0 ? NULL : s->plant->conditions[s->refused]; }
int32_t SYM_JS(js_project)(sym_instance *s) { return sym_instance_project(s); }
int32_t SYM_JS(js_accelerate)(sym_instance *s) { return sym_instance_accelerate(s); }
int32_t SYM_JS(js_advance)(sym_instance *s, double t_end, double h) { return sym_instance_advance(s, t_end, h); }
int32_t SYM_JS(js_call)(sym_instance *s, int32_t i, double *const *out) { return sym_instance_call(s, sym_js_function(i), out); }
