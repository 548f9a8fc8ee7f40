"""Joints of UsdPhysics: how a body moves on another one, or what closes a loop.

A joint has a frame J0 on its first body and a frame J1 on its second; where its coordinates are zero they are one. A
tree's joint goes from the parent A to the child C, which may be either: with the second as the parent its axis is
turned round. P lies at A's joint frame with the axes that C has there; where C's joint frame is elsewhere than C, and
the joint turns, a massless body at the joint carries C.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from symofros.base.arrays import Array
from symofros.description.closing import BLOCKED
from symofros.description.constraints import Closure, Constraint, Rod
from symofros.description.forces import Anchor
from symofros.description.frames import Frame, Pose
from symofros.description.imported.geometry import Exact
from symofros.description.imported.tree import ImportedJoint, Placement, Resistance
from symofros.description.joints.joint import WORLD, Joint, Limits
from symofros.description.joints.joint_kinds import JointKindName
from symofros.description.remarks import Remarks
from symofros.description.usd.masses import Units

Motion = Literal["fixed", "revolute", "prismatic", "cylindrical", "planar", "ball", "none"]
_AXIS = {"X": 0, "Y": 1, "Z": 2}
_FREEDOMS = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
# Entries that extensions of UsdPhysics have for the same, the first that is authored counts.
_ARMATURE = ("physxJoint:armature", "newton:armature")
_VELOCITY = ("physxJoint:maxJointVelocity", "newton:velocityLimit")
_COEFFICIENT = "physxJoint:jointFriction"


@dataclass(frozen=True)
class UsdJoint:
    """A joint of the stage.

    Attributes:
        name: Its name here.
        row: What the stage states of it.
        motion: What it lets its second body do on the first.
        axis: Index of its axis in the joint's frame; of a planar joint its normal.
        bounds: Least and greatest coordinate, in the stage's units; infinite where there is none.
        ends: Bodies, by path; "" for the world.
        frames: J0 in the first body, J1 in the second.
        where: Place in the file.
    """

    name: str
    row: Mapping[str, Any]
    motion: Motion
    axis: int
    bounds: tuple[float, float]
    ends: tuple[str, str]
    frames: tuple[Pose, Pose]
    where: str


def motion_of(row: Mapping[str, Any]) -> tuple[Motion, int, tuple[float, float]] | str:
    """Free motion of a joint, index of its axis, and its bounds; or the reason why it can't be read."""
    axis, kind = _AXIS[row["axis"] or "X"], row["kind"]
    bounds = number(row["lower"], -math.inf), number(row["upper"], math.inf)
    if kind == "fixed":
        return "fixed", axis, (-math.inf, math.inf)
    if kind == "spherical":
        return "ball", axis, (-math.inf, math.inf)
    if kind in ("revolute", "prismatic"):
        return kind, axis, bounds
    return _of_freedoms(row["limits"]) if kind == "d6" else f"its type is '{kind}'"


def _of_freedoms(limits: Mapping[str, Any]) -> tuple[Motion, int, tuple[float, float]] | str:
    """The same of a joint by its degrees of freedom, each of which a limit with low above high locks."""
    bounds = {name: (number(low, -math.inf), number(high, math.inf)) for name, (low, high) in limits.items()}
    if any(low == high != 0.0 for low, high in bounds.values()):
        return "a degree of freedom is held at another place than zero"
    free = [name for name in _FREEDOMS if name not in bounds or bounds[name][0] < bounds[name][1]]
    slides, turns = ([_AXIS[name[-1]] for name in free if name.startswith(kind)] for kind in ("trans", "rot"))
    unbounded = (-math.inf, math.inf)
    if not free:
        return "fixed", 0, unbounded
    if len(free) == 1:
        return "prismatic" if slides else "revolute", (slides or turns)[0], bounds.get(free[0], unbounded)
    if len(free) == 6:
        return "none", 0, unbounded
    if len(turns) == 3 and not slides:
        return "ball", 0, unbounded
    if len(turns) == 1 and slides == turns:
        return "cylindrical", turns[0], unbounded
    if len(turns) == 1 and len(slides) == 2 and turns[0] not in slides:
        return "planar", turns[0], unbounded
    return f"its free directions are {', '.join(free)}, for which UsdPhysics names no coordinates"


def number(value: Any, default: float) -> float:
    """A number of the stage; infinities are stated by their names."""
    return default if value is None else float(value)


class JointMaker:
    """Makes joints and constraints of the stage's.

    Args:
        units: Units of the stage.
        exact: Makes numbers exact.
        remarks: Remarks on what is left out.
        driven_only: Whether joints without a drive are passive: where the stage has drives.
    """

    def __init__(self, units: Units, exact: Exact, remarks: Remarks, driven_only: bool) -> None:
        self.units, self.exact, self.remarks, self.driven_only = units, exact, remarks, driven_only

    def placed(self, joint: UsdJoint, is_reversed: bool) -> tuple[ImportedJoint, Placement | None]:
        """A joint of the tree, and the child C in its frame D; None where that is C's own.

        Args:
            joint: The joint.
            is_reversed: Whether its second body is the parent.
        """
        own, other = joint.frames[::-1] if is_reversed else joint.frames
        kind: JointKindName = joint.motion if joint.motion != "none" else "free"
        e = np.eye(3)[joint.axis] * (-1.0 if is_reversed else 1.0)
        if kind == "planar":
            # The coordinates lie along x and y of P, the normal along z: the child may have other axes.
            turned = Pose(np.zeros(3), _with_z(np.eye(3)[joint.axis]))
            own, other = own @ turned, other @ turned
            position, rotation = self.exact.placement(own.p, own.R)
            if self._armature(joint):
                self.remarks.add("armature of planar joints ignored", "joint", joint.name)
            made = Joint(joint.name, kind, position=position, rotation=rotation)
            return ImportedJoint(made, self._resistances(joint, 3)), self._held(other.inverse())
        R = own.R @ other.R.T
        axis = self.exact.direction(other.R @ e)
        if kind in ("fixed", "prismatic"):  # A shift is the same wherever it is anchored.
            position, rotation = self.exact.placement(own.p - R @ other.p, R)
            held = None
        else:
            position, rotation = self.exact.placement(own.p, R)
            held = self._held(Pose(-other.p, np.eye(3)))
        if kind in ("fixed", "ball"):
            armature = self._armature(joint) if kind == "ball" else 0.0
            made = Joint(joint.name, kind, position=position, rotation=rotation, armature=armature)
            return ImportedJoint(made, self._resistances(joint, 3) if kind == "ball" else ()), held
        if kind == "revolute" and joint.bounds == (-math.inf, math.inf):
            kind = "continuous"
        made = Joint(
            joint.name,
            kind,
            WORLD,
            None,
            position,
            rotation,
            axis,
            actuated=kind != "cylindrical" and self._is_actuated(joint),
            limits=self._limits(joint, kind) if kind in ("revolute", "prismatic") else None,
            armature=self._armature(joint),
        )
        return ImportedJoint(made, self._resistances(joint, made.traits.nv)), held

    def _held(self, pose: Pose) -> Placement | None:
        """A body's place in the frame that its joint moves; None where it is that frame."""
        position, rotation = self.exact.placement(pose.p, pose.R)
        return (position, rotation) if any(position) or not rotation.is_identity else None

    def closing(self, joint: UsdJoint, names: tuple[str, str], on: dict[str, list[Frame]]) -> Constraint:
        """The closure of a joint that no tree needs.

        Args:
            joint: The joint.
            names: Names of its bodies.
            on: Takes the frames that it stands on, by body.
        """
        self.remarks.add("joints that close loops have no coordinate, input, damper or limit", "joint", joint.name)
        turned = Pose(np.zeros(3), _with_z(np.eye(3)[joint.axis]))
        first, second = self._anchors(joint, names, [pose @ turned for pose in joint.frames], on)
        return Closure(joint.name, first, second, *BLOCKED[joint.motion])

    def rod(self, joint: UsdJoint, names: tuple[str, str], length: float, on: dict[str, list[Frame]]) -> Constraint:
        """A joint that keeps a distance.

        Args:
            joint: The joint.
            names: Names of its bodies.
            length: The distance, in the stage's unit.
            on: Takes the frames that it stands on, by body.
        """
        first, second = self._anchors(joint, names, [Pose(pose.p, np.eye(3)) for pose in joint.frames], on)
        return Rod(joint.name, first, second, length * self.units.meters)

    def _anchors(
        self, joint: UsdJoint, names: tuple[str, str], poses: Sequence[Pose], on: dict[str, list[Frame]]
    ) -> Iterator[Anchor]:
        """Frames of a constraint on its two bodies."""
        for name, pose, label in zip(names, poses, ("first", "second"), strict=True):
            frame = Frame(f"{joint.name}_{label}", *self.exact.placement(pose.p, pose.R))
            on.setdefault(name, []).append(frame)
            yield name, frame.name

    def _is_actuated(self, joint: UsdJoint) -> bool:
        drives = joint.row["drives"]
        if not drives:
            return not self.driven_only
        self.remarks.add("gains and targets of drives ignored: efforts are inputs", "joint", joint.name)
        return any(number(drive["maxForce"], math.inf) > 0.0 for drive in drives.values())

    def _limits(self, joint: UsdJoint, kind: JointKindName) -> Limits:
        unit = math.radians(1.0) if kind == "revolute" else self.units.meters
        lower, upper = (bound * unit if math.isfinite(bound) else None for bound in joint.bounds)
        forces = [number(drive["maxForce"], math.inf) for drive in joint.row["drives"].values()]
        if "urdf:limit:effort" in joint.row["extensions"]:  # As the URDF had it: in SI units.
            effort = float(joint.row["extensions"]["urdf:limit:effort"])
        else:
            effort = min(forces, default=math.inf) * self._effort(kind)
        velocity = _first(joint, _VELOCITY)
        speed = math.inf if velocity is None else velocity * unit
        return Limits(lower, upper, self._size(joint, "speed", speed), self._size(joint, "effort", effort))

    def _size(self, joint: UsdJoint, what: str, bound: float) -> float | None:
        """A limit of a size; none where it is infinite, or negative, by which some mean none."""
        if bound < 0.0:
            self.remarks.add(f"negative limits of {what} taken for none", "joint", joint.name)
        return bound if 0.0 <= bound < math.inf else None

    def _effort(self, kind: str) -> float:
        """Newtons, or newton metres, in the stage's unit of efforts."""
        return self.units.kilograms * self.units.meters ** (1 if kind == "prismatic" else 2)

    def _armature(self, joint: UsdJoint) -> float:
        stated = _first(joint, _ARMATURE) or 0.0
        return stated * (self.units.kilograms if joint.motion == "prismatic" else self.units.inertia)

    def _resistances(self, joint: UsdJoint, speeds: int) -> tuple[Resistance, ...]:
        """Damping and friction, which extensions state of joints of one coordinate."""
        damping, friction = (_first(joint, (name,)) or 0.0 for name in ("newton:damping", "newton:friction"))
        if _first(joint, (_COEFFICIENT,)):
            self.remarks.add("friction coefficients of joints ignored, which scale with the load", "joint", joint.name)
        if speeds > 1:
            for what, value in (("damping", damping), ("dry friction", friction)):
                if value:
                    self.remarks.add(f"{what} of joints of several coordinates ignored", "joint", joint.name)
            return ()
        turns = joint.motion != "prismatic"
        per_unit = math.degrees(1.0) * self.units.inertia if turns else self.units.kilograms
        return (Resistance(damping=damping * per_unit, friction=friction * self._effort(joint.motion)),)


def _first(joint: UsdJoint, names: tuple[str, ...]) -> float | None:
    """The first of some entries of extensions that is stated."""
    stated = (joint.row["extensions"].get(name) for name in names)
    return next((float(value) for value in stated if value is not None), None)


def _with_z(z: Array) -> Array:
    """The rotation (3, 3) that permutes the axes so that the third one is `z`, itself a coordinate axis."""
    k = int(np.argmax(np.abs(z)))
    return np.column_stack([np.eye(3)[(k + 1) % 3], np.eye(3)[(k + 2) % 3], z])
