"""Trees whose links carry sensors, at frames that are turned and off the links' origins."""

from __future__ import annotations

import numpy as np

from ..interface import End, Joint, Link, Tree
from .kinds import OBLIQUE, link, placed, shifted, turned

_HINGE = Joint("revolute", axis=OBLIQUE)


def _sensed(name: str, *joints: Joint, base: bool = False, sideways: bool = False) -> Tree:
    """A chain, or branches on the first link, each link with a sensor."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    links: list[Link] = [link(draw, "base", -1, Joint("free"))] if base else []
    for k, joint in enumerate(joints):
        parent = min(len(links), 1) - 1 if sideways else len(links) - 1
        links.append(link(draw, "abcdef"[k], parent, placed(draw, joint)))
    sensors = tuple(End(one.name, turned(draw), shifted(draw, 0.3)) for one in links)
    return Tree(name, tuple(links), shifted(draw, 20.0) if "aside" in name else (0.0, 0.0, -9.81), sensors=sensors)


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    made = (
        _sensed("sensors on hinges", _HINGE, _HINGE, _HINGE),
        _sensed("sensors on branches, gravity aside", _HINGE, _HINGE, _HINGE, sideways=True),
        _sensed("sensors on a slide and hinges", Joint("prismatic", axis=OBLIQUE), _HINGE, _HINGE),
        _sensed("sensors beyond a ball", _HINGE, Joint("ball"), _HINGE),
        _sensed("sensors on a free base and branches", _HINGE, _HINGE, base=True, sideways=True),
        _sensed("sensors on fixed links", _HINGE, Joint("fixed"), _HINGE),
    )
    return {tree.name: tree for tree in made}
