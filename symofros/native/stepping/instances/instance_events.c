/* Events of instances, and rigid contacts: included by instance.c. */

/* A function of a model of formulas as a call at the evaluation point, with a parameters' part of its own. Returns 0 where
 * there is no model. */
static int32_t sym_instance_bind_formulas(sym_instance *instance, sym_arena *arena, sym_call *call, const sym_model *(*of)(void)) {
    const sym_model *m = of != NULL ? of() : NULL;
    const sym_point point = sym_system_point(&instance->system);
    double *pre, *work;
    if (m == NULL) return 0;
    pre = sym_allocate(arena, (size_t)m->npre), work = sym_allocate(arena, sym_work(m));
    call->init = m->init;
    return sym_bind_function(arena, call, m->functions, pre, work, &point);
}

/* Whether the condition of the description or the beams forbid that parameters change to some. */
static int32_t sym_instance_refuses(void *data, const double *par) {
    sym_instance *instance = data;
    const sym_plant *p = instance->plant;
    const double *L = instance->beam_stiffness.out[0], *EI = instance->beam_stiffness.out[1];
    int32_t b, differ = 0;
    if (instance->check_parameters && p->violated(par) >= 0) return 1;
    if (p->n_beams == 0) return 0;
    instance->model->init(par, instance->pre);
    sym_evaluate(&instance->beam_stiffness);
    for (b = 0; b < p->n_beams; ++b) {
        const sym_beam *beam = &instance->beams[b];
        int32_t i;
        differ |= EI[2 * b] != beam->EI_z || EI[2 * b + 1] != beam->EI_y;
        for (i = beam->first; i < beam->first + beam->n; ++i)
            differ |= instance->beam_scale[i] != (p->beam_displacements[i] ? 1.0 / L[b] : 1.0);
    }
    return differ;
}

/* Rows of events that an instance keeps of one call. */
enum { SYM_INSTANCE_EVENTS = 64 };

/* Lay out what the actions of events need. Returns 0 where the model lacks a function for that. */
static int32_t sym_instance_allocate_actions(sym_instance *instance, sym_arena *arena) {
    const sym_event_plan *plan = instance->plant->events;
    sym_actions *a = &instance->actions;
    sym_run *r = &instance->run;
    const sym_point point = sym_system_point(&instance->system);
    int32_t i, found = instance->model->nc == 0;
    a->npar = instance->model->npar, a->n_assignments = plan->n_assignments, a->n_switches = plan->n_switches;
    a->assignments = plan->assignments, a->switches = plan->switches;
    a->first_mode = plan->first_mode;
    a->modes = sym_allocate(arena, (size_t)a->npar + 2 * (size_t)plan->n_sticking + (size_t)plan->n_contacts);
    a->acts = plan->acts, a->once = plan->once, a->restitution = plan->restitution, a->opens = plan->opens;
    a->refuses = sym_instance_refuses, a->data = instance;
    a->engaged = sym_allocate(arena, (size_t)plan->n_switches);
    a->poses = sym_allocate_bytes(arena, (size_t)plan->n_poses * sizeof *a->poses);
    if (!found) found = sym_instance_bind(instance, arena, &a->constraint, "constraint");
    for (i = 0; i < plan->n_poses; ++i) {
        const sym_function *pose = sym_find(instance->model, "frame_pose", plan->pose_frames[i]);
        sym_call draft, *call = arena->base != NULL ? a->poses + i : &draft;
        found &= sym_bind_function(arena, call, pose, instance->pre, instance->work, &point);
        call->init = instance->model->init;
    }
    r->actions = a, r->acts = 1, r->par = instance->par, r->acted_at = sym_allocate(arena, (size_t)plan->n + 1);
    r->event_done = sym_allocate(arena, (size_t)r->event_capacity * sym_done_size(r));
    return sym_instance_bind_formulas(instance, arena, &a->values, plan->actions) && found;
}

/* Numbers that are kept of rigid contacts from one motion to the next: sym_system's contact_memory, then left_at. */
SYM_EXPORT size_t sym_instance_contact_size(const sym_instance *instance) {
    const sym_system *s = &instance->system;
    return s->n_contacts == 0 ? 0 : sym_contact_memory_size(s) + 1 + (size_t)s->nq + (size_t)s->nv;
}

/* Lay out what rigid contacts need. Returns 0 where a function for that is lacking. */
static int32_t sym_instance_allocate_contacts(sym_instance *instance, sym_arena *arena) {
    const sym_event_plan *plan = instance->plant->events;
    sym_system *s = &instance->system;
    s->n_contacts = plan->n_contacts, s->contacts = plan->contacts, s->npar = instance->model->npar;
    if (plan->n_contacts == 0) return 1;
    s->contact_memory = sym_allocate(arena, sym_instance_contact_size(instance));
    if (arena->base != NULL) instance->left_at = s->contact_memory + sym_contact_memory_size(s);
    s->contact_work = sym_allocate(arena, sym_contact_work_size(s));
    return sym_instance_bind_formulas(instance, arena, &s->contact_state, plan->contact_state);
}

/* Lay out what finds events and notes them. Returns 0 where the model lacks a function for that. */
static int32_t sym_instance_allocate_events(sym_instance *instance, sym_arena *arena) {
    const sym_event_plan *plan = instance->plant->events;
    sym_system *s = &instance->system;
    sym_run *r = &instance->run;
    size_t n, rows;
    int32_t i;
    memset(&instance->actions, 0, sizeof instance->actions);
    if (plan == NULL) return 1;
    n = (size_t)plan->n, rows = SYM_INSTANCE_EVENTS + 2 * n;
    s->n_events = plan->n, s->event_direction = plan->direction;
    s->n_sticking = plan->n_sticking, s->sticking = plan->sticking;
    s->held = sym_allocate_bytes(arena, (size_t)plan->n_sticking * sizeof *s->held);
    instance->event_terminal = sym_allocate_bytes(arena, n * sizeof *instance->event_terminal);
    s->event_terminal = instance->event_terminal;
    r->event_values = sym_allocate(arena, SYM_EVENT_ROWS * n);
    r->event_capacity = (int64_t)rows;
    r->event_t = sym_allocate(arena, rows), r->event_index = sym_allocate_bytes(arena, rows * sizeof *r->event_index);
    r->event_q = sym_allocate(arena, rows * (size_t)s->nq), r->event_v = sym_allocate(arena, rows * (size_t)s->nv);
    if (!sym_instance_bind_formulas(instance, arena, &s->events, plan->formulas)) return 0;
    for (i = 1; i < s->events.function->n_in; ++i) s->events_of_reactions |= strcmp(s->events.function->in[i].name, "lam") == 0;
    if (!sym_instance_allocate_contacts(instance, arena)) return 0;
    return plan->actions == NULL || sym_instance_allocate_actions(instance, arena);
}

/* No event has been met yet, and none has acted for good. */
static void sym_instance_forget_events(sym_instance *instance) {
    const sym_event_plan *plan = instance->plant->events;
    int32_t i;
    if (plan == NULL) return;
    memcpy(instance->event_terminal, plan->cut, (size_t)plan->n * sizeof *plan->cut);
    for (i = 0; i <= plan->n && instance->run.actions != NULL; ++i) instance->run.acted_at[i] = -HUGE_VAL;
    instance->run.n_event_records = 0;
    sym_run_forget_contacts(&instance->run);
}

/* Of more events than there are rows for, the last ones are kept. */
static void sym_instance_make_room(sym_run *r) {
    const int64_t n = r->system->n_events, left = r->event_capacity / 2;
    const size_t nq = (size_t)r->system->nq, nv = (size_t)r->system->nv;
    const int64_t first = r->n_event_records - left;
    if (n == 0 || r->n_event_records + n <= r->event_capacity) return;
    memmove(r->event_t, r->event_t + first, (size_t)left * sizeof *r->event_t);
    memmove(r->event_index, r->event_index + first, (size_t)left * sizeof *r->event_index);
    memmove(r->event_q, r->event_q + (size_t)first * nq, (size_t)left * nq * sizeof *r->event_q);
    memmove(r->event_v, r->event_v + (size_t)first * nv, (size_t)left * nv * sizeof *r->event_v);
    r->n_event_records = left;
}

/* Whether the modes of rigid contacts, which outlast a motion, have to be chosen anew as another one begins: the state is another
 * one, and all are open then, or by what has been set, as inputs, one of them has ended. Returns 0 or a status. */
static int32_t sym_instance_doubt_contacts(sym_instance *instance) {
    sym_run *r = &instance->run;
    const sym_system *s = r->system;
    const double *kept = instance->left_at;
    int32_t i, status;
    if (s->n_contacts == 0 || *sym_modes_chosen(s) == 0.0) return 0;
    if (kept[0] != r->t || memcmp(kept + 1, r->q, (size_t)s->nq * sizeof *kept) != 0 || memcmp(kept + 1 + s->nq, r->v, (size_t)s->nv * sizeof *kept) != 0) {
        sym_open_contacts(s, r->par);
        sym_run_set_parameters(r, r->par);
        sym_run_forget_contacts(r);
        return 0;
    }
    status = sym_restart_events(r);
    for (i = sym_first_contact_event(r); i < s->n_events && status == 0; ++i)
        if (r->event_values[i] < 0.0) *sym_modes_chosen(s) = 0.0;
    return status;
}

SYM_EXPORT double sym_instance_struck_in_sequence(const sym_instance *instance) {
    const sym_system *s = &instance->system;
    return s->n_contacts > 0 ? *sym_struck_in_sequence(s) : -HUGE_VAL;
}

/* The state at which a motion ends. */
static void sym_instance_leave(sym_instance *instance) {
    const sym_system *s = &instance->system;
    if (s->n_contacts == 0) return;
    instance->left_at[0] = instance->t;
    memcpy(instance->left_at + 1, instance->q, (size_t)s->nq * sizeof(double));
    memcpy(instance->left_at + 1 + s->nq, instance->v, (size_t)s->nv * sizeof(double));
}
