/* What this processor can do at most: fused multiply-adds, one by one and by vectors, and copies. */

#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <string.h>
#include <time.h>

#if defined(__AVX512F__)
enum { LANES = 8 };
#elif defined(__AVX__)
enum { LANES = 4 };
#else
enum { LANES = 2 };
#endif
/* More chains than a fused multiply-add takes cycles times what can start in a cycle. */
enum { CHAINS = 12, ROUNDS = 200000, REPEATS = 25 };
typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Each chain in a variable of its own: an array would live in memory. */
#define EACH(do) do(0) do(1) do(2) do(3) do(4) do(5) do(6) do(7) do(8) do(9) do(10) do(11)
#define BEGIN(k) x##k = a + k,
#define ADVANCE(k) x##k = x##k * a + b;
#define USE(k) __asm__ volatile("" : : "v"(x##k));
/* The loop calls nothing, so that the compiler may keep all chains in registers. */
#define MULTIPLY_ADD(name, type)                                   \
    static __attribute__((noinline)) void spin_##name(void) {      \
        const type zero = {0}, a = zero + 0.999, b = zero + 1e-3;  \
        type EACH(BEGIN) unused;                                   \
        int i;                                                     \
        (void)unused;                                              \
        for (i = 0; i < ROUNDS; ++i) {                             \
            EACH(ADVANCE)                                          \
        }                                                          \
        EACH(USE)                                                  \
    }                                                              \
    static double name(void) {                                     \
        double best = 1e9;                                         \
        int r;                                                     \
        for (r = 0; r < REPEATS; ++r) {                            \
            const double start = now();                            \
            spin_##name();                                         \
            if (now() - start < best) best = now() - start;        \
        }                                                          \
        return (double)CHAINS * ROUNDS / best;                     \
    }
MULTIPLY_ADD(scalar, double)
MULTIPLY_ADD(vector, lanes)

/* Bytes read and written a second, with both arrays in the cache next to the core. */
static double copy(void) {
    enum { BYTES = 16384 };
    static char from[BYTES], to[BYTES];
    double best = 1e9;
    int r, i;
    for (r = 0; r < REPEATS; ++r) {
        const double start = now();
        for (i = 0; i < 20000; ++i) {
            memcpy(to, from, BYTES);
            __asm__ volatile("" : : "r"(to) : "memory");
        }
        if (now() - start < best) best = now() - start;
    }
    return 2.0 * BYTES * 20000 / best;
}

int main(void) {
    printf("%.6e %.6e %d %.6e\n", scalar(), LANES * vector(), (int)LANES, copy());
    return 0;
}
