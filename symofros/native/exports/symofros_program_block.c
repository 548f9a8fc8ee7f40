/* A diagram as a block of Simulink: a level-2 S-function with a port for each inlet and each outlet. Written by hand. Included
 * by the file that names the diagram: it defines S_FUNCTION_NAME, SYM_BLOCK_PROGRAM, SYM_BLOCK_PERIOD [s], and the ports:
 * SYM_BLOCK_INPUTS, SYM_BLOCK_OUTPUTS, block_inputs[], block_outputs[]. Parameters of the block:
 *
 *     Parameters   one number for each run-time parameter of the diagram, or [] for the defaults
 *     SampleTime   seconds between two calls, or [] for the diagram's base period, or else the step of its mechanisms
 *
 * Mechanisms move from one call to the next under the inputs of the one before; what is sampled at the instant of a call reads
 * the inputs of that call. The diagram's time begins at 0 when the block's conditions are initialised. A block that was
 * disabled with its states held catches up when it is enabled again. Parameters hold for a simulation. An event that ends the
 * motion stops the simulation.
 */

enum { BLOCK_PARAMETERS, BLOCK_SAMPLE_TIME, N_BLOCK_PARAMETERS };

static double block_period(SimStruct *S) {
    const mxArray *given = ssGetSFcnParam(S, BLOCK_SAMPLE_TIME);
    return mxGetNumberOfElements(given) == 0 ? SYM_BLOCK_PERIOD : mxGetPr(given)[0];
}

/* Report a status below zero. */
static int block_failed(SimStruct *S, int32_t status) {
    const char *condition;
    if (status >= 0) return 0;
    condition = sym_program_refused(ssGetPWork(S)[0]);
    if (condition != NULL) ssSetErrorStatus(S, condition);
    else if (status == SYM_BEYOND_THEORY) ssSetErrorStatus(S, "a beam bends beyond its theory; divide it, or use theory 'strain'");
    else ssSetErrorStatus(S, "the diagram's motion has no solution from here on; sf.Simulation of it says why");
    return 1;
}

static void mdlInitializeSizes(SimStruct *S) {
    const mxArray *period;
    int i;
    ssSetNumSFcnParams(S, N_BLOCK_PARAMETERS);
    if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) return; /* Simulink reports it */
    for (i = 0; i < N_BLOCK_PARAMETERS; ++i) ssSetSFcnParamTunable(S, i, SS_PRM_NOT_TUNABLE);
    if (mxGetNumberOfElements(ssGetSFcnParam(S, BLOCK_PARAMETERS)) != 0 &&
        mxGetNumberOfElements(ssGetSFcnParam(S, BLOCK_PARAMETERS)) != (size_t)SYM_BLOCK_PROGRAM()->instants()->npar) {
        ssSetErrorStatus(S, "Parameters has one number a parameter of the diagram, in the order of its README, or is []");
        return;
    }
    period = ssGetSFcnParam(S, BLOCK_SAMPLE_TIME);
    if (mxGetNumberOfElements(period) > 1 || !(block_period(S) > 0.0 && block_period(S) < 1e300)) {
        ssSetErrorStatus(S, "SampleTime is a time above zero [s], or []");
        return;
    }
    ssSetNumContStates(S, 0);
    ssSetNumDiscStates(S, 0);
    if (!ssSetNumInputPorts(S, SYM_BLOCK_INPUTS)) return;
    for (i = 0; i < SYM_BLOCK_INPUTS; ++i) {
        ssSetInputPortWidth(S, i, block_inputs[i].width);
        ssSetInputPortRequiredContiguous(S, i, 1);
        ssSetInputPortDirectFeedThrough(S, i, block_inputs[i].at_once);
    }
    if (!ssSetNumOutputPorts(S, SYM_BLOCK_OUTPUTS)) return;
    for (i = 0; i < SYM_BLOCK_OUTPUTS; ++i) ssSetOutputPortWidth(S, i, block_outputs[i].width);
    ssSetNumSampleTimes(S, 1);
    ssSetNumPWork(S, 1);
    ssSetNumRWork(S, 1);
    ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);
}

static void mdlInitializeSampleTimes(SimStruct *S) {
    ssSetSampleTime(S, 0, block_period(S));
    ssSetOffsetTime(S, 0, 0.0);
}

#define MDL_START
static void mdlStart(SimStruct *S) {
    const size_t size = sym_program_size(SYM_BLOCK_PROGRAM());
    void *memory = malloc(size);
    sym_program_instance *instance = sym_program_init(memory, size, SYM_BLOCK_PROGRAM());
    const mxArray *par = ssGetSFcnParam(S, BLOCK_PARAMETERS);
    ssGetPWork(S)[0] = instance;
    if (instance == NULL) {
        free(memory);
        ssSetErrorStatus(S, "no memory, or no first state of the diagram on its constraints");
        return;
    }
    if (mxGetNumberOfElements(par) != 0) memcpy(instance->par, mxGetPr(par), mxGetNumberOfElements(par) * sizeof(double));
}

#define MDL_INITIALIZE_CONDITIONS
static void mdlInitializeConditions(SimStruct *S) {
    sym_program_instance *instance = ssGetPWork(S)[0];
    if (instance == NULL) return;
    ssGetRWork(S)[0] = ssGetT(S);
    memcpy(instance->inputs, instance->program->u_start, (size_t)instance->program->n_inputs * sizeof(double));
    block_failed(S, sym_program_start(instance));
}

/* inputs <- the ports, those that outputs answer to at once or all. */
static void block_read(SimStruct *S, int all) {
    sym_program_instance *instance = ssGetPWork(S)[0];
    double *into = instance->inputs;
    int i;
    for (i = 0; i < SYM_BLOCK_INPUTS; ++i) {
        const size_t n = (size_t)block_inputs[i].width;
        if (all || block_inputs[i].at_once) memcpy(into, ssGetInputPortRealSignal(S, i), n * sizeof *into);
        into += n;
    }
}

static void mdlOutputs(SimStruct *S, int_T tid) {
    sym_program_instance *instance = ssGetPWork(S)[0];
    const double t = ssGetT(S) - ssGetRWork(S)[0], *from = instance->signals;
    int32_t status;
    int i;
    (void)tid;
    status = sym_program_approach(instance, t);
    if (block_failed(S, status)) return;
    if (status == SYM_FINISHED) {
        block_read(S, 0);
        status = sym_program_advance(instance, t);
        if (block_failed(S, status)) return;
    }
    if (status != SYM_FINISHED) {
        ssSetStopRequested(S, 1);
        if (block_failed(S, sym_program_evaluate(instance))) return;
    }
    for (i = 0; i < SYM_BLOCK_OUTPUTS; ++i) {
        const size_t n = (size_t)block_outputs[i].width;
        memcpy(ssGetOutputPortRealSignal(S, i), from, n * sizeof *from);
        from += n;
    }
}

#define MDL_UPDATE
static void mdlUpdate(SimStruct *S, int_T tid) {
    (void)tid;
    block_read(S, 1);
}

static void mdlTerminate(SimStruct *S) {
    free(ssGetPWork(S)[0]);
    ssGetPWork(S)[0] = NULL;
}

#ifdef MATLAB_MEX_FILE
#include "simulink.c"
#else
#include "cg_sfun.h"
#endif
