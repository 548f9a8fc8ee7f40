/* Memory of the caller's, handed out piece by piece. The same layout function first counts (base NULL) and then places,
 * so that a size is never computed apart from its layout. Structs start on a boundary of doubles. */

typedef struct sym_arena {
    double *base; /* NULL: only count */
    size_t used;  /* doubles */
} sym_arena;

/* n doubles, at least one; NULL where the arena only counts. */
static double *sym_allocate(sym_arena *arena, size_t n) {
    double *start = arena->base == NULL ? NULL : arena->base + arena->used;
    arena->used += n > 0 ? n : 1;
    return start;
}

static size_t sym_doubles(size_t bytes) { return (bytes + sizeof(double) - 1) / sizeof(double); }

static void *sym_allocate_bytes(sym_arena *arena, size_t bytes) { return sym_allocate(arena, sym_doubles(bytes)); }

static size_t sym_array_size(const sym_array *array) { return (size_t)array->rows * (size_t)array->cols; }
