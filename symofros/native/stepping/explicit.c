/* Explicit Runge-Kutta methods by their tableau, and semi-implicit Euler. n = 2 nv. */

typedef struct sym_memory { /* where a run's work lies: vectors of n, slopes k of stages, what implicit methods need */
    double *y1, *stage, *size, *end, *k, *rest;
    size_t step; /* from one stage's slopes to the next one's */
} sym_memory;

static sym_memory sym_lay_out(const sym_run *r) {
    const size_t n = 2 * (size_t)r->scene->nv;
    const size_t stages = r->tableau.dense_stages > 1 ? (size_t)r->tableau.dense_stages : 1;
    sym_memory m;
    m.y1 = r->y;
    m.stage = m.y1 + n;
    m.size = m.stage + n;
    m.end = m.size + n;
    m.k = m.end + n;
    m.rest = m.k + stages * n;
    m.step = n;
    return m;
}

/* sum = weights[0] k_0 + ... + weights[stages - 1] k, of n entries. */
static void sym_sum(size_t n, int32_t stages, const double *weights, const double *k, size_t step, double *restrict sum) {
    int32_t j;
    size_t l;
    memset(sum, 0, n * sizeof *sum);
    for (j = 0; j < stages; ++j) {
        const double w = weights[j], *restrict kj = k + (size_t)j * step;
        if (w != 0.0)
            for (l = 0; l < n; ++l) sum[l] += w * kj[l];
    }
}

/* y = (0, v) + h sum of weighted slopes. */
static void sym_moved(const sym_run *r, const sym_memory *m, double h, int32_t stages, const double *weights, double *y) {
    const int32_t nv = r->scene->nv;
    int32_t l;
    sym_sum(2 * (size_t)nv, stages, weights, m->k, m->step, y);
    for (l = 0; l < nv; ++l) {
        y[l] *= h;
        y[nv + l] = h * y[nv + l] + r->v[l];
    }
}

/* Stages first to end - 1, those before them being known. */
static int32_t sym_stages(sym_run *r, const sym_memory *m, double h, int32_t first, int32_t end) {
    const sym_tableau *method = &r->tableau;
    int32_t i, status;
    for (i = first; i < end; ++i) {
        sym_moved(r, m, h, i, method->a + (size_t)i * method->dense_stages, m->stage);
        status = sym_slope(r, r->t + method->c[i] * h, m->stage, m->k + (size_t)i * m->step);
        if (status != 0) return status;
    }
    return 0;
}

/* v1 = v + h v', then q1 = q moved by h v1: symplectic for constant mass, one evaluation a step. */
static void sym_semi_implicit_step(const sym_run *r, double h, const double *k, double *y1) {
    const int32_t nv = r->scene->nv;
    int32_t l;
    for (l = 0; l < nv; ++l) {
        y1[nv + l] = r->v[l] + h * k[nv + l];
        y1[l] = h * y1[nv + l];
    }
}

/* Sizes of the entries of y at the present state: a coordinate's own; 1 for a rotation. */
static void sym_sizes(const sym_run *r, double *size) {
    const sym_scene *s = r->scene;
    int32_t i, k;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *seg = &s->segments[k];
        const int32_t n = seg->kind == 0 ? seg->size : 3 * seg->kind;
        for (i = 0; i < n; ++i)
            size[seg->v + i] = seg->kind == 0 || (seg->kind == 2 && i < 3) ? fabs(r->q[seg->q + i]) : 1.0;
    }
    for (i = 0; i < s->nv; ++i) size[s->nv + i] = fabs(r->v[i]);
}

/* What an error of entry l of y is measured by. */
static double sym_scale(const sym_run *r, int32_t l, const double *size, const double *y1) {
    double s = size[l];
    if (l >= r->scene->nv && fabs(y1[l]) > s) s = fabs(y1[l]);
    return r->atol + r->rtol * s;
}

static double sym_embedded(const sym_run *r, const sym_memory *m, const double *weights, double h) {
    const int32_t n = 2 * r->scene->nv;
    double sum = 0.0;
    int32_t i, l;
    for (l = 0; l < n; ++l) {
        double e = 0.0;
        for (i = 0; i < r->tableau.stages; ++i) e += weights[i] * m->k[(size_t)i * m->step + l];
        e *= h / sym_scale(r, l, m->size, m->y1);
        sum += e * e;
    }
    return sum / n;
}

/* Root mean square of the estimated error over its bound. */
static double sym_explicit_error(const sym_run *r, const sym_memory *m, double h) {
    const double first = sym_embedded(r, m, r->tableau.e, h);
    double second;
    if (r->tableau.errors < 2) return sqrt(first);
    second = sym_embedded(r, m, r->tableau.e2, h);
    return first == 0.0 ? 0.0 : first / sqrt(first + 0.01 * second);
}
