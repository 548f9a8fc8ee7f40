/* Where functions of x in [0, 1], the events along one step, arrive at zero (docs/theory/simulation.md, section 2). The
 * functions are known by their values alone. */

/* Where all events are evaluated in each step: at unequal distances, so that no oscillation has the same value at all. */
static const double sym_event_nodes[SYM_EVENT_NODES] = {0.0, 0.2319, 0.4876, 0.7541, 1.0};
/* Zeros that are closer than this share of a step are not told apart. */
#define SYM_EVENT_RESOLUTION 1e-9
/* Evaluations by which one event is followed in one step, beyond those at the nodes. */
enum { SYM_EVENT_BUDGET = 1000 };
/* Share of an event's largest value in the step below which what it does is rounding. */
#define SYM_EVENT_ROUNDING 1e-14

typedef struct sym_event_rows { /* (n) each, in sym_event_search.memory */
    double *node[SYM_EVENT_NODES]; /* values at the nodes */
    double *work;
    double *value;                 /* before the next arrival: at the one before, or at the start */
    double *next_x, *next_value;   /* of the next arrival at zero; beyond 1: there is none */
    double *size;                  /* its largest value at the nodes */
} sym_event_rows;

static sym_event_rows sym_rows_of_search(const sym_event_search *s) {
    double *row = s->memory;
    sym_event_rows rows;
    int32_t k;
    for (k = 0; k < SYM_EVENT_NODES; ++k, row += s->n) rows.node[k] = row;
    rows.work = row, rows.value = row + s->n, rows.next_x = row + 2 * s->n;
    rows.next_value = row + 3 * s->n, rows.size = row + 4 * s->n;
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

/* Second divided difference: half the second derivative of a smooth function. */
static double sym_bend(double a, double fa, double b, double fb, double c, double fc) {
    return ((fc - fb) / (c - b) - (fb - fa) / (b - a)) / (c - a);
}

/* A bound of |second divided difference| between the nodes k and k + 1, by the differences about it and how they vary. */
static double sym_bend_between_nodes(const sym_event_rows *rows, int32_t i, int32_t k) {
    double bend[SYM_EVENT_NODES], largest = 0.0, varies = 0.0;
    int32_t j;
    for (j = 1; j + 1 < SYM_EVENT_NODES; ++j)
        bend[j] = sym_bend(sym_event_nodes[j - 1], rows->node[j - 1][i], sym_event_nodes[j], rows->node[j][i],
                           sym_event_nodes[j + 1], rows->node[j + 1][i]);
    for (j = 1; j + 1 < SYM_EVENT_NODES; ++j) {
        if ((j == k || j == k + 1) && fabs(bend[j]) > largest) largest = fabs(bend[j]);
        if (j > 1 && j - 1 <= k + 1 && j >= k && fabs(bend[j] - bend[j - 1]) > varies) varies = fabs(bend[j] - bend[j - 1]);
    }
    return largest + varies;
}

/* Whether an event with those values at the ends of an interval, its curve departing from the chord by an eighth of
 * `departure` at most where it is as smooth as it looks, has the zeros that its ends show and no others: it is monotonic,
 * (4a), or stays away from zero, (4b). What is no number has none. */
static int32_t sym_hides_nothing(double fa, double fb, double departure) {
    if (!(fa == fa) || !(fb == fb) || fabs(fb - fa) >= 2.0 * departure) return 1;
    return (fa > departure && fb > departure) || (fa < -departure && fb < -departure);
}

/* The x in (a, b] from which on an event that is monotonic there is at zero or past it, by the Illinois method (regula
 * falsi whose retained end is halved), and its value at x. Returns 0 or a status. */
static int32_t sym_locate_event(sym_event_search *s, int32_t i, double a, double fa, double b, double fb, double *x,
                                double *fx) {
    const double before = fa;
    int32_t k, side = 0;
    *fx = fb;
    for (k = 0; k < 100 && b - a > 4e-16 && *fx != 0.0; ++k) {
        double c = (fa * b - fb * a) / (fa - fb), f;
        int32_t status;
        if (!(c > a && c < b)) c = 0.5 * (a + b);
        status = sym_event_at(s, i, c, &f);
        if (status != 0) return status;
        if (!(f == f)) return SYM_DIVERGED;
        if ((f < 0.0) == (before < 0.0) && f != 0.0) {
            a = c, fa = f;
            if (side == 1) fb *= 0.5;
            side = 1;
        } else {
            b = c, fb = *fx = f;
            if (side == -1) fa *= 0.5;
            side = -1;
        }
    }
    *x = b;
    return 0;
}

typedef struct sym_event_interval { /* where one event is followed, from left to right */
    int32_t event, node; /* the interval lies between this node and the next one */
    int32_t left;        /* evaluations that may still be made */
    double past, f_past; /* the point before a; past < 0: there is none */
    double a, fa, b, fb; /* the interval, and the values at its ends */
    double bend;         /* bound of |second divided difference| as far as it is known */
} sym_event_interval;

/* The interval <- the next one: up to the next node, or twice as long as the one before. Returns 0 or a status. */
static int32_t sym_next_interval(sym_event_search *s, const sym_event_rows *rows, sym_event_interval *at) {
    const double length = at->past < 0.0 ? 1.0 : 2.0 * (at->a - at->past);
    const int32_t i = at->event;
    double now;
    int32_t status;
    if (at->past < 0.0 || at->a >= sym_event_nodes[at->node + 1]) {
        while (at->a >= sym_event_nodes[at->node + 1]) ++at->node;
        at->b = sym_event_nodes[at->node + 1], at->fb = rows->node[at->node + 1][i];
        at->bend = sym_bend_between_nodes(rows, i, at->node);
        return 0;
    }
    at->b = at->a + length;
    if (at->b >= sym_event_nodes[at->node + 1]) {
        at->b = sym_event_nodes[at->node + 1], at->fb = rows->node[at->node + 1][i];
    } else {
        status = sym_event_at(s, i, at->b, &at->fb);
        if (status != 0) return status;
        --at->left;
    }
    now = fabs(sym_bend(at->past, at->f_past, at->a, at->fa, at->b, at->fb));
    at->bend = now > 0.5 * at->bend ? now : 0.5 * at->bend;
    return 0;
}

/* Halve the interval until it hides nothing. What was seen of its bend at a distance is forgotten by half each time.
 * Returns 0 or a status. */
static int32_t sym_shorten_interval(sym_event_search *s, const sym_event_rows *rows, sym_event_interval *at) {
    const double rounding = SYM_EVENT_ROUNDING * rows->size[at->event];
    for (;;) {
        const double length = at->b - at->a, departure = 2.0 * at->bend * length * length, m = at->a + 0.5 * length;
        double f, now;
        int32_t status;
        if (sym_hides_nothing(at->fa, at->fb, departure) || departure <= rounding) return 0;
        if (length <= SYM_EVENT_RESOLUTION) return 0;
        if (at->left-- <= 0) {
            s->unresolved = at->event;
            return 0;
        }
        status = sym_event_at(s, at->event, m, &f);
        if (status != 0) return status;
        now = fabs(sym_bend(at->a, at->fa, m, f, at->b, at->fb));
        at->bend = now > 0.5 * at->bend ? now : 0.5 * at->bend;
        at->b = m, at->fb = f;
    }
}

/* Note that an event turns at a nearer to zero than steps can tell. */
static void sym_note_touch(sym_event_search *s, const sym_event_rows *rows, const sym_event_interval *at) {
    if (at->past < 0.0 || !((at->f_past - at->fa) * (at->fb - at->fa) > 0.0)) return;
    if (fabs(at->fa) <= s->tolerance * rows->size[at->event]) s->touched = at->event, s->touched_x = at->a;
}

/* The next arrival of event i <- the one after it, or after the start of the step. Returns 0 or a status. */
static int32_t sym_seek_arrival(sym_event_search *s, int32_t i) {
    const sym_event_rows rows = sym_rows_of_search(s);
    sym_event_interval at = {i, 0, SYM_EVENT_BUDGET, -1.0, 0.0, rows.next_x[i], rows.next_value[i], 0.0, 0.0, 0.0};
    rows.value[i] = rows.next_value[i], rows.next_x[i] = 2.0;
    while (at.a < 1.0) {
        int32_t status = sym_next_interval(s, &rows, &at), arrives;
        if (status == 0) status = sym_shorten_interval(s, &rows, &at);
        if (status != 0) return status;
        sym_note_touch(s, &rows, &at);
        arrives = sym_arrives_at_zero(s->direction[i], at.fa, at.fb);
        if (sym_arrives_at_zero(0, at.fa, at.fb)) {
            status = sym_locate_event(s, i, at.a, at.fa, at.b, at.fb, &at.b, &at.fb);
            if (status != 0) return status;
        }
        at.past = at.a, at.f_past = at.fa, at.a = at.b, at.fa = at.fb;
        if (!arrives) continue;
        rows.next_x[i] = at.a, rows.next_value[i] = at.fa;
        return 0;
    }
    return 0;
}

SYM_EXPORT int32_t sym_event_search_next(sym_event_search *s, int32_t *which, double *x) {
    const sym_event_rows rows = sym_rows_of_search(s);
    int32_t i, first = -1;
    if (s->taken >= 0) {
        const int32_t status = sym_seek_arrival(s, s->taken);
        if (status != 0) return status;
    }
    for (i = 0; i < s->n; ++i)
        if (rows.next_x[i] <= 1.0 && (first < 0 || rows.next_x[i] < rows.next_x[first])) first = i;
    s->taken = *which = first, *x = first < 0 ? 2.0 : rows.next_x[first];
    return 0;
}

/* Whether event i, not yet met up to x, has arrived at zero there by that value: within rounding, at the same time. */
static int32_t sym_event_is_met(const sym_event_search *s, int32_t i, double x, double value) {
    const sym_event_rows rows = sym_rows_of_search(s);
    return rows.next_x[i] > x && rows.next_x[i] <= x + SYM_EVENT_RESOLUTION &&
           sym_arrives_at_zero(s->direction[i], rows.value[i], value);
}

SYM_EXPORT int32_t sym_event_search_begin(sym_event_search *s) {
    const sym_event_rows rows = sym_rows_of_search(s);
    int32_t i, k, status;
    s->taken = s->touched = s->unresolved = -1;
    memcpy(rows.value, rows.node[0], (size_t)s->n * sizeof(double));
    for (k = s->start_changes ? 0 : 1; k < SYM_EVENT_NODES; ++k) {
        status = s->evaluate(s->data, sym_event_nodes[k], rows.node[k]);
        if (status != 0) return status;
    }
    for (i = 0; i < s->n; ++i) {
        const int32_t arrives = sym_arrives_at_zero(s->direction[i], rows.value[i], rows.node[0][i]);
        rows.size[i] = 0.0;
        for (k = 0; k < SYM_EVENT_NODES; ++k)
            if (fabs(rows.node[k][i]) > rows.size[i]) rows.size[i] = fabs(rows.node[k][i]);
        rows.next_x[i] = 0.0, rows.next_value[i] = rows.node[0][i];
        status = arrives ? 0 : sym_seek_arrival(s, i);
        if (status != 0) return status;
    }
    return 0;
}
