"""Trees with limits, dry friction and floors that act: alone, at rest within, several at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..interface import Constraint, End, Joint, Tendon, Tree
from ..tree import SOFT_LIMITS
from .kinds import OBLIQUE, link, placed, shifted

_HINGE, _SLIDE = Joint("revolute", axis=OBLIQUE), Joint("prismatic", axis=OBLIQUE)
# Coordinates of random states are within half a turn: the first is always passed, the second mostly, the third never.
_ABOVE, _WITHIN, _WIDE = (4.0, 8.0), (-0.25, 0.125), (-8.0, 8.0)


def _chain(name: str, *joints: Joint, tendons: tuple[Tendon, ...] = (), floors: tuple[Constraint, ...] = ()) -> Tree:
    draw = np.random.default_rng([ord(letter) for letter in name])
    links = tuple(link(draw, "abc"[k], k - 1, placed(draw, joint)) for k, joint in enumerate(joints))
    return Tree(name, links, constraints=floors, tendons=tendons, asked=SOFT_LIMITS)


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    draw = np.random.default_rng(29)
    rubbed = replace(_HINGE, friction=0.25)
    along = Tendon("coupling", (End("a"), End("b"), End("c")), (1.0, -0.5, 2.0))
    over = Tendon("path", tuple(End(name, p=shifted(draw, 0.3)) for name in ("", "a", "c")))
    high, low, aside = (
        Constraint("floor", (End(name, p=shifted(draw, 0.3)),), (0.25, height))
        for name, height in (("a", 8.0), ("c", 8.0), ("b", -8.0))
    )
    three = (_HINGE, _SLIDE, _HINGE)
    made = (
        _chain("hinge below its limit", replace(_HINGE, limits=_ABOVE)),
        _chain("slide beyond its limits", replace(_SLIDE, limits=_WITHIN)),
        _chain("hinge within its limits", replace(_HINGE, limits=_WIDE)),
        _chain("hinge with dry friction", rubbed),
        _chain("slide with much dry friction", replace(_SLIDE, friction=64.0)),
        _chain("hinges beyond limits", *(replace(one, limits=_WITHIN) for one in three)),
        _chain("limits beside friction", replace(rubbed, limits=_ABOVE), replace(_SLIDE, friction=2.0), _HINGE),
        _chain(
            "limits, armature, springs and dampers",
            replace(_HINGE, limits=_ABOVE, armature=(0.75,), damping=0.5),
            replace(_SLIDE, stiffness=8.0, rest=0.25, friction=0.5),
        ),
        _chain("tendon of a sum beyond its limits", *three, tendons=(replace(along, limits=_WITHIN),)),
        _chain("tendon over points beyond its limits", *three, tendons=(replace(over, limits=(0.125, 0.25)),)),
        _chain(
            "tendons with dry friction", *three, tendons=(replace(along, friction=0.5), replace(over, friction=8.0))
        ),
        _chain("hinge with a ball below a floor", _HINGE, floors=(high,)),
        _chain("balls below floors and above one", *three, floors=(high, aside, low)),
        _chain("ball below a floor beside limits", replace(_HINGE, limits=_ABOVE), rubbed, floors=(high,)),
        _chain(
            "tendon beside a joint, both beyond limits",
            replace(_HINGE, limits=_ABOVE),
            *three[1:],
            tendons=(replace(along, limits=_WITHIN, stiffness=4.0, damping=0.5, rest=0.25),),
        ),
    )
    return {tree.name: tree for tree in made}
