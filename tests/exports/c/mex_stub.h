/* mex.h for tests without Matlab or Octave: arrays of doubles, names and messages as far as functions of models and diagrams ask for them. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
typedef size_t mwSize;
typedef size_t mwIndex;
typedef enum { mxREAL } mxComplexity;
typedef struct mxArray { size_t m, n; double *x; const char *text; } mxArray;
static mxArray *mxCreateDoubleMatrix(mwSize m, mwSize n, mxComplexity kind) {
    mxArray *made = calloc(1, sizeof *made);
    (void)kind;
    made->m = m, made->n = n, made->x = calloc(m * n + 1, sizeof *made->x);
    return made;
}
static mxArray *mxCreateDoubleScalar(double x) { mxArray *made = mxCreateDoubleMatrix(1, 1, mxREAL); made->x[0] = x; return made; }
static mxArray *mxCreateString(const char *text) { mxArray *made = mxCreateDoubleMatrix(1, 1, mxREAL); made->text = text; return made; }
static mxArray *mxCreateCellMatrix(mwSize m, mwSize n) { return mxCreateDoubleMatrix(m, n, mxREAL); }
static mxArray *mxCreateStructMatrix(mwSize m, mwSize n, int count, const char **names) { (void)count, (void)names; return mxCreateDoubleMatrix(m, n, mxREAL); }
static void mxSetCell(mxArray *into, mwIndex i, mxArray *x) { (void)into, (void)i, (void)x; }
static void mxSetField(mxArray *into, mwIndex i, const char *name, mxArray *x) { (void)i; if (strcmp(name, "X0") == 0 || strcmp(name, "values") == 0) into->m = x->m, into->x = x->x; }
static mxArray *mxGetField(mxArray *from, mwIndex i, const char *name) { (void)i, (void)name; return from; }
static double *mxGetPr(const mxArray *a) { return a->x; }
static double mxGetScalar(const mxArray *a) { return a->x[0]; }
static size_t mxGetM(const mxArray *a) { return a->m; }
static size_t mxGetN(const mxArray *a) { return a->n; }
static size_t mxGetNumberOfElements(const mxArray *a) { return a->m * a->n; }
static int mxIsEmpty(const mxArray *a) { return a->m * a->n == 0; }
static int mxIsDouble(const mxArray *a) { return a->text == NULL; }
static int mxIsChar(const mxArray *a) { return a->text != NULL; }
static int mxIsComplex(const mxArray *a) { (void)a; return 0; }
static int mxIsSparse(const mxArray *a) { (void)a; return 0; }
static char *mxArrayToString(const mxArray *a) { return strcpy(malloc(strlen(a->text) + 1), a->text); }
static void *mxMalloc(size_t n) { return malloc(n); }
static void *mxCalloc(size_t n, size_t size) { return calloc(n, size); }
static void mxFree(void *memory) { free(memory); }
static int mexAtExit(void (*action)(void)) { return atexit(action); }
#define mexPrintf printf
#define mexWarnMsgIdAndTxt(id, ...) (printf("%s ", id), printf(__VA_ARGS__))
#define mexErrMsgIdAndTxt(id, ...) (printf("%s ", id), printf(__VA_ARGS__), exit(3))
