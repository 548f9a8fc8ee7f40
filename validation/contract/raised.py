"""What is not to end a run: an exception inside an engine's adapter or plug-in becomes an answer in words."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import ParamSpec, TypeVar

import symofros as sf

T = TypeVar("T")
P = ParamSpec("P")
# What code from outside may raise in place of an answer: all but an interrupt.
ANY = (Exception, SystemExit)


@dataclass(frozen=True)
class Raised:
    """An exception in place of an answer.

    Attributes:
        words: Kind and message, and where it was raised.
    """

    words: str


def attempted(function: Callable[P, T], *arguments: P.args, **named: P.kwargs) -> T | Raised:
    """Result of a function, or `Raised` for its exception; KeyboardInterrupt and missing extras propagate."""
    try:
        return function(*arguments, **named)
    except ANY as error:
        if not_installed(error):  # Nobody's fault, and said of the whole model.
            raise
        return Raised(words(error))


def not_installed(error: BaseException) -> str:
    """The missing package and its remedy, where an exception reports a missing extra; "" otherwise."""
    if not isinstance(error, sf.SymofrosError) or not error.extra:
        return ""
    return f"{error.problem.what}; {error.problem.remedy}"


def words(error: BaseException) -> str:
    """Kind and message of an exception on one line, with the file, line and function that raised it."""
    said = " ".join(f"{type(error).__name__}: {error}".split())
    places = traceback.extract_tb(error.__traceback__)
    return f"{said} ({Path(places[-1].filename).name}:{places[-1].lineno}, in {places[-1].name})" if places else said
