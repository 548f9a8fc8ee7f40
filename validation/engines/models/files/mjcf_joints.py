"""MJCF: ranges of joints alone and several to a body, in both units of angles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from ...interface import Joint
from . import readers
from .mjcf import FIRST, JOINT_A, MA, MB, RADIAN, file
from .readers import LIMITED, LIMITED_OF_SOME, NEXT, Reading, hung

_of = partial(readers.reading, "mjcf")
_DEGREES = '<compiler angle="degree"/>'
_RANGE, _IN_DEGREES = (-0.5, 1.25), (-30.0, 75.0)


def _limits() -> Iterator[tuple[str, Reading]]:
    """Ranges of joints: angles in the unit that counts, lengths in metres, of joints alone and several to a body."""
    first = hung(FIRST, limits=(-1.0, 0.75))
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    own = JOINT_A.replace("/>", ' range="{} {}"/>')
    turned = tuple(map(math.radians, _IN_DEGREES))
    hinge = 'axis="0 1 0" range="{} {}"'
    radians, degrees = hinge.format(*_RANGE), hinge.format(*_IN_DEGREES)

    def stated(
        name: str, joints: str, *bounds: Joint, head: str = RADIAN, is_degree: bool = False
    ) -> tuple[str, Reading]:
        a = own.format(*map(math.degrees, (-1.0, 0.75))) if is_degree else own.format(-1.0, 0.75)
        place = Joint("fixed", p=(0.0, 0.0, 0.5))
        link = replace(NEXT, joints=(place, *bounds))
        return _of(name, file(a + MA, joints + MB, head), first, link, asked=LIMITED)

    one, other = Joint("revolute", axis=y, limits=_RANGE), Joint("revolute", axis=y, limits=turned)
    slide = Joint("prismatic", axis=x, limits=(-0.25, 2.0))
    along = '<joint type="slide" axis="1 0 0" range="-0.25 2"/>'
    yield stated("range of a hinge, angle left out", f"<joint {degrees}/>", other, head="", is_degree=True)
    yield stated("range of a slide, angle left out", along, slide, head="", is_degree=True)
    second = '<compiler autolimits="true"/>'
    yield stated("range, angle in a second compiler", f"<joint {radians}/>", one, head=second + RADIAN)
    yield stated("range, angle in the first of two compilers", f"<joint {radians}/>", one, head=RADIAN + second)
    yield stated("range, degrees after radians", f"<joint {degrees}/>", other, head=RADIAN + _DEGREES, is_degree=True)
    by_class = f'<default><default class="k"><joint {degrees}/></default></default>'
    yield stated("range of a class, angle left out", '<joint class="k"/>', other, head=by_class, is_degree=True)
    yield stated("ranges of two joints of a body", f"<joint {radians}/>{along}", one, slide)
    yield stated(
        "ranges of two joints, angle left out", f"<joint {degrees}/>{along}", other, slide, head="", is_degree=True
    )
    yield stated("ranges of a slide before a hinge", f"{along}<joint {radians}/>", slide, one)
    across = '<joint axis="1 0 0" range="-2 0.125"/>'
    third = Joint("revolute", axis=x, limits=(-2.0, 0.125))
    yield stated("ranges of three joints of a body", f"<joint {radians}/>{along}{across}", one, slide, third)


def _limits_of_some() -> Iterator[tuple[str, Reading]]:
    """Ranges of joints beyond others that have none, or more speeds or coordinates than one."""
    hinge, limited = '<joint axis="0 1 0" range="{} {}"/>'.format(*_RANGE), hung(NEXT, limits=_RANGE)
    free = replace(FIRST, joints=(Joint("free"),))
    ball = replace(FIRST, joints=(replace(FIRST.joints[0], kind="ball"),))
    firsts = {
        "an unlimited hinge": (JOINT_A, FIRST),
        "a free joint": ("<freejoint/>", free),
        "a ball": ('<joint type="ball"/>', ball),
    }
    for name, (joint, first) in firsts.items():
        yield _of(
            f"range of a hinge beyond {name}", file(joint + MA, hinge + MB), first, limited, asked=LIMITED_OF_SOME
        )


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_limits(), *_limits_of_some()])
