"""Trees that break assumptions: of order, of scale, of what is aligned, of what moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from ..interface import ORIGIN, Joint, Link, Rows, Tree, Vector, rows, vector
from .kinds import OBLIQUE, link, placed, shifted, tree_of

_NOTHING: Rows = (ORIGIN, ORIGIN, ORIGIN)


def _hinge(draw: np.random.Generator) -> Joint:
    return placed(draw, Joint("revolute", axis=OBLIQUE))


def _chain(name: str, count: int = 3) -> tuple[Link, ...]:
    """Links on oblique hinges, one after the other."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    return tuple(link(draw, "abcdefgh"[k], k - 1, _hinge(draw)) for k in range(count))


def _scaled(one: Link, factor: float) -> Link:
    inertia = np.array(one.inertia) * factor
    return replace(one, mass=one.mass * factor, inertia=rows(inertia))


def _resized(one: Link, factor: float) -> Link:
    """A link of another size, of the same density."""
    joints = tuple(replace(joint, p=vector(factor * np.array(joint.p))) for joint in one.joints)
    small = replace(one, joints=joints, com=vector(factor * np.array(one.com)))
    inertia = np.array(one.inertia) * factor**5
    return replace(small, mass=one.mass * factor**3, inertia=rows(inertia))


def _permuted() -> Tree:
    draw = np.random.default_rng(3)
    parents = (-1, 0, 0, 1, 2, -1)
    links = tuple(link(draw, name, parent, _hinge(draw)) for name, parent in zip("cfbead", parents, strict=True))
    return Tree("branches, numbered across", links)


def _with_fixed() -> Tree:
    draw = np.random.default_rng(4)
    rigid = placed(draw, Joint("fixed"))
    return Tree(
        "fixed links amid",
        (
            link(draw, "a", -1, _hinge(draw)),
            link(draw, "b", 0, rigid),
            link(draw, "c", 1, placed(draw, Joint("fixed"))),
            link(draw, "d", 2, _hinge(draw)),
            link(draw, "e", 0, placed(draw, Joint("fixed"))),
        ),
    )


def _massless() -> Tree:
    links = _chain("massless")
    return Tree("massless link amid", (links[0], replace(links[1], mass=0.0, com=ORIGIN, inertia=_NOTHING), links[2]))


def _grounded() -> Tree:
    """A first link that does not move; it has no mass, for not all engines count what stands still."""
    draw = np.random.default_rng(5)
    base = replace(link(draw, "a", -1, placed(draw, Joint("fixed"))), mass=0.0, com=ORIGIN, inertia=_NOTHING)
    return Tree("fixed to the world first", (base, link(draw, "b", 0, _hinge(draw)), link(draw, "c", 1, _hinge(draw))))


def _coincident() -> Tree:
    links = _chain("coincident")
    at_once = replace(links[1], joints=(Joint("revolute", axis=(0.0, 1.0, 0.0)),))
    return Tree(
        "hinges at one point", (links[0], at_once, replace(links[2], joints=(Joint("revolute", axis=(1.0, 0.0, 0.0)),)))
    )


def _free_with_branches() -> Tree:
    draw = np.random.default_rng(6)
    return Tree(
        "free base with branches",
        (
            link(draw, "a", -1, Joint("free")),
            link(draw, "b", 0, _hinge(draw)),
            link(draw, "c", 0, placed(draw, Joint("prismatic", axis=OBLIQUE))),
        ),
    )


def _beside_its_base() -> Tree:
    """A free base without mass; the body is fixed to it, aside, and carries a hinge."""
    draw = np.random.default_rng(8)
    base = Link("base", -1, (Joint("free"),), 0.0, ORIGIN, _NOTHING)
    return Tree(
        "free base beside its body",
        (base, link(draw, "b", 0, placed(draw, Joint("fixed"))), link(draw, "c", 1, _hinge(draw))),
    )


def _backwards() -> Tree:
    draw = np.random.default_rng(9)
    axes: tuple[Vector, ...] = ((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
    joints = [
        placed(draw, Joint(kind, axis=axis))
        for kind, axis in zip(("revolute", "prismatic", "revolute"), axes, strict=True)
    ]
    return Tree(
        "joints against x, y and z", tuple(link(draw, "abc"[k], k - 1, joint) for k, joint in enumerate(joints))
    )


def _far(name: str, p: Vector) -> Tree:
    """A chain whose first joint stands far from the world's origin."""
    first, *rest = _chain("far", 2)
    joint = replace(first.joints[0], p=p)
    return Tree(name, (replace(first, joints=(joint,)), *rest))


# Joints whose turns engines expand in series near zero, and how near: beside the series' usual bounds of 1e-3 and 1e-4,
# and where the cosine is 1 in doubles.
_TURNING, _NEAR = ("ball", "free", "planar", "free between links", "ellipsoid", "helical", "revolute z"), (12, 27)


def _small_turns() -> list[Tree]:
    return [
        replace(tree_of(kind), name=f"{kind}, 2^-{near} from zero", near=near) for kind in _TURNING for near in _NEAR
    ]


@cache
def trees() -> Mapping[str, Tree]:
    """The hostile set, by name."""
    draw = np.random.default_rng(7)
    heavy, light = _chain("heavy"), _chain("light")
    ends = (_scaled(heavy[0], 1e-8), heavy[1], _scaled(heavy[2], 1e8))
    armature = tuple(
        replace(one, joints=(replace(one.joints[0], armature=(0.25 * k + 0.5,)),)) for k, one in enumerate(light)
    )
    made = (
        _permuted(),
        _with_fixed(),
        _massless(),
        _grounded(),
        _coincident(),
        _free_with_branches(),
        _beside_its_base(),
        _backwards(),
        Tree("tiny before huge masses", ends),
        Tree("huge before tiny masses", (_scaled(heavy[0], 1e8), heavy[1], _scaled(heavy[2], 1e-8))),
        Tree("millimetres", tuple(_resized(one, 1e-3) for one in _chain("small"))),
        Tree("kilometres", tuple(_resized(one, 1e3) for one in _chain("large"))),
        Tree("oblique gravity", light, gravity=shifted(draw, 20.0)),
        Tree("armature everywhere", armature),
        _far("base 100 m away", (64.0, -48.0, 60.0)),
        _far("base 10 km away", (6400.0, -4800.0, 6000.0)),
        replace(_free_with_branches(), name="free base without weight", gravity=ORIGIN),
        replace(_free_with_branches(), name="free base 10 km away", away=(6400.0, -4800.0, 6000.0)),
        Tree("six oblique hinges", _chain("six", 6)),
        *_small_turns(),
    )
    return {tree.name: tree for tree in made}
