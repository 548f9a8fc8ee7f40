/* Instants at which formulas of time bend, jump or change fast (docs/theory/simulation.md, (3a)): where operands of theirs
 * pass zero, or come nearest to it. */

/* Points over the span at which zeros and extrema are looked for, besides those that an inner formula has shown. */
#define SYM_INSTANT_POINTS 1025
/* Halvings of an interval of time, down to neighbouring numbers; of the golden section, to the precision of an extremum. */
#define SYM_INSTANT_HALVINGS 64
#define SYM_INSTANT_SECTIONS 48
#define SYM_INSTANT_GOLDEN 0.6180339887498949
/* Share of an interval within which an extremum lies at its edge: where the operand passes zero, it is least at one. */
#define SYM_INSTANT_AT_EDGE 1e-6
/* A part of a formula that lasts longer than this share of the span is not narrow. */
#define SYM_INSTANT_NARROW_SHARE 0.03125
/* Halvings from there down to the shortest narrow part. */
#define SYM_INSTANT_REACHES 55
/* Middles of narrow parts that are nearer to each other, as a share of the span, are one. */
#define SYM_INSTANT_SAME_MIDDLE 1e-9
/* Instants beside the middle of a narrow part, in times in which the operand changes by one. */
#define SYM_INSTANT_BESIDE 11
static const double sym_instant_beside[SYM_INSTANT_BESIDE] = {-16.0, -8.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0, 8.0, 16.0};

typedef struct sym_instant_rows { /* of the memory of a search, (capacity) each */
    double *t, *f;                /* points, and the operand there */
    double *low, *high, *side;    /* intervals, and the operand's sign before them */
    double *tried, *value;        /* points within the intervals, and the operand there */
    double *place;                /* number of a point */
    double *nearest;              /* where the operand comes nearest to zero */
    double *found;                /* instants of this operand */
    double *merged;
} sym_instant_rows;

static sym_instant_rows sym_instant_rows_of(const sym_instant_search *search) {
    const size_t n = (size_t)search->capacity;
    double *m = search->memory;
    sym_instant_rows rows;
    rows.t = m, rows.f = m + n, rows.low = m + 2 * n, rows.high = m + 3 * n, rows.side = m + 4 * n;
    rows.tried = m + 5 * n, rows.value = m + 6 * n, rows.place = m + 7 * n, rows.nearest = m + 8 * n;
    rows.found = m + 9 * n, rows.merged = m + 10 * n;
    return rows;
}

static void sym_sort(double *x, int32_t n) { /* all but in order already */
    int32_t i, k;
    for (i = 1; i < n; ++i) {
        const double value = x[i];
        for (k = i; k > 0 && x[k - 1] > value; --k) x[k] = x[k - 1];
        x[k] = value;
    }
}

/* Merge numbers b (n_b), in order, into a (n_a), in order; equal ones are one. Returns how many there are, or -1 where they
 * do not fit. */
static int32_t sym_merge(const sym_instant_search *search, double *a, int32_t n_a, const double *b, int32_t n_b) {
    double *merged = sym_instant_rows_of(search).merged;
    int32_t i = 0, k = 0, n = 0;
    while (i < n_a || k < n_b) {
        const double next = k >= n_b || (i < n_a && a[i] <= b[k]) ? a[i] : b[k];
        if (n == search->capacity) return -1;
        merged[n++] = next;
        while (i < n_a && a[i] <= next) ++i;
        while (k < n_b && b[k] <= next) ++k;
    }
    memcpy(a, merged, (size_t)n * sizeof *a);
    return n;
}

/* Where an operand comes nearest to zero, or furthest beyond, between two of n points that it is larger at -> rows->nearest, in
 * order. Returns how many. */
static int32_t sym_find_nearest(const sym_instant_search *search, const sym_instant_rows *rows, int32_t operand,
                                int32_t n) {
    double *const left = rows->tried, *const at_left = rows->value;
    int32_t i, k, m = 0, kept = 0;
    for (k = 1; k < n - 1; ++k) {
        const double before = fabs(rows->f[k - 1]), here = fabs(rows->f[k]), after = fabs(rows->f[k + 1]);
        if (!(here < HUGE_VAL) || before < here || after < here || (before == here && after == here)) continue;
        rows->low[m] = rows->t[k - 1], rows->high[m] = rows->t[k + 1], rows->side[m] = sym_sign(rows->f[k]);
        rows->place[m++] = k;
    }
    for (i = 0; i < SYM_INSTANT_SECTIONS && m > 0; ++i) {
        double *const right = rows->nearest, *const at_right = rows->found;
        for (k = 0; k < m; ++k) {
            const double part = SYM_INSTANT_GOLDEN * (rows->high[k] - rows->low[k]);
            left[k] = rows->high[k] - part, right[k] = rows->low[k] + part;
        }
        search->evaluate(search->data, operand, m, left, at_left);
        search->evaluate(search->data, operand, m, right, at_right);
        for (k = 0; k < m; ++k) {
            if (rows->side[k] * at_left[k] < rows->side[k] * at_right[k]) rows->high[k] = right[k];
            else rows->low[k] = left[k];
        }
    }
    for (k = 0; k < m; ++k) {
        const int32_t at = (int32_t)rows->place[k];
        const double middle = 0.5 * (rows->low[k] + rows->high[k]), before = rows->t[at - 1], after = rows->t[at + 1];
        const double edge = middle - before < after - middle ? middle - before : after - middle;
        if (edge > SYM_INSTANT_AT_EDGE * (after - before)) rows->nearest[kept++] = middle;
    }
    sym_sort(rows->nearest, kept);
    return kept;
}

/* The first number after each change of an operand's sign between two of n points -> rows->found, in order. Returns how
 * many. */
static int32_t sym_find_sign_changes(const sym_instant_search *search, const sym_instant_rows *rows, int32_t operand,
                                     int32_t n) {
    int32_t i, k, m = 0;
    for (k = 0; k < n - 1; ++k) {
        const double here = rows->f[k], next = rows->f[k + 1];
        if (here != here || next != next || sym_sign(here) == sym_sign(next)) continue;
        rows->low[m] = rows->t[k], rows->high[m] = rows->t[k + 1], rows->side[m++] = sym_sign(here);
    }
    for (i = 0; i < SYM_INSTANT_HALVINGS && m > 0; ++i) {
        int32_t apart = 0;
        for (k = 0; k < m; ++k) {
            rows->tried[k] = 0.5 * (rows->low[k] + rows->high[k]);
            apart |= rows->tried[k] > rows->low[k] && rows->tried[k] < rows->high[k];
        }
        if (!apart) break;
        search->evaluate(search->data, operand, m, rows->tried, rows->value);
        for (k = 0; k < m; ++k) {
            if (sym_sign(rows->value[k]) == rows->side[k]) rows->low[k] = rows->tried[k];
            else rows->high[k] = rows->tried[k];
        }
    }
    memcpy(rows->found, rows->high, (size_t)m * sizeof *rows->found);
    return m;
}

/* Time in which an operand changes by one about the middle of a narrow part; 0 where the part is none. */
static double sym_find_reach(const sym_instant_search *search, int32_t operand, double middle, double span) {
    double t[2 * SYM_INSTANT_REACHES + 1], f[2 * SYM_INSTANT_REACHES + 1], reach = SYM_INSTANT_NARROW_SHARE * span;
    int32_t k;
    t[0] = middle;
    for (k = 0; k < SYM_INSTANT_REACHES; ++k, reach *= 0.5) t[2 * k + 1] = middle - reach, t[2 * k + 2] = middle + reach;
    search->evaluate(search->data, operand, 2 * SYM_INSTANT_REACHES + 1, t, f);
    reach = SYM_INSTANT_NARROW_SHARE * span;
    for (k = 0; k < SYM_INSTANT_REACHES; ++k, reach *= 0.5)
        if (fabs(f[2 * k + 1] - f[0]) <= 1.0 && fabs(f[2 * k + 2] - f[0]) <= 1.0) return k > 0 ? reach : 0.0;
    return 0.0;
}

/* Instants about the middles (n), in order, of narrow parts: there, and where the operand has changed by one and by more ->
 * rows->found, in order. Returns how many, or -1 where they do not fit. */
static int32_t sym_find_beside(const sym_instant_search *search, const sym_instant_rows *rows, int32_t operand, double span,
                               const double *middle, int32_t n) {
    int32_t i, k, m = 0;
    for (k = 0; k < n; ++k) {
        double reach;
        if (k > 0 && !(middle[k] - middle[k - 1] > SYM_INSTANT_SAME_MIDDLE * span)) continue;
        reach = sym_find_reach(search, operand, middle[k], span);
        if (reach == 0.0) continue;
        if (m + SYM_INSTANT_BESIDE > search->capacity) return -1;
        for (i = 0; i < SYM_INSTANT_BESIDE; ++i) rows->found[m++] = middle[k] + reach * sym_instant_beside[i];
    }
    sym_sort(rows->found, m);
    return m;
}

/* Middles of an operand's narrow parts: of the points nearest to zero (n) those that are no changes of sign (m), or, where they
 * are narrow parts as well, both -> rows->low. Returns how many, or -1 where they do not fit. */
static int32_t sym_find_middles(const sym_instant_search *search, const sym_instant_rows *rows, int32_t n, int32_t m,
                                int32_t both) {
    int32_t i, k = 0, kept = 0;
    memcpy(rows->low, rows->nearest, (size_t)n * sizeof *rows->low);
    if (both) return sym_merge(search, rows->low, n, rows->found, m);
    for (i = 0; i < n; ++i) {
        while (k < m && rows->found[k] < rows->nearest[i]) ++k;
        if (k == m || rows->found[k] != rows->nearest[i]) rows->low[kept++] = rows->nearest[i];
    }
    return kept;
}

/* Instants of one operand -> rows->found, in order; rows->t holds n points. Returns how many, or -1 where they do not fit. */
static int32_t sym_instants_of_operand(const sym_instant_search *search, const sym_instant_rows *rows, int32_t operand,
                                       double span, int32_t n) {
    const int32_t kind = (int32_t)search->kind[operand];
    int32_t nearest, changes, middles;
    search->evaluate(search->data, operand, n, rows->t, rows->f);
    nearest = sym_find_nearest(search, rows, operand, n);
    n = sym_merge(search, rows->t, n, rows->nearest, nearest);
    if (n < 0) return -1;
    search->evaluate(search->data, operand, n, rows->t, rows->f);
    changes = sym_find_sign_changes(search, rows, operand, n);
    if (kind == SYM_INSTANT_KINK) return changes;
    middles = sym_find_middles(search, rows, nearest, changes, kind == SYM_INSTANT_NARROW);
    if (middles < 0) return -1;
    memcpy(rows->high, rows->low, (size_t)middles * sizeof *rows->high);
    return sym_find_beside(search, rows, operand, span, rows->high, middles);
}

SYM_EXPORT int32_t sym_find_instants(const sym_instant_search *search, double t0, double t_end, double *instants) {
    const sym_instant_rows rows = sym_instant_rows_of(search);
    int32_t i, k, n, points, first, found = 0;
    if (search->capacity <= SYM_INSTANT_POINTS) return -1;
    for (i = 0; i < search->n && t_end > t0; ++i) {
        for (k = 0; k < SYM_INSTANT_POINTS; ++k) rows.t[k] = t0 + (t_end - t0) * ((double)k / (SYM_INSTANT_POINTS - 1));
        points = sym_merge(search, rows.t, SYM_INSTANT_POINTS, instants, found);
        n = points < 0 ? -1 : sym_instants_of_operand(search, &rows, i, t_end - t0, points);
        if (n < 0) return -1;
        for (k = 0; k < n; ++k) rows.found[k] = sym_multiple(rows.found[k], t_end - t0);
        for (first = 0; first < n && rows.found[first] < t0;) ++first;
        while (n > first && rows.found[n - 1] > t_end) --n;
        found = sym_merge(search, instants, found, rows.found + first, n - first);
        if (found < 0) return -1;
    }
    return found;
}
