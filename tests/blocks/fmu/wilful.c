/* A unit of FMI 2 that does what its input says: 0 passes it on, 1 crashes, 2 hangs, 3 fails, 4 prints, 5 ends.

   It counts whole milliseconds of each communication step, and keeps the input that it was initialised with. */
#include <stdio.h>
#include <stdlib.h>

#include "fmi2FunctionTypes.h"

typedef struct {
    double u, first, milliseconds;
    const fmi2CallbackFunctions *callbacks;
} unit;

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String where,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    unit *made = calloc(1, sizeof *made);
    (void)name, (void)type, (void)guid, (void)where, (void)visible, (void)logging;
    made->callbacks = callbacks;
    return made;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real t, fmi2Boolean d, fmi2Real e)
{
    (void)c, (void)a, (void)b, (void)t, (void)d, (void)e;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    unit *one = c;
    one->first = one->u;
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real values[])
{
    (void)vr;
    for (size_t i = 0; i < n; i++) ((unit *)c)->u = values[i];
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real values[])
{
    const unit *one = c;
    const double outputs[] = {0.0, one->u, 0.5, one->first, one->milliseconds};
    for (size_t i = 0; i < n; i++) values[i] = outputs[vr[i]];
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean last)
{
    unit *one = c;
    (void)t, (void)last;
    one->milliseconds += (int)(h / 1e-3);
    if (one->u == 1.0) abort();
    for (volatile int i = 0; one->u == 2.0; i++) { }
    if (one->u == 3.0) {
        one->callbacks->logger(NULL, "unit", fmi2Error, "error", "the pump is dry");
        return fmi2Error;
    }
    if (one->u == 4.0) printf("{\"values\": [7]}\n"), fflush(stdout);
    if (one->u == 5.0) exit(3);
    return fmi2OK;
}

/* What FMPy looks up and nobody calls. */
#define NOT_THERE(name) fmi2Status name(void) { return fmi2Error; }
NOT_THERE(fmi2GetTypesPlatform)
NOT_THERE(fmi2GetVersion)
NOT_THERE(fmi2SetDebugLogging)
NOT_THERE(fmi2Terminate)
NOT_THERE(fmi2Reset)
NOT_THERE(fmi2GetInteger)
NOT_THERE(fmi2GetBoolean)
NOT_THERE(fmi2GetString)
NOT_THERE(fmi2SetInteger)
NOT_THERE(fmi2SetBoolean)
NOT_THERE(fmi2SetString)
NOT_THERE(fmi2GetFMUstate)
NOT_THERE(fmi2SetFMUstate)
NOT_THERE(fmi2FreeFMUstate)
NOT_THERE(fmi2SerializedFMUstateSize)
NOT_THERE(fmi2SerializeFMUstate)
NOT_THERE(fmi2DeSerializeFMUstate)
NOT_THERE(fmi2GetDirectionalDerivative)
NOT_THERE(fmi2SetRealInputDerivatives)
NOT_THERE(fmi2GetRealOutputDerivatives)
NOT_THERE(fmi2CancelStep)
NOT_THERE(fmi2GetStatus)
NOT_THERE(fmi2GetRealStatus)
NOT_THERE(fmi2GetIntegerStatus)
NOT_THERE(fmi2GetBooleanStatus)
NOT_THERE(fmi2GetStringStatus)
