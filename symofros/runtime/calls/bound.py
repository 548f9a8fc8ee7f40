"""A function bound to its memory: the fastest call from Python, for loops over single states or over equal batches."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from math import prod
from types import MappingProxyType
from typing import Any, Literal, NoReturn, get_args

import numpy as np

from symofros.base.arguments import check_argument
from symofros.base.arrays import share_memory
from symofros.errors import ShapeError, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.calls.kernel import Array, BatchKernel, Kernel, Numbers, Signature
from symofros.runtime.calls.layout import columns

Layout = Literal["rows", "columns"]
# More than any memory holds; sizes of arrays are computed from it without overflow.
_MAX_STATES = 1 << 40


class Bound:
    """One function, the arrays it reads and the arrays it writes. A call computes, and neither checks nor allocates.

    Calls of one Bound share its arrays: each thread needs its own.

    Args:
        evaluate: Computes, on the arrays.
        arrays: Arrays of each input and output, by name.
        signature: Signature of the function.
        kept: Objects that must live as long as this.

    Attributes:
        inputs: Group, such as "q" -> array (size), or (n, size) of a batch, to be written into.
        outputs: Name, such as "M" -> array, overwritten by each call; of a batch (n, ...).
    """

    __slots__ = ("_evaluate", "_kept", "inputs", "outputs")

    def __init__(
        self, evaluate: Callable[[], None], arrays: Mapping[str, Array], signature: Signature, kept: object
    ) -> None:
        self.inputs = MappingProxyType({group: arrays[group] for group, _ in signature.inputs})
        self.outputs = MappingProxyType({name: arrays[name] for name, _ in signature.outputs})
        self._evaluate = evaluate
        self._kept = kept

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        """Refuse to pickle or copy memory of C."""
        rule, remedy = "it is compiled code and memory of one process", "send the model, and bind the function there"
        functions = ", ".join(self.outputs)
        raise SymofrosError("bound function: neither pickled nor copied", f"that of {functions}", rule, remedy)

    def __call__(self) -> None:
        """Compute the outputs from the current contents of the inputs."""
        self._evaluate()


def bind(kernel: Kernel, par: Array, given: Mapping[str, Array], defaults: Mapping[str, Array]) -> Bound:
    """A function of a model with its memory, for one state.

    Args:
        kernel: The function.
        par: Run-time parameters (npar).
        given: Arrays of the caller's, inputs and outputs, used as they are.
        defaults: First values of inputs that are not given; zeros otherwise.

    Raises:
        UnknownNameError: The function has no such input or output.
        ShapeError: An array is not a writeable, contiguous float64 array of its shape, or an output shares memory.
    """
    signature = kernel.signature
    shapes = _shapes(signature, given)
    if par.ndim != 1:
        raise _misfit(signature, "par", f"{par.ndim} dimensions", f"parameters of one state, of shape {par.shape[-1:]}")
    for name, array in given.items():
        if not (isinstance(array, np.ndarray) and array.shape == shapes[name] and _plain(array)):
            raise _misfit(
                signature, name, _seen(array), f"a writeable C-contiguous float64 array of shape {shapes[name]}"
            )
    _refuse_overlaps(signature, given)
    arrays = {name: given.get(name, np.zeros(shape)) for name, shape in shapes.items()}
    _fill(arrays, given, defaults)
    pre = kernel.prepare(par[None])
    read, written = _ordered(signature, arrays)
    return Bound(kernel.bind(pre, read, written), arrays, signature, (kernel, pre))


def receivers(
    out: Mapping[str, Numbers], signature: Signature, batch: tuple[int, ...], dtype: type[np.floating]
) -> list[Numbers | None]:
    """The caller's arrays that receive the outputs of a plain call, in the signature's order; None where there is none.

    Args:
        out: Arrays by names of outputs.
        signature: Signature of the function.
        batch: Leading dimensions of the outputs.
        dtype: Their type.

    Raises:
        UnknownNameError: The function has no such output.
        ShapeError: An array is not a writeable, contiguous one of its output's shape and type, or shares memory.
    """
    check_argument(f"{signature.name}: out", out, Mapping[str, Any])
    shapes = {name: batch + shape for name, shape in signature.outputs}
    for name, array in out.items():
        if name not in shapes:
            what, hint = f"{signature.name}: no output '{name}'", did_you_mean(name, shapes) or "leave it out"
            raise UnknownNameError(what, ", ".join(shapes), "arrays receive outputs by these names", hint)
        kind = isinstance(array, np.ndarray) and array.dtype == dtype and bool(array.flags.carray)
        if not kind or array.shape != shapes[name]:
            rule = f"a writeable C-contiguous {np.dtype(dtype)} array of shape {shapes[name]}"
            raise _misfit(signature, name, _seen(array), rule, "pass np.empty(shape), or leave it out")
    _refuse_overlaps(signature, out)
    return [out.get(name) for name in shapes]


def _refuse_overlaps(signature: Signature, given: Mapping[str, Numbers]) -> None:
    """Refuse outputs that share memory with other arrays of the caller: each is written while others are read."""
    for name, _ in signature.outputs:
        for other in given if name in given else ():
            if other != name and share_memory(given[name], given[other]):
                rule = "an output shares no memory with another array: each is written while others are read"
                raise _misfit(signature, name, f"memory of '{other}'", rule, "pass an array, or a copy, of its own")


def into(out: Mapping[str, Numbers], signature: Signature, results: Sequence[Array]) -> list[Array]:
    """Results for one state, copied into arrays of the caller's where there are some; raises as `receivers`."""
    places = receivers(out, signature, (), np.float64)
    for place, result in zip(places, results, strict=True):
        if place is not None:
            place[...] = result
    return [result if place is None else place for place, result in zip(places, results, strict=True)]


def bind_batch(
    kernel: Kernel,
    n: int,
    layout: Layout,
    par: Array,
    given: Mapping[str, Array],
    defaults: Mapping[str, Array],
    threads: int,
) -> Bound:
    """A function of a model with its memory, for n states: the results of the plain call, bit for bit.

    Args:
        kernel: The function.
        n: Number of states.
        layout: Layout of arrays that are not given: each state in a row, or the states as the fast axis.
        par: Run-time parameters (npar), or of each state (n, npar).
        given: Arrays of the caller's: inputs (n, size), or (size) for all states; outputs (n, ...).
        defaults: First values of inputs that are not given, in each state; zeros otherwise.
        threads: Number of threads that share a large batch.

    Raises:
        UnknownNameError: The function has no such input or output.
        ShapeError: n or the layout is not one, an array does not fit, or an output shares memory.
    """
    signature = kernel.signature
    n = _count(signature, n)
    if not isinstance(layout, str) or layout not in get_args(Layout):
        raise _misfit(signature, "layout", repr(layout)[:80], "'rows' or 'columns'", "leave it out for rows")
    shapes = _shapes(signature, given)
    if par.ndim != 1 and par.shape != (n, par.shape[-1]):
        raise _misfit(
            signature, "par", f"shape {par.shape}", f"shape {par.shape[-1:]}, or {(n, par.shape[-1])}: of each state"
        )
    shared = {group for group, _ in signature.inputs}
    for name, array in given.items():
        if not _fits(array, n, shapes[name], name in shared):
            also = f", or {shapes[name]} for all states" if name in shared else ""
            raise _misfit(
                signature,
                name,
                _seen(array),
                f"a writeable float64 array of shape {(n, *shapes[name])}{also}, by rows or by columns",
                "bind np.zeros(shape), or leave it out, and write into it",
            )
    _refuse_overlaps(signature, given)
    arrays = {name: given[name] if name in given else _room(n, shape, layout) for name, shape in shapes.items()}
    _fill(arrays, given, defaults)
    pre = kernel.prepare(np.atleast_2d(par))
    read = [arrays[group].reshape(-1, size) if size else np.zeros((1, 0)) for group, size in signature.inputs]
    written = [arrays[name].reshape(n, prod(shape)) for name, shape in signature.outputs]
    if isinstance(kernel, BatchKernel):
        evaluate = kernel.bind_batch(n, pre, read, written, threads)
    else:
        evaluate = _running(kernel, n, pre, read, [arrays[name] for name, _ in signature.outputs])
    return Bound(evaluate, arrays, signature, (kernel, pre, read, written))


def _running(kernel: Kernel, n: int, pre: Array, inputs: list[Array], outputs: list[Array]) -> Callable[[], None]:
    """A call of a function that NumPy evaluates; results, computed in NumPy's memory, are copied to the outputs."""

    def evaluate() -> None:
        for into, values in zip(outputs, kernel.run(n, pre, [*inputs]), strict=True):
            into[...] = values

    return evaluate


def _shapes(signature: Signature, given: Mapping[str, Array]) -> dict[str, tuple[int, ...]]:
    """Shapes of one state's inputs and outputs, by name; each name in `given` must be one of them."""
    shapes = {group: (size,) for group, size in signature.inputs} | dict(signature.outputs)
    for name in given:
        if name not in shapes:
            what = f"{signature.name}: neither input nor output '{name}'"
            raise UnknownNameError(
                what, ", ".join(shapes), "arrays are bound by these names", did_you_mean(name, shapes) or "leave it out"
            )
    return shapes


def _ordered(signature: Signature, arrays: Mapping[str, Array]) -> tuple[list[Array], list[Array]]:
    return [arrays[group] for group, _ in signature.inputs], [arrays[name] for name, _ in signature.outputs]


def _fill(arrays: Mapping[str, Array], given: Mapping[str, Array], defaults: Mapping[str, Array]) -> None:
    for name in defaults.keys() & arrays.keys() - given.keys():
        arrays[name][...] = defaults[name]


def _count(signature: Signature, n: object) -> int:
    try:
        count = operator.index(n)  # type: ignore[arg-type]  # Whatever is none raises TypeError.
    except TypeError:
        count = 0
    if not 1 <= count <= _MAX_STATES or isinstance(n, bool):
        raise _misfit(
            signature,
            "n",
            repr(n)[:80],
            "a number of states, a whole one from 1 on",
            "leave n out for one state without a batch dimension",
        )
    return count


def _room(n: int, shape: tuple[int, ...], layout: Layout) -> Array:
    """Zeros (n, *shape)."""
    if layout == "rows":
        return np.zeros((n, *shape))
    flat = columns(n, prod(shape), np.float64)
    flat[...] = 0.0
    return flat.reshape(n, *shape)  # Splits an axis, so that it is a view.


def _fits(array: Any, n: int, shape: tuple[int, ...], shared: bool) -> bool:
    """Whether addresses and strides describe where the numbers of a batch lie."""
    if not isinstance(array, np.ndarray) or array.dtype != np.float64:
        return False
    if shared and array.shape == shape:
        return _plain(array)
    if array.shape != (n, *shape) or not array.flags.behaved or any(step % array.itemsize for step in array.strides):
        return False
    return array.size == 0 or np.may_share_memory(array.reshape(n, prod(shape)), array)


def _plain(array: Array) -> bool:
    return array.dtype == np.float64 and bool(array.flags.carray)


def _seen(array: object) -> str:
    if not isinstance(array, np.ndarray):
        return type(array).__name__
    flags = array.flags
    faults = ", not contiguous or not writeable" if not flags.carray else ""
    return f"{array.dtype} array of shape {array.shape}{faults}"


def _misfit(signature: Signature, name: str, found: str, rule: str, remedy: str = "") -> ShapeError:
    what = f"{signature.name}: '{name}' can't be bound"
    remedy = remedy or "bind np.zeros(shape), or leave it out, and write into it"
    return ShapeError(what, found, rule, remedy)
