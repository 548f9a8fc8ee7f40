/* A module of Python: calls of a model's functions for one state, from arrays of NumPy to new arrays. Written by hand.
 *
 * Call(eval, work, inputs, outputs, pre) is made by symofros/runtime/calls/single.py, which states what each is. A call
 * takes a dict of the inputs by name and gives a list of the outputs, or None where an input is no array of float64 of
 * the expected length, a time no float, or a quaternion not of unit length: such calls are made elsewhere, and refused
 * or converted there. Call.are_unit looks at the quaternions of a batch. SYM_UNIT_ROUNDING is defined before this text.
 * Step is the type of symofros_step.c.
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
    Py_ssize_t n_quaternions;
    npy_intp *quaternions; /* first index of each */
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

static double squared_length(const double *p, npy_intp step) {
    return p[0] * p[0] + p[step] * p[step] + p[2 * step] * p[2 * step] + p[3 * step] * p[3 * step];
}

/* Whether that is no unit quaternion's. What is no number goes through to what depends on it. */
static int is_off(double squared) { return squared > 1.0 + SYM_UNIT_ROUNDING || squared < 1.0 - SYM_UNIT_ROUNDING; }

/* The numbers of an array, in a row; NULL where it is not as expected. */
static const double *row_of(const input *of, PyObject *value) {
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

/* The same, with quaternions of unit length. */
static const double *numbers(const input *of, PyObject *value) {
    const double *row = row_of(of, value);
    Py_ssize_t k;
    for (k = 0; row != NULL && k < of->n_quaternions; ++k)
        if (is_off(squared_length(row + of->quaternions[k], 1))) row = NULL;
    return row;
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
        PyMem_Free(self->in[i].quaternions);
    }
    Py_CLEAR(self->kept);
    PyMem_Free(self->in);
    PyMem_Free(self->out);
    PyMem_Free(self->read);
    PyMem_Free(self->written);
    PyMem_Free(self->memory);
    Py_TYPE(self)->tp_free((PyObject *)self);
}

/* First indices of quaternions, a tuple. */
static int describe_quaternions(input *of, PyObject *places) {
    Py_ssize_t k;
    of->n_quaternions = PyTuple_GET_SIZE(places);
    of->quaternions = PyMem_Calloc((size_t)of->n_quaternions + 1, sizeof(npy_intp));
    if (of->quaternions == NULL) {
        PyErr_NoMemory();
        return -1;
    }
    for (k = 0; k < of->n_quaternions; ++k) {
        of->quaternions[k] = PyLong_AsSsize_t(PyTuple_GET_ITEM(places, k));
        if (of->quaternions[k] == -1 && PyErr_Occurred()) return -1;
        if (of->quaternions[k] < 0 || of->quaternions[k] > of->size - 4) {
            PyErr_SetString(PyExc_ValueError, "a quaternion lies within its input");
            return -1;
        }
    }
    return 0;
}

/* Inputs (name, length or -1 for the time, array in place of None or None, first indices of quaternions) and outputs
 * (length, ...). */
static int describe(call_object *self, PyObject *inputs, PyObject *outputs, Py_ssize_t work) {
    Py_ssize_t i, k, doubles = work;
    for (i = 0; i < self->n_in; ++i) {
        PyObject *name, *fallback, *places;
        if (!PyArg_ParseTuple(PyTuple_GET_ITEM(inputs, i), "UnOO!", &name, &self->in[i].size, &fallback, &PyTuple_Type,
                              &places))
            return -1;
        self->in[i].name = Py_NewRef(name);
        self->in[i].fallback = fallback == Py_None ? NULL : Py_NewRef(fallback);
        if (describe_quaternions(&self->in[i], places) < 0) return -1;
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

/* Two states at a time, by vectors of two. */
typedef double pair __attribute__((vector_size(16)));
typedef int64_t pair_mask __attribute__((vector_size(16)));

static pair pair_at(const double *p) {
    pair both;
    memcpy(&both, p, sizeof both);
    return both;
}

/* The squared lengths of the quaternions of two states. */
static pair squared_lengths(const double *p, npy_intp by, npy_intp step) {
    if (step == 1) {
        const pair xy = pair_at(p), zw = pair_at(p + 2), next_xy = pair_at(p + by), next_zw = pair_at(p + by + 2);
        const pair one = xy * xy + zw * zw, other = next_xy * next_xy + next_zw * next_zw;
        return (pair){one[0], other[0]} + (pair){one[1], other[1]};
    }
    if (by == 1) {
        const pair x = pair_at(p), y = pair_at(p + step), z = pair_at(p + 2 * step), w = pair_at(p + 3 * step);
        return x * x + y * y + z * z + w * w;
    }
    return (pair){squared_length(p, step), squared_length(p + by, step)};
}

/* Whether a quaternion of n states is off unit length; strides in doubles. */
static int any_off(npy_intp n, const double *p, npy_intp by, npy_intp step) {
    const pair most = {1.0 + SYM_UNIT_ROUNDING, 1.0 + SYM_UNIT_ROUNDING};
    const pair least = {1.0 - SYM_UNIT_ROUNDING, 1.0 - SYM_UNIT_ROUNDING};
    pair_mask off = {0, 0};
    npy_intp i;
    for (i = 0; i + 1 < n; i += 2) {
        const pair squared = squared_lengths(p + i * by, by, step);
        off |= (squared > most) | (squared < least);
    }
    return off[0] || off[1] || (i < n && is_off(squared_length(p + i * by, step)));
}

/* are_unit(q, firsts): whether the quaternions that begin at these indices in an array of float64 (..., size) are known
 * to be of unit length; of arrays that do not lie in even steps nothing is known here. */
static PyObject *are_unit(PyObject *self, PyObject *const *args, Py_ssize_t n_args) {
    PyArrayObject *array;
    npy_intp n, size, by, step;
    Py_ssize_t k;
    int rank;
    (void)self;
    if (n_args != 2 || !PyArray_Check(args[0]) || !PyTuple_CheckExact(args[1])) {
        PyErr_SetString(PyExc_TypeError, "are_unit takes an array and a tuple of indices");
        return NULL;
    }
    array = (PyArrayObject *)args[0];
    rank = PyArray_NDIM(array);
    if (rank < 1 || PyArray_TYPE(array) != NPY_DOUBLE || !PyArray_ISBEHAVED_RO(array)) Py_RETURN_FALSE;
    if (rank > 2 && !PyArray_IS_C_CONTIGUOUS(array)) Py_RETURN_FALSE;
    size = PyArray_DIM(array, rank - 1), n = size ? PyArray_SIZE(array) / size : 0;
    step = PyArray_STRIDE(array, rank - 1), by = rank == 1 ? 0 : rank == 2 ? PyArray_STRIDE(array, 0) : size * step;
    if (step % (npy_intp)sizeof(double) || by % (npy_intp)sizeof(double)) Py_RETURN_FALSE;
    step /= (npy_intp)sizeof(double), by /= (npy_intp)sizeof(double);
    for (k = 0; k < PyTuple_GET_SIZE(args[1]); ++k) {
        const Py_ssize_t first = PyLong_AsSsize_t(PyTuple_GET_ITEM(args[1], k));
        if (first == -1 && PyErr_Occurred()) return NULL;
        if (first < 0 || first > size - 4) {
            PyErr_SetString(PyExc_ValueError, "a quaternion lies within its state");
            return NULL;
        }
        if (any_off(n, (const double *)PyArray_DATA(array) + first * step, by, step)) Py_RETURN_FALSE;
    }
    Py_RETURN_TRUE;
}

#include "symofros_step.c"

static PyMethodDef methods[] = {
    {"are_unit", (PyCFunction)(void (*)(void))are_unit, METH_FASTCALL | METH_STATIC, "Whether quaternions are unit ones."},
    {NULL, NULL, 0, NULL},
};

static PyTypeObject call_type = {
    PyVarObject_HEAD_INIT(NULL, 0)
    .tp_name = "symofros_call.Call",
    .tp_doc = "A function of a model on one state.",
    .tp_basicsize = sizeof(call_object),
    .tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL,
    .tp_vectorcall_offset = offsetof(call_object, vectorcall),
    .tp_call = PyVectorcall_Call,
    .tp_methods = methods,
    .tp_new = make,
    .tp_dealloc = (destructor)release,
};

static struct PyModuleDef module = {PyModuleDef_HEAD_INIT, .m_name = "symofros_call", .m_size = -1};

PyMODINIT_FUNC PyInit_symofros_call(void) {
    PyObject *made;
    import_array();
    if (PyType_Ready(&call_type) < 0 || PyType_Ready(&step_type) < 0) return NULL;
    made = PyModule_Create(&module);
    if (made != NULL && (PyModule_AddObjectRef(made, "Call", (PyObject *)&call_type) < 0 ||
                         PyModule_AddObjectRef(made, "Step", (PyObject *)&step_type) < 0))
        Py_CLEAR(made);
    return made;
}
