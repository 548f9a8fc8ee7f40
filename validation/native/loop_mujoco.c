/* MuJoCo's own C as loops over states, for loop.h; the model comes as an .mjb file.
 *
 * Kinematics are shared by what follows them, as in MuJoCo's own pipeline. */

#include <mujoco/mujoco.h>
#include <stdlib.h>
#include <string.h>

#include "loop.h"

typedef struct engine {
    mjModel *m;
    mjData *d;
    int body;
    mjtNum *J;
} engine;

static void place(engine *e, const loop_states *s, size_t i) {
    memcpy(e->d->qpos, s->q + i * (size_t)e->m->nq, (size_t)e->m->nq * sizeof(double));
    mj_kinematics(e->m, e->d);
    mj_comPos(e->m, e->d);
}

static void move(engine *e, const loop_states *s, size_t i) {
    memcpy(e->d->qvel, s->v + i * (size_t)e->m->nv, (size_t)e->m->nv * sizeof(double));
    mj_comVel(e->m, e->d);
}

static void at_M(engine *e, const loop_states *s, size_t i) {
    place(e, s, i);
    mj_makeM(e->m, e->d);
}

static void at_h(engine *e, const loop_states *s, size_t i) {
    place(e, s, i);
    move(e, s, i);
    mj_rne(e->m, e->d, 0, e->d->qfrc_bias);
}

static void at_both(engine *e, const loop_states *s, size_t i) {
    at_M(e, s, i);
    move(e, s, i);
    mj_rne(e->m, e->d, 0, e->d->qfrc_bias);
}

static void at_a(engine *e, const loop_states *s, size_t i) {
    at_both(e, s, i);
    mj_factorM(e->m, e->d);
    mju_sub(e->d->qfrc_smooth, s->tau + i * (size_t)e->m->nv, e->d->qfrc_bias, e->m->nv);
    mj_solveM(e->m, e->d, e->d->qacc, e->d->qfrc_smooth, 1);
}

/* mj_rne leaves armatures out. */
static void at_tau(engine *e, const loop_states *s, size_t i) {
    int k;
    place(e, s, i);
    move(e, s, i);
    memcpy(e->d->qacc, s->a + i * (size_t)e->m->nv, (size_t)e->m->nv * sizeof(double));
    mj_rne(e->m, e->d, 1, e->d->qfrc_inverse);
    for (k = 0; k < e->m->nv; ++k) e->d->qfrc_inverse[k] += e->m->dof_armature[k] * e->d->qacc[k];
}

static void at_J(engine *e, const loop_states *s, size_t i) {
    place(e, s, i);
    mj_jacBody(e->m, e->d, e->J, e->J + 3 * e->m->nv, e->body);
}

static double *put(double *to, const mjtNum *from, int n) {
    memcpy(to, from, (size_t)n * sizeof *to);
    return to + n;
}

static double *give_M(engine *e, double *to) {
    mj_fullM(e->m, e->d, to);
    return to + e->m->nv * e->m->nv;
}

static double *give_h(engine *e, double *to) { return put(to, e->d->qfrc_bias, e->m->nv); }
static double *give_both(engine *e, double *to) { return give_h(e, give_M(e, to)); }
static double *give_a(engine *e, double *to) { return put(to, e->d->qacc, e->m->nv); }
static double *give_tau(engine *e, double *to) { return put(to, e->d->qfrc_inverse, e->m->nv); }
static double *give_J(engine *e, double *to) { return put(to, e->J, 6 * e->m->nv); }

#define LOOP(name)                                                                                   \
    static void run_##name(void *given, const loop_states *s, size_t rounds, double *results) {      \
        engine *e = (engine *)given;                                                                 \
        size_t r, i;                                                                                 \
        for (r = 0; r < rounds; ++r)                                                                 \
            for (i = 0; i < s->n; ++i) {                                                             \
                at_##name(e, s, i);                                                                  \
                if (results != NULL) results = give_##name(e, results);                              \
            }                                                                                        \
    }
LOOP(M)
LOOP(h)
LOOP(both)
LOOP(a)
LOOP(tau)
LOOP(J)

/* As many steps as there are states, from the first of them, free of forces; nothing touches, and nothing is tied. */
static void run_steps(void *given, const loop_states *s, size_t rounds, double *results) {
    engine *e = (engine *)given;
    size_t r, i;
    e->m->opt.integrator = mjINT_RK4;
    e->m->opt.timestep = s->step;
    e->m->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_SENSOR;
    for (r = 0; r < rounds; ++r) {
        e->d->time = 0.0;
        memcpy(e->d->qpos, s->q, (size_t)e->m->nq * sizeof(double));
        memcpy(e->d->qvel, s->v, (size_t)e->m->nv * sizeof(double));
        for (i = 0; i < s->n; ++i) mj_step(e->m, e->d);
    }
    if (results != NULL) put(put(results, e->d->qpos, (int)e->m->nq), e->d->qvel, e->m->nv);
}

const loop_engine *loop_open(const char *path, int32_t body) {
    engine *e = malloc(sizeof *e);
    loop_engine *found = malloc(sizeof *found);
    loop_function *functions = malloc(7 * sizeof *functions);
    int nv;
    if (e == NULL || found == NULL || functions == NULL) return NULL;
    e->m = mj_loadModel(path, NULL);
    if (e->m == NULL) return NULL;
    e->d = mj_makeData(e->m);
    e->body = body;
    nv = e->m->nv;
    e->J = calloc(6 * (size_t)nv + 1, sizeof *e->J);
    functions[0] = (loop_function){"mass_matrix", "", nv * nv, 0, run_M};
    functions[1] = (loop_function){"bias", "", nv, 0, run_h};
    functions[2] = (loop_function){"dynamics", "", nv * nv + nv, 0, run_both};
    functions[3] = (loop_function){"forward_dynamics", "", nv, 0, run_a};
    functions[4] = (loop_function){"inverse_dynamics", "", nv, 0, run_tau};
    functions[5] = (loop_function){"frame_jacobian", "", 6 * nv, 0, run_J};
    functions[6] = (loop_function){"step", "RK4", (int32_t)e->m->nq + nv, 1, run_steps};
    *found = (loop_engine){e, 7, functions};
    return found;
}
