"""Scores of suites from what is red at a fault's wrong release and at its right one.

A red cell is *new* where it is red at the wrong release and at the right one is not asked, or less red; where there is
no right release yet, every red cell of the wrong one is. New cells are put together into groups. A group *shows* the
fault if one of its functions, or what the engine does to all of its trees once they are built, is one that the fault's
file states as its subject, and if most of its trees are of those that the subject is shown in
(`validation.faults.entry.Subject`), by their names or by what the engine calls their constraints and demands; what a
reader makes of a file shows in files of that format alone. What else a script calls, and what else the same release
mended, is no part of it.

hit: some new group shows the fault. half a hit: all such groups are imprecise only, or they are lost among `LOST` new
groups or more. miss: neither. A false alarm is a group of cells
that are red at the right release, where the wrong one's answer was right, or less wrong, and which neither another
fault of the set that the right release still has nor a cause that is stated of the engine explains.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from itertools import takewhile
from types import MappingProxyType
from typing import Literal, NamedTuple

from ..engines.causes.grouping import Group, causes_of
from ..engines.verdicts import RED, Cell
from ..faults.entry import Fault

LOST = 20
# From the mildest to the worst; what is no number is as bad as a wrong one.
_BADNESS = {"imprecise": 1}
_WORST = 2
_ANSWERED = ("right", "imprecise")
# Classes that are about files.
_READ = ("reader", "writer", "mass properties")
# Format -> what a script has where it states such a file.
_FORMATS = {"mjcf": "<mujoco", "urdf": "<robot", "sdf": "<sdf", "usd": "#usda"}
Score = Literal["hit", "half a hit", "miss", "not asked"]


def grouped(cells: Sequence[Cell]) -> list[Group]:
    """Red cells put together by what they have in common; no stated cause, which people found, has a part in it."""
    return causes_of(cells, known=())


class Stated(NamedTuple):
    """What an engine calls what a tree states.

    Attributes:
        done: What it does to the tree once it is built; "" for nothing.
        called: Its constraints, and what else it demands.
    """

    done: str = ""
    called: str = ""


@dataclass(frozen=True)
class Shown:
    """A group of red cells, for a report.

    Attributes:
        functions: Names of functions.
        natives: What the engine calls them.
        models: Trees and files.
        verdict: The worst verdict.
        shows: Whether it shows the fault.
        explained: Why it is no false alarm; "" for no reason, or where that was not asked.
    """

    functions: list[str]
    natives: list[str]
    models: list[str]
    verdict: str
    shows: bool
    explained: str = ""


@dataclass(frozen=True)
class Scored:
    """What became of one fault.

    Attributes:
        score: The score.
        why: Why it is no hit; "" for a hit.
        groups: New groups at the wrong release, those that show the fault first.
        others: Groups that are new at the right release.
    """

    score: Score
    why: str
    groups: tuple[Shown, ...] = ()
    others: tuple[Shown, ...] = ()

    @property
    def alarms(self) -> tuple[Shown, ...]:
        """False alarms."""
        return tuple(one for one in self.others if not one.explained)

    def row(self) -> dict[str, object]:
        """The score as an object of JSON."""
        return asdict(self) | {"alarms": len(self.alarms)}


def scored(
    fault: Fault,
    wrong: Sequence[Cell],
    right: Sequence[Cell] | None,
    natives: Mapping[str, str],
    explained: Callable[[Group], str],
    together: Callable[[Sequence[Cell]], list[Group]] = grouped,
    trees: Mapping[str, Stated] = MappingProxyType({}),
) -> Scored:
    """The score of one fault.

    Args:
        fault: The fault.
        wrong: All cells at the wrong release.
        right: All cells at the right one; None where there is none yet.
        natives: Name of a function -> what the engine calls it.
        explained: Why a group that is new at the right release is no false alarm; "" for no reason.
        together: Puts red cells together.
        trees: Name of a tree -> what the engine calls what it states.
    """
    shown = partial(_shown, fault, natives=natives, trees=trees)
    groups = [shown(group) for group in together(new(wrong, right or ()))]
    answered = {(cell.model, cell.function) for cell in wrong if cell.verdict in _ANSWERED}
    alarming = [cell for cell in new(right or (), wrong) if (cell.model, cell.function) in answered]
    at_right = together(alarming)
    return judged(groups, [shown(group, explained=explained(group)) for group in at_right])


def judged(groups: Sequence[Shown], others: Sequence[Shown]) -> Scored:
    """The score that groups make: new ones at the wrong release, and others at the right one."""
    groups = sorted(groups, key=lambda one: not one.shows)
    showing = [one for one in groups if one.shows]
    score: Score = "half a hit"
    if not showing:
        score, why = "miss", f"{len(groups)} new groups, none of which shows it" if groups else "nothing new is red"
    elif all(one.verdict == "imprecise" for one in showing):
        why = "imprecise only"
    elif len(groups) >= LOST:
        why = f"lost among {len(groups)} new groups"
    else:
        score, why = "hit", ""
    return Scored(score, why, tuple(groups), tuple(others))


def new(cells: Sequence[Cell], than: Sequence[Cell]) -> list[Cell]:
    """Red cells that are not there, or less red, in others."""
    known = {(cell.model, cell.function): _badness(cell) for cell in than}
    return [cell for cell in cells if _badness(cell) > known.get((cell.model, cell.function), 0)]


def _badness(cell: Cell) -> int:
    return _BADNESS.get(cell.verdict, _WORST) if cell.verdict in RED else 0


def _shown(
    fault: Fault, group: Group, natives: Mapping[str, str], trees: Mapping[str, Stated], explained: str = ""
) -> Shown:
    worst = max(group.cells, key=_badness).verdict
    own = list(dict.fromkeys(natives.get(name, name) for name in group.functions))
    return Shown(list(group.functions), own, list(group.models), worst, shows(fault, group, own, trees), explained)


def shows(fault: Fault, group: Group, natives: Sequence[str], trees: Mapping[str, Stated]) -> bool:
    """Whether a group shows a fault.

    Args:
        fault: The fault.
        group: The group.
        natives: What the engine calls its functions.
        trees: Name of a tree -> what the engine calls what it states.
    """
    stated = [trees.get(model, Stated()) for model in group.models]
    done = [one.done for one in stated] if all(one.done for one in stated) else []
    wanted, asked = set(fault.subject.functions), " ".join((*group.functions, *natives, *done))
    if wanted and not wanted & set(re.findall(r"[A-Za-z_]\w*", asked)):
        return False
    if not any(group.models):  # The checks of another suite have names alone, and no trees.
        return _has_words(fault, asked)
    shown = [_is_shown_in(fault, model, one.called) for model, one in zip(group.models, stated, strict=True)]
    return 2 * sum(shown) >= len(shown)


def _is_shown_in(fault: Fault, name: str, called: str) -> bool:
    """Whether a tree or file is one that a fault shows in, by its name or by what the engine calls what it states."""
    form = next((form for form in _FORMATS if re.match(rf"{form}\b", name)), "")
    if fault.kind in _READ:
        stated = {form for form, mark in _FORMATS.items() if mark in fault.script}
        if stated and form not in stated and (form or not fault.subject.shown_in):
            return False
    return (fault.kind != "writer" or "written" in name) and _has_words(fault, f"{name}; {called}")


def _has_words(fault: Fault, text: str) -> bool:
    words = fault.subject.shown_in
    return not words or any(re.search(rf"\b{re.escape(word)}", text, re.IGNORECASE) for word in words)


def has(fault: Fault, version: str) -> bool:
    """Whether a release may still have a fault: none is right yet, or it is older than the first right one."""
    return fault.right is None or _ordered(version) < _ordered(fault.right)


def _ordered(version: str) -> list[int]:
    """The numbers of a release, in order."""
    digits = ("".join(takewhile(str.isdigit, part)) for part in version.split("."))
    return [int(one) for one in digits if one]
