/* A program has one thread: what diagram.c asks of gang.c. */
static int32_t sym_gang_until(sym_diagram *d, double t) {
    (void)d, (void)t;
    return SYM_DIVERGED;
}
