"""Checks of constraints: their frames, bodies and speeds exist, and can be bound."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import partial

from symofros.description.constraints import BETWEEN_FRAMES, Coupling, Nonholonomic
from symofros.description.forces import Anchor
from symofros.description.joints.joint import WORLD
from symofros.description.system import Body, System
from symofros.description.values import Value, symbols
from symofros.errors import Problem, did_you_mean
from symofros.expr.derivative import partials
from symofros.expr.edges import ZERO
from symofros.expr.expression import Expression, lower
from symofros.expr.graph import Graph
from symofros.mechanics.topology.conditions import Condition
from symofros.mechanics.topology.coordinates import coordinate_symbols, speed_symbols
from symofros.mechanics.topology.frames import frame_remedy, frames_of
from symofros.mechanics.topology.numbers import Numbers


def anchor_problems(
    what: str, anchor: Anchor, bodies: Mapping[str, Body], base: Body, broken: frozenset[str], where: str
) -> Iterator[Problem]:
    """A frame that is not there.

    Args:
        what: The thing that names it, for the message.
        anchor: (body, frame).
        bodies: Bodies by name.
        base: The base, which "world" stands for.
        broken: Names that could not be read; nothing is said of them.
        where: "file:line".
    """
    name, frame = anchor
    body = base if name in (WORLD, base.name) else bodies.get(name)
    if body is None:
        if name not in broken:
            yield Problem(
                f"{what}: no body '{name}'",
                f"'{name}'",
                "it joins frames of bodies, or of 'world'",
                did_you_mean(name, [WORLD, *bodies]),
                where,
            )
    elif frame is not None and frame not in {item.name for item in body.frames}:
        yield Problem(
            f"{what}: frame '{frame}' is not on body '{name}'",
            frames_of(body),
            "it joins frames that exist on their bodies",
            frame_remedy(bodies.values(), body, frame, "body: ") or "add the frame",
            where,
        )


def constraint_problems(
    system: System, bodies: Mapping[str, Body], base: Body, broken: frozenset[str]
) -> Iterator[Problem]:
    """Constraints on frames, bodies and speeds that are not there, or that can't be bound."""
    joints = [body.joint for body in system.bodies if body.joint is not None]
    speeds = {name for joint in joints if not joint.prescribed for name in speed_symbols(joint)}
    free = {name for joint in joints if not joint.prescribed for name in coordinate_symbols(joint)}
    known = {name for joint in joints for name in coordinate_symbols(joint)} | {item.name for item in system.parameters}
    for item in system.constraints:
        what, where = f"constraint '{item.name}'", system.origin.get(("constraint", item.name), "")
        if isinstance(item, Nonholonomic):
            for speed, _ in item.coefficients:
                if speed not in speeds | broken:
                    yield Problem(
                        f"{what}: '{speed}' is not a speed",
                        ", ".join(sorted(speeds)[:12]),
                        "a coefficient is given for a free speed: d and the coordinate's name",
                        did_you_mean(speed, speeds),
                        where,
                    )
            if not any(_slopes(value, None) for _, value in item.coefficients):
                text = ", ".join(f"{speed}: {value}" for speed, value in item.coefficients)
                yield Problem(f"{what}: binds no speed", text, "a coefficient is not zero", "mend the formulas", where)
            continue
        if isinstance(item, Coupling):  # Names in formulas are checked with all others.
            if symbols(item.residual) <= known and not _slopes(item.residual, free):
                rule = "a coupling changes with a coordinate that is free to move"
                yield Problem(f"{what}: binds no coordinate", f"'{item.residual}'", rule, "mend its formula", where)
            continue
        anchors = [item.first, item.second] if isinstance(item, BETWEEN_FRAMES) else [item.anchor]
        for anchor in anchors:
            yield from anchor_problems(what, anchor, bodies, base, broken, where)
        if isinstance(item, BETWEEN_FRAMES):
            yield from same_body_problems(what, (item.first, item.second), base, where)


def same_body_problems(what: str, anchors: tuple[Anchor, Anchor], base: Body, where: str) -> Iterator[Problem]:
    """Two frames of one body, between which nothing can move.

    Args:
        what: The thing that names them, for the message.
        anchors: (body, frame) of both.
        base: The base, which "world" stands for.
        where: "file:line".
    """
    (first, of_first), (second, of_second) = anchors
    if len({base.name if name == WORLD else name for name in (first, second)}) == 1:
        yield Problem(
            f"{what}: both frames are on body '{first}'",
            ", ".join("the body frame" if frame is None else f"'{frame}'" for frame in (of_first, of_second)),
            "it joins frames of two bodies, which can move against each other",
            "name a frame of another body",
            where,
        )


def _slopes(value: Value, names: Collection[str] | None) -> bool:
    """Whether a formula changes with one of some symbols, or, for None, is not zero, whatever values they have."""
    if not isinstance(value, Expression):
        return names is None and value != 0.0
    g, stated = Graph(), sorted(symbols(value))
    inputs = {name: g.input("x", i) for i, name in enumerate(stated)}
    try:
        edge = lower(value, g, inputs)
    except ArithmeticError:
        return True  # A constant part outside its domain, which is said with all others.
    if names is None:
        return edge != ZERO
    return any(partials(g, [edge], [inputs[name] for name in stated if name in names])[0])


# What to do about a size that is not positive, by its name.
_INSTEAD = {
    "length": "for two points that coincide, use a closure",
    "radius": "give the distance from the centre to the rim; for a point that does not slip sideways, use knife_edge",
}


def constraint_conditions(system: System) -> Iterator[Condition]:
    """Lengths and radii are positive."""
    for item in system.constraints:
        for label in _INSTEAD:
            value = getattr(item, label, None)
            if value is not None:
                where = system.origin.get(("constraint", item.name), "")
                yield Condition((value,), "positive", partial(_not_positive, item.name, label, value, where))


def _not_positive(name: str, label: str, value: Value, where: str, numbers: Numbers) -> Problem:
    return Problem(
        f"constraint '{name}': {label} {numbers.value(value):g}",
        f"'{value}'",
        f"the {label} is positive",
        _INSTEAD[label],
        where,
    )
