"""What a page draws of a model: lines between frames, and curves of beams."""

from __future__ import annotations

from symofros.description import Beam, Value
from symofros.exports.material import Material
from symofros.expr import Expression
from symofros.mechanics.topology import build_tree, frame_of


def segments(material: Material) -> list[dict[str, str | bool]]:
    """Lines from each body to its frames, and to the bodies that it carries; between frames of the module only.

    Returns:
        Lines, with the frames `from` and `to`; whether one is `curved`, a beam that leaves its root along x; and
        whether `to` is the beam's tip, whose x is the `tangent` there.
    """
    tree = build_tree(material.system)
    drawn: list[dict[str, str | bool]] = []

    def add(start: str, end: str, curved: bool = False, tangent: bool = False) -> None:
        if start != end and {start, end} <= set(material.frames):
            drawn.append({"from": start, "to": end, "curved": curved, "tangent": tangent})

    bodies = {body.name: body for body in tree.system.bodies}
    for body in tree.system.bodies:
        own = frame_of(tree, body.name).name
        for frame in body.frames:
            tip = frame_of(tree, body.name, frame.name).name
            add(own, tip, isinstance(body, Beam), True)
        if body.joint is not None:
            parent = bodies.get(body.joint.parent)
            on_bare_beam = isinstance(parent, Beam) and not parent.frames
            start = frame_of(tree, body.joint.parent, None if on_bare_beam else body.joint.frame).name
            add(start, own, on_bare_beam)
    return drawn


def up(material: Material) -> list[float]:
    """The direction against gravity where that is a number, otherwise z."""
    gravity = [_number(value) for value in material.system.gravity]
    size = sum(x * x for x in gravity) ** 0.5
    return [-x / size for x in gravity] if size > 0 else [0.0, 0.0, 1.0]


def _number(value: Value) -> float:
    return 0.0 if isinstance(value, Expression) else value
