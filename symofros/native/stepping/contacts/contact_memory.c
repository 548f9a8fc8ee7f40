/* Scratch of rigid contacts, and what is remembered of their balls from step to step. */

/* Parts of the scratch. */
typedef struct sym_contact_scratch {
    double *par;          /* (npar) */
    double *a, *lam;      /* (nv), (nc) without what is added */
    double *change_a, *change_lam; /* (n, nv), (n, nc) by unit normal forces on balls that slide */
    double *free_a;       /* (nv) acceleration without the forces of an instant's balls */
    double *effect;       /* (3 n, nv) what unit forces on them add */
    double *v;            /* (nv) speeds */
    double *kept_a, *kept_lam; /* (nv), (nc) */
    double *drag;         /* (n, nv) generalised friction by unit normal forces on balls that slide; of implicit steps */
} sym_contact_scratch;

/* Where the parts begin from a base on. Returns how many entries all of them have. */
static size_t sym_lay_out_contacts(const sym_system *s, double *base, sym_contact_scratch *at) {
    const size_t n = (size_t)s->n_contacts, nv = (size_t)s->nv, nc = (size_t)s->nc;
    const size_t sizes[] = {(size_t)s->npar, nv, nc, n * nv, n * nc, nv, 3 * n * nv, nv, nv, nc, n * nv};
    double **const parts[] = {&at->par, &at->a, &at->lam, &at->change_a, &at->change_lam, &at->free_a, &at->effect, &at->v, &at->kept_a, &at->kept_lam, &at->drag};
    size_t i, end = 0;
    for (i = 0; i < sizeof sizes / sizeof *sizes; end += sizes[i++])
        if (base != NULL) *parts[i] = base + end;
    return end;
}

static sym_contact_scratch sym_scratch_of_contacts(const sym_run *r) {
    sym_contact_scratch scratch;
    (void)sym_lay_out_contacts(r->system, r->system->contact_work, &scratch);
    return scratch;
}

SYM_EXPORT size_t sym_contact_work_size(const sym_system *s) {
    sym_contact_scratch scratch;
    return s->n_contacts == 0 ? 0 : sym_lay_out_contacts(s, NULL, &scratch);
}

SYM_EXPORT size_t sym_contact_memory_size(const sym_system *s) {
    return s->n_contacts == 0 ? 0 : SYM_BALL_ENTRIES * (size_t)s->n_contacts + 3;
}

/* What is remembered of a ball; of all of them: whether modes have been chosen, whether a load is shared, and when balls struck
 * in sequence last because no motion was found in which they do at once. */
static double *sym_ball_memory(const sym_system *s, int32_t ball) { return s->contact_memory + SYM_INDEX(ball, SYM_BALL_ENTRIES, 0); }
static double *sym_modes_chosen(const sym_system *s) { return sym_ball_memory(s, s->n_contacts); }
static double *sym_load_shared(const sym_system *s) { return sym_ball_memory(s, s->n_contacts) + 1; }
static double *sym_struck_in_sequence(const sym_system *s) { return sym_ball_memory(s, s->n_contacts) + 2; }

SYM_EXPORT void sym_run_forget_contacts(sym_run *r) {
    const sym_system *s = r->system;
    int32_t i;
    for (i = 0; i < s->n_contacts; ++i) {
        double *known = sym_ball_memory(s, i);
        known[0] = r->par[s->contacts[i].way[0]], known[1] = r->par[s->contacts[i].way[1]], known[2] = 0.0, known[3] = known[4] = -HUGE_VAL;
    }
    if (s->n_contacts > 0) *sym_modes_chosen(s) = *sym_load_shared(s) = 0.0, *sym_struck_in_sequence(s) = -HUGE_VAL;
}
