"""MJCF: which class of defaults counts for each attribute: the one that is named, with the classes around it, alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from ...interface import End, Link, Tree
from .mjcf import FIRST, JOINT_A, JOINT_B, MA, MB, RADIAN, dense, file, solid_of
from .readers import LIMITED_OF_SOME, LOSSES, NEXT, PLACED, READ, Reading, hung

_SIZES = (0.1, 0.2, 0.3)


class _Attribute(NamedTuple):
    """One attribute of one element.

    Attributes:
        element: Name of the element.
        stated: The attribute.
        text: What stands in the second body; braces where the element names its class.
        links: The second body by default, and where the attribute counts.
        asked: What it shows in.
        ends: Sites by default, and where it counts.
    """

    element: str
    stated: str
    text: str
    links: tuple[Link, Link]
    asked: tuple[str, ...] = READ
    ends: tuple[tuple[End, ...], tuple[End, ...]] = ((), ())


def _attributes() -> dict[str, _Attribute]:
    about_y = NEXT.joints[0]
    turned = replace(about_y, axis=(0.0, 0.0, 1.0))
    by_default, along_x = (replace(NEXT, joints=(one,)) for one in (turned, replace(turned, axis=(1.0, 0.0, 0.0))))
    slide = replace(NEXT, joints=(replace(about_y, kind="prismatic"),))
    hinge, bare = f'<joint axis="0 1 0" {{}}/>{MB}', f"<joint {{}}/>{MB}"
    solid = solid_of("box", *_SIZES)
    box = f'{JOINT_B}<geom type="box" size="0.1 0.2 0.3" {{}}/>'
    light, heavy = dense(solid), dense(solid, 2000.0)
    site, ends = f'{JOINT_B}{MB}<site name="o0" {{}}/>', ((End("b"),), (End("b", p=(0.1, -0.2, 0.3)),))
    lost = partial(_Attribute, "joint", text=hinge, asked=LOSSES)
    return {
        "damping": lost('damping="3"', links=(NEXT, hung(NEXT, damping=3.0))),
        "stiffness": lost('stiffness="7"', links=(NEXT, hung(NEXT, stiffness=7.0))),
        "frictionloss": lost('frictionloss="0.3"', links=(NEXT, hung(NEXT, friction=0.3))),
        "armature": _Attribute("joint", 'armature="0.5"', hinge, (NEXT, hung(NEXT, armature=(0.5,)))),
        "axis": _Attribute("joint", 'axis="1 0 0"', bare, (by_default, along_x)),
        "type of a joint": _Attribute("joint", 'type="slide"', hinge, (NEXT, slide)),
        "range": _Attribute(
            "joint",
            'range="-0.5 1.25"',
            hinge,
            (NEXT, hung(NEXT, limits=(-0.5, 1.25))),
            LIMITED_OF_SOME,
        ),
        "density": _Attribute("geom", 'density="2000"', box, (light, heavy)),
        "mass of a geom": _Attribute("geom", 'mass="24"', box, (light, dense(solid, 24.0 / solid[0]))),
        "position of a site": _Attribute("site", 'pos="0.1 -0.2 0.3"', site, (NEXT, NEXT), PLACED, ends),
    }


def _scopes() -> Iterator[tuple[str, Reading]]:
    """A class within another has what that states; one that is named hides what `childclass` states."""
    for name, one in _attributes().items():
        stated = f"<{one.element} {one.stated}/>"
        ways = {
            "class of nothing below childclass": (
                f'<default class="k">{stated}</default><default class="p"/>',
                'class="p"',
                0,
            ),
            "class within a class": (f'<default class="k">{stated}<default class="p"/></default>', 'class="p"', 1),
            "main class below childclass": (f'{stated}<default class="k"/>', 'class="main"', 1),
            "childclass over main class": (f'{stated}<default class="k"/>', "", 1),
        }
        for way, (classes, own, counts) in ways.items():
            head = f"{RADIAN}<default>{classes}</default>"
            first = JOINT_A.replace(
                "<joint", '<joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge"'
            )
            if "range" in name:
                first = first.replace("/>", ' limited="false"/>')
            text = file(first + MA, one.text.format(own), head, ("", 'childclass="k"'))
            title = f"mjcf: {way}: {name}"
            tree = Tree(title, (FIRST, one.links[counts]), sensors=one.ends[counts])
            yield title, Reading("mjcf", text, tree, asked=one.asked)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict(_scopes())
