/* The loop: steps, their size, records, events. */

typedef struct sym_memory { /* where things lie in sym_run.y */
    double *y1, *stage, *size, *end, *k, *rest;
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
    return m;
}

SYM_EXPORT size_t sym_work_size(const sym_run *r) {
    const size_t n = 2 * (size_t)r->scene->nv;
    const size_t stages = r->tableau.dense_stages > 1 ? (size_t)r->tableau.dense_stages : 1;
    return (4 + stages) * n + sym_implicit_size(r);
}

/* Slope at the present state into k[0], unless it is known. */
static int32_t sym_first_slope(sym_run *r, double *k) {
    const int32_t nv = r->scene->nv;
    int32_t status = 0;
    if (!r->fresh) {
        sym_here(r);
        status = sym_accelerate(r);
        r->fresh = 1, r->linear = 0;
        if (status == 0) {
            memcpy(k, r->v, (size_t)nv * sizeof *k);
            memcpy(k + nv, r->scene->a, (size_t)nv * sizeof *k);
        }
    }
    if (r->scene->nc > 0 && status == 0) {
        const int32_t rank = (int32_t)*r->scene->rank;
        if (rank > r->rank_max) r->rank_max = rank;
        if (rank < r->rank_min) r->rank_min = rank, r->t_rank = r->t;
    }
    return status;
}

/* Dense output: y at x in [0, 1] of the step that has just been made. */
static int32_t sym_dense(sym_run *r, sym_memory *m, double h, int32_t *ready, double x, double *y) {
    const sym_tableau *tableau = &r->tableau;
    const int32_t nv = r->scene->nv, n = 2 * nv;
    int32_t i, j, l, status;
    if (r->method == SYM_METHOD_EXPLICIT && tableau->degree > 0) {
        if (!*ready) {
            status = sym_stages(r, h, tableau->stages, tableau->dense_stages, m->k, m->stage);
            if (status != 0) return status;
            *ready = 1;
        }
        memset(y, 0, (size_t)n * sizeof *y);
        for (i = 0; i < tableau->dense_stages; ++i) {
            const double *p = tableau->dense + (size_t)i * tableau->degree;
            double s = 0.0;
            for (j = tableau->degree - 1; j >= 0; --j) s = (s + p[j]) * x;
            if (s != 0.0)
                for (l = 0; l < n; ++l) y[l] += h * s * m->k[(size_t)i * n + l];
        }
        for (l = 0; l < nv; ++l) y[nv + l] += r->v[l];
        return 0;
    }
    if (!*ready) { /* the cubic through both ends and their slopes */
        status = sym_slope(r, r->t + h, m->y1, m->end);
        if (status != 0) return status;
        *ready = 1;
    }
    for (l = 0; l < n; ++l) {
        const double y0 = l < nv ? 0.0 : r->v[l - nv], d = m->y1[l] - y0;
        const double f0 = h * m->k[l], f1 = h * m->end[l];
        y[l] = y0 + x * (f0 + x * ((3.0 * d - 2.0 * f0 - f1) + x * (f0 + f1 - 2.0 * d)));
    }
    return 0;
}

/* The scene's point: y of the present chart at time t. */
static void sym_place(sym_run *r, double t, const double *y) {
    sym_retract(r->scene, r->q, y, r->scene->q);
    memcpy(r->scene->v, y + r->scene->nv, (size_t)r->scene->nv * sizeof *y);
    *r->scene->t = t;
}

/* Record the scene's point. */
static int32_t sym_record(sym_run *r) {
    const sym_scene *s = r->scene;
    const int64_t i = r->n_records;
    if (sym_inputs(r->scene) != 0) return SYM_CALLBACK;
    r->record_t[i] = *s->t;
    memcpy(r->record_q + i * s->nq, s->q, (size_t)s->nq * sizeof(double));
    memcpy(r->record_v + i * s->nv, s->v, (size_t)s->nv * sizeof(double));
    memcpy(r->record_u + i * s->nu, s->u, (size_t)s->nu * sizeof(double));
    ++r->n_records;
    return 0;
}

/* All events at the scene's point. */
static int32_t sym_event_values(sym_run *r, double *values) {
    const sym_scene *s = r->scene;
    if (sym_inputs(r->scene) != 0) return SYM_CALLBACK;
    sym_evaluate(&s->events);
    memcpy(values, s->events.out[0], (size_t)s->n_events * sizeof *values);
    return 0;
}

static double sym_event_value(sym_run *r, int32_t which) {
    if (sym_inputs(r->scene) != 0) return NAN;
    sym_evaluate(&r->scene->events);
    return r->scene->events.out[0][which];
}

static int32_t sym_crosses(int32_t direction, double before, double after) {
    if (direction >= 0 && before < 0.0 && after >= 0.0) return 1;
    return direction <= 0 && before > 0.0 && after <= 0.0;
}

/* The x at which an event is zero, by the Illinois method on the dense output. */
static int32_t sym_locate(sym_run *r, sym_memory *m, double h, int32_t *ready, int32_t which, double before,
                          double after, double *x) {
    double a = 0.0, b = 1.0, fa = before, fb = after;
    int32_t i, side = 0;
    for (i = 0; i < 100 && b - a > 4e-16 && fb != 0.0; ++i) {
        double c = (fa * b - fb * a) / (fa - fb), f;
        int32_t status;
        if (!(c > a && c < b)) c = 0.5 * (a + b);
        status = sym_dense(r, m, h, ready, c, m->stage);
        if (status != 0) return status;
        sym_place(r, r->t + c * h, m->stage);
        f = sym_event_value(r, which);
        if (!(f == f)) return SYM_DIVERGED;
        if ((f < 0.0) == (fa < 0.0) && f != 0.0) {
            a = c, fa = f;
            if (side == 1) fb *= 0.5;
            side = 1;
        } else {
            b = c, fb = f;
            if (side == -1) fa *= 0.5;
            side = -1;
        }
    }
    *x = b;
    return 0;
}

/* Events of the step just made, which ends at t1, in the order of time up to the first terminal one, whose x is
 * returned through it. r->event: the values at t1; then, for each event met, its x; then which it is. */
static int32_t sym_events(sym_run *r, sym_memory *m, double h, double t1, int32_t *ready, double *stop_x) {
    sym_scene *s = r->scene;
    int32_t i, status, n = 0;
    *stop_x = 2.0;
    r->stopped_by = -1;
    sym_place(r, t1, m->y1);
    status = sym_event_values(r, r->event + s->n_events);
    if (status != 0) return status;
    for (i = 0; i < s->n_events; ++i) { /* n <= i: what is written over has been read */
        const double before = r->event[i], after = r->event[s->n_events + i];
        double x;
        r->event[i] = after;
        if (!sym_crosses(s->event_direction[i], before, after)) continue;
        status = sym_locate(r, m, h, ready, i, before, after, &x);
        if (status != 0) return status;
        if (s->event_terminal[i] && x < *stop_x) *stop_x = x, r->stopped_by = i;
        r->event[s->n_events + n] = x;
        r->event[2 * s->n_events + n] = (double)i;
        ++n;
    }
    for (;;) { /* the earliest that is left */
        int32_t best = -1, which;
        for (i = 0; i < n; ++i)
            if (r->event[s->n_events + i] <= *stop_x &&
                (best < 0 || r->event[s->n_events + i] < r->event[s->n_events + best]))
                best = i;
        if (best < 0) return 0;
        which = (int32_t)r->event[2 * s->n_events + best];
        status = sym_dense(r, m, h, ready, r->event[s->n_events + best], m->stage);
        if (status != 0) return status;
        sym_place(r, r->t + r->event[s->n_events + best] * h, m->stage);
        r->found_t[r->n_found] = *s->t;
        r->found_which[r->n_found] = which;
        memcpy(r->found_q + r->n_found * s->nq, s->q, (size_t)s->nq * sizeof(double));
        memcpy(r->found_v + r->n_found * s->nv, s->v, (size_t)s->nv * sizeof(double));
        ++r->n_found;
        r->event[s->n_events + best] = 3.0;
    }
}

/* Records asked for at times within the step. */
static int32_t sym_grid(sym_run *r, sym_memory *m, double h, int32_t *ready, double up_to) {
    while (r->at_grid < r->n_grid && r->grid[r->at_grid] <= r->t + up_to * h * (1.0 + 1e-12)) {
        const double x = (r->grid[r->at_grid] - r->t) / h;
        int32_t status;
        if (x > 1.0 - 1e-9) {
            sym_place(r, r->grid[r->at_grid], m->y1);
        } else {
            status = sym_dense(r, m, h, ready, x, m->stage);
            if (status != 0) return status;
            sym_place(r, r->grid[r->at_grid], m->stage);
        }
        status = sym_record(r);
        if (status != 0) return status;
        ++r->at_grid;
    }
    return 0;
}

/* The state becomes y at time t. */
static void sym_move(sym_run *r, double t, const double *y) {
    sym_place(r, t, y);
    memcpy(r->q, r->scene->q, (size_t)r->scene->nq * sizeof *r->q);
    memcpy(r->v, r->scene->v, (size_t)r->scene->nv * sizeof *r->v);
    r->t = t;
}

/* One attempt at a step of length h: y1, and the error over its bound where the method estimates one. */
static int32_t sym_try(sym_run *r, sym_memory *m, double h, double *error) {
    int32_t status;
    *error = 0.0;
    if (r->method == SYM_METHOD_EXPLICIT) {
        status = sym_explicit_step(r, h, m->k, m->y1, m->stage);
        if (status == 0 && r->adaptive) *error = sym_explicit_error(r, h, m->k, m->size, m->y1);
    } else if (r->method == SYM_METHOD_SEMI_IMPLICIT) {
        sym_semi_implicit_step(r, h, m->k, m->y1);
        status = 0;
    } else if (r->method == SYM_METHOD_ROSENBROCK) {
        status = sym_rosenbrock_step(r, h, m->k, m->y1, m->stage, m->size, m->rest, error);
    } else if (r->method == SYM_METHOD_ALPHA) {
        status = sym_alpha_step(r, h, m->y1, m->rest);
    } else {
        status = sym_variational_step(r, h, m->y1, m->rest);
    }
    if (status == 0 && !sym_finite(2 * r->scene->nv, m->y1)) status = SYM_DIVERGED;
    return status;
}

/* A first step size from the sizes of state, slope and change of slope (Hairer, Norsett, Wanner I, II.4). */
static int32_t sym_first_step(sym_run *r, sym_memory *m) {
    const int32_t nv = r->scene->nv, n = 2 * nv;
    const double order = r->tableau.error_order + 1.0;
    double d0 = 0.0, d1 = 0.0, d2 = 0.0, h0, h1, largest;
    int32_t l, status;
    sym_sizes(r, m->size);
    for (l = 0; l < nv; ++l) m->y1[l] = 0.0, m->y1[nv + l] = r->v[l];
    for (l = 0; l < n; ++l) {
        const double scale = sym_scale(r, l, m->size, m->y1);
        d0 += (m->size[l] / scale) * (m->size[l] / scale);
        d1 += (m->k[l] / scale) * (m->k[l] / scale);
    }
    d0 = sqrt(d0 / n), d1 = sqrt(d1 / n);
    h0 = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;
    if (h0 > r->t_end - r->t) h0 = r->t_end - r->t;
    for (l = 0; l < nv; ++l) m->stage[l] = h0 * m->k[l], m->stage[nv + l] = r->v[l] + h0 * m->k[nv + l];
    status = sym_slope(r, r->t + h0, m->stage, m->end);
    if (status == SYM_CALLBACK) return status;
    if (status != 0) {
        r->h_next = 1e-3 * h0;
        return 0;
    }
    for (l = 0; l < n; ++l) {
        const double scale = sym_scale(r, l, m->size, m->y1), d = (m->end[l] - m->k[l]) / scale;
        d2 += d * d;
    }
    d2 = sqrt(d2 / n) / h0;
    largest = d1 > d2 ? d1 : d2;
    h1 = largest <= 1e-15 ? (1e-6 > 1e-3 * h0 ? 1e-6 : 1e-3 * h0) : pow(0.01 / largest, 1.0 / order);
    r->h_next = 100.0 * h0 < h1 ? 100.0 * h0 : h1;
    return 0;
}

SYM_EXPORT int32_t sym_start(sym_run *r) {
    sym_memory m = sym_lay_out(r);
    sym_scene *s = r->scene;
    int32_t status;
    r->fresh = 0;
    r->steps = r->rejected = r->evaluations = r->jacobians = 0;
    r->n_records = r->n_found = r->at_grid = 0;
    r->rank_max = -1, r->rank_min = s->nc + 1;
    r->error_last = 1.0;
    r->clock0 = r->pace > 0.0 ? sym_clock() : 0.0;
    sym_here(r);
    if (r->every > 0 || (r->n_grid > 0 && r->grid[0] <= r->t)) {
        status = sym_record(r);
        if (status != 0) return status;
        if (r->every == 0) ++r->at_grid;
    }
    status = sym_first_slope(r, m.k);
    if (status != 0) return status;
    if (s->n_events > 0) {
        status = sym_event_values(r, r->event);
        if (status != 0) return status;
    }
    r->h_next = r->h;
    if (!r->adaptive || r->h > 0.0) return 0;
    status = sym_first_step(r, &m);
    if (r->method == SYM_METHOD_ROSENBROCK) r->fresh = 0; /* its derivatives need the scene back there */
    return status;
}

/* The size of the next step after one of size h with that error. */
static double sym_next_size(sym_run *r, double h, double error) {
    const double order = r->tableau.error_order + 1.0, damped = 0.04;
    double factor = error > 0.0 ? 0.9 * pow(error, -(1.0 / order - 0.75 * damped)) * pow(r->error_last, damped) : 8.0;
    if (factor > 8.0) factor = 8.0;
    if (factor < 0.2) factor = 0.2;
    return h * factor;
}

/* After a step was accepted: events, records, the new state. Returns 0 or a status. */
static int32_t sym_accept(sym_run *r, sym_memory *m, double h, double t1) {
    sym_scene *s = r->scene;
    const int32_t nv = s->nv, ends = r->method == SYM_METHOD_EXPLICIT && r->tableau.last > 0;
    int32_t ready = 0, status, stopped = 0;
    double stop_x = 2.0;
    if (s->n_events > 0) {
        status = sym_events(r, m, h, t1, &ready, &stop_x);
        if (status != 0) return status;
        stopped = stop_x <= 1.0;
    }
    if (r->every == 0) {
        status = sym_grid(r, m, h, &ready, stopped ? stop_x : 1.0);
        if (status != 0) return status;
    }
    if (stopped) {
        status = sym_dense(r, m, h, &ready, stop_x, m->y1);
        if (status != 0) return status;
        t1 = r->t + stop_x * h;
    }
    sym_move(r, t1, m->y1);
    r->fresh = 0;
    if (r->project) {
        status = sym_return(r);
        if (status != 0) return status;
    } else if (ends && !stopped) { /* the last slope is the next step's first; its chart starts anew */
        memcpy(m->k + nv, m->k + (size_t)r->tableau.last * 2 * nv + nv, (size_t)nv * sizeof(double));
        memcpy(m->k, r->v, (size_t)nv * sizeof(double));
        r->fresh = 1;
    }
    ++r->steps;
    if (s->n_events > 0 && (r->project || stopped)) { /* the state is no longer the one that sym_events saw */
        sym_here(r);
        status = sym_event_values(r, r->event);
        if (status != 0) return status;
    }
    if (r->every > 0 && (r->steps % r->every == 0 || r->t >= r->t_end || stopped)) {
        sym_here(r);
        status = sym_record(r);
        if (status != 0) return status;
    }
    if (r->pace > 0.0) sym_pace(r);
    return stopped ? SYM_EVENT : 0;
}

static int32_t sym_room(const sym_run *r) {
    const int32_t records = r->every == 0 || r->n_records < r->capacity; /* a grid fits as a whole */
    return records && r->n_found + r->scene->n_events <= r->event_capacity;
}

SYM_EXPORT int32_t sym_advance(sym_run *r, int64_t max_steps) {
    sym_memory m = sym_lay_out(r);
    int64_t done;
    for (done = 0; done < max_steps; ++done) {
        double h, error, t1;
        int32_t status;
        if (r->t >= r->t_end) return SYM_DONE;
        if (!sym_room(r)) return SYM_FULL;
        status = sym_first_slope(r, m.k);
        if (status != 0) return status;
        h = r->adaptive ? r->h_next : r->h;
        t1 = r->adaptive ? r->t + h : r->t0 + (double)(r->steps + 1) * r->h;
        if (r->adaptive && h < 16.0 * 2.2e-16 * fabs(r->t) + 1e-300) return SYM_TINY_STEP;
        if (t1 >= r->t_end - 1e-9 * h) t1 = r->t_end;
        if (r->adaptive && r->h_max > 0.0 && t1 - r->t > r->h_max) t1 = r->t + r->h_max;
        h = t1 - r->t;
        if (r->adaptive) sym_sizes(r, m.size);
        status = sym_try(r, &m, h, &error);
        if (status == SYM_CALLBACK) return status;
        if (r->adaptive && (status != 0 || !(error <= 1.0))) {
            ++r->rejected;
            r->h_next = status != 0 || !(error == error) ? 0.25 * h : sym_next_size(r, h, error);
            continue;
        }
        if (status != 0) return status;
        if (r->adaptive) {
            r->h_next = sym_next_size(r, h, error);
            r->error_last = error > 1e-4 ? error : 1e-4;
        }
        status = sym_accept(r, &m, h, t1);
        if (status != 0) return status;
    }
    return r->t >= r->t_end ? SYM_DONE : SYM_GOING;
}
