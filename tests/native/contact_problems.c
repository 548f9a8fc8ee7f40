/* Random problems of rigid contacts through the shipped solver, each answer judged by its definition (docs/theory/constraints.md,
 * (46)), not by the solver's own tests. Arguments: number of balls, of problems, seed, of directions that are tried at random where
 * the solver has found none. Prints how many were certified, have several motions, none by enumeration, none by the directions
 * tried either, and were missed; and the largest residual of what is certified. */
#include "integrator.c"
#include <stdio.h>
#include <stdlib.h>

static uint64_t state;
static double uniform(void) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (double)(state >> 11) / 9007199254740992.0;
}
static double normal(void) { return sqrt(-2.0 * log(1.0 - uniform())) * cos(6.283185307179586 * uniform()); }

/* n balls of one body, every other time, or of a mechanism of as many degrees of freedom as come, or each between two of n
 * masses, so that some act on others by way of a third one alone: W = J M^-1 J^T, b = J a. */
static void draw(sym_contact_problem *p, int32_t n) {
    const int32_t body = uniform() < 0.5, masses = !body && uniform() < 0.5;
    const int32_t nv = body ? 6 : masses ? 3 * n : 3 + (int32_t)(uniform() * 3.0 * n);
    double J[SYM_MOST_FORCES][SYM_MOST_FORCES + 3], a[SYM_MOST_FORCES + 3], inverse[SYM_MOST_FORCES + 3];
    int32_t i, j, k;
    memset(p, 0, sizeof *p);
    p->n = n;
    for (k = 0; k < nv; ++k) a[k] = normal(), inverse[k] = body ? (k < 3 ? 1.0 : 0.5 + 4.0 * uniform()) : 1.0;
    for (i = 0; i < n; ++i) {
        const double x = normal(), y = normal(), z = body && uniform() < 0.5 ? -1.0 : normal(), turn = 6.283185307179586 * uniform();
        const double rows[3][6] = {{1, 0, 0, 0, z, -y}, {0, 1, 0, -z, 0, x}, {0, 0, 1, y, -x, 0}};
        const int32_t first = (int32_t)(uniform() * n), second = (int32_t)(uniform() * n);
        for (j = 0; j < 3; ++j)
            for (k = 0; k < nv; ++k) J[3 * i + j][k] = body ? rows[j][k] : !masses || k / 3 == first || k / 3 == second ? normal() : 0.0;
        p->mu[i] = uniform() < 0.1 ? 0.0 : uniform();
        p->parts[i] = uniform() < 0.1, p->slides[i] = uniform() < 0.3;
        p->d[2 * i] = cos(turn), p->d[2 * i + 1] = sin(turn);
    }
    if (body) a[2] = -1.0 - uniform(); /* it weighs */
    for (i = 0; i < 3 * n; ++i) {
        for (k = 0; k < nv; ++k) p->b[i] += J[i][k] * a[k];
        for (j = 0; j < 3 * n; ++j)
            for (k = 0; k < nv; ++k) p->W[3 * n * i + j] += J[i][k] * inverse[k] * J[j][k];
    }
}

/* Size of W: the largest entry of its diagonal. */
static double inertia(const sym_contact_problem *p) {
    double largest = 0.0;
    int32_t i;
    for (i = 0; i < 3 * p->n; ++i) largest = fmax(largest, p->W[(3 * p->n + 1) * i]);
    return largest;
}

/* Largest violation of (46) by forces f, over size/W: distance of f from its projection where c acts on it. */
static double residual(const sym_contact_problem *p, const double *f) {
    const double w = inertia(p);
    double worst = 0.0, size = 0.0;
    int32_t i, j, n = 3 * p->n;
    for (i = 0; i < n; ++i) size = fmax(size, fabs(p->b[i]));
    for (i = 0; i < p->n; ++i) {
        double c[3], wanted[3], limit, length, reach;
        for (j = 0; j < 3; ++j) {
            int32_t k;
            c[j] = p->b[3 * i + j];
            for (k = 0; k < n; ++k) c[j] += p->W[n * (3 * i + j) + k] * f[k];
        }
        wanted[2] = p->parts[i] ? 0.0 : fmax(0.0, f[3 * i + 2] - c[2] / w);
        limit = p->mu[i] * fmax(0.0, f[3 * i + 2]);
        for (j = 0; j < 2; ++j) wanted[j] = p->slides[i] ? -limit * p->d[2 * i + j] : f[3 * i + j] - c[j] / w;
        length = hypot(wanted[0], wanted[1]), reach = p->parts[i] ? 0.0 : length > limit ? limit / length : 1.0;
        wanted[0] *= reach, wanted[1] *= reach;
        for (j = 0; j < 3; ++j) worst = fmax(worst, fabs(f[3 * i + j] - wanted[j]));
    }
    return worst * w / size;
}

/* Whether modes agree with a motion after all, from many directions in which balls may begin to slide, drawn at random. */
static int32_t sought(sym_contact_problem *p, int32_t times) {
    const uint64_t before = state; /* problems are the same whatever becomes of them */
    int32_t code, sets = 1, found = 0, i, k;
    for (i = 0; i < p->n; ++i) sets *= 3;
    for (code = 0; code < sets && !found; ++code) {
        int32_t left = code, fits = 1, turns = 0;
        for (i = 0; i < p->n; ++i, left /= 3) {
            p->mode[i] = (double)(left % 3);
            fits &= !(p->parts[i] && left % 3 > 0) && !((p->slides[i] || p->mu[i] == 0.0) && left % 3 == 2);
            turns |= p->mode[i] == SYM_SLIDES && !p->slides[i] && p->mu[i] > 0.0;
        }
        for (k = 0; fits && !found && k < (turns ? times : 1); ++k) {
            for (i = 0; i < p->n; ++i) {
                const double angle = 6.283185307179586 * uniform();
                if (!p->slides[i]) p->d[2 * i] = cos(angle), p->d[2 * i + 1] = sin(angle);
            }
            found = sym_try_modes(p);
        }
    }
    state = before;
    return found;
}

/* Forces of the same motion within all cones, if balls that stick share a load: f moves between the cones and what changes
 * nothing, until both agree. */
static void share(const sym_contact_problem *p, double *f) {
    double A[SYM_MOST_FORCES * SYM_MOST_FORCES], null[SYM_MOST_FORCES * SYM_MOST_FORCES], x[SYM_MOST_FORCES], own[SYM_MOST_FORCES];
    const double none[SYM_MOST_FORCES] = {0.0};
    double least[SYM_MOST_FORCES], y[SYM_MOST_FORCES] = {0.0};
    int32_t which[SYM_MOST_CONTACTS], m = 0, i, j, k, l, count, round;
    for (i = 0; i < p->n; ++i)
        if (p->mode[i] == SYM_STICKS) which[m++] = i;
    for (i = 0; i < m; ++i)
        for (k = 0; k < 3; ++k) {
            own[3 * i + k] = least[3 * i + k] = p->f[3 * which[i] + k];
            for (j = 0; j < m; ++j)
                for (l = 0; l < 3; ++l) A[3 * m * (3 * i + k) + 3 * j + l] = p->W[3 * p->n * (3 * which[i] + k) + 3 * which[j] + l];
        }
    count = sym_least_norm(3 * m, A, none, x, null);
    for (round = 0; round < 20000; ++round) {
        double inside[SYM_MOST_FORCES], moved = 0.0;
        for (i = 0; i < m; ++i) { /* the nearest point of a cone that is a little narrower */
            const double mu = p->mu[which[i]] * (1.0 - 1e-9), t = hypot(own[3 * i], own[3 * i + 1]), z = own[3 * i + 2];
            double to = 1.0, up = z;
            if (t > mu * z) {
                up = fmax(0.0, (mu * t + z) / (1.0 + mu * mu));
                to = t > 0.0 ? mu * up / t : 0.0;
            }
            inside[3 * i] = own[3 * i] * to, inside[3 * i + 1] = own[3 * i + 1] * to, inside[3 * i + 2] = up;
        }
        for (j = 0; j < count; ++j) {
            double along = 0.0;
            for (i = 0; i < 3 * m; ++i) along += null[3 * m * j + i] * (inside[i] - own[i]);
            y[j] += 1.5 * along, moved = fmax(moved, fabs(along));
        }
        for (i = 0; i < 3 * m; ++i)
            for (j = 0, own[i] = least[i]; j < count; ++j) own[i] += y[j] * null[3 * m * j + i];
        if (moved < 1e-17) break;
    }
    for (i = 0; i < m; ++i)
        for (k = 0; k < 3; ++k) f[3 * which[i] + k] = own[3 * i + k];
}

int main(int n, char **word) {
    const int32_t balls = atoi(word[1]), total = atoi(word[2]);
    int32_t i, k, certified = 0, several = 0, none = 0, nowhere = 0, missed = 0, times;
    double worst = 0.0;
    state = 88172645463325252u + 7919u * (uint64_t)atoi(word[3]);
    if (n < 5) return 1;
    times = atoi(word[4]);
    for (k = 0; k < total; ++k) {
        sym_contact_problem p;
        double f[SYM_MOST_FORCES], off;
        int32_t status, known = 1;
        draw(&p, balls);
        for (i = 0; i < balls; ++i) known &= p.parts[i] || p.slides[i] || p.mu[i] == 0.0;
        status = sym_solve_contacts(&p, 1);
        if (status == SYM_CONTACTS_AMBIGUOUS) {
            ++several;
            continue;
        }
        if (status != 0) {
            if (known) ++none;
            else if (times > 0 && sought(&p, times)) ++missed;
            else ++nowhere;
            continue;
        }
        memcpy(f, p.f, sizeof f);
        if (p.shared) share(&p, f);
        off = residual(&p, f);
        if (off <= 1e-12) ++certified, worst = fmax(worst, off);
        else ++missed;
    }
    printf("%d %d %d %d %d %d %.2g\n", balls, certified, several, none, nowhere, missed, worst);
    return 0;
}
