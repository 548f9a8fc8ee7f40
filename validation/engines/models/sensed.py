"""Trees whose links carry sensors, at frames that are turned and off the links' origins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..interface import Actuator, End, Joint, Tendon, Tree
from .kinds import OBLIQUE, link, placed, shifted, turned

_HINGE = Joint("revolute", axis=OBLIQUE)


def _sensed(name: str, *joints: Joint) -> Tree:
    """A chain, each link with a sensor."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = [link(draw, "abcdef"[k], k - 1, placed(draw, joint)) for k, joint in enumerate(joints)]
    sensors = tuple(End(one.name, turned(draw), shifted(draw, 0.3)) for one in links)
    return Tree(name, tuple(links), sensors=sensors)


def _of_forces() -> list[Tree]:
    """Joints that act on both of their links, which no sensor tells from what holds the link: losses, motors.

    A tendon between links is none of what holds them.
    """
    damped = replace(_HINGE, damping=0.75)
    driven = _sensed("sensors on driven joints", _HINGE, Joint("prismatic", axis=OBLIQUE), _HINGE)
    motors = (
        Actuator("a", gear=3.0, control=0.75),
        Actuator("b", gear=0.5, gain=6.0, bias=(0.0, -6.0, 0.0), control=-0.5),
    )
    first, last = End("a", p=(0.25, 0.125, 0.25)), End("c", p=(-0.25, 0.5, 0.125))
    straight = Tendon("path", (first, last), stiffness=40.0, damping=0.5, rest=0.25)
    over = replace(straight, ends=(End("", p=(-1.0, 0.125, 0.25)), first, last))
    pulled, bent = "sensors on hinges that a tendon pulls", "sensors on hinges that a tendon over points pulls"
    return [
        replace(_sensed(pulled, _HINGE, _HINGE, _HINGE), tendons=(straight,)),
        replace(_sensed(bent, _HINGE, _HINGE, _HINGE), tendons=(over,)),
        _sensed("sensors on damped hinges", damped, damped, damped),
        replace(driven, actuators=motors),
    ]


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    made = (
        *_of_forces(),
        _sensed("sensors on hinges", _HINGE, _HINGE, _HINGE),
        _sensed("sensors beyond a ball", _HINGE, Joint("ball"), _HINGE),
        _sensed("sensors on fixed links", _HINGE, Joint("fixed"), _HINGE),
    )
    return {tree.name: tree for tree in made}
