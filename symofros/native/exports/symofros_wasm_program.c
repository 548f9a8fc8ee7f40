/* What a WebAssembly module shows of a diagram to JavaScript (symofros_wasm_program.mjs): pointers are numbers there. Written by
 * hand. Included by the file that names the diagram: it defines SYM_WASM_PROGRAM. */
#define SYM_JS(name) __attribute__((export_name(#name))) name

/* An instance at its start; NULL where there is no memory, or no first state on the constraints. */
sym_program_instance *SYM_JS(js_instance)(void) {
    const size_t size = sym_program_size(SYM_WASM_PROGRAM());
    void *memory = malloc(size);
    sym_program_instance *instance = memory == NULL ? NULL : sym_program_init(memory, size, SYM_WASM_PROGRAM());
    if (instance == NULL) free(memory);
    return instance;
}
void SYM_JS(js_free)(sym_program_instance *instance) { free(instance); }

/* Arrays in the order inputs, signals, par. */
double *SYM_JS(js_array)(sym_program_instance *instance, int32_t what) {
    double *const arrays[] = {instance->inputs, instance->signals, instance->par};
    return arrays[what];
}
void SYM_JS(js_set)(sym_program_instance *instance, int32_t i, double value) { sym_program_set(instance, i, value); }
double SYM_JS(js_present)(const sym_program_instance *instance, int32_t i) { return sym_program_present(instance, i); }
double SYM_JS(js_time)(const sym_program_instance *instance) { return *instance->diagram.t; }
const char *SYM_JS(js_refused)(const sym_program_instance *instance) { return sym_program_refused(instance); }
int32_t SYM_JS(js_start)(sym_program_instance *instance) { return sym_program_start(instance); }
int32_t SYM_JS(js_prepare)(sym_program_instance *instance) { return sym_program_prepare(instance); }
int32_t SYM_JS(js_evaluate)(sym_program_instance *instance) { return sym_program_evaluate(instance); }
int32_t SYM_JS(js_advance)(sym_program_instance *instance, double t, int32_t before_samples) {
    return before_samples ? sym_program_approach(instance, t) : sym_program_advance(instance, t);
}
