/* The loop: steps and their size. */

SYM_EXPORT size_t sym_work_size(const sym_run *r) {
    const size_t n = 2 * (size_t)r->scene->nv;
    const size_t stages = r->tableau.dense_stages > 1 ? (size_t)r->tableau.dense_stages : 1;
    return (4 + stages) * n + sym_implicit_size(r);
}

/* The scene's accelerations, those of the present state, into k[0]. */
static void sym_begin_slopes(sym_run *r, double *k) {
    const int32_t nv = r->scene->nv;
    memcpy(k, r->v, (size_t)nv * sizeof *k);
    memcpy(k + nv, r->scene->a, (size_t)nv * sizeof *k);
    r->fresh = 1, r->linear = 0;
}

/* Slope at the present state into k[0], unless it is known. */
static int32_t sym_first_slope(sym_run *r, double *k) {
    int32_t status = 0;
    if (!r->fresh) {
        sym_here(r);
        status = sym_accelerate(r);
        if (status == 0) sym_begin_slopes(r, k);
    }
    if (r->scene->nc > 0 && status == 0) {
        const int32_t rank = (int32_t)*r->scene->rank;
        if (rank > r->rank_max) r->rank_max = rank;
        if (rank < r->rank_min) r->rank_min = rank, r->t_rank = r->t;
    }
    return status;
}

/* The state becomes y at time t. */
static void sym_move(sym_run *r, double t, const double *y) {
    sym_place(r, t, y);
    memcpy(r->q, r->scene->q, (size_t)r->scene->nq * sizeof *r->q);
    memcpy(r->v, r->scene->v, (size_t)r->scene->nv * sizeof *r->v);
    r->t = t;
}

/* The error of an explicit step whose y1 is known. Returns 0 or a status. */
static int32_t sym_examine(sym_run *r, const sym_memory *m, double h, double *error) {
    *error = r->adaptive ? sym_explicit_error(r, m, h) : 0.0;
    return sym_finite(2 * r->scene->nv, m->y1) ? 0 : SYM_DIVERGED;
}

/* y1 and the error of an explicit step whose stages are known. */
static int32_t sym_complete(sym_run *r, sym_memory *m, double h, double *error) {
    if (r->method == SYM_METHOD_EXPLICIT) sym_moved(r, m, h, r->tableau.stages, r->tableau.b, m->y1);
    else sym_semi_implicit_step(r, h, m->k, m->y1);
    return sym_examine(r, m, h, error);
}

/* One attempt at a step of length h: y1, and the error over its bound where the method estimates one. */
static int32_t sym_try(sym_run *r, sym_memory *m, double h, double *error) {
    int32_t status;
    *error = 0.0;
    if (r->method == SYM_METHOD_EXPLICIT || r->method == SYM_METHOD_SEMI_IMPLICIT) {
        status = sym_stages(r, m, h, 1, r->tableau.stages);
        return status != 0 ? status : sym_complete(r, m, h, error);
    }
    if (r->method == SYM_METHOD_ROSENBROCK) {
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
        memcpy(m->k + nv, m->k + (size_t)r->tableau.last * m->step + nv, (size_t)nv * sizeof(double));
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

/* The step that is to be tried next: its length, and the time at its end. Returns 0 or a status. */
static int32_t sym_plan(sym_run *r, sym_memory *m, double *h, double *t1) {
    *h = r->adaptive ? r->h_next : r->h;
    *t1 = r->adaptive ? r->t + *h : r->t0 + (double)(r->steps + 1) * r->h;
    if (r->adaptive && *h < 16.0 * 2.2e-16 * fabs(r->t) + 1e-300) return SYM_TINY_STEP;
    if (*t1 >= r->t_end - 1e-9 * *h) *t1 = r->t_end;
    if (r->adaptive && r->h_max > 0.0 && *t1 - r->t > r->h_max) *t1 = r->t + r->h_max;
    *h = *t1 - r->t;
    if (r->adaptive) sym_sizes(r, m->size);
    return 0;
}

/* After a step was tried, with that status and error: take it, or make the next one shorter. Returns 0 or a status. */
static int32_t sym_judge(sym_run *r, sym_memory *m, double h, double t1, int32_t status, double error) {
    if (status == SYM_CALLBACK) return status;
    if (r->adaptive && (status != 0 || !(error <= 1.0))) {
        ++r->rejected;
        r->h_next = status != 0 || !(error == error) ? 0.25 * h : sym_next_size(r, h, error);
        return 0;
    }
    if (status != 0) return status;
    if (r->adaptive) {
        r->h_next = sym_next_size(r, h, error);
        r->error_last = error > 1e-4 ? error : 1e-4;
    }
    return sym_accept(r, m, h, t1);
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
        if (status == 0) status = sym_plan(r, &m, &h, &t1);
        if (status != 0) return status;
        status = sym_try(r, &m, h, &error);
        status = sym_judge(r, &m, h, t1, status, error);
        if (status != 0) return status;
    }
    return r->t >= r->t_end ? SYM_DONE : SYM_GOING;
}
