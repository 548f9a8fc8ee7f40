"""Trees whose links are bound further: loops closed by points and welds, coupled coordinates, paths of cables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..interface import Constraint, End, Joint, Link, Tree
from .kinds import OBLIQUE, link, placed, shifted, turned

_Y = (0.0, 1.0, 0.0)


def _hinge(draw: np.random.Generator) -> Joint:
    return placed(draw, Joint("revolute", axis=OBLIQUE))


def _branches(draw: np.random.Generator, count: int, root: int, *lengths: int) -> tuple[Link, ...]:
    """Chains of links on oblique hinges, that hang on one root; `count` links stand before them."""
    links: list[Link] = []
    for letter, length in zip("abc", lengths, strict=False):
        for k in range(length):
            parent = count + len(links) - 1 if k else root
            links.append(link(draw, f"{letter}{k}", parent, _hinge(draw)))
    return tuple(links)


def _end(draw: np.random.Generator, name: str) -> End:
    return End(name, turned(draw), shifted(draw, 0.3))


def _free_base(draw: np.random.Generator) -> Link:
    return link(draw, "base", -1, Joint("free"))


def _bound(name: str, kind: str, ends: tuple[str, str], *lengths: int, free: bool = False) -> Tree:
    """Branches of which two links are bound to each other, or one to the world."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    base = (_free_base(draw),) if free else ()
    links = (*base, *_branches(draw, len(base), len(base) - 1, *lengths))
    return Tree(name, links, constraints=(Constraint(kind, (_end(draw, ends[0]), _end(draw, ends[1]))),))


def _scaled(name: str, second: str, *lengths: int) -> Tree:
    """A weld whose rows of rotation have a factor; the second frame is its link's."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    first = _end(draw, f"a{lengths[0] - 1}")
    weld = Constraint("weld", (first, End(second)), torque_scale=0.5)
    return Tree(name, _branches(draw, 0, -1, *lengths), constraints=(weld,))


def _lone_body() -> Tree:
    """A free body of equal moments, welded at its mass centre: J M^-1 J^T is the same at all orientations."""
    body = Link("a", -1, (Joint("free"),), 2.0, inertia=((0.125, 0.0, 0.0), (0.0, 0.125, 0.0), (0.0, 0.0, 0.125)))
    return Tree("weld of a ball", (body,), constraints=(Constraint("weld", (End("a"), End(""))),), asked="a lone body")


def _pair(kind: str) -> Tree:
    """Two free bodies that are bound to each other, aside of their origins and along axes of their own."""
    draw = np.random.default_rng(37)
    links = tuple(link(draw, name, -1, Joint("free")) for name in "ab")
    bound = Constraint(kind, (_end(draw, "a"), _end(draw, "b")))
    return Tree(f"{kind} between free bodies", links, constraints=(bound,), asked="a bound pair")


def _sensed(name: str, kind: str, ends: tuple[str, str], *lengths: int) -> Tree:
    """Bound branches with a sensor on each link; constraints bear a part of the wrenches that hold it."""
    tree = _bound(name, kind, ends, *lengths)
    draw = np.random.default_rng(43)
    return replace(tree, sensors=tuple(_end(draw, link.name) for link in tree.links))


def _two_points() -> Tree:
    draw = np.random.default_rng(31)
    links = _branches(draw, 0, -1, 4, 4)
    ties = (
        Constraint("point", (_end(draw, "a1"), _end(draw, "b1"))),
        Constraint("point", (_end(draw, "a3"), _end(draw, "b3"))),
    )
    return Tree("points at two heights", links, constraints=ties)


def _four_bar() -> Tree:
    """Bars in a plane: of the three equations of its closing point one says nothing, exactly."""
    hinge = Joint("revolute", axis=_Y)
    along = Joint("revolute", p=(1.0, 0.0, 0.0), axis=_Y)
    bar = {"mass": 1.5, "com": (0.5, 0.0, 0.25), "inertia": ((0.2, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))}
    links = (Link("a", -1, (hinge,), **bar), Link("b", 0, (along,), **bar), Link("c", 1, (along,), **bar))  # type: ignore[arg-type]
    closing = Constraint("point", (End("c", p=(1.0, 0.0, 0.0)), End("", p=(0.75, 0.0, 0.5))))
    return Tree("four-bar in a plane", links, constraints=(closing,))


def _by_bodies() -> Tree:
    """Two branches along the world's axes at zero, where one anchor is the other."""
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    draw = np.random.default_rng(41)
    stated = (
        ("a0", -1, y, (0.0, 0.0, 0.0)),
        ("a1", 0, x, (0.5, 0.0, 0.0)),
        ("a2", 1, z, (0.5, 0.0, 0.25)),
        ("b0", -1, y, (0.0, 0.0, 1.0)),
        ("b1", 3, z, (0.5, 0.25, 0.0)),
    )
    links = tuple(link(draw, name, parent, Joint("revolute", p=p, axis=axis)) for name, parent, axis, p in stated)
    ends = End("a2", p=(0.25, 0.5, 0.0)), End("b1", p=(0.75, 0.25, -0.75))
    return Tree("point by bodies", links, constraints=(Constraint("point", ends, by_bodies=True),))


def _of_joint(name: str, joint: Joint) -> Tree:
    """A joint of some kind amid one of two branches that a point binds."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = list(_branches(draw, 0, -1, 3, 2))
    links[1] = link(draw, "a1", 0, placed(draw, joint))
    return Tree(name, tuple(links), constraints=(Constraint("point", (_end(draw, "a2"), _end(draw, "b1"))),))


def _coupled(name: str, count: int, *coefficients: float) -> Tree:
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = _branches(draw, 0, -1, count)
    ends = tuple(End(f"a{k}") for k in range(len(coefficients)))
    return Tree(name, links, constraints=(Constraint("coupling", ends, coefficients),))


def _polynomial(name: str, driver: Joint, *coefficients: float) -> Tree:
    """A hinge whose angle is a polynomial of the coordinate of the joint before it."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = list(_branches(draw, 0, -1, 3))
    links[1] = link(draw, "a1", 0, placed(draw, driver))
    return Tree(name, tuple(links), constraints=(Constraint("polynomial", (End("a2"), End("a1")), coefficients),))


def _cable(name: str, *via: str) -> Tree:
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = _branches(draw, 0, -1, 3, 2)
    ends = tuple(End(one, p=shifted(draw, 0.3)) for one in via)
    return Tree(name, links, constraints=(Constraint("path", ends),))


def trees() -> dict[str, Tree]:
    """All of them, by name: first one of each kind."""
    anchored = _by_bodies()
    made = (
        _bound("point between branches", "point", ("a2", "b2"), 3, 3),
        _bound("weld between branches", "weld", ("a3", "b3"), 4, 4),
        replace(anchored, name="anchor of a connect constraint changed", changed="anchor"),
        _sensed("sensors on branches that a connect constraint binds", "point", ("a2", "b2"), 3, 3),
        _coupled("coupling of two hinges", 3, 1.0, -0.5),
        _scaled("weld between branches with a torque scale", "b3", 4, 4),
        _polynomial("polynomial of a hinge, of degree two", Joint("revolute", axis=OBLIQUE), 0.125, -0.5, 0.25),
        _cable("cable of two points", "a2", "b1"),
        _lone_body(),
        _pair("weld"),
        _pair("point"),
        _four_bar(),
        anchored,
        _bound("point held in the world", "point", ("a3", ""), 4),
        _bound("weld on the world", "weld", ("a6", ""), 7),
        _sensed("sensors on branches that a weld constraint binds", "weld", ("a3", "b2"), 4, 3),
        _bound("point between branches of a free base", "point", ("a2", "b2"), 3, 3, free=True),
        _bound("weld of two branches on a free base", "weld", ("a3", "b3"), 4, 4, free=True),
        _sensed("sensors on a chain that a connect constraint holds in the world", "point", ("a3", ""), 4),
        _bound("point of a free base's branch on the world", "point", ("a2", ""), 3, free=True),
        _bound("weld of a free base's branch on the world", "weld", ("a1", ""), 2, free=True),
        _scaled("weld on the world with a torque scale", "", 7),
        _two_points(),
        _of_joint("point beyond a slide", Joint("prismatic", axis=OBLIQUE)),
        _of_joint("point beyond a ball", Joint("ball")),
        _of_joint("point beyond a universal joint", Joint("universal", axis=(1.0, 0.0, 0.0), second=_Y)),
        _coupled("coupling of four hinges", 4, 1.0, -0.5, 0.25, 2.0),
        _polynomial(
            "polynomial of a hinge, of degree four", Joint("revolute", axis=OBLIQUE), -0.25, 0.5, 0.125, -0.25, 0.0625
        ),
        _polynomial("polynomial of a slide", Joint("prismatic", axis=OBLIQUE), 0.25, 0.0, -1.5, 0.5),
        _cable("cable over four points", "a2", "a0", "", "b1"),
    )
    return {tree.name: tree for tree in made}
