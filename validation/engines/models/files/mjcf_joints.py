"""MJCF: what joints state that no function of M and g shows: dampers, springs, dry friction, limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from ...interface import Joint, Link
from . import readers
from .mjcf import FIRST, JOINT_A, MA, MB, RADIAN, file
from .readers import LIMITED, LIMITED_OF_SOME, LOSSES, NEXT, Reading, hung

_of = partial(readers.reading, "mjcf")
_DEGREES = '<compiler angle="degree"/>'
_RANGE, _IN_DEGREES = (-0.5, 1.25), (-30.0, 75.0)


def _losses() -> Iterator[tuple[str, Reading]]:
    """Dampers, springs and dry friction of joints, in units that no angle's unit changes."""
    stated = {"damping": 3.0, "stiffness": 7.0, "friction": 0.3}
    text = 'damping="3" stiffness="7" frictionloss="0.3"'
    lost = hung(NEXT, **stated)
    slide = Joint("prismatic", p=(0.0, 0.0, 0.5), axis=(1.0, 0.0, 0.0), **stated)  # type: ignore[arg-type]

    def second(name: str, joint: str, link: Link, head: str = RADIAN) -> tuple[str, Reading]:
        return _of(name, file(b=joint + MB, head=head), FIRST, link, asked=LOSSES)

    yield second("losses of a hinge", f'<joint axis="0 1 0" {text}/>', lost)
    yield second("losses of a hinge, angle left out", f'<joint axis="0 1 0" {text}/>', lost, "")
    yield second("losses of a slide", f'<joint type="slide" axis="1 0 0" {text}/>', replace(NEXT, joints=(slide,)), "")
    placed, borne = Joint("fixed", p=(0.0, 0.0, 0.5)), {"damping": 3.0, "friction": 0.3}
    ball = replace(NEXT, joints=(placed, Joint("ball", **borne)))  # type: ignore[arg-type]
    yield second("losses of a ball", '<joint type="ball" damping="3" frictionloss="0.3"/>', ball)
    heavy = replace(NEXT, joints=(placed, Joint("ball", armature=(0.5,) * 3)))
    yield _of("armature of a ball", file(b='<joint type="ball" armature="0.5"/>' + MB), FIRST, heavy)
    pair = '<joint axis="0 1 0" damping="3"/><joint axis="1 0 0" damping="0.5" frictionloss="0.25"/>'
    y, x = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
    both = Joint("revolute", axis=y, damping=3.0), Joint("revolute", axis=x, damping=0.5, friction=0.25)
    yield second("losses of two joints of a body", pair, replace(NEXT, joints=(placed, *both)))
    classes = f'<default><default class="k"><joint {text}/></default></default>'
    yield second("losses of a class", '<joint class="k" axis="0 1 0"/>', lost, RADIAN + classes)


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
    yield stated("range of a hinge", f"<joint {radians}/>", one)
    yield stated("range of a hinge, angle left out", f"<joint {degrees}/>", other, head="", is_degree=True)
    yield stated("range of a slide, angle left out", along, slide, head="", is_degree=True)
    yield stated("range, limited", f'<joint limited="true" {radians}/>', one)
    manual = '<compiler angle="radian" autolimits="false"/>'
    both = file(
        own.format(-1.0, 0.75).replace("/>", ' limited="true"/>') + MA,
        f'<joint limited="true" {radians}/>{MB}',
        manual,
    )
    yield _of("range, limited by hand", both, first, hung(NEXT, limits=_RANGE), asked=LIMITED)
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


def _limits_of_none() -> Iterator[tuple[str, Reading]]:
    """Ranges that are no limits: `limited` says so, or, where it leaves that to the range, both ends are zero."""
    first = hung(FIRST, limits=(-1.0, 0.75))
    a = JOINT_A.replace("/>", ' limited="true" range="-1 0.75"/>') + MA
    by_hand = '<compiler angle="radian" autolimits="false"/>'
    for name, stated, head in (
        ("limited false", 'limited="false" range="-0.5 1.25"', RADIAN),
        ("limited false, autolimits false", 'limited="false" range="-0.5 1.25"', by_hand),
        ("zeros", 'range="0 0"', RADIAN),
        ("zeros, limited auto", 'limited="auto" range="0 0"', RADIAN),
    ):
        text = file(a, f'<joint axis="0 1 0" {stated}/>{MB}', head)
        yield _of(f"range without limits: {name}", text, first, NEXT, asked=LIMITED_OF_SOME)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict([*_losses(), *_limits(), *_limits_of_some(), *_limits_of_none()])
