/* A model as a function of Matlab or Octave. Written by hand. Included by the file that names the model: it defines
 * SYM_MEX_PLANT, SYM_MEX_NAME (a string), sym_mex_help, and the beams: SYM_MEX_BEAMS, sym_mex_beams[]. */
#include "symofros_mex_arrays.h"

static sym_instance *instance;

static void forget(void) {
    free(instance);
    instance = NULL;
}

/* Row by row in C, column by column in Matlab. */
static mxArray *matrix(int32_t rows, int32_t columns, const double *x) {
    mxArray *found = mxCreateDoubleMatrix((mwSize)rows, (mwSize)columns, mxREAL);
    double *into = mxGetPr(found);
    int32_t i, j;
    for (j = 0; j < columns; ++j)
        for (i = 0; i < rows; ++i) into[(size_t)j * (size_t)rows + (size_t)i] = x[(size_t)i * (size_t)columns + (size_t)j];
    return found;
}

/* X, then what follows from `from` on: U, Parameters and, but for a simulation, t. */
static void place(int count, const mxArray *const *given, int from, int with_time) {
    const sym_model *m = instance->model;
    const int32_t nx = m->nq + m->nv;
    double *x = mxMalloc((size_t)(nx + m->npar + 1) * sizeof *x), *par = x + nx;
    take(count, given, 1, "X = [q; v]", COLUMN, nx, x, NULL);
    memcpy(instance->q, x, (size_t)m->nq * sizeof *x);
    memcpy(instance->v, x + m->nq, (size_t)m->nv * sizeof *x);
    take(count, given, from, "U", COLUMN, m->nu, instance->u, instance->plant->u_start);
    take(count, given, from + 1, "Parameters", VECTOR, m->npar, par, m->par_default);
    if (instance->refused >= 0 || memcmp(par, instance->par, (size_t)m->npar * sizeof *par) != 0) {
        memcpy(instance->par, par, (size_t)m->npar * sizeof *par);
        if (sym_instance_prepare(instance) != 0)
            refuse("parameters", "Parameters", instance->plant->conditions[instance->refused]);
    }
    instance->t = 0.0;
    if (with_time) take(count, given, from + 2, "t", VECTOR, 1, &instance->t, &instance->t);
    mxFree(x);
}

static const sym_function *function(const char *name, const char *frame) {
    const sym_function *f = sym_find(instance->model, name, frame);
    if (f == NULL) refuse("absent", name, "the model was exported without this function");
    return f;
}

/* Calls a function at the present state; its outputs lie one after the other. */
static double *evaluate(const sym_function *f, double **out) {
    size_t total = 1;
    double *memory;
    int32_t k;
    for (k = 0; k < f->n_out; ++k) total += (size_t)f->out[k].rows * (size_t)f->out[k].cols;
    memory = mxMalloc(total * sizeof *memory);
    out[0] = memory;
    for (k = 1; k < f->n_out; ++k) out[k] = out[k - 1] + (size_t)f->out[k - 1].rows * (size_t)f->out[k - 1].cols;
    if (!sym_instance_call(instance, f, out)) refuse("absent", f->name, "it needs what an instance does not hold");
    return memory;
}

static mxArray *as_array(const sym_function *f, int32_t k, const double *x) {
    return matrix(f->out[k].rows, f->out[k].cols, x);
}

/* 0: [SysDim, SysSet, FlexLink, Parameter, Frame, Info] = model(0) */
static void describe(int nlhs, mxArray **plhs) {
    static const char *dims[] = {"nq", "nv", "nu", "npar", "nc", "nx", "nframes", "nz"};
    static const char *sets[] = {"X0", "U0", "q_names", "v_names", "u_names", "constraint_names", "method", "dt"};
    static const char *flexible[] = {"name", "first", "count"};
    static const char *parameter[] = {"names", "values"};
    static const char *frame[] = {"names"};
    static const char *info[] = {"name", "hash", "generator", "functions"};
    const sym_model *m = instance->model;
    const sym_plant *p = instance->plant;
    const int32_t numbers[8] = {m->nq, m->nv, m->nu, m->npar, m->nc, m->nq + m->nv, p->n_frames, sym_nz(m)};
    mxArray *made[6];
    double *x;
    int i;
    made[0] = mxCreateStructMatrix(1, 1, 8, dims);
    for (i = 0; i < 8; ++i) mxSetField(made[0], 0, dims[i], number((double)numbers[i]));
    made[1] = mxCreateStructMatrix(1, 1, 8, sets);
    mxSetField(made[1], 0, "X0", mxCreateDoubleMatrix((mwSize)(m->nq + m->nv), 1, mxREAL));
    x = mxGetPr(mxGetField(made[1], 0, "X0"));
    for (i = 0; i < m->nq; ++i) x[i] = p->q_start[i];
    for (i = 0; i < m->nv; ++i) x[m->nq + i] = p->v_start[i];
    mxSetField(made[1], 0, "U0", column(m->nu, p->u_start));
    mxSetField(made[1], 0, "q_names", texts(m->nq, m->q_names));
    mxSetField(made[1], 0, "v_names", texts(m->nv, m->v_names));
    mxSetField(made[1], 0, "u_names", texts(m->nu, m->u_names));
    mxSetField(made[1], 0, "constraint_names", texts(m->nc, p->constraint_names));
    mxSetField(made[1], 0, "method", mxCreateString(p->method_name));
    mxSetField(made[1], 0, "dt", number(p->h));
    made[2] = mxCreateStructMatrix(SYM_MEX_BEAMS, SYM_MEX_BEAMS > 0 ? 1 : 0, 3, flexible);
    for (i = 0; i < SYM_MEX_BEAMS; ++i) {
        mxSetField(made[2], (mwIndex)i, "name", mxCreateString(sym_mex_beams[i].name));
        mxSetField(made[2], (mwIndex)i, "first", number((double)sym_mex_beams[i].first + 1.0));
        mxSetField(made[2], (mwIndex)i, "count", number((double)sym_mex_beams[i].count));
    }
    made[3] = mxCreateStructMatrix(1, 1, 2, parameter);
    mxSetField(made[3], 0, "names", texts(m->npar, m->par_names));
    mxSetField(made[3], 0, "values", column(m->npar, m->par_default));
    made[4] = mxCreateStructMatrix(1, 1, 1, frame);
    mxSetField(made[4], 0, "names", texts(p->n_frames, p->frame_names));
    made[5] = mxCreateStructMatrix(1, 1, 4, info);
    mxSetField(made[5], 0, "name", mxCreateString(m->name));
    mxSetField(made[5], 0, "hash", mxCreateString(m->hash));
    mxSetField(made[5], 0, "generator", mxCreateString(m->generator));
    mxSetField(made[5], 0, "functions", number((double)m->n_functions));
    for (i = 0; i < 6 && (i < nlhs || i == 0); ++i) plhs[i] = made[i];
}

/* 1: M and Q - h, so that M v' = gnl for a tree. */
static void dynamics(int nlhs, mxArray **plhs) {
    const sym_function *f = function("dynamics", NULL);
    double *out[8];
    int32_t i;
    evaluate(f, out);
    for (i = 0; i < instance->model->nv; ++i) out[2][i] -= out[1][i];
    plhs[0] = as_array(f, 0, out[0]);
    if (nlhs > 1) plhs[1] = column(instance->model->nv, out[2]);
}

static void motion(int nlhs, mxArray **plhs) {
    sym_instance_accelerate(instance); /* NaN where there is none */
    plhs[0] = column(instance->model->nv, instance->a);
    if (nlhs > 1) plhs[1] = column(instance->model->nc, instance->lam);
}

static void inverse(int count, const mxArray *const *given, mxArray **plhs) {
    const sym_function *f = function("inverse_dynamics", NULL);
    double *out[8];
    take(count, given, 2, "A, the accelerations", COLUMN, instance->model->nv, instance->a, NULL);
    evaluate(f, out);
    plhs[0] = column(instance->model->nv, out[0]);
}

static const char *frame_of(const mxArray *array) {
    const sym_plant *p = instance->plant;
    char *name;
    int32_t i;
    if (array != NULL && mxIsChar(array)) {
        name = mxArrayToString(array);
        for (i = 0; i < p->n_frames; ++i)
            if (strcmp(p->frame_names[i], name) == 0) return p->frame_names[i];
        refuse("frame", "no such frame", "its name is one of Frame.names of the call with flag 0");
    }
    if (array != NULL && mxIsDouble(array) && mxGetNumberOfElements(array) == 1) {
        const double which = mxGetScalar(array);
        if (which >= 1.0 && which <= (double)p->n_frames && which == floor(which)) return p->frame_names[(int32_t)which - 1];
    }
    refuse("frame", "no such frame", "it is a name, or an index into Frame.names of the call with flag 0");
    return NULL;
}

/* 4: [p, R, V, J, dJ] */
static void kinematics(int nlhs, mxArray **plhs, const char *frame) {
    static const char *const names[3] = {"frame_velocity", "frame_jacobian", "frame_jacobian_rate"};
    const sym_function *f = function("frame_pose", frame);
    double *out[8];
    int i;
    evaluate(f, out);
    plhs[0] = as_array(f, 0, out[0]);
    if (nlhs > 1) plhs[1] = as_array(f, 1, out[1]);
    for (i = 0; i < 3 && i + 2 < nlhs; ++i) {
        f = function(names[i], frame);
        evaluate(f, out);
        plhs[i + 2] = as_array(f, 0, out[0]);
    }
}

/* 5, 6: [residual, G, gamma] of the conditions on coordinates, or of those on speeds alone. */
static void constraints(int nlhs, mxArray **plhs, int on_speeds) {
    static const char *const names[3] = {"constraint", "constraint_jacobian", "constraint_bias"};
    const sym_model *m = instance->model;
    int32_t i, j, k, rows = 0;
    for (i = 0; i < m->nc; ++i) rows += instance->plant->on_speeds[i] == on_speeds;
    for (k = 0; k < 3 && (k < nlhs || k == 0); ++k) {
        const int32_t columns = k == 1 ? m->nv : 1;
        mxArray *found = mxCreateDoubleMatrix((mwSize)rows, (mwSize)columns, mxREAL);
        double *into = mxGetPr(found), *out[8];
        if (rows > 0) {
            int32_t row = 0;
            evaluate(function(k == 0 && on_speeds ? "constraint_rate" : names[k], NULL), out);
            for (i = 0; i < m->nc; ++i) {
                if (instance->plant->on_speeds[i] != on_speeds) continue;
                for (j = 0; j < columns; ++j) into[(size_t)j * (size_t)rows + (size_t)row] = out[0][(size_t)i * (size_t)columns + (size_t)j];
                ++row;
            }
        }
        plhs[k] = found;
    }
}

static void energy(int nlhs, mxArray **plhs) {
    double *out[8];
    evaluate(function("kinetic_energy", NULL), out);
    plhs[0] = number(out[0][0]);
    if (nlhs < 2) return;
    evaluate(function("potential_energy", NULL), out);
    plhs[1] = number(out[0][0]);
}

/* 8: [A, B] of x' = A x + B u, x = (change of q along the manifold, change of v). */
static void linearisation(int nlhs, mxArray **plhs) {
    const sym_model *m = instance->model;
    const size_t nv = (size_t)m->nv, nu = (size_t)m->nu;
    double *out[8], *A, *B, *change = mxCalloc(2 * nv + 1, sizeof *change), *x = change + nv;
    size_t i, j;
    evaluate(function("forward_dynamics_derivatives", NULL), out);
    plhs[0] = mxCreateDoubleMatrix(2 * nv, 2 * nv, mxREAL);
    A = mxGetPr(plhs[0]);
    for (j = 0; j < nv; ++j) {
        memset(change, 0, 2 * nv * sizeof *change);
        x[j] = 1.0;
        sym_chart_rate_jacobian(&instance->system, instance->v, x, 1.0, change);
        for (i = 0; i < nv; ++i) {
            A[j * 2 * nv + i] = change[i];
            A[(nv + j) * 2 * nv + i] = i == j ? 1.0 : 0.0;
            A[j * 2 * nv + nv + i] = out[0][i * nv + j];
            A[(nv + j) * 2 * nv + nv + i] = out[1][i * nv + j];
        }
    }
    if (nlhs < 2) return;
    plhs[1] = mxCreateDoubleMatrix(2 * nv, nu, mxREAL);
    B = mxGetPr(plhs[1]);
    for (j = 0; j < nu; ++j)
        for (i = 0; i < nv; ++i) B[j * 2 * nv + nv + i] = out[2][i * nu + j];
}

/* 9: [T, X] = model(9, X, U, Parameters, [t0 t_end dt]): steps with inputs held. */
static void simulate(int nlhs, mxArray **plhs, int count, const mxArray *const *given) {
    const sym_model *m = instance->model;
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv;
    double span[3], *t, *x;
    size_t n, i, k;
    take(count, given, 4, "[t0 t_end dt]", VECTOR, 3, span, NULL);
    if (!(span[2] > 0.0) || !(span[1] >= span[0]) || !((span[1] - span[0]) / span[2] < 1e8))
        refuse("span", "[t0 t_end dt] is no span of time", "t_end >= t0 and dt > 0");
    n = (size_t)ceil((span[1] - span[0]) / span[2] * (1.0 - 1e-9)) + 1;
    plhs[0] = mxCreateDoubleMatrix(n, 1, mxREAL);
    t = mxGetPr(plhs[0]);
    x = mxMalloc(n * (nq + nv + 1) * sizeof *x);
    instance->t = span[0], instance->run.h = 0.0;
    sym_instance_forget_events(instance); /* each call is a motion of its own */
    for (k = 0; k < n; ++k) {
        if (k > 0) {
            const double next = span[0] + (double)k * span[2];
            const int32_t status = sym_instance_advance(instance, next < span[1] ? next : span[1], span[2]);
            if (status == SYM_NO_ROTATION)
                refuse("rotation", "X or U holds a quaternion that is no rotation", "its length is 1, to 1e-3");
            if (status != SYM_FINISHED)
                refuse("motion", "the motion ends early", "accelerations exist and are finite, and loops can be closed");
        }
        t[k] = instance->t;
        for (i = 0; i < nq; ++i) x[i * n + k] = instance->q[i];
        for (i = 0; i < nv; ++i) x[(nq + i) * n + k] = instance->v[i];
    }
    if (sym_instance_struck_in_sequence(instance) != -HUGE_VAL)
        mexWarnMsgIdAndTxt("symofros:sequence", "several balls struck one after the other, as no motion was found in which they do at once");
    if (nlhs < 2) return;
    plhs[1] = mxCreateDoubleMatrix(n, nq + nv, mxREAL);
    memcpy(mxGetPr(plhs[1]), x, n * (nq + nv) * sizeof *x);
}

SYM_MEX_EXPORT void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[]) {
    static const int most[10] = {6, 2, 2, 1, 5, 3, 3, 2, 2, 2}, taken[10] = {1, 5, 5, 6, 6, 5, 5, 5, 5, 5};
    const mxArray *const *given = (const mxArray *const *)prhs;
    double flag;
    if (nrhs == 0) {
        mexPrintf("%s", sym_mex_help);
        return;
    }
    if (instance == NULL) {
        const size_t size = sym_instance_size(SYM_MEX_PLANT());
        void *memory = malloc(size);
        instance = sym_instance_init(memory, size, SYM_MEX_PLANT());
        if (instance == NULL) {
            free(memory);
            refuse("memory", "no memory", "a model needs some");
        }
        mexAtExit(forget);
    }
    if (!mxIsDouble(prhs[0]) || mxGetNumberOfElements(prhs[0]) != 1) refuse("flag", "the flag is no number", "it is one of 0 to 9");
    flag = mxGetScalar(prhs[0]);
    if (!(flag >= 0.0 && flag <= 9.0) || flag != floor(flag)) refuse("flag", "no such flag", "it is one of 0 to 9");
    if (nlhs > most[(int)flag]) refuse("outputs", "too many outputs", "see the help for what each flag returns");
    if (nrhs > taken[(int)flag]) refuse("inputs", "too many inputs", "see the help for what each flag takes");
    if (flag == 0.0) {
        describe(nlhs, plhs);
        return;
    }
    place(nrhs, given, flag == 3.0 || flag == 4.0 ? 3 : 2, flag != 9.0);
    switch ((int)flag) {
    case 1: dynamics(nlhs, plhs); break;
    case 2: motion(nlhs, plhs); break;
    case 3: inverse(nrhs, given, plhs); break;
    case 4: kinematics(nlhs, plhs, frame_of(nrhs > 2 ? given[2] : NULL)); break;
    case 5: constraints(nlhs, plhs, 0); break;
    case 6: constraints(nlhs, plhs, 1); break;
    case 7: energy(nlhs, plhs); break;
    case 8: linearisation(nlhs, plhs); break;
    default: simulate(nlhs, plhs, nrhs, given);
    }
}
