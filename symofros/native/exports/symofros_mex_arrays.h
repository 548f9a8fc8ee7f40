/* symofros_mex_arrays.h - arguments and results of functions of Matlab or Octave, of models and of diagrams. Written by hand.
 * Included by the file that defines SYM_MEX_NAME (a string). */

static void refuse(const char *id, const char *what, const char *rule) {
    char name[128];
    sprintf(name, "symofros:%.60s:%.40s", SYM_MEX_NAME, id);
    mexErrMsgIdAndTxt(name, "%s; %s. Call %s() for help.", what, rule, SYM_MEX_NAME);
}

static mxArray *column(int32_t n, const double *x) {
    mxArray *found = mxCreateDoubleMatrix((mwSize)n, 1, mxREAL);
    if (n > 0) memcpy(mxGetPr(found), x, (size_t)n * sizeof *x);
    return found;
}

static mxArray *number(double x) { return mxCreateDoubleScalar(x); }

static mxArray *texts(int32_t n, const char *const *names) {
    mxArray *found = mxCreateCellMatrix((mwSize)n, 1);
    int32_t i;
    for (i = 0; i < n; ++i) mxSetCell(found, (mwIndex)i, mxCreateString(names[i]));
    return found;
}

enum { COLUMN, VECTOR };

/* An argument of n finite doubles, a column or any vector, or the default where it is empty or absent. */
static void take(int count, const mxArray *const *given, int which, const char *what, int shape, int32_t n, double *into,
                 const double *otherwise) {
    const mxArray *array = which < count ? given[which] : NULL;
    char rule[160];
    int32_t i;
    if (array == NULL || mxIsEmpty(array)) {
        if (otherwise == NULL && n > 0) {
            sprintf(rule, "it has %d entries", (int)n);
            refuse("missing", what, rule);
        }
        if (n > 0) memcpy(into, otherwise, (size_t)n * sizeof *into);
        return;
    }
    if (!mxIsDouble(array) || mxIsComplex(array) || mxIsSparse(array) || (int32_t)mxGetNumberOfElements(array) != n) {
        sprintf(rule, "it is a real, full array of %d doubles", (int)n);
        refuse("size", what, rule);
    }
    if ((int32_t)mxGetM(array) != n && (shape == COLUMN || mxGetM(array) != 1)) {
        sprintf(rule, "it is a column of %d doubles%s", (int)n, shape == COLUMN ? "" : ", or a row");
        refuse("shape", what, rule);
    }
    memcpy(into, mxGetPr(array), (size_t)n * sizeof *into);
    for (i = 0; i < n; ++i)
        if (!(into[i] - into[i] == 0.0)) {
            sprintf(rule, "its entries are finite, and number %d is not", (int)i + 1);
            refuse("value", what, rule);
        }
}
