"""Trees of one link that stand for what packages offer beside mechanisms: rotations, mass properties of solids."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..interface import ORIGIN, Joint, Link, Rows, Tree, rows, vector
from ..tree import FEATURES
from ..truth.devices import COMPILED, DEVICES
from .files.readers import IDENTITY, TURNED

# What rotations are near to, and how near: 2^-n, or exactly (0).
_BESIDE = {
    "half turns": (8, 17, 27),
    "half turns about an axis": (12, 27),
    "each other": (12, 27),
    "each other's opposite": (0, 12, 27),
    "one axis": (0,),
}


def _solid(name: str, volume: float, moments: tuple[float, float, float], density: float, **joint: Any) -> Tree:
    """A solid of principal moments, for unit mass, about its middle; its link's joint places it."""
    mass = density * volume
    inertia = np.diag(mass * np.array(moments))
    return Tree(name, (Link("a", -1, (Joint("fixed", **joint),), mass, inertia=rows(inertia)),), asked="solids")


def _box(name: str, low: tuple[float, ...], high: tuple[float, ...], density: float, R: Rows = IDENTITY) -> Tree:
    """A solid between two corners, turned about its middle."""
    size = np.subtract(high, low)
    x, y, z = (float(one) for one in (size @ size - size**2) / 12.0)
    middle = vector(np.add(low, high) / 2.0)
    return _solid(name, float(np.prod(size)), (x, y, z), density, R=R, p=middle)


def _cylinder(name: str, radius: float, length: float, density: float, **joint: Any) -> Tree:
    across = radius**2 / 4.0 + length**2 / 12.0
    volume = math.pi * radius**2 * length
    return _solid(name, volume, (across, across, radius**2 / 2.0), density, **joint)


def _capsule(name: str, radius: float, length: float, density: float, **joint: Any) -> Tree:
    """A cylinder between two halves of a ball, whose mass centres are 3/8 of the radius from its ends."""
    cylinder, ball = math.pi * radius**2 * length, 4.0 / 3.0 * math.pi * radius**3
    volume = cylinder + ball
    across = cylinder * (radius**2 / 4.0 + length**2 / 12.0)
    across += ball * (0.4 * radius**2 + length**2 / 4.0 + 0.375 * radius * length)
    along = cylinder * radius**2 / 2.0 + ball * 0.4 * radius**2
    return _solid(name, volume, (across / volume, across / volume, along / volume), density, **joint)


def _ball(name: str, radius: float, density: float, **joint: Any) -> Tree:
    moment = 0.4 * radius**2
    return _solid(name, 4.0 / 3.0 * math.pi * radius**3, (moment, moment, moment), density, **joint)


def _wheel(name: str, kind: str, **joint: Any) -> Tree:
    """A body on one joint through its mass centre, turned and aside, where nothing pulls at it but what drives it."""
    moments = ((0.25, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 0.25))
    placed = Joint(kind, R=TURNED, p=(0.5, -0.25, 1.0), **joint)
    return Tree(name, (Link("a", -1, (placed,), 2.0, inertia=moments),), ORIGIN, asked="wheels")


def _held(name: str, least: float, greatest: float) -> Tree:
    """A body whose distance from a point of the world is held between two bounds."""
    moments = ((0.25, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 0.25))
    link = Link("a", -1, (Joint("prismatic", axis=(1.0, 0.0, 0.0), limits=(least, greatest)),), 2.0, inertia=moments)
    return Tree(name, (link,), ORIGIN, asked="held distances")


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    low, high, aside = (0.5, -0.25, 1.0), (1.5, 0.75, 3.0), (1.0, -0.5, 2.0)
    turns = Tree("rotations", (Link("a", -1, (Joint("ball"),)),), asked="turns")
    oblique, along = (0.6, 0.0, 0.8), {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    made = (
        _wheel("wheel on a hinge", "revolute", axis=oblique),
        _wheel("wheel on a damped hinge", "revolute", axis=oblique, damping=0.5),
        *(_wheel(f"wheel on a hinge along {x}", "revolute", axis=axis) for x, axis in along.items()),
        _wheel("wheel on a damped hinge along z", "revolute", axis=along["z"], damping=0.5),
        _wheel("body on a slide", "prismatic", axis=oblique),
        _wheel("wheel on a ball", "ball"),
        _wheel("wheel on a ball with dampers", "ball", damping=4.0),
        _held("distance below its bounds", 2.0, 3.0),
        _held("distance beyond its bounds", 0.125, 0.25),
        _held("distance within its bounds", 0.0625, 8.0),
        turns,
        replace(turns, name="vectors", asked="vectors"),
        *(replace(turns, name=group, asked=group) for group in (DEVICES | COMPILED)),
        *(replace(turns, name=name, asked=name) for name in FEATURES),
        *(replace(turns, name=f"rotations, 2^-{near} from none", near=near) for near in (8, 12, 17, 22, 27, 40)),
        *(
            replace(turns, name=f"rotations, {f'2^-{near} from ' if near else ''}{beside}", near=near, beside=beside)
            for beside, nears in _BESIDE.items()
            for near in nears
        ),
        _box("box by its sizes", (-0.5, -0.25, -1.0), (0.5, 0.25, 1.0), 2.0),
        _box("box by its corners", low, high, 0.5),
        _box("box by its corners, the other way round", low, high, 0.5),
        _box("box by its triangles", low, high, 0.5),
        _box("box that is moved", low, high, 2.0),
        _box("primitive box", low, high, 2.0, TURNED),
        _box("primitive box by its corners", low, high, 0.5),
        _box("primitive box by its corners, the other way round", low, high, 0.5),
        _ball("primitive sphere", 0.5, 1.0, p=aside),
        _ball("primitive sphere of a density", 0.5, 2.0, p=aside),
        _cylinder("primitive cylinder", 0.5, 2.0, 1.0, R=TURNED, p=aside),
        _cylinder("primitive cylinder of a density", 0.5, 2.0, 2.0, R=TURNED, p=aside),
        _capsule("primitive capsule", 1.0, 2.0, 1.0, R=TURNED, p=aside),
        _capsule("primitive capsule of a density", 1.0, 2.0, 2.0, R=TURNED, p=aside),
    )
    return {tree.name: tree for tree in made}
