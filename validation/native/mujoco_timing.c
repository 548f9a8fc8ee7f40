/* Times generated C against MuJoCo's own C in one process, interleaved, over the same states.
 *
 * Arguments: MuJoCo's model (.mjb), states file, generated library, its exported function, repeats.
 * The states file holds their count, then per state our q and v and MuJoCo's qpos and qvel.
 * Prints "time FUNCTION SIDE REPEAT NANOSECONDS" for each function, side and repeat, per state. */

#define _POSIX_C_SOURCE 200809L
#include <dlfcn.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "symofros_model.h"

enum { MASS_MATRIX, BOTH, FORWARD, FUNCTIONS };

static const char *const names[] = {"mass_matrix", "mass_matrix_and_bias", "forward_dynamics"};
static const char *const ours[] = {"mass_matrix", "dynamics", "forward_dynamics"};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* Kinematics are shared by what follows, as MuJoCo's own pipeline does. */
static void mujoco_run(const mjModel *m, mjData *d, int what, size_t n, const double *q, const double *v) {
    size_t i;
    for (i = 0; i < n; ++i) {
        memcpy(d->qpos, q + i * (size_t)m->nq, (size_t)m->nq * sizeof *q);
        mj_kinematics(m, d);
        mj_comPos(m, d);
        mj_makeM(m, d);
        if (what == MASS_MATRIX) continue;
        memcpy(d->qvel, v + i * (size_t)m->nv, (size_t)m->nv * sizeof *v);
        mj_comVel(m, d);
        mj_rne(m, d, 0, d->qfrc_bias);
        if (what == BOTH) continue;
        mj_factorM(m, d);
        mju_scl(d->qfrc_smooth, d->qfrc_bias, -1.0, m->nv);
        mj_solveM(m, d, d->qacc_smooth, d->qfrc_smooth, 1);
    }
}

/* Ours, state by state, as a control loop calls it. */
static void ours_run(const sym_function *function, size_t n, const double *const *in, const size_t *stride,
                     double *const *out, double *work) {
    const double *x[10];
    double *y[8];
    size_t i;
    int k;
    for (k = 0; k < function->n_in; ++k) x[k] = in[k];
    for (k = 0; k < function->n_out; ++k) y[k] = out[k];
    for (i = 0; i < n; ++i) {
        function->eval(x, y, work);
        for (k = 0; k < function->n_in; ++k) x[k] += stride[k];
        for (k = 0; k < function->n_out; ++k) y[k] += function->out[k].rows * function->out[k].cols;
    }
}

static double *room(size_t n) { return calloc(n + 1, sizeof(double)); }

int main(int argc, char **argv) {
    mjModel *m;
    mjData *d;
    FILE *file;
    void *library;
    const sym_model *(*symbol)(void);
    const sym_model *model;
    const sym_function *function[FUNCTIONS];
    const double *in[FUNCTIONS][10];
    size_t stride[FUNCTIONS][10], n, i;
    double *out[FUNCTIONS][8], *work[FUNCTIONS], *pre, *zeros, *q, *v, *qpos, *qvel;
    int f, k, r, repeats;
    if (argc != 6) return 2;
    m = mj_loadModel(argv[1], NULL);
    if (m == NULL) return fprintf(stderr, "MuJoCo's model can't be read\n"), 2;
    d = mj_makeData(m);
    library = dlopen(argv[3], RTLD_NOW);
    if (library == NULL) return fprintf(stderr, "%s\n", dlerror()), 2;
    *(void **)&symbol = dlsym(library, argv[4]);
    if (symbol == NULL) return fprintf(stderr, "%s\n", dlerror()), 2;
    model = symbol();
    file = fopen(argv[2], "r");
    if (file == NULL || fscanf(file, "%zu", &n) != 1) return fprintf(stderr, "the states can't be read\n"), 2;
    q = room(n * (size_t)model->nq), v = room(n * (size_t)model->nv);
    qpos = room(n * (size_t)m->nq), qvel = room(n * (size_t)m->nv);
    for (i = 0; i < n; ++i) {
        double *const row[] = {q + i * (size_t)model->nq, v + i * (size_t)model->nv, qpos + i * (size_t)m->nq,
                               qvel + i * (size_t)m->nv};
        const int size[] = {model->nq, model->nv, (int)m->nq, (int)m->nv};
        for (f = 0; f < 4; ++f)
            for (k = 0; k < size[f]; ++k)
                if (fscanf(file, "%lf", row[f] + k) != 1) return fprintf(stderr, "the states can't be read\n"), 2;
    }
    fclose(file);
    pre = room((size_t)model->npre), zeros = room((size_t)(model->nv + model->nu));
    model->init(model->par_default, pre);
    for (f = 0; f < FUNCTIONS; ++f) {
        function[f] = sym_find(model, ours[f], NULL);
        if (function[f] == NULL) return fprintf(stderr, "the library lacks %s\n", ours[f]), 2;
        for (k = 0; k < function[f]->n_in; ++k) {
            const char *name = function[f]->in[k].name;
            const int is_q = strcmp(name, "q") == 0, is_v = strcmp(name, "v") == 0;
            in[f][k] = strcmp(name, "pre") == 0 ? pre : is_q ? q : is_v ? v : zeros;
            stride[f][k] = is_q || is_v ? (size_t)function[f]->in[k].rows : 0;
        }
        for (k = 0; k < function[f]->n_out; ++k)
            out[f][k] = room(n * (size_t)function[f]->out[k].rows * (size_t)function[f]->out[k].cols);
        work[f] = room(function[f]->work);
    }
    repeats = atoi(argv[5]);
    for (r = 0; r < repeats; ++r)
        for (f = 0; f < FUNCTIONS; ++f) {
            double start = now();
            ours_run(function[f], n, in[f], stride[f], (double *const *)out[f], work[f]);
            printf("time %s symofros %d %.2f\n", names[f], r, (now() - start) / (double)n);
            start = now();
            function[f]->batch(n, in[f], stride[f], (double *const *)out[f], work[f]);
            printf("time %s batch %d %.2f\n", names[f], r, (now() - start) / (double)n);
            start = now();
            mujoco_run(m, d, f, n, qpos, qvel);
            printf("time %s mujoco %d %.2f\n", names[f], r, (now() - start) / (double)n);
        }
    return 0;
}
