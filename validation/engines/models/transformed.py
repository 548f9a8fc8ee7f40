"""Trees that an engine transforms once it has built them: joints locked, models attached, links fused, changes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..interface import ORIGIN, Activation, Actuator, End, Joint, Link, Rows, Tendon, Tree, Wrap
from .files.readers import diagonal, in_series
from .hostile import trees as hostile_trees
from .kinds import OBLIQUE, link, placed, turned


def _hinge(draw: np.random.Generator, **changes: float) -> Joint:
    return replace(placed(draw, Joint("revolute", axis=OBLIQUE)), **changes)  # type: ignore[arg-type]


def _massless(tree: Tree) -> Tree:
    """The tree with no mass in its first link."""
    first = replace(tree.links[0], mass=0.0, com=ORIGIN, inertia=(ORIGIN, ORIGIN, ORIGIN))
    return replace(tree, links=(first, *tree.links[1:]))


def _locked(name: str, *joints: Joint, base: bool = False) -> Tree:
    draw = np.random.default_rng([ord(letter) for letter in name])
    links: list[Link] = [link(draw, "base", -1, Joint("free"))] if base else []
    for k, joint in enumerate(joints):
        links.append(link(draw, "abcdef"[k], len(links) - 1, placed(draw, joint)))
    return Tree(name, tuple(links))


def _fused_at_one_point(name: str, *turn: Rows) -> Tree:
    """Fixed links whose origins and mass centres are one point, with principal inertias that one turn lies between."""
    draw = np.random.default_rng(13)
    principal = diagonal(0.125, 0.1875, 0.25)
    first = Link("a", -1, (_hinge(draw),), 1.5, inertia=principal)
    held = Joint("fixed", R=turn[0] if turn else turned(draw))
    return Tree(name, (first, Link("b", 0, (held,), 0.75, inertia=principal)), fused=True)


def _fixed_parts() -> tuple[Link, ...]:
    """Links of which those of an attached model don't move in it, but for the last."""
    draw = np.random.default_rng(14)
    held = [_hinge(draw), _hinge(draw), *(placed(draw, Joint("fixed")) for _ in range(2)), _hinge(draw)]
    return tuple(link(draw, "abcde"[k], k - 1, joint) for k, joint in enumerate(held))


def _parallel_parts() -> tuple[Link, ...]:
    """Links of which an attached model's base carries joints in parallel, and what does not move on it."""
    draw = np.random.default_rng(15)
    slide = Joint("prismatic", axis=OBLIQUE)
    stated = (
        *((-1, _hinge(draw)), (0, _hinge(draw)), (1, placed(draw, Joint("fixed")))),
        *((2, _hinge(draw)), (3, _hinge(draw)), (2, placed(draw, Joint("fixed"))), (2, placed(draw, slide))),
    )
    return tuple(link(draw, "abcdefg"[k], parent, joint) for k, (parent, joint) in enumerate(stated))


def _acting(links: tuple[Link, ...]) -> list[Tree]:
    """Attached chains that forces of their own act on: what hangs on parts must follow them, those of the other first.

    Tendons pass a sphere the shortest way, and on the side of a point; one stands on the model that is attached to.
    """
    damped = tuple(
        replace(one, joints=(replace(one.joints[0], damping=0.75, stiffness=3.0, rest=0.25),)) for one in links
    )
    straight = Tendon("path", (End("a", p=(0.5, 0.0, 0.25)), End("b", p=(0.0, 0.25, -0.5))), (), 3.0, 0.5, 0.25)
    ends = End("c", p=(-1.0, 0.125, 0.25)), End("d", p=(0.5, 0.0625, 1.5))
    ball = Wrap(0, End("c", p=(0.0625, 0.0, 0.25)), 0.375, True)
    around = replace(straight, ends=ends, stiffness=4.0, wraps=(ball,))
    aside = replace(around, wraps=(ball._replace(side=(0.0, 0.5, 0.25)),))
    total = Tendon("coupling", (End("c"), End("d")), (1.0, -0.5), 4.0, 0.5, 0.25)
    state = Activation("filter", 0.375, (0.125,))
    driven = (
        Actuator("b", gear=3.0, control=0.75, activation=Activation("integrator", 0.25)),
        Actuator("a", gear=0.5, gain=6.0, bias=(0.0, -6.0, 0.0), control=-0.5),
        Actuator("d", gear=2.0, gain=1.5, bias=(0.25, 0.0, -1.5), control=0.5, activation=state),
        Actuator("c", gear=-1.5, control=2.0, control_limits=(-1.0, 1.0)),
        Actuator(tendon=1, gear=0.5, gain=3.0, bias=(0.25, -3.0, -0.5)),
    )
    return [
        Tree("attached springs and dampers", damped, attached="c"),
        Tree("attached tendon around a sphere", links, attached="c", tendons=(straight, around)),
        Tree("attached tendon on the side of a sphere", links, attached="c", tendons=(straight, aside)),
        Tree("attached tendon of a sum", links, attached="c", tendons=(straight, total)),
        Tree("attached actuators", links, attached="c", tendons=(straight, total), actuators=driven),
    ]


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    free, held = Joint("revolute", axis=OBLIQUE), Joint("revolute", axis=OBLIQUE, locked=0.75)
    slide = Joint("prismatic", axis=OBLIQUE, locked=-0.5)
    draw = np.random.default_rng(8)
    parts = tuple(link(draw, "abcde"[k], parent, _hinge(draw)) for k, parent in enumerate((-1, 0, 1, 2, 2)))
    made = (
        _locked("locked hinge amid", free, held, free),
        _locked("locked slide at the end", free, free, slide),
        # Not all engines count the mass of what stands still.
        _massless(_locked("locked hinge first", held, free, free)),
        _locked("locked hinge and slide in series", free, held, slide, free),
        _locked("locked hinge on a free base", held, free, base=True),
        Tree("attached chain", parts[:4], attached="c"),
        Tree("attached branches", parts, attached="c"),
        Tree("attached fixed links", _fixed_parts(), attached="c"),
        Tree("attached base of parallel joints", _parallel_parts(), attached="c"),
        *_acting(parts[:4]),
        replace(hostile_trees()["fixed links amid"], name="fixed links fused", fused=True),
        _fused_at_one_point("fixed links fused at one point"),
        _fused_at_one_point("fixed links fused at a quarter turn", in_series(("z", math.pi / 2.0))),
    )
    changed = tuple(
        Tree(f"{what} changed", parts[:2], changed=what) for what in ("mass", "inertia", "frame", "gravity")
    )
    return {tree.name: tree for tree in (*made, *changed)}
