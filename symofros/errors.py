"""The exceptions, and the four-part form of what they say.

Every message names the object, what was found, the rule it breaks, and the remedy.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import islice

# Nobody reads more, and hostile files have millions.
MAX_PROBLEMS = 100
_CANDIDATES = 1000


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a description.

    Attributes:
        what: The object and its fault, as in "joint 'q1': parent body 'bas' does not exist".
        found: State found instead.
        rule: Rule that must hold.
        remedy: Remedy: the change to make.
        where: "file:line", or "" for an object built in Python.
        extra: Extra of this distribution whose package is not installed; "" where that is not the fault.
    """

    what: str
    found: str = ""
    rule: str = ""
    remedy: str = ""
    where: str = ""
    extra: str = ""

    @classmethod
    def of_extra(cls, what: str, found: str, rule: str, extra: str, instead: str = "") -> Problem:
        """The problem that a package is not installed, which an extra brings.

        Args:
            what: What was asked.
            found: What is missing.
            rule: Why it is needed.
            extra: The extra that brings it.
            instead: What serves without it.
        """
        remedy = f"pip install 'symofros[{extra}]'"
        return cls(what, found, rule, f"{remedy}, or {instead}" if instead else remedy, extra=extra)

    def __str__(self) -> str:
        """The message: one line, then the parts that are given, indented."""
        head = f"{self.where}: {self.what}" if self.where else self.what
        parts = [("found", self.found), ("rule", self.rule), ("remedy", self.remedy)]
        return "\n".join([head, *(f"  {label + ':':<8}{text}" for label, text in parts if text)])


def first_of(problems: Iterable[Problem]) -> list[Problem]:
    """The first MAX_PROBLEMS of the problems, and one that says that there are more; the rest are never made."""
    endless = iter(problems)
    first = list(islice(endless, MAX_PROBLEMS))
    if next(endless, None) is not None:
        first.append(
            Problem(
                "there are more faults than are listed",
                f"more than {MAX_PROBLEMS}",
                f"the first {MAX_PROBLEMS} of a kind are listed",
                "mend these first",
                first[-1].where,
            )
        )
    return first


class SymofrosError(Exception):
    """The base of everything this package raises on purpose; the message is the text of the problems it carries.

    Args:
        problems: One problem, or several; a text that has no parts stands for a problem that only names the object.
    """

    def __init__(self, problems: Sequence[Problem] | Problem | str) -> None:
        stated = Problem(problems) if isinstance(problems, str) else problems
        self.problems: tuple[Problem, ...] = (stated,) if isinstance(stated, Problem) else tuple(stated)
        super().__init__("\n".join(map(str, self.problems)))

    @property
    def problem(self) -> Problem:
        """The first problem, the only one of most errors."""
        return self.problems[0]

    @property
    def extra(self) -> str:
        """The extra that is not installed, where that is all that is wrong; else ""."""
        return self.problem.extra if len(self.problems) == 1 else ""

    def __reduce__(self) -> tuple[type[SymofrosError], tuple[tuple[Problem, ...]]]:
        """Pickle by the problems, so that the error crosses process borders whole."""
        return type(self), (self.problems,)


class DescriptionError(SymofrosError):
    """A description can't be a mechanism; carries every problem found, not only the first."""


class ShapeError(SymofrosError, ValueError):
    """An array does not have the shape a model function needs."""


class ParameterError(SymofrosError, ValueError):
    """Run-time parameters have values that the description's conditions refuse."""


class ArgumentError(SymofrosError, TypeError, ValueError):
    """An argument of a function, or an option, is of another type than its signature states."""


class UnknownNameError(SymofrosError, KeyError):
    """A name that is not in the model: a frame, a parameter, a function."""

    def __str__(self) -> str:
        """KeyError would print the repr of the message; this prints the message."""
        return str(self.args[0])


class CompileError(SymofrosError):
    """The C compiler refused the generated code, or the result did not load."""


class ExportError(SymofrosError):
    """A model can't be written to that format, or to that place."""


class AssemblyError(SymofrosError):
    """No configuration, or no speeds, satisfy the constraints; says which constraint is worst and by how much."""


class EquilibriumError(SymofrosError):
    """No configuration was found in which the speeds stay as they are."""


class ActuationError(SymofrosError):
    """The chosen actuators can't produce a motion, or it is no motion of the mechanism."""


class BeamTheoryError(EquilibriumError):
    """A beam is bent beyond second-order theory, or that theory has no equilibrium; says which beam, where, how far."""


class CompilerMissingWarning(UserWarning):
    """No C compiler was found; a slower way is used."""


class InconsistentModelWarning(UserWarning):
    """A model leaves out terms of the order of those it keeps, or a matrix is a rotation to a few digits only."""


def near_name(name: str, known: Iterable[str]) -> str:
    """The question whether the nearest known name, capitals apart, was meant; "" where none is near."""
    candidates = {str(other).lower(): other for other in islice(known, _CANDIDATES)}
    near = difflib.get_close_matches(str(name).lower(), candidates, n=1, cutoff=0.5)
    return f"did you mean '{candidates[near[0]]}'?" if near else ""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The remedy for a misspelt name: the nearest known one, or the list of them.

    Args:
        name: Name as it was written.
        known: Names that exist.

    Returns:
        "did you mean 'tip'?", or "use one of: …", or "" when nothing is known.
    """
    known = list(known)
    near = near_name(name, known)
    if near:
        return near
    if not known:
        return ""
    shown = ", ".join(known[:12]) + (", …" if len(known) > 12 else "")
    return f"use one of: {shown}"
