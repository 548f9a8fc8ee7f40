/* A stand-in for Simulink's header, of our own: only what the public documentation of level-2 S-functions names and
 * our blocks use, so that they can be compiled and run without Simulink. */
#ifndef STAND_IN_SIMSTRUC_H
#define STAND_IN_SIMSTRUC_H

#include <stddef.h>
#include <string.h>

typedef double real_T;
typedef int int_T;

typedef struct mxArray {
    const char *text;
    const double *numbers;
    size_t count;
} mxArray;

enum { MOST_PORTS = 4, MOST_PARAMETERS = 3 };

typedef struct SimStruct {
    int wanted_parameters, given_parameters, held_parameters, n_states, n_inputs, n_outputs, n_pointers;
    const mxArray *parameters[MOST_PARAMETERS];
    int input_width[MOST_PORTS], output_width[MOST_PORTS], at_once[MOST_PORTS], stopped;
    double *states, *rates, *input[MOST_PORTS], *output[MOST_PORTS], t, sample_time;
    void *pointers[2];
    real_T numbers[2];
    const char *error;
} SimStruct;

#define CONTINUOUS_SAMPLE_TIME 0.0
#define SS_OPTION_EXCEPTION_FREE_CODE 1
#define ssSetNumSFcnParams(S, n) ((S)->wanted_parameters = (n))
#define ssGetNumSFcnParams(S) ((S)->wanted_parameters)
#define ssGetSFcnParamsCount(S) ((S)->given_parameters)
#define ssGetSFcnParam(S, i) ((S)->parameters[i])
#define SS_PRM_NOT_TUNABLE 0
#define ssSetSFcnParamTunable(S, i, yes) ((S)->held_parameters += (yes) == SS_PRM_NOT_TUNABLE)
#define ssSetErrorStatus(S, words) ((S)->error = (words))
#define ssSetNumContStates(S, n) ((S)->n_states = (n))
#define ssSetNumDiscStates(S, n) ((void)(S), (void)(n))
#define ssSetNumInputPorts(S, n) ((S)->n_inputs = (n), 1)
#define ssSetInputPortWidth(S, i, n) ((S)->input_width[i] = (n))
#define ssSetInputPortRequiredContiguous(S, i, yes) ((void)(S), (void)(i))
#define ssSetInputPortDirectFeedThrough(S, i, yes) ((S)->at_once[i] = (yes))
#define ssSetNumOutputPorts(S, n) ((S)->n_outputs = (n), 1)
#define ssSetOutputPortWidth(S, i, n) ((S)->output_width[i] = (n))
#define ssSetNumSampleTimes(S, n) ((void)(S), (void)(n))
#define ssSetNumPWork(S, n) ((S)->n_pointers = (n))
#define ssSetNumRWork(S, n) ((void)(S), (void)(n))
#define ssGetRWork(S) ((S)->numbers)
#define ssSetStopRequested(S, yes) ((S)->stopped = (yes))
#define ssSetOptions(S, options) ((void)(S), (void)(options))
#define ssSetSampleTime(S, i, seconds) ((S)->sample_time = (seconds))
#define ssSetOffsetTime(S, i, seconds) ((void)(S), (void)(seconds))
#define ssGetPWork(S) ((S)->pointers)
#define ssGetContStates(S) ((S)->states)
#define ssGetdX(S) ((S)->rates)
#define ssGetT(S) ((S)->t)
#define ssGetInputPortRealSignal(S, i) ((const real_T *)(S)->input[i])
#define ssGetOutputPortRealSignal(S, i) ((S)->output[i])

static inline int mxGetString(const mxArray *array, char *into, size_t size) {
    if (array == NULL || array->text == NULL || strlen(array->text) >= size) return 1;
    strcpy(into, array->text);
    return 0;
}
static inline size_t mxGetNumberOfElements(const mxArray *array) { return array->count; }
static inline const double *mxGetPr(const mxArray *array) { return array->numbers; }

#endif
