"""A description as numbers: the moving bodies, where they sit, what is fixed to them.

What the adapters build their engines' models from. It is written apart from `symofros.mechanics.topology` on purpose;
the rules it follows are those of the description: depth first in the order of description, a body without a joint
(or the implicit "world") is the base, whatever is fixed to the base neither moves nor has energy.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

import symofros as sf

from .geometry import Array, Placement, rotation_matrix, skew
from .joint_kinds import PartKind
from .parts import Part, coordinate_symbols, has_quaternion, series

BASE = -1
WORLD = "world"

Value = float | sf.Expression


@dataclass(frozen=True)
class Mass:
    """The inertia of one described body, in the frame B of the moving body that carries it.

    Attributes:
        body: Name of the described body.
        mass: Mass [kg].
        p_BC: Mass centre (3,) [m].
        J_BC: Inertia about the mass centre, along the axes of B (3, 3) [kg m^2].
    """

    body: str
    mass: float
    p_BC: Array
    J_BC: Array


@dataclass(frozen=True)
class Mover:
    """A body with a joint that moves; a joint of several coordinates makes several movers, all but the last massless.

    Attributes:
        body: Name of the body.
        name: Name of the joint, or of this part of it.
        joint: Joint as described.
        part: The part of the joint that this is.
        continues: Whether it is a further part of the joint of the mover before it.
        parent: Index of the moving body that carries it, or BASE.
        X_AP: The joint's proximal frame in the parent's body frame.
        axis: Unit axis in P (3,); meaningless for ball and free joints.
        q: Slice of our coordinates; empty where the motion is prescribed.
        v: Slice of our speeds.
        pitch: Pitch of a screw [m/rad].
        length: Length of a beam whose elastic coordinates it stands for; of a section before the tip, its station [m].
        is_rod: Whether it stands for strains of a geometrically exact rod.
        masses: Masses of the body and of everything fixed to it.
    """

    body: str
    name: str
    joint: sf.Joint
    part: Part
    continues: bool
    parent: int
    X_AP: Placement
    axis: Array
    q: slice
    v: slice
    pitch: float = 0.0
    length: float = 0.0
    is_rod: bool = False
    masses: list[Mass] = field(default_factory=list)

    @property
    def kind(self) -> PartKind:
        """Kind of the mover's part of a joint, as engines distinguish them."""
        return self.part.kind

    @property
    def has_quaternion(self) -> bool:
        """Whether its coordinates end with a quaternion."""
        return has_quaternion(self.joint)

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
        name: Public name: the frame's own if unique in the system, otherwise "body.frame".
        mover: Index of the moving body, or BASE.
        X_BF: Placement of the frame on the body.
    """

    name: str
    mover: int
    X_BF: Placement


@dataclass(frozen=True)
class Described:
    """A joint as described, with its slices of our coordinates and speeds; empty where its motion is prescribed."""

    joint: sf.Joint
    q: slice
    v: slice


@dataclass(frozen=True)
class Assembly:
    """A description as numbers.

    Attributes:
        name: Name of the system.
        joints: Joints that move, in order.
        movers: Depth first in the order of description.
        frames: Frames by name.
        gravity: (3,) [m/s^2].
        nq: Number of coordinates.
        nv: Number of speeds.
    """

    name: str
    joints: tuple[Described, ...]
    movers: tuple[Mover, ...]
    frames: Mapping[str, FrameSite]
    gravity: Array
    nq: int
    nv: int

    @property
    def free_joints(self) -> list[Described]:
        """Joints whose motion is not prescribed."""
        return [described for described in self.joints if not described.joint.prescribed]

    @property
    def driven_joints(self) -> list[sf.Joint]:
        """Joints with prescribed motion: q, v and v' are inputs after all others, joint by joint."""
        return [described.joint for described in self.joints if described.joint.prescribed]

    @property
    def motors(self) -> int:
        """How many inputs actuated joints add, between the named ones and prescribed motions."""
        free = [described for described in self.free_joints if described.joint.actuated]
        return sum(described.v.stop - described.v.start for described in free)

    @property
    def moves_no_mass(self) -> bool:
        """Whether some joint moves no mass, as in files of kinematics alone: then M has no inverse."""
        moving = [bool(mover.joint.armature or mover.joint.rotors) for mover in self.movers]
        for i, mover in enumerate(self.movers):
            moving[i] |= any(one.mass != 0.0 or bool(np.any(one.J_BC)) for one in mover.masses)
        for i in range(len(moving) - 1, -1, -1):  # Those that are carried stand behind their carriers.
            if moving[i] and self.movers[i].parent != BASE:
                moving[self.movers[i].parent] = True
        return not all(moving)

    def leaves(self) -> list[int]:
        """Moving bodies that carry no other."""
        parents = {mover.parent for mover in self.movers}
        return [i for i in range(len(self.movers)) if i not in parents]


def assemble(system: sf.System) -> Assembly:
    """Evaluate a description at its parameters' values and sort it into moving bodies.

    Args:
        system: A legal description; `symofros.compile` is what finds its faults.
    """
    builder = _AssemblyBuilder(system)
    builder.visit_all()
    names = Counter(own for own, _, _ in builder.frames)
    frames = {}
    for own, qualified, site in builder.frames:
        # A body frame bears its body's name whatever else is called so.
        name = own if names[own] == 1 or own == qualified else qualified
        frames[name] = FrameSite(name, site.mover, site.X_BF)
    nq, nv = (builder.joints[-1].q.stop, builder.joints[-1].v.stop) if builder.joints else (0, 0)
    return Assembly(
        system.name, tuple(builder.joints), tuple(builder.movers), frames, builder.numbers(system.gravity), nq, nv
    )


class _AssemblyBuilder:
    def __init__(self, system: sf.System) -> None:
        self.system = system
        self.parameters = system.parameter_values()
        self.joints: list[Described] = []
        self.movers: list[Mover] = []
        self.frames: list[tuple[str, str, FrameSite]] = []
        self.children: dict[str, list[sf.Body]] = {}
        # Where the frames of beams are.
        self.stations: dict[tuple[str, str], tuple[int, Placement]] = {}
        self.base: sf.Body = next((body for body in system.bodies if body.joint is None), sf.RigidBody(WORLD))
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
            root = (mover, X_BF)
            if isinstance(body, sf.Beam):
                self._add_elastic(body, *root)
                mover, X_BF = len(self.movers) - 1, Placement.identity()
                self._add_stations(body, root, mover)
            self._add_mass(body, mover, X_BF)
            self._add_frames(body, root, (mover, X_BF))
            for child in self._reversed_children(body):
                assert child.joint is not None
                on, X = root if child.joint.frame is None else (mover, X_BF)
                if isinstance(body, sf.Beam) and child.joint.frame is not None:
                    on, X = self.stations[body.name, child.joint.frame]
                pending.append((child, on, X @ self._proximal(body, child)))

    def _reversed_children(self, body: sf.Body) -> list[sf.Body]:
        return self.children.get(body.name, [])[::-1]

    def _proximal(self, parent: sf.Body, child: sf.Body) -> Placement:
        joint = child.joint
        assert joint is not None
        X = self.placement(joint.position, joint.rotation)
        if joint.frame is None:
            return X
        frame = next(frame for frame in parent.frames if frame.name == joint.frame)
        return self.placement(frame.position, frame.rotation) @ X

    def _add_mover(self, body: sf.Body, joint: sf.Joint, parent: int, X_AP: Placement) -> None:
        parts = series(joint)
        pitch = float(self.numbers([joint.pitch])[0])
        q, v = (self.joints[-1].q.stop, self.joints[-1].v.stop) if self.joints else (0, 0)
        nq, nv = sum(part.coordinates for part in parts), sum(part.speeds for part in parts)
        if joint.prescribed:
            nq = nv = 0
        self.joints.append(Described(joint, slice(q, q + nq), slice(v, v + nv)))
        for i, part in enumerate(parts):
            axis = self.numbers(part.axis)
            if part.coordinates == 1:
                axis = axis / np.linalg.norm(axis)
            name = joint.name if len(parts) == 1 else coordinate_symbols(joint)[part.first]
            q_part, v_part = slice(q, q), slice(v, v)
            if not joint.prescribed:
                q_part = slice(q + part.first, q + part.first + part.coordinates)
                v_part = slice(v + part.first, v + part.first + part.speeds)
            self.movers.append(Mover(body.name, name, joint, part, i > 0, parent, X_AP, axis, q_part, v_part, pitch))
            parent, X_AP = len(self.movers) - 1, Placement.identity()

    def _add_elastic(self, beam: sf.Beam, root: int, X_BF: Placement) -> None:
        """The elastic coordinates, between root and tip; no rigid engine is built from them."""
        q, v = (self.joints[-1].q.stop, self.joints[-1].v.stop) if self.joints else (0, 0)
        n = beam.modes
        joint = sf.Joint(f"{beam.name}.elastic", "general", beam.name, coordinates=beam.coordinates)
        described = Described(joint, slice(q, q + n), slice(v, v + n))
        self.joints.append(described)
        part, along_x = Part("elastic", joint.axis, 0, n, n), np.array([1.0, 0.0, 0.0])
        length = float(self.numbers([beam.length])[0])
        own = described.q, described.v
        is_rod = beam.elastic.is_exact
        mover = Mover(
            beam.name, joint.name, joint, part, False, root, X_BF, along_x, *own, length=length, is_rod=is_rod
        )
        self.movers.append(mover)

    def _add_stations(self, beam: sf.Beam, root: tuple[int, Placement], tip: int) -> None:
        """The beam's sections with frames: root, tip, or a mover of its own without coordinates."""
        length = float(self.numbers([beam.length])[0])
        places = {0.0: root, 1.0: (tip, Placement.identity())}
        for frame in beam.frames:
            xi = 1.0 if frame.at is None else frame.at
            if xi not in places:
                q, v = self.joints[-1].q.stop, self.joints[-1].v.stop
                joint = sf.Joint(f"{beam.name}.{frame.name}", "fixed", beam.name)
                part, along_x = Part("section", joint.axis, 0, 0, 0), np.array([1.0, 0.0, 0.0])
                none = slice(q, q), slice(v, v)
                self.movers.append(
                    Mover(
                        beam.name,
                        joint.name,
                        joint,
                        part,
                        False,
                        tip,
                        Placement.identity(),
                        along_x,
                        *none,
                        length=xi * length,
                    )
                )
                places[xi] = len(self.movers) - 1, Placement.identity()
            self.stations[beam.name, frame.name] = places[xi]

    def _add_mass(self, body: sf.Body, mover: int, X_BF: Placement) -> None:
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

    def _add_frames(self, body: sf.Body, root: tuple[int, Placement], ends: tuple[int, Placement]) -> None:
        """The body frame at its root; extremity frames where its ends are, which for a beam is another mover."""
        self.frames.append((body.name, body.name, FrameSite(body.name, *root)))
        mover, X_BE = ends
        for frame in body.frames:
            if isinstance(body, sf.Beam):
                mover, X_BE = self.stations[body.name, frame.name]
            X = X_BE @ self.placement(frame.position, frame.rotation)
            self.frames.append((frame.name, f"{body.name}.{frame.name}", FrameSite(frame.name, mover, X)))


def anchor_name(assembly: Assembly, anchor: tuple[str, str | None]) -> str:
    """The public name of the frame that an anchor names; "" for the world's own."""
    body, frame = anchor
    if frame is None:
        return body if body in assembly.frames and body != "world" else ""
    qualified = f"{body}.{frame}"
    return qualified if qualified in assembly.frames else frame
