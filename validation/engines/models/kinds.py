"""One small tree for each kind of joint: the joint between two links, where nothing is aligned that need not be."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import fsum

import mpmath
import numpy as np

from ..interface import Joint, Link, Rows, Tree, Vector, rows, vector


def turned(draw: np.random.Generator) -> Rows:
    """A random rotation: of LAPACK's QR decomposition, in digits that no processor and no library changes."""
    with mpmath.workdps(40):
        Q, _ = mpmath.qr(mpmath.matrix(draw.normal(size=(3, 3)).tolist()))
        return rows(np.array((Q * mpmath.sign(mpmath.det(Q))).tolist(), dtype=float))


def shifted(draw: np.random.Generator, size: float = 0.5) -> Vector:
    """A random vector."""
    return vector(draw.uniform(-size, size, 3))


def inertia(draw: np.random.Generator, size: float = 0.1) -> Rows:
    """Moments of inertia about the mass centre that a body can have, along axes that are not principal ones."""
    spread = draw.uniform(0.2, 1.0, 3)
    principal = size * (sum(spread) - spread)
    R = np.array(turned(draw))
    # Symmetric to the bit, and each sum is rounded once: those of BLAS depend on the processor.
    return rows(np.array([[fsum(R[i] * R[j] * principal) for j in range(3)] for i in range(3)]))


def link(draw: np.random.Generator, name: str, parent: int, *joints: Joint) -> Link:
    """A link of about a kilogram, with an offset mass centre and rotated inertia."""
    return Link(name, parent, joints, float(draw.uniform(0.5, 2.0)), shifted(draw, 0.2), inertia(draw))


def placed(draw: np.random.Generator, joint: Joint) -> Joint:
    """The joint at an oblique placement."""
    return replace(joint, R=turned(draw), p=shifted(draw))


@dataclass(frozen=True)
class Kind:
    """A kind of joint.

    Attributes:
        joints: The joint, or those in series that make it.
        grounded: Whether it stands in the world, unplaced, as free joints must in some engines.
    """

    joints: tuple[Joint, ...]
    grounded: bool = False


OBLIQUE: Vector = (2 / 3, -1 / 3, 2 / 3)
_X: Vector = (1.0, 0.0, 0.0)
_Y: Vector = (0.0, 1.0, 0.0)
_Z: Vector = (0.0, 0.0, 1.0)
_ACROSS: Rows = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))

KINDS: dict[str, Kind] = {
    "revolute x": Kind((Joint("revolute", axis=_X),)),
    "revolute y": Kind((Joint("revolute", axis=_Y),)),
    "revolute z": Kind((Joint("revolute", axis=_Z),)),
    "revolute oblique": Kind((Joint("revolute", axis=OBLIQUE),)),
    "revolute unbounded": Kind((Joint("revolute", axis=_Y, form="unbounded"),)),
    "revolute unbounded oblique": Kind((Joint("revolute", axis=OBLIQUE, form="unbounded"),)),
    "prismatic": Kind((Joint("prismatic", axis=_X),)),
    "prismatic oblique": Kind((Joint("prismatic", axis=OBLIQUE),)),
    "helical": Kind((Joint("helical", axis=_Z, pitch=0.25),)),
    "helical oblique": Kind((Joint("helical", axis=OBLIQUE, pitch=0.25),)),
    "universal": Kind((Joint("universal", axis=_X, second=_Y),)),
    "ball": Kind((Joint("ball"),)),
    "euler zyx": Kind((Joint("euler", sequence="ZYX"),)),
    "translation": Kind((Joint("translation"),)),
    "planar": Kind((Joint("planar"),)),
    "free": Kind((Joint("free"),), grounded=True),
    "ellipsoid": Kind((Joint("ellipsoid", radii=(0.3, 0.2, 0.4)),)),
    "ellipsoid of revolution": Kind((Joint("ellipsoid", radii=(0.3, 0.3, 0.3)),)),
    "free between links": Kind((Joint("free"),)),
    "cylindrical": Kind((Joint("prismatic", axis=_Z), Joint("revolute", axis=_Z))),
    "three hinges": Kind((Joint("revolute", axis=_X), Joint("revolute", axis=_Y), Joint("revolute", axis=_Z))),
    "two slides and a hinge": Kind(
        (Joint("prismatic", axis=_X), Joint("prismatic", axis=_Y), Joint("revolute", axis=_Z))
    ),
    "slide and ball": Kind((Joint("prismatic", axis=_X), Joint("ball"))),
    "translation and euler zyx": Kind((Joint("translation"), Joint("euler", sequence="ZYX"))),
    "offset hinges": Kind(
        (Joint("revolute", axis=_X), Joint("revolute", axis=OBLIQUE, R=_ACROSS, p=(0.25, 0.5, -0.125)))
    ),
    "euler xyz": Kind((Joint("euler", sequence="XYZ"),)),
    "revolute with armature": Kind((Joint("revolute", axis=_Y, armature=(0.75,)),)),
    "universal with armature": Kind((Joint("universal", axis=_X, second=_Y, armature=(0.75, 0.75)),)),
    "planar with armature": Kind((Joint("planar", armature=(0.75,) * 3),)),
    "mimic revolute": Kind((Joint("revolute", axis=_Y, mimics="a", ratio=1.5, offset=0.25),)),
    "mimic oblique": Kind((Joint("revolute", axis=OBLIQUE, mimics="a", ratio=-0.5, offset=0.25),)),
    "mimic prismatic": Kind((Joint("prismatic", axis=_Y, mimics="a", ratio=0.5, offset=0.25),)),
}


def tree_of(name: str) -> Tree:
    """The tree of a kind: a link on an oblique hinge, the joint, and a link on another hinge beyond."""
    kind = KINDS[name]
    draw = np.random.default_rng([ord(letter) for letter in name])
    joints = kind.joints if kind.grounded else (placed(draw, kind.joints[0]), *kind.joints[1:])
    if kind.grounded:
        return Tree(
            name, (link(draw, "a", -1, *joints), link(draw, "b", 0, placed(draw, Joint("revolute", axis=OBLIQUE))))
        )
    first = link(draw, "a", -1, placed(draw, Joint("revolute", axis=_X)))
    last = link(draw, "c", 1, placed(draw, Joint("revolute", axis=OBLIQUE)))
    return Tree(name, (first, link(draw, "b", 0, *joints), last))
