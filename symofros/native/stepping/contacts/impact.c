/* The impact of one ball on a plane with friction: Coulomb's law along the normal impulse, Stronge's coefficient of
 * restitution (docs/theory/constraints.md, section 15, (43) to (45)). */

enum { SYM_IMPACT_PARTS = 256, SYM_IMPACT_HALVINGS = 60, SYM_MOST_SEGMENTS = 64, SYM_ANGLES = 64 };
#define SYM_FULL_TURN 6.28318530717958647693
/* Slip, over the speeds before the impact, and change of its direction that are rounding. */
#define SYM_IMPACT_STILL 1e-13
#define SYM_STRAIGHT 1e-12
/* Share of the largest entry of a ball's inverse inertia below which it does not move along an axis. */
#define SYM_IMMOBILE 1e-12

typedef struct sym_impact_state { /* along the normal impulse */
    double u[3];  /* velocity of the ball's point against the plane's: x, y, normal */
    double p[3];  /* impulse */
    double work;  /* of the normal impulse since the compression, or the restitution, began */
} sym_impact_state;

/* h = -pinv(W_tt) W_tn: the friction, over the normal impulse, that keeps the ball from slipping. */
static void sym_sticking_ratio(const double *W, double *h) {
    const double a = W[0], b = 0.5 * (W[1] + W[3]), d = W[4], mean = 0.5 * (a + d), half = 0.5 * (a - d);
    const double root = hypot(half, b), most = mean + root, floor = SYM_IMMOBILE * (most > W[8] ? most : W[8]);
    const double angle = 0.5 * atan2(b, half), c = cos(angle), s = sin(angle);
    const double first = c * W[2] + s * W[5], second = c * W[5] - s * W[2];
    const double x = most > floor ? -first / most : 0.0, y = mean - root > floor ? -second / (mean - root) : 0.0;
    h[0] = c * x - s * y, h[1] = s * x + c * y;
}

/* Direction d (2), from a first guess, in which a ball begins to slide, so that friction opposes what it leaves: that has no part
 * across d, which the function returns, and one along it. Returns whether there is one; else d stays. */
static int32_t sym_find_direction(double (*leaves)(void *data, const double *d, double *along), void *data, double *d) {
    const double turn = SYM_FULL_TURN / (double)SYM_ANGLES, from = atan2(d[1], d[0]) - 0.5 * turn;
    double before, after = 0.0, along, at[2];
    int32_t i, k;
    for (i = 0; i <= SYM_ANGLES; ++i) {
        double low = from + (i - 1) * turn, high = from + i * turn;
        before = after, at[0] = cos(high), at[1] = sin(high);
        after = leaves(data, at, &along);
        if (i == 0 || (before != 0.0 && (before > 0.0) == (after > 0.0))) continue;
        for (k = 0; k < SYM_IMPACT_HALVINGS; ++k) {
            const double middle = 0.5 * (low + high);
            at[0] = cos(middle), at[1] = sin(middle);
            if ((leaves(data, at, &along) > 0.0) == (before > 0.0)) low = middle;
            else high = middle;
        }
        at[0] = cos(high), at[1] = sin(high);
        (void)leaves(data, at, &along);
        if (!(along > 0.0)) continue;
        memcpy(d, at, sizeof at);
        return 1;
    }
    return 0;
}

typedef struct sym_ball_in_impact { /* a ball whose slip begins */
    const double *W;
    double mu;
} sym_ball_in_impact;

/* What its slip gains of the normal impulse. */
static double sym_gain_of_slip(void *data, const double *d, double *along) {
    const sym_ball_in_impact *of = (const sym_ball_in_impact *)data;
    const double x = of->W[2] - of->mu * (of->W[0] * d[0] + of->W[1] * d[1]), y = of->W[5] - of->mu * (of->W[3] * d[0] + of->W[4] * d[1]);
    *along = x * d[0] + y * d[1];
    return x * d[1] - y * d[0];
}

/* Friction over the normal impulse at a slip: against it, or where there is none, what keeps it so. Returns whether friction
 * is constant from here on, as far as the slip's direction is, or -1 where it is not determined. */
static int32_t sym_friction_ratio(const double *W, double mu, double still, const double *u, double *h) {
    const double slip = hypot(u[0], u[1]);
    sym_ball_in_impact ball = {W, mu};
    double d[2], size, x, y;
    if (slip <= still) {
        sym_sticking_ratio(W, h);
        size = hypot(h[0], h[1]);
        if (size <= mu) return 1;
        d[0] = -h[0] / size, d[1] = -h[1] / size;
        if (!sym_find_direction(sym_gain_of_slip, &ball, d)) return -1;
        h[0] = -mu * d[0], h[1] = -mu * d[1];
        return 1;
    }
    h[0] = -mu * u[0] / slip, h[1] = -mu * u[1] / slip;
    x = W[2] + W[0] * h[0] + W[1] * h[1], y = W[5] + W[3] * h[0] + W[4] * h[1];
    return fabs(x * u[1] - y * u[0]) <= SYM_STRAIGHT * slip * hypot(x, y);
}

/* State after a further normal impulse dp by constant friction h. */
static sym_impact_state sym_after_impulse(const double *W, const sym_impact_state *s, const double *h, double dp) {
    sym_impact_state next = *s;
    const double rate = W[8] + W[6] * h[0] + W[7] * h[1];
    int32_t i;
    for (i = 0; i < 3; ++i) next.u[i] += (W[3 * i + 2] + W[3 * i] * h[0] + W[3 * i + 1] * h[1]) * dp;
    next.p[0] += h[0] * dp, next.p[1] += h[1] * dp, next.p[2] += dp;
    next.work += (s->u[2] + 0.5 * rate * dp) * dp;
    return next;
}

/* State after a further normal impulse dp, in which the direction of the slip turns: the classical method of order four. */
static sym_impact_state sym_after_turning(const double *W, double mu, const sym_impact_state *s, double dp) {
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    double h[2] = {0.0, 0.0}, mean[2] = {0.0, 0.0}, normal = 0.0;
    sym_impact_state next;
    int32_t i;
    for (i = 0; i < 4; ++i) {
        const sym_impact_state stage = sym_after_impulse(W, s, h, at[i] * dp);
        const double slip = hypot(stage.u[0], stage.u[1]);
        if (slip > 0.0) h[0] = -mu * stage.u[0] / slip, h[1] = -mu * stage.u[1] / slip;
        mean[0] += weight[i] * h[0], mean[1] += weight[i] * h[1], normal += weight[i] * stage.u[2];
    }
    next = sym_after_impulse(W, s, mean, dp);
    next.work = s->work + normal * dp;
    return next;
}

/* Whether a phase has ended: the compression at u_n = 0, the restitution once its work is the target. */
static int32_t sym_phase_ended(const sym_impact_state *s, double target) {
    return target < 0.0 ? s->u[2] >= 0.0 : s->work >= target;
}

/* The least dp > 0 at which a + b dp + c dp^2 = 0 falls or rises through zero; HUGE_VAL: none. */
static double sym_first_root(double a, double b, double c) {
    double discriminant, q, first, second;
    if (c == 0.0) return b != 0.0 && -a / b > 0.0 ? -a / b : HUGE_VAL;
    discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0) return HUGE_VAL;
    q = -0.5 * (b + copysign(sqrt(discriminant), b));
    first = q / c, second = q != 0.0 ? a / q : HUGE_VAL;
    if (!(first > 0.0)) first = HUGE_VAL;
    if (!(second > 0.0)) second = HUGE_VAL;
    return first < second ? first : second;
}

/* One phase of an impact; target: the work of the restitution, below zero: compression; reach: about the normal impulse.
 * Returns 0 or a status. */
static int32_t sym_impact_phase(const double *W, double mu, double still, double reach, double target, sym_impact_state *s) {
    int32_t segment;
    for (segment = 0; segment < SYM_MOST_SEGMENTS; ++segment) {
        double h[2], end, stops = HUGE_VAL;
        const int32_t constant = sym_friction_ratio(W, mu, still, s->u, h);
        const double rate = W[8] + W[6] * h[0] + W[7] * h[1], slip = hypot(s->u[0], s->u[1]);
        const double x = W[2] + W[0] * h[0] + W[1] * h[1], y = W[5] + W[3] * h[0] + W[4] * h[1];
        if (constant < 0) return SYM_NO_CONTACT_FORCE;
        if (constant) {
            const double along = slip > still ? (x * s->u[0] + y * s->u[1]) / slip : 0.0;
            if (along < 0.0) stops = -slip / along;
            end = target < 0.0 ? (rate > 0.0 ? -s->u[2] / rate : HUGE_VAL) : sym_first_root(s->work - target, s->u[2], 0.5 * rate);
            if (end > stops) {
                if (stops == HUGE_VAL) return SYM_NO_CONTACT_FORCE;
                *s = sym_after_impulse(W, s, h, stops);
                s->u[0] = s->u[1] = 0.0;
                continue;
            }
            if (end == HUGE_VAL) return SYM_NO_CONTACT_FORCE;
            *s = sym_after_impulse(W, s, h, end);
            if (target < 0.0) s->u[2] = 0.0;
            return 0;
        }
        { /* Parts within which neither the slip nor the normal velocity changes by more than a share. */
            const double size = hypot(x, y), part = slip < size * reach ? slip / size : reach;
            int32_t i, ended = 0;
            for (i = 0; i < 64 * SYM_IMPACT_PARTS && !ended; ++i) {
                const double now = hypot(s->u[0], s->u[1]);
                double dp = part / (double)SYM_IMPACT_PARTS, low = 0.0;
                sym_impact_state next;
                int32_t k;
                if (now < 0.25 * slip || now > 4.0 * slip) break; /* a new length of the parts */
                next = sym_after_turning(W, mu, s, dp);
                if (!sym_phase_ended(&next, target)) {
                    *s = next;
                    continue;
                }
                for (k = 0; k < SYM_IMPACT_HALVINGS; ++k) {
                    const double middle = 0.5 * (low + dp);
                    next = sym_after_turning(W, mu, s, middle);
                    if (sym_phase_ended(&next, target)) dp = middle;
                    else low = middle;
                }
                *s = sym_after_turning(W, mu, s, dp);
                ended = 1;
            }
            if (ended) {
                if (target < 0.0) s->u[2] = 0.0;
                return 0;
            }
        }
    }
    return SYM_NO_CONTACT_FORCE;
}

/* Impulse P (3) of a ball that strikes with the velocity u (x, y, normal), W (3 x 3) its inverse inertia at the point of
 * contact. Returns 0 or a status. */
static int32_t sym_impact_of_ball(const double *W, const double *u, double mu, double e, double *P) {
    const double still = SYM_IMPACT_STILL * sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), reach = -u[2] / W[8];
    sym_impact_state s = {{u[0], u[1], u[2]}, {0.0, 0.0, 0.0}, 0.0};
    int32_t status = sym_impact_phase(W, mu, still, reach, -1.0, &s);
    const double target = e * e * -s.work;
    s.work = 0.0;
    if (status == 0 && target > 0.0) status = sym_impact_phase(W, mu, still, reach, target, &s);
    memcpy(P, s.p, sizeof s.p);
    return status;
}
