/* Threads that share the parts of a diagram between two instants. Parts do not interact there, so that the result is the
 * same for any number of threads. */

#if defined(_WIN32)
SYM_EXPORT int32_t sym_diagram_start_threads(sym_diagram *d, int32_t threads) { (void)d; (void)threads; return 0; }
SYM_EXPORT void sym_diagram_stop_threads(sym_diagram *d) { (void)d; }
#else
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>

/* Polls of a shared counter before a waiting thread yields its processor. */
enum { SYM_SPINS = 2000 };

struct sym_worker {
    struct sym_thread_pool *pool;
    int32_t first; /* of the parts first, first + threads, ... */
};

struct sym_thread_pool {
    sym_diagram *d;
    int32_t threads;   /* the caller's included */
    int32_t n_workers; /* that were started */
    pthread_t *ids;
    struct sym_worker *workers;
    int32_t *status;   /* (n_parts) */
    double t;          /* to advance to */
    int64_t job;       /* number of the present job; -1: stop */
    int32_t busy;      /* workers that have not finished it */
};

static void sym_worker_advance(struct sym_thread_pool *pool, int32_t first) {
    int32_t i;
    for (i = first; i < pool->d->n_parts; i += pool->threads)
        pool->status[i] = sym_advance_part(pool->d->parts[i], pool->t);
}

static void *sym_worker_main(void *argument) {
    const struct sym_worker *worker = argument;
    struct sym_thread_pool *pool = worker->pool;
    int64_t last_job = 0;
    for (;;) {
        int32_t spins = 0;
        int64_t job;
        while ((job = __atomic_load_n(&pool->job, __ATOMIC_ACQUIRE)) == last_job)
            if (++spins > SYM_SPINS) sched_yield();
        if (job < 0) return NULL;
        last_job = job;
        sym_worker_advance(pool, worker->first);
        __atomic_sub_fetch(&pool->busy, 1, __ATOMIC_RELEASE);
    }
}

/* All parts up to a time; this thread is one of those that share them. Returns SYM_FINISHED or another status. */
static int32_t sym_pool_advance_parts(sym_diagram *d, double t) {
    struct sym_thread_pool *pool = d->pool;
    int32_t i, spins = 0;
    pool->t = t;
    __atomic_store_n(&pool->busy, pool->n_workers, __ATOMIC_RELAXED);
    __atomic_add_fetch(&pool->job, 1, __ATOMIC_RELEASE);
    sym_worker_advance(pool, 0);
    while (__atomic_load_n(&pool->busy, __ATOMIC_ACQUIRE) > 0)
        if (++spins > SYM_SPINS) sched_yield();
    for (i = 0; i < d->n_parts; ++i) sym_add_counters(d, d->parts[i]);
    for (i = 0; i < d->n_parts; ++i)
        if (pool->status[i] != SYM_FINISHED) {
            d->failed_part = i;
            return pool->status[i];
        }
    return SYM_FINISHED;
}

SYM_EXPORT void sym_diagram_stop_threads(sym_diagram *d) {
    struct sym_thread_pool *pool = d->pool;
    int32_t i;
    if (pool == NULL) return;
    __atomic_store_n(&pool->job, -1, __ATOMIC_RELEASE);
    for (i = 0; i < pool->n_workers; ++i) pthread_join(pool->ids[i], NULL);
    free(pool->ids), free(pool->workers), free(pool->status), free(pool);
    d->pool = NULL, d->advance_parallel = NULL;
}

SYM_EXPORT int32_t sym_diagram_start_threads(sym_diagram *d, int32_t threads) {
    struct sym_thread_pool *pool = calloc(1, sizeof *pool);
    int32_t i;
    if (pool == NULL) return 0;
    pool->d = d, pool->threads = threads;
    pool->ids = calloc((size_t)threads, sizeof *pool->ids);
    pool->workers = calloc((size_t)threads, sizeof *pool->workers);
    pool->status = calloc((size_t)d->n_parts, sizeof *pool->status);
    d->pool = pool, d->advance_parallel = sym_pool_advance_parts;
    for (i = 1; pool->ids != NULL && pool->workers != NULL && pool->status != NULL && i < threads; ++i) {
        pool->workers[i].pool = pool, pool->workers[i].first = i;
        if (pthread_create(&pool->ids[pool->n_workers], NULL, sym_worker_main, &pool->workers[i]) != 0) break;
        ++pool->n_workers;
    }
    if (pool->n_workers == threads - 1) return 1;
    sym_diagram_stop_threads(d);
    return 0;
}
#endif
