"""The exceptions, and the four-part form of what they say.

Every message names the object, what was found, the rule it breaks, and the remedy.
"""

from __future__ import annotations

import difflib
import re
import shlex
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import chain, islice
from typing import Self

# Nobody reads more, and hostile files have millions.
MAX_PROBLEMS = 100
_CANDIDATES = 1000
# So many problems that differ in the names of their objects alone are listed as one, which names so many of the others.
_ALIKE, _NAMED = 3, 3
_QUOTED = re.compile(r"'[^']*'")


@dataclass(frozen=True)
class Argument:
    """An argument of `sf.load` that a remedy proposes, which commands have as an option of the same meaning.

    Attributes:
        name: Name of the argument.
        value: Value, or one of several; "" of one that is switched on.
        key: Key of the value, of an argument that is a mapping.
    """

    name: str
    value: str = ""
    key: str = ""

    @property
    def call(self) -> str:
        """The argument in Python."""
        if not self.value:
            return f"load(…, {self.name}=True)"
        stated = f"{{{self.key!r}: {self.value!r}}}" if self.key else f"[{self.value!r}]"
        return f"load(…, {self.name}={stated})"

    def flag(self, prefix: str) -> str:
        """The name of that option."""
        return prefix + (self.name.removesuffix("s") if self.key else self.name.replace("_", "-"))

    def option(self, prefix: str) -> str:
        """The option of a command, whose name begins with the prefix; one occurrence states one value."""
        stated = f"{self._name_of_pair()}={self.value}" if self.key else self.value
        return " ".join(filter(None, (self.flag(prefix), shlex.quote(stated) if stated else "")))

    def _name_of_pair(self) -> str:
        """The key as a command reads it: between backquotes where it would not be read as it stands."""
        plain = not {"=", "`"} & set(self.key) and self.key == self.key.strip()
        return self.key if plain else f"`{self.key.replace('`', '``')}`"


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a description.

    Attributes:
        what: The object and its fault, as in "joint 'q1': parent body 'bas' does not exist".
        found: State found instead.
        rule: Rule that must hold.
        remedy: Remedy: the change to make.
        where: "file:line", or "" for an object built in Python.
        argument: Argument of `load` that the remedy states as it is written in Python.
        extra: Extra of this distribution whose package is not installed; "" where that is not the fault.
    """

    what: str
    found: str = ""
    rule: str = ""
    remedy: str = ""
    where: str = ""
    argument: Argument | None = None
    extra: str = ""

    def in_shell(self, prefix: str = "--") -> Problem:
        """The same, its remedy with the option that a command has in the place of the argument.

        Args:
            prefix: Beginning of the names of the command's options.
        """
        if self.argument is None:
            return self
        what, name = self.what, self.argument.name
        if what.startswith(f"{name} "):
            what = self.argument.flag(prefix) + what.removeprefix(name)
        return replace(self, what=what, remedy=self.remedy.replace(self.argument.call, self.argument.option(prefix)))

    def __str__(self) -> str:
        """The message: one line, then the parts that are given, indented."""
        head = f"{self.where}: {self.what}" if self.where else self.what
        parts = [("found", self.found), ("rule", self.rule), ("remedy", self.remedy)]
        return "\n".join([head, *(f"  {label + ':':<8}{text}" for label, text in parts if text)])


def listed(problems: Sequence[Problem]) -> str:
    """The text of problems; several that differ in the names of their objects alone are one, with their number."""
    by_kind: dict[tuple[str, ...], list[Problem]] = {}
    for problem in problems:
        kind = _QUOTED.sub("'", problem.what), problem.found, problem.rule, problem.remedy
        by_kind.setdefault(kind, []).append(problem)
    texts = (map(str, each) if len(each) < _ALIKE else [_gathered(each)] for each in by_kind.values())
    return "\n".join(chain.from_iterable(texts))


def _gathered(by_kind: Sequence[Problem]) -> str:
    """The first of problems of one kind, with the number of the others and the first names among these."""
    first, others = by_kind[0], by_kind[1:]
    shown = ", ".join(map(_named, others[:_NAMED])) + (", …" if len(others) > _NAMED else "")
    return str(replace(first, what=f"{first.what}; and {len(others)} more: {shown}"))


def _named(problem: Problem) -> str:
    """The object of a problem, with its line."""
    name = next(iter(_QUOTED.findall(problem.what)), problem.what)
    line = problem.where.rpartition(":")[2]
    return f"{name} (line {line})" if line.isdigit() else name


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
        problems: What is wrong, with the further parts of a `Problem` behind it; or a problem, or several.
        found: State found instead.
        rule: Rule that must hold.
        remedy: Remedy: the change to make.
        where: "file:line", or "" for an object built in Python.
        argument: Argument of `load` that the remedy states as it is written in Python.
    """

    def __init__(
        self,
        problems: Sequence[Problem] | Problem | str,
        found: str = "",
        rule: str = "",
        remedy: str = "",
        where: str = "",
        argument: Argument | None = None,
    ) -> None:
        if isinstance(problems, str):
            problems = Problem(problems, found, rule, remedy, where, argument)
        self.problems: tuple[Problem, ...] = (problems,) if isinstance(problems, Problem) else tuple(problems)
        super().__init__(listed(self.problems))

    @classmethod
    def of_extra(cls, what: str, found: str, rule: str, extra: str, instead: str = "") -> Self:
        """The error that a package is not installed, which an extra brings.

        Args:
            what: What was asked.
            found: What is missing.
            rule: Why it is needed.
            extra: The extra that brings it.
            instead: What serves without it.
        """
        remedy = f"pip install 'symofros[{extra}]'"
        return cls(Problem(what, found, rule, f"{remedy}, or {instead}" if instead else remedy, extra=extra))

    @property
    def problem(self) -> Problem:
        """The first problem, the only one of most errors."""
        return self.problems[0]

    @property
    def extra(self) -> str:
        """The extra that is not installed, where that is all that is wrong; else ""."""
        return self.problem.extra if len(self.problems) == 1 else ""

    def in_shell(self, prefix: str = "--") -> str:
        """The message for who gave a command, whose options begin with the prefix."""
        return listed([problem.in_shell(prefix) for problem in self.problems])

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


class StoredStateWarning(UserWarning):
    """A file that keeps earlier work, such as one of the cache, is damaged or can't be written: work is repeated."""


class InconsistentModelWarning(UserWarning):
    """A model leaves out terms of the order of those it keeps, or a matrix is a rotation to a few digits only.

    Also: a function takes friction that sticks in runs as smooth, at a joint at rest.
    """


def near_name(name: str, known: Iterable[str], spelling: Callable[[str], str] = str, likeness: float = 0.5) -> str:
    """The question whether the nearest known name, capitals apart, was meant; "" where none is so like it."""
    candidates = {str(other).lower(): other for other in islice(known, _CANDIDATES)}
    near = difflib.get_close_matches(str(name).lower(), candidates, n=1, cutoff=likeness)
    return f"did you mean '{spelling(candidates[near[0]])}'?" if near else ""


def did_you_mean(name: str, known: Iterable[str], spelling: Callable[[str], str] = str) -> str:
    """The remedy for a misspelt name: the nearest known one, or the list of them.

    Args:
        name: Name as it was written.
        known: Names that exist, in the order in which they are listed; by the alphabet if they have none.
        spelling: How a name is written there; as it is by default.

    Returns:
        "did you mean 'tip'?", or "use one of: …", or "" when nothing is known.
    """
    known = sorted(known) if isinstance(known, set | frozenset) else list(known)
    near = near_name(name, known, spelling)
    if near:
        return near
    if not known:
        return ""
    shown = ", ".join(map(spelling, known[:12])) + (", …" if len(known) > 12 else "")
    return f"use one of: {shown}"
