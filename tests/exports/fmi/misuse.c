/* Calls in a wrong order, with wrong times and with NULL, of a unit whose source (UNIT) and version (VERSION) are given by
 * macros: none may read or write what is not its own, and each is refused in words. Prints what the logger got. */
#include UNIT
#include <stdarg.h>
#include <stdio.h>

static int failures, messages;

#if VERSION == 2
static void logger(fmi2ComponentEnvironment to, fmi2String name, fmi2Status status, fmi2String kind, fmi2String format,
                   ...) {
    va_list given;
    va_start(given, format);
    (void)to, (void)name, (void)status, (void)kind;
    ++messages, vprintf(format, given), putchar('\n');
    va_end(given);
}
static void *none(size_t n, size_t size) { return (void)n, (void)size, NULL; }
static void step_finished(fmi2ComponentEnvironment to, fmi2Status status) { (void)to, (void)status; }
static const fmi2CallbackFunctions callbacks = {logger, calloc, free, step_finished, NULL};
static const fmi2CallbackFunctions poor = {logger, none, free, step_finished, NULL};
static const fmi2CallbackFunctions silent = {NULL, calloc, free, NULL, NULL};
#define NEW_OF(name, cosim, token, functions) \
    fmi2Instantiate(name, cosim ? fmi2CoSimulation : fmi2ModelExchange, token, "", functions, fmi2False, fmi2False)
#define NEW(cosim) NEW_OF("it", cosim, SYM_FMU_TOKEN, &callbacks)
#define NEW_SILENT() NEW_OF("it", 1, SYM_FMU_TOKEN, &silent)
#define REAL(verb, c, vr, n, x) fmi2##verb##Real(c, vr, n, x)
#define SLOPE(c, of, n, by, m, seed, x) fmi2GetDirectionalDerivative(c, of, n, by, m, seed, x)
#define STEP(c, t, h) fmi2DoStep(c, t, h, fmi2True)
#define RATES fmi2GetDerivatives
static fmi2Status begin(fmi2Component c, double start, int has_stop, double stop) {
    const fmi2Status status = fmi2SetupExperiment(c, fmi2False, 0.0, start, has_stop, stop);
    return status == fmi2OK ? fmi2EnterInitializationMode(c) : status;
}
static fmi2Status events(fmi2Component c) {
    fmi2EventInfo info;
    return fmi2NewDiscreteStates(c, &info);
}
#else
static void logger(fmi3InstanceEnvironment to, fmi3Status status, fmi3String kind, fmi3String message) {
    (void)to, (void)status, (void)kind;
    ++messages, puts(message);
}
#define NEW_COSIM(name, token, log) \
    fmi3InstantiateCoSimulation(name, token, "", 0, 0, 0, 0, NULL, 0, NULL, log, NULL)
#define NEW(cosim) \
    ((cosim) ? NEW_COSIM("it", SYM_FMU_TOKEN, logger) \
             : fmi3InstantiateModelExchange("it", SYM_FMU_TOKEN, "", 0, 0, NULL, logger))
#define NEW_SILENT() NEW_COSIM("it", SYM_FMU_TOKEN, NULL)
#define REAL(verb, c, vr, n, x) fmi3##verb##Float64(c, vr, n, x, n)
#define SLOPE(c, of, n, by, m, seed, x) fmi3GetDirectionalDerivative(c, of, n, by, m, seed, m, x, n)
#define RATES fmi3GetContinuousStateDerivatives
static fmi3Status STEP(fmi3Instance c, double t, double h) {
    fmi3Boolean event, terminate, early;
    fmi3Float64 last;
    return fmi3DoStep(c, t, h, fmi3True, &event, &terminate, &early, &last);
}
static fmi3Status begin(fmi3Instance c, double start, int has_stop, double stop) {
    return fmi3EnterInitializationMode(c, fmi3False, 0.0, start, has_stop != 0, stop);
}
static fmi3Status events(fmi3Instance c) {
    fmi3Boolean flag[5];
    fmi3Float64 next;
    return fmi3UpdateDiscreteStates(c, flag, flag + 1, flag + 2, flag + 3, flag + 4, &next);
}
#endif

static void expect(int condition, const char *call, int line) {
    if (!condition) ++failures, printf("FAILED in line %d: %s\n", line, call);
}
#define OKAY(call) expect((call) == FMI(OK), #call, __LINE__)
/* An error, with one message. */
#define REFUSED(call) \
    do { \
        const int before = messages; \
        const FMI(Status) status = (call); \
        expect(status == FMI(Error) && messages == before + 1, #call, __LINE__); \
    } while (0)

static const uint32_t state = 1; /* the first coordinate */

static double stepped(FMI_INSTANCE c, double t) {
    double q = 0.0;
    OKAY(STEP(c, t, 0.01));
    OKAY(REAL(Get, c, &state, 1, &q));
    return q;
}

static void steps_that_are_none(void) {
    const double no[3] = {0.0, -0.01, HUGE_VAL};
    FMI_INSTANCE c = NEW(1);
    int i;
    REFUSED(STEP(c, 0.0, 0.01)); /* not yet initialised */
    REFUSED(begin(c, HUGE_VAL - HUGE_VAL, 0, 0.0));
    REFUSED(begin(c, 1.0, 1, 0.0));
    OKAY(begin(c, 0.0, 1, 0.025));
    REFUSED(STEP(c, 0.0, 0.01));
    OKAY(FMI(ExitInitializationMode)(c));
    OKAY(STEP(c, 0.0, 0.01));
    for (i = 0; i < 3; ++i) REFUSED(STEP(c, 0.01, no[i]));
    REFUSED(STEP(c, 0.01, no[2] - no[2]));
    REFUSED(STEP(c, 0.0, 0.01)); /* backwards */
    REFUSED(STEP(c, 0.02, 0.01));
    REFUSED(STEP(c, 0.01, 0.02)); /* beyond the stop time */
    OKAY(STEP(c, 0.01, 0.015));
    FMI(FreeInstance)(c); /* without having been terminated */
    c = NEW(1);
    OKAY(begin(c, 0.0, 1, HUGE_VAL)); /* no stop time */
    OKAY(FMI(ExitInitializationMode)(c));
    OKAY(STEP(c, 0.0, 0.01));
    FMI(FreeInstance)(c);
    FMI(FreeInstance)(NULL);
}

/* Two instances in turn, one of which begins anew in between, move as one alone; so does one that has no logger. */
static void instances_side_by_side(void) {
    FMI_INSTANCE one = NEW(1), other = NEW(1), alone = NEW_SILENT();
    double first[3], q;
    int i;
    OKAY(begin(alone, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(alone));
    expect(STEP(alone, 5.0, 0.01) == FMI(Error), "a step elsewhere, unheard", __LINE__);
    for (i = 0; i < 3; ++i) first[i] = stepped(alone, 0.01 * i);
    FMI(FreeInstance)(alone);
    OKAY(begin(one, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(one));
    stepped(one, 0.0);
    ((fmu *)one)->instance->run.rtol = 1.0;
    OKAY(FMI(Reset)(one));
    expect(((fmu *)one)->instance->run.rtol == SYM_FMU_PLANT()->rtol, "tolerance after a reset", __LINE__);
    REFUSED(STEP(one, 0.01, 0.01));
    OKAY(begin(one, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(one));
    OKAY(begin(other, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(other));
    for (i = 0; i < 3; ++i) {
        expect(stepped(one, 0.01 * i) == first[i], "one of two", __LINE__);
        expect(stepped(other, 0.01 * i) == first[i], "the other of two", __LINE__);
    }
    OKAY(FMI(Terminate)(one));
    REFUSED(FMI(Terminate)(one));
    REFUSED(STEP(one, 0.03, 0.01));
    OKAY(REAL(Get, one, &state, 1, &q)); /* final values are asked for */
    REFUSED(REAL(Set, one, &state, 1, &q));
    REFUSED(SLOPE(one, &state, 1, &state, 1, &q, &q));
    REFUSED(FMI(ExitInitializationMode)(one));
    FMI(FreeInstance)(one);
    stepped(other, 0.03); /* after the other one is gone */
    FMI(FreeInstance)(other);
}

static void states_of_others(void) {
    FMI_INSTANCE c = NEW(1);
    FMI_STATE own = NULL, copy = NULL;
    size_t size = 0;
    fmu_snapshot *foreign = calloc(1, sizeof *foreign); /* of a model without a variable */
    FMI(Byte) *bytes;
    REFUSED(FMI_STATES(Get)(c, NULL));
    REFUSED(FMI_STATES(Set)(c, NULL));
    OKAY(FMI_STATES(Free)(c, NULL));
    OKAY(FMI_STATES(Free)(c, &own));
    OKAY(FMI_STATES(Get)(c, &own));
    REFUSED(FMI_STATES_SIZE(c, own, NULL));
    REFUSED(FMI_STATES_SIZE(c, foreign, &size));
    OKAY(FMI_STATES_SIZE(c, own, &size));
    bytes = calloc(size, 1);
    REFUSED(FMI_STATES(Serialize)(c, own, NULL, size));
    REFUSED(FMI_STATES(Serialize)(c, own, bytes, size - 1));
    REFUSED(FMI_STATES(Serialize)(c, foreign, bytes, size));
    REFUSED(FMI_DESERIALIZE(c, bytes, size, &copy)); /* of no model yet */
    OKAY(FMI_STATES(Serialize)(c, own, bytes, size));
    REFUSED(FMI_DESERIALIZE(c, bytes, size, NULL));
    REFUSED(FMI_DESERIALIZE(c, NULL, size, &copy));
    OKAY(FMI_DESERIALIZE(c, bytes, size, &copy));
    REFUSED(FMI_STATES(Set)(c, foreign));
    OKAY(FMI_STATES(Set)(c, copy));
    OKAY(FMI_STATES(Free)(c, &own)), OKAY(FMI_STATES(Free)(c, &own)), OKAY(FMI_STATES(Free)(c, &copy));
    FMI(FreeInstance)(c);
    free(bytes), free(foreign);
}

static void model_exchange_without_arrays(void) {
    FMI_INSTANCE c = NEW(0);
    FMI(Boolean) flag;
    const size_t n = fmu_states(c);
    const double no_number = HUGE_VAL - HUGE_VAL;
    double *x = calloc(n, sizeof *x);
    REFUSED(FMI(EnterContinuousTimeMode)(c));
    REFUSED(FMI(GetNominalsOfContinuousStates)(c, NULL, n));
    OKAY(begin(c, 0.0, 0, 0.0));
    REFUSED(REAL(Get, c, &state, 1, NULL));
    REFUSED(REAL(Get, c, NULL, 1, x));
    REFUSED(REAL(Set, c, &state, 1, NULL));
    REFUSED(REAL(Set, c, NULL, 1, x));
    OKAY(REAL(Set, c, NULL, 0, NULL));
    OKAY(FMI(ExitInitializationMode)(c));
    REFUSED(STEP(c, 0.0, 0.01)); /* not of this kind */
    OKAY(events(c));
    OKAY(FMI(EnterContinuousTimeMode)(c));
    REFUSED(events(c));
    REFUSED(FMI(SetTime)(c, HUGE_VAL));
    REFUSED(FMI(SetContinuousStates)(c, NULL, n));
    REFUSED(FMI(SetContinuousStates)(c, x, n - 1));
    REFUSED(FMI(GetContinuousStates)(c, NULL, n));
    REFUSED(RATES(c, NULL, n));
    REFUSED(SLOPE(c, &state, 1, &state, 1, NULL, x));
    REFUSED(SLOPE(c, NULL, 1, &state, 1, x, x));
    REFUSED(SLOPE(c, &state, 1, &state, 1, &no_number, x));
    REFUSED(FMI(CompletedIntegratorStep)(c, FMI(True), NULL, &flag));
    OKAY(FMI(GetContinuousStates)(c, x, n));
    OKAY(FMI(SetTime)(c, -1.0)); /* integrators go back to try a shorter step */
    OKAY(FMI(EnterEventMode)(c));
    FMI(FreeInstance)(c);
    free(x);
}

/* What either version alone has. */
static void of_one_version(void) {
#if VERSION == 2
    FMI_INSTANCE c;
    const fmi2String text = NULL;
    expect(NEW_OF(NULL, 1, SYM_FMU_TOKEN, &callbacks) == NULL && messages > 0, "no name", __LINE__);
    expect(NEW_OF("it", 1, NULL, &silent) == NULL && NEW_OF("it", 1, "", NULL) == NULL, "no token", __LINE__);
    messages = 0;
    expect(NEW_OF("it", 1, SYM_FMU_TOKEN, &poor) == NULL && messages == 1, "no memory", __LINE__);
    c = NEW(1);
    REFUSED(fmi2SetString(c, &state, 1, &text));
    REFUSED(fmi2SetString(c, NULL, 1, NULL));
    OKAY(fmi2SetDebugLogging(c, fmi2True, 1, &text));
    REFUSED(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, NULL));
    FMI(FreeInstance)(c);
    c = NEW(0);
    OKAY(begin(c, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(c));
    REFUSED(fmi2NewDiscreteStates(c, NULL));
#else
    FMI_INSTANCE c = NEW(1);
    const fmi3String text = NULL;
    fmi3Float64 x;
    expect(NEW_COSIM(NULL, SYM_FMU_TOKEN, logger) == NULL && messages > 0, "no name", __LINE__);
    expect(NEW_COSIM("it", NULL, NULL) == NULL, "no token, unheard", __LINE__);
    REFUSED(fmi3SetString(c, &state, 1, &text, 1));
    REFUSED(fmi3SetString(c, NULL, 1, NULL, 1));
    REFUSED(fmi3GetFloat64(c, &state, 1, &x, 2));
    OKAY(begin(c, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(c));
    REFUSED(fmi3DoStep(c, 0.0, 0.01, fmi3True, NULL, NULL, NULL, NULL));
    FMI(FreeInstance)(c);
    c = NEW(0);
    REFUSED(fmi3GetNumberOfContinuousStates(c, NULL));
    OKAY(begin(c, 0.0, 0, 0.0)), OKAY(FMI(ExitInitializationMode)(c));
    REFUSED(fmi3UpdateDiscreteStates(c, NULL, NULL, NULL, NULL, NULL, NULL));
#endif
    FMI(FreeInstance)(c);
}

int main(void) {
    steps_that_are_none();
    instances_side_by_side();
    states_of_others();
    model_exchange_without_arrays();
    of_one_version();
    return failures > 0;
}
