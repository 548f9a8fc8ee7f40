/* Which modes the balls of a contact problem take: by parts that do not act on each other, from guesses on
 * (docs/theory/constraints.md, section 15, (46), (47b)). */

enum { SYM_UNIQUE_UP_TO = 4, SYM_ALL_UP_TO = 8, SYM_MOST_SETS = 6561, SYM_GUESS_SWEEPS = 1000, SYM_FIRST_SETS = 4 };
/* Share by which two motions differ; shares down to which a guess tells forces and motions from none. */
#define SYM_DIFFERENT 1e-6
#define SYM_GUESSED 1e-6
/* Share of two balls' own inverse inertias that is no coupling between them. */
#define SYM_UNCOUPLED 1e-14

/* Whether normal forces on the balls that do not part are determined, by the other forces. */
static int32_t sym_normals_are_determined(const sym_contact_problem *p) {
    double A[SYM_MOST_CONTACTS * SYM_MOST_CONTACTS], x[SYM_MOST_CONTACTS];
    const double none[SYM_MOST_CONTACTS] = {0.0};
    int32_t which[SYM_MOST_CONTACTS], m = 0, i, j;
    for (i = 0; i < p->n; ++i)
        if (!p->parts[i]) which[m++] = i;
    for (i = 0; i < m; ++i)
        for (j = 0; j < m; ++j) A[m * i + j] = p->W[3 * p->n * (3 * which[i] + 2) + 3 * which[j] + 2];
    return m < 2 || sym_least_norm(m, A, none, x, NULL) == 0;
}

/* Most of contact that a ball may have. */
static int32_t sym_most_contact(const sym_contact_problem *p, int32_t i) {
    return p->parts[i] ? SYM_OPEN : p->slides[i] || p->mu[i] == 0.0 ? SYM_SLIDES : SYM_STICKS;
}

/* The force f (3) of a ball with the motion c becomes one nearer to its law, (47b). Returns by how much it changes. */
static double sym_relax_ball(const sym_contact_problem *p, int32_t i, const double *c, double *f) {
    const double *W = p->W + 9 * i * p->n + 3 * i, *d = p->d + 2 * i, mu = p->mu[i], was[3] = {f[0], f[1], f[2]};
    const int32_t n = 3 * p->n;
    const double own = W[2 * n + 2], along = p->slides[i] ? own - mu * (W[2 * n] * d[0] + W[2 * n + 1] * d[1]) : own;
    double across = W[0] + W[n + 1], size;
    f[2] = fmax(0.0, f[2] - c[2] / (along > 0.1 * own ? along : own));
    if (p->slides[i]) {
        f[0] = -mu * f[2] * d[0], f[1] = -mu * f[2] * d[1];
    } else if (across > 0.0) {
        f[0] -= (c[0] + W[2] * (f[2] - was[2])) / across, f[1] -= (c[1] + W[n + 2] * (f[2] - was[2])) / across;
        size = hypot(f[0], f[1]);
        if (size > mu * f[2]) f[0] *= mu * f[2] / size, f[1] *= mu * f[2] / size;
    }
    return fabs(f[0] - was[0]) + fabs(f[1] - was[1]) + fabs(f[2] - was[2]);
}

/* Guess of the modes, and of the directions of balls that begin to slide: ball by ball, (47b), until forces rest. Balls without force
 * and motion are in contact there; in freed they are open. */
static void sym_guess_modes(const sym_contact_problem *p, double *mode, double *freed, double *d) {
    double f[SYM_MOST_FORCES] = {0.0}, c[3], largest = 0.0;
    int32_t sweep, i;
    for (sweep = 0; sweep < SYM_GUESS_SWEEPS; ++sweep) {
        double change = 0.0;
        for (i = 0, largest = 0.0; i < p->n; ++i) {
            if (p->parts[i] || !(p->W[(3 * p->n + 1) * (3 * i + 2)] > 0.0)) continue;
            sym_motion_of_ball(p, f, i, c);
            change = fmax(change, sym_relax_ball(p, i, c, f + 3 * i));
            largest = fmax(largest, f[3 * i + 2]);
        }
        if (!(change > 1e-3 * SYM_GUESSED * largest) || !(largest < HUGE_VAL)) break;
    }
    for (i = 0; i < p->n; ++i) {
        const double *force = f + 3 * i, drag = hypot(force[0], force[1]);
        const int32_t pressed = force[2] > SYM_GUESSED * largest;
        mode[i] = sym_most_contact(p, i);
        sym_motion_of_ball(p, f, i, c);
        if (!pressed) {
            if (c[2] > SYM_GUESSED * p->size) mode[i] = SYM_OPEN;
        } else if (mode[i] == SYM_STICKS && drag >= (1.0 - SYM_GUESSED) * p->mu[i] * force[2] && hypot(c[0], c[1]) > SYM_GUESSED * p->size) {
            mode[i] = SYM_SLIDES, d[2 * i] = -force[0] / drag, d[2 * i + 1] = -force[1] / drag;
        }
        freed[i] = pressed ? mode[i] : SYM_OPEN;
    }
}

/* Sets of modes in the order in which they are tried: most contact, the last modes, the guess, the same with balls without force
 * open, then by how many balls differ from the guess, of those that differ by as many the ones with more contact of the first
 * balls before. less: by how much each ball has less contact than it may have. */
typedef struct sym_order_of_modes {
    double first[SYM_FIRST_SETS][SYM_MOST_CONTACTS]; /* modes */
    int32_t given, differing;
    int32_t less[SYM_MOST_CONTACTS];
} sym_order_of_modes;

/* The first of the sets in which the balls from one on differ from the guess, so many of them. Returns 0 where there is none. */
static int32_t sym_first_differing(const sym_contact_problem *p, sym_order_of_modes *at, int32_t ball, int32_t differing) {
    int32_t i, can = 0;
    for (i = ball; i < p->n; ++i) can += sym_most_contact(p, i) > 0;
    if (differing < 0 || differing > can) return 0;
    for (i = ball; i < p->n; ++i) {
        const int32_t most = sym_most_contact(p, i), guess = most - (int32_t)at->first[2][i];
        can -= most > 0;
        at->less[i] = 0; /* unless that differs and none may, or all others have to and one more */
        if (guess != 0 && differing == 0) at->less[i] = guess;
        if (guess == 0 && differing > can) at->less[i] = 1;
        differing -= at->less[i] != guess;
    }
    return 1;
}

/* The set after that of the order, which has as many that differ. Returns 0 where there is none. */
static int32_t sym_next_differing(const sym_contact_problem *p, sym_order_of_modes *at) {
    int32_t i, within = 0; /* how many of the balls from i on differ */
    for (i = p->n - 1; i >= 0; --i) {
        const int32_t most = sym_most_contact(p, i), guess = most - (int32_t)at->first[2][i];
        within += at->less[i] != guess;
        while (++at->less[i] <= most)
            if (sym_first_differing(p, at, i + 1, within - (at->less[i] != guess))) return 1;
    }
    return 0;
}

/* The next set, in mode. Returns 0 at the end. */
static int32_t sym_next_modes(const sym_contact_problem *p, sym_order_of_modes *at, double *mode) {
    const size_t size = (size_t)p->n * sizeof *mode;
    int32_t i, known = 1, found;
    while (at->given < SYM_FIRST_SETS) {
        const int32_t k = at->given++;
        memcpy(mode, at->first[k], size);
        for (i = 0; i < k && memcmp(mode, at->first[i], size) != 0; ++i) {}
        if (i == k) return 1;
    }
    while (known) {
        found = at->differing > 0 && sym_next_differing(p, at);
        while (!found && at->differing < p->n) found = sym_first_differing(p, at, 0, ++at->differing);
        if (!found) return 0;
        for (i = 0; i < p->n; ++i) mode[i] = (double)(sym_most_contact(p, i) - at->less[i]);
        for (i = 0, known = 0; i < SYM_FIRST_SETS; ++i) known |= memcmp(mode, at->first[i], size) == 0;
    }
    return 1;
}

/* Forces and modes of balls of which each acts on another, with the size of the whole problem. Where only one motion may agree all
 * sets are tried: of up to SYM_UNIQUE_UP_TO balls whose normal forces are determined. Of more than SYM_ALL_UP_TO balls as many sets
 * are tried as cost what all of so many do. Returns 0 or a status. */
static int32_t sym_solve_coupled(sym_contact_problem *p, int32_t unique) {
    const int32_t n = 3 * p->n;
    double d[2][2 * SYM_MOST_CONTACTS]; /* from which directions are sought: by friction where all stick, and the guess's */
    double mode[SYM_MOST_CONTACTS] = {0.0};
    const double more = fmax(1.0, (double)p->n / (double)SYM_ALL_UP_TO), most = (double)SYM_MOST_SETS / (more * more * more);
    double tried = 0.0;
    int32_t i, from, found = 0;
    sym_order_of_modes order = {{{0.0}}, 0, 0, {0}};
    sym_contact_problem first;
    for (i = 0; i < p->n; ++i) p->mode[i] = sym_most_contact(p, i);
    memcpy(order.first[0], p->mode, sizeof p->mode);
    sym_forces_of_modes(p); /* friction that keeps a ball from sliding shows where it begins to */
    for (i = 0; i < p->n; ++i) {
        const double x = p->f[3 * i], y = p->f[3 * i + 1], drag = hypot(x, y);
        if (!p->slides[i]) p->d[2 * i] = drag > 0.0 ? -x / drag : 1.0, p->d[2 * i + 1] = drag > 0.0 ? -y / drag : 0.0;
    }
    memcpy(d[0], p->d, sizeof d[0]), memcpy(d[1], p->d, sizeof d[1]);
    sym_guess_modes(p, order.first[2], order.first[3], d[1]);
    for (i = 0; i < p->n; ++i) order.first[1][i] = fmin(p->last[i], order.first[0][i]);
    unique = unique && p->n <= SYM_UNIQUE_UP_TO && sym_normals_are_determined(p);
    while (tried++ < most && sym_next_modes(p, &order, mode))
        for (from = 0; from < 2; ++from) {
            int32_t different = 0;
            memcpy(p->mode, mode, sizeof mode);
            for (i = 0; i < p->n; ++i) different |= p->mode[i] == SYM_SLIDES && memcmp(d[0] + 2 * i, d[1] + 2 * i, 2 * sizeof **d) != 0;
            if (from > 0 && !different) continue;
            memcpy(p->d, d[from], sizeof d[from]);
            if (!sym_try_modes(p)) continue;
            if (!found) {
                found = 1, first = *p;
                if (!unique) return 0;
                continue;
            }
            for (i = 0, different = 0; i < n; ++i) different |= fabs(p->c[i] - first.c[i]) > SYM_DIFFERENT * p->size;
            if (different) return SYM_CONTACTS_AMBIGUOUS;
        }
    if (!found) return SYM_NO_CONTACT_FORCE;
    *p = first;
    return 0;
}

/* Whether forces on two balls act on each other's. */
static int32_t sym_are_coupled(const sym_contact_problem *p, int32_t a, int32_t b) {
    const int32_t n = 3 * p->n;
    int32_t i, j;
    if (p->parts[a] || p->parts[b]) return 0;
    for (i = 3 * a; i < 3 * a + 3; ++i)
        for (j = 3 * b; j < 3 * b + 3; ++j) {
            const double across = fmax(fabs(p->W[n * i + j]), fabs(p->W[n * j + i]));
            if (across * across > SYM_UNCOUPLED * SYM_UNCOUPLED * p->W[(n + 1) * i] * p->W[(n + 1) * j]) return 1;
        }
    return 0;
}

/* The balls that belong to one (part: whose first ball they have) make a problem of their own, is solved, and goes back. */
static int32_t sym_solve_part(sym_contact_problem *p, const int32_t *part, int32_t first, int32_t unique) {
    const int32_t n = 3 * p->n;
    int32_t which[SYM_MOST_CONTACTS], m = 0, i, j, k, l, status;
    sym_contact_problem own;
    for (i = 0; i < p->n; ++i)
        if (part[i] == first) which[m++] = i;
    own.n = m, own.size = p->size, own.shared = 0;
    for (i = 0; i < m; ++i) {
        const int32_t ball = which[i];
        own.mu[i] = p->mu[ball], own.parts[i] = p->parts[ball], own.slides[i] = p->slides[ball], own.last[i] = p->last[ball];
        memcpy(own.d + 2 * i, p->d + 2 * ball, 2 * sizeof *own.d);
        memcpy(own.b + 3 * i, p->b + 3 * ball, 3 * sizeof *own.b);
        for (j = 0; j < m; ++j)
            for (k = 0; k < 3; ++k)
                for (l = 0; l < 3; ++l) own.W[3 * m * (3 * i + k) + 3 * j + l] = p->W[n * (3 * ball + k) + 3 * which[j] + l];
    }
    status = sym_solve_coupled(&own, unique);
    for (i = 0; i < m; ++i) {
        const int32_t ball = which[i];
        p->mode[ball] = own.mode[i];
        memcpy(p->d + 2 * ball, own.d + 2 * i, 2 * sizeof *own.d), memcpy(p->f + 3 * ball, own.f + 3 * i, 3 * sizeof *own.f);
    }
    p->shared |= own.shared;
    return status;
}

/* No ball is pressed: all are open. */
static void sym_leave_without_forces(sym_contact_problem *p) {
    int32_t i;
    for (i = 0; i < p->n; ++i) p->mode[i] = SYM_OPEN;
    for (i = 0; i < 3 * p->n; ++i) p->f[i] = 0.0, p->c[i] = p->b[i];
    p->shared = 0;
}

/* Forces and modes that agree with Coulomb's law, part by part. Returns 0 or a status. */
static int32_t sym_solve_contacts(sym_contact_problem *p, int32_t unique) {
    int32_t part[SYM_MOST_CONTACTS], i, j, k, status = 0;
    for (i = 0, p->size = 0.0; i < 3 * p->n; ++i) p->size = fmax(p->size, fabs(p->b[i]));
    if (p->size <= SYM_HELD_POINTS) {
        sym_leave_without_forces(p);
        return 0;
    }
    for (i = 0, p->shared = 0; i < p->n; ++i) {
        part[i] = i;
        for (j = 0; j < i; ++j) {
            const int32_t joins = part[j];
            if (part[i] == joins || !sym_are_coupled(p, i, j)) continue;
            for (k = 0; k < i; ++k)
                if (part[k] == joins) part[k] = part[i];
        }
    }
    for (i = 0; i < p->n && status == 0; ++i)
        if (part[i] == i) status = sym_solve_part(p, part, i, unique);
    for (i = 0; i < p->n && status == 0; ++i) sym_motion_of_ball(p, p->f, i, p->c + 3 * i);
    return status;
}
