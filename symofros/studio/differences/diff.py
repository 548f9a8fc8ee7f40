"""The front door `diff`: whether two descriptions are the same mechanism, and in which entry they first differ."""

from __future__ import annotations

import json
import os
import textwrap
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from symofros.base.arguments import checked
from symofros.description import System
from symofros.errors import ArgumentError, DescriptionError
from symofros.exports.limits import listed
from symofros.loading import applicable, load
from symofros.mechanics.topology import find_problems
from symofros.studio.differences.constraints import constraint_differences, switching_differences
from symofros.studio.differences.difference import Difference
from symofros.studio.differences.findings import MOST_DIFFERENCES, POSTURES, Findings
from symofros.studio.differences.mechanism import Mechanism

# Numbers that readers and writers round: rotations by angles, inertias along other axes, products of placements.
TOLERANCE = 1e-9
# Columns of the text.
_WIDTH, _LISTED = 80, 20
# How files are read for a comparison, where their formats have a use for it: everything that they state.
READ_FULLY: dict[str, Any] = {"dissipation": "all", "waive": ("massless_tip",), "mimic": True}
UNREAD_MIMICRY = "joints that mimic others can't be read as such, and are compared as independent ones"
# Of M and g of one mechanism that is computed in two ways.
_EXACT = 1e-13
# What a difference that no entry was found for is called.
_UNKNOWN = "an entry that is not found"


@dataclass(frozen=True)
class MechanismDiff:
    """Whether two descriptions are the same mechanism.

    Attributes:
        first: Name of the first.
        second: Name of the second.
        differences: What differs, parents first; those that change kinematics, M or g before the rest. Of several that
            change kinematics, their effect on M and g is stated for all together.
        errors: "kinematics", "M", "g" -> largest relative difference over random postures; empty where joints of one
            have no counterpart in the other.
        coordinates: Coordinates that differ: name in the first, name in the second, sign, offset; q = sign q' + offset.
        matched: Joints that are the same by structure under different names.
        notes: What else is to be known: frames placed otherwise, what was not compared.
    """

    first: str
    second: str
    differences: tuple[Difference, ...]
    errors: dict[str, float]
    coordinates: tuple[tuple[str, str, float, float], ...] = ()
    matched: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        """Whether they are the same mechanism: kinematics, M, g and constraints, after a map of coordinates."""
        return not any(item.is_mechanical for item in self.differences)

    @property
    def identical(self) -> bool:
        """Whether nothing differs that can be observed: limits, dissipation and coordinates, too."""
        return not any(item.changes for item in self.differences)

    @property
    def first_difference(self) -> Difference | None:
        """The first one, if any: of those that change the mechanism if there are such."""
        return self.differences[0] if self.differences else None

    def to_json(self) -> dict[str, Any]:
        """The same as plain data."""
        return {
            "first": self.first,
            "second": self.second,
            "same": self.same,
            "identical": self.identical,
            "differences": [json.loads(json.dumps(asdict(item))) for item in self.differences],
            "errors": self.errors,
            "coordinates": [
                dict(zip(("first", "second", "sign", "offset"), row, strict=True)) for row in self.coordinates
            ],
            "matched": [list(pair) for pair in self.matched],
            "notes": list(self.notes),
        }

    def __str__(self) -> str:
        """The same for people, at most 80 columns wide."""
        lines = [*_wrapped(f"{self.first} | {self.second}: {self._verdict()}")]
        shown = [item for item in self.differences if item.is_mechanical or not item.changes]
        for k, item in enumerate(shown[:_LISTED]):
            lines += [*_wrapped(f"{k + 1}. {item.subject}{self._renamed(item)}: {item.entry}", "  ")]
            for label, value, place in zip(("first", "second"), (item.here, item.there), item.places, strict=True):
                at = f"  ({Path(place).name})" if place else ""
                lines += [*_wrapped(f"{label:9}{_text(value)}{at}", "     ")]
            lines += [*_wrapped(f"changes  {', '.join(item.changes) or 'nothing that can be observed'}", "     ")]
            if item.likelier is not None:
                label = ("first", "second")[item.likelier]
                lines += [*_wrapped(f"likelier right: the {label} file; {item.reason}", "     ")]
        if len(shown) > _LISTED:
            lines.append(f"  ... {len(shown) - _LISTED} more (--json lists them)")
        rest: dict[str, list[Difference]] = {}
        for item in self.differences:
            if item not in shown:
                rest.setdefault(item.entry, []).append(item)
        for entry, items in rest.items():
            many = f" and {len(items) - 1} more" if len(items) > 1 else ""
            here, there = (_text(value) for value in (items[0].here, items[0].there))
            difference = f"{entry} of {items[0].subject}{many}: {here} in the first, {there} in the second"
            lines += [*_wrapped(f"- {difference} (changes {', '.join(items[0].changes)})", "  ")]
        if self.errors:
            largest = ", ".join(f"{name} {error:.1g}" for name, error in self.errors.items())
            lines += [*_wrapped(f"over {POSTURES} random postures they differ by: {largest} (relative)", "  ")]
        if self.matched:
            pairs = ", ".join(f"{a} = {b}" for a, b in self.matched[:_LISTED])
            more = f", ... ({len(self.matched)} in all)" if len(self.matched) > _LISTED else ""
            lines += [*_wrapped(f"joints matched by structure: {pairs}{more}", "  ")]
        return "\n".join([*lines, *(line for note in self.notes for line in _wrapped(f"note: {note}", "  "))])

    def _verdict(self) -> str:
        first = self.first_difference
        if first is None:
            return "the same mechanism"
        if not self.same:
            return f"different, first in {first.entry} of {first.subject}"
        if self.identical:
            return "the same mechanism; what differs changes nothing that can be observed"
        named = dict.fromkeys(what for item in self.differences for what in item.changes)
        return f"the same mechanism, with other {', '.join(named)}"

    @staticmethod
    def _renamed(item: Difference) -> str:
        name = item.names[1] if item.joint else item.names[0]
        return f" (second file: '{name}')" if name and name != (item.joint or item.link) else ""


@checked
def diff(
    first: str | os.PathLike[str] | System, second: str | os.PathLike[str] | System, *, tolerance: float = TOLERANCE
) -> MechanismDiff:
    """Compare two descriptions as mechanisms.

    Links and joints are matched by structure where names differ. What only states the same mechanism otherwise is no
    difference: other names, another order, frames of links placed otherwise, links fused or held by fixed joints.
    Another zero or sign of a coordinate is a difference of coordinates, and named as such.

    Args:
        first: Path of a file, which is read with all that it states (dry friction, mimicking joints), or a system.
        second: Likewise.
        tolerance: Relative difference of numbers that is rounding.

    Raises:
        DescriptionError: A file can't be read, or is more than a tree of rigid bodies on joints of the library.
        ArgumentError: The tolerance is no small positive number.
    """
    systems = [_sound(item) if isinstance(item, System) else read_fully(Path(item)) for item in (first, second)]
    names = [item.name if isinstance(item, System) else os.fspath(item) for item in (first, second)]
    return compare(*systems, names=(names[0], names[1]), tolerance=tolerance)


def _sound(system: System) -> System:
    """A system that was not read from a file, once it is checked like one.

    Raises:
        DescriptionError: With its problems.
    """
    waive = (*READ_FULLY["waive"], "nonphysical_inertia")
    bodies = tuple(replace(body, waive=(*body.waive, *waive)) for body in system.bodies)
    if problems := find_problems(replace(system, bodies=bodies)):
        raise DescriptionError(problems)
    return system


def read_fully(path: Path, **stated: Any) -> System:
    """Read a file with all that it states; joints that mimic in a way that can't be read are independent, with a note.

    Args:
        path: The file.
        stated: Arguments of `load`; those that the file's format has no use for are left out.

    Raises:
        DescriptionError: As for `load`.
    """
    waive = {*READ_FULLY["waive"], *stated.get("waive", ())}
    arguments = applicable(path, READ_FULLY | stated | {"waive": waive})
    try:
        return load(path, **arguments)
    except DescriptionError:
        if not arguments.get("mimic"):
            raise
        system = load(path, **arguments | {"mimic": False})
        return replace(system, notes=(*system.notes, UNREAD_MIMICRY))


def compare(
    first: System, second: System, *, names: tuple[str, str] = ("first", "second"), tolerance: float = TOLERANCE
) -> MechanismDiff:
    """`diff` of systems, by the names that are to be shown.

    Raises:
        DescriptionError: As for `diff`.
        ArgumentError: As for `diff`.
    """
    if not 0.0 < tolerance < 0.1:
        rule, remedy = "0 < tolerance < 0.1, so that it absorbs rounding only", "for example tolerance=1e-6"
        raise ArgumentError("diff: unusable tolerance", f"{tolerance:g}", rule, remedy)
    a, b = (Mechanism(system, name) for system, name in zip((first, second), names, strict=True))
    found = Findings(a, b, tolerance, seed=0)
    differences = [*found.differences, *constraint_differences(found), *switching_differences(found)]
    if not any(item.is_mechanical for item in differences):  # Silence would say that they are the same.
        wrong = tuple(name for name, error in found.errors.items() if error > 1e3 * tolerance)
        wrong = wrong if found.complete else ("kinematics", "M", "g")
        if wrong:
            differences.append(Difference(_UNKNOWN, "", "", None, None, wrong))
    shown = tuple(name for name in ("M", "g") if found.errors.get(name, 0.0) > 1e3 * _EXACT)
    for k, item in enumerate(differences):
        if item.changes == ("kinematics",) and not item.entry.startswith("frame"):
            differences[k] = replace(item, changes=(*item.changes, *shown))
    differences.sort(key=lambda item: (not item.is_mechanical, not item.changes))
    moves = [(a.parts[x].move, b.parts[y].move, way) for x, (y, way) in found.pairs.items() if x]
    coordinates = [
        (m.name, n.name, way.sign, way.offset) for m, n, way in moves if m and n and (way.sign < 0.0 or way.offset)
    ]
    matched = [(m.name, n.name) for m, n, _ in moves if m and n and m.name != n.name]
    return MechanismDiff(
        *names, tuple(differences), found.errors, tuple(coordinates), tuple(matched), tuple(_notes(found))
    )


def _notes(found: Findings) -> list[str]:
    mechanisms = (found.a, found.b)
    notes = [f"{m.label}: not compared: {note}" for m in mechanisms for note in m.lost]
    # What readers leave out of couplings is missed in the comparison.
    notes += [f"{m.label}: {note}" for m in mechanisms for note in m.system.notes if "mimic" in note.lower()]
    moves = [(found.a.parts[x].move, found.b.parts[y].move) for x, (y, _) in found.pairs.items()]
    otherwise = [m.name for m, n in moves if m is not None and n is not None and m.driven != n.driven]
    inputs = [len(m.system.inputs) for m in mechanisms]
    if any(inputs):
        notes.append(f"actuators are not compared: {inputs[0]} in the first, {inputs[1]} in the second")
    elif otherwise:
        notes.append(f"which joints are driven is not compared; those driven in one alone: {listed(otherwise)}")
    if found.reframed:
        links = f"{len(found.reframed)} links"
        notes.append(f"frames of {links} are placed otherwise, which changes no motion: {listed(found.reframed)}")
    if found.is_cut:
        notes.append(f"the comparison ended after {MOST_DIFFERENCES} differences")
    return notes


def _wrapped(text: str, indent: str = "") -> list[str]:
    inner = indent + "   "
    return textwrap.wrap(text, _WIDTH, initial_indent=indent, subsequent_indent=inner, break_on_hyphens=False)


def _text(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(entry)}" for key, entry in value.items())
    if isinstance(value, list):
        return " ".join(map(_text, value))
    return f"{value + 0.0:.9g}" if isinstance(value, float) else str(value)
