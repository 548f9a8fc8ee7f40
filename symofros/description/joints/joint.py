"""A joint: how a body moves on its parent. No computation."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.description.entries import refuses_unknown_entries
from symofros.description.forces import JointElement, Rotor
from symofros.description.joints.joint_kinds import JOINT_KINDS, KINDS, JointKind, JointKindName
from symofros.description.values import IDENTITY, ORIGIN, Rotation, Value, Vector, as_value, as_vector
from symofros.errors import DescriptionError, did_you_mean

WORLD = "world"


@refuses_unknown_entries
@dataclass(frozen=True)
class Limits:
    """Bounds of a one-coordinate joint; data for sampling and inverse kinematics, not a force.

    Attributes:
        lower: Least coordinate [rad or m].
        upper: Greatest coordinate [rad or m].
        velocity: Greatest speed [rad/s or m/s]; zero is no limit, as in files that leave it open.
        effort: Greatest effort [N m or N]; zero is no limit.
    """

    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None

    def __post_init__(self) -> None:
        """Refuse sizes below zero."""
        for label in ("velocity", "effort"):
            size = getattr(self, label)
            if size is not None and size < 0.0:
                rule = f"the limit of {label} is a size, for both directions"
                raise DescriptionError(
                    f"limits: {label} is negative", f"{size:g}", rule, "leave it out where there is none"
                )


@refuses_unknown_entries
@dataclass(frozen=True)
class Joint:
    """How a body B moves on its parent A: proximal frame P fixed on A, distal frame D = body frame B.

    Attributes:
        name: Unique name, borne by the coordinate of a one-coordinate joint; in files `q_` and the body's name if not
            given.
        kind: Name of a row of the table of joint kinds (joint_kinds.py). All but ball and free have v = q'.
        parent: Body that carries this one; "world" for the ground.
        frame: Frame of the parent that P is placed in; the parent's body frame if not given.
        position: Position of Po from that frame's origin, in that frame [m].
        rotation: Rotation from that frame to P.
        axis: Main axis of a kind that has one, in P, of any length.
        actuated: Whether an input is added for each speed, named like the speed: an effort on the joint [N m or N].
        effort: Formulas, one a speed, of inputs, parameters, coordinates, speeds (`dq1`) and `t` [N m or N].
        limits: Bounds of the coordinate, if any.
        axis2: Second axis of a universal joint, in the frame after the first turn.
        pitch: Pitch of a screw joint [m/rad].
        coordinates: Names of the coordinates of a general joint, one to six.
        moving_position: Position p_PD of a general joint, by formulas of its coordinates and of parameters [m].
        moving_rotation: Rotation R_PD of a general joint, by formulas of its coordinates and of parameters.
        prescribed: Whether the motion is given: coordinates, speeds and their rates are inputs (q1, dq1, ddq1).
        elements: Springs, dampers, stops and friction on its coordinates.
        armature: Inertia added to each speed, of a rotor whose gyroscopic effect is neglected [kg m^2 or kg].
        rotors: Rotors that its speeds drive, with their gyroscopic effect.
    """

    name: str
    kind: JointKindName = "fixed"
    parent: str = WORLD
    frame: str | None = None
    position: Vector = ORIGIN
    rotation: Rotation = IDENTITY
    axis: Vector = (0.0, 0.0, 1.0)
    actuated: bool = False
    effort: tuple[Value, ...] = ()
    limits: Limits | None = None
    axis2: Vector = (0.0, 1.0, 0.0)
    pitch: Value = 0.0
    coordinates: tuple[str, ...] = ()
    moving_position: Vector = ORIGIN
    moving_rotation: Rotation = IDENTITY
    prescribed: bool = False
    elements: tuple[JointElement, ...] = ()
    armature: Value = 0.0
    rotors: tuple[Rotor, ...] = ()

    def __post_init__(self) -> None:
        """Convert numbers and check the kind."""
        what = f"joint '{self.name}'"
        if self.kind not in JOINT_KINDS:
            raise DescriptionError(
                f"{what}: unknown kind",
                f"'{self.kind}'",
                f"one of {', '.join(JOINT_KINDS)}",
                did_you_mean(str(self.kind), JOINT_KINDS),
            )
        object.__setattr__(self, "position", as_vector(self.position, f"{what}: position"))
        object.__setattr__(self, "axis", as_vector(self.axis, f"{what}: axis"))
        object.__setattr__(self, "axis2", as_vector(self.axis2, f"{what}: axis2"))
        object.__setattr__(self, "pitch", as_value(self.pitch, f"{what}: pitch"))
        object.__setattr__(self, "armature", as_value(self.armature, f"{what}: armature"))
        for name in ("coordinates", "elements", "rotors"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        object.__setattr__(self, "moving_position", as_vector(self.moving_position, f"{what}: moving_position"))
        effort = self.effort if isinstance(self.effort, (tuple, list)) else (self.effort,)
        object.__setattr__(self, "effort", tuple(as_value(e, f"{what}: effort[{i}]") for i, e in enumerate(effort)))

    @property
    def traits(self) -> JointKind:
        """Row of the table of joint kinds."""
        return KINDS[self.kind]
