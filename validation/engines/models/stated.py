"""Trees that are plain, in ways of stating them that an engine has of its own: a base, parameters, a tool.

Of Denavit and Hartenberg's parameters a joint's displacement and the offset d are along z, the length a and the twist
alpha along x after it; of the modified ones, before it.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np

from ..interface import ORIGIN, Joint, Link, Rows, Tree, rows
from ..tree import BASE, DENAVIT, GRIPPER, MODIFIED
from .kinds import link, placed, shifted

# Kind, d or theta, a, alpha, offset.
_Parameters = tuple[str, float, float, float, float]
_SHORT: tuple[_Parameters, ...] = (
    ("revolute", 0.25, 0.5, 1.25, 0.375),
    ("prismatic", 0.5, 0.125, -0.75, 0.25),
    ("revolute", -0.125, 0.375, 0.5, -0.625),
)
_ARM: tuple[_Parameters, ...] = (
    ("revolute", 0.25, 0.125, 1.25, 0.375),
    ("revolute", -0.125, 0.5, 0.25, -0.25),
    ("revolute", 0.0625, 0.375, -1.0, 0.5),
    ("revolute", 0.5, 0.0, 1.5, 0.0),
    ("revolute", 0.0, 0.125, -1.25, 0.25),
    ("revolute", 0.25, 0.0625, 0.75, -0.5),
)
_NOTHING: Rows = (ORIGIN, ORIGIN, ORIGIN)
_Z = (0.0, 0.0, 1.0)


def _turn(axis: str, angle: float) -> Rows:
    c, s = cos(angle), sin(angle)
    x, z = ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c)), ((c, -s, 0.0), (s, c, 0.0), _Z)
    return x if axis == "x" else z


def _standard(kind: str, along: float, a: float, alpha: float, offset: float) -> tuple[Joint, ...]:
    """A joint and what is after it; of a slide, `along` is the angle theta, otherwise the offset d."""
    is_slide = kind == "prismatic"
    moving = Joint(kind, R=_turn("z", along if is_slide else offset), p=(0.0, 0.0, offset if is_slide else 0.0))
    return moving, Joint("fixed", R=_turn("x", alpha), p=(a, 0.0, 0.0 if is_slide else along))


def _modified(kind: str, along: float, a: float, alpha: float, offset: float) -> tuple[Joint, ...]:
    """A joint after what is before it."""
    is_slide = kind == "prismatic"
    d, theta = (offset, along) if is_slide else (along, offset)
    R = rows(np.array(_turn("x", alpha)) @ np.array(_turn("z", theta)))
    return (Joint(kind, R=R, p=(a, -d * sin(alpha), d * cos(alpha))),)


def _chain(name: str, parameters: tuple[_Parameters, ...], stated: str, armature: float = 0.0) -> Tree:
    """A chain by its parameters; its links stand where the parameters have them."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    make = _modified if stated == MODIFIED else _standard
    links = []
    for k, one in enumerate(parameters):
        moving, *after = make(*one)
        moved = replace(moving, armature=(armature * (k + 1),) if armature else ())
        links.append(link(draw, "abcdef"[k], k - 1, moved, *after))
    return Tree(name, tuple(links), stated=stated)


def _on_base(tree: Tree) -> Tree:
    """A chain by parameters on a base that is turned and shifted."""
    first, *rest = tree.links
    base = placed(np.random.default_rng(33), Joint("fixed"))
    return replace(tree, name=f"{tree.name}, on a base", links=(replace(first, joints=(base, *first.joints)), *rest))


def _based(name: str, *kinds: str) -> Tree:
    """A chain on a base that is turned and shifted: the placement of its first joint."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    axes = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    joints = [placed(draw, Joint(kind, axis=axes[k % 3])) for k, kind in enumerate(kinds)]
    return Tree(name, tuple(link(draw, "abcdefg"[k], k - 1, joint) for k, joint in enumerate(joints)), stated=BASE)


def _gripped() -> Tree:
    """Two hinges and a gripper of three links, which don't move in it."""
    draw = np.random.default_rng(34)
    joints = [Joint("revolute"), Joint("revolute", axis=(0.0, 1.0, 0.0)), *[Joint("fixed")] * 3]
    links = tuple(link(draw, "abcde"[k], min(k, 3) - 1, placed(draw, joint)) for k, joint in enumerate(joints))
    return Tree("fixed links of a gripper", links, stated=GRIPPER)


def _with_tool(tree: Tree) -> Tree:
    """An arm: its end is a tool, without mass, beyond the last link."""
    draw = np.random.default_rng(31)
    last = len(tree.links) - 1
    tool = Link("tool", last, (placed(draw, Joint("fixed")),), 0.0, ORIGIN, _NOTHING)
    return replace(tree, links=(*tree.links, tool), asked="arms")


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    aside = shifted(np.random.default_rng(32), 20.0)
    short, other = (_chain(f"chain by {stated}", _SHORT, stated) for stated in (DENAVIT, MODIFIED))
    hinges, mixed = (
        _based("hinges on a turned base", *["revolute"] * 3),
        _based("slide and hinges on a turned base", "prismatic", "revolute", "revolute"),
    )
    bent = _based("slides and hinges", "prismatic", "revolute", "revolute", "prismatic", "revolute", "revolute")
    seven = _based("seven hinges", *["revolute"] * 7)
    six = replace(_based("arm with a tool", *["revolute"] * 6), stated="")
    made = (
        *(replace(one, name=one.name.replace("chain", "hinge"), links=one.links[:1]) for one in (short, other)),
        short,
        other,
        _chain(f"chain by {DENAVIT}, armature", _SHORT, DENAVIT, 0.25),
        _chain(f"chain by {MODIFIED}, armature", _SHORT, MODIFIED, 0.25),
        replace(short, name=f"{short.name}, oblique gravity", gravity=aside),
        replace(other, name=f"{other.name}, oblique gravity", gravity=aside),
        _on_base(short),
        _on_base(other),
        _based("hinge on a turned base", "revolute"),
        hinges,
        mixed,
        replace(hinges, name=f"{hinges.name}, oblique gravity", gravity=aside),
        _gripped(),
        _with_tool(six),
        *(replace(one, name=f"goals of {one.name}", stated="", asked="goals") for one in (six, bent, seven)),
        *(_with_tool(_chain(f"arm by {stated}, with a tool", _ARM, stated)) for stated in (DENAVIT, MODIFIED)),
    )
    return {tree.name: tree for tree in made}
