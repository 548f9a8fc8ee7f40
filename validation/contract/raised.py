"""What is not to end a run: an exception inside an engine's adapter or plug-in becomes an answer in words.

Whose exception it is follows from where it was raised, not from what a plug-in's author thinks of it (`kind_of`).
"""

from __future__ import annotations

import dis
import re
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Literal, ParamSpec, TypeVar

import symofros as sf

T = TypeVar("T")
P = ParamSpec("P")
# What code from outside may raise in place of an answer: all but an interrupt.
ANY = (Exception, SystemExit)
# "refuses": in an engine's own words. "raises": inside an engine, and no refusal. "plug-in": outside of any.
Kind = Literal["refuses", "raises", "plug-in"]
# File name of text that calls an engine (`plugins.writing.source`).
TEXT = "<text that calls an engine>"
# Packages that every engine's caller uses, too: what they raise is said of whoever called them.
_LIBRARIES = sys.stdlib_module_names | {"numpy", "scipy"}
# Where a call does not fit what is called, or its own line is at fault: no word of the engine's.
_MISFITS = (TypeError, AttributeError, NameError, ImportError, SyntaxError, AssertionError)
# What interpreter and libraries of C++ raise of their own, whatever was asked.
_INTERNAL = (SystemError, MemoryError, IndexError, ArithmeticError, UnicodeError)
# Most letters of an exception's words.
_LONG = 300
# Words about shapes of arrays say nothing of a tree, whose shapes are those of its bodies.
_SHAPES = re.compile(r"(?<!collision )(?<!visual )\bshapes?\b|dimension|mismatch|broadcast|\bndim\b|size[12]\(\)")


@dataclass(frozen=True)
class Raised:
    """An exception in place of an answer.

    Attributes:
        words: Kind and message, and where it was raised.
        kind: Whose word it is.
    """

    words: str
    kind: Kind = "plug-in"


def attempted(function: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T | Raised:
    """Result of a function, or `Raised` for its exception; KeyboardInterrupt and missing extras propagate."""
    try:
        return function(*arguments, **named)
    except ANY as error:
        if not_installed(error):  # Nobody's fault, and said of the whole model.
            raise
        return Raised(words(error), kind_of(error))


def not_installed(error: BaseException) -> str:
    """The missing package and its remedy, where an exception reports a missing extra; "" otherwise."""
    if not isinstance(error, sf.SymofrosError) or not error.extra:
        return ""
    return f"{error.problem.what}; {error.problem.remedy}"


def words(error: BaseException) -> str:
    """Kind and message of an exception on one line, with the file, line and function that raised it."""
    said = " ".join(f"{type(error).__name__}: {error}".split())
    if len(said) > _LONG:  # Arrays of numbers, as a rule: what is wrong stands before or after them.
        said = f"{said[: _LONG // 2]} ... {said[-_LONG // 2 :]}"
    places = traceback.extract_tb(error.__traceback__)
    return f"{said} ({Path(places[-1].filename).name}:{places[-1].lineno}, in {places[-1].name})" if places else said


def kind_of(error: BaseException) -> Kind:
    """Whose word an exception is; the rule is in docs/engines.md, "Exceptions".

    The last step that is ours (a module of the harness, the plug-in's module, or its text) called something. If that is
    Python of another package, NumPy and the standard library apart, the exception is the engine's: a refusal where a
    `raise` of that same package states it in words that are not about shapes of arrays. If nothing in Python follows,
    our line called compiled code, or broke by itself.
    """
    steps = _steps(error.__traceback__)
    place = max((k for k, step in enumerate(steps) if _is_ours(step)), default=-1)
    if place < 0:
        return "plug-in"
    if steps[place].tb_frame.f_code.co_filename != TEXT:  # A stranger's plug-in follows, in a module of its own.
        after = steps[place + 1 :]
        own = {_module(after[0])} if after else set()
        place += max((k for k, step in enumerate(after, 1) if _module(step) in own), default=0)
    engine = [step for step in steps[place + 1 :] if _package(step) not in _LIBRARIES]
    if engine:
        stated = _operation(steps[-1]) == "RAISE_VARARGS" and _package(steps[-1]) == _package(engine[0])
        return "refuses" if stated and str(error) and not _SHAPES.search(str(error)) else "raises"
    if len(steps) > place + 1 or "CALL" not in _operation(steps[place]) or isinstance(error, _MISFITS):
        return "plug-in"
    if isinstance(error, _INTERNAL):
        return "raises"
    # Whoever calls an engine in Python may raise likewise; text of ours only calls.
    return "refuses" if steps[place].tb_frame.f_code.co_filename == TEXT and str(error) else "plug-in"


def _steps(trace: TracebackType | None) -> list[TracebackType]:
    """A traceback's steps, outermost first."""
    steps = []
    while trace is not None:
        steps.append(trace)
        trace = trace.tb_next
    return steps


def _module(step: TracebackType) -> str:
    return str(step.tb_frame.f_globals.get("__name__", ""))


def _package(step: TracebackType) -> str:
    return _module(step).partition(".")[0]


def _is_ours(step: TracebackType) -> bool:
    return step.tb_frame.f_code.co_filename == TEXT or _module(step).removeprefix("symofros.").startswith("validation.")


def _operation(step: TracebackType) -> str:
    """Name of the instruction at which a step stands."""
    return dis.opname[step.tb_frame.f_code.co_code[step.tb_lasti]]
