"""Functions of the user's that runs call: where they stand, and where they raised."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from pathlib import Path
from types import CodeType
from typing import Any

_PACKAGE = str(Path(__file__).parents[1])


def named_function(function: Callable[..., Any]) -> str:
    """A function by its name, file and line, "law (controller.py:12)"; by its text where Python knows no more."""
    code = getattr(function, "__code__", None)
    if not isinstance(code, CodeType):
        code = getattr(vars(type(function)).get("__call__"), "__code__", None)
    if not isinstance(code, CodeType):
        return repr(function)[:80]
    name = getattr(function, "__qualname__", type(function).__qualname__)
    return f"{name} ({Path(code.co_filename).name}:{code.co_firstlineno})"


def raised_where(error: BaseException) -> str:
    """An exception and the line of the user's code that led to it, "ValueError('no') at controller.py:15 in law"."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if not frame.filename.startswith(_PACKAGE)]
    where = own[0] if own else frames[-1] if frames else None
    return f"{error!r} at {Path(where.filename).name}:{where.lineno} in {where.name}" if where else repr(error)
