/* FMI 3.0 over symofros_fmu.h. Written by hand. */

static fmi3Status say(const fmu *f, fmi3Status status, const char *message) {
    fmi3LogMessageCallback logger;
    memcpy(&logger, &f->logger, sizeof logger);
    if (logger != NULL) logger(f->environment, status, status == fmi3Discard ? "logStatusDiscard" : "logStatusError", message);
    return status;
}

static fmi3Status outcome(const fmu *f, int found) {
    switch (found) {
    case FMU_OK: return fmi3OK;
    case FMU_UNKNOWN: return say(f, fmi3Error, "no such variable, or not one for this call");
    case FMU_NO_MOTION: return say(f, fmi3Discard, "no finite acceleration, or constraints that can't be met");
    default: return say(f, fmi3Error, "not allowed in this mode, or not a legal value");
    }
}

#define ALLOWED(condition) \
    if (f == NULL) return fmi3Error; \
    if (!(condition)) return say(f, fmi3Error, "the call is not allowed in this mode")

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    fmu *f = c;
    (void)on, (void)n, (void)categories; /* errors are always told; there is nothing else to tell */
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
    if (f == NULL) return NULL;
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

void fmi3FreeInstance(fmi3Instance c) {
    fmu *f = c;
    if (f != NULL) f->release(f);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_INSTANTIATED);
    if (has_stop && !(stop >= start)) return say(f, fmi3Error, "the stop time is before the start time");
    if (has_tolerance && tolerance > 0.0 && f->it->run.adaptive) f->it->run.rtol = tolerance;
    f->it->t = start, f->stops = has_stop ? 1 : 0, f->stop = stop;
    f->phase = FMU_INITIALISING;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_INITIALISING);
    return fmu_initialise(f) == FMU_OK ? fmi3OK : say(f, fmi3Error, "no state near the start meets the constraints");
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(!f->cosim && (f->phase == FMU_CONTINUOUS || f->phase == FMU_EVENT));
    f->phase = FMU_EVENT;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(f->phase >= FMU_EVENT && f->phase <= FMU_STEPPING);
    f->phase = FMU_TERMINATED;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(1);
    fmu_reset(f);
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 value[], size_t nv) {
    fmu *f = c;
    size_t i;
    ALLOWED(f->phase != FMU_INSTANTIATED && n == nv);
    for (i = 0; i < n; ++i) {
        const int found = fmu_get(f, vr[i], &value[i]);
        if (found != FMU_OK) return outcome(f, found);
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 value[],
                          size_t nv) {
    fmu *f = c;
    size_t i;
    ALLOWED(n == nv);
    for (i = 0; i < n; ++i) {
        const int found = fmu_set(f, vr[i], value[i]);
        if (found != FMU_OK) return outcome(f, found);
    }
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    fmu *f = c;
    ALLOWED(1);
    if (*state == NULL) *state = malloc(fmu_snapshot_size(f));
    if (*state == NULL) return say(f, fmi3Error, "no memory");
    fmu_save(f, *state);
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    fmu *f = c;
    ALLOWED(state != NULL);
    return fmu_load(f, state) ? fmi3OK : say(f, fmi3Error, "the state is of another model or kind");
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    fmu *f = c;
    ALLOWED(1);
    if (state != NULL) free(*state), *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    fmu *f = c;
    ALLOWED(state != NULL);
    *size = fmu_snapshot_size(f);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    fmu *f = c;
    ALLOWED(state != NULL);
    if (size < fmu_snapshot_size(f)) return say(f, fmi3Error, "too few bytes");
    memcpy(bytes, state, fmu_snapshot_size(f));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    fmu *f = c;
    ALLOWED(1);
    if (size != fmu_snapshot_size(f)) return say(f, fmi3Error, "bytes of another model");
    if (*state == NULL) *state = malloc(size);
    if (*state == NULL) return say(f, fmi3Error, "no memory");
    memcpy(*state, bytes, size);
    return fmi3OK;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference unknown[], size_t n_unknown,
                                        const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[],
                                        size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity) {
    fmu *f = c;
    ALLOWED(f->phase != FMU_INSTANTIATED && f->phase != FMU_TERMINATED && n_seed == n_known &&
            n_sensitivity == n_unknown);
    return outcome(f, fmu_differentiate(f, n_unknown, unknown, n_known, known, seed, sensitivity));
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
    *again = *terminate = *nominals = *states = *has_next = fmi3False;
    *next = 0.0;
    return fmi3OK;
}

/* Model Exchange. */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(!f->cosim && f->phase == FMU_EVENT);
    f->phase = FMU_CONTINUOUS;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean final, fmi3Boolean *event, fmi3Boolean *terminate) {
    fmu *f = c;
    (void)final;
    ALLOWED(!f->cosim && f->phase == FMU_CONTINUOUS);
    *event = *terminate = fmi3False;
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 t) {
    fmu *f = c;
    ALLOWED(!f->cosim && (f->phase == FMU_CONTINUOUS || f->phase == FMU_EVENT));
    f->it->t = t, f->fresh = 0;
    return fmi3OK;
}

#define STATES(f) ((size_t)(f)->it->model->nq + (size_t)(f)->it->model->nv)

fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n) {
    fmu *f = c;
    size_t nq;
    ALLOWED(!f->cosim && f->phase == FMU_CONTINUOUS && n == STATES(f));
    nq = (size_t)f->it->model->nq;
    memcpy(f->it->q, x, nq * sizeof *x), memcpy(f->it->v, x + nq, (n - nq) * sizeof *x);
    f->fresh = 0;
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t n) {
    fmu *f = c;
    size_t nq;
    ALLOWED(!f->cosim && f->phase >= FMU_INITIALISING && n == STATES(f));
    nq = (size_t)f->it->model->nq;
    memcpy(x, f->it->q, nq * sizeof *x), memcpy(x + nq, f->it->v, (n - nq) * sizeof *x);
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t n) {
    fmu *f = c;
    int found;
    ALLOWED(!f->cosim && f->phase >= FMU_INITIALISING && n == STATES(f));
    found = fmu_refresh(f);
    if (found == FMU_OK) memcpy(derivatives, f->rates, n * sizeof *derivatives);
    return outcome(f, found);
}

fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t n) {
    fmu *f = c;
    (void)indicators;
    ALLOWED(!f->cosim && n == 0);
    return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t n) {
    fmu *f = c;
    size_t i;
    ALLOWED(!f->cosim && n == STATES(f));
    for (i = 0; i < n; ++i) nominals[i] = 1.0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n) {
    fmu *f = c;
    ALLOWED(!f->cosim);
    *n = 0;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n) {
    fmu *f = c;
    ALLOWED(!f->cosim);
    *n = STATES(f);
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
    *event = *terminate = *early = fmi3False;
    found = fmu_step(f, t, h);
    *last = f->it->t;
    return outcome(f, found);
}
