/* symofros_fmu.h - a model as a functional mock-up unit, apart from the version of the interface. Written by hand.
 *
 * Value references run through, in this order: time, q, v, rates of q, rates of v, u, par, lam, kinetic and potential
 * energy, then x, y, z of each output frame. Included by the file that names the model: it defines SYM_FMU_PLANT,
 * SYM_FMU_TOKEN, SYM_FMU_FRAMES and sym_fmu_frames[].
 */

typedef enum { FMU_INSTANTIATED, FMU_INITIALISING, FMU_EVENT, FMU_CONTINUOUS, FMU_STEPPING, FMU_TERMINATED } fmu_phase;

enum {
    FMU_OK, FMU_NOT_NOW, FMU_UNKNOWN, FMU_NO_MOTION, FMU_WRONG_MODE, FMU_NO_START, FMU_STOP_BEFORE_START, FMU_NO_MEMORY,
    FMU_FOREIGN, FMU_TOO_SHORT
};

typedef struct fmu_snapshot { /* followed by q, v, u, par */
    char hash[24];
    double t, h, stop;
    int32_t phase, stops, cosim, reserved;
} fmu_snapshot;

typedef struct fmu {
    sym_instance *it;
    fmu_phase phase;
    int cosim, fresh, stops, prepared;
    double stop;
    double *rates, *change, *dq, *dv, *du, *dlam, *matrix, *jacobian;
    const sym_function *pose[SYM_FMU_FRAMES + 1], *slope[SYM_FMU_FRAMES + 1];
    const sym_function *driven[SYM_FMU_FRAMES + 1]; /* by prescribed motions; NULL where there are none */
    const sym_function *kinetic, *potential;
    /* Of the environment. */
    void *environment, *logger;
    char *name;
    void (*release)(void *);
} fmu;

/* Baumgarte's gains under an importer's integrator, which knows nothing of constraints [1/s]. */
#define FMU_GAIN 20.0

static size_t fmu_first(const fmu *f, int what) {
    const sym_model *m = f->it->model;
    const int32_t sizes[10] = {1, m->nq, m->nv, m->nq, m->nv, m->nu, m->npar, m->nc, 2, 3 * SYM_FMU_FRAMES};
    size_t first = 0;
    int i;
    for (i = 0; i < what; ++i) first += (size_t)sizes[i];
    return first;
}

enum { FMU_TIME, FMU_Q, FMU_V, FMU_DQ, FMU_DV, FMU_U, FMU_PAR, FMU_LAM, FMU_ENERGY, FMU_FRAME, FMU_END };

/* Which group a value reference is of, and where in it. */
static int fmu_locate(const fmu *f, size_t reference, size_t *index) {
    int what;
    for (what = FMU_END; what > 0; --what)
        if (reference >= fmu_first(f, what)) break;
    *index = reference - fmu_first(f, what);
    return what;
}

static double *fmu_part(double **at, size_t n) {
    double *found = *at;
    *at += n + 1;
    return found;
}

static fmu *fmu_new(int cosim, const char *name, void *(*allocate)(size_t, size_t), void (*release)(void *)) {
    const sym_plant *plant = SYM_FMU_PLANT();
    const sym_model *m = plant->model();
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv, nu = (size_t)m->nu, nc = (size_t)m->nc, n = nv + nc;
    const size_t doubles = 2 * (nq + nv) + nq + nv + nu + nc + n * n + 3 * n + nv + 30 * nv + 18 * nu + 16;
    const size_t head = (sizeof(fmu) + 15) / 16 * 16, size = (sym_instance_size(plant) + 15) / 16 * 16;
    const size_t length = name == NULL ? 0 : strlen(name);
    char *memory = allocate(1, head + size + doubles * sizeof(double) + length + 1);
    fmu *f = (fmu *)(void *)memory;
    double *at;
    int i;
    if (memory == NULL) return NULL;
    memset(f, 0, sizeof *f);
    f->it = sym_instance_in(memory + head, size, plant);
    if (f->it == NULL) {
        release(memory);
        return NULL;
    }
    at = (double *)(void *)(memory + head + size);
    f->rates = fmu_part(&at, nq + nv), f->change = fmu_part(&at, nq + nv);
    f->dq = fmu_part(&at, nq), f->dv = fmu_part(&at, nv), f->du = fmu_part(&at, nu), f->dlam = fmu_part(&at, nc);
    f->matrix = fmu_part(&at, n * n + 3 * n + nv), f->jacobian = fmu_part(&at, 30 * nv + 18 * nu);
    f->name = (char *)(void *)at;
    if (length > 0) memcpy(f->name, name, length);
    f->name[length] = '\0';
    f->cosim = cosim, f->release = release, f->phase = FMU_INSTANTIATED;
    f->kinetic = sym_find(m, "kinetic_energy", NULL), f->potential = sym_find(m, "potential_energy", NULL);
    for (i = 0; i < SYM_FMU_FRAMES; ++i) {
        f->pose[i] = sym_find(m, "frame_pose", sym_fmu_frames[i]);
        f->slope[i] = sym_find(m, "frame_jacobian", sym_fmu_frames[i]);
        f->driven[i] = sym_find(m, "frame_derivatives", sym_fmu_frames[i]);
    }
    return f;
}

static void fmu_reset(fmu *f) {
    const int32_t nc = f->it->model->nc;
    int32_t i;
    sym_instance_reset(f->it);
    if (!f->cosim)
        for (i = 0; i < 2 * nc; ++i) f->it->gains[i] = FMU_GAIN;
    f->phase = FMU_INSTANTIATED, f->fresh = 0, f->stops = 0, f->prepared = 1;
}

/* Everything at the present state, computed when it is first asked for. */
static int fmu_refresh(fmu *f) {
    if (!f->prepared) sym_instance_prepare(f->it), f->prepared = 1;
    if (f->fresh) return FMU_OK;
    if (sym_instance_rates(f->it, f->rates) != 0) return FMU_NO_MOTION;
    f->fresh = 1;
    return FMU_OK;
}

static int fmu_get(fmu *f, size_t reference, double *value) {
    sym_instance *it = f->it;
    size_t i;
    const int what = fmu_locate(f, reference, &i);
    double p[3], R[9], *out[2];
    if (what == FMU_END) return FMU_UNKNOWN;
    if (what == FMU_DQ || what == FMU_DV || what == FMU_LAM) {
        const int status = fmu_refresh(f);
        if (status != FMU_OK) return status;
    } else if (!f->prepared) {
        sym_instance_prepare(it), f->prepared = 1;
    }
    out[0] = p, out[1] = R;
    switch (what) {
    case FMU_TIME: *value = it->t; break;
    case FMU_Q: *value = it->q[i]; break;
    case FMU_V: *value = it->v[i]; break;
    case FMU_DQ: *value = f->rates[i]; break;
    case FMU_DV: *value = f->rates[(size_t)it->model->nq + i]; break;
    case FMU_U: *value = it->u[i]; break;
    case FMU_PAR: *value = it->par[i]; break;
    case FMU_LAM: *value = it->lam[i]; break;
    case FMU_ENERGY:
        if (!sym_instance_call(it, i == 0 ? f->kinetic : f->potential, out)) return FMU_UNKNOWN;
        *value = p[0];
        break;
    default:
        if (!sym_instance_call(it, f->pose[i / 3], out)) return FMU_UNKNOWN;
        *value = p[i % 3];
    }
    return FMU_OK;
}

static int fmu_set(fmu *f, size_t reference, double value) {
    sym_instance *it = f->it;
    size_t i;
    const int what = fmu_locate(f, reference, &i), starting = f->phase <= FMU_INITIALISING;
    if (what == FMU_END) return FMU_UNKNOWN;
    if (!(value - value == 0.0) || f->phase == FMU_TERMINATED) return FMU_NOT_NOW;
    if (what == FMU_Q && starting) it->q[i] = value;
    else if (what == FMU_V && starting) it->v[i] = value;
    else if (what == FMU_U) it->u[i] = value;
    else if (what == FMU_PAR && f->phase != FMU_CONTINUOUS) it->par[i] = value, f->prepared = 0;
    else return FMU_NOT_NOW;
    f->fresh = 0;
    return FMU_OK;
}

static int fmu_initialise(fmu *f) {
    if (!f->prepared) sym_instance_prepare(f->it), f->prepared = 1;
    f->fresh = 0;
    if (sym_instance_close(f->it) != 0 || fmu_refresh(f) != FMU_OK) return FMU_NO_MOTION;
    f->phase = f->cosim ? FMU_STEPPING : FMU_EVENT;
    return FMU_OK;
}

/* One communication step. */
static int fmu_step(fmu *f, double t, double h) {
    const double slack = 1e-9 * (fabs(t) + h);
    if (!f->prepared) sym_instance_prepare(f->it), f->prepared = 1;
    if (!(h > 0.0) || !(fabs(t - f->it->t) <= slack)) return FMU_NOT_NOW;
    if (f->stops && t + h > f->stop + slack) return FMU_NOT_NOW;
    f->fresh = 0;
    return sym_instance_advance(f->it, t + h, 0.0) == SYM_DONE ? FMU_OK : FMU_NO_MOTION;
}

/* The change of a frame's coordinate with f->dq and f->du. */
static int fmu_moved(fmu *f, size_t frame, size_t row, double *change) {
    sym_instance *it = f->it;
    const size_t nv = (size_t)it->model->nv, nu = (size_t)it->model->nu;
    double *out[8], *at = f->jacobian, sum = 0.0;
    size_t j;
    out[0] = f->jacobian;
    if (!sym_instance_call(it, f->slope[frame], out)) return FMU_UNKNOWN;
    sym_instance_tangent(it, f->dq, f->matrix);
    for (j = 0; j < nv; ++j) sum += f->jacobian[row * nv + j] * f->matrix[j];
    if (f->driven[frame] != NULL) { /* six rows each, by q or v or u: pose_by_u is the second */
        static const int of_inputs[8] = {0, 1, 0, 0, 1, 0, 0, 1};
        for (j = 0; j < 8; ++j) {
            out[j] = at;
            at += 6 * (of_inputs[j] ? nu : nv);
        }
        if (!sym_instance_call(it, f->driven[frame], out)) return FMU_UNKNOWN;
        for (j = 0; j < nu; ++j) sum += out[1][row * nu + j] * f->du[j];
    }
    *change = sum;
    return FMU_OK;
}

/* seeds of knowns (states and inputs) -> changes of unknowns (rates, multipliers, outputs): exact. */
static int fmu_differentiate(fmu *f, size_t n_unknown, const uint32_t *unknown, size_t n_known, const uint32_t *known,
                             const double *seed, double *found) {
    sym_instance *it = f->it;
    const sym_model *m = it->model;
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv;
    size_t i, k;
    int status;
    memset(f->dq, 0, nq * sizeof(double)), memset(f->dv, 0, nv * sizeof(double));
    memset(f->du, 0, (size_t)m->nu * sizeof(double));
    for (k = 0; k < n_known; ++k)
        switch (fmu_locate(f, known[k], &i)) {
        case FMU_Q: f->dq[i] += seed[k]; break;
        case FMU_V: f->dv[i] += seed[k]; break;
        case FMU_U: f->du[i] += seed[k]; break;
        default: return FMU_UNKNOWN;
        }
    status = fmu_refresh(f);
    if (status != FMU_OK) return status;
    if (sym_instance_changes(it, f->dq, f->dv, f->du, f->change, f->dlam, f->matrix) != 0) return FMU_NO_MOTION;
    for (k = 0; k < n_unknown; ++k) {
        switch (fmu_locate(f, unknown[k], &i)) {
        case FMU_Q: found[k] = f->dq[i]; break;
        case FMU_V: found[k] = f->dv[i]; break;
        case FMU_DQ: found[k] = f->change[i]; break;
        case FMU_DV: found[k] = f->change[nq + i]; break;
        case FMU_LAM: found[k] = f->dlam[i]; break;
        case FMU_FRAME:
            status = fmu_moved(f, i / 3, i % 3, &found[k]);
            if (status != FMU_OK) return status;
            break;
        default: return FMU_UNKNOWN;
        }
    }
    return FMU_OK;
}

static size_t fmu_snapshot_size(const fmu *f) {
    const sym_model *m = f->it->model;
    return sizeof(fmu_snapshot) + ((size_t)m->nq + (size_t)m->nv + (size_t)m->nu + (size_t)m->npar) * sizeof(double);
}

static void fmu_save(const fmu *f, void *into) {
    const sym_instance *it = f->it;
    const sym_model *m = it->model;
    const double *const parts[4] = {it->q, it->v, it->u, it->par};
    const int32_t sizes[4] = {m->nq, m->nv, m->nu, m->npar};
    char *at = (char *)into + sizeof(fmu_snapshot);
    fmu_snapshot head;
    int i;
    memset(&head, 0, sizeof head);
    strncpy(head.hash, m->hash, sizeof head.hash - 1);
    head.t = it->t, head.h = it->run.h, head.stop = f->stop;
    head.phase = (int32_t)f->phase, head.stops = f->stops, head.cosim = f->cosim;
    memcpy(into, &head, sizeof head);
    for (i = 0; i < 4; ++i) {
        memcpy(at, parts[i], (size_t)sizes[i] * sizeof(double));
        at += (size_t)sizes[i] * sizeof(double);
    }
}

/* 0 where it is of another model or kind. */
static int fmu_load(fmu *f, const void *from) {
    sym_instance *it = f->it;
    const sym_model *m = it->model;
    double *const parts[4] = {it->q, it->v, it->u, it->par};
    const int32_t sizes[4] = {m->nq, m->nv, m->nu, m->npar};
    const char *at = (const char *)from + sizeof(fmu_snapshot);
    fmu_snapshot head;
    int i;
    memcpy(&head, from, sizeof head);
    head.hash[sizeof head.hash - 1] = '\0';
    if (strncmp(head.hash, m->hash, sizeof head.hash - 1) != 0 || head.cosim != f->cosim) return 0;
    if (head.phase < 0 || head.phase > (int32_t)FMU_TERMINATED) return 0;
    it->t = head.t, it->run.h = head.h, f->stop = head.stop;
    f->phase = (fmu_phase)head.phase, f->stops = head.stops;
    for (i = 0; i < 4; ++i) {
        memcpy(parts[i], at, (size_t)sizes[i] * sizeof(double));
        at += (size_t)sizes[i] * sizeof(double);
    }
    f->prepared = 0, f->fresh = 0;
    return 1;
}
