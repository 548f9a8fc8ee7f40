"""The harness's own table of joint kinds: what each is a series of, and what the simple ones are.

Written apart from the generator's table on purpose: names, sizes and series are checked by their agreement. To add a
kind: a row of `STATED_JOINTS`; engines get the series (docs/architecture.md, "To add").
"""

from __future__ import annotations

from typing import Literal, NamedTuple

PartKind = Literal["revolute", "prismatic", "screw", "ball", "free", "general", "elastic", "section"]
Sampling = Literal["angle", "slide", "deflection", "quaternion", "pose"]


class SimpleJoint(NamedTuple):
    """One kind of simple joint, as engines have them.

    Attributes:
        sampling: Distribution that states are drawn from: an "angle", a "slide", the "deflection" of a beam, a
            "quaternion" uniform on the sphere, or a "pose" of a slide in each direction and a quaternion.
        coordinates: Number of coordinates; of a general joint or a beam, as many as it has; of a section of a beam
            before its tip none, as those of the beam move it.
        speeds: Number of speeds.
    """

    sampling: Sampling
    coordinates: int = 1
    speeds: int = 1


SIMPLE_JOINTS: dict[PartKind, SimpleJoint] = {
    "revolute": SimpleJoint("angle"),
    "prismatic": SimpleJoint("slide"),
    "screw": SimpleJoint("angle"),
    "ball": SimpleJoint("quaternion", 4, 3),
    "free": SimpleJoint("pose", 7, 6),
    "general": SimpleJoint("slide"),
    "elastic": SimpleJoint("deflection"),
    "section": SimpleJoint("deflection", 0, 0),
}


class StatedJoint(NamedTuple):
    """One kind of joint of the description.

    Attributes:
        series: Simple joints from the parent outwards, one a coordinate but for quaternions: kind, and axis as an entry
            of the joint or as x, y, z.
        coordinates: Names of its coordinates after the joint's name; "" for that name alone.
        speeds: Names of its speeds after the joint's name; None where they are the rates of the coordinates.
    """

    series: tuple[tuple[PartKind, str], ...]
    coordinates: tuple[str, ...] = ("",)
    speeds: tuple[str, ...] | None = None


_QUATERNION = ("qx", "qy", "qz", "qw")

STATED_JOINTS: dict[str, StatedJoint] = {
    "fixed": StatedJoint((), ()),
    "revolute": StatedJoint((("revolute", "axis"),)),
    "continuous": StatedJoint((("revolute", "axis"),)),
    "prismatic": StatedJoint((("prismatic", "axis"),)),
    "screw": StatedJoint((("screw", "axis"),)),
    "cylindrical": StatedJoint((("revolute", "axis"), ("prismatic", "axis")), ("angle", "length")),
    "universal": StatedJoint((("revolute", "axis"), ("revolute", "axis2")), ("angle1", "angle2")),
    "planar": StatedJoint((("prismatic", "x"), ("prismatic", "y"), ("revolute", "z")), ("x", "y", "angle")),
    "ball": StatedJoint((("ball", "axis"),), _QUATERNION, ("wx", "wy", "wz")),
    "free": StatedJoint((("free", "axis"),), ("px", "py", "pz", *_QUATERNION), ("vx", "vy", "vz", "wx", "wy", "wz")),
}
