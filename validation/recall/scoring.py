"""From what is red at a fault's wrong release and at its right one to a score.

A red cell is *new* where it is red at the wrong release and at the right one is not asked, or less red; where there is
no right release yet, every red cell of the wrong one is. New cells are put together into groups. A group *names* the
fault if the engine's own name of one of its functions is in the fault's sentence or script; it is of its *family* if a
word of the fault's class (`FAMILIES`) is in the name of a function or a tree, or, for what readers make of files, if
the engine read a file of the script's format. No entry states by hand what it is to be seen in, so that a frozen one is
judged as any other.

hit: some new group names the fault or is of its family; without a right release, names it. half a hit: all such groups
are imprecise only, or they are lost among `LOST` new groups or more. miss: neither. A false alarm is a group of cells
that are red at the right release and not, or less, at the wrong one, where no other fault of the set that the right
release still has, and no cause that is stated of the engine, explains it.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import takewhile
from typing import Literal

from ..engines.matrix import Judged
from ..engines.verdicts import RED
from ..faults.entry import Fault

LOST = 20
# From the mildest to the worst; what is no number is as bad as a wrong one.
_BADNESS = {"imprecise": 1}
_WORST = 2
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
    "sensor": ("sensor", "accelerometer", "gyro"),
    "reader": (),
    "writer": ("writ", "round trip"),
    "constraint": ("constrain", "impact", "impulse", "weld", "loop"),
    "actuator": ("actuator", "motor", "muscle", "transmission", "moment arm", "moment_arm", "tendon"),
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
Score = Literal["hit", "half a hit", "miss", "not asked"]
Group = Sequence[Judged]


@dataclass(frozen=True)
class Shown:
    """A group of red cells, for a report.

    Attributes:
        functions: Names of functions.
        natives: What the engine calls them.
        models: Trees and files.
        verdict: The worst verdict.
        names: "function", "family" or "": what of the fault it names.
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
    wrong: Sequence[Judged],
    right: Sequence[Judged] | None,
    natives: Mapping[str, str],
    grouped: Callable[[Sequence[Judged]], Sequence[Group]],
    explained: Callable[[Group], str],
) -> Scored:
    """The score of one fault.

    Args:
        fault: The fault.
        wrong: All cells at the wrong release.
        right: All cells at the right one; None where there is none yet.
        natives: Name of a function -> what the engine calls it.
        grouped: Puts red cells together.
        explained: Why a group that is new at the right release is no false alarm; "" for no reason.
    """
    groups = [_shown(fault, group, natives) for group in grouped(new(wrong, right or ()))]
    groups.sort(key=lambda one: ("function", "family", "").index(one.names))
    others = tuple(
        _shown(fault, group, natives, explained(group)) for group in grouped(new(right, wrong)) if right is not None
    )
    wanted = ("function", "family") if right is not None or fault.kind in _READ else ("function",)
    naming = [one for one in groups if one.names in wanted]
    if not naming:
        said = f"{len(groups)} new groups, none of which names it" if groups else "nothing new is red"
        return Scored("miss", said, tuple(groups), others)
    if all(one.verdict == "imprecise" for one in naming):
        return Scored("half a hit", "imprecise only", tuple(groups), others)
    if len(groups) >= LOST:
        return Scored("half a hit", f"lost among {len(groups)} new groups", tuple(groups), others)
    return Scored("hit", "", tuple(groups), others)


def new(cells: Sequence[Judged] | None, than: Sequence[Judged]) -> list[Judged]:
    """Red cells that are not there, or less red, in others."""
    known = {_place(one): _badness(one) for one in than}
    return [one for one in cells or () if _badness(one) > known.get(_place(one), 0)]


def _place(one: Judged) -> tuple[str, str]:
    return one.cell.model, one.cell.function


def _badness(one: Judged) -> int:
    return _BADNESS.get(one.cell.verdict, _WORST) if one.cell.verdict in RED else 0


def _shown(fault: Fault, group: Group, natives: Mapping[str, str], explained: str = "") -> Shown:
    functions = list(dict.fromkeys(one.cell.function for one in group))
    worst = max(group, key=_badness).cell.verdict
    models = list(dict.fromkeys(one.cell.model for one in group))
    own = list(dict.fromkeys(natives.get(name, name) for name in functions))
    return Shown(functions, own, models, worst, named(fault, group, natives), explained)


def named(fault: Fault, group: Group, natives: Mapping[str, str]) -> str:
    """What of a fault a group names: "function", "family" or ""."""
    known = _identifiers(fault)
    of_format = {form for form, mark in _FORMATS.items() if mark in fault.script}
    is_family = False
    for one in group:
        native = _words(natives.get(one.cell.function, one.cell.function))
        if any(word == other or other.startswith(f"{word}_") for word in native for other in known):
            return "function"
        text = f"{one.cell.function} {one.cell.model}".lower()
        is_read = fault.kind in _READ and one.form != "" and (not of_format or one.form in of_format)
        is_family = is_family or is_read or any(word in text for word in FAMILIES[fault.kind])
    return "family" if is_family else ""


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
