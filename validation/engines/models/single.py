"""Trees of one link that stand for what packages offer beside mechanisms: rotations, mass properties of solids."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..interface import Joint, Link, Rows, Tree, rows, vector
from .readers import IDENTITY, TURNED


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


def trees() -> dict[str, Tree]:
    """All of them, by name."""
    low, high, aside = (0.5, -0.25, 1.0), (1.5, 0.75, 3.0), (1.0, -0.5, 2.0)
    turns = Tree("rotations", (Link("a", -1, (Joint("ball"),)),), asked="turns")
    made = (
        turns,
        *(replace(turns, name=f"rotations, 2^-{near} from none", near=near) for near in (8, 12, 17, 27)),
        _box("box by its sizes", (-0.5, -0.25, -1.0), (0.5, 0.25, 1.0), 2.0),
        _box("box by its corners", low, high, 0.5),
        _box("box by its corners, the other way round", low, high, 0.5),
        _box("box by its triangles", low, high, 0.5),
        _box("box that is moved", low, high, 2.0),
        _box("primitive box", low, high, 2.0, TURNED),
        _box("primitive box by its corners", low, high, 0.5),
        _box("primitive box by its corners, the other way round", low, high, 0.5),
        _ball("primitive ball", 0.5, 1.0, p=aside),
        _ball("primitive ball of a density", 0.5, 2.0, p=aside),
        _cylinder("primitive cylinder", 0.5, 2.0, 1.0, R=TURNED, p=aside),
        _cylinder("primitive cylinder of a density", 0.5, 2.0, 2.0, R=TURNED, p=aside),
        _capsule("primitive capsule", 1.0, 2.0, 1.0, R=TURNED, p=aside),
        _capsule("primitive capsule of a density", 1.0, 2.0, 2.0, R=TURNED, p=aside),
    )
    return {tree.name: tree for tree in made}
