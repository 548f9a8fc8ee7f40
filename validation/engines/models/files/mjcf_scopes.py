"""MJCF: which class of defaults counts for each attribute: the one that is named, with the classes around it, alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from ..covering.mjcf_meaning import meaning
from .mjcf import JOINT_A, JOINT_B, MA, MB, RADIAN, file
from .readers import LIMITED_OF_SOME, LOSSES, PLACED, READ, Reading

_SIZES = (0.1, 0.2, 0.3)


class _Attribute(NamedTuple):
    """One attribute of one element.

    Attributes:
        element: Name of the element.
        stated: The attribute.
        text: What stands in the second body; braces where the element names its class.
        asked: What it shows in.
    """

    element: str
    stated: str
    text: str
    asked: tuple[str, ...] = READ


_HINGE, _BARE = f'<joint axis="0 1 0" {{}}/>{MB}', f"<joint {{}}/>{MB}"
_BOX = f'{JOINT_B}<geom type="box" size="0.1 0.2 0.3" {{}}/>'
_ATTRIBUTES = {
    "damping": _Attribute("joint", 'damping="3"', _HINGE, LOSSES),
    "stiffness": _Attribute("joint", 'stiffness="7"', _HINGE, LOSSES),
    "frictionloss": _Attribute("joint", 'frictionloss="0.3"', _HINGE, LOSSES),
    "armature": _Attribute("joint", 'armature="0.5"', _HINGE),
    "axis": _Attribute("joint", 'axis="1 0 0"', _BARE),
    "type of a joint": _Attribute("joint", 'type="slide"', _HINGE),
    "range": _Attribute("joint", 'range="-0.5 1.25"', _HINGE, LIMITED_OF_SOME),
    "density": _Attribute("geom", 'density="2000"', _BOX),
    "mass of a geom": _Attribute("geom", 'mass="24"', _BOX),
    "position of a site": _Attribute("site", 'pos="0.1 -0.2 0.3"', f'{JOINT_B}{MB}<site name="o0" {{}}/>', PLACED),
}


def _scopes() -> Iterator[tuple[str, Reading]]:
    """A class within another has what that states; one that is named hides what `childclass` states."""
    for name, one in _ATTRIBUTES.items():
        stated = f"<{one.element} {one.stated}/>"
        ways = {
            "class of nothing below childclass": (
                f'<default class="k">{stated}</default><default class="p"/>',
                'class="p"',
            ),
            "class within a class": (f'<default class="k">{stated}<default class="p"/></default>', 'class="p"'),
            "main class below childclass": (f'{stated}<default class="k"/>', 'class="main"'),
            "childclass over main class": (f'{stated}<default class="k"/>', ""),
        }
        for way, (classes, own) in ways.items():
            head = f"{RADIAN}<default>{classes}</default>"
            first = JOINT_A.replace(
                "<joint", '<joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge"'
            )
            if "range" in name:
                first = first.replace("/>", ' limited="false"/>')
            text = file(first + MA, one.text.format(own), head, ("", 'childclass="k"'))
            title = f"mjcf: {way}: {name}"
            yield title, Reading("mjcf", text, replace(meaning(text), name=title), asked=one.asked)


def files() -> dict[str, Reading]:
    """All of them, by name."""
    return dict(_scopes())
