"""What an engine is stated: a tree of rigid links, with what constrains, drives and pulls it.

Frames: a link's frame stands where its last joint leaves it. Vectors are tuples, rotations tuples of rows; R of a
placement turns components of the placed frame into those of the frame it is placed in.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .frames import IDENTITY, ORIGIN, End, Rows, Vector, rows
from .lines import Actuator, Medium, Tendon

# Ways of stating a tree (`Tree.stated`).
BASE, DENAVIT, MODIFIED = "a base", "Denavit-Hartenberg parameters", "modified Denavit-Hartenberg parameters"
# The first link that is fixed to another begins a gripper.
GRIPPER = "a gripper"
# What a tree is asked about whose limits and dry friction act as MuJoCo's documentation has them (`Tree.asked`).
SOFT_LIMITS = "soft limits and friction"
# What engines are asked about whose text makes its own model: names of a tree that is there for its state alone.
FEATURES = (
    "force elements",
    "inertias of solids, meshes and convex hulls",
    "defaults and parameters: gears, rotors, dampers, model instances",
    "joints that are locked, held and coupled in a step",
    "trajectories",
    "linear systems and controllers",
    "servos, motors, dry friction and joints at limits",
)


@dataclass(frozen=True)
class Joint:
    """One elementary joint; a link may hang on several in series.

    Attributes:
        kind: Key of `charts.GEOMETRIES`, such as "revolute".
        R: Rotation (3, 3) of the frame before its motion, in the frame that it is placed in.
        p: Position (3) of the same [m].
        axis: Direction of its motion in its own frame, of unit length.
        second: Direction of its second motion ("universal").
        pitch: Advance for a radian [m/rad] ("helical").
        radii: Half axes (3) [m] ("ellipsoid").
        sequence: Axes of successive rotations ("euler"), as "ZYX".
        form: Native form that is asked for where an engine has several, such as "unbounded"; "" for the plainest.
        armature: Inertia added to the diagonal of the mass matrix, for each speed; () for none.
        mimics: Name of the link whose (one and only) joint it follows: q = ratio q_followed + offset; "" for none.
        ratio: See `mimics`.
        offset: See `mimics`.
        locked: Coordinate that a joint of one coordinate is locked at, by the engine: the joint moves no more. None for
            none.
        damping: Force against each of its speeds, for a unit of speed.
        stiffness: Force of a spring on a joint of one coordinate, for a unit of it.
        rest: Coordinate at which the spring has no force.
        friction: Greatest force of dry friction against each of its speeds; files state it, no function has its force.
        force_limits: Least and greatest force that actuators make together along a joint of one coordinate; () for
            none.
        limits: Least and greatest coordinate of a joint of one coordinate, that files state and no function has; () for
            none.
        bounds: Greatest speed and greatest force of such a joint, by files; () for none.
        drive: Stiffness, damping and coordinate that a drive holds such a joint at, by files; () for none.
    """

    kind: str
    R: Rows = IDENTITY
    p: Vector = ORIGIN
    axis: Vector = (0.0, 0.0, 1.0)
    second: Vector = (0.0, 1.0, 0.0)
    pitch: float = 0.0
    radii: Vector = (0.0, 0.0, 0.0)
    sequence: str = ""
    form: str = ""
    armature: tuple[float, ...] = ()
    mimics: str = ""
    ratio: float = 1.0
    offset: float = 0.0
    locked: float | None = None
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    friction: float = 0.0
    force_limits: tuple[float, ...] = ()
    limits: tuple[float, ...] = ()
    bounds: tuple[float, ...] = ()
    drive: tuple[float, ...] = ()


@dataclass(frozen=True)
class Link:
    """A rigid body and the joints it hangs on.

    Attributes:
        name: Name of the link.
        parent: Index of the link it hangs on, smaller than its own; -1 for the world.
        joints: Joints in series, the first placed in the parent's frame. A joint of kind "fixed" places only.
        mass: Mass [kg].
        com: Mass centre (3) in the link's frame [m].
        inertia: Inertia (3, 3) about the mass centre, along the link's axes [kg m^2].
        compensation: Part of its weight that a force at its mass centre bears.
    """

    name: str
    parent: int
    joints: tuple[Joint, ...]
    mass: float = 1.0
    com: Vector = ORIGIN
    inertia: Rows = IDENTITY
    compensation: float = 0.0

    def before(self, change: str) -> Link:
        """The link before a change (`Tree.changed`)."""
        x, y, z = self.com
        match change:
            case "mass":
                return replace(self, mass=2.0 * self.mass)
            case "inertia":
                return replace(self, com=(y, z, x), inertia=rows(np.array(self.inertia)[::-1, ::-1]))
            case "frame":
                first, *rest = self.joints
                return replace(self, joints=(replace(first, R=IDENTITY, p=(0.5, 0.25, -0.125)), *rest))
        return self


@dataclass(frozen=True)
class Constraint:
    """An equation between positions of links.

    "point": the origins of two frames coincide. "weld": two frames coincide. "coupling": a sum of coordinates, each
    times its coefficient, is constant; each is that of the only joint of a link. "polynomial": the first coordinate is
    the polynomial of the second, whose coefficients begin with the constant. "path": the sum of the distances from
    point to point is what it is with all coordinates zero. "floor": a ball about a frame's origin stays above a height.

    Attributes:
        kind: One of these.
        ends: Frames that it holds; of a "coupling", their links; of a "path", its points in order.
        coefficients: Of a "coupling", for each end; of a "polynomial", for each power; of a "floor", the ball's radius
            and the height.
        torque_scale: Of a "weld", factor of its rows of rotation.
        by_bodies: Whether only the first frame of a "point" is stated: the second is where that is with all
            coordinates zero.
    """

    kind: str
    ends: tuple[End, ...]
    coefficients: tuple[float, ...] = ()
    torque_scale: float = 1.0
    by_bodies: bool = False


@dataclass(frozen=True)
class Tree:
    """A mechanism as it is stated to all engines.

    Attributes:
        name: Name for tables.
        links: Links, each after its parent.
        gravity: Acceleration of gravity (3) in the world [m/s^2].
        constraints: Equations that bind the links further. Only `functions.CONSTRAINED` are asked of such a tree.
        attached: Name of a link that begins a model of its own, which the engine attaches to the others' ("").
        fused: Whether the engine fuses links that don't move against each other.
        changed: What the engine changes, once model and data are there and used, from `before` to what is stated:
            "mass", "inertia" (with mass centres), "frame" (placements of joints), "anchor" (first frames of
            constraints) or "gravity"; "" for nothing.
        tendons: Lengths over its joints or links.
        actuators: What drives it.
        sensors: Frames of links at which sensors stand.
        medium: What surrounds its links; None for nothing.
        away: Added to the positions that random states have of free joints [m].
        near: Random states are near to where nothing has moved: coordinates' distances from there, speeds and forces
            are 2^-near of what they would be; rates of speeds are not.
        beside: What random rotations are near to in place of that, 2^-near from it, or exactly for near = 0: "half
            turns", "half turns about an axis", "each other", "each other's opposite" quaternion; "one axis" turns all
            by less than a quarter turn about one of the coordinates' axes.
        asked: What else an engine must know by name to be asked about it, such as "turns" or "flexible bodies"; only
            functions that need it are asked of such a tree.
        stated: In which way of its own the engine states it, where that is not link by link: "a base",
            "Denavit-Hartenberg parameters" (`models.stated`).
        features: Features of the scene that the tree stands for, or of the tree itself (`models.covering`).
    """

    name: str
    links: tuple[Link, ...]
    gravity: Vector = (0.0, 0.0, -9.81)
    constraints: tuple[Constraint, ...] = ()
    attached: str = ""
    fused: bool = False
    changed: str = ""
    tendons: tuple[Tendon, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    sensors: tuple[End, ...] = ()
    medium: Medium | None = None
    away: Vector = ORIGIN
    near: int = 0
    beside: str = ""
    asked: str = ""
    stated: str = ""
    features: tuple[str, ...] = ()

    @property
    def forces(self) -> frozenset[str]:
        """What acts on it by its own statement: "dampers", "springs", "compensation", "actuators" and the like."""
        joints = [joint for link in self.links for joint in link.joints]
        stated = {
            "dampers": any(joint.damping for joint in joints),
            "springs": any(joint.stiffness for joint in joints),
            "compensation": any(link.compensation for link in self.links),
            "tendons": bool(self.tendons),
            "wrapped tendons": any(tendon.wraps for tendon in self.tendons),
            "heavy tendons": any(tendon.armature for tendon in self.tendons),
            "actuators": bool(self.actuators),
            "a medium": self.medium is not None,
            "activations": any(actuator.activation for actuator in self.actuators),
            "affine gains": any(any(actuator.slopes) for actuator in self.actuators),
        }
        return frozenset(name for name, there in stated.items() if there)

    @property
    def demands(self) -> frozenset[str]:
        """What an engine must know by name to be asked about it: transformations, forces, "sensors" and the like."""
        scaled = any(one.torque_scale != 1.0 for one in self.constraints)
        by_bodies = any(one.by_bodies for one in self.constraints)
        stated = {"sensors": bool(self.sensors), "scaled welds": scaled, "points by bodies": by_bodies}
        stated["sensors of bound links"] = bool(self.sensors and self.constraints)
        stated[self.asked] = bool(self.asked)
        return self.transformations | self.forces | {name for name, there in stated.items() if there}

    @property
    def transformations(self) -> frozenset[str]:
        """What engines must do to it once it is built: "locked", "attached", "fused", "changed mass" and the like."""
        locked = any(joint.locked is not None for link in self.links for joint in link.joints)
        stated = {
            "locked": locked,
            "attached": bool(self.attached),
            "fused": self.fused,
            self.stated: bool(self.stated),
        }
        names = {name for name, there in stated.items() if there}
        return frozenset(names | ({f"changed {self.changed}"} if self.changed else set()))

    @property
    def before(self) -> Tree:
        """The tree that an engine builds first, where it changes one thing of it after."""
        x, y, z = self.gravity
        links = tuple(link.before(self.changed) for link in self.links)
        constraints = self.constraints
        if self.changed == "anchor":
            moved = ((one, one.ends[0], one.ends[1:]) for one in self.constraints)
            constraints = tuple(
                replace(one, ends=(first._replace(p=(0.5, 0.25, -0.125)), *others)) for one, first, others in moved
            )
        return replace(
            self,
            links=links,
            constraints=constraints,
            gravity=(z, x, y) if self.changed == "gravity" else self.gravity,
            changed="",
        )
