/* What FMI 2.0 and 3.0 have in common but for names, which the including file defines: FMI(name), FMI_INSTANCE, FMI_REAL,
 * FMI_STATE, FMI_STATES(verb), FMI_STATES_SIZE, FMI_DESERIALIZE. Written by hand. */

static const char *category(FMI(Status) status) {
    if (status == FMI(Warning)) return "logStatusWarning";
    return status == FMI(Discard) ? "logStatusDiscard" : "logStatusError";
}

static FMI(Status) outcome(const fmu *f, int found) {
    if (found == FMU_OK) return FMI(OK);
    if (found == FMU_BEYOND_THEORY) return say(f, FMI(Discard), f->message);
    if (found == FMU_NOT_DIFFERENTIATED || found == FMU_REFUSED) return say(f, FMI(Error), f->message);
    return say(f, found == FMU_SINGULAR ? FMI(Discard) : FMI(Error), fmi_message(found));
}

#define ANSWER(found) \
    fmu *f = c; \
    return f == NULL ? FMI(Error) : outcome(f, found)
#define ALLOWED(condition) \
    if (f == NULL) return FMI(Error); \
    if (!(condition)) return outcome(f, FMU_WRONG_MODE)
#define NEEDED(results) \
    if (!(results)) return outcome(f, FMU_NULL)

void FMI(FreeInstance)(FMI_INSTANCE c) {
    fmu *f = c;
    if (f != NULL) f->release(f);
}

FMI(Status) FMI(ExitInitializationMode)(FMI_INSTANCE c) {
    fmu *f = c;
    int found;
    ALLOWED(1);
    found = fmi_exit_initialisation(f);
    if (found == FMU_OK && fmu_note_start(f)) say(f, FMI(Warning), f->message);
    return outcome(f, found);
}

FMI(Status) FMI(Terminate)(FMI_INSTANCE c) {
    ANSWER(fmi_terminate(f));
}

FMI(Status) FMI(Reset)(FMI_INSTANCE c) {
    ANSWER(fmi_reset(f));
}

FMI(Status) FMI_STATES(Get)(FMI_INSTANCE c, FMI_STATE *state) {
    ANSWER(fmi_save(f, state));
}

FMI(Status) FMI_STATES(Set)(FMI_INSTANCE c, FMI_STATE state) {
    ANSWER(fmi_load(f, state));
}

FMI(Status) FMI_STATES(Free)(FMI_INSTANCE c, FMI_STATE *state) {
    ANSWER(fmi_forget(state));
}

FMI(Status) FMI_STATES_SIZE(FMI_INSTANCE c, FMI_STATE state, size_t *size) {
    ANSWER(fmi_size(f, state, size));
}

FMI(Status) FMI_STATES(Serialize)(FMI_INSTANCE c, FMI_STATE state, FMI(Byte) bytes[], size_t size) {
    ANSWER(fmi_pack(f, state, bytes, size));
}

FMI(Status) FMI_DESERIALIZE(FMI_INSTANCE c, const FMI(Byte) bytes[], size_t size, FMI_STATE *state) {
    ANSWER(fmi_unpack(f, bytes, size, state));
}

FMI(Status) FMI(EnterEventMode)(FMI_INSTANCE c) {
    ANSWER(fmi_event_mode(f));
}

FMI(Status) FMI(EnterContinuousTimeMode)(FMI_INSTANCE c) {
    ANSWER(fmi_continuous_mode(f));
}

FMI(Status) FMI(CompletedIntegratorStep)(FMI_INSTANCE c, FMI(Boolean) final, FMI(Boolean) *event, FMI(Boolean) *terminate) {
    fmu *f = c;
    (void)final;
    ALLOWED(!f->cosim && f->phase == FMU_CONTINUOUS);
    NEEDED(event && terminate);
    *event = *terminate = FMI(False);
    if (fmu_judge(f) != 0) *terminate = FMI(True);
    if (fmu_remark(f)) say(f, FMI(Warning), f->message);
    return FMI(OK);
}

FMI(Status) FMI(SetTime)(FMI_INSTANCE c, FMI_REAL t) {
    ANSWER(fmi_set_time(f, t));
}

FMI(Status) FMI(SetContinuousStates)(FMI_INSTANCE c, const FMI_REAL x[], size_t n) {
    ANSWER(fmi_set_states(f, x, n));
}

FMI(Status) FMI(GetContinuousStates)(FMI_INSTANCE c, FMI_REAL x[], size_t n) {
    ANSWER(fmi_get_states(f, x, n));
}

FMI(Status) FMI(GetEventIndicators)(FMI_INSTANCE c, FMI_REAL indicators[], size_t n) {
    fmu *f = c;
    (void)indicators;
    ALLOWED(!f->cosim && n == 0);
    return FMI(OK);
}

FMI(Status) FMI(GetNominalsOfContinuousStates)(FMI_INSTANCE c, FMI_REAL nominals[], size_t n) {
    ANSWER(fmi_nominals(f, nominals, n));
}
