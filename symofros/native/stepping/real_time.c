/* The clock, and keeping pace with it in real-time runs. */

#if defined(_WIN32)
#include <windows.h>
static double sym_clock_seconds(void) {
    LARGE_INTEGER count, rate;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&rate);
    return (double)count.QuadPart / (double)rate.QuadPart;
}
static void sym_sleep_seconds(double seconds) { Sleep((DWORD)(1e3 * seconds)); }
#elif defined(__wasm__)
/* The page that calls keeps pace itself; without a clock the module needs nothing of its surroundings. */
static double sym_clock_seconds(void) { return 0.0; }
static void sym_sleep_seconds(double seconds) { (void)seconds; }
#else
#include <time.h>
#if defined(__linux__)
#include <sys/prctl.h>
/* Linux wakes a thread up to its timer slack late: 50 microseconds, unless it asks for less. */
static void sym_minimize_timer_slack(void) { prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL); }
#else
static void sym_minimize_timer_slack(void) {}
#endif
static double sym_clock_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
static void sym_sleep_seconds(double seconds) {
    struct timespec span;
    sym_minimize_timer_slack();
    span.tv_sec = (time_t)seconds;
    span.tv_nsec = (long)(1e9 * (seconds - (double)span.tv_sec));
    nanosleep(&span, NULL);
}
#endif

/* Wait until the clock shows the time of the present state; count steps that end after it, and how late they are. */
static void sym_wait_for_clock(sym_run *r) {
    const double due = r->clock_start + (r->t - r->t0) * r->realtime_scale;
    double early = due - sym_clock_seconds(), late;
    if (early > 0.0) sym_sleep_seconds(early);
    late = sym_clock_seconds() - due;
    if (early < 0.0) ++r->late_steps;
    if (late > r->late_max) r->late_max = late;
    r->late_sum += late;
    ++r->paced_steps;
}

SYM_EXPORT double sym_seconds(void) { return sym_clock_seconds(); }

SYM_EXPORT void sym_wait(double seconds) { sym_sleep_seconds(seconds); }
