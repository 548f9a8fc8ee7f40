/* A module of Python: calls of a model's functions for one state, from arrays of NumPy to new arrays. Written by hand.
 *
 * Call(eval, work, inputs, outputs, pre) is made by symofros/runtime/calls/single.py, which states what each is. A call
 * takes a dict of the inputs by name and gives a list of the outputs, or None where an input is no array of float64 of
 * the expected length, or a time no float: such calls are made elsewhere, and refused or converted there.
 */
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <numpy/arrayobject.h>

#define SYM_MOST_INPUTS 16

typedef void (*evaluate_function)(const double *const *in, double *const *out, double *work);

typedef struct {
    PyObject *name;     /* key in the dict */
    PyObject *fallback; /* what None stands for, an array; or NULL */
    npy_intp size;      /* -1 for the time, a number */
    double *copy;       /* where numbers go that do not lie in a row */
} input;

typedef struct {
    int rank;
    npy_intp shape[2];
} output;

typedef struct {
    PyObject_HEAD
    vectorcallfunc vectorcall;
    evaluate_function evaluate;
    Py_ssize_t n_in, n_out; /* n_in without pre */
    input *in;
    output *out;
    const double **read; /* pre, then the inputs */
    double **written;
    double *memory; /* of copies and scratch */
    PyObject *kept; /* arguments that C points into */
} call_object;

/* The numbers of an array, in a row; NULL where it is not as expected. */
static const double *numbers(const input *of, PyObject *value) {
    PyArrayObject *array;
    npy_intp i, stride;
    const char *at;
    if (of->size < 0) {
        if (!PyFloat_CheckExact(value)) return NULL;
        of->copy[0] = PyFloat_AS_DOUBLE(value);
        return of->copy;
    }
    if (!PyArray_CheckExact(value)) return NULL;
    array = (PyArrayObject *)value;
    if (PyArray_NDIM(array) != 1 || PyArray_DIM(array, 0) != of->size) return NULL;
    if (PyArray_TYPE(array) != NPY_DOUBLE || !PyArray_ISNOTSWAPPED(array)) return NULL;
    if (PyArray_IS_C_CONTIGUOUS(array) && PyArray_ISALIGNED(array)) return (const double *)PyArray_DATA(array);
    at = PyArray_BYTES(array);
    stride = PyArray_STRIDE(array, 0);
    for (i = 0; i < of->size; ++i) memcpy(of->copy + i, at + i * stride, sizeof(double));
    return of->copy;
}

static PyObject *call(PyObject *callable, PyObject *const *args, size_t nargsf, PyObject *kwnames) {
    call_object *self = (call_object *)callable;
    PyObject *given, *results, *held[SYM_MOST_INPUTS];
    Py_ssize_t i, n_held = 0;
    if (PyVectorcall_NARGS(nargsf) != 1 || (kwnames && PyTuple_GET_SIZE(kwnames)) || !PyDict_CheckExact(args[0])) {
        PyErr_SetString(PyExc_TypeError, "a call takes one dict of inputs");
        return NULL;
    }
    given = args[0];
    for (i = 0; i < self->n_in; ++i) {
        const input *of = &self->in[i];
        PyObject *value = PyDict_GetItemWithError(given, of->name);
        if (value == NULL) {
            if (!PyErr_Occurred()) PyErr_SetObject(PyExc_KeyError, of->name);
            goto fail;
        }
        if (value == Py_None && of->fallback) value = of->fallback;
        self->read[1 + i] = numbers(of, value);
        if (self->read[1 + i] == NULL) {
            while (n_held > 0) Py_DECREF(held[--n_held]);
            Py_RETURN_NONE;
        }
        Py_INCREF(value); /* Other threads may change the dict while C runs. */
        held[n_held++] = value;
    }
    results = PyList_New(self->n_out);
    if (results == NULL) goto fail;
    for (i = 0; i < self->n_out; ++i) {
        PyObject *array = PyArray_SimpleNew(self->out[i].rank, self->out[i].shape, NPY_DOUBLE);
        if (array == NULL) {
            Py_DECREF(results);
            goto fail;
        }
        PyList_SET_ITEM(results, i, array);
        self->written[i] = (double *)PyArray_DATA((PyArrayObject *)array);
    }
    Py_BEGIN_ALLOW_THREADS
    self->evaluate(self->read, self->written, self->memory);
    Py_END_ALLOW_THREADS
    while (n_held > 0) Py_DECREF(held[--n_held]);
    return results;
fail:
    while (n_held > 0) Py_DECREF(held[--n_held]);
    return NULL;
}

static void release(call_object *self) {
    Py_ssize_t i;
    for (i = 0; self->in && i < self->n_in; ++i) {
        Py_CLEAR(self->in[i].name);
        Py_CLEAR(self->in[i].fallback);
    }
    Py_CLEAR(self->kept);
    PyMem_Free(self->in);
    PyMem_Free(self->out);
    PyMem_Free(self->read);
    PyMem_Free(self->written);
    PyMem_Free(self->memory);
    Py_TYPE(self)->tp_free((PyObject *)self);
}

/* Inputs (name, length or -1 for the time, array in place of None or None) and outputs (length, ...). */
static int describe(call_object *self, PyObject *inputs, PyObject *outputs, Py_ssize_t work) {
    Py_ssize_t i, k, doubles = work;
    for (i = 0; i < self->n_in; ++i) {
        PyObject *name, *fallback;
        if (!PyArg_ParseTuple(PyTuple_GET_ITEM(inputs, i), "UnO", &name, &self->in[i].size, &fallback)) return -1;
        self->in[i].name = Py_NewRef(name);
        self->in[i].fallback = fallback == Py_None ? NULL : Py_NewRef(fallback);
        doubles += self->in[i].size < 1 ? 1 : self->in[i].size;
    }
    for (i = 0; i < self->n_out; ++i) {
        PyObject *shape = PyTuple_GET_ITEM(outputs, i);
        if (!PyTuple_Check(shape) || PyTuple_GET_SIZE(shape) > 2) {
            PyErr_SetString(PyExc_TypeError, "an output is a tuple of at most two lengths");
            return -1;
        }
        self->out[i].rank = (int)PyTuple_GET_SIZE(shape);
        for (k = 0; k < self->out[i].rank; ++k) {
            self->out[i].shape[k] = PyNumber_AsSsize_t(PyTuple_GET_ITEM(shape, k), PyExc_OverflowError);
            if (self->out[i].shape[k] == -1 && PyErr_Occurred()) return -1;
        }
    }
    self->memory = PyMem_Calloc((size_t)doubles, sizeof(double));
    if (self->memory == NULL) {
        PyErr_NoMemory();
        return -1;
    }
    for (i = 0; i < self->n_in; ++i) {
        self->in[i].copy = self->memory + work;
        work += self->in[i].size < 1 ? 1 : self->in[i].size;
    }
    return 0;
}

static PyObject *make(PyTypeObject *type, PyObject *args, PyObject *kwargs) {
    PyObject *address, *inputs, *outputs, *pre, *kept;
    Py_ssize_t work;
    call_object *self;
    (void)kwargs;
    if (!PyArg_ParseTuple(args, "OnO!O!O!O", &address, &work, &PyTuple_Type, &inputs, &PyTuple_Type, &outputs,
                          &PyArray_Type, &pre, &kept))
        return NULL;
    if (work < 1 || PyTuple_GET_SIZE(inputs) > SYM_MOST_INPUTS) {
        PyErr_SetString(PyExc_ValueError, "a call has scratch, and few inputs");
        return NULL;
    }
    self = (call_object *)type->tp_alloc(type, 0);
    if (self == NULL) return NULL;
    self->vectorcall = call;
    self->n_in = PyTuple_GET_SIZE(inputs);
    self->n_out = PyTuple_GET_SIZE(outputs);
    self->in = PyMem_Calloc((size_t)self->n_in + 1, sizeof(input));
    self->out = PyMem_Calloc((size_t)self->n_out + 1, sizeof(output));
    self->read = PyMem_Calloc((size_t)self->n_in + 1, sizeof(double *));
    self->written = PyMem_Calloc((size_t)self->n_out + 1, sizeof(double *));
    self->evaluate = (evaluate_function)(uintptr_t)PyLong_AsVoidPtr(address);
    self->kept = PyTuple_Pack(2, pre, kept);
    if (!self->in || !self->out || !self->read || !self->written || !self->kept || PyErr_Occurred() ||
        describe(self, inputs, outputs, work) < 0) {
        if (!PyErr_Occurred()) PyErr_NoMemory();
        Py_DECREF(self);
        return NULL;
    }
    self->read[0] = (const double *)PyArray_DATA((PyArrayObject *)pre);
    return (PyObject *)self;
}

static PyTypeObject call_type = {
    PyVarObject_HEAD_INIT(NULL, 0)
    .tp_name = "symofros_call.Call",
    .tp_doc = "A function of a model on one state.",
    .tp_basicsize = sizeof(call_object),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL,
    .tp_vectorcall_offset = offsetof(call_object, vectorcall),
    .tp_call = PyVectorcall_Call,
    .tp_new = make,
    .tp_dealloc = (destructor)release,
};

static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, .m_name = "symofros_call", .m_size = -1};

PyMODINIT_FUNC PyInit_symofros_call(void) {
    PyObject *made;
    import_array();
    if (PyType_Ready(&call_type) < 0) return NULL;
    made = PyModule_Create(&module);
    if (made != NULL && PyModule_AddObjectRef(made, "Call", (PyObject *)&call_type) < 0) Py_CLEAR(made);
    return made;
}
