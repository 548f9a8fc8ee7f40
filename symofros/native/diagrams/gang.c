/* Threads that share the parts of a diagram between two instants. Parts do not see each other there, so the result is
 * the same for any number of threads. */

#if defined(_WIN32)
struct sym_gang { int32_t threads; };
static int32_t sym_gang_until(sym_diagram *d, double t) { (void)d; (void)t; return SYM_DONE; }
SYM_EXPORT int32_t sym_diagram_hire(sym_diagram *d, int32_t threads) { (void)d; (void)threads; return 0; }
SYM_EXPORT void sym_diagram_dismiss(sym_diagram *d) { (void)d; }
#else
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>

/* Rounds of looking before a thread lets others run. */
enum { SYM_LOOKS = 2000 };

struct sym_gang {
    sym_diagram *d;
    int32_t threads, hired;
    pthread_t *ids;
    struct sym_hand { struct sym_gang *gang; int32_t first; } *hands;
    int32_t *status;  /* of each part */
    double until;
    int64_t called;   /* how often the threads were called; -1: go home */
    int32_t busy;     /* threads that have not answered yet */
};

/* The parts of one hand: every so many of them. */
static void sym_hand_work(struct sym_gang *gang, int32_t first) {
    int32_t i;
    for (i = first; i < gang->d->n_parts; i += gang->threads)
        gang->status[i] = sym_part_until(gang->d->parts[i], gang->until);
}

static void *sym_hand_main(void *argument) {
    const struct sym_hand *hand = argument;
    struct sym_gang *gang = hand->gang;
    int64_t seen = 0;
    for (;;) {
        int32_t looks = 0;
        int64_t called;
        while ((called = __atomic_load_n(&gang->called, __ATOMIC_ACQUIRE)) == seen)
            if (++looks > SYM_LOOKS) sched_yield();
        if (called < 0) return NULL;
        seen = called;
        sym_hand_work(gang, hand->first);
        __atomic_sub_fetch(&gang->busy, 1, __ATOMIC_RELEASE);
    }
}

static int32_t sym_gang_until(sym_diagram *d, double t) {
    struct sym_gang *gang = d->gang;
    int32_t i, looks = 0;
    gang->until = t;
    __atomic_store_n(&gang->busy, gang->hired, __ATOMIC_RELAXED);
    __atomic_add_fetch(&gang->called, 1, __ATOMIC_RELEASE);
    sym_hand_work(gang, 0);
    while (__atomic_load_n(&gang->busy, __ATOMIC_ACQUIRE) > 0)
        if (++looks > SYM_LOOKS) sched_yield();
    for (i = 0; i < d->n_parts; ++i) sym_tally(d, d->parts[i]);
    for (i = 0; i < d->n_parts; ++i)
        if (gang->status[i] != SYM_DONE) {
            d->failed = i;
            return gang->status[i];
        }
    return SYM_DONE;
}

SYM_EXPORT void sym_diagram_dismiss(sym_diagram *d) {
    struct sym_gang *gang = d->gang;
    int32_t i;
    if (gang == NULL) return;
    __atomic_store_n(&gang->called, -1, __ATOMIC_RELEASE);
    for (i = 0; i < gang->hired; ++i) pthread_join(gang->ids[i], NULL);
    free(gang->ids), free(gang->hands), free(gang->status), free(gang);
    d->gang = NULL;
}

SYM_EXPORT int32_t sym_diagram_hire(sym_diagram *d, int32_t threads) {
    struct sym_gang *gang = calloc(1, sizeof *gang);
    int32_t i;
    if (gang == NULL) return 0;
    gang->d = d, gang->threads = threads;
    gang->ids = calloc((size_t)threads, sizeof *gang->ids);
    gang->hands = calloc((size_t)threads, sizeof *gang->hands);
    gang->status = calloc((size_t)d->n_parts, sizeof *gang->status);
    d->gang = gang;
    for (i = 1; gang->ids != NULL && gang->hands != NULL && gang->status != NULL && i < threads; ++i) {
        gang->hands[i].gang = gang, gang->hands[i].first = i;
        if (pthread_create(&gang->ids[gang->hired], NULL, sym_hand_main, &gang->hands[i]) != 0) break;
        ++gang->hired;
    }
    if (gang->hired == threads - 1) return 1;
    sym_diagram_dismiss(d);
    return 0;
}
#endif
