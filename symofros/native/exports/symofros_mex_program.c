/* A diagram as a function of Matlab or Octave. Written by hand. Included by the file that names the diagram: it defines
 * SYM_MEX_PROGRAM, SYM_MEX_NAME (a string), SYM_MEX_PERIOD [s] and sym_mex_help. One program stays between calls. */
#include "symofros_mex_arrays.h"

static sym_program_instance *instance;
static int begun;

static void forget(void) {
    free(instance);
    instance = NULL;
}

static const sym_model *constants(void) { return instance->program->instants(); }

/* Ends the call where a status is below zero. */
static void judge(int32_t status) {
    const char *condition;
    char what[80];
    if (status >= 0) return;
    begun = 0;
    condition = sym_program_refused(instance);
    if (condition != NULL) refuse("parameters", "Parameters", condition);
    sprintf(what, "the motion ends at t = %.9g s", *instance->diagram.t);
    if (status == SYM_BEYOND_THEORY) refuse("motion", what, "a beam bends beyond its theory; divide it, or use theory 'strain'");
    sprintf(what + strlen(what), ", status %d", (int)status);
    refuse("motion", what, "symofros_stepper.h says what a status means; sf.Simulation of the diagram says it in words");
}

static mxArray *listed(int32_t n, const char *const *names, const char *const *units, const double *first) {
    static const char *fields[] = {"names", "units", "values"};
    mxArray *made = mxCreateStructMatrix(1, 1, 3, fields);
    mxSetField(made, 0, "names", texts(n, names));
    mxSetField(made, 0, "units", units == NULL ? mxCreateCellMatrix(0, 1) : texts(n, units));
    mxSetField(made, 0, "values", first == NULL ? mxCreateDoubleMatrix(0, 1, mxREAL) : column(n, first));
    return made;
}

static void describe(int nlhs, mxArray **plhs) {
    static const char *info[] = {"name", "period"};
    const sym_program *p = instance->program;
    mxArray *made[4];
    int i;
    made[0] = listed(p->n_inputs, p->input_names, p->input_units, p->u_start);
    made[1] = listed(p->n_outputs, p->output_names, p->output_units, NULL);
    made[2] = listed(constants()->npar, constants()->par_names, NULL, constants()->par_default);
    made[3] = mxCreateStructMatrix(1, 1, 2, info);
    mxSetField(made[3], 0, "name", mxCreateString(p->name));
    mxSetField(made[3], 0, "period", number(SYM_MEX_PERIOD));
    for (i = 0; i < 4 && (i < nlhs || i == 0); ++i) plhs[i] = made[i];
}

/* Begin at t = 0 with parameters and inputs; what is sampled there waits. */
static void begin(int count, const mxArray *const *given, int which, const double *inputs) {
    const sym_program *p = instance->program;
    begun = 0;
    take(count, given, which, "Parameters", VECTOR, constants()->npar, instance->par, constants()->par_default);
    memcpy(instance->inputs, inputs, (size_t)p->n_inputs * sizeof *inputs);
    judge(sym_program_start(instance));
    begun = 1;
}

/* Move to time t under the present inputs, then set others, which what is sampled at t reads. Returns whether the motion
 * goes on. */
static int move(double t, const double *inputs) {
    int32_t status = sym_program_approach(instance, t);
    judge(status);
    if (status == SYM_FINISHED) {
        memcpy(instance->inputs, inputs, (size_t)instance->program->n_inputs * sizeof *inputs);
        judge(status = sym_program_advance(instance, t));
    }
    if (status != SYM_FINISHED) judge(sym_program_evaluate(instance)); /* where an event ends it */
    return status == SYM_FINISHED;
}

/* NAME(3, T, U, Parameters): U is a column that holds, or has a row for each time. */
static void simulate(int nlhs, mxArray **plhs, int count, const mxArray *const *given) {
    const size_t n_in = (size_t)instance->program->n_inputs, n_out = (size_t)instance->program->n_outputs;
    const size_t n = count > 1 ? mxGetNumberOfElements(given[1]) : 0;
    const mxArray *rows = count > 2 && mxGetM(given[2]) == n && mxGetN(given[2]) == n_in ? given[2] : NULL;
    double *t, *u, *y, *into;
    size_t done = 0, i, k;
    if (n == 0 || n > 100000000) refuse("times", "T, the times, are none or too many", "they ascend from 0 or later");
    t = mxMalloc((n + n * n_in + n_in + n * n_out + 1) * sizeof *t), u = t + n, y = u + (n + 1) * n_in;
    take(count, given, 1, "T, the times", VECTOR, (int32_t)n, t, NULL);
    for (k = 0; k < n; ++k)
        if (!(t[k] >= 0.0) || (k > 0 && !(t[k] > t[k - 1]))) refuse("times", "T, the times", "they ascend from 0 or later");
    if (rows != NULL && n_in > 0) {
        const double *x = mxGetPr(rows);
        for (i = 0; i < n_in; ++i)
            for (k = 0; k < n; ++k) {
                if (!(x[i * n + k] - x[i * n + k] == 0.0)) refuse("value", "U", "its entries are finite");
                u[k * n_in + i] = x[i * n + k];
            }
    } else {
        take(count, given, 2, "U, which has no row for each time,", COLUMN, (int32_t)n_in, u, instance->program->u_start);
        for (k = 1; k < n; ++k) memcpy(u + k * n_in, u, n_in * sizeof *u);
    }
    begin(count, given, 3, u);
    for (k = 0; k < n; ++k) {
        const int goes_on = move(t[k], u + k * n_in);
        t[k] = *instance->diagram.t;
        memcpy(y + k * n_out, instance->signals, n_out * sizeof *y);
        ++done;
        if (!goes_on) break;
    }
    plhs[0] = mxCreateDoubleMatrix(done, 1, mxREAL);
    memcpy(mxGetPr(plhs[0]), t, done * sizeof *t);
    if (nlhs > 1) {
        plhs[1] = mxCreateDoubleMatrix(done, n_out, mxREAL);
        into = mxGetPr(plhs[1]);
        for (i = 0; i < n_out; ++i)
            for (k = 0; k < done; ++k) into[i * done + k] = y[k * n_out + i];
    }
    mxFree(t);
}

SYM_MEX_EXPORT void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[]) {
    static const int most[4] = {4, 1, 2, 2}, taken[4] = {1, 3, 3, 4};
    const mxArray *const *given = (const mxArray *const *)prhs;
    const sym_program *p = SYM_MEX_PROGRAM();
    double flag, t, *u;
    if (nrhs == 0) {
        mexPrintf("%s", sym_mex_help);
        return;
    }
    if (instance == NULL) {
        const size_t size = sym_program_size(p);
        void *memory = malloc(size);
        instance = sym_program_init(memory, size, p);
        if (instance == NULL) {
            free(memory);
            refuse("memory", "no memory, or no first state on the constraints", "a program needs both");
        }
        mexAtExit(forget);
    }
    if (!mxIsDouble(prhs[0]) || mxGetNumberOfElements(prhs[0]) != 1) refuse("flag", "the flag is no number", "it is one of 0 to 3");
    flag = mxGetScalar(prhs[0]);
    if (!(flag >= 0.0 && flag <= 3.0) || flag != floor(flag)) refuse("flag", "no such flag", "it is one of 0 to 3");
    if (nlhs > most[(int)flag]) refuse("outputs", "too many outputs", "see the help for what each flag returns");
    if (nrhs > taken[(int)flag]) refuse("inputs", "too many inputs", "Parameters count from flag 1 or 3 on, for a whole motion");
    if (flag == 0.0) {
        describe(nlhs, plhs);
        return;
    }
    if (flag == 3.0) {
        simulate(nlhs, plhs, nrhs, given);
        return;
    }
    u = mxMalloc((size_t)(p->n_inputs + 1) * sizeof *u);
    if (flag == 1.0) {
        take(nrhs, given, 1, "U", COLUMN, p->n_inputs, u, p->u_start);
        begin(nrhs, given, 2, u);
        move(0.0, u);
    } else {
        if (!begun) refuse("order", "nothing has begun", "flag 1 begins a motion");
        take(nrhs, given, 1, "t", VECTOR, 1, &t, NULL);
        if (!(t >= *instance->diagram.t)) refuse("time", "t lies before the present time", "time ascends, and flag 1 begins anew");
        take(nrhs, given, 2, "U", COLUMN, p->n_inputs, u, instance->inputs);
        move(t, u);
    }
    mxFree(u);
    plhs[0] = column(p->n_outputs, instance->signals);
    if (nlhs > 1) plhs[1] = number(*instance->diagram.t);
}
