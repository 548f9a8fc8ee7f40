/* An engine for blocks with continuous states: sizes, start, steps of classical Runge-Kutta.
 *
 *     [BLOCK_PARAMETERS='1 2'] block MODEL FUNCTION T_END STEP NUMBERS...    numbers: of all input ports, in order
 *
 * prints the outputs at the end, a port a line. */

static void outputs(SimStruct *S, const double *x, double t) {
    if (S->n_states > 0) memcpy(S->states, x, (size_t)S->n_states * sizeof *x);
    S->t = t;
    mdlOutputs(S, 0);
}

static void slopes(SimStruct *S, const double *x, double t, double *rates) {
    outputs(S, x, t);
    mdlDerivatives(S);
    memcpy(rates, S->rates, (size_t)S->n_states * sizeof *rates);
}

static void step(SimStruct *S, double *x, double t, double h, double *k) {
    static const double nodes[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    const int n = S->n_states;
    double *y = k + 4 * n;
    int i, stage;
    for (stage = 0; stage < 4; ++stage) {
        for (i = 0; i < n; ++i) y[i] = x[i] + (stage > 0 ? nodes[stage] * h * k[(stage - 1) * n + i] : 0.0);
        slopes(S, y, t + nodes[stage] * h, k + stage * n);
    }
    for (stage = 0; stage < 4; ++stage)
        for (i = 0; i < n; ++i) x[i] += h * weights[stage] * k[stage * n + i];
}

int main(int argc, char **argv) {
    const mxArray name = {argc > 1 ? argv[1] : NULL, NULL, 1}, function = {argc > 2 ? argv[2] : NULL, NULL, 1};
    const char *stated = getenv("BLOCK_PARAMETERS"); /* Parameters of the model, one after the other; none: [] */
    double numbers[64];
    mxArray parameters = {NULL, numbers, 0};
    SimStruct block;
    double *memory, *at, *x;
    int i, j, given = 5;
    long k, count;
    if (argc < 5) return 2;
    for (; stated != NULL && *stated != '\0' && parameters.count < 64; ++parameters.count) {
        char *rest;
        numbers[parameters.count] = strtod(stated, &rest);
        stated = rest;
    }
    memset(&block, 0, sizeof block);
    block.parameters[0] = &name, block.parameters[1] = &function, block.parameters[2] = &parameters;
    block.given_parameters = 3;
    mdlInitializeSizes(&block);
    if (block.error == NULL && block.held_parameters != 3) block.error = "parameters can be tuned, and are read at the start";
    if (block.error != NULL) {
        printf("%s\n", block.error);
        return 1;
    }
    mdlInitializeSampleTimes(&block);
    memory = calloc(100000, sizeof *memory);
    if (memory == NULL) return 2;
    at = memory;
    block.states = at, at += block.n_states;
    block.rates = at, at += block.n_states;
    for (i = 0; i < block.n_inputs; ++i) {
        block.input[i] = at, at += block.input_width[i];
        for (j = 0; j < block.input_width[i]; ++j) block.input[i][j] = given < argc ? atof(argv[given++]) : 0.0;
    }
    for (i = 0; i < block.n_outputs; ++i) block.output[i] = at, at += block.output_width[i];
    mdlStart(&block);
    mdlInitializeConditions(&block);
    x = at, at += block.n_states;
    memcpy(x, block.states, (size_t)block.n_states * sizeof *x);
    count = (long)(atof(argv[3]) / atof(argv[4]) + 0.5);
    for (k = 0; k < count && block.n_states > 0 && block.error == NULL; ++k) {
        step(&block, x, (double)k * atof(argv[4]), atof(argv[4]), at);
        outputs(&block, x, (double)(k + 1) * atof(argv[4]));
        mdlUpdate(&block, 0);
    }
    outputs(&block, x, atof(argv[3]));
    for (i = 0; i < block.n_outputs; ++i) {
        for (j = 0; j < block.output_width[i]; ++j) printf("%.17g ", block.output[i][j]);
        printf("\n");
    }
    mdlTerminate(&block);
    free(memory);
    if (block.error != NULL) printf("%s\n", block.error);
    return block.error != NULL;
}
