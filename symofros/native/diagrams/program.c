/* Programs: symofros_program.h. Memory is one run of doubles; structs lie in it as well, each from a double's boundary. */

static void *sym_place_for(sym_cursor *at, size_t bytes) { return sym_take(at, (bytes + sizeof(double) - 1) / sizeof(double)); }

static void sym_program_call(sym_assembly *it, sym_cursor *at, sym_call *call, const char *name) {
    const sym_model *m = it->program->instants();
    const sym_function *f = sym_find(m, name, NULL);
    double *work = sym_take(at, sym_work(m));
    int32_t i;
    call->function = f, call->pre = it->pre, call->work = work;
    for (i = 0; f != NULL && i < f->n_out; ++i)
        call->out[i] = sym_take(at, (size_t)f->out[i].rows * (size_t)f->out[i].cols);
    if (at->base != NULL && f != NULL) sym_diagram_bind(&it->diagram, call);
}

static void sym_program_stages(sym_assembly *it, sym_cursor *at) {
    const sym_program *p = it->program;
    sym_stage spare;
    char name[32];
    int32_t i;
    for (i = 0; i < p->n_sets; ++i) {
        sym_stage *stage = at->base == NULL ? &spare : &it->stages[i];
        stage->opaque = -1;
        sym_program_call(it, at, &stage->call, p->due[i]);
        if (at->base != NULL) it->sets[i].n = 1, it->sets[i].records = 0, it->sets[i].stages = stage;
    }
    for (i = 0; i < p->n_crossings; ++i) {
        sym_stage *stage = at->base == NULL ? &spare : &it->crossings[i];
        snprintf(name, sizeof name, "crossed_%d", (int)i);
        stage->opaque = -1;
        sym_program_call(it, at, &stage->call, name);
    }
}

/* Every array and struct. */
static void sym_program_furnish(sym_assembly *it, sym_cursor *at) {
    const sym_program *p = it->program;
    const sym_model *m = p->instants();
    sym_diagram *d = &it->diagram;
    sym_run **runs = sym_place_for(at, (size_t)p->n_parts * sizeof *runs);
    int32_t i;
    memset(d, 0, sizeof *d);
    d->n_parts = p->n_parts, d->parts = runs, d->q_at = p->q_at, d->v_at = p->v_at, d->c_at = p->c_at;
    d->nq = m->nq, d->nv = m->nv, d->nu = m->nu, d->nc = m->nc;
    d->n_signals = p->n_signals, d->signals = p->signals, d->looks_back = p->looks_back;
    d->n_engaging = p->n_engaging, d->engaging = p->engaging, d->engaged = sym_take(at, (size_t)p->n_engaging);
    d->base_n = p->base_n, d->base_d = p->base_d, d->cycle = p->cycle, d->n_instants = p->n_instants;
    d->instant = p->instant, d->set = p->set, d->n_crossings = p->n_crossings;
    d->q = sym_take(at, (size_t)m->nq), d->v = sym_take(at, (size_t)m->nv), d->u = sym_take(at, (size_t)m->nu);
    d->t = sym_take(at, 1), d->a = sym_take(at, (size_t)m->nv), d->lam = sym_take(at, (size_t)m->nc);
    it->par = sym_take(at, (size_t)m->npar), it->pre = sym_take(at, (size_t)m->npre);
    it->parts = sym_place_for(at, (size_t)p->n_parts * sizeof *it->parts);
    it->stages = sym_place_for(at, (size_t)p->n_sets * sizeof *it->stages);
    it->sets = sym_place_for(at, (size_t)p->n_sets * sizeof *it->sets);
    it->crossings = sym_place_for(at, (size_t)p->n_crossings * sizeof *it->crossings);
    d->sets = it->sets, d->crossings = it->crossings;
    /* Room for a crossing's two records, which nobody reads; it is emptied after each step of the caller's. */
    d->capacity = 8, d->found_capacity = 4;
    d->record_t = sym_take(at, 8), d->record_q = sym_take(at, 8 * (size_t)m->nq);
    d->record_v = sym_take(at, 8 * (size_t)m->nv), d->record_u = sym_take(at, 8 * (size_t)m->nu);
    d->found_t = sym_take(at, 4), d->found_which = sym_place_for(at, 4 * sizeof(int32_t));
    sym_program_stages(it, at);
    sym_program_call(it, at, &it->outputs, "signals");
    it->signals = sym_take(at, (size_t)p->n_outputs);
    for (i = 0; i < p->n_parts; ++i) {
        const size_t size = sym_instance_size(p->parts[i]());
        const sym_model *part = p->parts[i]()->model();
        void *memory = sym_place_for(at, size);
        double *watched = sym_take(at, 4 * (size_t)p->n_crossings);
        double *found = sym_take(at, (size_t)p->n_crossings * (2 + (size_t)part->nq + (size_t)part->nv));
        sym_run *r;
        sym_scene *s;
        if (at->base == NULL) continue;
        it->parts[i] = sym_instance_in(memory, size, p->parts[i]());
        if (it->parts[i] == NULL) continue;
        r = runs[i] = &it->parts[i]->run, s = &it->parts[i]->scene;
        s->constant = d->u, s->n_signals = p->n_signals, s->signals = p->signals;
        r->project = it->parts[i]->projects, r->h = p->parts[i]()->h;
        if (p->n_crossings > 0) {
            const size_t n = (size_t)p->n_crossings;
            s->events.function = sym_find(part, "formulas", NULL);
            s->events.pre = it->parts[i]->pre, s->events.work = it->parts[i]->work, s->events.out[0] = watched + 3 * n;
            s->n_events = s->events.function != NULL ? p->n_crossings : 0;
            s->event_direction = p->directions, s->event_terminal = p->all_end;
            r->event = watched, r->event_capacity = p->n_crossings;
            r->found_t = found, r->found_q = found + n, r->found_v = r->found_q + n * (size_t)part->nq;
            r->found_which = (int32_t *)(void *)(r->found_v + n * (size_t)part->nv);
            if (s->n_events > 0) sym_bind(s, &s->events);
        }
    }
}

static size_t sym_assembly_head(void) { return (sizeof(sym_assembly) + sizeof(double) - 1) / sizeof(double); }

SYM_EXPORT size_t sym_program_size(const sym_program *program) {
    sym_assembly draft;
    sym_cursor at = {NULL, 0};
    memset(&draft, 0, sizeof draft);
    draft.program = program;
    sym_program_furnish(&draft, &at);
    return (sym_assembly_head() + at.used) * sizeof(double);
}

SYM_EXPORT void sym_program_prepare(sym_assembly *it) {
    int32_t i;
    it->program->instants()->init(it->par, it->pre);
    for (i = 0; i < it->program->n_parts; ++i) {
        sym_instance *part = it->parts[i];
        memcpy(part->par, it->par, (size_t)part->model->npar * sizeof(double));
        sym_instance_prepare(part);
        part->run.fresh = 0;
    }
}

/* The signals of the present time; accelerations and multipliers are those under the inputs held now. */
static int32_t sym_program_listen(sym_assembly *it) {
    const sym_function *f = it->outputs.function;
    double *into = it->signals;
    int32_t i, status;
    sym_gather(&it->diagram, *it->diagram.t);
    if (f == NULL) return 0;
    if (it->diagram.looks_back && (status = sym_look_back(&it->diagram)) != 0) return status;
    sym_evaluate(&it->outputs);
    for (i = 0; i < f->n_out; ++i) {
        const size_t n = (size_t)f->out[i].rows * (size_t)f->out[i].cols;
        memcpy(into, it->outputs.out[i], n * sizeof *into);
        into += n;
    }
    return 0;
}

SYM_EXPORT sym_assembly *sym_program_in(void *memory, size_t size, const sym_program *program) {
    sym_assembly *it = memory;
    sym_cursor at = {NULL, 0};
    int32_t i;
    if (memory == NULL || size < sym_program_size(program)) return NULL;
    memset(memory, 0, size);
    it->program = program;
    at.base = (double *)memory + sym_assembly_head();
    sym_program_furnish(it, &at);
    memcpy(it->diagram.u, program->u_start, (size_t)it->diagram.nu * sizeof(double));
    for (i = 0; i < program->n_engaging; ++i) it->diagram.engaged[i] = it->diagram.u[program->engaging[i]];
    memcpy(it->par, program->instants()->par_default, (size_t)program->instants()->npar * sizeof(double));
    for (i = 0; i < program->n_parts; ++i)
        if (it->parts[i] == NULL) return NULL;
    sym_program_prepare(it);
    for (i = 0; i < program->n_parts; ++i) {
        if (it->parts[i]->projects && sym_instance_close(it->parts[i]) != 0) return NULL;
        if (sym_start(&it->parts[i]->run) < 0) return NULL;
    }
    if (sym_diagram_start(&it->diagram) != 0) return NULL;
    return it;
}

SYM_EXPORT int32_t sym_program_advance(sym_assembly *it, double t) {
    sym_diagram *d = &it->diagram;
    int32_t status = SYM_GOING;
    d->t_end = t, d->ended = 0;
    while (status == SYM_GOING || status == SYM_FULL) {
        d->n_records = d->n_found = 0;
        status = sym_diagram_advance(d, 1);
    }
    d->n_records = d->n_found = 0;
    if (status != SYM_DONE) return status;
    status = sym_program_listen(it);
    return status == 0 ? SYM_DONE : status;
}
