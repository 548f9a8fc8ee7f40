"""The neutral tree that each reader makes of its file, before the choices of `ImportOptions`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from symofros.description.constraints import Constraint
from symofros.description.forces import Load, Spring
from symofros.description.frames import Frame
from symofros.description.imported.geometry import Exact
from symofros.description.imported.options import Dissipation, ImportOptions
from symofros.description.joints.joint import WORLD, Joint
from symofros.description.remarks import Remarks
from symofros.description.system import Inertia, Input
from symofros.description.values import Rotation, Vector
from symofros.description.visual import Visual
from symofros.errors import Problem

Placement = tuple[Vector, Rotation]
GRAVITY = (0.0, 0.0, -9.81)  # Of files that can't state one [m/s^2].


@dataclass(frozen=True)
class Resistance:
    """What acts against the motion along one speed of a joint, as the file states it.

    Attributes:
        spring: Spring on its coordinate.
        damping: Viscous damping [N m s/rad or N s/m].
        quadratic: Damping by v |v| [N m s^2/rad^2 or N s^2/m^2].
        friction: Dry friction [N m or N].
    """

    spring: Spring | None = None
    damping: float = 0.0
    quadratic: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class ImportedJoint:
    """A joint of the file.

    Attributes:
        joint: The joint, placed on what carries it; the parent and the elements are left to `system_of`.
        resistances: What resists it, one a speed; those that are left out have none.
    """

    joint: Joint
    resistances: tuple[Resistance, ...] = ()


@dataclass
class ImportedBody:
    """A body of the file, with all joints between it and its parent.

    Attributes:
        name: Its name.
        inertia: Inertia; None for a massless body.
        parent: Name of the body that carries it.
        joints: Joints in the order from the parent to the body; all but the last carry massless bodies.
        placement: Where the body is in the frame that the last joint moves, or on its parent if there is no joint;
            None where it is that frame.
        is_ground: Whether it is the base itself, in whose frame all else is placed.
        floats: Whether no joint holds it, so that it goes onto a free one.
        loads: Forces on it.
    """

    name: str
    inertia: Inertia | None = None
    parent: str = WORLD
    joints: tuple[ImportedJoint, ...] = ()
    placement: Placement | None = None
    is_ground: bool = False
    floats: bool = False
    loads: tuple[Load, ...] = ()

    @property
    def is_held(self) -> bool:
        """Whether nothing lets it move on its parent."""
        return not self.floats and all(stated.joint.kind == "fixed" for stated in self.joints)


@dataclass
class ImportedTree:
    """A file, whatever its format.

    Attributes:
        name: Name of the system.
        options: How it is read.
        where: Place of the file, for problems.
        dissipation: What of the passive losses the format keeps by default.
        limits_act: Whether limits of coordinates act in the format's own engine, so that keeping them as data is noted.
        floating_joint: Name of the joint of a body that floats, with `{}` in the place of the body's.
        noun: What the format calls a body.
        remarks: What is ignored or changed.
        exact: Has made numbers exact; its count becomes a remark.
        bodies: Bodies, parents first.
        frames: Frames by the name of their body.
        gravity: Acceleration of gravity [m/s^2].
        inputs: Inputs of actuators.
        constraints: Closures, couplings, rods.
        origin: Places in the file, as in System.
        visuals: How bodies look, by name.
        problems: What is wrong with the file.
    """

    name: str
    options: ImportOptions
    where: str
    dissipation: Dissipation = "viscous"
    limits_act: bool = False
    floating_joint: str = "{}_floating"
    noun: str = "link"
    remarks: Remarks = field(default_factory=Remarks)
    exact: Exact = field(default_factory=lambda: Exact(0.0))
    bodies: list[ImportedBody] = field(default_factory=list)
    frames: dict[str, list[Frame]] = field(default_factory=dict)
    gravity: Vector = GRAVITY
    inputs: tuple[Input, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    origin: dict[tuple[str, ...], str] = field(default_factory=dict)
    visuals: Mapping[str, tuple[Visual, ...]] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    @property
    def keeps(self) -> Dissipation:
        """Which passive losses are kept: by the options, or else by the default of the format."""
        return self.options.dissipation or self.dissipation
