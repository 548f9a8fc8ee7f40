/* FMI 2.0 over symofros_fmi.h. Written by hand. */
#define FMI(name) fmi2##name
#define FMI_INSTANCE fmi2Component
#define FMI_REAL fmi2Real
#define FMI_STATE fmi2FMUstate
#define FMI_STATES(verb) fmi2##verb##FMUstate
#define FMI_STATES_SIZE fmi2SerializedFMUstateSize
#define FMI_DESERIALIZE fmi2DeSerializeFMUstate

static const char *category(fmi2Status status);

static fmi2Status say(const fmu *f, fmi2Status status, const char *message) {
    fmi2CallbackLogger logger;
    memcpy(&logger, &f->logger, sizeof logger);
    if (logger != NULL)
        logger(f->environment, f->name, status, category(status), "%s",
               message);
    return status;
}

#include "symofros_fmi_shared.h"

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    fmu *f = c;
    (void)on, (void)n, (void)categories; /* errors are always logged; nothing else is */
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
            functions->logger(functions->componentEnvironment, name == NULL ? "" : name, fmi2Error, "logStatusError",
                              "%s", "the GUID is another one, or the name is empty");
        return NULL;
    }
    f = fmu_new(type == fmi2CoSimulation, name, functions->allocateMemory, functions->freeMemory);
    if (f == NULL) {
        if (functions->logger != NULL)
            functions->logger(functions->componentEnvironment, name, fmi2Error, "logStatusError", "%s",
                              fmi_message(fmu_absent(type == fmi2CoSimulation)));
        return NULL;
    }
    f->environment = functions->componentEnvironment;
    memcpy(&f->logger, &functions->logger, sizeof f->logger);
    fmu_reset(f);
    return f;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean has_stop, fmi2Real stop) {
    ANSWER(fmi_prepare(f, has_tolerance, tolerance, start, has_stop, stop));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    fmu *f = c;
    ALLOWED(f->phase == FMU_INSTANTIATED);
    f->phase = FMU_INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    ANSWER(fmi_get(f, vr, n, value));
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    ANSWER(fmi_set(f, vr, n, value));
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

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real seed[],
                                        fmi2Real sensitivity[]) {
    ANSWER(fmi_differentiate(f, unknown, n_unknown, known, n_known, seed, sensitivity));
}

/* Model Exchange. */

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    fmu *f = c;
    ALLOWED(!f->cosim && f->phase == FMU_EVENT);
    NEEDED(info);
    info->newDiscreteStatesNeeded = info->terminateSimulation = info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = fmi2False;
    info->nextEventTime = 0.0;
    info->nextEventTimeDefined = fmu_next_event(f, &info->nextEventTime) ? fmi2True : fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t n) {
    ANSWER(fmi_get_rates(f, derivatives, n));
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
    fmi2Status status;
    int found;
    (void)final;
    ALLOWED(f->cosim && f->phase == FMU_STEPPING);
    found = fmi_step(f, t, h);
    if (found == FMU_OK && fmu_remark(f)) say(f, fmi2Warning, f->message);
    status = outcome(f, found);
    f->discarded = status == fmi2Discard;
    return status;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    fmu *f = c;
    ALLOWED(0); /* no step is ever pending */
    return fmi2Error;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2DoStepStatus);
    NEEDED(value);
    *value = fmi2OK; /* no step is ever pending */
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2LastSuccessfulTime);
    NEEDED(value);
    *value = *fmu_time(f);
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
    NEEDED(value);
    *value = f->discarded ? fmi2True : fmi2False; /* the motion ends there, so that no other step helps */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    fmu *f = c;
    ALLOWED(f->cosim && kind == fmi2PendingStatus);
    NEEDED(value);
    *value = "";
    return fmi2OK;
}
