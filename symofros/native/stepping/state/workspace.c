/* Working memory of a run, laid out in sym_run.work. */

typedef struct sym_implicit_workspace { /* n = nv + nc; empty for explicit methods */
    double *matrix;                      /* (n, n) Newton's or a Rosenbrock step's, then its factors */
    double *scale;                       /* (n) of the factors */
    double *right, *solution, *scratch;  /* (n) */
    double *correction, *tried;          /* (n) of damped Newton iteration */
    double *unknowns;                    /* (2 n) of the equations of a step, and their guess */
    double *history;                     /* (2 nv) what a step leaves to the next one */
    double *time_slope;                  /* (2 nv) partial derivative of the slope by time; else work */
    double *stages;                      /* (stages + 3, 2 nv) solutions U of Rosenbrock stages; else work */
} sym_implicit_workspace;

typedef struct sym_input_defects { /* of each signal over a step: input_moments.c; rows for nu, which signals never exceed */
    double *impulse, *moment; /* (nu) integrals of the input and of its moment, less what the method makes of them */
    double *total, *size;     /* (nu) the integral itself; the input's largest change */
    double *effect;           /* (nu, nv) accelerations by the input */
} sym_input_defects;

typedef struct sym_workspace { /* m = 2 nv entries of y */
    double *y1;          /* (m) y at the end of the step being tried */
    double *stage;       /* (m) y at a stage; else work */
    double *magnitude;   /* (m) sizes of the entries of y at the start of the step */
    double *end_slope;   /* (m) slope at the end of the step, for the cubic dense output */
    double *unseen;      /* (3 nv) of a look within a quiet step */
    double *end_state;   /* (nq + nv) q, v at the end of the step, projected where the run projects */
    double *k;           /* (dense_stages, m) slopes of the stages */
    size_t stage_stride; /* doubles from the slope of one stage to that of the next */
    sym_input_defects defects;
    sym_implicit_workspace implicit;
} sym_workspace;

static sym_input_defects sym_allocate_defects(const sym_system *s, sym_arena *arena) {
    const size_t n = (size_t)s->nu;
    sym_input_defects d;
    d.impulse = sym_allocate(arena, n), d.moment = sym_allocate(arena, n), d.total = sym_allocate(arena, n);
    d.size = sym_allocate(arena, n), d.effect = sym_allocate(arena, n * (size_t)s->nv);
    return d;
}

static sym_workspace sym_allocate_workspace(const sym_run *r, sym_arena *arena) {
    const size_t nv = (size_t)r->system->nv, n = nv + (size_t)r->system->nc, m = 2 * nv;
    const size_t slopes = r->tableau.dense_stages > 1 ? (size_t)r->tableau.dense_stages : 1;
    sym_workspace w;
    w.y1 = sym_allocate(arena, m), w.stage = sym_allocate(arena, m), w.magnitude = sym_allocate(arena, m);
    w.end_slope = sym_allocate(arena, m), w.end_state = sym_allocate(arena, (size_t)r->system->nq + nv), w.k = sym_allocate(arena, slopes * m), w.stage_stride = m;
    w.unseen = sym_allocate(arena, 3 * nv);
    w.defects = sym_allocate_defects(r->system, arena);
    memset(&w.implicit, 0, sizeof w.implicit);
    if (r->method > SYM_METHOD_SEMI_IMPLICIT) {
        sym_implicit_workspace *implicit = &w.implicit;
        implicit->matrix = sym_allocate(arena, n * n), implicit->scale = sym_allocate(arena, n);
        implicit->right = sym_allocate(arena, n);
        implicit->solution = sym_allocate(arena, n), implicit->scratch = sym_allocate(arena, n);
        implicit->correction = sym_allocate(arena, n), implicit->tried = sym_allocate(arena, n);
        implicit->unknowns = sym_allocate(arena, 2 * n);
        implicit->history = sym_allocate(arena, m), implicit->time_slope = sym_allocate(arena, m);
        implicit->stages = sym_allocate(arena, m * ((size_t)r->tableau.stages + 3));
    }
    return w;
}

SYM_EXPORT size_t sym_run_work_size(const sym_run *r) {
    sym_arena arena = {NULL, 0};
    sym_allocate_workspace(r, &arena);
    return arena.used;
}

static sym_workspace sym_workspace_of(const sym_run *r) {
    sym_arena arena;
    arena.base = r->work, arena.used = 0;
    return sym_allocate_workspace(r, &arena);
}
