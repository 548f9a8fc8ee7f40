"""Spacecraft: a free hub that carries chains of hinges or of slides, panels, wheels, particles, in no gravity."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..interface import IDENTITY, ORIGIN, Joint, Link, Rows, Tree, Vector
from .kinds import OBLIQUE, link, placed

SPACECRAFT = "spacecraft"
_HINGE, _SLIDE = Joint("revolute", axis=OBLIQUE), Joint("prismatic", axis=OBLIQUE)
_LOSSY = {"stiffness": 3.0, "damping": 0.75, "rest": 0.25}
_FREE: Joint = Joint("free")


def _craft(name: str, *chains: tuple[Joint, ...]) -> Tree:
    """A hub with chains of bodies, each joint at an oblique placement."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = [link(draw, "hub", -1, _FREE)]
    for chain in chains:
        parent = 0
        for joint in chain:
            links.append(link(draw, f"body {len(links)}", parent, placed(draw, joint)))
            parent = len(links) - 1
    return _tree(name, *links)


def _tree(name: str, *links: Link) -> Tree:
    return Tree(name, links, ORIGIN, asked=SPACECRAFT)


def _diagonal(x: float, y: float, z: float) -> Rows:
    return ((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))


def _panels(name: str, count: int, reach: float, **forces: float) -> Tree:
    """A chain of panels of length `reach`, hinged along y, that reach to -x, with mass centres at 3/8."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    first = placed(draw, Joint("revolute", axis=(0.0, 1.0, 0.0), **forces))  # type: ignore[arg-type]
    after = replace(first, R=IDENTITY, p=(-reach, 0.0, 0.0))
    panel = Link("panel 0", 0, (first,), 0.75, (-0.375, 0.0, 0.0), _diagonal(0.0625, 0.046875, 0.09375))
    others = (replace(panel, name=f"panel {k}", parent=k, joints=(after,)) for k in range(1, count))
    return _tree(name, link(draw, "hub", -1, _FREE), panel, *others)


def _with(name: str, joint: Joint, mass: float, inertia: Rows, com: Vector = ORIGIN) -> Tree:
    """A hub with two bodies, given in the frames of their joints."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    hub, parts = link(draw, "hub", -1, _FREE), [placed(draw, joint) for _ in range(2)]
    return _tree(name, hub, *(Link(f"wheel {k}", 0, (one,), mass, com, inertia) for k, one in enumerate(parts)))


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    spun, slid = replace(_HINGE, **_LOSSY), replace(_SLIDE, **_LOSSY)  # type: ignore[arg-type]
    about_x, nothing = Joint("revolute", axis=(1.0, 0.0, 0.0)), _diagonal(0.0, 0.0, 0.0)
    unbalanced = ((0.0625, 0.0, 0.015625), (0.0, 0.046875, 0.0), (0.015625, 0.0, 0.046875))
    drawn = replace(_SLIDE, stiffness=3.0, damping=0.75)
    made = [
        _craft("spacecraft"),
        _craft("spacecraft with a hinge", (_HINGE,)),
        _craft("spacecraft with two hinges in series", (_HINGE, _HINGE)),
        _craft("spacecraft with three hinges in series", (_HINGE,) * 3),
        _craft("spacecraft with two hinges aside", (_HINGE,), (_HINGE,)),
        _craft("spacecraft with a slide", (_SLIDE,)),
        _craft("spacecraft with two slides in series", (_SLIDE, _SLIDE)),
        _craft("spacecraft with hinges and slides", (_HINGE, _HINGE), (_SLIDE, _SLIDE)),
        _craft("spacecraft with a sprung hinge", (spun,)),
        _craft("spacecraft with sprung hinges in series", (spun, spun)),
        _craft("spacecraft with a sprung slide", (slid,)),
        _craft("spacecraft with sprung slides in series", (slid, slid)),
        _panels("spacecraft with a panel", 1, 0.75),
        _panels("spacecraft with a sprung panel", 1, 0.75, **_LOSSY),
        _panels("spacecraft with two panels", 2, 0.75),
        _panels("spacecraft with two panels of other lengths", 2, 0.625, stiffness=3.0, damping=0.75),
        _panels("spacecraft with three panels", 3, 0.75),
        _panels("spacecraft with three sprung panels", 3, 0.75, stiffness=3.0, damping=0.75),
        _with("spacecraft with particles", _SLIDE, 0.5, nothing),
        _with("spacecraft with sprung particles", drawn, 0.5, nothing),
        _with("spacecraft with wheels", about_x, 0.0, _diagonal(0.015625, 0.0, 0.0)),
        _with("spacecraft with unbalanced wheels", about_x, 0.5, unbalanced, (0.0, 0.125, 0.0)),
        _with("spacecraft with wheels of two moments across", about_x, 0.5, _diagonal(0.0625, 0.046875, 0.0546875)),
    ]
    return {tree.name: tree for tree in made}
