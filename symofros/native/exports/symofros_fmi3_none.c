/* What FMI 3.0 has and these units have not: other types, clocks, structural parameters. After symofros_fmi3.c. */

/* All variables are of Float64. */
#define NONE(name, type) \
    fmi3Status name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, type value[], size_t nv) { \
        fmu *f = c; \
        (void)vr, (void)value; \
        ALLOWED(1); \
        return n == 0 && nv == 0 ? fmi3OK : outcome(f, FMU_UNKNOWN); \
    }
#define NONE_OF(type) NONE(fmi3Get##type, fmi3##type) NONE(fmi3Set##type, const fmi3##type)
NONE_OF(Float32)
NONE_OF(Int8)
NONE_OF(UInt8)
NONE_OF(Int16)
NONE_OF(UInt16)
NONE_OF(Int32)
NONE_OF(UInt32)
NONE_OF(Int64)
NONE_OF(UInt64)
NONE_OF(Boolean)
NONE_OF(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[], fmi3Binary value[],
                         size_t nv) {
    fmu *f = c;
    (void)vr, (void)sizes, (void)value, (void)nv;
    ALLOWED(1);
    return n == 0 ? fmi3OK : outcome(f, FMU_UNKNOWN);
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                         const fmi3Binary value[], size_t nv) {
    fmu *f = c;
    (void)vr, (void)sizes, (void)value, (void)nv;
    ALLOWED(1);
    return n == 0 ? fmi3OK : outcome(f, FMU_UNKNOWN);
}

/* There are no clocks. */
#define NO_CLOCK(name, ...) \
    fmi3Status name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, __VA_ARGS__) { \
        fmu *f = c; \
        (void)vr, (void)a; \
        ALLOWED(1); \
        return n == 0 ? fmi3OK : outcome(f, FMU_UNKNOWN); \
    }
#define NO_CLOCK2(name, one, two) \
    fmi3Status name(fmi3Instance c, const fmi3ValueReference vr[], size_t n, one, two) { \
        fmu *f = c; \
        (void)vr, (void)a, (void)b; \
        ALLOWED(1); \
        return n == 0 ? fmi3OK : outcome(f, FMU_UNKNOWN); \
    }
NO_CLOCK(fmi3GetClock, fmi3Clock a[])
NO_CLOCK(fmi3SetClock, const fmi3Clock a[])
NO_CLOCK2(fmi3GetIntervalDecimal, fmi3Float64 a[], fmi3IntervalQualifier b[])
NO_CLOCK(fmi3GetShiftDecimal, fmi3Float64 a[])
NO_CLOCK2(fmi3GetShiftFraction, fmi3UInt64 a[], fmi3UInt64 b[])
NO_CLOCK(fmi3SetIntervalDecimal, const fmi3Float64 a[])
NO_CLOCK2(fmi3SetIntervalFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])
NO_CLOCK(fmi3SetShiftDecimal, const fmi3Float64 a[])
NO_CLOCK2(fmi3SetShiftFraction, const fmi3UInt64 a[], const fmi3UInt64 b[])

fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                   fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]) {
    fmu *f = c;
    (void)vr, (void)counters, (void)resolutions, (void)qualifiers;
    ALLOWED(1);
    return n == 0 ? fmi3OK : outcome(f, FMU_UNKNOWN);
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 t) {
    fmu *f = c;
    (void)clock, (void)t;
    ALLOWED(0);
    return fmi3Error;
}

/* The description states the dependencies; there are no arrays whose sizes could change them. */
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *n) {
    fmu *f = c;
    (void)vr, (void)n;
    ALLOWED(0);
    return fmi3Error;
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t of[], fmi3ValueReference on[],
                                       size_t at[], fmi3DependencyKind kinds[], size_t n) {
    fmu *f = c;
    (void)vr, (void)of, (void)on, (void)at, (void)kinds, (void)n;
    ALLOWED(0);
    return fmi3Error;
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(0); /* there are no structural parameters */
    return fmi3Error;
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
    fmu *f = c;
    ALLOWED(0);
    return fmi3Error;
}
