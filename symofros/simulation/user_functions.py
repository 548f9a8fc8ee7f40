"""Functions of the user's that runs call: where they stand, and where they raised."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import ArgumentError

_PACKAGE = str(Path(__file__).parents[1])
# States, about, at which a function is asked again for the inputs; share by which they may differ.
_CALLED, _SAME = 8, 1e-9


def named_function(function: Callable[..., Any]) -> str:
    """A function by its name, file and line, "law (controller.py:12)"; by its text where Python knows no more."""
    function = inspect.unwrap(function)
    code = getattr(function, "__code__", None)
    if not isinstance(code, CodeType):
        code = getattr(vars(type(function)).get("__call__"), "__code__", None)
    if not isinstance(code, CodeType):
        return repr(function)[:80]
    name = getattr(function, "__qualname__", type(function).__qualname__)
    return f"{name} ({Path(code.co_filename).name}:{code.co_firstlineno})"


def check_called_with(what: str, function: Callable[..., Any], *arguments: str) -> None:
    """Refuse a function that does not take what it is called with, in order; of some in C nobody knows.

    Args:
        what: What the function is, in words.
        function: The user's function.
        arguments: Names of what it is called with.

    Raises:
        ArgumentError: It takes other arguments.
    """
    try:
        signature = inspect.signature(function, follow_wrapped=False)
    except (TypeError, ValueError):
        return
    try:
        signature.bind(*arguments)
    except TypeError as error:
        called = ", ".join(arguments)
        found = f"{named_function(function)} takes {signature}: {error}"
        remedy = f"lambda {called}: ..., whether it needs all of them or not"
        raise ArgumentError(f"{what} takes other arguments", found, f"it is called with ({called})", remedy) from None


def raised_where(error: BaseException) -> str:
    """An exception and the line of the user's code that led to it, "ValueError('no') at controller.py:15 in law"."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if not frame.filename.startswith(_PACKAGE)]
    where = own[0] if own else frames[-1] if frames else None
    return f"{error!r} at {Path(where.filename).name}:{where.lineno} in {where.name}" if where else repr(error)


def gives_again(function: Callable[..., Any], states: Sequence[Array]) -> bool:
    """Whether a function of the user's gives the recorded inputs once more, at some of the states t (n), q, v, u."""
    t, q, v, u = (array[:: -max(1, len(array) // _CALLED)] for array in states)
    try:
        again = [np.asarray(function(float(t[i]), q[i].copy(), v[i].copy()), float) for i in range(len(t))]
    except Exception:  # Whatever it raises: the run itself has ended well.
        return False
    size = float(np.abs(u).max(initial=0.0))
    return all(row.shape == u[i].shape and np.abs(row - u[i]).max() <= _SAME * size for i, row in enumerate(again))
