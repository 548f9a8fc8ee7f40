/* FMI 3.0 over symofros_fmi.h. Written by hand. */
#define FMI(name) fmi3##name
#define FMI_INSTANCE fmi3Instance
#define FMI_REAL fmi3Float64
#define FMI_STATE fmi3FMUState
#define FMI_STATES(verb) fmi3##verb##FMUState
#define FMI_STATES_SIZE fmi3SerializedFMUStateSize
#define FMI_DESERIALIZE fmi3DeserializeFMUState

static const char *category(fmi3Status status);

static fmi3Status say(const fmu *f, fmi3Status status, const char *message) {
    fmi3LogMessageCallback logger;
    memcpy(&logger, &f->logger, sizeof logger);
    if (logger != NULL) logger(f->environment, status, category(status), message);
    return status;
}

#include "symofros_fmi_shared.h"

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    fmu *f = c;
    (void)on, (void)n, (void)categories; /* errors are always logged; nothing else is */
    ALLOWED(1);
    return fmi3OK;
}

static fmi3Instance instantiate(int cosim, fmi3String name, fmi3String token, fmi3InstanceEnvironment environment,
                                fmi3LogMessageCallback logger) {
    fmu *f;
    if (name == NULL || token == NULL || strcmp(token, SYM_FMU_TOKEN) != 0) {
        if (logger != NULL) logger(environment, fmi3Error, "logStatusError", "the instantiation token is another one");
        return NULL;
    }
    f = fmu_new(cosim, name, calloc, free);
    if (f == NULL) {
        if (logger != NULL) logger(environment, fmi3Error, "logStatusError", fmi_message(fmu_absent(cosim)));
        return NULL;
    }
    f->environment = environment;
    memcpy(&f->logger, &logger, sizeof f->logger);
    fmu_reset(f);
    return f;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logger) {
    (void)resources, (void)visible, (void)logging;
    return instantiate(0, name, token, environment, logger);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                         fmi3IntermediateUpdateCallback update) {
    (void)resources, (void)visible, (void)logging, (void)early, (void)required, (void)update;
    if (events || n > 0) { /* neither is among the capabilities that the description states */
        if (logger != NULL)
            logger(environment, fmi3Error, "logStatusError", "no event mode, and no intermediate variables");
        return NULL;
    }
    return instantiate(1, name, token, environment, logger);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    if (logger != NULL) logger(environment, fmi3Error, "logStatusError", "no scheduled execution");
    return NULL;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
    fmu *f = c;
    int found;
    ALLOWED(1);
    found = fmi_prepare(f, has_tolerance, tolerance, start, has_stop ? 1 : 0, stop);
    if (found == FMU_OK) f->phase = FMU_INITIALISING;
    return outcome(f, found);
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[], size_t nv) {
    ANSWER(n != nv ? FMU_WRONG_SIZE : fmi_get(f, vr, n, value));
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[],
                          size_t nv) {
    ANSWER(n != nv ? FMU_WRONG_SIZE : fmi_set(f, vr, n, value));
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t n_unknown,
                                        const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                        size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity) {
    ANSWER(n_seed != n_known || n_sensitivity != n_unknown
               ? FMU_WRONG_SIZE
               : fmi_differentiate(f, unknown, n_unknown, known, n_known, seed, sensitivity));
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t n_unknown,
                                    const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                    size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity) {
    fmu *f = c;
    (void)unknown, (void)n_unknown, (void)known, (void)n_known;
    (void)seed, (void)n_seed, (void)sensitivity, (void)n_sensitivity;
    ALLOWED(0); /* not among the capabilities that the description states */
    return fmi3Error;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_EVENT);
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_EVENT);
    NEEDED(again && terminate && nominals && states && has_next && next);
    *again = *terminate = *nominals = *states = fmi3False;
    *next = 0.0;
    *has_next = fmu_next_event(f, next) ? fmi3True : fmi3False;
    return fmi3OK;
}

/* Model Exchange. */

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t n) {
    ANSWER(fmi_get_rates(f, derivatives, n));
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n) {
    fmu *f = c;
    ALLOWED(!f->cosim);
    NEEDED(n);
    *n = 0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n) {
    fmu *f = c;
    ALLOWED(!f->cosim);
    NEEDED(n);
    *n = fmu_states(f);
    return fmi3OK;
}

/* Co-Simulation. */

fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(0); /* only from event mode, which there is none of */
    return fmi3Error;
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int32 orders[],
                                    fmi3Float64 value[], size_t nv) {
    fmu *f = c;
    (void)vr, (void)orders, (void)value;
    ALLOWED(f->cosim && n == 0 && nv == 0);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 t, fmi3Float64 h, fmi3Boolean final, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    fmu *f = c;
    int found;
    (void)final;
    ALLOWED(f->cosim && f->phase == FMU_STEPPING);
    NEEDED(event && terminate && early && last);
    *event = *terminate = *early = fmi3False;
    found = fmi_step(f, t, h);
    *last = *fmu_time(f);
    if (found == FMU_OK && fmu_remark(f)) say(f, fmi3Warning, f->message);
    return outcome(f, found);
}
