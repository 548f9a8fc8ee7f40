"""Trees that forces of their own act on: dampers, springs, compensated weights, tendons, actuators."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..interface import Actuator, End, Joint, Link, Tendon, Tree
from .kinds import OBLIQUE, link, placed, shifted


def _chain(name: str, *joints: Joint, branches: bool = False) -> tuple[Link, ...]:
    """Links one after the other, or the last two on the first."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    parents = [-1, 0, 0] if branches else range(-1, len(joints) - 1)
    return tuple(link(draw, "abcdef"[k], parents[k], placed(draw, joint)) for k, joint in enumerate(joints))


_HINGE, _SLIDE = Joint("revolute", axis=OBLIQUE), Joint("prismatic", axis=OBLIQUE)
_DAMPED = replace(_HINGE, damping=0.75)
_SPRUNG = replace(_HINGE, stiffness=3.0, rest=0.25)


def _passive() -> list[Tree]:
    both, slide = replace(_DAMPED, stiffness=2.0, rest=-0.5), replace(_SLIDE, damping=1.5, stiffness=8.0, rest=0.125)
    borne = tuple(
        replace(one, compensation=part)
        for one, part in zip(_chain("borne", *[_HINGE] * 3), (1.0, 0.0, 0.5), strict=True)
    )
    draw = np.random.default_rng(9)
    body = link(draw, "a", -1, Joint("free", damping=0.5))
    return [
        Tree("dampers on hinges", _chain("dampers", *[_DAMPED] * 3)),
        Tree("a damper and two free hinges", _chain("one damper", _HINGE, _DAMPED, _HINGE)),
        Tree(
            "dampers on a slide and a ball",
            _chain("slide and ball", replace(_SLIDE, damping=1.5), Joint("ball", damping=0.5)),
        ),
        Tree("springs on hinges", _chain("springs", *[_SPRUNG] * 3)),
        Tree("springs and dampers on hinges and a slide", _chain("both", both, slide, both)),
        Tree("springs and dampers on branches", _chain("both, branched", both, both, slide, branches=True)),
        Tree("a damped free body", (body,)),
        Tree("a damped hinge on a damped free base", _carried(body)),
        Tree("borne weights", borne),
    ]


def _carried(base: Link) -> tuple[Link, ...]:
    return base, link(np.random.default_rng(10), "b", 0, placed(np.random.default_rng(12), _DAMPED))


def _tendons() -> list[Tree]:
    draw = np.random.default_rng(11)
    links = _chain("tendons", _HINGE, _SLIDE, _HINGE)
    ends = tuple(End(one.name) for one in links)
    coupled = Tendon("coupling", ends, (1.0, -0.5, 2.0), stiffness=4.0, damping=0.5, rest=0.25)
    path = tuple(End(name, p=shifted(draw, 0.3)) for name in ("", "a", "c"))
    over = Tendon("path", path, stiffness=4.0, damping=0.5, rest=0.25)
    pulled = (
        Actuator(tendon=0, gear=2.0, gain=1.5, control=0.75),
        Actuator(tendon=1, gear=-0.5, gain=3.0, bias=(0.25, -3.0, -0.5)),
    )
    return [
        Tree("tendon of a sum", links, tendons=(coupled,)),
        Tree("tendon over points", links, tendons=(over,)),
        Tree(
            "tendon over points of one branch", _chain("short", *[_HINGE] * 3), tendons=(replace(over, ends=path[1:]),)
        ),
        Tree("actuators on tendons", links, tendons=(coupled, over), actuators=pulled),
    ]


def _actuators() -> list[Tree]:
    links = _chain("actuators", _DAMPED, _SLIDE, _SPRUNG)
    motor = Actuator("a", gear=3.0, control=0.75)
    servo = Actuator("b", gear=0.5, gain=6.0, bias=(0.0, -6.0, 0.0), control=-0.5)
    brake = Actuator("c", gear=2.0, gain=1.5, bias=(0.0, 0.0, -1.5), control=0.5)
    general = Actuator("b", gear=-1.5, gain=0.5, bias=(0.25, -1.0, -0.75), control=2.0, control_limits=(-1.0, 1.0))
    return [
        Tree("motors", links, actuators=(motor, replace(motor, link="b", gear=-1.0))),
        Tree("servos of position and velocity", links, actuators=(servo, brake)),
        Tree("actuators of all kinds", links, actuators=(motor, servo, brake, general)),
        Tree("actuators at their limits", links, actuators=(replace(general, force_limits=(-0.125, 0.125)), motor)),
    ]


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    return {tree.name: tree for tree in (*_passive(), *_tendons(), *_actuators())}
