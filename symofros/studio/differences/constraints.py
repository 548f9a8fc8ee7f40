"""Constraints of two mechanisms, when they hold, and events: which of one has no equal among the other's."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.description import Closure, Constraint, Coupling, Rod, event_text, symbols
from symofros.mechanics.topology import coordinate_symbols
from symofros.studio.differences.difference import Difference
from symofros.studio.differences.findings import Findings
from symofros.studio.differences.mechanism import Mechanism, moved

_POSTURES = 5


def constraint_differences(found: Findings) -> Iterator[Difference]:
    """Constraints without an equal."""
    ours, theirs = list(found.a.system.constraints), list(found.b.system.constraints)
    equal, as_named = _equality(found, is_mapped=True), _equality(found, is_mapped=False)
    for constraint in ours:
        other = next((item for item in theirs if equal(constraint, item)), None)
        if other is not None:
            theirs.remove(other)
            continue
        other = next((item for item in theirs if as_named(constraint, item)), None)
        if other is not None and _blame_coordinates(found, constraint):
            theirs.remove(other)
            continue
        named = next((item for item in theirs if type(item) is type(constraint) and item.name == constraint.name), None)
        if named is not None:
            theirs.remove(named)
        there = "no such constraint" if named is None else _stated(named)
        yield Difference(f"constraint '{constraint.name}'", "", "", _stated(constraint), there, ("constraints",))
    for item in theirs:
        yield Difference(f"constraint '{item.name}'", "", "", "no such constraint", _stated(item), ("constraints",))


def switching_differences(found: Findings) -> Iterator[Difference]:
    """Switches of constraints, and events, that one states and the other does not, or otherwise."""
    systems = found.a.system, found.b.system
    switches = [{one.constraint: f"{one.engaged}, pose {one.pose}" for one in system.switches} for system in systems]
    events = [{name: event_text(event) for name, event in system.events.items()} for system in systems]
    for kind, changes, (ours, theirs) in (("switch of", "constraints", switches), ("event", "events", events)):
        for name in ours | theirs:
            here, there = (of.get(name, f"no such {kind.removesuffix(' of')}") for of in (ours, theirs))
            if here != there:
                yield Difference(f"{kind} '{name}'", "", "", here, there, (changes,))


def _blame_coordinates(found: Findings, constraint: Constraint) -> bool:
    """Say of coordinates with another zero or sign that they change a coupling which doesn't follow them."""
    bound = symbols(constraint.residual) if isinstance(constraint, Coupling) else frozenset[str]()
    names = {name for name, symbol in _symbols(found.a).items() if symbol in bound}
    blamed = [k for k, item in enumerate(found.differences) if item.joint in names and "coordinates" in item.changes]
    for k in blamed:
        item = found.differences[k]
        found.differences[k] = replace(item, changes=tuple(dict.fromkeys((*item.changes, "constraints"))))
    return bool(blamed)


def _stated(constraint: Constraint) -> str:
    shown = (f"{item.name} {getattr(constraint, item.name)}" for item in fields(constraint) if item.name != "name")
    return f"{type(constraint).__name__.lower()}: {', '.join(shown)}"


def _equality(found: Findings, is_mapped: bool) -> Callable[[Constraint, Constraint], bool]:
    """Whether two constraints say the same, in the first file's places; in its coordinates, or in each file's own."""
    q, q2 = _coordinates(found, is_mapped)

    def residuals(mechanism: Mechanism, constraint: Coupling, values: list[dict[str, float]]) -> Array:
        return np.array([mechanism.numbers.extended(at).value(constraint.residual) for at in values])

    def equal(one: Constraint, other: Constraint) -> bool:
        if type(one) is not type(other):
            return False
        if isinstance(one, Coupling) and isinstance(other, Coupling):
            # The same condition, times whatever number.
            r, r2 = residuals(found.a, one, q), residuals(found.b, other, q2)
            size = float(np.linalg.norm(r) * np.linalg.norm(r2))
            return bool(size and abs(abs(float(r @ r2)) - size) <= found.close.tolerance * size)
        if isinstance(one, Closure | Rod) and isinstance(other, Closure | Rod):
            ends = zip((one.first, one.second), (other.first, other.second), strict=True)
            named = replace(other, name=one.name, first=one.first, second=one.second)
            return named == one and all(_same_place(found, anchor, anchor2) for anchor, anchor2 in ends)
        return replace(other, name=one.name) == one

    return equal


def _coordinates(found: Findings, is_mapped: bool) -> tuple[list[dict[str, float]], list[dict[str, float]]]:
    """Values of the joints' coordinates in both files, at random postures."""
    rng = np.random.default_rng(0)
    rows: tuple[list[dict[str, float]], list[dict[str, float]]] = ([], [])
    symbols = [_symbols(mechanism) for mechanism in (found.a, found.b)]
    for _ in range(_POSTURES):
        q, q2 = dict[str, float](), dict[str, float]()
        for x, (y, way) in found.pairs.items():
            m, n = found.a.parts[x].move, found.b.parts[y].move
            if m is not None and n is not None:
                value = float(rng.uniform(-1.0, 1.0))
                q[symbols[0].get(m.name, m.name)] = value
                q2[symbols[1].get(n.name, n.name)] = way.sign * (value - way.offset) if is_mapped else value
        rows[0].append(q)
        rows[1].append(q2)
    return rows


def _symbols(mechanism: Mechanism) -> dict[str, str]:
    """Name of a coordinate -> its symbol in formulas."""
    joints = [body.joint for body in mechanism.system.bodies if body.joint is not None]
    return {joint.name: coordinate_symbols(joint)[0] for joint in joints if joint.traits.nv == 1}


def _same_place(found: Findings, anchor: tuple[str, str | None], other: tuple[str, str | None]) -> bool:
    """Whether two anchors are the same point of counterparts."""
    bodies = [
        m.bodies[m.index[name]] if name in m.index else None
        for m, (name, _) in zip((found.a, found.b), (anchor, other), strict=True)
    ]
    one, two = bodies
    if one is None or two is None:
        return one is two
    if one.part not in found.pairs or found.pairs[one.part][0] != two.part:
        return False
    poses = [
        body.pose if label is None else body.frames.get(label, body.pose)
        for body, (_, label) in ((one, anchor), (two, other))
    ]
    return found.close.points(poses[0].p, moved(found.pairs[one.part][1].T, poses[1].p))
