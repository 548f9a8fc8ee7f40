/* symofros_fmu_program.h - an exported diagram as a functional mock-up unit of Co-Simulation, apart from the version of the
 * interface. Written by hand.
 *
 * Value references run through, in this order: time, inputs, outputs, parameters. Included by the file that names the diagram:
 * it defines SYM_FMU_PROGRAM and SYM_FMU_TOKEN. What symofros_fmi.h calls is also in symofros_fmu.h.
 */
#include "symofros_fmu_codes.h"

typedef struct fmu {
    sym_program_instance *instance; /* at the beginning of its memory */
    size_t size;
    fmu_phase phase;
    int cosim, has_stop, discarded, rates_valid; /* discarded: whether the last step was */
    int parameters_valid, outputs_valid; /* whether the program, and its signals, are of what was set last */
    double stop, *rates;
    void *environment, *logger;
    char *name;
    char message[256];
    void (*release)(void *);
} fmu;

typedef struct fmu_snapshot { /* followed by the instance's memory, which holds addresses of its own */
    const fmu *owner;
    double stop;
    fmu_phase phase;
    int has_stop, parameters_valid;
} fmu_snapshot;

static fmu *fmu_new(int cosim, const char *name, void *(*allocate)(size_t, size_t), void (*release)(void *)) {
    const size_t size = sym_program_size(SYM_FMU_PROGRAM()), length = name == NULL ? 0 : strlen(name);
    const size_t doubles = sym_doubles(sizeof(fmu)) + sym_doubles(size) + sym_doubles(length + 1);
    double *memory = cosim ? allocate(doubles, sizeof *memory) : NULL;
    fmu *f = (fmu *)(void *)memory;
    if (memory == NULL) return NULL;
    memset(f, 0, sizeof *f);
    f->size = size, f->cosim = cosim, f->release = release, f->phase = FMU_INSTANTIATED;
    f->instance = sym_program_init(memory + sym_doubles(sizeof *f), size, SYM_FMU_PROGRAM());
    f->name = (char *)(memory + sym_doubles(sizeof *f) + sym_doubles(size));
    if (length > 0) memcpy(f->name, name, length);
    f->name[length] = '\0';
    if (f->instance != NULL) return f;
    release(memory);
    return NULL;
}

/* Why there is no unit. */
static int fmu_absent(int cosim) { return cosim ? FMU_NO_MEMORY : FMU_NOT_ALLOWED; }

static double *fmu_time(const fmu *f) { return f->instance->diagram.t; }

static void fmu_set_tolerance(fmu *f, double tolerance) {
    int32_t i;
    for (i = 0; i < f->instance->program->n_parts; ++i)
        if (f->instance->parts[i]->run.adaptive) f->instance->parts[i]->run.rtol = tolerance;
}

/* Model Exchange is not offered, nor are derivatives. */
static size_t fmu_states(const fmu *f) { return (void)f, 0; }
static void fmu_put_states(fmu *f, const double *x) { (void)f, (void)x; }
static void fmu_take_states(const fmu *f, double *x) { (void)f, (void)x; }
static int fmu_judge(fmu *f) { return (void)f, 0; }
static int fmu_refresh(fmu *f) { return (void)f, FMU_WRONG_MODE; }
static int fmu_next_event(fmu *f, double *next) { return (void)f, (void)next, 0; }
static int fmu_differentiate(fmu *f, size_t n_unknown, const uint32_t *unknown, size_t n_known, const uint32_t *known,
                             const double *seed, double *derivative) {
    (void)f, (void)n_unknown, (void)unknown, (void)n_known, (void)known, (void)seed, (void)derivative;
    return FMU_WRONG_MODE;
}

/* A beam that bends beyond its theory ends a step; below that nothing is said. */
static int fmu_remark(fmu *f) { return (void)f, 0; }
static int fmu_note_start(fmu *f) { return (void)f, 0; }

static void fmu_reset(fmu *f) {
    f->instance = sym_program_init(f->instance, f->size, SYM_FMU_PROGRAM()); /* it began so before */
    f->phase = FMU_INSTANTIATED, f->has_stop = 0, f->parameters_valid = 1, f->outputs_valid = 0;
}

/* What is refused is said in f->message. */
static const char *fmu_condition(int which) { return (void)which, "parameters are refused"; }

static int fmu_answer(fmu *f, int32_t status) {
    const char *reason;
    if (status >= 0) return FMU_OK;
    if (status == SYM_NO_ROTATION) return FMU_INPUT_NO_ROTATION;
    reason = status == SYM_BEYOND_THEORY ? "a beam bends beyond its theory" : fmu_reason(status);
    if (reason != NULL) return strcpy(f->message, reason), FMU_BEYOND_THEORY;
    if (status != SYM_PARAMETERS_REFUSED) return FMU_SINGULAR;
    sprintf(f->message, "%.250s", sym_program_refused(f->instance));
    return FMU_REFUSED;
}

/* What depends on parameters: before the start also the first state. */
static int fmu_prepare(fmu *f) {
    int found = FMU_OK;
    if (f->parameters_valid) return FMU_OK;
    found = fmu_answer(f, f->phase <= FMU_INITIALISING ? sym_program_start(f->instance) : sym_program_prepare(f->instance));
    f->parameters_valid = found == FMU_OK;
    return found;
}

static int fmu_get(fmu *f, size_t reference, double *value) {
    const sym_program *p = f->instance->program;
    const size_t in = (size_t)p->n_inputs, out = (size_t)p->n_outputs, par = (size_t)p->instants()->npar;
    int found = FMU_OK;
    if (reference == 0) return *value = *fmu_time(f), FMU_OK;
    if (--reference < in) return *value = f->instance->inputs[reference], FMU_OK;
    if ((reference -= in) >= out) {
        if ((reference -= out) >= par) return FMU_UNKNOWN;
        return *value = sym_program_present(f->instance, (int32_t)reference), FMU_OK;
    }
    if (!f->outputs_valid) {
        found = fmu_prepare(f);
        if (found == FMU_OK) found = fmu_answer(f, sym_program_evaluate(f->instance));
        f->outputs_valid = found == FMU_OK;
    }
    *value = f->instance->signals[reference];
    return found;
}

static int fmu_set(fmu *f, size_t reference, double value) {
    const sym_program *p = f->instance->program;
    const size_t in = (size_t)p->n_inputs, out = (size_t)p->n_outputs;
    if (reference > in + out + (size_t)p->instants()->npar) return FMU_UNKNOWN;
    if (reference == 0 || !(value - value == 0.0) || f->phase == FMU_TERMINATED) return FMU_NOT_ALLOWED;
    if (--reference < in) f->instance->inputs[reference] = value;
    else if ((reference -= in) < out) return FMU_NOT_ALLOWED;
    else sym_program_set(f->instance, (int32_t)(reference - out), value), f->parameters_valid = 0;
    f->outputs_valid = 0;
    return FMU_OK;
}

static int fmu_initialise(fmu *f) {
    int found;
    if (*fmu_time(f) != 0.0) {
        strcpy(f->message, "a diagram begins at t = 0: samples are multiples of their periods from there");
        return FMU_REFUSED;
    }
    found = fmu_answer(f, sym_program_start(f->instance));
    if (found == FMU_OK) found = fmu_answer(f, sym_program_advance(f->instance, 0.0));
    if (found == FMU_OK) f->phase = FMU_STEPPING, f->parameters_valid = f->outputs_valid = 1;
    return found;
}

/* One communication step, to time t. */
static int fmu_step(fmu *f, double t) {
    const int found = fmu_answer(f, sym_program_advance(f->instance, t));
    f->outputs_valid = found == FMU_OK;
    return found;
}

static size_t fmu_snapshot_size(const fmu *f) { return sizeof(fmu_snapshot) + f->size; }

static void fmu_save(const fmu *f, void *into) {
    fmu_snapshot head;
    memset(&head, 0, sizeof head);
    head.owner = f, head.stop = f->stop, head.phase = f->phase, head.has_stop = f->has_stop;
    head.parameters_valid = f->parameters_valid;
    memcpy(into, &head, sizeof head);
    memcpy((char *)into + sizeof head, f->instance, f->size);
}

/* Whether a snapshot is of this unit. */
static int fmu_owns(const fmu *f, const void *snapshot) {
    fmu_snapshot head;
    memcpy(&head, snapshot, sizeof head);
    return head.owner == f;
}

/* Returns 0 where the snapshot is of another unit. */
static int fmu_load(fmu *f, const void *from) {
    fmu_snapshot head;
    if (!fmu_owns(f, from)) return 0;
    memcpy(&head, from, sizeof head);
    f->stop = head.stop, f->phase = head.phase, f->has_stop = head.has_stop;
    f->parameters_valid = head.parameters_valid, f->outputs_valid = 0;
    memcpy(f->instance, (const char *)from + sizeof head, f->size);
    return 1;
}
