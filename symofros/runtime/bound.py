"""A function bound to its memory: the fastest call from Python, for loops that call one state at a time."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from symofros.errors import Problem, ShapeError, UnknownNameError, did_you_mean
from symofros.runtime.kernel import Array, Kernel


class Bound:
    """One function, the arrays it reads and the arrays it writes. A call computes, and neither checks nor allocates.

    Calls of one Bound share its arrays: each thread needs its own.

    Args:
        kernel: The function.
        pre: Its parameter-only part (1, npre).
        arrays: Of each input and output, by name.

    Attributes:
        inputs: Group, such as "q" -> array (size), to be written into.
        outputs: Name, such as "M" -> array, overwritten by each call.
    """

    __slots__ = ("_evaluate", "_kept", "inputs", "outputs")

    def __init__(self, kernel: Kernel, pre: Array, arrays: Mapping[str, Array]) -> None:
        signature = kernel.signature
        self.inputs = MappingProxyType({group: arrays[group] for group, _ in signature.inputs})
        self.outputs = MappingProxyType({name: arrays[name] for name, _ in signature.outputs})
        self._evaluate = kernel.bind(pre, [*self.inputs.values()], [*self.outputs.values()])
        self._kept = kernel, pre

    def __call__(self) -> None:
        """Compute the outputs from what the inputs hold now."""
        self._evaluate()


def bind(kernel: Kernel, par: Array, given: Mapping[str, Array], defaults: Mapping[str, Array]) -> Bound:
    """A function of a model with its memory.

    Args:
        kernel: The function.
        par: Run-time parameters (npar).
        given: Arrays of the caller's, inputs and outputs, used as they are.
        defaults: What inputs that are not given hold at first; zeros otherwise.

    Raises:
        UnknownNameError: The function has no such input or output.
        ShapeError: An array is not a writeable, contiguous float64 array of its shape.
    """
    signature = kernel.signature
    shapes = {group: (size,) for group, size in signature.inputs} | dict(signature.outputs)
    for name, array in given.items():
        if name not in shapes:
            what = f"{signature.name}: neither input nor output '{name}'"
            raise UnknownNameError(str(Problem(what, ", ".join(shapes), "arrays are bound by these names",
                                               did_you_mean(name, shapes) or "leave it out")))  # fmt: skip
        _check(signature.name, name, array, shapes[name])
    arrays = {name: given.get(name, np.zeros(shape)) for name, shape in shapes.items()}
    for name in defaults.keys() & shapes.keys() - given.keys():
        arrays[name][:] = defaults[name]
    return Bound(kernel, kernel.prepare(par[None]), arrays)


def _check(function: str, name: str, array: Array, shape: tuple[int, ...]) -> None:
    if not isinstance(array, np.ndarray):
        found = type(array).__name__
    elif array.shape == shape and array.dtype == np.float64 and array.flags.carray:
        return
    else:
        order = "" if array.flags.carray else ", not contiguous or not writeable"
        found = f"{array.dtype} array of shape {array.shape}{order}"
    raise ShapeError(str(Problem(
        f"{function}: '{name}' can't be bound", found, f"a writeable C-contiguous float64 array of shape {shape}",
        "bind np.zeros(shape), or leave it out, and write into it",
    )))  # fmt: skip
