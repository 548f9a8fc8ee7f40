"""The joint kinds: one row a kind with every fact about it that is not mechanics.

Sizes and names of coordinates and speeds, the part of the configuration manifold, entries of the description, what the
exchange formats call it, how the editor and the viewer draw it. To add a kind: its name in `JointKindName`, a row of
`_ROWS`, its displacement in `symofros/mechanics/kinematics/joint.py`, a row of the harness's own table
(`validation/mechanics/joint_kinds.py`); then regenerate schema and page. docs/architecture.md, "To add", has the steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

from symofros.base.manifold import ManifoldKind

JointKindName = Literal[
    "fixed",
    "revolute",
    "continuous",
    "prismatic",
    "screw",
    "cylindrical",
    "universal",
    "planar",
    "ball",
    "free",
    "general",
]
JOINT_KINDS: tuple[JointKindName, ...] = get_args(JointKindName)

Measure = Literal["angle", "length", "component"]
AxisName = Literal["axis", "axis2", "x", "y", "z"]
# Entries that only some kinds have: geometry by parameters alone, and others.
ConstantEntry = Literal["axis", "axis2", "pitch"]
Entry = ConstantEntry | Literal["limits", "coordinates", "moving_position", "moving_rotation"]
CONSTANT_ENTRIES: tuple[ConstantEntry, ...] = get_args(ConstantEntry)
Symbol = Literal["cylinder", "box", "sphere", "disc"]


class Coordinate(NamedTuple):
    """One coordinate of a joint.

    Attributes:
        suffix: Name after the joint's name and a dot; "" where the coordinate bears the joint's name.
        measure: "angle" [rad], periodic; "length" [m]; or "component" of a unit quaternion.
        axis: Axis it turns about or slides along, where that is all it does: an entry of the joint, or x, y, z of the
            frame that the coordinates before it lead to; None otherwise.
    """

    suffix: str
    measure: Measure
    axis: AxisName | None = None

    @property
    def unit(self) -> str:
        """SI unit; "" for a component of a quaternion."""
        return {"angle": "rad", "length": "m", "component": ""}[self.measure]


@dataclass(frozen=True)
class JointKind:
    """One kind of joint.

    Attributes:
        name: Value of the entry `kind`.
        summary: One line for people.
        coordinates: Coordinates in order; empty for the general joint, whose coordinates are the user's.
        glyph: SVG path in a square of 16, for the editor.
        speed_suffixes: Names of the speeds; None where the speeds are the rates of the coordinates.
        manifold: "linear" (q' = v), "quaternion" (q a unit quaternion, v the angular velocity in D) or "pose" (position
            and unit quaternion, linear and angular velocity in D).
        entries: Entries of the description that say how this kind moves.
        turns_about: The only axis that the joint turns about, constant in P and in D; None if there are more or none.
        urdf: Type in URDF of a single joint of this kind; None where URDF has none.
        mjcf: Type in MJCF of a single joint of this kind; None where MJCF has none.
        symbol: Solid that the viewer marks it by; None: no mark.
        slides: Whether the viewer draws a line from Po to Do.
    """

    name: JointKindName
    summary: str
    coordinates: tuple[Coordinate, ...]
    glyph: str
    speed_suffixes: tuple[str, ...] | None = None
    manifold: ManifoldKind = "linear"
    entries: tuple[Entry, ...] = ()
    turns_about: Literal["axis", "z"] | None = None
    urdf: str | None = None
    mjcf: str | None = None
    symbol: Symbol | None = None
    slides: bool = False

    @property
    def coordinate_suffixes(self) -> tuple[str, ...]:
        """Names of the coordinates after the joint's name."""
        return tuple(coordinate.suffix for coordinate in self.coordinates)

    @property
    def angles(self) -> tuple[bool, ...]:
        """Which coordinates are periodic."""
        return tuple(coordinate.measure == "angle" for coordinate in self.coordinates)

    @property
    def nv(self) -> int:
        """Number of speeds."""
        return len(self.coordinates if self.speed_suffixes is None else self.speed_suffixes)

    @property
    def quasi_velocities(self) -> bool:
        """Whether the speeds are other than the rates of the coordinates."""
        return self.manifold != "linear"

    @property
    def user_defined(self) -> bool:
        """Whether the user states coordinates, position and rotation."""
        return "coordinates" in self.entries

    @property
    def aligned(self) -> bool:
        """Whether P and D are turned so that a constant axis lies along a coordinate axis."""
        return "axis" in self.entries and "axis2" not in self.entries

    @property
    def series(self) -> bool:
        """Whether the joint is a series of turns and slides, one a coordinate: what formats without formulas hold."""
        return not self.user_defined and all(coordinate.axis for coordinate in self.coordinates)

    @property
    def translates(self) -> bool:
        """Whether some coordinate shifts the body without turning it, so that a mass is needed and no inertia helps."""
        return any(coordinate.measure == "length" for coordinate in self.coordinates)


_QUATERNION = tuple(Coordinate(suffix, "component") for suffix in ("qx", "qy", "qz", "qw"))
_POSITION = tuple(Coordinate(suffix, "length") for suffix in ("px", "py", "pz"))
_SPIN = ("wx", "wy", "wz")

_ROWS: tuple[JointKind, ...] = (
    JointKind(
        name="fixed",
        summary="no motion",
        coordinates=(),
        glyph="M3 3v10M3 4l3-2M3 8l3-2M3 12l3-2M3 8h10",
        urdf="fixed",
    ),
    JointKind(
        name="revolute",
        summary="angle about axis",
        coordinates=(Coordinate("", "angle", "axis"),),
        glyph="M12.5 9.5A5 5 0 1 1 11.6 4.5M11.8 1.6v3.2H8.6M8 8h.01",
        entries=("axis", "limits"),
        turns_about="axis",
        urdf="revolute",
        mjcf="hinge",
        symbol="cylinder",
    ),
    JointKind(
        name="continuous",
        summary="angle about axis, without limits",
        coordinates=(Coordinate("", "angle", "axis"),),
        glyph="M13 8A5 5 0 1 1 8 3M8 .9 10.3 3 8 5.1M8 8h.01",
        entries=("axis",),
        turns_about="axis",
        urdf="continuous",
        mjcf="hinge",
        symbol="cylinder",
    ),
    JointKind(
        name="prismatic",
        summary="length along axis",
        coordinates=(Coordinate("", "length", "axis"),),
        glyph="M1.5 8h13M4 5.5 1.5 8 4 10.5M12 5.5 14.5 8 12 10.5M5.5 5h5v6h-5z",
        entries=("axis", "limits"),
        urdf="prismatic",
        mjcf="slide",
        symbol="box",
        slides=True,
    ),
    JointKind(
        name="screw",
        summary="angle about axis, with a shift along it of pitch times the angle",
        coordinates=(Coordinate("", "angle"),),
        glyph="M8 1.5v13M5 4.5l6-2M5 8l6-2M5 11.5l6-2",
        entries=("axis", "pitch", "limits"),
        turns_about="axis",
        symbol="cylinder",
        slides=True,
    ),
    JointKind(
        name="cylindrical",
        summary="angle about axis, then length along it",
        coordinates=(Coordinate("angle", "angle", "axis"), Coordinate("length", "length", "axis")),
        glyph="M4 4.5v7c0 1.2 8 1.2 8 0v-7M4 4.5c0 1.2 8 1.2 8 0s-8-1.2-8 0M8 1v1.5",
        entries=("axis",),
        turns_about="axis",
        symbol="cylinder",
        slides=True,
    ),
    JointKind(
        name="universal",
        summary="angle about axis, then angle about axis2",
        coordinates=(Coordinate("angle1", "angle", "axis"), Coordinate("angle2", "angle", "axis2")),
        glyph="M8 1.5v4M8 10.5v4M1.5 8h4M10.5 8h4M5.5 8a2.5 2.5 0 1 0 5 0 2.5 2.5 0 1 0-5 0",
        entries=("axis", "axis2"),
        symbol="sphere",
    ),
    JointKind(
        name="planar",
        summary="x and y in P, then the angle about z",
        coordinates=(
            Coordinate("x", "length", "x"),
            Coordinate("y", "length", "y"),
            Coordinate("angle", "angle", "z"),
        ),
        glyph="M1.5 11.5 5 5h9.5L11 11.5zM8 8h.01",
        turns_about="z",
        symbol="disc",
        slides=True,
    ),
    JointKind(
        name="ball",
        summary="quaternion (x, y, z, w); angular velocity in D",
        coordinates=_QUATERNION,
        glyph="M4.5 9.5a4 4 0 1 0 7 0M8 8.5V14M3 14h10",
        speed_suffixes=_SPIN,
        manifold="quaternion",
        mjcf="ball",
        symbol="sphere",
    ),
    JointKind(
        name="free",
        summary="position in P and quaternion; linear and angular velocity in D",
        coordinates=(*_POSITION, *_QUATERNION),
        glyph="M8 8V2M8 8l5 3.5M8 8l-5 3.5M6.5 3.5 8 2l1.5 1.5M11 11.7l2-.2-.4-2M5 11.7l-2-.2.4-2",
        speed_suffixes=("vx", "vy", "vz", *_SPIN),
        manifold="pose",
        urdf="floating",
        mjcf="free",
    ),
    JointKind(
        name="general",
        summary="position and rotation by formulas of the user's own coordinates",
        coordinates=(),
        glyph="M3 11c2-8 3-8 5-3s3 5 5-3M3 13.5h10",
        entries=("coordinates", "moving_position", "moving_rotation"),
        symbol="sphere",
    ),
)

KINDS: dict[str, JointKind] = {row.name: row for row in _ROWS}
