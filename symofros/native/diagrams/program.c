/* Exported diagrams: symofros_program.h. */

/* Rows of records in a program, which nobody reads: they are emptied after each step of the caller's. */
enum { SYM_PROGRAM_RECORDS = 2 * SYM_RECORDS_PER_INSTANT };

/* A function of the instants' model as a call at the diagram's point; absent ones stay NULL. */
static void sym_program_bind(sym_program_instance *instance, sym_arena *arena, sym_call *call, const char *name) {
    const sym_model *m = instance->program->instants();
    const sym_point point = sym_diagram_point(&instance->diagram);
    sym_bind_function(arena, call, sym_find(m, name, NULL), instance->pre, instance->work, &point);
}

static void sym_program_bind_task(sym_program_instance *instance, sym_arena *arena, sym_task *task, const char *name) {
    sym_task draft; /* while the arena only counts, there is no task to write to */
    if (arena->base == NULL) task = &draft;
    memset(task, 0, sizeof *task);
    task->callback = -1;
    sym_program_bind(instance, arena, &task->call, name);
}

static void sym_program_bind_tasks(sym_program_instance *instance, sym_arena *arena) {
    const sym_program *p = instance->program;
    char name[32];
    int32_t i;
    for (i = 0; i < p->n_sets; ++i) {
        sym_program_bind_task(instance, arena, instance->tasks + i, p->set_functions[i]);
        if (arena->base != NULL) instance->task_sets[i].n = 1, instance->task_sets[i].tasks = &instance->tasks[i];
    }
    for (i = 0; i < p->n_crossings; ++i) {
        snprintf(name, sizeof name, "crossed_%d", (int)i);
        sym_program_bind_task(instance, arena, instance->crossing_tasks + i, name);
    }
    sym_program_bind_task(instance, arena, &instance->begin_task, "begun");
    if (instance->begin_task.call.function != NULL) instance->diagram.begin_task = &instance->begin_task;
}

/* Time and step of a part as at the start. */
static void sym_program_rewind_part(sym_instance *part) {
    part->run.t = part->run.t0 = part->run.t_end = 0.0, part->run.h = part->plant->h;
}

/* One part: its instance, which reads the diagram's inputs. Its events are handled by the diagram. */
static void sym_program_allocate_part(sym_program_instance *instance, sym_arena *arena, int32_t i) {
    const sym_program *p = instance->program;
    const sym_plant *plant = p->parts[i]();
    const size_t size = sym_instance_size(plant);
    void *memory = sym_allocate_bytes(arena, size);
    sym_instance *part;
    if (arena->base == NULL) return;
    part = instance->parts[i] = sym_instance_init(memory, size, plant);
    if (part == NULL) return;
    instance->diagram.parts[i] = &part->run;
    part->system.u_constant = instance->diagram.u;
    part->system.n_signals = p->n_signals, part->system.signals = p->signals;
    part->run.project = part->project, part->run.acts = 0;
    part->actions.at_once = part->run.adaptive ? 0.0 : SYM_AT_ONCE * plant->h;
    sym_program_rewind_part(part);
}

/* Lay out every array and struct. */
static void sym_program_allocate(sym_program_instance *instance, sym_arena *arena) {
    const sym_program *p = instance->program;
    const sym_model *m = p->instants();
    const size_t nq = (size_t)m->nq, nv = (size_t)m->nv, nu = (size_t)m->nu, nc = (size_t)m->nc;
    sym_diagram *d = &instance->diagram;
    int32_t i;
    memset(d, 0, sizeof *d);
    d->n_parts = p->n_parts, d->parts = sym_allocate_bytes(arena, (size_t)p->n_parts * sizeof *d->parts);
    d->q_offset = p->q_offset, d->v_offset = p->v_offset, d->c_offset = p->c_offset;
    d->nq = m->nq, d->nv = m->nv, d->nu = m->nu, d->nc = m->nc;
    d->n_signals = p->n_signals, d->signals = p->signals, d->reads_accelerations = p->reads_accelerations;
    d->n_locks = p->n_locks, d->lock_inputs = p->lock_inputs;
    d->lock_values = sym_allocate(arena, (size_t)p->n_locks);
    d->base_numerator = p->base_numerator, d->base_denominator = p->base_denominator;
    d->cycle_ticks = p->cycle_ticks, d->n_instants = p->n_instants;
    d->instant_tick = p->instant_tick, d->instant_set = p->instant_set, d->n_crossings = p->n_crossings;
    d->q = sym_allocate(arena, nq), d->v = sym_allocate(arena, nv), d->u = sym_allocate(arena, nu);
    instance->inputs = d->u; /* inlets come first */
    d->t = sym_allocate(arena, 1), d->a = sym_allocate(arena, nv), d->lam = sym_allocate(arena, nc);
    instance->par = sym_allocate(arena, (size_t)m->npar), instance->pre = sym_allocate(arena, (size_t)m->npre);
    instance->work = sym_allocate(arena, sym_work(m));
    instance->parts = sym_allocate_bytes(arena, (size_t)p->n_parts * sizeof *instance->parts);
    instance->tasks = sym_allocate_bytes(arena, (size_t)p->n_sets * sizeof *instance->tasks);
    instance->task_sets = sym_allocate_bytes(arena, (size_t)p->n_sets * sizeof *instance->task_sets);
    instance->crossing_tasks = sym_allocate_bytes(arena, (size_t)p->n_crossings * sizeof *instance->crossing_tasks);
    d->task_sets = instance->task_sets, d->crossing_tasks = instance->crossing_tasks;
    d->capacity = SYM_PROGRAM_RECORDS, d->n_kept = p->n_kept, d->kept = p->kept;
    d->record_t = sym_allocate(arena, SYM_PROGRAM_RECORDS), d->record_q = sym_allocate(arena, SYM_PROGRAM_RECORDS * nq);
    d->record_v = sym_allocate(arena, SYM_PROGRAM_RECORDS * nv);
    d->record_u = sym_allocate(arena, SYM_PROGRAM_RECORDS * nu);
    sym_program_bind_tasks(instance, arena);
    memset(&instance->outputs, 0, sizeof instance->outputs);
    sym_program_bind(instance, arena, &instance->outputs, "signals");
    instance->signals = sym_allocate(arena, (size_t)p->n_outputs);
    for (i = 0; i < p->n_parts; ++i) sym_program_allocate_part(instance, arena, i);
}

SYM_EXPORT size_t sym_program_size(const sym_program *program) {
    sym_program_instance draft;
    sym_arena arena = {NULL, 0};
    memset(&draft, 0, sizeof draft);
    draft.program = program;
    sym_program_allocate(&draft, &arena);
    return (sym_doubles(sizeof draft) + arena.used) * sizeof(double);
}

SYM_EXPORT int32_t sym_program_prepare(sym_program_instance *instance) {
    const sym_kept *kept = instance->program->kept;
    int32_t i, k, status = 0;
    instance->program->instants()->init(instance->par, instance->pre);
    for (i = 0; i < instance->program->n_parts; ++i) {
        sym_instance *part = instance->parts[i];
        memcpy(part->par, instance->par, (size_t)part->model->npar * sizeof(double));
        for (k = 0; k < instance->program->n_kept; ++k)
            if (kept[k].part == i) part->par[kept[k].par] = instance->diagram.u[kept[k].input];
        if (sym_instance_prepare(part) != 0) status = SYM_PARAMETERS_REFUSED;
        part->run.slope_valid = 0;
    }
    return status;
}

SYM_EXPORT const char *sym_program_refused(const sym_program_instance *instance) {
    int32_t i;
    for (i = 0; i < instance->program->n_parts; ++i) {
        const sym_instance *part = instance->parts[i];
        if (part->refused >= 0) return part->plant->conditions[part->refused];
    }
    return NULL;
}

/* Accelerations and multipliers are those under the inputs held now. */
SYM_EXPORT int32_t sym_program_evaluate(sym_program_instance *instance) {
    const sym_function *f = instance->outputs.function;
    double *into = instance->signals;
    int32_t i, status;
    sym_gather_states(&instance->diagram, *instance->diagram.t);
    if (f == NULL) return 0;
    if (instance->diagram.reads_accelerations && (status = sym_evaluate_parts(&instance->diagram)) != 0) return status;
    sym_evaluate(&instance->outputs);
    for (i = 0; i < f->n_out; ++i) {
        const size_t n = sym_array_size(&f->out[i]);
        memcpy(into, instance->outputs.out[i], n * sizeof *into);
        into += n;
    }
    return 0;
}

/* States, memory and what is held as at the first start; parameters and inputs stay. */
static void sym_program_restore(sym_program_instance *instance) {
    const sym_program *p = instance->program;
    sym_diagram *d = &instance->diagram;
    int32_t i;
    memcpy(d->u + p->n_inputs, p->u_start + p->n_inputs, (size_t)(d->nu - p->n_inputs) * sizeof *d->u);
    for (i = 0; i < p->n_locks; ++i) d->lock_values[i] = d->u[p->lock_inputs[i]];
    for (i = 0; i < p->n_parts; ++i) {
        const int32_t checked = instance->parts[i]->check_parameters, project = instance->parts[i]->project;
        sym_instance_reset(instance->parts[i]);
        sym_program_rewind_part(instance->parts[i]);
        instance->parts[i]->check_parameters = checked, instance->parts[i]->project = project;
    }
}

SYM_EXPORT int32_t sym_program_start(sym_program_instance *instance) {
    const sym_program *p = instance->program;
    int32_t i, status;
    if (instance->diagram.begun) sym_program_restore(instance);
    for (i = 0; i < p->n_kept; ++i) instance->diagram.u[p->kept[i].input] = instance->par[p->kept[i].from];
    status = sym_program_prepare(instance);
    for (i = 0; i < instance->program->n_parts && status == 0; ++i) {
        sym_instance_forget_events(instance->parts[i]);
        if (instance->parts[i]->project) status = sym_instance_project(instance->parts[i]);
        if (status == 0) status = sym_run_start(&instance->parts[i]->run);
        if (status > 0) status = 0; /* it runs */
    }
    return status == 0 ? sym_diagram_start(&instance->diagram) : status;
}

SYM_EXPORT int32_t sym_program_parameter(const sym_program *program, const char *name) {
    const sym_model *m = program->instants();
    int32_t i, k;
    for (i = 0; i < m->npar; ++i)
        if (strcmp(m->par_names[i], name) == 0) break;
    for (k = 0; k < program->n_kept; ++k)
        if (program->kept[k].par == i) return -1; /* memory of the program */
    return i < m->npar ? i : -1;
}

SYM_EXPORT void sym_program_set(sym_program_instance *instance, int32_t i, double value) {
    const sym_program *p = instance->program;
    int32_t k;
    instance->par[i] = value;
    for (k = 0; instance->diagram.begun && k < p->n_kept; ++k)
        if (p->kept[k].from == i) instance->diagram.u[p->kept[k].input] = value;
}

SYM_EXPORT double sym_program_present(const sym_program_instance *instance, int32_t i) {
    const sym_program *p = instance->program;
    int32_t k;
    for (k = 0; instance->diagram.begun && k < p->n_kept; ++k)
        if (p->kept[k].from == i) return instance->diagram.u[p->kept[k].input];
    return instance->par[i];
}

SYM_EXPORT sym_program_instance *sym_program_init(void *memory, size_t size, const sym_program *program) {
    sym_program_instance *instance = memory;
    sym_arena arena = {NULL, 0};
    int32_t i;
    if (memory == NULL || size < sym_program_size(program)) return NULL;
    memset(memory, 0, size);
    instance->program = program;
    arena.base = (double *)memory + sym_doubles(sizeof *instance);
    sym_program_allocate(instance, &arena);
    memcpy(instance->diagram.u, program->u_start, (size_t)instance->diagram.nu * sizeof(double));
    for (i = 0; i < program->n_locks; ++i)
        instance->diagram.lock_values[i] = instance->diagram.u[program->lock_inputs[i]];
    memcpy(instance->par, program->instants()->par_default, (size_t)program->instants()->npar * sizeof(double));
    for (i = 0; i < program->n_parts; ++i)
        if (instance->parts[i] == NULL) return NULL;
    return sym_program_start(instance) == 0 ? instance : NULL;
}

/* Find the instants of formulas of time at which steps of the parts end. Returns up to when, at most t, they are
 * known of all. */
static double sym_program_find_stops(sym_program_instance *instance, double t) {
    double known = t;
    int32_t i;
    for (i = 0; i < instance->program->n_parts; ++i) {
        sym_instance *part = instance->parts[i];
        double of_part;
        sym_instance_look(part, sym_instance_span(part, part->run.t, t));
        of_part = sym_instance_find_stops(part, part->run.t, t);
        if (of_part < known) known = of_part;
    }
    return known;
}

/* Integrate to time t, instants of that time included or not. Returns SYM_FINISHED or another status. */
static int32_t sym_program_integrate(sym_program_instance *instance, double t, int32_t before_end) {
    sym_diagram *d = &instance->diagram;
    int32_t i, status = SYM_FINISHED;
    d->before_end = before_end;
    if (!(fabs(t) < HUGE_VAL) || t < *d->t - 1e-9 * d->base_numerator / d->base_denominator) return SYM_DIVERGED;
    if (sym_program_refused(instance) != NULL) return SYM_PARAMETERS_REFUSED;
    for (i = 0; i < instance->program->n_parts; ++i) {
        if (instance->program->n_inputs > 0) instance->parts[i]->run.slope_valid = 0; /* they may have changed */
        instance->parts[i]->run.n_event_records = 0;
    }
    do {
        d->t_end = sym_program_find_stops(instance, t), d->finished = 0;
        do {
            d->n_records = 0;
            for (i = 0; i < instance->program->n_parts; ++i) sym_instance_make_room(&instance->parts[i]->run);
            status = sym_diagram_advance(d, 1);
        } while (status == SYM_RUNNING || status == SYM_RECORDS_FULL);
        d->n_records = 0;
    } while (status == SYM_FINISHED && d->t_end < t);
    return status;
}

SYM_EXPORT int32_t sym_program_approach(sym_program_instance *instance, double t) {
    return sym_program_integrate(instance, t, 1);
}

SYM_EXPORT int32_t sym_program_advance(sym_program_instance *instance, double t) {
    int32_t status = sym_program_integrate(instance, t, 0);
    if (status != SYM_FINISHED) return status;
    status = sym_program_evaluate(instance);
    return status == 0 ? SYM_FINISHED : status;
}
