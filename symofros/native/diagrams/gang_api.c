/* What diagram.c asks of gang.c. */
static int32_t sym_gang_until(sym_diagram *d, double t);
static int32_t sym_part_until(sym_run *r, double t);
static void sym_tally(sym_diagram *d, sym_run *r);
