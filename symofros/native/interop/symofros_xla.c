/* Functions of models as handlers of XLA's foreign function interface (xla/ffi/api/c_api.h, put before this text).
 *
 * A handler has no data of its own, so there is one for each slot; Python fills a slot with a model's function and registers
 * its handler under a name of its own. Arguments: parameters (..., npar), then the function's inputs in order, each with
 * the same leading dimensions; results: its outputs. All are doubles, row by row. */
#include "symofros_model.h"
#include <stdlib.h>

typedef struct sym_slot {
    const sym_model *model;
    const sym_function *function, *many; /* many: the same by vectors, for large batches; or NULL */
    size_t from;                         /* states from which on `many` is called */
} sym_slot;

#define SYM_SLOTS 64
static sym_slot sym_slots[SYM_SLOTS];

SYM_EXPORT void sym_xla_fill(int32_t slot, const sym_model *model, const sym_function *function, const sym_function *many,
                             size_t from) {
    const sym_slot filled = {model, function, many, from};
    sym_slots[slot] = filled;
}

static XLA_FFI_Error *sym_xla_error(XLA_FFI_CallFrame *frame, const char *message) {
    XLA_FFI_Error_Create_Args args = {0};
    args.struct_size = XLA_FFI_Error_Create_Args_STRUCT_SIZE;
    args.message = message, args.errc = XLA_FFI_Error_Code_INTERNAL;
    return frame->api->XLA_FFI_Error_Create(&args);
}

static size_t sym_xla_size(const sym_array *array) { return (size_t)array->rows * (size_t)array->cols; }

static size_t sym_xla_states(const XLA_FFI_Buffer *buffer, const sym_array *array) {
    size_t total = 1;
    int64_t i;
    for (i = 0; i < buffer->rank; ++i) total *= (size_t)buffer->dims[i];
    return total / sym_xla_size(array);
}

#define SYM_XLA_MOST 16
static XLA_FFI_Error *sym_xla_run(const sym_slot *slot, XLA_FFI_CallFrame *frame) {
    const sym_function *f = slot->function;
    const size_t npar = (size_t)slot->model->npar, npre = (size_t)slot->model->npre;
    const double *in[SYM_XLA_MOST], *par;
    double *out[SYM_XLA_MOST], *pre, *work;
    size_t stride[SYM_XLA_MOST], n, first, scratch;
    int32_t k;
    if (frame->extension_start != NULL && frame->extension_start->type == XLA_FFI_Extension_Metadata) {
        XLA_FFI_Metadata *metadata = ((XLA_FFI_Metadata_Extension *)frame->extension_start)->metadata;
        metadata->api_version.major_version = XLA_FFI_API_MAJOR;
        metadata->api_version.minor_version = XLA_FFI_API_MINOR;
        return NULL;
    }
    if (f == NULL || f->n_in > SYM_XLA_MOST || f->n_out > SYM_XLA_MOST || frame->args.size != f->n_in ||
        frame->rets.size != f->n_out)
        return sym_xla_error(frame, "symofros: the arguments are not those of the model's function");
    n = sym_xla_states(frame->rets.rets[0], &f->out[0]);
    par = ((XLA_FFI_Buffer *)frame->args.args[0])->data;
    for (k = 1; k < f->n_in; ++k) {
        in[k] = ((XLA_FFI_Buffer *)frame->args.args[k])->data;
        stride[k] = sym_xla_size(&f->in[k]);
    }
    for (k = 0; k < f->n_out; ++k) out[k] = ((XLA_FFI_Buffer *)frame->rets.rets[k])->data;
    scratch = slot->many != NULL && slot->many->work > f->work ? slot->many->work : f->work;
    pre = malloc((npre + scratch + 1) * sizeof(double));
    if (pre == NULL) return sym_xla_error(frame, "symofros: no memory for a call");
    work = pre + npre;
    in[0] = pre, stride[0] = 0;
    /* States that share their parameters are one batch. */
    for (first = 0; first < n;) {
        const sym_function *chosen;
        size_t last = first + 1;
        while (last < n && memcmp(par + first * npar, par + last * npar, npar * sizeof(double)) == 0) ++last;
        slot->model->init(par + first * npar, pre);
        chosen = slot->many != NULL && last - first >= slot->from ? slot->many : f;
        chosen->batch(last - first, in, stride, out, work);
        for (k = 1; k < f->n_in; ++k) in[k] += (last - first) * stride[k];
        for (k = 0; k < f->n_out; ++k) out[k] += (last - first) * sym_xla_size(&f->out[k]);
        first = last;
    }
    free(pre);
    return NULL;
}

#define SYM_ONE(i) \
    static XLA_FFI_Error *sym_xla_##i(XLA_FFI_CallFrame *frame) { return sym_xla_run(&sym_slots[i], frame); }
#define SYM_EIGHT(x, i) x(i##0) x(i##1) x(i##2) x(i##3) x(i##4) x(i##5) x(i##6) x(i##7)
#define SYM_ALL(x) \
    SYM_EIGHT(x, 00) SYM_EIGHT(x, 01) SYM_EIGHT(x, 02) SYM_EIGHT(x, 03) SYM_EIGHT(x, 04) SYM_EIGHT(x, 05) \
    SYM_EIGHT(x, 06) SYM_EIGHT(x, 07) /* octal */
SYM_ALL(SYM_ONE)

SYM_EXPORT XLA_FFI_Handler *sym_xla_handler(int32_t slot) {
#define SYM_NAME(i) sym_xla_##i,
    static XLA_FFI_Handler *const handlers[] = {SYM_ALL(SYM_NAME)};
    return handlers[slot];
}
SYM_EXPORT int32_t sym_xla_slots(void) { return SYM_SLOTS; }
