/* How long a step may be for its inputs (docs/theory/simulation.md, (3b), (3c)): what a step's stages make of inputs that depend
 * on time, against what these are. Between two corners the lines of a signal are straight, and every adaptive method is exact
 * for them; a step that passes corners is shortened where its stages misjudge the inputs' impulses or their moments. */

enum { SYM_MAX_STAGES = 16 };

/* Times the bound of a step's error that its inputs may cause before it is shortened, and may cause then: steps from corner to
 * corner have defects of one sign, which add up. */
#define SYM_INPUT_ERROR 2.0
#define SYM_INPUT_SHORTENED 0.2
/* Defects below this share of the input's size within the step are rounding. */
#define SYM_INPUT_ROUNDING 1e-13

typedef struct sym_moments { /* of an input, less its value at the step's start, over a step of length h that ends at t1 */
    double impulse; /* integral of u */
    double moment;  /* integral of (t1 - t) u */
    double size;    /* largest |u| seen */
} sym_moments;

static void sym_widen(sym_moments *m, double value) {
    if (fabs(value) > m->size) m->size = fabs(value);
}

/* Add a straight piece of length d from value a to value b, which ends `left` before the step does. */
static void sym_add_line(sym_moments *m, double d, double left, double a, double b) {
    const double area = 0.5 * d * (a + b);
    m->impulse += area;
    m->moment += left * area + d * d * (2.0 * a + b) / 6.0;
    sym_widen(m, b);
}

/* The first corner of any signal's lines after t, before t1; t1 where there is none. */
static double sym_first_corner(const sym_system *s, double t, double t1) {
    int32_t i;
    for (i = 0; i < s->n_signals; ++i) {
        const sym_signal *signal = &s->signals[i];
        const int32_t k = signal->linear ? sym_samples_begun(signal, sym_instant(t)) : signal->n;
        if (k < signal->n && signal->t[k] < t1) t1 = signal->t[k];
    }
    return t1;
}

/* The last corner of any signal's lines up to t1; -HUGE_VAL where there is none. */
static double sym_last_corner(const sym_system *s, double t1) {
    double last = -HUGE_VAL;
    int32_t i;
    for (i = 0; i < s->n_signals; ++i) {
        const sym_signal *signal = &s->signals[i];
        const int32_t k = signal->linear ? sym_samples_begun(signal, t1) - 1 : -1;
        if (k >= 0 && signal->t[k] > last) last = signal->t[k];
    }
    return last;
}

/* Moments of a signal with lines over the step from t to t1. */
static sym_moments sym_signal_moments(const sym_signal *signal, double t, double t1) {
    sym_moments m = {0.0, 0.0, 0.0};
    const double start = sym_signal_at(signal, t, HUGE_VAL);
    double at = t, value = 0.0, next;
    int32_t k;
    for (k = sym_samples_begun(signal, t); k < signal->n && signal->t[k] < t1; ++k) {
        next = signal->value[k] - start;
        sym_add_line(&m, signal->t[k] - at, t1 - signal->t[k], value, next);
        at = signal->t[k], value = next;
    }
    sym_add_line(&m, t1 - at, 0.0, value, sym_signal_at(signal, t1, HUGE_VAL) - start);
    return m;
}

/* What the method makes of x'' = u from rest: v(t1) and x(t1), from u at its stages and the rate of u at the start. For an
 * input these are the impulse and the moment that the step gives to the motion. */
static sym_moments sym_method_moments(const sym_run *r, double h, const double *u, double rate) {
    const sym_tableau *method = &r->tableau;
    sym_moments m = {0.0, 0.0, 0.0};
    double v[SYM_MAX_STAGES], x[SYM_MAX_STAGES]; /* solutions of the stages of a Rosenbrock method; slopes of others */
    int32_t i, j;
    for (i = 0; i < method->stages; ++i) {
        if (r->method == SYM_METHOD_ROSENBROCK) {
            const double *a = method->a + SYM_INDEX(i, method->stages, 0), *c = method->coupling + SYM_INDEX(i, method->stages, 0);
            const double g = h * method->gamma;
            double speed = u[i] + h * method->d[i] * rate, place = 0.0;
            for (j = 0; j < i; ++j) speed += c[j] / h * v[j], place += a[j] * v[j] + c[j] / h * x[j];
            v[i] = g * speed, x[i] = g * (place + v[i]);
            m.impulse += method->b[i] * v[i], m.moment += method->b[i] * x[i];
        } else {
            const double *a = method->a + SYM_INDEX(i, method->dense_stages, 0);
            x[i] = 0.0;
            for (j = 0; j < i; ++j) x[i] += h * a[j] * u[j];
            m.impulse += h * method->b[i] * u[i], m.moment += h * method->b[i] * x[i];
        }
        sym_widen(&m, u[i]);
    }
    return m;
}

/* Defects of a signal over the step from t to t1: its moments, less what the method makes of them. Its impulse -> *total. */
static sym_moments sym_signal_defects(const sym_run *r, const sym_signal *signal, double t, double t1, double *total) {
    const double h = t1 - t, start = sym_signal_at(signal, t, HUGE_VAL), ahead = sym_time_difference(t);
    double u[SYM_MAX_STAGES];
    sym_moments exact = sym_signal_moments(signal, t, t1), made;
    int32_t i;
    for (i = 0; i < r->tableau.stages; ++i) u[i] = sym_signal_at(signal, t + r->tableau.c[i] * h, HUGE_VAL) - start;
    made = sym_method_moments(r, h, u, (sym_signal_at(signal, t + ahead, HUGE_VAL) - start) / ahead);
    *total = exact.impulse;
    sym_widen(&exact, made.size);
    exact.impulse -= made.impulse, exact.moment -= made.moment;
    if (fabs(exact.impulse) <= SYM_INPUT_ROUNDING * exact.size * h) exact.impulse = 0.0;
    if (fabs(exact.moment) <= SYM_INPUT_ROUNDING * exact.size * h * h) exact.moment = 0.0;
    return exact;
}

/* Defects of all signals with lines over the step from t to t1. Returns whether there are any. */
static int32_t sym_find_defects(const sym_run *r, sym_input_defects *d, double t, double t1) {
    const sym_system *s = r->system;
    int32_t i, any = 0;
    for (i = 0; i < s->n_signals; ++i) {
        sym_moments m;
        if (!s->signals[i].linear) continue;
        m = sym_signal_defects(r, &s->signals[i], t, t1, d->total + i);
        d->impulse[i] = m.impulse, d->moment[i] = m.moment, d->size[i] = m.size;
        if (m.impulse != 0.0 || m.moment != 0.0) any = 1;
    }
    return any;
}

/* Accelerations by each signal with lines, at the present state: differences of the size that it has in the step. */
static void sym_find_input_effects(sym_run *r, const sym_workspace *w) {
    sym_system *s = r->system;
    const int32_t nv = s->nv;
    int32_t i, l;
    sym_load_start(r);
    (void)sym_evaluate_inputs(s); /* without a function of the caller's it can't fail */
    for (i = 0; i < s->n_signals; ++i) {
        double *effect = w->defects.effect + SYM_INDEX(i, nv, 0), *u = s->u + s->signals[i].input;
        const double kept = *u, size = w->defects.size[i];
        memset(effect, 0, (size_t)nv * sizeof *effect);
        if (!s->signals[i].linear || size == 0.0) continue;
        *u = kept + size;
        sym_evaluate(&s->forward_dynamics);
        ++r->evaluations;
        *u = kept;
        for (l = 0; l < nv; ++l) effect[l] = (s->a[l] - w->k[nv + l]) / size;
    }
    if (r->method == SYM_METHOD_ROSENBROCK) (void)sym_evaluate_acceleration(r); /* its Jacobian is taken at this point */
}

/* Norm, as of (4), of the error that the defects cause in a step of length h. */
static double sym_input_error(const sym_run *r, const sym_workspace *w, double h) {
    const sym_system *s = r->system;
    const sym_input_defects *d = &w->defects;
    const int32_t nv = s->nv;
    double sum = 0.0;
    int32_t i, l;
    for (l = 0; l < nv; ++l) {
        double speed = 0.0, place = 0.0, gain = h * w->k[nv + l], larger = w->magnitude[nv + l];
        for (i = 0; i < s->n_signals; ++i) {
            const double effect = d->effect[SYM_INDEX(i, nv, l)];
            if (!s->signals[i].linear) continue;
            speed += effect * d->impulse[i], place += effect * d->moment[i], gain += effect * d->total[i];
        }
        if (fabs(r->v[l] + gain) > larger) larger = fabs(r->v[l] + gain);
        speed /= r->atol + r->rtol * larger, place /= r->atol + r->rtol * w->magnitude[l];
        sum += speed * speed + place * place;
    }
    return sqrt(sum / (2 * nv));
}

/* Whether the stages of a step from the present state to t1 see the inputs well enough. */
static int32_t sym_inputs_are_seen(const sym_run *r, sym_workspace *w, double t1) {
    return !sym_find_defects(r, &w->defects, r->t, t1) || sym_input_error(r, w, t1 - r->t) <= SYM_INPUT_SHORTENED;
}

/* Where a step that may last until t1 ends for its inputs: there, or at the last corner up to which its stages see them, by
 * bisection. The step to the first corner always does. */
static double sym_end_by_inputs(sym_run *r, sym_workspace *w, double t1) {
    const sym_system *s = r->system;
    double seen = sym_first_corner(s, r->t, sym_before(t1)), unseen = t1;
    if (s->callback != NULL || seen >= sym_before(t1) || !sym_find_defects(r, &w->defects, r->t, t1)) return t1;
    sym_find_input_effects(r, w);
    if (sym_input_error(r, w, t1 - r->t) <= SYM_INPUT_ERROR) return t1;
    for (;;) {
        const double middle = 0.5 * (seen + unseen);
        double tried = sym_last_corner(s, middle);
        if (tried <= seen) tried = sym_first_corner(s, middle, unseen);
        if (tried <= seen || tried >= unseen) return seen;
        if (sym_inputs_are_seen(r, w, tried)) seen = tried;
        else unseen = tried;
    }
}
