"""Trees that cover each pair of features of joints, links and what acts on them, for engines held to the truth.

A tree has a root, on a hinge or free, and chains of links; two families, by what is asked of them: motion, and forces
of its own with sensors. Features that few engines know come last.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ...interface import IDENTITY, ORIGIN, Activation, Actuator, End, Joint, Link, Tendon, Tree
from ..kinds import KINDS, OBLIQUE, link, placed, shifted, turned
from .pairs import Table, covering, levels

_BEYOND = " beyond"
_SPEEDS = {"ball": 3, "planar": 3, "translation": 3, "euler": 3, "ellipsoid": 3, "universal": 2, "free": 6}
_PLAIN = ("revolute oblique", "prismatic oblique")
# Names of `KINDS` that MuJoCo has, that Drake and DART have, that Pinocchio has.
_SERIES = ("cylindrical", "offset hinges", "slide and ball")
_OWN = ("universal", "planar", "helical oblique", "free between links")
_RARE = ("euler zyx", "translation", "revolute unbounded", "ellipsoid")
_MIMIC = "mimic oblique" + _BEYOND
_BASE = {"root on a hinge": (Joint("revolute", axis=OBLIQUE),), "free base": (Joint("free"),)}
_GRAVITY = {"weight": (0.0, 0.0, -9.81), "oblique gravity": (3.0, -6.0, 2.0)}


def _joints(*names: str, after: str = "") -> dict[str, tuple[Joint, ...]]:
    """Names of kinds, and of the plain ones -> their joints."""
    return {name + after: KINDS[name].joints for name in (*_PLAIN, *names)}


_BEHIND = _joints("ball", "mimic oblique", after=_BEYOND) | {"fixed" + _BEYOND: (Joint("fixed"),)}
_PASSIVE: Mapping[str, Mapping[str, Any]] = {
    "loose": {},
    "damper": {"damping": 0.75},
    "spring": {"stiffness": 3.0, "rest": 0.25},
    "sprung damper": {"damping": 0.5, "stiffness": 2.0, "rest": -0.5},
    "gravity compensation": {},
    "force limits": {"force_limits": (-0.125, 0.25)},
}
_DRIVES = {
    "not driven": None,
    "motor": Actuator(gain=2.0, control=0.75),
    "motor with gear": Actuator(gear=3.0, control=0.75),
    "servo with gear": Actuator(gear=0.5, gain=3.0, bias=(0.25, -3.0, -0.5), control=0.5),
    "gain of speed": Actuator(gear=0.5, slopes=(-0.5, -1.0), control=0.75),
    "control beyond limits": Actuator(gear=-1.5, control=2.0, control_limits=(-1.0, 1.0)),
    "force limited": Actuator(gear=2.0, gain=6.0, control=0.75, force_limits=(-0.5, 0.25)),
    "integrator": Actuator(gear=3.0, activation=Activation("integrator", 0.25)),
    "filter": Actuator(gear=2.0, control=0.5, activation=Activation("filter", 0.375, (0.125,))),
    "filter with actearly": Actuator(
        control=0.5, activation=Activation("exact filter", 0.375, (0.125,), is_early=True)
    ),
}
_FEW = (*tuple(_PASSIVE)[4:], *tuple(_DRIVES)[2:])
_LINES = {"no tendon": 0.0, "sum": 0.0, "path": 0.0, "path with inertia": 0.5}


class _Family(NamedTuple):
    """Trees of one kind, by tables of their features (`pairs.covering`).

    Attributes:
        chains: Number of chains.
        options: See `pairs.covering`; so with the others.
    """

    name: str
    chains: int
    options: Table[Any]
    chain: Table[Any]
    rare: Sequence[Sequence[str]]
    never: Mapping[str, Sequence[str]]


_ARMED = ("armature", "armature" + _BEYOND)
_BALL = "ball" + _BEYOND
_ARMATURE = dict.fromkeys(("no armature", *_ARMED))
_MOTION = _Family(
    "chain",
    1,
    {"base": _BASE, "gravity": _GRAVITY},
    {
        "joint": _joints("ball", *_SERIES, *_OWN, *_RARE),
        "second joint": _BEHIND,
        "placement": dict.fromkeys(("oblique placement", "at the origin", "shifted", "turned")),
        "mass": dict.fromkeys(("oblique mass", "mass at the origin", "spherical inertia")),
        "armature": _ARMATURE,
    },
    (
        ("ball", _BALL, *_SERIES, *_OWN, *_RARE, _MIMIC, *_ARMED),
        (*_SERIES, *_OWN, *_RARE, _MIMIC),
        (*_OWN, *_RARE, _MIMIC),
        (*_SERIES, *_RARE, _MIMIC),
        (*_SERIES, *_OWN),
    ),
    {_MIMIC: ("free base", _ARMED[1]), "fixed" + _BEYOND: _ARMED[1:]},
)
_TENDONS = tuple(_LINES)[1:]
_FORCES = _Family(
    "forces",
    2,
    {"base": _BASE, "sensors": dict.fromkeys(("no sensors", "sensors"))},
    {
        "joint": _joints("ball"),
        "second joint": _joints(after=_BEYOND),
        "passive": _PASSIVE,
        "armature": _ARMATURE,
        "drive": _DRIVES,
        "way": dict.fromkeys(("at a joint", "by a tendon")),
        "line": _LINES,
    },
    (
        ("ball", *_FEW, *_ARMED, *_TENDONS, "by a tendon"),
        (*_FEW, *_TENDONS, "by a tendon"),
        ("filter with actearly", "filter", "integrator", "path with inertia"),
        (),
    ),
    # Armature is an actuator of its own in Drake; steps that are asked for on the way change activations.
    {
        "motor": ("sensors", *_ARMED),
        "sensors": ("integrator", "filter", "filter with actearly"),
        "by a tendon": ("no tendon",),
        "ball": ("spring", "sprung damper", "force limits"),
    },
)


def _link(draw: np.random.Generator, name: str, parent: int, joints: Sequence[Joint], own: Mapping[str, str]) -> Link:
    """A link of a chain; the second of it has features of its own."""
    beyond = _BEYOND if name[0] == "c" else ""
    first, *rest = joints
    place = own.get("placement", "")
    first = placed(draw, first)
    if place in ("at the origin", "shifted"):
        first = replace(first, R=IDENTITY)
    if place in ("at the origin", "turned"):
        first = replace(first, p=ORIGIN)
    all_joints = [first, *rest]
    if own.get("armature") == "armature" + beyond:
        all_joints = [replace(one, armature=(0.75,) * _SPEEDS.get(one.kind, 1)) for one in all_joints]
    passive = {} if first.kind == "fixed" else _PASSIVE[own.get("passive", "loose")]
    all_joints[-1] = replace(all_joints[-1], **passive)
    made = replace(
        link(draw, name, parent, *all_joints), compensation=0.75 * (own.get("passive") == "gravity compensation")
    )
    match own.get("mass"):
        case "mass at the origin":
            return replace(made, com=ORIGIN)
        case "spherical inertia":
            return replace(made, inertia=((0.125, 0.0, 0.0), (0.0, 0.125, 0.0), (0.0, 0.0, 0.125)))
    return made


def _tree(family: _Family, name: str, features: Sequence[str]) -> Tree:
    """The tree of some features."""
    draw = np.random.default_rng([ord(letter) for letter in name])
    whole = levels(family.options, features)
    (joint,) = _BASE[whole["base"]]
    links = [link(draw, "a", -1, joint if joint.kind == "free" else placed(draw, joint))]
    owns = []
    for k in range(family.chains):
        own = levels(family.chain, [one.partition(": ")[2] for one in features if one.startswith(f"{k}: ")])
        links.append(_link(draw, f"b{k}", 0, family.chain["joint"][own["joint"]], own))
        links.append(_link(draw, f"c{k}", len(links) - 1, family.chain["second joint"][own["second joint"]], own))
        owns.append(own)
    tree = Tree(name, tuple(links), _GRAVITY[whole.get("gravity", "weight")])
    if "sensors" in whole:
        tree = _acted_on(draw, tree, owns)
    if whole.get("sensors") == "sensors":
        tree = replace(tree, sensors=tuple(End(one.name, turned(draw), shifted(draw, 0.3)) for one in links))
    return replace(tree, features=tuple(features))


def _acted_on(draw: np.random.Generator, tree: Tree, owns: Sequence[Mapping[str, str]]) -> Tree:
    """The tree with tendons and actuators of its chains."""
    tendons: list[Tendon] = []
    actuators: list[Actuator] = []
    for k, own in enumerate(owns):
        sprung = Tendon("", (), stiffness=3.0, damping=0.5, rest=0.25, armature=_LINES[own["line"]])
        if own["line"] == "sum":
            tendons.append(replace(sprung, kind="coupling", ends=(End(f"c{k}"),), coefficients=(0.75,)))
        elif own["line"] != "no tendon":
            points = (End(one, p=shifted(draw, 0.3)) for one in ("", f"b{k}", f"c{k}"))
            tendons.append(replace(sprung, kind="path", ends=tuple(points)))
        drive = _DRIVES[own["drive"]]
        if drive is not None:
            by_tendon = {"tendon": len(tendons) - 1} if own["way"] == "by a tendon" else {"link": f"c{k}"}
            actuators.append(replace(drive, **by_tendon))
    return replace(tree, tendons=tuple(tendons), actuators=tuple(actuators))


@cache
def trees() -> Mapping[str, Tree]:
    """All of them, by name."""
    made = {}
    for family in (_MOTION, _FORCES):
        never = {frozenset((one, other)) for one, others in family.never.items() for other in others}
        found = covering(family.options, family.chain, family.chains, family.rare, never)
        for number, features in enumerate(found):
            name = f"{family.name} {number + 1}: {', '.join(features)}"
            made[name] = _tree(family, name, features)
    return made
