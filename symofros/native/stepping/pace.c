/* Keeping pace with the clock. */

#if defined(_WIN32)
#include <windows.h>
static double sym_clock(void) {
    LARGE_INTEGER count, rate;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&rate);
    return (double)count.QuadPart / (double)rate.QuadPart;
}
static void sym_sleep(double seconds) { Sleep((DWORD)(1e3 * seconds)); }
#else
#include <time.h>
#if defined(__linux__)
#include <sys/prctl.h>
/* Linux wakes a thread up to its slack late, 50 microseconds unless it asks for less. */
static void sym_no_slack(void) { prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL); }
#else
static void sym_no_slack(void) {}
#endif
static double sym_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
static void sym_sleep(double seconds) {
    struct timespec span;
    sym_no_slack();
    span.tv_sec = (time_t)seconds;
    span.tv_nsec = (long)(1e9 * (seconds - (double)span.tv_sec));
    nanosleep(&span, NULL);
}
#endif

/* Wait until the clock shows the present time; count how late it is where it already does. */
static void sym_pace(sym_run *r) {
    const double due = r->clock0 + (r->t - r->t0) * r->pace;
    double early = due - sym_clock(), late;
    if (early > 0.0) sym_sleep(early);
    late = sym_clock() - due;
    if (early < 0.0) ++r->late_steps;
    if (late > r->late_max) r->late_max = late;
    r->late_sum += late;
    ++r->paced_steps;
}
