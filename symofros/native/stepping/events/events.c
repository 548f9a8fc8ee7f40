/* Events of a run: zeros of formulas along the dense output, found by event_search.c. */

static int32_t sym_watch_shared_load(sym_run *r, double *values);
static double *sym_load_shared(const sym_system *s);

/* Values of all events at the evaluation point. Returns 0 or a status. */
static int32_t sym_event_values(sym_run *r, double *values) {
    const sym_system *s = r->system;
    int32_t i;
    if (s->events_of_reactions) {
        const int32_t status = sym_evaluate_acceleration(r);
        if (status != 0) return status;
    } else if (!s->events_free_of_inputs && sym_evaluate_inputs(r->system) != 0) {
        return SYM_CALLBACK_FAILED;
    }
    sym_evaluate(&s->events);
    for (i = 0; i < s->n_events; ++i) values[i] = s->event_terminal[i] == -1 ? 1.0 : s->events.out[0][i];
    return s->n_contacts > 0 && r->actions != NULL && *sym_load_shared(s) != 0.0 ? sym_watch_shared_load(r, values) : 0;
}

typedef struct sym_event_step { /* the step just made */
    sym_run *run;
    sym_workspace *memory;
    double h;
    int32_t *dense_ready;
} sym_event_step;

/* Values of all events at x of the step, the sample that holds from its start on included. Returns 0 or a status. */
static int32_t sym_event_values_within_step(void *data, double x, double *values) {
    const sym_event_step *step = (const sym_event_step *)data;
    const int32_t status = sym_load_state_within_step(step->run, step->memory, step->h, step->dense_ready, x);
    return status != 0 ? status : sym_event_values(step->run, values);
}

/* Record the evaluation point as an event, if it is still looked for. */
static void sym_record_event(sym_run *r, int32_t which) {
    const sym_system *s = r->system;
    const int64_t row = r->n_event_records;
    if (s->event_terminal[which] == -1) return;
    if (s->event_terminal[which] == -2) s->event_terminal[which] = -1;
    ++r->n_event_records;
    r->event_t[row] = *s->t;
    r->event_index[row] = which;
    memcpy(r->event_q + row * s->nq, s->q, (size_t)s->nq * sizeof(double));
    memcpy(r->event_v + row * s->nv, s->v, (size_t)s->nv * sizeof(double));
}

/* Whether event i has been found at the evaluation point. */
static int32_t sym_is_recorded(const sym_run *r, int32_t i) {
    int64_t row = r->n_event_records;
    while (row > r->first_met && r->event_t[row - 1] >= *r->system->t)
        if (r->event_index[--row] == i) return 1;
    return 0;
}

/* Record the events that are met where the step is cut, at the evaluation point, and were not found there by rounding: the
 * next step begins behind them. Returns 0 or a status. */
static int32_t sym_record_events_at_cut(sym_run *r, sym_event_search *search, double x) {
    const sym_system *s = r->system;
    double *values = r->event_values; /* evaluated again at the start of the next step */
    int32_t i, status = sym_event_values(r, values);
    if (status != 0) return status;
    for (i = 0; i < s->n_events; ++i)
        if (!sym_is_recorded(r, i) && sym_event_is_met(search, i, x, values[i])) sym_record_event(r, i);
    return 0;
}

/* Gap [m, rad] and force [N, N m] of a contact that are rounding. */
#define SYM_TOUCHING 1e-9
/* By which a rim or segment that lies along its surface may pass it, while others carry it, until it is known that none does [m]. */
#define SYM_LIES (2.0 * SYM_TOUCHING)

/* Whether contacts that rest are where they can begin: not penetrated, or pressing. Returns 0 or a status. */
static int32_t sym_check_contacts(const sym_run *r) {
    const sym_system *s = r->system;
    int32_t i;
    for (i = 0; i < s->n_events && r->actions != NULL; ++i) {
        const int32_t opens = r->actions->opens[i];
        if (opens < 0) continue;
        if (s->event_direction[i] * r->event_values[i] > SYM_TOUCHING) return SYM_WRONG_CONTACT;
        if (r->event_values[opens] < -SYM_TOUCHING) return SYM_WRONG_CONTACT;
    }
    return 0;
}

/* Values of the events at the present state, from which a search may begin; those before are unknown. Returns 0 or a
 * status. */
static int32_t sym_restart_events(sym_run *r) {
    const int32_t n = r->system->n_events;
    int32_t i;
    if (n == 0) return 0;
    for (i = 0; i < n; ++i) r->event_values[SYM_EVENT_EARLIER * n + i] = NAN;
    sym_load_state(r);
    return sym_event_values(r, r->event_values);
}

/* Errors that a state of fixed steps has at least; those of adaptive steps are rtol and atol. */
#define SYM_EVENT_RTOL 1e-9
#define SYM_EVENT_ATOL 1e-12
/* Errors of a state by rounding. */
#define SYM_EVENT_STATE_ROUNDING 1e-14

/* errors (n) += what errors of the entries of y at x change of all events, which have the values (n) there. The errors' signs alternate
 * after signs_length entries; below zero the first ones are negative. Returns 0 or a status. */
static int32_t sym_add_errors_of_events(sym_event_step *step, double x, double rtol, double atol, int32_t signs_length, const double *values, double *errors) {
    sym_run *r = step->run;
    sym_workspace *w = step->memory;
    double *moved = r->event_values + (SYM_EVENT_ROWS - 1) * r->system->n_events;
    const int32_t length = signs_length < 0 ? -signs_length : signs_length;
    int32_t l, status = sym_dense_output(r, w, step->h, step->dense_ready, x, w->stage);
    if (status != 0) return status;
    sym_state_magnitudes(r, w->magnitude);
    for (l = 0; l < 2 * r->system->nv; ++l) w->stage[l] += (l / length % 2 == (signs_length > 0) ? -1.0 : 1.0) * (atol + rtol * w->magnitude[l]);
    sym_load_chart_state(r, (r->t + x * step->h) * (1.0 + (signs_length > 0 ? DBL_EPSILON : -DBL_EPSILON)), w->stage);
    status = sym_event_values(r, moved);
    for (l = 0; l < r->system->n_events; ++l) errors[l] += fabs(moved[l] - values[l]);
    return status;
}

/* Whether event i is at x no farther from zero than errors of the entries of y may move it, their signs alternating one way
 * or the other. Returns 0 or a status. */
static int32_t sym_event_is_at_zero(sym_event_step *step, int32_t i, double x, double rtol, double atol, int32_t *is) {
    const int32_t n = step->run->system->n_events;
    double *values = step->run->event_values + (SYM_EVENT_ROWS - 2) * n, *errors = step->run->event_values + (SYM_EVENT_ROWS - 3) * n;
    int32_t way, status = sym_event_values_within_step(step, x, values);
    memset(errors, 0, (size_t)n * sizeof *errors);
    for (way = -1; way <= 1 && status == 0; way += 2) status = sym_add_errors_of_events(step, x, rtol, atol, way, values, errors);
    *is = fabs(values[i]) <= errors[i];
    return status;
}

/* The event at which the first mode of a ball ends: after those of friction that sticks. */
static int32_t sym_first_contact_event(const sym_run *r) { return r->actions->first_mode + r->system->n_sticking; }

/* Whether event i is of a rigid contact that has been settled where the step begins. */
static int sym_settled_now(const sym_run *r, int32_t i) {
    return r->system->n_contacts > 0 && i >= sym_first_contact_event(r) && r->acted_at[i] >= r->t;
}

/* Whether the action of an event sets speeds, or lets constraints strike: nothing then goes on through its zero. */
static int32_t sym_sets_speeds(const sym_run *r, int32_t which) {
    const sym_actions *a = r->actions;
    int32_t i, sets = a->restitution[which] >= 0.0;
    for (i = 0; i < a->n_assignments; ++i) sets |= a->assignments[i].event == which && a->assignments[i].is_speed;
    return sets;
}

/* Whether the contact opens where the step begins that comes to rest by event i. */
static int sym_opens_now(const sym_run *r, int32_t i) { return r->actions->opens[i] >= 0 && r->acted_at[r->actions->opens[i]] == r->t; }

/* Whether event i is zero where the step begins, as its bodies touch there since an impact, an opening or the choice of modes. */
static int sym_begins_at_zero(const sym_run *r, int32_t i) {
    return r->actions != NULL && (sym_settled_now(r, i) || sym_opens_now(r, i) || (r->acted_at[i] == r->t && sym_sets_speeds(r, i)));
}

/* Changes that are rounding, of events that are zero where the step begins, for the search: near to zero they have no digits, so
 * that their largest value in the step is no measure of it. Returns 0 or a status. */
static int32_t sym_measure_rounding(sym_event_step *step) {
    const sym_run *r = step->run;
    const int32_t n = r->system->n_events;
    double *rounding = r->event_values + SYM_EVENT_UNSURE * n, *values = r->event_values + (SYM_EVENT_ROWS - 2) * n;
    int32_t i, signs_length, some = 0, status;
    for (i = 0; i < n; ++i) some |= sym_begins_at_zero(r, i), rounding[i] = 0.0;
    if (!some) return 0;
    status = sym_event_values_within_step(step, 0.0, values);
    /* Entries that cancel with some signs do not with others. */
    for (signs_length = 1; signs_length < 4 * r->system->nv && status == 0; signs_length *= 2)
        status = sym_add_errors_of_events(step, 0.0, SYM_EVENT_STATE_ROUNDING, SYM_EVENT_STATE_ROUNDING, signs_length, values, rounding);
    for (i = 0; i < n; ++i)
        if (!sym_begins_at_zero(r, i)) rounding[i] = 0.0;
    return status;
}

/* Share of a step after which a ball that rises from its surface is above it by more than rounding. */
#define SYM_EVENT_RISES 1e-6

/* Whether event i is met at x by rounding alone: a strike has left the bodies on each other, or a little apart, where the step
 * begins, and half way to x they have not moved apart by more; a ball of a rigid contact is above zero soon after x, or not
 * beyond it at the end of the step either. *past: behind which the search goes on, so that a ball that stays within rounding for a
 * part of the step is not asked about at each zero of its rounding; 0: the event is met. Returns 0 or a status. */
static int32_t sym_event_is_rounding(sym_event_step *step, int32_t i, double x, double *past) {
    const sym_run *r = step->run;
    const double end = r->event_values[(SYM_EVENT_NODES - 1) * r->system->n_events + i];
    double *values = r->event_values + (SYM_EVENT_ROWS - 1) * r->system->n_events, behind[2] = {x + SYM_EVENT_RISES, fmax(2.0 * x, SYM_EVENT_RESOLUTION)};
    int32_t status, k, is, stays = 1;
    *past = 0.0;
    if (!sym_begins_at_zero(r, i)) return 0;
    status = sym_event_is_at_zero(step, i, 0.5 * x, SYM_EVENT_STATE_ROUNDING, SYM_EVENT_STATE_ROUNDING, &is);
    if (status != 0 || !is) return status;
    if (sym_settled_now(r, i) && end < 0.0) status = sym_event_is_at_zero(step, i, 1.0, SYM_EVENT_STATE_ROUNDING, SYM_EVENT_STATE_ROUNDING, &stays);
    if (stays) *past = behind[1];
    for (k = 0; k < 2 && !stays && status == 0; ++k) {
        if (!(behind[k] < 1.0 && behind[k] > *past)) continue;
        status = sym_event_values_within_step(step, behind[k], values);
        if (values[i] > 0.0) *past = behind[k];
        else if (k == 0) break;
    }
    return status;
}

/* Whether the step begins as bodies leave a contact that can come to rest, near to which they turn then. */
static int sym_leaves_contact(const sym_run *r, int32_t i) {
    if (r->actions == NULL) return 0;
    return sym_settled_now(r, i) || sym_opens_now(r, i) || (r->actions->opens[i] >= 0 && r->acted_at[i] == r->t);
}

/* Whether event i is of a rim or segment that lies along its surface: other contacts carry it, near to zero. */
static int sym_lies_along(const sym_run *r, int32_t i) {
    const int32_t which = r->actions == NULL || r->system->n_contacts == 0 ? -1 : i - sym_first_contact_event(r);
    return which >= 0 && r->par[r->system->contacts[which / 2].apart] >= SYM_LIES;
}

/* Keep what was noted of the events of a step, the first of each kind: one that turns at x nearer to zero than the errors of
 * the state let it be known, one that was not followed. Returns 0 or a status. */
static int32_t sym_keep_event_notes(sym_event_step *step, const sym_event_search *search) {
    sym_run *r = step->run;
    const int32_t i = search->touched;
    const double rtol = r->adaptive ? r->rtol : SYM_EVENT_RTOL, atol = r->adaptive ? r->atol : SYM_EVENT_ATOL;
    double past;
    int32_t status, is_zero = 0;
    if (r->unresolved_event < 0 && search->unresolved >= 0)
        r->unresolved_event = search->unresolved, r->unresolved_t = r->t;
    if (r->touched_event >= 0 || i < 0 || sym_leaves_contact(r, i) || sym_lies_along(r, i)) return 0;
    status = sym_event_is_rounding(step, i, search->touched_x, &past);
    if (status != 0 || past > 0.0) return status;
    status = sym_event_is_at_zero(step, i, search->touched_x, rtol, atol, &is_zero);
    if (status == 0 && is_zero) r->touched_event = i, r->touched_t = r->t + search->touched_x * step->h;
    return status;
}

/* The largest way of a coordinate in the step just made, by the speeds at its ends [rad or m]. */
static double sym_way_of_step(const sym_run *r, const sym_workspace *w, double h) {
    const int32_t nv = r->system->nv;
    double largest = 0.0;
    int32_t l;
    for (l = 0; l < nv; ++l) {
        const double first = h * fabs(r->v[l]), last = h * fabs(w->y1[nv + l]);
        if (first > largest) largest = first;
        if (last > largest) largest = last;
    }
    return largest;
}

/* Shares of a step: two points nearer than the first are not told apart; what stays up to the second has been at rest there. */
#define SYM_EVENT_SOON 1e-9
#define SYM_EVENT_STAYS 1e-3
/* By how much what moves off grows in twice the time: between those of t and of t^2. */
#define SYM_EVENT_FROM_REST 3.0

typedef struct sym_departure { /* how an event leaves the value that it has where a step begins */
    int32_t way, from_rest; /* 1 rising, -1 falling, 0 not at all; whether it does so faster than in proportion to time */
    double stays, seen;     /* up to where it stays, and from where on it has left by more than rounding */
} sym_departure;

/* Whether event i is at x of the step elsewhere than at its begin, by more than rounding, and how far. Returns 0 or a status. */
static int32_t sym_has_left(sym_event_step *step, int32_t i, double begin, double x, int32_t *left, double *change) {
    const int32_t n = step->run->system->n_events;
    const double *values = step->run->event_values + (SYM_EVENT_ROWS - 2) * n, *errors = step->run->event_values + (SYM_EVENT_ROWS - 3) * n;
    const int32_t status = sym_event_is_at_zero(step, i, x, SYM_EVENT_STATE_ROUNDING, SYM_EVENT_STATE_ROUNDING, left);
    *change = values[i] - begin, *left = fabs(*change) > errors[i];
    return status;
}

/* How event i leaves the value that it has where the step begins, up to x. Returns 0 or a status. */
static int32_t sym_find_departure(sym_event_step *step, int32_t i, double x, sym_departure *found) {
    double *values = step->run->event_values + (SYM_EVENT_ROWS - 2) * step->run->system->n_events, begin, change = 0.0, nearest = 0.0;
    int32_t left = 0, status = sym_event_values_within_step(step, 0.0, values);
    begin = values[i];
    for (found->seen = x; status == 0; x *= 0.5) {
        status = sym_has_left(step, i, begin, x, &left, &change);
        if (!left || x <= SYM_EVENT_SOON) break;
        nearest = change, found->seen = x;
    }
    found->way = (nearest > 0.0) - (nearest < 0.0), found->stays = 0.0;
    found->from_rest = nearest * change < 0.0 || fabs(nearest) > SYM_EVENT_FROM_REST * fabs(change);
    if (left || found->way == 0 || x < SYM_EVENT_STAYS) return status;
    for (found->stays = x; found->seen - found->stays > SYM_EVENT_SOON && status == 0;) {
        x = 0.5 * (found->stays + found->seen);
        status = sym_has_left(step, i, begin, x, &left, &change);
        *(left ? &found->seen : &found->stays) = x;
    }
    return status;
}

/* Whether the action of event i may be missed, as it is at zero where the step begins, (4e), (4f): it has acted there, its contact has
 * opened there, or the run has begun at zero. */
static int32_t sym_may_pass_unseen(const sym_run *r, int32_t i, double begin) {
    const sym_actions *a = r->actions;
    const int32_t direction = r->system->event_direction[i], strikes = sym_sets_speeds(r, i);
    if (!a->acts[i] || direction == 0 || r->system->event_terminal[i] == -1) return 0;
    if (r->acted_at[i] == r->t) return strikes;
    if (direction * begin < 0.0) return 0; /* on this side: the search finds it */
    if (sym_opens_now(r, i)) return 1;
    return r->acted_at[i] == -HUGE_VAL && (strikes || (r->acted_at[r->system->n_events] == r->t && r->system->event_terminal[i] != 1));
}

/* *lost: the first event whose action is missed up to x, since it is at zero where the step begins and goes on through it, (4e), (4f);
 * -1: there is none. One that has just acted is missed only if it sets off from rest: else its action lets it pass. *at: where it acts.
 * Returns 0 or a status. */
static int32_t sym_find_lost_event(sym_event_step *step, double x, int32_t *lost, double *at) {
    const sym_run *r = step->run;
    int32_t i, status = 0, at_zero;
    int64_t row;
    for (i = 0, *lost = -1; r->actions != NULL && i < r->actions->first_mode && *lost < 0 && status == 0; ++i) {
        const double begin = r->event_values[i];
        sym_departure leaves;
        if (!sym_may_pass_unseen(r, i, begin)) continue;
        status = sym_event_is_at_zero(step, i, 0.0, SYM_EVENT_RTOL, SYM_EVENT_ATOL, &at_zero);
        if (status != 0 || !at_zero) continue;
        status = sym_find_departure(step, i, x, &leaves);
        if (status != 0 || leaves.way * r->system->event_direction[i] <= 0 || (r->acted_at[i] == r->t && !leaves.from_rest)) continue;
        for (row = r->first_met; row < r->n_event_records && r->event_index[row] != i;) ++row;
        if (row < r->n_event_records && r->event_t[row] <= r->t + leaves.seen * step->h) continue; /* found beside the begin */
        *lost = i, *at = r->acted_at[i] == r->t ? 0.0 : leaves.stays;
    }
    return status;
}

/* An event that acts at x of the step has been missed: what has been found behind it is given up. Returns 0 or a status. */
static int32_t sym_go_back_to_lost_event(sym_event_step *step, int32_t lost, double x) {
    sym_run *r = step->run;
    int32_t status;
    while (r->n_event_records > r->first_met && r->event_t[r->n_event_records - 1] >= r->t + x * step->h) {
        int32_t *found = r->system->event_terminal + r->event_index[--r->n_event_records];
        if (*found == -1) *found = -2;
    }
    r->terminal_event = lost;
    if (x == 0.0) sym_load_start(r);
    status = x == 0.0 ? 0 : sym_load_state_within_step(r, step->memory, step->h, step->dense_ready, x);
    if (status == 0) sym_record_event(r, lost);
    return status;
}

/* Events of the step just made, recorded in the order of time, up to the first terminal one or as many as fit: *stop_x is
 * where the step is cut then, else beyond 1. r->event_values becomes the values at the end, of a step that is not cut.
 * Returns 0 or a status. */
static int32_t sym_find_events(sym_run *r, sym_workspace *w, double h, int32_t *dense_ready, double *stop_x) {
    sym_system *s = r->system;
    sym_event_step step = {r, w, h, dense_ready};
    sym_event_search search;
    double last_x = 2.0, lost_x = 0.0;
    int32_t status, lost = -1;
    *stop_x = 2.0, r->terminal_event = -1, r->first_met = r->n_event_records;
    search.n = s->n_events, search.direction = s->event_direction, search.memory = r->event_values;
    sym_event_search_set_step(&search, r->t, h, sym_way_of_step(r, w, h), r->steps < r->n_from ? 0 : r->steps - r->n_from);
    search.evaluate = sym_event_values_within_step, search.data = &step;
    search.n_instants = s->n_event_instants, search.instants = s->event_instants;
    search.start_changes = !s->events_free_of_inputs && s->nu > 0;
    status = sym_measure_rounding(&step);
    if (status == 0) status = sym_event_search_begin(&search);
    while (status == 0) {
        double x, past;
        int32_t which;
        status = sym_event_search_next(&search, &which, &x);
        if (status != 0 || which < 0 || x > *stop_x) break;
        status = sym_event_is_rounding(&step, which, x, &past);
        if (status != 0) break;
        if (past > 0.0) {
            sym_event_search_pass(&search, past);
            continue;
        }
        if (x != last_x && r->n_event_records + s->n_events > r->event_capacity) {
            *stop_x = last_x;
            break;
        }
        last_x = x;
        if (s->event_terminal[which] > 0 && r->terminal_event < 0) r->terminal_event = which, *stop_x = x;
        status = sym_load_state_within_step(r, w, h, dense_ready, x);
        if (status == 0) sym_record_event(r, which);
    }
    if (status == 0) status = sym_find_lost_event(&step, fmin(*stop_x, 1.0), &lost, &lost_x);
    if (status == 0 && lost < 0) status = sym_keep_event_notes(&step, &search);
    if (status != 0) return status;
    if (lost >= 0) return *stop_x = lost_x, sym_go_back_to_lost_event(&step, lost, lost_x);
    if (*stop_x > 1.0) {
        memcpy(r->event_values, r->event_values + (SYM_EVENT_NODES - 1) * s->n_events, (size_t)s->n_events * sizeof(double));
        return 0;
    }
    status = sym_load_state_within_step(r, w, h, dense_ready, *stop_x);
    return status != 0 ? status : sym_record_events_at_cut(r, &search, *stop_x);
}
