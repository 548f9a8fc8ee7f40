/* Where functions of x in [0, 1], the events along one step, arrive at zero: docs/theory/simulation.md, section 2, whose
 * equations the numbers in parentheses are. The functions are known by their values alone. */

/* Where all events are evaluated in each step: at unequal distances, so that no oscillation has the same value at all. */
static const double sym_event_nodes[SYM_EVENT_NODES] = {0.0, 0.2319, 0.4876, 0.7541, 1.0};
/* Shares of a step: zeros that are closer are not told apart; intervals of an event that is not smooth, or turns often. */
#define SYM_EVENT_RESOLUTION 1e-9
#define SYM_EVENT_FINE 0.02
/* Share of the values at four neighbouring nodes that their third difference has at most where an event is smooth. */
#define SYM_EVENT_SMOOTH 0.05
/* Where the rate of events is looked at beside a node, and farther from it: shares of a step. Change between two points, as a share of the largest
 * value in the step, of an event that turns often; the shortest such interval. An event is no cubic where its rate at the
 * middle is off by more than the last share. */
#define SYM_EVENT_BESIDE 1e-7
#define SYM_EVENT_FARTHER 0.0137
#define SYM_EVENT_PACE 0.5
#define SYM_EVENT_SHORTEST_PACE 1e-7
#define SYM_EVENT_SMOOTH_RATE 0.5
/* Shares of an event's largest value in the step: below one, what it does is rounding; turns nearer to zero are noted. */
#define SYM_EVENT_ROUNDING 1e-14
#define SYM_EVENT_NEAR 1e-3
/* Evaluations by which one event is followed between two of its zeros in one step, beyond those at the nodes. */
enum { SYM_EVENT_BUDGET = 1000, SYM_EVENT_POINTS = 60, SYM_EVENT_AHEAD = 20 };

typedef struct sym_event_rows { /* (n) each, in sym_event_search.memory */
    double *node[SYM_EVENT_NODES]; /* values at the nodes */
    double *work;
    double *before;                /* a value between the last arrival at zero and the next one, or 0 */
    double *next_x;                /* the next arrival; beyond 1: there is none */
    double *past, *past_value;     /* a point before it */
    double *size;                  /* the largest value at the nodes */
    double *earlier;               /* values at the start of the step before; NaN: they are unknown */
    double *rate[SYM_EVENT_NODES]; /* by x, at the nodes; below 0 where it turns seldom */
    double *pace;                  /* the largest rate by time where it was looked at last */
    double *rounding;              /* changes up to this are rounding, whatever the largest value is */
} sym_event_rows;

static sym_event_rows sym_rows_of_search(const sym_event_search *s) {
    const size_t n = (size_t)s->n;
    double *row = s->memory;
    sym_event_rows rows;
    int32_t k;
    for (k = 0; k < SYM_EVENT_NODES; ++k, row += n) rows.node[k] = row;
    rows.work = row, rows.before = row + n, rows.next_x = row + 2 * n;
    rows.past = row + 3 * n, rows.past_value = row + 4 * n, rows.size = row + 5 * n;
    rows.earlier = row + (SYM_EVENT_EARLIER - SYM_EVENT_NODES) * n;
    for (k = 0; k < SYM_EVENT_NODES; ++k) rows.rate[k] = rows.earlier + (size_t)(1 + k) * n;
    rows.pace = rows.earlier + (size_t)(1 + SYM_EVENT_NODES) * n, rows.rounding = s->memory + SYM_EVENT_UNSURE * n;
    return rows;
}

/* The value of event i at x. Returns 0 or a status. */
static int32_t sym_event_at(const sym_event_search *s, int32_t i, double x, double *value) {
    double *work = sym_rows_of_search(s).work;
    const int32_t status = s->evaluate(s->data, x, work);
    *value = work[i];
    return status;
}

/* Whether an event arrives at zero, in that direction. One that leaves zero arrives nowhere. */
static int32_t sym_arrives_at_zero(int32_t direction, double before, double after) {
    if (direction >= 0 && before < 0.0 && after >= 0.0) return 1;
    return direction <= 0 && before > 0.0 && after <= 0.0;
}

/* Share of a step before an exact zero at which an event that is zero as well rests at zero. */
#define SYM_EVENT_REST 1e-12

/* Steps of the Illinois method in a row by which one end alone moves: then the value there is next to nothing beside the
 * other one, as that of a signal just below zero (1e-308) is, and such steps would hardly move it. */
enum { SYM_EVENT_SAME_END = 6 };

/* The x in (a, b] from which on an event that is monotonic there is at zero or past it, by the Illinois method (regula
 * falsi whose retained end is halved); by bisection where it rests at zero, and from where one end alone moves. Returns 0
 * or a status. */
static int32_t sym_locate_event(const sym_event_search *s, int32_t i, double a, double fa, double b, double fb, double *x) {
    const double before = fa;
    double past = fb;
    int32_t k, moved, side = 0, same = 0, rests = 0;
    for (k = 0; k < 100 && b - a > 4e-16; ++k) {
        const int32_t looks_back = past == 0.0 && !rests;
        double c = looks_back ? b - SYM_EVENT_REST : (fa * b - fb * a) / (fa - fb), f;
        int32_t status;
        if (looks_back && c <= a) break;
        if (!(c > a && c < b) || (same >= SYM_EVENT_SAME_END && !looks_back)) c = 0.5 * (a + b);
        status = sym_event_at(s, i, c, &f);
        if (status != 0) return status;
        if (!(f == f)) return SYM_DIVERGED;
        if (looks_back && f != 0.0) break;
        rests = rests || looks_back;
        moved = (f < 0.0) == (before < 0.0) && f != 0.0 ? 1 : -1;
        if (moved == 1) a = c, fa = f;
        else b = c, fb = past = f;
        if (side == 1 && moved == 1) fb *= 0.5;
        if (side == -1 && moved == -1) fa *= 0.5;
        if (same < SYM_EVENT_SAME_END) same = side == moved ? same + 1 : 1;
        side = moved;
    }
    *x = b;
    return 0;
}

typedef struct sym_event_point {
    double x, f;
} sym_event_point;

typedef struct sym_event_walk { /* one event, followed from left to right over intervals [a, b] */
    int32_t event, left;         /* evaluations that may still be made */
    double longest[SYM_EVENT_NODES - 1]; /* interval between two nodes */
    int32_t n_before, n;         /* points known before a, of which two are kept; points known behind it */
    sym_event_point before[2], a;
    sym_event_point behind[SYM_EVENT_POINTS]; /* the farthest first; the last one is b */
} sym_event_walk;

/* Second divided difference: half the second derivative of a smooth function. What is no number counts as straight. */
static double sym_bend(sym_event_point p, sym_event_point q, sym_event_point r) {
    const double bend = ((r.f - q.f) / (r.x - q.x) - (q.f - p.f) / (q.x - p.x)) / (r.x - p.x);
    return bend == bend ? bend : 0.0;
}

/* The four neighbouring points about [a, b] that are known; fewer at the start of a walk in the last interval. */
static int32_t sym_points_about(const sym_event_walk *w, sym_event_point *points) {
    int32_t before = w->n_before, n = 0, k;
    if (before > 1 && w->n > 1) before = 1;
    for (k = 0; k < before; ++k) points[n++] = w->before[before - 1 - k];
    points[n++] = w->a;
    for (k = w->n - 1; k >= 0 && n < 4; --k) points[n++] = w->behind[k];
    return n;
}

/* The longest interval about x. */
static double sym_longest_interval(const sym_event_walk *w, double x) {
    int32_t k = 0;
    while (k + 2 < SYM_EVENT_NODES && x >= sym_event_nodes[k + 1]) ++k;
    return w->longest[k];
}

/* Whether the event has between a and b no zeros but the one that a change of sign shows. Its curve departs from the chord
 * by an eighth of `departure` at most, (4a), if it is as smooth as the points about it look; then it is monotonic, (4b), or
 * stays away from zero, (4c). */
static int32_t sym_hides_nothing(const sym_event_walk *w, double size, double rounding) {
    const sym_event_point a = w->a, b = w->behind[w->n - 1];
    const double length = b.x - a.x;
    sym_event_point p[4];
    double bend, other, departure;
    int32_t n;
    if (!(a.f == a.f) || !(b.f == b.f)) return 1; /* what is no number has none */
    if (length > sym_longest_interval(w, a.x)) return 0;
    n = sym_points_about(w, p);
    if (n < 3) return 1;
    bend = sym_bend(p[0], p[1], p[2]), other = n > 3 ? sym_bend(p[1], p[2], p[3]) : bend;
    departure = 2.0 * ((fabs(bend) > fabs(other) ? fabs(bend) : fabs(other)) + fabs(other - bend)) * length * length;
    if (departure <= fmax(rounding, SYM_EVENT_ROUNDING * size)) return 1;
    if (a.f == 0.0 || b.f == 0.0 || (a.f > 0.0) != (b.f > 0.0)) return fabs(b.f - a.f) >= 2.0 * departure;
    return fabs(a.f) > departure && fabs(b.f) > departure;
}

/* Halve the interval until it hides nothing. Returns 0 or a status. */
static int32_t sym_shorten_interval(sym_event_search *s, sym_event_walk *w, double size) {
    const double rounding = sym_rows_of_search(s).rounding[w->event];
    while (!sym_hides_nothing(w, size, rounding)) {
        const double length = w->behind[w->n - 1].x - w->a.x;
        sym_event_point m;
        int32_t status;
        if (length <= SYM_EVENT_RESOLUTION || w->n == SYM_EVENT_POINTS) return 0;
        if (w->left-- <= 0) {
            s->unresolved = w->event;
            return 0;
        }
        m.x = w->a.x + 0.5 * length;
        status = sym_event_at(s, w->event, m.x, &m.f);
        if (status != 0) return status;
        w->behind[w->n++] = m;
    }
    return 0;
}

/* a <- a point behind it, up to which nothing is left to look for. */
static void sym_walk_to(sym_event_walk *w, sym_event_point to) {
    w->before[1] = w->before[0], w->before[0] = w->a, w->a = to;
    if (w->n_before < 2) ++w->n_before;
    while (w->n > 0 && w->behind[w->n - 1].x <= to.x) --w->n;
}

/* Note where an event turns at a, if nowhere nearer to zero. */
static void sym_note_touch(sym_event_search *s, const sym_event_walk *w, double size) {
    const double f = w->a.f;
    if (w->n_before == 0 || !((w->before[0].f - f) * (w->behind[w->n - 1].f - f) > 0.0)) return;
    if (!(fabs(f) < SYM_EVENT_NEAR * size)) return;
    if (s->touched < 0 || fabs(f) < s->touched_share * size)
        s->touched = w->event, s->touched_x = w->a.x, s->touched_share = fabs(f) / size;
}

/* Whether the values of event i at four neighbouring nodes are like those of a cubic. */
static int32_t sym_is_smooth(const sym_event_rows *rows, int32_t i, int32_t first) {
    sym_event_point p[4];
    double largest = 0.0, length;
    int32_t k;
    for (k = 0; k < 4; ++k) {
        p[k].x = sym_event_nodes[first + k], p[k].f = rows->node[first + k][i];
        if (fabs(p[k].f) > largest) largest = fabs(p[k].f);
    }
    length = p[3].x - p[0].x;
    return fabs(sym_bend(p[1], p[2], p[3]) - sym_bend(p[0], p[1], p[2])) * length * length <= 27.0 * SYM_EVENT_SMOOTH * largest;
}

/* Rate of event i by its values at two points that are so far apart. */
static double sym_rate_between(const sym_event_rows *rows, int32_t i, double first, double last, double apart) {
    return fabs(last - first) <= rows->rounding[i] ? 0.0 : (last - first) / apart;
}

/* Rates of all events at a node <- by their values beside it. Returns 0 or a status. */
static int32_t sym_look_beside(const sym_event_search *s, const sym_event_rows *rows, int32_t k) {
    const double beside = k + 1 < SYM_EVENT_NODES ? SYM_EVENT_BESIDE : -SYM_EVENT_BESIDE;
    const int32_t status = s->evaluate(s->data, sym_event_nodes[k] + beside, rows->work);
    int32_t i;
    for (i = 0; i < s->n; ++i) rows->rate[k][i] = sym_rate_between(rows, i, rows->node[k][i], rows->work[i], beside);
    return status;
}

/* Whether event i looks like a cubic at the nodes, and has its rate at the middle. */
static int32_t sym_turns_seldom(const sym_event_rows *rows, int32_t i) {
    const double *x = sym_event_nodes, before = x[2] - x[1], behind = x[3] - x[2];
    const double first = (rows->node[2][i] - rows->node[1][i]) / before, last = (rows->node[3][i] - rows->node[2][i]) / behind;
    const double rate = (first * behind + last * before) / (before + behind);
    if (fabs(rows->rate[2][i] - rate) > SYM_EVENT_SMOOTH_RATE * rows->size[i]) return 0;
    return sym_is_smooth(rows, i, 0) && sym_is_smooth(rows, i, 1);
}

/* Share of the step at which instant k is; beyond 1: there is none. */
static double sym_instant_x(const sym_event_search *s, int32_t k) {
    return k < s->n_instants ? (s->instants[k] - s->t) / s->h : 2.0;
}

/* Whether an instant lies in the step. */
static int32_t sym_has_instant(const sym_event_search *s) {
    return sym_instant_x(s, sym_instants_begun(s->instants, s->n_instants, s->t)) <= 1.0;
}

/* A rate that is too fast to be followed may be that of a jump or, where instants show these, of a narrow part at node k alone:
 * rates <- those farther from it where they are less. Returns 0 or a status. */
static int32_t sym_look_farther(const sym_event_search *s, const sym_event_rows *rows, int32_t k) {
    const int32_t narrow = sym_has_instant(s);
    const double followed = narrow ? SYM_EVENT_FINE : SYM_EVENT_SHORTEST_PACE, side = k + 1 < SYM_EVENT_NODES ? 1.0 : -1.0;
    const double x = sym_event_nodes[k] + side * (narrow ? SYM_EVENT_FARTHER : 2.0 * SYM_EVENT_BESIDE);
    int32_t i, fast = 0, status;
    for (i = 0; i < s->n; ++i) fast = fast || fabs(rows->rate[k][i]) * followed > SYM_EVENT_PACE * rows->size[i];
    if (!fast) return 0;
    status = s->evaluate(s->data, x, rows->past_value);
    if (status == 0) status = s->evaluate(s->data, x + side * SYM_EVENT_BESIDE, rows->work);
    for (i = 0; i < s->n; ++i) {
        const double rate = sym_rate_between(rows, i, rows->past_value[i], rows->work[i], side * SYM_EVENT_BESIDE), seen = fabs(rows->rate[k][i]);
        if (seen * followed > SYM_EVENT_PACE * rows->size[i] && fabs(rate) < seen) rows->rate[k][i] = rate;
        rows->past_value[i] = 0.0;
    }
    return status;
}

/* How fast each event changes about the nodes, which are evaluated; of those that turn seldom in the step one look beside
 * the middle node is enough. Returns 0 or a status. */
static int32_t sym_look_at_rates(sym_event_search *s) {
    const sym_event_rows rows = sym_rows_of_search(s);
    int32_t i, k, often = 0, status = sym_look_beside(s, &rows, 2);
    for (i = 0; i < s->n; ++i) often = often || !sym_turns_seldom(&rows, i);
    for (k = 0; k < SYM_EVENT_NODES && often && status == 0; ++k)
        if (k != 2) status = sym_look_beside(s, &rows, k);
    for (k = 0; k < SYM_EVENT_NODES && status == 0; ++k)
        if (often || k == 2) status = sym_look_farther(s, &rows, k);
    for (i = 0; i < s->n; ++i) {
        const int32_t seldom = sym_turns_seldom(&rows, i);
        rows.pace[i] = fabs(rows.rate[2][i]) / s->h;
        for (k = 0; k < SYM_EVENT_NODES; ++k) {
            if (often && fabs(rows.rate[k][i]) / s->h > rows.pace[i]) rows.pace[i] = fabs(rows.rate[k][i]) / s->h;
            rows.rate[k][i] = seldom ? -1.0 : fabs(rows.rate[k][i]);
        }
    }
    return status;
}

/* The longest intervals in which event i is looked at between the nodes. */
static void sym_set_longest_intervals(sym_event_search *s, sym_event_walk *w) {
    const sym_event_rows rows = sym_rows_of_search(s);
    const int32_t i = w->event, seldom = rows.rate[0][i] < 0.0;
    int32_t k;
    for (k = 0; k + 1 < SYM_EVENT_NODES; ++k) {
        const double a = rows.rate[k][i], b = rows.rate[k + 1][i], rate = a > b ? a : b;
        double longest = seldom ? 1.0 : SYM_EVENT_FINE;
        if (longest * rate > SYM_EVENT_PACE * rows.size[i] && rows.size[i] > 0.0) longest = SYM_EVENT_PACE * rows.size[i] / rate;
        if (longest < SYM_EVENT_SHORTEST_PACE) longest = SYM_EVENT_SHORTEST_PACE, s->unresolved = i;
        w->longest[k] = s->longest < longest ? s->longest : longest;
    }
}

/* Points behind a <- the next nodes and instants, of one kind or the other. Returns 0 or a status. */
static int32_t sym_look_ahead(const sym_event_search *s, sym_event_walk *w) {
    const sym_event_rows rows = sym_rows_of_search(s);
    sym_event_point next[SYM_EVENT_AHEAD];
    int32_t node = 1, n = 0, k = sym_instants_begun(s->instants, s->n_instants, s->t + w->a.x * s->h), i;
    while (node < SYM_EVENT_NODES && sym_event_nodes[node] <= w->a.x) ++node;
    while (k < s->n_instants && sym_instant_x(s, k) <= w->a.x) ++k;
    while (node < SYM_EVENT_NODES && n < SYM_EVENT_AHEAD) {
        const double at_node = sym_event_nodes[node], at_instant = sym_instant_x(s, k);
        sym_event_point *point = &next[n++];
        point->x = at_instant < at_node ? at_instant : at_node;
        if (at_instant < at_node) {
            const int32_t status = sym_event_at(s, w->event, at_instant, &point->f);
            if (status != 0) return status;
        } else {
            point->f = rows.node[node++][w->event];
        }
        while (k < s->n_instants && sym_instant_x(s, k) <= point->x) ++k;
    }
    for (i = 0; i < n; ++i) w->behind[i] = next[n - 1 - i];
    w->n = n;
    return 0;
}

/* The next arrival of event i <- the one after it. Where it has arrived its value is zero, whatever rounding made of it.
 * Returns 0 or a status. */
static int32_t sym_seek_arrival(sym_event_search *s, int32_t i, double value) {
    const sym_event_rows rows = sym_rows_of_search(s);
    const double size = rows.size[i];
    sym_event_walk w;
    int32_t status;
    w.event = i, w.left = SYM_EVENT_BUDGET;
    sym_set_longest_intervals(s, &w);
    w.a.x = rows.next_x[i], w.a.f = value;
    w.n_before = w.a.x > rows.past[i], w.before[0].x = rows.past[i], w.before[0].f = rows.past_value[i];
    rows.next_x[i] = 2.0;
    for (w.n = 0;;) {
        sym_event_point to;
        status = w.n > 0 ? 0 : sym_look_ahead(s, &w);
        if (status != 0 || w.n == 0) return status;
        status = sym_shorten_interval(s, &w, size);
        if (status != 0) return status;
        sym_note_touch(s, &w, size);
        to = w.behind[w.n - 1];
        if (sym_arrives_at_zero(0, w.a.f, to.f)) {
            const int32_t counts = sym_arrives_at_zero(s->direction[i], w.a.f, to.f);
            status = sym_locate_event(s, i, w.a.x, w.a.f, to.x, to.f, &to.x);
            if (status != 0) return status;
            to.f = 0.0;
            if (to.x > 1.0 - SYM_EVENT_RESOLUTION) rows.node[SYM_EVENT_NODES - 1][i] = 0.0;
            if (counts) {
                rows.next_x[i] = to.x, rows.before[i] = w.a.f;
                rows.past[i] = w.a.x, rows.past_value[i] = w.a.f;
                return 0;
            }
        }
        sym_walk_to(&w, to);
    }
}

SYM_EXPORT int32_t sym_event_search_next(sym_event_search *s, int32_t *which, double *x) {
    const sym_event_rows rows = sym_rows_of_search(s);
    int32_t i, first = -1;
    if (s->taken >= 0) {
        const int32_t status = sym_seek_arrival(s, s->taken, 0.0);
        if (status != 0) return status;
    }
    for (i = 0; i < s->n; ++i)
        if (rows.next_x[i] <= 1.0 && (first < 0 || rows.next_x[i] < rows.next_x[first])) first = i;
    s->taken = *which = first, *x = first < 0 ? 2.0 : rows.next_x[first];
    return 0;
}

/* The event taken last is looked for from x on, where its value counts as zero. */
static void sym_event_search_pass(sym_event_search *s, double x) { sym_rows_of_search(s).next_x[s->taken] = x; }

SYM_EXPORT int32_t sym_event_is_met(const sym_event_search *s, int32_t i, double x, double value) {
    const sym_event_rows rows = sym_rows_of_search(s);
    return rows.next_x[i] > x && rows.next_x[i] <= x + SYM_EVENT_RESOLUTION &&
           sym_arrives_at_zero(s->direction[i], rows.before[i], value);
}

/* Steps that are short: shares of a second, and changes of a coordinate [rad or m]. */
#define SYM_EVENT_SHORT_TIME 0.02
#define SYM_EVENT_SHORT_WAY 0.05
/* How many times farther from zero than it changes in two short steps an event has to be where it is not looked at within. */
#define SYM_EVENT_FAR 8.0
/* Change of a coordinate between two looks at the events, which may be periodic in it [rad or m], and the shortest share of
 * a step that this may come to. */
#define SYM_EVENT_TURN 0.7
#define SYM_EVENT_SHORTEST 0.004

/* Of steps whose events are far, one in so many has their rates looked at. */
#define SYM_EVENT_LOOKS 8

SYM_EXPORT void sym_event_search_set_step(sym_event_search *s, double t, double h, double way, int64_t step) {
    const double longest = way > SYM_EVENT_TURN ? SYM_EVENT_TURN / way : 1.0;
    s->t = t, s->h = h, s->looks = step % SYM_EVENT_LOOKS == 0;
    s->short_step = h <= SYM_EVENT_SHORT_TIME && way <= SYM_EVENT_SHORT_WAY;
    s->longest = longest > SYM_EVENT_SHORTEST ? longest : SYM_EVENT_SHORTEST;
}

/* Whether no instant is in the step, and all events are so far from zero, at the ends of this step and of the one before and by the rate that they had when
 * it was looked at last, that they need no look within. */
static int32_t sym_all_events_are_far(const sym_event_search *s, const sym_event_rows *rows) {
    int32_t i;
    if (sym_has_instant(s)) return 0;
    for (i = 0; i < s->n; ++i) {
        const double a = rows->earlier[i], b = rows->before[i], c = rows->node[SYM_EVENT_NODES - 1][i];
        const double low = a < b ? (a < c ? a : c) : (b < c ? b : c), high = a > b ? (a > c ? a : c) : (b > c ? b : c);
        const double nearest = low > 0.0 ? low : -high; /* below 0 where the sign changes */
        if (!(a == a) || !(nearest > SYM_EVENT_FAR * (high - low)) || nearest < rows->pace[i] * s->h) return 0;
    }
    return 1;
}

SYM_EXPORT int32_t sym_event_search_begin(sym_event_search *s) {
    const sym_event_rows rows = sym_rows_of_search(s);
    int32_t i, k, distant, status = s->evaluate(s->data, 1.0, rows.node[SYM_EVENT_NODES - 1]);
    s->taken = s->touched = s->unresolved = -1;
    if (status != 0) return status;
    memcpy(rows.before, rows.node[0], (size_t)s->n * sizeof(double));
    distant = s->short_step && sym_all_events_are_far(s, &rows);
    if (distant && s->looks) {
        status = sym_look_beside(s, &rows, SYM_EVENT_NODES - 1);
        if (status != 0) return status;
        for (i = 0; i < s->n; ++i) rows.pace[i] = fabs(rows.rate[SYM_EVENT_NODES - 1][i]) / s->h;
        distant = sym_all_events_are_far(s, &rows);
    }
    memcpy(rows.earlier, rows.before, (size_t)s->n * sizeof(double));
    for (i = 0; i < s->n; ++i) rows.next_x[i] = 2.0;
    if (distant) return 0;
    for (k = s->start_changes ? 0 : 1; k + 1 < SYM_EVENT_NODES; ++k) {
        status = s->evaluate(s->data, sym_event_nodes[k], rows.node[k]);
        if (status != 0) return status;
    }
    for (i = 0; i < s->n; ++i) {
        rows.size[i] = rows.next_x[i] = rows.past[i] = rows.past_value[i] = 0.0;
        for (k = 0; k < SYM_EVENT_NODES; ++k)
            if (fabs(rows.node[k][i]) > rows.size[i]) rows.size[i] = fabs(rows.node[k][i]);
    }
    status = sym_look_at_rates(s);
    if (status != 0) return status;
    for (i = 0; i < s->n; ++i) {
        const double before = rows.before[i], start = rows.node[0][i];
        if (sym_arrives_at_zero(s->direction[i], before, start)) continue; /* by an input that changes there: at x = 0 */
        status = sym_seek_arrival(s, i, sym_arrives_at_zero(0, before, start) || before == 0.0 ? 0.0 : start);
        if (status != 0) return status;
    }
    return 0;
}
