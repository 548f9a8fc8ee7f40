/* The motion within the steps of a run, by the cubics through their ends: docs/theory/simulation.md, (18a). */

/* Value and rate at share x of an interval of length h of the cubic with values y0, y1 and rates r0, r1 at its ends. */
static void sym_cubic_at(double x, double h, double y0, double r0, double y1, double r1, double *y, double *r) {
    const double change = y1 - y0 - h * r0, bend = h * (r1 - r0);
    *y = y0 + x * (h * r0 + x * (3.0 * change - bend + x * (bend - 2.0 * change)));
    *r = r0 + x * (2.0 * (3.0 * change - bend) + 3.0 * x * (bend - 2.0 * change)) / h;
}

SYM_EXPORT void sym_run_path(const sym_run *r, const double *t, const double *q, const double *v, const double *a, int64_t m,
                             const int64_t *interval, const double *x, double *work, double *t_x, double *q_x, double *v_x,
                             double *a_x) {
    const sym_system *s = r->system;
    const int32_t nq = s->nq, nv = s->nv;
    double *theta = work, *rate = work + nv, *along = rate + nv, unused;
    int64_t j;
    int32_t k;
    for (j = 0; j < m; ++j) {
        const int64_t i = interval[j];
        const double h = t[i + 1] - t[i], *v0 = v + i * nv, *a0 = a + i * nv, *v1 = v0 + nv, *a1 = a0 + nv;
        if (j == 0 || i != interval[j - 1]) { /* The chart about the begin of the interval. */
            sym_chart_coordinates(s, q + i * nq, q + (i + 1) * nq, theta);
            sym_chart_rate(s, theta, v1, rate);
        }
        for (k = 0; k < nv; ++k) {
            sym_cubic_at(x[j], h, 0.0, v0[k], theta[k], rate[k], along + k, &unused);
            sym_cubic_at(x[j], h, v0[k], a0[k], v1[k], a1[k], v_x + j * nv + k, a_x + j * nv + k);
        }
        t_x[j] = t[i] + x[j] * h;
        sym_retract(s, q + i * nq, along, q_x + j * nq);
    }
}
