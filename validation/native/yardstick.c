/* A fixed amount of arithmetic of the kind that generated code consists of: speeds are given as multiples of its time,
   so that they can be compared between runs on machines of one kind. Never change it: stored runs rest on it. */

#include <math.h>
#include <stddef.h>

enum { INPUTS = 8, WIDTH = 16, ROUNDS = 12 };

/* y[n][WIDTH] from x[n][INPUTS]. */
void yardstick(size_t n, const double *x, double *y) {
    size_t i;
    for (i = 0; i < n; ++i, x += INPUTS, y += WIDTH) {
        double w[WIDTH];
        int k, round;
        for (k = 0; k < INPUTS; ++k) {
            w[2 * k] = sin(x[k]);
            w[2 * k + 1] = cos(x[k]);
        }
        for (round = 0; round < ROUNDS; ++round)
            for (k = 0; k < WIDTH; ++k) w[k] = 0.5 * w[k] * w[(k + 3) % WIDTH] + 0.25 * w[(k + 7) % WIDTH];
        for (k = 0; k < WIDTH; ++k) y[k] = w[k];
    }
}
