/* symofros_fmi.h - what FMI 2.0 and 3.0 have in common, over symofros_fmu.h or symofros_fmu_program.h. Written
 * by hand.
 *
 * Each function checks whether the call is allowed in the present mode, and returns FMU_OK or the code of what is wrong.
 */

static const char *fmi_message(int found) {
    if (found >= FMU_PARAMETERS) return fmu_condition(found - FMU_PARAMETERS);
    switch (found) {
    case FMU_UNKNOWN: return "no such variable, or not one for this call";
    case FMU_SINGULAR: return "no finite acceleration, or constraints that can't be met";
    case FMU_WRONG_MODE: return "the call is not allowed in this mode";
    case FMU_START_NOT_CONSISTENT: return "no state near the start meets the constraints";
    case FMU_STOP_BEFORE_START: return "the start time is no finite number, or the stop time is before it or no number";
    case FMU_NO_ROTATION: return "start values of a quaternion are no rotation: they are of unit length";
    case FMU_INPUT_NO_ROTATION: return "inputs that prescribe a motion hold a quaternion that is no rotation: they are of unit length";
    case FMU_WRONG_SIZE: return "an array has another length than the call needs";
    case FMU_NULL: return "an array or a result that the call needs is NULL";
    case FMU_NO_MEMORY: return "no memory";
    case FMU_OTHER_MODEL: return "the state is of another model or kind";
    case FMU_BUFFER_TOO_SMALL: return "too few bytes";
    default: return "not allowed in this mode, or not a legal value";
    }
}

static int fmi_require(int condition) { return condition ? FMU_OK : FMU_WRONG_MODE; }

static int fmi_missing(const void *array, size_t n) { return n > 0 && array == NULL; }

/* Times and tolerance of the run to come. */
static int fmi_prepare(fmu *f, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    if (f->phase != FMU_INSTANTIATED) return FMU_WRONG_MODE;
    if (!(start - start == 0.0) || (has_stop && !(stop >= start))) return FMU_STOP_BEFORE_START;
    if (has_tolerance && tolerance > 0.0 && tolerance < HUGE_VAL) fmu_set_tolerance(f, tolerance);
    *fmu_time(f) = start, f->has_stop = has_stop && stop < HUGE_VAL, f->stop = stop;
    return FMU_OK;
}

static int fmi_exit_initialisation(fmu *f) {
    int found;
    if (f->phase != FMU_INITIALISING) return FMU_WRONG_MODE;
    found = fmu_initialise(f);
    return found == FMU_SINGULAR ? FMU_START_NOT_CONSISTENT : found;
}

static int fmi_terminate(fmu *f) {
    if (f->phase < FMU_EVENT || f->phase > FMU_STEPPING) return FMU_WRONG_MODE;
    f->phase = FMU_TERMINATED;
    return FMU_OK;
}

static int fmi_reset(fmu *f) {
    fmu_reset(f);
    return FMU_OK;
}

static int fmi_get(fmu *f, const uint32_t *references, size_t n, double *values) {
    size_t i;
    int found = fmi_require(f->phase != FMU_INSTANTIATED);
    if (fmi_missing(references, n) || fmi_missing(values, n)) return FMU_NULL;
    for (i = 0; i < n && found == FMU_OK; ++i) found = fmu_get(f, references[i], &values[i]);
    return found;
}

static int fmi_set(fmu *f, const uint32_t *references, size_t n, const double *values) {
    size_t i;
    int found = FMU_OK;
    if (fmi_missing(references, n) || fmi_missing(values, n)) return FMU_NULL;
    for (i = 0; i < n && found == FMU_OK; ++i) found = fmu_set(f, references[i], values[i]);
    if (found != FMU_NOT_ALLOWED) return found;
    sprintf(f->message, "value reference %lu is not set to %.9g: %s", (unsigned long)references[i - 1], values[i - 1],
            values[i - 1] - values[i - 1] == 0.0
                ? "states are set up to initialisation, parameters in event mode rather than continuous-time mode, inputs until the"
                  " end, others never"
                : "values are finite");
    return FMU_REFUSED;
}

static int fmi_save(fmu *f, void **state) {
    if (state == NULL) return FMU_NULL;
    if (*state == NULL) *state = malloc(fmu_snapshot_size(f));
    if (*state == NULL) return FMU_NO_MEMORY;
    fmu_save(f, *state);
    return FMU_OK;
}

static int fmi_load(fmu *f, const void *state) {
    if (state == NULL) return FMU_NULL;
    return fmu_load(f, state) ? FMU_OK : FMU_OTHER_MODEL;
}

static int fmi_forget(void **state) {
    if (state != NULL) free(*state), *state = NULL;
    return FMU_OK;
}

static int fmi_size(const fmu *f, const void *state, size_t *size) {
    if (state == NULL || size == NULL) return FMU_NULL;
    if (!fmu_owns(f, state)) return FMU_OTHER_MODEL;
    *size = fmu_snapshot_size(f);
    return FMU_OK;
}

static int fmi_pack(const fmu *f, const void *state, void *bytes, size_t size) {
    if (state == NULL || bytes == NULL) return FMU_NULL;
    if (!fmu_owns(f, state)) return FMU_OTHER_MODEL;
    if (size < fmu_snapshot_size(f)) return FMU_BUFFER_TOO_SMALL;
    memcpy(bytes, state, fmu_snapshot_size(f));
    return FMU_OK;
}

static int fmi_unpack(const fmu *f, const void *bytes, size_t size, void **state) {
    if (bytes == NULL || state == NULL) return FMU_NULL;
    if (size != fmu_snapshot_size(f) || !fmu_owns(f, bytes)) return FMU_OTHER_MODEL;
    if (*state == NULL) *state = malloc(size);
    if (*state == NULL) return FMU_NO_MEMORY;
    memcpy(*state, bytes, size);
    return FMU_OK;
}

static int fmi_differentiate(fmu *f, const uint32_t *unknown, size_t n_unknown, const uint32_t *known, size_t n_known,
                             const double *seed, double *found) {
    if (f->phase == FMU_INSTANTIATED || f->phase == FMU_TERMINATED) return FMU_WRONG_MODE;
    if (fmi_missing(unknown, n_unknown) || fmi_missing(found, n_unknown)) return FMU_NULL;
    if (fmi_missing(known, n_known) || fmi_missing(seed, n_known)) return FMU_NULL;
    return fmu_differentiate(f, n_unknown, unknown, n_known, known, seed, found);
}

static int fmi_refuse_step(fmu *f, double t, double h, const char *rule, double limit) {
    sprintf(f->message, "step of %.9g s from t = %.9g s refused: %.100s %.9g s", h, t, rule, limit);
    return FMU_REFUSED;
}

/* One communication step. */
static int fmi_step(fmu *f, double t, double h) {
    const double slack = 1e-9 * (fabs(t) + h);
    const int status = fmu_prepare(f);
    if (status != FMU_OK) return status;
    if (!(h > 0.0 && h < HUGE_VAL)) return fmi_refuse_step(f, t, h, "it has to be finite and longer than", 0.0);
    if (!(fabs(t - *fmu_time(f)) <= slack))
        return fmi_refuse_step(f, t, h, "it has to begin at the present time, t =", *fmu_time(f));
    if (f->has_stop && t + h > f->stop + slack)
        return fmi_refuse_step(f, t, h, "it leads beyond the stop time, t =", f->stop);
    return fmu_step(f, t + h);
}

/* Model Exchange. */

static int fmi_event_mode(fmu *f) {
    if (f->cosim || (f->phase != FMU_CONTINUOUS && f->phase != FMU_EVENT)) return FMU_WRONG_MODE;
    f->phase = FMU_EVENT;
    return FMU_OK;
}

static int fmi_continuous_mode(fmu *f) {
    if (f->cosim || f->phase != FMU_EVENT) return FMU_WRONG_MODE;
    f->phase = FMU_CONTINUOUS;
    return FMU_OK;
}

static int fmi_set_time(fmu *f, double t) {
    if (f->cosim || (f->phase != FMU_CONTINUOUS && f->phase != FMU_EVENT)) return FMU_WRONG_MODE;
    if (!(t - t == 0.0)) return FMU_NOT_ALLOWED;
    *fmu_time(f) = t, f->rates_valid = 0;
    return FMU_OK;
}

/* Whether the call is allowed, and its array has a number for each state. */
static int fmi_check_states(const fmu *f, int allowed, const double *array, size_t n) {
    if (f->cosim || !allowed) return FMU_WRONG_MODE;
    if (n != fmu_states(f)) return FMU_WRONG_SIZE;
    return fmi_missing(array, n) ? FMU_NULL : FMU_OK;
}

static int fmi_set_states(fmu *f, const double *x, size_t n) {
    const int found = fmi_check_states(f, f->phase == FMU_CONTINUOUS, x, n);
    if (found != FMU_OK || n == 0) return found;
    fmu_put_states(f, x);
    f->rates_valid = 0;
    return FMU_OK;
}

static int fmi_get_states(const fmu *f, double *x, size_t n) {
    const int found = fmi_check_states(f, f->phase >= FMU_INITIALISING, x, n);
    if (found != FMU_OK || n == 0) return found;
    fmu_take_states(f, x);
    return FMU_OK;
}

static int fmi_get_rates(fmu *f, double *rates, size_t n) {
    int found = fmi_check_states(f, f->phase >= FMU_INITIALISING, rates, n);
    if (found != FMU_OK || n == 0) return found;
    found = fmu_refresh(f);
    if (found == FMU_OK) memcpy(rates, f->rates, n * sizeof *rates);
    return found;
}

static int fmi_nominals(const fmu *f, double *nominals, size_t n) {
    const int found = fmi_check_states(f, 1, nominals, n);
    size_t i;
    for (i = 0; i < n && found == FMU_OK; ++i) nominals[i] = 1.0;
    return found;
}
