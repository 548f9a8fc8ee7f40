#include <stdio.h>
#include <stdlib.h>
#include "cart.h"
int main(int n, char **word) {
    const size_t size = sym_instance_size(cart_plant());
    sym_instance *cart = sym_instance_init(malloc(size), size, cart_plant());
    const double span = atof(word[1]);
    int i, k, status = SYM_FINISHED;
    for (i = 2; i + 1 < n; i += 2) { /* late and width of one run after the other, in the same instance */
        sym_instance_reset(cart);
        cart->par[0] = atof(word[i]), cart->par[1] = atof(word[i + 1]);
        if (sym_instance_prepare(cart) != 0) return 1;
        for (k = 1; status == SYM_FINISHED && cart->t < 10.0; ++k) {
            const double end = (double)k * span;
            status = sym_instance_advance(cart, end < 10.0 ? end : 10.0, 0.0);
        }
        printf("%d %.17g\n", status, cart->v[0]);
    }
    return 0;
}
