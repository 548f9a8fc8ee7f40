/* FMI 2.0 over symofros_fmu.h. Written by hand. */

static fmi2Status say(const fmu *f, fmi2Status status, const char *message) {
    fmi2CallbackLogger logger;
    memcpy(&logger, &f->logger, sizeof logger);
    if (logger != NULL)
        logger(f->environment, f->name, status, status == fmi2Discard ? "logStatusDiscard" : "logStatusError", "%s",
               message);
    return status;
}

static fmi2Status outcome(const fmu *f, int found) {
    switch (found) {
    case FMU_OK: return fmi2OK;
    case FMU_UNKNOWN: return say(f, fmi2Error, "no such variable, or not one for this call");
    case FMU_NO_MOTION: return say(f, fmi2Discard, "no finite acceleration, or constraints that can't be met");
    default: return say(f, fmi2Error, "not allowed in this mode, or not a legal value");
    }
}

#define ALLOWED(condition) \
    if (f == NULL) return fmi2Error; \
    if (!(condition)) return say(f, fmi2Error, "the call is not allowed in this mode")

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    fmu *f = c;
    (void)on, (void)n, (void)categories; /* errors are always told; there is nothing else to tell */
    ALLOWED(1);
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    fmu *f;
    (void)resources, (void)visible, (void)logging;
    if (functions == NULL || functions->allocateMemory == NULL || functions->freeMemory == NULL) return NULL;
    if (name == NULL || name[0] == '\0' || guid == NULL || strcmp(guid, SYM_FMU_TOKEN) != 0) {
        if (functions->logger != NULL)
            functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError", "%s",
                              "the GUID is another one, or the name is empty");
        return NULL;
    }
    f = fmu_new(type == fmi2CoSimulation, name, functions->allocateMemory, functions->freeMemory);
    if (f == NULL) return NULL;
    f->environment = functions->componentEnvironment;
    memcpy(&f->logger, &functions->logger, sizeof f->logger);
    fmu_reset(f);
    return f;
}

void fmi2FreeInstance(fmi2Component c) {
    fmu *f = c;
    if (f != NULL) f->release(f);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_INSTANTIATED);
    if (has_stop && !(stop >= start)) return say(f, fmi2Error, "the stop time is before the start time");
    if (has_tolerance && tolerance > 0.0 && f->it->run.adaptive) f->it->run.rtol = tolerance;
    f->it->t = start, f->stops = has_stop, f->stop = stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_INSTANTIATED);
    f->phase = FMU_INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_INITIALISING);
    return fmu_initialise(f) == FMU_OK ? fmi2OK : say(f, fmi2Error, "no state near the start meets the constraints");
}

fmi2Status fmi2Terminate(fmi2Component c) {
    fmu *f = c;
    ALLOWED(f->phase >= FMU_EVENT && f->phase <= FMU_STEPPING);
    f->phase = FMU_TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
    fmu *f = c;
    ALLOWED(1);
    fmu_reset(f);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    fmu *f = c;
    size_t i;
    ALLOWED(f->phase != FMU_INSTANTIATED);
    for (i = 0; i < n; ++i) {
        const int found = fmu_get(f, vr[i], &value[i]);
        if (found != FMU_OK) return outcome(f, found);
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    fmu *f = c;
    size_t i;
    ALLOWED(1);
    for (i = 0; i < n; ++i) {
        const int found = fmu_set(f, vr[i], value[i]);
        if (found != FMU_OK) return outcome(f, found);
    }
    return fmi2OK;
}

/* All variables are real. */
#define NONE(name, type) \
    fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[]) { \
        fmu *f = c; \
        (void)vr, (void)value; \
        ALLOWED(1); \
        return n == 0 ? fmi2OK : outcome(f, FMU_UNKNOWN); \
    }
NONE(fmi2GetInteger, fmi2Integer)
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetInteger, const fmi2Integer)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2SetString, const fmi2String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    fmu *f = c;
    ALLOWED(1);
    if (*state == NULL) *state = malloc(fmu_snapshot_size(f));
    if (*state == NULL) return say(f, fmi2Error, "no memory");
    fmu_save(f, *state);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    fmu *f = c;
    ALLOWED(state != NULL);
    return fmu_load(f, state) ? fmi2OK : say(f, fmi2Error, "the state is of another model or kind");
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    fmu *f = c;
    ALLOWED(1);
    if (state != NULL) free(*state), *state = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    fmu *f = c;
    ALLOWED(state != NULL);
    *size = fmu_snapshot_size(f);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    fmu *f = c;
    ALLOWED(state != NULL);
    if (size < fmu_snapshot_size(f)) return say(f, fmi2Error, "too few bytes");
    memcpy(bytes, state, fmu_snapshot_size(f));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    fmu *f = c;
    ALLOWED(1);
    if (size != fmu_snapshot_size(f)) return say(f, fmi2Error, "bytes of another model");
    if (*state == NULL) *state = malloc(size);
    if (*state == NULL) return say(f, fmi2Error, "no memory");
    memcpy(*state, bytes, size);
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real seed[],
                                        fmi2Real sensitivity[]) {
    fmu *f = c;
    ALLOWED(f->phase != FMU_INSTANTIATED && f->phase != FMU_TERMINATED);
    return outcome(f, fmu_differentiate(f, n_unknown, unknown, n_known, known, seed, sensitivity));
}

/* Model Exchange. */

fmi2Status fmi2EnterEventMode(fmi2Component c) {
    fmu *f = c;
    ALLOWED(!f->cosim && (f->phase == FMU_CONTINUOUS || f->phase == FMU_EVENT));
    f->phase = FMU_EVENT;
    return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    fmu *f = c;
    ALLOWED(!f->cosim && f->phase == FMU_EVENT);
    info->newDiscreteStatesNeeded = info->terminateSimulation = info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = info->nextEventTimeDefined = fmi2False;
    info->nextEventTime = 0.0;
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    fmu *f = c;
    ALLOWED(!f->cosim && f->phase == FMU_EVENT);
    f->phase = FMU_CONTINUOUS;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean final, fmi2Boolean *event, fmi2Boolean *terminate) {
    fmu *f = c;
    (void)final;
    ALLOWED(!f->cosim && f->phase == FMU_CONTINUOUS);
    *event = *terminate = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real t) {
    fmu *f = c;
    ALLOWED(!f->cosim && (f->phase == FMU_CONTINUOUS || f->phase == FMU_EVENT));
    f->it->t = t, f->fresh = 0;
    return fmi2OK;
}

#define STATES(f) ((size_t)(f)->it->model->nq + (size_t)(f)->it->model->nv)

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
    fmu *f = c;
    size_t nq;
    ALLOWED(!f->cosim && f->phase == FMU_CONTINUOUS && n == STATES(f));
    nq = (size_t)f->it->model->nq;
    memcpy(f->it->q, x, nq * sizeof *x), memcpy(f->it->v, x + nq, (n - nq) * sizeof *x);
    f->fresh = 0;
    return fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
    fmu *f = c;
    size_t nq;
    ALLOWED(!f->cosim && f->phase >= FMU_INITIALISING && n == STATES(f));
    nq = (size_t)f->it->model->nq;
    memcpy(x, f->it->q, nq * sizeof *x), memcpy(x + nq, f->it->v, (n - nq) * sizeof *x);
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t n) {
    fmu *f = c;
    int found;
    ALLOWED(!f->cosim && f->phase >= FMU_INITIALISING && n == STATES(f));
    found = fmu_refresh(f);
    if (found == FMU_OK) memcpy(derivatives, f->rates, n * sizeof *derivatives);
    return outcome(f, found);
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t n) {
    fmu *f = c;
    (void)indicators;
    ALLOWED(!f->cosim && n == 0);
    return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominals[], size_t n) {
    fmu *f = c;
    size_t i;
    ALLOWED(!f->cosim && n == STATES(f));
    for (i = 0; i < n; ++i) nominals[i] = 1.0;
    return fmi2OK;
}

/* Co-Simulation. */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    fmu *f = c;
    (void)vr, (void)order, (void)value;
    ALLOWED(f->cosim && n == 0); /* inputs are held */
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
    fmu *f = c;
    (void)vr, (void)order, (void)value;
    ALLOWED(f->cosim && n == 0);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean final) {
    fmu *f = c;
    (void)final;
    ALLOWED(f->cosim && f->phase == FMU_STEPPING);
    return outcome(f, fmu_step(f, t, h));
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    fmu *f = c;
    ALLOWED(0); /* no step is ever pending */
    return fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2DoStepStatus);
    *value = fmi2OK; /* no step is ever pending */
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2LastSuccessfulTime);
    *value = f->it->t;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    fmu *f = c;
    (void)kind, (void)value;
    ALLOWED(0);
    return fmi2Error;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2Terminated);
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2PendingStatus);
    *value = "";
    return fmi2OK;
}
