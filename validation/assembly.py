"""A description as numbers: the moving bodies, where they sit, what is fixed to them.

What the adapters build their engines' models from. It is written apart from `symofros.topology` on purpose; the rules
it follows are those of the description: depth first in the order of description, a body without a joint (or the
implicit "world") is the base, whatever is fixed to the base neither moves nor has energy.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

import symofros as sf
from validation.geometry import Array, Placement, rotation_matrix, skew

BASE = -1
WORLD = "world"

Value = float | sf.Expression

# Joint kind -> (coordinates, speeds).
SIZES = {"revolute": (1, 1), "continuous": (1, 1), "prismatic": (1, 1), "ball": (4, 3), "free": (7, 6)}


@dataclass(frozen=True)
class Mass:
    """The inertia of one described body, in the frame B of the moving body that carries it.

    Attributes:
        body: Name of the described body.
        mass: [kg].
        p_BC: Mass centre (3,) [m].
        J_BC: Inertia about the mass centre, along the axes of B (3, 3) [kg m^2].
    """

    body: str
    mass: float
    p_BC: Array
    J_BC: Array


@dataclass(frozen=True)
class Mover:
    """A body with a joint that moves.

    Attributes:
        body: Its name.
        joint: Its joint as described.
        parent: Index of the moving body that carries it, or BASE.
        X_AP: The joint's proximal frame in the parent's body frame.
        axis: Unit axis in P (3,); meaningless for ball and free joints.
        q: Slice of our coordinates.
        v: Slice of our speeds.
        masses: Of the body and of everything fixed to it.
    """

    body: str
    joint: sf.Joint
    parent: int
    X_AP: Placement
    axis: Array
    q: slice
    v: slice
    masses: list[Mass] = field(default_factory=list)

    @property
    def kind(self) -> str:
        """The joint's kind; one that has limits or not is the same to an engine."""
        return "revolute" if self.joint.kind == "continuous" else self.joint.kind

    def merged(self) -> Mass:
        """Everything it carries as one rigid body (parallel axes)."""
        mass = sum(part.mass for part in self.masses)
        p_BC, J_BC = np.zeros(3), np.zeros((3, 3))
        for part in self.masses:
            p_BC += part.p_BC * (part.mass / mass if mass else 0.0)
        for part in self.masses:
            K = skew(part.p_BC - p_BC)
            J_BC += part.J_BC - part.mass * K @ K
        return Mass(self.body, mass, p_BC, J_BC)


@dataclass(frozen=True)
class FrameSite:
    """A frame fixed on a moving body, or on the base.

    Attributes:
        name: Its public name: its own if unique in the system, otherwise "body.frame".
        mover: Index of the moving body, or BASE.
        X_BF: Where it is on it.
    """

    name: str
    mover: int
    X_BF: Placement


@dataclass(frozen=True)
class Assembly:
    """A description as numbers.

    Attributes:
        name: Of the system.
        movers: Depth first in the order of description.
        frames: By name.
        gravity: (3,) [m/s^2].
        nq: Number of coordinates.
        nv: Number of speeds.
    """

    name: str
    movers: tuple[Mover, ...]
    frames: Mapping[str, FrameSite]
    gravity: Array
    nq: int
    nv: int

    def leaves(self) -> list[int]:
        """Moving bodies that carry no other."""
        parents = {mover.parent for mover in self.movers}
        return [i for i in range(len(self.movers)) if i not in parents]


def assemble(system: sf.System) -> Assembly:
    """Evaluate a description at its parameters' values and sort it into moving bodies.

    Args:
        system: A legal description; `symofros.compile` is what finds its faults.
    """
    builder = _Builder(system)
    builder.visit_all()
    names = Counter(own for own, _, _ in builder.frames)
    frames = {}
    for own, qualified, site in builder.frames:
        # A body frame bears its body's name whatever else is called so.
        name = own if names[own] == 1 or own == qualified else qualified
        frames[name] = FrameSite(name, site.mover, site.X_BF)
    nq = max((mover.q.stop for mover in builder.movers), default=0)
    nv = max((mover.v.stop for mover in builder.movers), default=0)
    return Assembly(system.name, tuple(builder.movers), frames, builder.numbers(system.gravity), nq, nv)


class _Builder:
    def __init__(self, system: sf.System) -> None:
        self.system = system
        self.parameters = system.parameter_values()
        self.movers: list[Mover] = []
        self.frames: list[tuple[str, str, FrameSite]] = []
        self.children: dict[str, list[sf.RigidBody]] = {}
        self.base = next((body for body in system.bodies if body.joint is None), sf.RigidBody(WORLD))
        for body in system.bodies:
            if body.joint is not None:
                parent = self.base.name if body.joint.parent == WORLD else body.joint.parent
                self.children.setdefault(parent, []).append(body)

    def numbers(self, values: Iterable[Value]) -> Array:
        return np.array([sf.evaluate(value, self.parameters) for value in values])

    def placement(self, position: Iterable[Value], rotation: sf.Rotation) -> Placement:
        return Placement(rotation_matrix(rotation.kind, self.numbers(rotation)), self.numbers(position))

    def visit_all(self) -> None:
        """Depth first without recursion: a chain may be longer than Python's stack."""
        pending = [(self.base, BASE, Placement.identity())]
        while pending:
            body, mover, X_BF = pending.pop()
            if body.joint is not None and body.joint.kind != "fixed":
                self._add_mover(body, body.joint, mover, X_BF)
                mover, X_BF = len(self.movers) - 1, Placement.identity()
            self._add_mass(body, mover, X_BF)
            self._add_frames(body, mover, X_BF)
            pending += [(child, mover, X_BF @ self._proximal(body, child)) for child in self._reversed_children(body)]

    def _reversed_children(self, body: sf.RigidBody) -> list[sf.RigidBody]:
        return self.children.get(body.name, [])[::-1]

    def _proximal(self, parent: sf.RigidBody, child: sf.RigidBody) -> Placement:
        joint = child.joint
        assert joint is not None
        X = self.placement(joint.position, joint.rotation)
        if joint.frame is None:
            return X
        frame = next(frame for frame in parent.frames if frame.name == joint.frame)
        return self.placement(frame.position, frame.rotation) @ X

    def _add_mover(self, body: sf.RigidBody, joint: sf.Joint, parent: int, X_AP: Placement) -> None:
        nq, nv = SIZES[joint.kind]
        q, v = (self.movers[-1].q.stop, self.movers[-1].v.stop) if self.movers else (0, 0)
        axis = self.numbers(joint.axis)
        if nq == 1:
            axis = axis / np.linalg.norm(axis)
        self.movers.append(Mover(body.name, joint, parent, X_AP, axis, slice(q, q + nq), slice(v, v + nv)))

    def _add_mass(self, body: sf.RigidBody, mover: int, X_BF: Placement) -> None:
        if body.inertia is None or mover == BASE:
            return
        inertia = body.inertia
        xx, yy, zz, xy, xz, yz = self.numbers(inertia.moments)
        J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        mass, center = float(self.numbers([inertia.mass])[0]), self.numbers(inertia.center_of_mass)
        if inertia.about == "body":
            K = skew(center)
            J = J + mass * K @ K
        else:
            R_FC = rotation_matrix(inertia.rotation.kind, self.numbers(inertia.rotation))
            J = R_FC @ J @ R_FC.T
        self.movers[mover].masses.append(Mass(body.name, mass, X_BF.p + X_BF.R @ center, X_BF.R @ J @ X_BF.R.T))

    def _add_frames(self, body: sf.RigidBody, mover: int, X_BF: Placement) -> None:
        self.frames.append((body.name, body.name, FrameSite(body.name, mover, X_BF)))
        for frame in body.frames:
            X = X_BF @ self.placement(frame.position, frame.rotation)
            self.frames.append((frame.name, f"{body.name}.{frame.name}", FrameSite(frame.name, mover, X)))
