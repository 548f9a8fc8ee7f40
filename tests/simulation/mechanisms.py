"""Small mechanisms that tests of simulation are made of: a slide, chains of links, loops, a hinge that is carried."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import symofros as sf

Vector = tuple[float, float, float]


def slide(*elements: Any, mass: Any = 1.0, name: str = "x", axis: Vector = (1, 0, 0), **more: Any) -> sf.System:
    """A body on a slide, without weight.

    Args:
        elements: Of its joint: springs, dampers, friction, stops.
        mass: Of the body [kg].
        name: Of the joint.
        axis: Of the joint.
        more: Options of the joint (actuated, limits), the body (loads) or the system (parameters, potentials, gravity).
    """
    of_joint = {key: more.pop(key) for key in ("actuated", "limits", "prescribed", "effort") if key in more}
    joint = sf.Joint(name, "prismatic", axis=axis, elements=elements, **of_joint)
    body = sf.RigidBody("body", joint, sf.Inertia(mass), loads=more.pop("loads", ()))
    return sf.System("slide", (body,), **({"gravity": (0, 0, 0)} | more))


def links(
    lengths: Sequence[Any], name: str = "b", joint: str = "q", axis: Vector = (0, 0, 1), **more: Any
) -> list[Any]:
    """Links along x, each on the end of the one before.

    Args:
        lengths: Of the links [m]; numbers or formulas.
        name: Of the links, with their numbers behind it.
        joint: Of the hinges.
        axis: Of the hinges.
        more: `inertia`, a function of a length (1 kg in the hinge); `position` of the first hinge; `limits` by number.
    """
    inertia: Callable[[Any], sf.Inertia] = more.get("inertia", lambda _: sf.Inertia(1.0))
    bodies = []
    for i, length in enumerate(lengths):
        carrier = {"parent": f"{name}{i - 1}", "frame": "end"} if i else {"position": more.get("position", (0, 0, 0))}
        hinge = sf.Joint(f"{joint}{i}", "revolute", axis=axis, limits=more.get("limits", {}).get(i), **carrier)
        bodies.append(sf.RigidBody(f"{name}{i}", hinge, inertia(length), (sf.Frame("end", (length, 0, 0)),)))
    return bodies


def loop(lengths: Sequence[Any], ground: Any, axis: Vector = (0, -1, 0), **more: Any) -> sf.System:
    """Links in one line, the last on a pivot of its own at the other end of the ground, closed at the ends.

    Args:
        lengths: Of the links [m].
        ground: From the first pivot to the last [m].
        axis: Of the hinges q1, q2, ...
        more: `inertia`, a function of a length (a rod of 1 kg); `rows` of the closure ((x, z), no rotations);
            `first`, options of the first joint; others of the system.
    """
    inertia = more.pop("inertia", lambda length: sf.Inertia(1.0, (length / 2, 0, 0), (0.01, 0.1, 0.1)))
    rows, first = more.pop("rows", (("x", "z"), ())), more.pop("first", {})
    bodies = []
    for i, length in enumerate(lengths, 1):
        carrier: dict[str, Any] = {"parent": f"b{i - 1}", "frame": "end"} if i > 1 else first
        if i == len(lengths):
            carrier = {"position": (ground, 0, 0)}
        hinge = sf.Joint(f"q{i}", "revolute", axis=axis, **carrier)
        bodies.append(sf.RigidBody(f"b{i}", hinge, inertia(length), (sf.Frame("end", (length, 0, 0)),)))
    shut = sf.Closure("shut", (bodies[-1].name, "end"), (bodies[-2].name, "end"), *rows)
    others = more.pop("constraints", ())
    return sf.System("loop", (*bodies, *more.pop("bodies", ())), constraints=(shut, *others), **more)


def turned() -> sf.System:
    """A hinge q on a body with prescribed rotation, the ball joint p."""
    base = sf.RigidBody("base", sf.Joint("p", "ball", prescribed=True), sf.Inertia(1.0, moments=(1, 1, 1)))
    hinge = sf.Joint("q", "revolute", "base", axis=(0, 1, 0))
    return sf.System("turned", (base, sf.RigidBody("arm", hinge, sf.Inertia(1.0, (0.5, 0, 0)))))
