"""A description as parts that move against each other: joints as lines, bodies as inertias, all in the world's axes.

Everything is stated in one frame, the world's, with all coordinates zero, so that it does not depend on where a file
puts the frames of its links.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import skew
from symofros.description import IDENTITY_POSE, Beam, Damper, Friction, Joint, JointElement, Pose, Spring, System
from symofros.errors import DescriptionError
from symofros.exports.interchange.rigid import RigidLink, rigid_links
from symofros.exports.limits import listed
from symofros.mechanics.topology import Numbers

# Entries of friction beside its level, and those that mean nothing without another one.
FRICTION = ("static friction", "smoothing of friction", "Stribeck speed", "sticking")
FOLLOWING = frozenset({"rest of the spring", *FRICTION})
# Bodies beyond which files are refused, so that hostile ones take bounded time.
MOST_BODIES = 1000


def moved(T: Pose, point: Array) -> Array:
    """A point (3) displaced."""
    return np.asarray(T.p + T.R @ point)


@dataclass(frozen=True)
class Body:
    """A body at zero coordinates, in the axes of the world.

    Attributes:
        name: Its name.
        parent: Index of the body that carries it; -1 for none.
        part: Index of its part.
        joint: Name of the joint that carries it.
        pose: Its frame.
        placed: Its frame in that of the body that carries it, as the file states it.
        mass: Mass [kg].
        center: Mass centre (3) [m].
        inertia: About the mass centre (3, 3) [kg m^2].
        frames: Frames on it.
    """

    name: str
    parent: int
    part: int
    joint: str
    pose: Pose
    placed: Pose
    mass: float
    center: Array
    inertia: Array
    frames: dict[str, Pose]


@dataclass(frozen=True)
class Move:
    """An elementary joint at zero coordinates, in the axes of the world.

    Attributes:
        name: Name of its coordinate, or of the joint.
        kind: "turn", "slide", "screw", "ball" or "free".
        stated: Kind of joint in the description, such as "continuous".
        axis: Unit vector (3); any of balls and free joints.
        point: A point on the axis, or the centre (3) [m].
        pitch: Advance [m/rad] of a screw.
        frame: Frame of the joint.
        placed: That frame in the carrier's, as the file states it.
        carrier: Index of the body that carries it; -1 for none.
        entries: Limits, damping, friction, springs, armature: name -> number, without those that are not there.
        driven: Whether the joint has an input.
    """

    name: str
    kind: str
    stated: str
    axis: Array
    point: Array
    pitch: float
    frame: Pose
    placed: Pose
    carrier: int
    entries: dict[str, float]
    driven: bool

    @property
    def screws(self) -> Array:
        """Twists (6, n) of its speeds: angular velocity, and velocity of the point at the origin."""
        if self.kind in ("ball", "free"):
            turns = np.vstack([np.eye(3), skew(self.point)])
            slides = np.vstack([np.zeros((3, 3)), np.eye(3)])
            return turns if self.kind == "ball" else np.hstack([slides, turns])
        if self.kind == "slide":
            return np.concatenate([np.zeros(3), self.axis])[:, None]
        return np.concatenate([self.axis, np.cross(self.point, self.axis) + self.pitch * self.axis])[:, None]


@dataclass
class Part:
    """Bodies that don't move against each other.

    Attributes:
        parent: Index of the part that carries it; -1 for the ground.
        move: How it moves on that; None for the ground.
        bodies: Indices of its bodies, parents first; none between the elementary joints of one joint.
        children: Indices of the parts that it carries.
    """

    parent: int
    move: Move | None
    bodies: list[int] = field(default_factory=list)
    children: list[int] = field(default_factory=list)


class Mechanism:
    """A description in parts.

    Args:
        system: Checked description.
        label: Name in problems and tables.

    Attributes:
        bodies: Bodies, parents first.
        parts: Parts, parents first; the ground first of all.
        gravity: Acceleration of gravity (3) [m/s^2].
        lost: What the system has and is not compared.

    Raises:
        DescriptionError: It is more than a tree of rigid bodies, or too large.
    """

    def __init__(self, system: System, label: str) -> None:
        self.system, self.label, self.numbers = system, label, Numbers(system)
        _refuse(system, label)
        links, lost = rigid_links(system, None)
        # Inputs of actuators and parameters say nothing of the mechanism; of actuators another note tells.
        silent = ("parameters", "inputs", *(("efforts",) if system.inputs else ()))
        self.lost = (*(note for note in lost if not note.startswith(silent)), *_uncompared(system))
        self.gravity = self.numbers.values(system.gravity)
        self.bodies: list[Body] = []
        self.parts = [Part(-1, None)]
        self.index: dict[str, int] = {}
        for link in links:
            self._add(link)
        self.size = max(1e-6, *(float(np.linalg.norm(body.center - body.pose.p)) for body in self.bodies))
        self.size = max(self.size, *(float(np.linalg.norm(body.placed.p)) for body in self.bodies))

    def _add(self, link: RigidLink) -> None:
        """A body, and the parts of its joint."""
        parent = self.index.get(link.parent or "", -1)
        placed = Pose(link.position, link.rotation)
        pose = (self.bodies[parent].pose if parent >= 0 else IDENTITY_POSE) @ placed
        part = self.bodies[parent].part if parent >= 0 else 0
        for move in () if link.joint is None else self._moves(link.joint, link, pose, placed, parent):
            self.parts.append(Part(part, move))
            self.parts[part].children.append(len(self.parts) - 1)
            part = len(self.parts) - 1
        frames = {name: pose @ Pose(p, R) for name, p, R in link.frames}
        joint = "" if link.joint is None else link.joint.name
        center, inertia = moved(pose, link.center), pose.R @ link.inertia @ pose.R.T
        self.index[link.name] = len(self.bodies)
        self.parts[part].bodies.append(len(self.bodies))
        self.bodies.append(Body(link.name, parent, part, joint, pose, placed, link.mass, center, inertia, frames))

    def _moves(self, joint: Joint, link: RigidLink, pose: Pose, placed: Pose, carrier: int) -> Iterator[Move]:
        """The elementary joints of a joint."""
        if joint.kind == "fixed":
            return
        if not link.axes:
            direction = self.numbers.values(joint.axis)
            axis = pose.R @ (direction / (np.linalg.norm(direction) or 1.0))
            pitch, name = self.numbers.value(joint.pitch) if joint.kind == "screw" else 0.0, joint.name
            entries = self._entries(joint, 0)
            yield Move(
                name, joint.kind, joint.kind, axis, pose.p, pitch, pose, placed, carrier, entries, joint.actuated
            )
        for k, single in enumerate(link.axes):
            kind, axis = "turn" if single.turns else "slide", pose.R @ np.array(single.direction)
            entries = self._entries(joint, k)
            at = -1 if k else carrier
            yield Move(single.name, kind, joint.kind, axis, pose.p, 0.0, pose, placed, at, entries, joint.actuated)

    def _entries(self, joint: Joint, k: int) -> dict[str, float]:
        """Numbers of one coordinate of a joint."""
        value = self.numbers.value
        found = {"armature": value(joint.armature)}
        if joint.limits is not None:
            limits = joint.limits
            sizes = {f"limit of {label}": getattr(limits, label) or None for label in ("velocity", "effort")}
            stated = {"lower limit": limits.lower, "upper limit": limits.upper, **sizes}
            found |= {label: number for label, number in stated.items() if number is not None}
        for element in joint.elements:
            if element.coordinate == k and isinstance(element, Damper):
                found["damping"] = found.get("damping", 0.0) + value(element.coefficient)
                found["quadratic damping"] = found.get("quadratic damping", 0.0) + value(element.quadratic)
            elif element.coordinate == k and isinstance(element, Friction):
                found["damping"] = found.get("damping", 0.0) + value(element.viscous)
                for label, number in self._friction(element).items():
                    found[label] = found.get(label, 0.0) + number
        found |= self._springs([e for e in joint.elements if isinstance(e, Spring) and e.coordinate == k])
        return {
            label: number for label, number in found.items() if number != 0.0 or "limit" in label or label in FOLLOWING
        }

    def _friction(self, element: Friction) -> dict[str, float]:
        """Numbers of dry friction, those that are left out as the model takes them; 0 where none holds beyond it."""
        value, dynamic = self.numbers.value, self.numbers.value(element.dynamic)
        speed = value(element.minimum_velocity)
        stribeck = 10.0 * speed if element.stribeck_velocity is None else value(element.stribeck_velocity)
        static = dynamic if element.static is None else value(element.static)
        beyond = (static, stribeck) if static > dynamic else (0.0, 0.0)
        numbers = dynamic, beyond[0], speed, beyond[1], float(element.sticks)
        return dict(zip(("friction", *FRICTION), numbers, strict=True))

    def _springs(self, springs: Sequence[Spring]) -> dict[str, float]:
        """The springs of a coordinate as one of the rest R, -F = C (q - R)^3 + K (q - R) + P; of a single one P = 0."""
        value = self.numbers.value
        terms = [(value(s.stiffness), value(s.cubic), value(s.rest)) for s in springs]
        K, C = (math.fsum(column) for column in ([k for k, _, _ in terms], [c for _, c, _ in terms]))
        rests = [rest for _, _, rest in terms]
        total, first = C or K, rests[0] if rests else 0.0
        if not total:
            return {"push of the springs": math.fsum(-k * rest for k, _, rest in terms)}
        # About the first rest, so that equal ones are kept to the last digit.
        R = first + math.fsum((c if C else k) * (rest - first) for k, c, rest in terms) / total
        stiffness = K + 3.0 * math.fsum(c * (R - rest) ** 2 for _, c, rest in terms)
        push = math.fsum((c * (R - rest) ** 2 + k) * (R - rest) for k, c, rest in terms) if C else 0.0
        entries = {"stiffness": stiffness, "cubic stiffness": C, "rest of the spring": R, "push of the springs": push}
        return entries

    def massive(self, part: int) -> list[Body]:
        """The bodies of a part that have mass or inertia."""
        listed = [self.bodies[k] for k in self.parts[part].bodies]
        return [body for body in listed if body.mass or body.inertia.any()]

    def total(self, part: int) -> tuple[float, Array, Array]:
        """Mass, mass centre and inertia about it of a part."""
        bodies = self.massive(part)
        mass = sum(body.mass for body in bodies)
        center = sum((body.mass * body.center for body in bodies), np.zeros(3)) / (mass or 1.0)
        inertia = np.zeros((3, 3))
        for body in bodies:
            S = skew(body.center - center)
            inertia = inertia + body.inertia - body.mass * S @ S
        return mass, center, inertia

    def carried_by(self, part: int) -> Body:
        """The body that the file states on a part's joint; carriers that a reader puts between joints are none."""
        origin, first = self.system.origin, None
        while True:
            bodies = [self.bodies[k] for k in self.parts[part].bodies]
            stated = [body for body in bodies if not origin or ("body", body.name) in origin or body.mass]
            if stated:
                return stated[0]
            first = first or next(iter(bodies), None)
            if not self.parts[part].children:
                assert first is not None  # A series of joints ends in a body.
                return first
            part = self.parts[part].children[0]

    def whole(self, part: int) -> Body:
        """The bodies of a part as one."""
        bodies, there = self.massive(part), self.parts[part].bodies
        mass, center, inertia = self.total(part)
        first = bodies[0] if bodies else self.bodies[there[0]] if there else self.carried_by(part)
        name = "+".join(body.name for body in bodies) or first.name
        return replace(first, name=name, mass=mass, center=center, inertia=inertia)


def _uncompared(system: System) -> Iterator[str]:
    """Elements of joints that have no entries, and when constraints hold."""
    joints = [body.joint for body in system.bodies if body.joint is not None]
    odd = {
        joint.name: sorted({type(element).__name__ for element in joint.elements if _is_odd(element)})
        for joint in joints
    }
    if any(odd.values()):
        yield "elements of joints: " + listed([f"{name} ({', '.join(kinds)})" for name, kinds in odd.items() if kinds])


def _is_odd(element: JointElement) -> bool:
    """Whether an element has more than the entries say."""
    if isinstance(element, Friction):
        return element.factor != 1.0
    return not isinstance(element, Damper | Spring)


def _refuse(system: System, label: str) -> None:
    """Refuse what is more than a tree of rigid bodies on joints of the library."""
    joints = [body.joint for body in system.bodies if body.joint is not None]
    odd = [f"beam '{body.name}'" for body in system.bodies if isinstance(body, Beam)]
    odd += [f"joint '{joint.name}' (general)" for joint in joints if joint.kind == "general"]
    odd += [f"joint '{joint.name}' (prescribed)" for joint in joints if joint.prescribed]
    if odd:
        rule, remedy = "a comparison is of rigid bodies on joints of the library", "compare files of the rigid part"
        raise DescriptionError(f"{label}: not comparable", ", ".join(odd[:5]), rule, remedy)
    if len(system.bodies) > MOST_BODIES:
        rule, remedy = f"at most {MOST_BODIES} bodies are compared", "compare parts of it"
        raise DescriptionError(f"{label}: too many bodies", f"{len(system.bodies)}", rule, remedy)
