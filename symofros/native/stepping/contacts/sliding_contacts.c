/* Forces of rigid contacts while balls slide, and their derivatives (docs/theory/constraints.md, section 15, (41), (41a)). */

/* Coefficient of friction of a ball: of parameters alone, so that it is that of any evaluation of its state. */
static double sym_friction_of(const sym_system *s, int32_t ball) {
    return s->contact_state.out[0][SYM_CONTACT_ENTRIES * ball + 4];
}

/* What a slip has along the way in which the ball has begun to slide. */
static double sym_along_way(const double *par, const sym_rigid_contact *of, const double *slip) {
    return par[of->way[0]] * slip[0] + par[of->way[1]] * slip[1];
}

/* Cosine of the angle from the direction in which sliding began beyond which a slip has passed rest: one that turns past the
 * right angle at which a mode ends has not. */
#define SYM_PASSED_REST -0.7

/* Direction (2) in which a ball slides by its slip u: the last known one where the slip is so small that a step of this length
 * can't follow how it turns, and opposite to the slip where this has passed rest since it began, so that a step beyond the end
 * of a mode is as smooth as the one before, (41b). */
static void sym_slip_direction(const double *par, const sym_rigid_contact *of, const double *u, const double *known, double *d) {
    const double slip = hypot(u[0], u[1]);
    memcpy(d, known, 2 * sizeof *d);
    if (slip <= SYM_RESTS_AT || slip <= known[2]) return;
    d[0] = u[0] / slip, d[1] = u[1] / slip;
    if (sym_along_way(par, of, d) < SYM_PASSED_REST) d[0] = -d[0], d[1] = -d[1];
}

/* At the end of a step: the directions of balls that slide. */
static void sym_keep_directions(sym_run *r) {
    const sym_system *s = r->system;
    int32_t i, sliding = 0;
    for (i = 0; i < s->n_contacts; ++i) sliding |= r->par[s->contacts[i].mode] == SYM_SLIDES;
    if (!sliding) return;
    sym_load_state(r);
    sym_evaluate(&s->contact_state);
    for (i = 0; i < s->n_contacts; ++i) {
        const double *state = s->contact_state.out[0] + SYM_CONTACT_ENTRIES * i, slip = hypot(state[1], state[2]);
        double *known = sym_ball_memory(s, i);
        if (r->par[s->contacts[i].mode] != SYM_SLIDES) continue;
        if (slip > SYM_RESTS_AT && slip > known[2] && sym_along_way(r->par, s->contacts + i, state + 1) > 0.0)
            known[0] = state[1] / slip, known[1] = state[2] / slip;
    }
}

/* x with A x = b (n x n, n <= SYM_MOST_CONTACTS), in place of b, without changes of rows: whether all leading minors are
 * positive. */
static int32_t sym_solve_sliding(int32_t n, double *A, double *b) {
    int32_t i, j, k;
    for (k = 0; k < n; ++k) {
        if (!(A[n * k + k] > SYM_FORCE_ROUNDING)) return 0;
        for (i = k + 1; i < n; ++i) {
            const double factor = A[n * i + k] / A[n * k + k];
            for (j = k; j < n; ++j) A[n * i + j] -= factor * A[n * k + j];
            b[i] -= factor * b[k];
        }
    }
    for (k = n - 1; k >= 0; --k) {
        for (j = k + 1; j < n; ++j) b[k] -= A[n * k + j] * b[j];
        b[k] /= A[n * k + k];
    }
    return 1;
}

/* Accelerations and multipliers at the evaluation point, those without sliding friction, become those with it, (41); the
 * multipliers across the normals of balls that slide become their friction. The inputs are known. Returns 0 or a status. */
static int32_t sym_add_sliding(sym_run *r, const double *par) {
    const sym_system *s = r->system;
    const size_t nv = (size_t)s->nv, nc = (size_t)s->nc;
    const sym_contact_scratch scratch = sym_scratch_of_contacts(r);
    double A[SYM_MOST_CONTACTS * SYM_MOST_CONTACTS], f[SYM_MOST_CONTACTS], d[SYM_MOST_CONTACTS][2];
    int32_t which[SYM_MOST_CONTACTS], n = 0, i, j, status = 0;
    size_t l;
    for (i = 0; i < s->n_contacts; ++i)
        if (par[s->contacts[i].mode] == SYM_SLIDES) which[n++] = i;
    if (n == 0) return 0;
    sym_evaluate(&s->contact_state);
    for (j = 0; j < n; ++j) {
        const double *slip = s->contact_state.out[0] + SYM_CONTACT_ENTRIES * which[j] + 1;
        sym_slip_direction(par, s->contacts + which[j], slip, sym_ball_memory(s, which[j]), d[j]);
    }
    memcpy(scratch.par, par, (size_t)s->npar * sizeof *par);
    memcpy(scratch.a, s->a, nv * sizeof *s->a), memcpy(scratch.lam, s->lam, nc * sizeof *s->lam);
    for (j = 0; j < n && status == 0; ++j) {
        const sym_rigid_contact *of = s->contacts + which[j];
        double *a = scratch.change_a + (size_t)j * nv, *lam = scratch.change_lam + (size_t)j * nc;
        for (i = 0; i < 2; ++i) scratch.par[of->push[i]] = -sym_friction_of(s, which[j]) * d[j][i];
        sym_prepare_call(&s->forward_dynamics, scratch.par);
        sym_evaluate(&s->forward_dynamics);
        for (i = 0; i < 2; ++i) scratch.par[of->push[i]] = par[of->push[i]];
        if (*s->rank < 0.0) status = SYM_SINGULAR;
        for (l = 0; l < nv; ++l) a[l] = s->a[l] - scratch.a[l];
        for (l = 0; l < nc; ++l) lam[l] = s->lam[l] - scratch.lam[l];
    }
    sym_prepare_call(&s->forward_dynamics, par);
    if (status != 0) return status;
    for (i = 0; i < n; ++i) {
        const int32_t row = s->contacts[which[i]].row[2];
        f[i] = scratch.lam[row];
        for (j = 0; j < n; ++j) A[n * i + j] = (i == j) - scratch.change_lam[(size_t)j * nc + (size_t)row];
    }
    if (!sym_solve_sliding(n, A, f)) return SYM_NO_CONTACT_FORCE;
    memcpy(s->a, scratch.a, nv * sizeof *s->a), memcpy(s->lam, scratch.lam, nc * sizeof *s->lam);
    for (j = 0; j < n; ++j) {
        for (l = 0; l < nv; ++l) s->a[l] += scratch.change_a[(size_t)j * nv + l] * f[j];
        for (l = 0; l < nc; ++l) s->lam[l] += scratch.change_lam[(size_t)j * nc + l] * f[j];
    }
    for (j = 0; j < n; ++j)
        for (i = 0; i < 2; ++i) s->lam[s->contacts[which[j]].row[i]] = -sym_friction_of(s, which[j]) * d[j][i] * f[j];
    return sym_all_finite(s->nv, s->a) ? 0 : SYM_DIVERGED;
}

/* Terms of one ball that slides, (41a), in the outputs of implicit_terms with its rows across the normal, which become zero. drag
 * (nv): what a unit normal force has as generalised friction. */
static void sym_slope_of_friction(sym_run *r, int32_t ball, double *drag) {
    const sym_system *s = r->system;
    const sym_rigid_contact *of = s->contacts + ball;
    const int32_t nv = s->nv, nu = s->nu, x = of->row[0], y = of->row[1];
    double *const *terms = s->implicit_terms.out;
    double *const rows[] = {terms[SYM_TERM_G], terms[SYM_TERM_RATE_Q], terms[SYM_TERM_R_Q] + SYM_INDEX(nv, nv, 0), terms[SYM_TERM_R_V] + SYM_INDEX(nv, nv, 0)};
    const double *slip = s->contact_state.out[0] + SYM_CONTACT_ENTRIES * ball + 1, *G_x = rows[0] + SYM_INDEX(x, nv, 0), *G_y = rows[0] + SYM_INDEX(y, nv, 0);
    const double *u_x = rows[1] + SYM_INDEX(x, nv, 0), *u_y = rows[1] + SYM_INDEX(y, nv, 0), mu = sym_friction_of(s, ball);
    const double *known = sym_ball_memory(s, ball);
    double d[2], turn = 0.0;
    int32_t i, j;
    size_t k;
    sym_slip_direction(r->par, of, slip, known, d);
    if (hypot(slip[0], slip[1]) > fmax(SYM_RESTS_AT, known[2])) /* the slip, against d where it has passed rest */
        turn = mu * s->lam[of->row[2]] / (slip[0] * d[0] + slip[1] * d[1]);
    for (i = 0; i < nv; ++i) {
        const double across = turn * (d[0] * G_y[i] - d[1] * G_x[i]);
        drag[i] = mu * (d[0] * G_x[i] + d[1] * G_y[i]);
        for (j = 0; j < nv; ++j) {
            terms[SYM_TERM_R_V][SYM_INDEX(i, nv, j)] += across * (d[0] * G_y[j] - d[1] * G_x[j]);
            terms[SYM_TERM_R_Q][SYM_INDEX(i, nv, j)] += across * (d[0] * u_y[j] - d[1] * u_x[j]);
        }
    }
    for (k = 0; k < sizeof rows / sizeof *rows; ++k)
        for (j = 0; j < nv; ++j) rows[k][SYM_INDEX(x, nv, j)] = rows[k][SYM_INDEX(y, nv, j)] = 0.0;
    for (j = 0; j < nu; ++j) terms[SYM_TERM_R_U][SYM_INDEX(nv + x, nu, j)] = terms[SYM_TERM_R_U][SYM_INDEX(nv + y, nu, j)] = 0.0;
}

/* implicit_terms at the evaluation point, whose accelerations and multipliers are known, with friction of balls that slide. */
static void sym_evaluate_sliding_terms(sym_run *r) {
    const sym_system *s = r->system;
    const sym_contact_scratch scratch = sym_scratch_of_contacts(r);
    int32_t i, sliding = 0;
    memcpy(scratch.par, r->par, (size_t)s->npar * sizeof *r->par);
    for (i = 0; i < s->n_contacts; ++i) {
        double *mode = scratch.par + s->contacts[i].mode;
        if (*mode == SYM_SLIDES) *mode = SYM_STICKS, sliding = 1; /* for the rows across its normal */
    }
    if (sliding) sym_prepare_call(&s->implicit_terms, scratch.par);
    sym_evaluate(&s->implicit_terms);
    if (!sliding) return;
    sym_prepare_call(&s->implicit_terms, r->par);
    sym_evaluate(&s->contact_state);
    for (i = 0; i < s->n_contacts; ++i)
        if (r->par[s->contacts[i].mode] == SYM_SLIDES) sym_slope_of_friction(r, i, scratch.drag + (size_t)i * (size_t)s->nv);
}

/* Friction by the normal forces of balls that slide, in the columns of these in the matrix (nv + nc, nv + nc) of (5). */
static void sym_add_drag(const sym_run *r, double *matrix) {
    const sym_system *s = r->system;
    const int32_t nv = s->nv, n = nv + s->nc;
    const double *drag = sym_scratch_of_contacts(r).drag;
    int32_t b, i;
    for (b = 0; b < s->n_contacts; ++b, drag += nv) {
        if (r->par[s->contacts[b].mode] != SYM_SLIDES) continue;
        for (i = 0; i < nv; ++i) matrix[SYM_INDEX(i, n, nv + s->contacts[b].row[2])] += drag[i];
    }
}
