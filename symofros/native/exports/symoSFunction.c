/* The block of the SYMOFROS paper's table 2: a level-2 S-function that evaluates one function of one model.
 * Written by hand. Parameters of the block:
 *
 *     ModelName      one of the models in symo_models.h, such as 'arm'
 *     ModelFunction  'direct_dynamics'   in u            out q, v, a, lam    integrates: continuous states q, v
 *                    'inverse_dynamics'  in q, v, a      out tau
 *                    'dynamics'          in q, v, u      out M (row by row), gnl = Q - h
 *                    'kinematics'        in q, v         out p, V of each frame: 3 and 6 numbers a frame
 *                    'energy'            in q, v         out T, V
 *     Parameters     the model's, or [] for the defaults
 *
 * Ports of no width (u of a model without inputs, lam of one without loops) are left out. Parameters hold for a simulation, at
 * whose start the states are brought onto the constraints; beams bent beyond their theory at the end of a step end it.
 */
#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 199309L
#endif
#define S_FUNCTION_NAME symoSFunction
#define S_FUNCTION_LEVEL 2
#include <stdlib.h>
#include <string.h>
#include "simstruc.h"
#include "symo_models.h"

enum { DIRECT, INVERSE, TERMS, KINEMATICS, ENERGY, N_KINDS };
static const char *const kinds[N_KINDS] = {"direct_dynamics", "inverse_dynamics", "dynamics", "kinematics", "energy"};

/* Of loops under an integrator that knows nothing of them [1/s]. */
#define GAIN 20.0

enum { NONE, OF_Q, OF_V, OF_A, OF_U };
static const int inputs_of[N_KINDS][3] = {
    {OF_U, NONE, NONE}, {OF_Q, OF_V, OF_A}, {OF_Q, OF_V, OF_U}, {OF_Q, OF_V, NONE}, {OF_Q, OF_V, NONE}};

static int32_t width(const sym_model *m, int what) {
    return what == OF_Q ? m->nq : what == OF_V || what == OF_A ? m->nv : what == OF_U ? m->nu : 0;
}

static const sym_plant *chosen(SimStruct *S, int *kind) {
    char name[256], function[64];
    size_t i;
    int k;
    if (mxGetString(ssGetSFcnParam(S, 0), name, sizeof name) != 0) return NULL;
    if (mxGetString(ssGetSFcnParam(S, 1), function, sizeof function) != 0) return NULL;
    for (k = 0; k < N_KINDS && strcmp(kinds[k], function) != 0; ++k) continue;
    *kind = k;
    for (i = 0; symo_models[i].name != NULL; ++i)
        if (strcmp(symo_models[i].name, name) == 0) return k < N_KINDS ? symo_models[i].plant() : NULL;
    return NULL;
}

static void mdlInitializeSizes(SimStruct *S) {
    const sym_plant *plant;
    const sym_model *m;
    int32_t widths[4] = {0, 0, 0, 0};
    int kind = 0, i, n = 0;
    ssSetNumSFcnParams(S, 3);
    if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) return; /* Simulink reports it */
    for (i = 0; i < 3; ++i) ssSetSFcnParamTunable(S, i, SS_PRM_NOT_TUNABLE);
    plant = chosen(S, &kind);
    if (plant == NULL) {
        ssSetErrorStatus(S, "symoSFunction: no such ModelName or ModelFunction; see symoSFunction.c and symo_models.h");
        return;
    }
    m = plant->model();
    if (mxGetNumberOfElements(ssGetSFcnParam(S, 2)) != 0 &&
        mxGetNumberOfElements(ssGetSFcnParam(S, 2)) != (size_t)m->npar) {
        ssSetErrorStatus(S, "symoSFunction: Parameters has one number a parameter of the model, or is []");
        return;
    }
    if (kind == KINEMATICS && plant->n_frames == 0) {
        ssSetErrorStatus(S, "symoSFunction: kinematics of a model that was exported with frames=[]; export it with some");
        return;
    }
    ssSetNumContStates(S, kind == DIRECT ? m->nq + m->nv : 0);
    ssSetNumDiscStates(S, 0);
    for (i = 0; i < 3; ++i) n += width(m, inputs_of[kind][i]) > 0;
    if (!ssSetNumInputPorts(S, n)) return;
    for (i = 0, n = 0; i < 3; ++i) {
        const int32_t w = width(m, inputs_of[kind][i]);
        if (w == 0) continue;
        ssSetInputPortWidth(S, n, w);
        ssSetInputPortRequiredContiguous(S, n, 1);
        ssSetInputPortDirectFeedThrough(S, n, 1); /* accelerations follow inputs at once */
        ++n;
    }
    switch (kind) {
    case DIRECT: widths[0] = m->nq, widths[1] = m->nv, widths[2] = m->nv, widths[3] = m->nc; break;
    case INVERSE: widths[0] = m->nv; break;
    case TERMS: widths[0] = m->nv * m->nv, widths[1] = m->nv; break;
    case KINEMATICS: widths[0] = 3 * plant->n_frames, widths[1] = 6 * plant->n_frames; break;
    default: widths[0] = widths[1] = 1;
    }
    for (i = 0, n = 0; i < 4; ++i) n += widths[i] > 0;
    if (!ssSetNumOutputPorts(S, n)) return;
    for (i = 0, n = 0; i < 4; ++i)
        if (widths[i] > 0) ssSetOutputPortWidth(S, n++, widths[i]);
    ssSetNumSampleTimes(S, 1);
    ssSetNumPWork(S, 1);
    ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);
}

static void mdlInitializeSampleTimes(SimStruct *S) {
    ssSetSampleTime(S, 0, CONTINUOUS_SAMPLE_TIME);
    ssSetOffsetTime(S, 0, 0.0);
}

#define MDL_START
static void mdlStart(SimStruct *S) {
    int kind = 0;
    const sym_plant *plant = chosen(S, &kind);
    const size_t size = sym_instance_size(plant);
    void *memory = malloc(size);
    sym_instance *instance = sym_instance_init(memory, size, plant);
    const mxArray *par = ssGetSFcnParam(S, 2);
    int32_t i;
    ssGetPWork(S)[0] = instance;
    if (instance == NULL) {
        free(memory);
        ssSetErrorStatus(S, "symoSFunction: no memory");
        return;
    }
    if (mxGetNumberOfElements(par) != 0) {
        memcpy(instance->par, mxGetPr(par), (size_t)instance->model->npar * sizeof(double));
        if (sym_instance_prepare(instance) != 0) {
            ssSetErrorStatus(S, plant->conditions[instance->refused]);
            return;
        }
    }
    for (i = 0; i < 2 * instance->model->nc; ++i) instance->gains[i] = GAIN;
}

#define MDL_INITIALIZE_CONDITIONS
static void mdlInitializeConditions(SimStruct *S) {
    int kind = 0;
    sym_instance *instance = ssGetPWork(S)[0];
    const sym_model *m = chosen(S, &kind)->model();
    real_T *x = ssGetContStates(S);
    if (kind != DIRECT || instance == NULL) return;
    memcpy(instance->q, instance->plant->q_start, (size_t)m->nq * sizeof *x);
    memcpy(instance->v, instance->plant->v_start, (size_t)m->nv * sizeof *x);
    if (instance->refused < 0 && sym_instance_project(instance) != 0)
        ssSetErrorStatus(S, "symoSFunction: these Parameters keep the start off the constraints; export with a start near them");
    memcpy(x, instance->q, (size_t)m->nq * sizeof *x);
    memcpy(x + m->nq, instance->v, (size_t)m->nv * sizeof *x);
}

/* The instance's point: from the states, and from the ports. */
static sym_instance *here(SimStruct *S, int *kind) {
    sym_instance *instance = ssGetPWork(S)[0];
    const sym_model *m = instance->model;
    int i, n = 0;
    (void)chosen(S, kind);
    instance->t = ssGetT(S);
    if (*kind == DIRECT) {
        const real_T *x = ssGetContStates(S);
        memcpy(instance->q, x, (size_t)m->nq * sizeof *x);
        memcpy(instance->v, x + m->nq, (size_t)m->nv * sizeof *x);
    }
    for (i = 0; i < 3; ++i) {
        const int what = inputs_of[*kind][i];
        const int32_t w = width(m, what);
        if (w == 0) continue;
        memcpy(what == OF_Q ? instance->q : what == OF_V ? instance->v : what == OF_A ? instance->a : instance->u,
               ssGetInputPortRealSignal(S, n++), (size_t)w * sizeof(double));
    }
    return instance;
}

static void call(SimStruct *S, sym_instance *instance, const char *name, const char *frame, double *const *out) {
    if (!sym_instance_call(instance, sym_find(instance->model, name, frame), out))
        ssSetErrorStatus(S, "symoSFunction: the model was exported without this function");
}

static void mdlOutputs(SimStruct *S, int_T tid) {
    int kind = 0;
    sym_instance *instance = here(S, &kind);
    const sym_model *m = instance->model;
    double *out[3], *y0 = ssGetOutputPortRealSignal(S, 0), rotation[9];
    int32_t i;
    (void)tid;
    if (kind == DIRECT) {
        if (sym_instance_accelerate(instance) != 0) ssSetErrorStatus(S, "symoSFunction: no finite acceleration");
        memcpy(y0, instance->q, (size_t)m->nq * sizeof *y0);
        memcpy(ssGetOutputPortRealSignal(S, 1), instance->v, (size_t)m->nv * sizeof *y0);
        memcpy(ssGetOutputPortRealSignal(S, 2), instance->a, (size_t)m->nv * sizeof *y0);
        if (m->nc > 0) memcpy(ssGetOutputPortRealSignal(S, 3), instance->lam, (size_t)m->nc * sizeof *y0);
    } else if (kind == INVERSE) {
        out[0] = y0;
        call(S, instance, "inverse_dynamics", NULL, out);
    } else if (kind == TERMS) {
        double *gnl = ssGetOutputPortRealSignal(S, 1);
        out[0] = y0, out[1] = instance->a, out[2] = gnl; /* h where accelerations are not needed */
        call(S, instance, "dynamics", NULL, out);
        for (i = 0; i < m->nv; ++i) gnl[i] -= instance->a[i];
    } else if (kind == KINEMATICS) {
        double *y1 = ssGetOutputPortRealSignal(S, 1);
        for (i = 0; i < instance->plant->n_frames; ++i) {
            const char *frame = instance->plant->frame_names[i];
            out[0] = y0 + (size_t)3 * (size_t)i, out[1] = rotation;
            call(S, instance, "frame_pose", frame, out);
            out[0] = y1 + (size_t)6 * (size_t)i;
            call(S, instance, "frame_velocity", frame, out);
        }
    } else {
        out[0] = y0;
        call(S, instance, "kinetic_energy", NULL, out);
        out[0] = ssGetOutputPortRealSignal(S, 1);
        call(S, instance, "potential_energy", NULL, out);
    }
}

#define MDL_UPDATE
static void mdlUpdate(SimStruct *S, int_T tid) {
    int kind = 0;
    sym_instance *instance = here(S, &kind);
    (void)tid;
    if (kind == DIRECT && sym_instance_judge_beams(instance) != 0)
        ssSetErrorStatus(S, "symoSFunction: a beam bends beyond its theory; divide it, or state theory: strain");
}

#define MDL_DERIVATIVES
static void mdlDerivatives(SimStruct *S) {
    int kind = 0;
    sym_instance *instance = here(S, &kind);
    if (kind == DIRECT && sym_instance_rates(instance, ssGetdX(S)) != 0)
        ssSetErrorStatus(S, "symoSFunction: no finite acceleration");
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
