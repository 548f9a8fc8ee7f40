/* Further starts, for targets that the steps from a guess do not reach (docs/theory/constraints.md, section 9). */

#define SYM_TURN 6.283185307179586

/* Marks in p->depends (nv) the free speeds that the targets depend on, by themselves or through loops, as three postures
 * show. Returns their number. */
static int32_t sym_posture_used(sym_posture *p, const double *guess) {
    const int32_t nv = p->system->nv, m = p->m;
    int32_t i, k, look, n = 0, changed = 1;
    double *used = p->movable, *row = p->e_tried; /* whether a speed, a row counts */
    memset(p->depends, 0, (size_t)m * (size_t)nv * sizeof *p->depends);
    for (look = 0; look < 3; ++look) {
        const double *draws = p->draws + SYM_INDEX(look, nv, 0);
        for (k = 0; k < nv; ++k) p->step[k] = look == 0 ? 0.0 : draws[k] - 0.5;
        sym_retract(p->system, guess, p->step, p->tried);
        sym_posture_residual(p, p->tried, p->e, p->J);
        for (i = 0; i < m * nv; ++i)
            if (p->J[i] != 0.0) p->depends[i] = 1.0;
    }
    for (k = 0; k < nv; ++k) used[k] = 0.0;
    for (i = 0; i < m; ++i) row[i] = i < p->wishes;
    while (changed) {
        changed = 0;
        for (i = 0; i < m; ++i)
            for (k = 0; k < nv; ++k)
                if (p->depends[SYM_INDEX(i, nv, k)] != 0.0 && row[i] != used[k]) row[i] = used[k] = changed = 1;
    }
    for (k = 0; k < nv; ++k) {
        p->depends[k] = used[k] != 0.0 && p->free[k];
        n += p->depends[k] != 0.0;
    }
    return n;
}

/* The part of an interval about 0 within `far`, moved to keep its length where a limit is nearer. */
static void sym_window(double lower, double upper, double far, double *low, double *high) {
    const double a = lower > -far ? lower : -far, b = upper < far ? upper : far;
    const double shifted_a = a < b - 2.0 * far ? a : b - 2.0 * far, shifted_b = b > a + 2.0 * far ? b : a + 2.0 * far;
    *low = lower > shifted_a ? lower : shifted_a, *high = upper < shifted_b ? upper : shifted_b;
}

/* Largest error of the targets' positions in e [m]. */
static double sym_position_missing(const sym_posture *p, const double *e) {
    double largest = 0.0;
    int32_t k, i;
    for (k = 0; k < p->n_targets; ++k) {
        for (i = 0; p->targets[k].position && i < 3; ++i) largest = fabs(e[i]) > largest ? fabs(e[i]) : largest;
        e += 3 * (p->targets[k].position + p->targets[k].rotation);
    }
    return largest;
}

SYM_EXPORT int32_t sym_posture_windows(sym_posture *p, const double *guess) {
    const sym_system *s = p->system;
    int32_t k, i;
    const int32_t n = sym_posture_used(p, guess);
    double reach;
    sym_posture_error(p, guess, p->e);
    reach = sym_position_missing(p, p->e);
    p->n_kept = 0;
    for (k = 0; k < s->nv; ++k) p->low[k] = p->high[k] = 0.0;
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *of = &s->segments[k];
        const int32_t first = of->kind == SYM_SEGMENT_POSE ? of->v + 3 : of->v;
        if (of->kind != SYM_SEGMENT_LINEAR) { /* windows of 1: draws are rotation vectors already */
            const int32_t turns = p->depends[first] != 0.0 && p->depends[first + 1] != 0.0 && p->depends[first + 2] != 0.0;
            for (i = 0; i < 3; ++i) p->high[first + i] = turns;
            continue;
        }
        for (i = 0; i < of->size; ++i) {
            const double lower = p->lower[of->q + i], upper = p->upper[of->q + i], x = guess[of->q + i];
            const int32_t speed = of->v + i, turns = p->kind[speed] == SYM_SPEED_ROTATION;
            if (p->depends[speed] == 0.0 || p->kind[speed] == SYM_SPEED_OTHER) continue;
            sym_window(lower - x, upper - x, turns ? 0.5 * SYM_TURN : upper - lower < HUGE_VAL ? HUGE_VAL : reach,
                       p->low + speed, p->high + speed);
        }
    }
    return n;
}

/* Keep the end p->q among those that miss by least. */
static void sym_posture_keep(sym_posture *p) {
    const size_t nq = (size_t)p->system->nq;
    const double square = sym_squared_norm(p->m, p->e);
    int32_t i, at = p->n_kept;
    if (!(square < HUGE_VAL)) return;
    while (at > 0 && square < p->kept_square[at - 1]) --at;
    if (at == SYM_POSTURE_KEPT) return;
    if (p->n_kept < SYM_POSTURE_KEPT) ++p->n_kept;
    for (i = p->n_kept - 1; i > at; --i) {
        memcpy(p->kept + (size_t)i * nq, p->kept + (size_t)(i - 1) * nq, nq * sizeof *p->kept);
        p->kept_square[i] = p->kept_square[i - 1];
    }
    memcpy(p->kept + (size_t)at * nq, p->q, nq * sizeof *p->kept);
    p->kept_square[at] = square;
}

SYM_EXPORT void sym_posture_round(sym_posture *p, const double *guess, int32_t first, int32_t n, int32_t most) {
    const int32_t nq = p->system->nq, nv = p->system->nv;
    int32_t i, k;
    for (i = 0; i < n; ++i) {
        const double *draws = p->draws + SYM_INDEX(first + i, nv, 0), share = (i + 1.0) / SYM_POSTURE_ROUND;
        for (k = 0; k < nv; ++k) p->step[k] = share * (p->low[k] + (p->high[k] - p->low[k]) * draws[k]);
        sym_retract(p->system, guess, p->step, p->q);
        p->round_met[i] = first + i < SYM_QUICK_STARTS
                              ? sym_posture_follow(p, most, SYM_STALLED_QUICK, SYM_MIN_SHARE_QUICK)
                              : sym_posture_descend(p, most);
        memcpy(p->round + SYM_INDEX(i, nq, 0), p->q, (size_t)nq * sizeof *p->q);
        if (p->round_met[i] == 0.0) sym_posture_keep(p);
    }
    p->starts += n;
}

/* p->tried <- the posture with its angles turned by whole turns towards the guess, within their limits, where that is the
 * same posture: conditions on coordinates, as those of gears, tell one turn from another. */
static void sym_posture_turn(sym_posture *p, const double *q, const double *guess) {
    const sym_system *s = p->system;
    double largest = 1e-12, turned = 0.0;
    int32_t k, i, changed = 0;
    memcpy(p->tried, q, (size_t)s->nq * sizeof *q);
    for (k = 0; k < s->n_segments; ++k) {
        const sym_segment *of = &s->segments[k];
        for (i = of->q; of->kind == SYM_SEGMENT_LINEAR && i < of->q + of->size; ++i) {
            const double near = q[i] - SYM_TURN * nearbyint((q[i] - guess[i]) / SYM_TURN);
            if (p->periodic[i] && p->lower[i] <= near && near <= p->upper[i] && near != q[i]) p->tried[i] = near, changed = 1;
        }
    }
    if (!changed) return;
    sym_posture_error(p, q, p->e);
    for (i = 0; i < p->m; ++i) largest = 2.0 * fabs(p->e[i]) > largest ? 2.0 * fabs(p->e[i]) : largest;
    sym_posture_error(p, p->tried, p->e);
    for (i = 0; i < p->m; ++i) turned = fabs(p->e[i]) > turned ? fabs(p->e[i]) : turned;
    if (turned > largest) memcpy(p->tried, q, (size_t)s->nq * sizeof *q);
}

SYM_EXPORT int32_t sym_posture_nearest(sym_posture *p, const double *guess, const double *near, int32_t n) {
    const sym_system *s = p->system;
    double least = HUGE_VAL;
    int32_t i, found = 0;
    for (i = 0; i < n; ++i) {
        double square;
        if (p->round_met[i] == 0.0) continue;
        sym_posture_turn(p, p->round + SYM_INDEX(i, s->nq, 0), guess);
        sym_chart_coordinates(s, near, p->tried, p->theta);
        square = sym_squared_norm(s->nv, p->theta);
        if (found && !(square < least)) continue;
        least = square, found = 1;
        memcpy(p->q, p->tried, (size_t)s->nq * sizeof *p->q);
    }
    if (!found) return 0;
    sym_posture_error(p, p->q, p->e);
    sym_posture_judge(p, p->e);
    return p->met = 1;
}

SYM_EXPORT int32_t sym_posture_again(sym_posture *p, const double *guess, const double *near, int32_t first, int32_t end,
                                     int32_t most) {
    p->met = 0;
    for (; first < end; first += SYM_POSTURE_ROUND) {
        const int32_t n = end - first < SYM_POSTURE_ROUND ? end - first : SYM_POSTURE_ROUND;
        sym_posture_round(p, guess, first, n, most);
        if (sym_posture_nearest(p, guess, near, n)) break;
    }
    return p->met;
}

SYM_EXPORT void sym_posture_batch_run(sym_posture *p, const sym_posture_batch *batch, int64_t first, int64_t end) {
    const size_t nq = (size_t)p->system->nq;
    const double *own = p->wanted;
    int64_t i;
    for (i = first; i < end; ++i) {
        const double *given = batch->guess + (size_t)i * batch->guess_stride;
        double *guess = batch->q + (size_t)i * nq; /* within the limits */
        p->wanted = batch->wanted + (size_t)i * batch->wanted_stride;
        p->steps = 0, p->starts = 1;
        memcpy(p->q, given, nq * sizeof *p->q);
        memcpy(guess, given, nq * sizeof *p->q);
        if (!sym_posture_descend(p, batch->most) && batch->n_starts > 1) {
            sym_posture_limit(p, guess);
            if (sym_posture_windows(p, guess)) sym_posture_again(p, guess, given, 0, batch->n_starts - 1, batch->most_drawn);
        }
        memcpy(batch->q + (size_t)i * nq, p->q, nq * sizeof *p->q);
        batch->error[i] = p->error, batch->gap[i] = p->gap, batch->met[i] = p->met;
        batch->steps[i] = p->steps, batch->starts[i] = p->starts;
    }
    p->wanted = own;
}
