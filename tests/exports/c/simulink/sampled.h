/* An engine for blocks of diagrams, called at multiples of their sample time:
 *
 *     [BLOCK_PARAMETERS='1 2'] block [SAMPLE_TIME [BEGIN]]     the rows of all input ports follow on the standard input
 *
 * prints the outputs of each call in a line. The simulation begins at BEGIN [s]. Ports whose values outputs do not answer to at
 * once are not numbers while the outputs are asked for. */

int main(int argc, char **argv) {
    const char *stated = getenv("BLOCK_PARAMETERS");
    double numbers[64], sample_time = argc > 1 ? atof(argv[1]) : 0.0, begin = argc > 2 ? atof(argv[2]) : 0.0;
    double memory[1024] = {0.0}, given[512], *at = memory;
    mxArray parameters = {NULL, numbers, 0}, period = {NULL, &sample_time, argc > 1 && sample_time != 0.0};
    SimStruct block;
    long k;
    int i, j, n;
    for (; stated != NULL && *stated != '\0' && parameters.count < 64; ++parameters.count) {
        char *rest;
        numbers[parameters.count] = strtod(stated, &rest);
        stated = rest;
    }
    memset(&block, 0, sizeof block);
    block.parameters[0] = &parameters, block.parameters[1] = &period;
    block.given_parameters = 2;
    mdlInitializeSizes(&block);
    if (block.error == NULL && block.held_parameters != 2) block.error = "parameters can be tuned, and are read at the start";
    if (block.error == NULL) {
        mdlInitializeSampleTimes(&block);
        for (i = 0; i < block.n_inputs; ++i) block.input[i] = at, at += block.input_width[i];
        for (i = 0; i < block.n_outputs; ++i) block.output[i] = at, at += block.output_width[i];
        mdlStart(&block);
    }
    block.t = begin;
    if (block.error == NULL) mdlInitializeConditions(&block);
    for (k = 0; block.error == NULL && !block.stopped; ++k) {
        for (i = 0, n = 0; i < block.n_inputs; ++i)
            for (j = 0; j < block.input_width[i]; ++j, ++n) {
                if (scanf("%lf", &given[n]) != 1) goto end;
                block.input[i][j] = block.at_once[i] ? given[n] : (double)NAN;
            }
        if (block.n_inputs == 0 && k == 100) break;
        block.t = begin + (double)k * block.sample_time;
        mdlOutputs(&block, 0);
        for (i = 0; i < block.n_outputs && block.error == NULL; ++i)
            for (j = 0; j < block.output_width[i]; ++j) printf("%a ", block.output[i][j]);
        printf("\n");
        for (i = 0, n = 0; i < block.n_inputs; ++i)
            for (j = 0; j < block.input_width[i]; ++j) block.input[i][j] = given[n++];
        mdlUpdate(&block, 0);
    }
end:
    if (block.pointers[0] != NULL) mdlTerminate(&block);
    if (block.error != NULL) printf("%s\n", block.error);
    return block.error != NULL;
}
