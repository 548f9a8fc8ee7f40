/* The type Step: steps of a run that is made by hand (stepping/batches/by_hand.c), part of the module of symofros_call.c.
 *
 * Step(function, hand, n, made, plain, kept) is made by symofros/simulation/stepping/fast_step.py. A call takes inputs, an
 * array (n) or None, and a number of steps, and gives True where all were made; made(status) says what else comes of
 * steps, made(None) where another thread is within a call. Calls with other arguments, or where no step is made, go to
 * plain, with the same arguments.
 */

typedef int32_t (*step_function)(void *hand, const double *u, int64_t steps);

/* Steps of one call: Ctrl-C waits for them. More are made by plain, in portions. */
#define SYM_MOST_STEPS 64

typedef struct {
    PyObject_HEAD
    vectorcallfunc vectorcall;
    step_function step;
    void *hand;
    npy_intp n;
    int no_step; /* status of a call that made none */
    int busy;    /* a thread makes steps, without the interpreter's lock; read and written with it */
    PyObject *made, *plain, *kept;
} step_object;

/* The numbers of an array (n), in a row; NULL where it is not that. */
static const double *plain_row(PyObject *value, npy_intp n) {
    PyArrayObject *array;
    if (!PyArray_CheckExact(value)) return NULL;
    array = (PyArrayObject *)value;
    if (PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != n || PyArray_TYPE(array) != NPY_DOUBLE) return NULL;
    return PyArray_ISCARRAY_RO(array) ? (const double *)PyArray_DATA(array) : NULL;
}

static PyObject *step_call(PyObject *callable, PyObject *const *args, size_t nargsf, PyObject *kwnames) {
    step_object *self = (step_object *)callable;
    const Py_ssize_t n_args = PyVectorcall_NARGS(nargsf);
    const double *u = NULL;
    long steps = 1;
    int32_t status;
    PyObject *held, *code, *result;
    if (n_args > 2 || (kwnames != NULL && PyTuple_GET_SIZE(kwnames) > 0)) goto plain;
    if (n_args > 0 && args[0] != Py_None && (u = plain_row(args[0], self->n)) == NULL) goto plain;
    if (n_args > 1) {
        int overflow;
        if (!PyLong_CheckExact(args[1])) goto plain;
        steps = PyLong_AsLongAndOverflow(args[1], &overflow);
        if (overflow != 0 || steps < 1 || steps > SYM_MOST_STEPS) goto plain;
    }
    if (self->busy) return PyObject_CallOneArg(self->made, Py_None);
    held = n_args > 0 ? Py_NewRef(args[0]) : NULL;
    self->busy = 1;
    Py_BEGIN_ALLOW_THREADS
    status = self->step(self->hand, u, steps);
    Py_END_ALLOW_THREADS
    self->busy = 0;
    Py_XDECREF(held);
    if (status == 0) Py_RETURN_TRUE;
    if (status == self->no_step) goto plain;
    code = PyLong_FromLong(status);
    if (code == NULL) return NULL;
    result = PyObject_CallOneArg(self->made, code);
    Py_DECREF(code);
    return result;
plain:
    return PyObject_Vectorcall(self->plain, args, (size_t)n_args, kwnames);
}

static int step_traverse(step_object *self, visitproc visit, void *arg) {
    Py_VISIT(self->made);
    Py_VISIT(self->plain);
    Py_VISIT(self->kept);
    return 0;
}

static int step_clear(step_object *self) {
    Py_CLEAR(self->made);
    Py_CLEAR(self->plain);
    Py_CLEAR(self->kept);
    return 0;
}

static void step_release(step_object *self) {
    PyObject_GC_UnTrack(self);
    (void)step_clear(self);
    Py_TYPE(self)->tp_free((PyObject *)self);
}

static PyObject *step_make(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
    PyObject *function, *hand, *made, *plain, *kept;
    Py_ssize_t n;
    int no_step;
    step_object *self;
    (void)kwargs;
    if (!PyArg_ParseTuple(args, "OOniOOO", &function, &hand, &n, &no_step, &made, &plain, &kept)) return NULL;
    self = (step_object *)type->tp_alloc(type, 0);
    if (self == NULL) return NULL;
    self->vectorcall = step_call;
    self->step = (step_function)(uintptr_t)PyLong_AsVoidPtr(function);
    self->hand = PyLong_AsVoidPtr(hand);
    self->n = n, self->no_step = no_step;
    self->made = Py_NewRef(made), self->plain = Py_NewRef(plain), self->kept = Py_NewRef(kept);
    if (PyErr_Occurred()) Py_CLEAR(self);
    return (PyObject *)self;
}

static PyTypeObject step_type = {
    PyVarObject_HEAD_INIT(NULL, 0)
    .tp_name = "symofros_call.Step",
    .tp_doc = "Steps of a run, made by hand: step(u=None, steps=1).",
    .tp_basicsize = sizeof(step_object),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL | Py_TPFLAGS_HAVE_GC,
    .tp_vectorcall_offset = offsetof(step_object, vectorcall),
    .tp_call = PyVectorcall_Call,
    .tp_new = step_make,
    .tp_dealloc = (destructor)step_release,
    .tp_traverse = (traverseproc)step_traverse,
    .tp_clear = (inquiry)step_clear,
};
