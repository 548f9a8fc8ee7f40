/* A module of Python: calls of a model's functions from arrays of NumPy to new arrays, or to arrays of the caller's.
 * Written by hand.
 *
 * Call(functions, inputs, outputs, pre, kept) is made by symofros/runtime/calls/plain.py, which states what each is. A
 * call takes a dict of the inputs by name, and one of arrays that receive outputs or None; it gives a list of the
 * outputs, or None where an input is no array of float64 of the expected length or of rows of it, a time no float, or a
 * quaternion not of unit length; where an array that is to receive an output does not fit, or overlaps another; where
 * batches do not have one length, or have as many states as threads may share; and within another call of the same
 * object, whose memory is in use. Such calls are made elsewhere, and refused or converted there. Call.are_unit looks at
 * the quaternions of a batch. SYM_UNIT_ROUNDING and SYM_MANY are defined before this text. Step is the type of
 * symofros_step.c.
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
typedef void (*batch_function)(size_t n, const double *const *in, const size_t *by, double *const *out, double *work);

typedef struct {
    PyObject *name;     /* key in the dict */
    PyObject *fallback; /* what None stands for, an array; or NULL */
    npy_intp size;      /* -1 for the time, a number */
    double *copy;       /* where numbers go that do not lie in a row */
    Py_ssize_t n_quaternions;
    npy_intp *quaternions; /* first index of each */
} input;

typedef struct {
    PyObject *name; /* key in the dict of arrays that receive outputs */
    int rank;       /* of one state */
    npy_intp shape[3]; /* states, then the lengths of one */
    npy_intp count; /* entries of one state */
} output;

/* Rows of states, and how to evaluate so many. */
typedef struct {
    batch_function evaluate; /* NULL: not known yet */
    double *work;
} batch;

typedef struct {
    PyObject_HEAD
    vectorcallfunc vectorcall;
    evaluate_function evaluate;
    Py_ssize_t n_in, n_out; /* n_in without pre */
    input *in;
    output *out;
    const double **read; /* pre, then the inputs */
    size_t *by;          /* distance from one state's to the next's, of the same */
    double **written;
    double *memory;     /* of copies and scratch */
    batch few, many;    /* below SYM_MANY states, and from there on */
    npy_intp most;      /* states of a call at most */
    PyObject *get_many; /* gives the address and scratch of what evaluates many, and what is kept for it */
    PyObject *kept, *kept_many; /* what C points into */
    int busy; /* a call is under way, within which Python may make another, as handlers of signals do */
} call_object;

static double squared_length(const double *p, npy_intp step) {
    return p[0] * p[0] + p[step] * p[step] + p[2 * step] * p[2 * step] + p[3 * step] * p[3 * step];
}

/* Whether that is no unit quaternion's. What is no number goes through to what depends on it. */
static int is_off(double squared) { return squared > 1.0 + SYM_UNIT_ROUNDING || squared < 1.0 - SYM_UNIT_ROUNDING; }

/* Whether C reads the array as it lies. */
static int is_plain(PyArrayObject *array) {
    return PyArray_TYPE(array) == NPY_DOUBLE && PyArray_ISNOTSWAPPED(array) && PyArray_IS_C_CONTIGUOUS(array) &&
           PyArray_ISALIGNED(array);
}

/* The numbers of one state, in a row; NULL where they are not as expected. */
static const double *row_of(const input *of, PyArrayObject *array) {
    npy_intp i, stride;
    const char *at;
    if (PyArray_DIM(array, 0) != of->size) return NULL;
    if (is_plain(array)) return (const double *)PyArray_DATA(array);
    if (PyArray_TYPE(array) != NPY_DOUBLE || !PyArray_ISNOTSWAPPED(array)) return NULL;
    at = PyArray_BYTES(array);
    stride = PyArray_STRIDE(array, 0);
    for (i = 0; i < of->size; ++i) memcpy(of->copy + i, at + i * stride, sizeof(double));
    return of->copy;
}

/* The numbers of an input, and its number of states; -1 of one without a batch; NULL where it is not as expected. */
static const double *rows_of(const input *of, PyObject *value, npy_intp *states) {
    const npy_intp size = of->size < 0 ? 1 : of->size;
    PyArrayObject *array;
    *states = -1;
    if (of->size < 0 && PyFloat_CheckExact(value)) {
        of->copy[0] = PyFloat_AS_DOUBLE(value);
        return of->copy;
    }
    if (!PyArray_CheckExact(value)) return NULL;
    array = (PyArrayObject *)value;
    if (of->size >= 0 && PyArray_NDIM(array) == 1) return row_of(of, array);
    if (PyArray_NDIM(array) != (of->size < 0 ? 1 : 2) || !is_plain(array)) return NULL;
    *states = PyArray_DIM(array, 0);
    if (*states < 1 || PyArray_SIZE(array) != *states * size) return NULL;
    return (const double *)PyArray_DATA(array);
}

static int any_off(npy_intp n, const double *p, npy_intp by, npy_intp step);

/* The same, with quaternions of unit length. */
static const double *numbers(const input *of, PyObject *value, npy_intp *states) {
    const double *rows = rows_of(of, value, states);
    Py_ssize_t k;
    for (k = 0; rows != NULL && k < of->n_quaternions; ++k)
        if (any_off(*states < 0 ? 1 : *states, rows + of->quaternions[k], of->size, 1)) rows = NULL;
    return rows;
}

/* The batch of inputs with so many states each (-1: none), and the distances between these; 0 where they have not one
 * length. */
static npy_intp one_batch(call_object *self, const npy_intp *states) {
    npy_intp n = -1;
    Py_ssize_t i;
    for (i = 0; i < self->n_in; ++i)
        if (states[i] > 0 && n <= 1) n = states[i];
    for (i = 0; i < self->n_in; ++i) {
        if (states[i] > 1 && states[i] != n) return 0;
        self->by[1 + i] = states[i] > 1 ? (size_t)(self->in[i].size < 0 ? 1 : self->in[i].size) : 0;
    }
    return n;
}

/* Whether two ranges of numbers have any in common. */
static int overlap(const double *a, npy_intp n_a, const double *b, npy_intp n_b) {
    return (uintptr_t)a < (uintptr_t)(b + n_b) && (uintptr_t)b < (uintptr_t)(a + n_a);
}

/* Whether an array can receive an output of n states (-1: of one without a batch) while the others are in use. */
static int receives(call_object *self, Py_ssize_t which, PyObject *value, npy_intp n) {
    const output *of = &self->out[which];
    PyArrayObject *array = (PyArrayObject *)value;
    const int first = n < 0;
    npy_intp count = of->count * (first ? 1 : n);
    const double *at;
    Py_ssize_t i;
    if (!PyArray_CheckExact(value) || !is_plain(array) || !PyArray_ISWRITEABLE(array)) return 0;
    if (PyArray_NDIM(array) != of->rank + !first ||
        memcmp(PyArray_DIMS(array), of->shape + first, (size_t)(of->rank + !first) * sizeof(npy_intp)) != 0)
        return 0;
    at = (const double *)PyArray_DATA(array);
    for (i = 0; i < self->n_in; ++i) {
        const npy_intp size = self->in[i].size < 0 ? 1 : self->in[i].size;
        if (overlap(at, count, self->read[1 + i], !first && self->by[1 + i] ? n * size : size)) return 0;
    }
    for (i = 0; i < which; ++i)
        if (overlap(at, count, self->written[i], self->out[i].count * (first ? 1 : n))) return 0;
    return 1;
}

/* A list of the outputs of n states (-1: of one without a batch), in arrays of `out` by name where they fit; None where
 * one does not. */
static PyObject *results_of(call_object *self, PyObject *out, npy_intp n) {
    PyObject *results = PyList_New(self->n_out);
    const int first = n < 0;
    Py_ssize_t i, received = 0;
    for (i = 0; results != NULL && i < self->n_out; ++i) {
        output *of = &self->out[i];
        PyObject *array = NULL;
        of->shape[0] = n;
        if (out != NULL && (array = PyDict_GetItemWithError(out, of->name)) == NULL && PyErr_Occurred()) {
            Py_CLEAR(results);
            break;
        }
        if (array != NULL) {
            if (!receives(self, i, array, n)) {
                Py_DECREF(results);
                Py_RETURN_NONE;
            }
            Py_INCREF(array);
            ++received;
        } else {
            array = PyArray_SimpleNew(of->rank + !first, of->shape + first, NPY_DOUBLE);
        }
        if (array == NULL) {
            Py_CLEAR(results);
            break;
        }
        PyList_SET_ITEM(results, i, array);
        self->written[i] = (double *)PyArray_DATA((PyArrayObject *)array);
    }
    if (results != NULL && out != NULL && received != PyDict_GET_SIZE(out)) {
        Py_DECREF(results);
        Py_RETURN_NONE;
    }
    return results;
}

/* Ask once for what evaluates many states. */
static int find_many(call_object *self) {
    PyObject *found, *address, *kept;
    Py_ssize_t work;
    if (self->many.evaluate != NULL) return 0;
    found = PyObject_CallNoArgs(self->get_many);
    if (found == NULL) return -1;
    if (PyArg_ParseTuple(found, "OnO", &address, &work, &kept)) {
        PyMem_Free(self->many.work);
        self->many.work = PyMem_Calloc((size_t)(work < 1 ? 1 : work), sizeof(double));
        if (self->many.work == NULL) PyErr_NoMemory();
        Py_XSETREF(self->kept_many, Py_NewRef(kept));
        self->many.evaluate = (batch_function)(uintptr_t)PyLong_AsVoidPtr(address);
    }
    Py_DECREF(found);
    if (PyErr_Occurred()) self->many.evaluate = NULL;
    return PyErr_Occurred() ? -1 : 0;
}

static PyObject *call(PyObject *callable, PyObject *const *args, size_t nargsf, PyObject *kwnames) {
    call_object *self = (call_object *)callable;
    PyObject *results = NULL, *held[SYM_MOST_INPUTS], *out = NULL;
    npy_intp n, states[SYM_MOST_INPUTS];
    const Py_ssize_t n_args = PyVectorcall_NARGS(nargsf);
    Py_ssize_t i, n_held = 0;
    int as_expected = 1, batched = 0;
    if (n_args == 2 && args[1] != Py_None) out = args[1];
    if (n_args < 1 || n_args > 2 || (kwnames && PyTuple_GET_SIZE(kwnames)) || !PyDict_CheckExact(args[0])) {
        PyErr_SetString(PyExc_TypeError, "a call takes one dict of inputs, and one of arrays that receive outputs");
        return NULL;
    }
    if (self->busy || (out && !PyDict_CheckExact(out))) Py_RETURN_NONE;
    self->busy = 1;
    for (i = 0; as_expected && i < self->n_in; ++i) {
        const input *of = &self->in[i];
        PyObject *value = PyDict_GetItemWithError(args[0], of->name);
        if (value == NULL) {
            if (!PyErr_Occurred()) PyErr_SetObject(PyExc_KeyError, of->name);
            goto done;
        }
        if (value == Py_None && of->fallback) value = of->fallback;
        self->read[1 + i] = numbers(of, value, &states[i]);
        as_expected = self->read[1 + i] != NULL;
        batched |= states[i] >= 0;
        Py_INCREF(value); /* Other threads may change the dict while C runs. */
        held[n_held++] = value;
    }
    n = !as_expected ? 0 : batched ? one_batch(self, states) : -1;
    if (n == 0 || n > self->most) {
        results = Py_NewRef(Py_None);
        goto done;
    }
    if (n >= SYM_MANY && find_many(self) < 0) goto done;
    results = results_of(self, out, n);
    if (results == NULL || results == Py_None) goto done;
    Py_BEGIN_ALLOW_THREADS
    if (n < 0) {
        self->evaluate(self->read, self->written, self->memory);
    } else {
        const batch *of = n < SYM_MANY ? &self->few : &self->many;
        of->evaluate((size_t)n, self->read, self->by, self->written, of->work);
    }
    Py_END_ALLOW_THREADS
done:
    self->busy = 0;
    while (n_held > 0) Py_DECREF(held[--n_held]);
    return results;
}

static void release(call_object *self) {
    Py_ssize_t i;
    for (i = 0; self->in && i < self->n_in; ++i) {
        Py_CLEAR(self->in[i].name);
        Py_CLEAR(self->in[i].fallback);
        PyMem_Free(self->in[i].quaternions);
    }
    for (i = 0; self->out && i < self->n_out; ++i) Py_CLEAR(self->out[i].name);
    Py_CLEAR(self->kept);
    Py_CLEAR(self->kept_many);
    Py_CLEAR(self->get_many);
    PyMem_Free(self->many.work);
    PyMem_Free(self->by);
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
 * (name, (length, ...)). */
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
        output *of = &self->out[i];
        PyObject *name, *shape;
        if (!PyArg_ParseTuple(PyTuple_GET_ITEM(outputs, i), "UO!", &name, &PyTuple_Type, &shape)) return -1;
        if (PyTuple_GET_SIZE(shape) > 2) {
            PyErr_SetString(PyExc_TypeError, "an output has at most two lengths");
            return -1;
        }
        of->name = Py_NewRef(name);
        of->rank = (int)PyTuple_GET_SIZE(shape);
        of->count = 1;
        for (k = 0; k < of->rank; ++k) {
            of->shape[1 + k] = PyNumber_AsSsize_t(PyTuple_GET_ITEM(shape, k), PyExc_OverflowError);
            if (of->shape[1 + k] == -1 && PyErr_Occurred()) return -1;
            of->count *= of->shape[1 + k];
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
    PyObject *one, *few, *get_many, *inputs, *outputs, *pre, *kept;
    Py_ssize_t work, most;
    call_object *self;
    (void)kwargs;
    if (!PyArg_ParseTuple(args, "(OOnOn)O!O!O!O", &one, &few, &work, &get_many, &most, &PyTuple_Type, &inputs,
                          &PyTuple_Type, &outputs, &PyArray_Type, &pre, &kept))
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
    self->by = PyMem_Calloc((size_t)self->n_in + 1, sizeof(size_t));
    self->written = PyMem_Calloc((size_t)self->n_out + 1, sizeof(double *));
    self->evaluate = (evaluate_function)(uintptr_t)PyLong_AsVoidPtr(one);
    self->few.evaluate = (batch_function)(uintptr_t)PyLong_AsVoidPtr(few);
    self->most = most;
    self->get_many = Py_NewRef(get_many);
    self->kept = PyTuple_Pack(2, pre, kept);
    if (!self->in || !self->out || !self->read || !self->by || !self->written || !self->kept || PyErr_Occurred() ||
        describe(self, inputs, outputs, work) < 0) {
        if (!PyErr_Occurred()) PyErr_NoMemory();
        Py_DECREF(self);
        return NULL;
    }
    self->few.work = self->memory;
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
    .tp_doc = "A function of a model on one state or a batch.",
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
