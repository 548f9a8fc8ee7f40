"""From what is red at a fault's wrong release and at its right one to a score.

A red cell is *new* where it is red at the wrong release and at the right one is not asked, or less red; where there is
no right release yet, every red cell of the wrong one is. New cells are put together into groups. A group *names* the
fault if the engine's own name of one of its functions is in the fault's sentence or script, or if the names of most of
its trees have a word of the fault's sentence that few faults have. It is of its *family* if a word of the fault's class
(`FAMILIES`) is in the name of a function or a tree, or, for what readers make of files, if the engine read a file of
the script's format; unless it names another fault that went between the same releases. No entry states by hand what it
is to be seen in, so that a frozen one is judged as any other.

hit: some new group names the fault or is of its family; without a right release, names it. half a hit: all such groups
are imprecise only, or they are lost among `LOST` new groups or more. miss: neither. A false alarm is a group of cells
that are red at the right release, where the wrong one's answer was right, or less wrong, and which neither another
fault of the set that the right release still has nor a cause that is stated of the engine explains.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from itertools import takewhile
from typing import Literal

from ..engines.causes.grouping import Group, causes_of
from ..engines.verdicts import RED, Cell
from ..faults.entry import Fault, faults

LOST = 20
# From the mildest to the worst; what is no number is as bad as a wrong one.
_BADNESS = {"imprecise": 1}
_WORST = 2
_ANSWERED = ("right", "imprecise")
# Class of a fault -> words that names of functions or trees have where they are about it.
FAMILIES: Mapping[str, tuple[str, ...]] = {
    "dynamics": (
        *("mass_matrix", "bias", "gravity", "coriolis", "dynamics", "energy", "regressor"),
        *("centroidal", "momentum", "delassus", "kkt", "armature"),
    ),
    "kinematics": (
        *("pose", "jacobian", "velocit", "acceleration", "mass_centre", "integrate", "difference", "interpolate"),
        *("frame", "rotation", "angle", "quaternion"),
    ),
    "step": ("step", "integrator"),
    "reaction": ("wrench", "reaction", "constraint_force", "impulse"),
    "sensor": ("sensor", "accelerometer", "gyro", "velocimeter"),
    "reader": (),
    "writer": ("writ", "round trip"),
    "constraint": ("constrain", "impact", "impulse", "weld", "loop"),
    "actuator": ("actuat", "motor", "muscle", "transmission", "moment arm", "moment_arm", "tendon"),
    "passive force": ("passive", "friction", "damp", "stiff", "spring", "compensat"),
    "flexible body": ("flex", "beam", "shell", "elastic"),
    "mass properties": ("mass", "inertia", "density", "volume"),
}
# Classes that are about what a reader makes of a file.
_READ = ("reader", "mass properties")
# Format -> what a script has where it states such a file.
_FORMATS = {"mjcf": "<mujoco", "urdf": "<robot", "sdf": "<sdf", "usd": "#usda"}
# What nearly every script calls: a name of nothing.
_SETUP = {"mj_forward", "mj_step", "value", "World"}
_SHORTEST = 4
# Letters of a word that can tell faults apart, and how many of them it may be of.
_LONG, _FEW = 5, 3
_NAMING = ("function", "words", "family", "")
Score = Literal["hit", "half a hit", "miss", "not asked"]


@dataclass(frozen=True)
class Names:
    """What cells of an engine are called elsewhere.

    Attributes:
        natives: Name of a function -> what the engine calls it.
        forms: Name of a file -> its format.
    """

    natives: Mapping[str, str] = field(default_factory=dict)
    forms: Mapping[str, str] = field(default_factory=dict)


def grouped(cells: Sequence[Cell]) -> list[Group]:
    """Red cells put together by what they have in common; no stated cause, which people found, has a part in it."""
    return causes_of(cells, known=())


@dataclass(frozen=True)
class Shown:
    """A group of red cells, for a report.

    Attributes:
        functions: Names of functions.
        natives: What the engine calls them.
        models: Trees and files.
        verdict: The worst verdict.
        names: What of the fault it names: "function", "words", "family" or "".
        explained: Why it is no false alarm; "" for no reason, or where that was not asked.
    """

    functions: list[str]
    natives: list[str]
    models: list[str]
    verdict: str
    names: str
    explained: str = ""


@dataclass(frozen=True)
class Scored:
    """What became of one fault.

    Attributes:
        score: The score.
        why: Why it is no hit; "" for a hit.
        groups: New groups at the wrong release, those that name the fault first.
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
        """As JSON has it."""
        return asdict(self) | {"alarms": len(self.alarms)}


def scored(
    fault: Fault,
    wrong: Sequence[Cell],
    right: Sequence[Cell] | None,
    names: Names,
    explained: Callable[[Group], str],
    together: Callable[[Sequence[Cell]], list[Group]] = grouped,
) -> Scored:
    """The score of one fault.

    Args:
        fault: The fault.
        wrong: All cells at the wrong release.
        right: All cells at the right one; None where there is none yet.
        names: What they are called elsewhere.
        explained: Why a group that is new at the right release is no false alarm; "" for no reason.
        together: Puts red cells together.
    """
    groups = [_shown(fault, group, names) for group in together(new(wrong, right or ()))]
    groups.sort(key=lambda one: _NAMING.index(one.names))
    answered = {(cell.model, cell.function) for cell in wrong if cell.verdict in _ANSWERED}
    alarming = [cell for cell in new(right or (), wrong) if (cell.model, cell.function) in answered]
    at_right = together(alarming)
    others = tuple(_shown(fault, group, names, explained(group)) for group in at_right)
    # Of what no release is right yet, more is red than this fault.
    wanted = _NAMING[:3] if right is not None or fault.kind in _READ else _NAMING[:2]
    naming = [one for one in groups if one.names in wanted]
    if not naming:
        said = f"{len(groups)} new groups, none of which names it" if groups else "nothing new is red"
        return Scored("miss", said, tuple(groups), others)
    if all(one.verdict == "imprecise" for one in naming):
        return Scored("half a hit", "imprecise only", tuple(groups), others)
    if len(groups) >= LOST:
        return Scored("half a hit", f"lost among {len(groups)} new groups", tuple(groups), others)
    return Scored("hit", "", tuple(groups), others)


def new(cells: Sequence[Cell], than: Sequence[Cell]) -> list[Cell]:
    """Red cells that are not there, or less red, in others."""
    known = {(cell.model, cell.function): _badness(cell) for cell in than}
    return [cell for cell in cells if _badness(cell) > known.get((cell.model, cell.function), 0)]


def _badness(cell: Cell) -> int:
    return _BADNESS.get(cell.verdict, _WORST) if cell.verdict in RED else 0


def _shown(fault: Fault, group: Group, names: Names, explained: str = "") -> Shown:
    worst = max(group.cells, key=_badness).verdict
    own = list(dict.fromkeys(names.natives.get(name, name) for name in group.functions))
    return Shown(list(group.functions), own, list(group.models), worst, named(fault, group, names), explained)


def named(fault: Fault, group: Group, names: Names) -> str:
    """What of a fault a group names: "function", "words", "family" or ""."""
    if said := _named_itself(fault, group, names):
        return said
    between = (one for one in faults().values() if one.engine == fault.engine and one is not fault)
    gone = [one for one in between if has(one, fault.wrong) and fault.right and not has(one, fault.right)]
    if any(_named_itself(one, group, names) for one in gone):
        return ""
    of_format = {form for form, mark in _FORMATS.items() if mark in fault.script}
    for cell in group.cells:
        form, text = names.forms.get(cell.model, ""), f"{cell.function} {cell.model}".lower()
        is_read = fault.kind in _READ and form != "" and (not of_format or form in of_format)
        if is_read or any(word in text for word in FAMILIES[fault.kind]):
            return "family"
    return ""


def _named_itself(fault: Fault, group: Group, names: Names) -> str:
    """Whether a group names this fault alone, by "function" or by "words"."""
    known, rare = _identifiers(fault), _plain_words(fault.fault) - _frequent()
    shared: Counter[str] = Counter()
    for cell in group.cells:
        native = names.natives.get(cell.function, cell.function)
        if known & {name for word in _words(native) for name in (word, f"{word}_fun")}:  # CasADi's functions.
            return "function"
        shared.update(rare & _plain_words(cell.model))
    return "words" if 2 * max(shared.values(), default=0) >= len(group.cells) else ""


def _plain_words(text: str) -> set[str]:
    """The longer words of a text, without the s of a plural; names of code are none."""
    return {word.lower().removesuffix("s") for word in re.findall(r"\b[A-Za-z][a-z]+\b", text) if len(word) >= _LONG}


@cache
def _frequent() -> set[str]:
    """Words that more than `_FEW` faults have in their sentences."""
    counted = Counter(word for fault in faults().values() for word in _plain_words(fault.fault))
    return {word for word, number in counted.items() if number > _FEW}


def _words(text: str) -> set[str]:
    """Identifiers in a text that can name something."""
    found = re.findall(r"[A-Za-z_]\w*", text)
    return {word for word in found if len(word) >= _SHORTEST} - _SETUP


def _identifiers(fault: Fault) -> set[str]:
    """What a fault's sentence and script name: words that look like code, and what the script uses."""
    used = set()
    for node in ast.walk(ast.parse(fault.script)):
        if isinstance(node, ast.Attribute):
            used.add(node.attr)
        elif isinstance(node, ast.Name):
            used.add(node.id)
    said = {word for word in _words(fault.fault) if "_" in word or not word.islower() and not word.istitle()}
    return {word for word in used | said if len(word) >= _SHORTEST} - _SETUP


def has(fault: Fault, version: str) -> bool:
    """Whether a release may still have a fault: none is right yet, or it is older than the first right one."""
    return fault.right is None or _ordered(version) < _ordered(fault.right)


def _ordered(version: str) -> list[int]:
    """The numbers of a release, in order."""
    digits = ("".join(takewhile(str.isdigit, part)) for part in version.split("."))
    return [int(one) for one in digits if one]
