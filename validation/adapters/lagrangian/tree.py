"""Lagrange's equations of a tree of rigid bodies and beams, by automatic differentiation (CasADi).

Kinetic and potential energy are written down; momenta, M and h are derivatives that CasADi takes, and nothing is
shared with the generator. Where speeds are not rates of coordinates (ball and free joints), derivatives are those by a
displacement e of the state along the speeds,

    turn by the quaternion (e/2, sqrt(1 - e.e/4)),   shift by x + e x x / 2   (x: the linear part)            (1)

which follows the motion at constant speeds to second order. Lagrange's equations take no more than second derivatives,
so at e = 0 those in e are those in our speeds: e' = v, e'' = v'. Away from e = 0, v = T(e) e' with T' u = -1/2 v x u,
the cross product of motions, which the rates of Jacobians need.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import casadi as ca
import numpy as np

from ...mechanics.geometry import Array
from . import beam as beams
from . import rod as rods
from .beam import SX, Flexible
from .rod import ExactRod

Manifold = Literal["flat", "ball", "free"]


class Pose(NamedTuple):
    """A frame in the world, and its rates."""

    p: SX
    R: SX
    dp: SX
    dR: SX

    def carried(self, p: SX, R: SX, dp: SX, dR: SX) -> Pose:
        """A frame placed in this one, which moves there with the rates dp, dR."""
        return Pose(self.p + self.R @ p, self.R @ R, self.dp + self.dR @ p + self.R @ dp, self.dR @ R + self.R @ dR)

    def place(self, p: SX, dp: SX) -> tuple[SX, SX]:
        """Places in this frame (3, n), in the world, and their velocities."""
        n = p.shape[1]
        return ca.repmat(self.p, 1, n) + self.R @ p, ca.repmat(self.dp, 1, n) + self.dR @ p + self.R @ dp

    def spin(self) -> SX:
        """Angular velocity along the frame's axes."""
        W = self.R.T @ self.dR
        return ca.vertcat(W[2, 1], W[0, 2], W[1, 0])


GROUND = Pose(ca.SX.zeros(3), ca.SX.eye(3), ca.SX.zeros(3), ca.SX.zeros(3, 3))


def displaced(manifold: Manifold, q: SX, e: SX) -> SX:
    """Coordinates after a displacement along the speeds (1)."""
    if manifold == "flat":
        return q + e
    if manifold == "ball":
        half = e / 2
        turn, scalar = half, ca.sqrt(1 - ca.sumsqr(half))
        vector = q[3] * turn + scalar * q[:3] + ca.cross(q[:3], turn)
        return ca.vertcat(vector, q[3] * scalar - ca.dot(q[:3], turn))
    shift = e[:3] + ca.cross(e[3:], e[:3]) / 2
    return ca.vertcat(q[:3] + quaternion_rotation(q[3:]) @ shift, displaced("ball", q[3:], e[3:]))


def quaternion_rotation(quaternion: SX) -> SX:
    """R of a unit quaternion (x, y, z, w)."""
    K = ca.skew(quaternion[:3])
    return ca.SX.eye(3) + 2 * quaternion[3] * K + 2 * (K @ K)


WORLD = -1
_COORDINATES: dict[Manifold, Callable[[int], int]] = {"flat": lambda n: n, "ball": lambda n: 4, "free": lambda n: 7}


@dataclass(frozen=True)
class Solid:
    """A rigid body: mass, mass centre in its frame, Ixx, Iyy, Izz (, Ixy, Ixz, Iyz) about it along the frame's axes."""

    mass: float
    center: Sequence[float] = (0.0, 0.0, 0.0)
    moments: Sequence[float] = (0.0, 0.0, 0.0)


class Rotor(NamedTuple):
    """A rotor driven by a speed of the joint of its node; carrier is a node, or WORLD, which is at rest."""

    inertia: float
    ratio: float
    coordinate: int
    carrier: int
    axis: Sequence[float]


def _clamped(_: SX) -> tuple[SX, SX]:
    return ca.SX.zeros(3), ca.SX.eye(3)


@dataclass(frozen=True)
class Node:
    """A body with the joint that carries it on the world, on a body, or on a beam's tip.

    Attributes:
        parent: Index of a node, or WORLD.
        body: Body; None for one without mass.
        count: Number of speeds of the joint.
        motion: Position and rotation in the parent's frame, of the joint's coordinates.
        prescribed: Whether the joint's motion is given.
        manifold: Manifold of the coordinates: "ball" (quaternion x, y, z, w), "free" (position, quaternion) or "flat".
        rotors: Rotors that the joint drives.
        at: Index of its first coordinate and speed, among the free or the prescribed ones; None: after those of the
            node before.
        tip: A rigid body fixed to the tip of a beam, in the tip's frame.
        station: Distance from the root of a section of the beam that is the parent, which it stands for [m].
    """

    parent: int
    body: Flexible | ExactRod | Solid | None
    count: int = 0
    motion: Callable[[SX], tuple[SX, SX]] = _clamped
    prescribed: bool = False
    manifold: Manifold = "flat"
    rotors: tuple[Rotor, ...] = ()
    tip: Solid | None = None
    at: tuple[int, int] | None = None
    station: float | None = None

    @property
    def coordinates(self) -> int:
        """Number of coordinates of the joint."""
        return _COORDINATES[self.manifold](self.count)

    @property
    def modes(self) -> int:
        """Number of elastic coordinates, after the joint's."""
        return self.body.modes if isinstance(self.body, Flexible | ExactRod) else 0


class Terms(NamedTuple):
    """M (nv, nv), h and Q (nv), kinetic and potential energy at one state."""

    M: Array
    h: Array
    Q: Array
    T: float
    V: float


@dataclass(frozen=True)
class Symbols:
    """What the energies are functions of.

    Prescribed joints have s, ds, dds; e and es are displacements (1).

    Attributes:
        seen: The speeds again, as formulas of forces see them: virtual power does not differentiate those.
        u: Named inputs.
    """

    q: SX
    e: SX
    v: SX
    a: SX
    s: SX
    es: SX
    ds: SX
    dds: SX
    seen: SX
    u: SX

    @staticmethod
    def of(nodes: Sequence[Node], inputs: int = 0) -> Symbols:
        """New symbols of the sizes that a tree's nodes need."""
        modes = sum(node.modes for node in nodes)
        nq, nv = ([node.coordinates for node in nodes], [node.count for node in nodes])
        free = [not node.prescribed for node in nodes]
        sizes = {
            "q": modes + sum(n for n, own in zip(nq, free, strict=True) if own),
            "v": modes + sum(n for n, own in zip(nv, free, strict=True) if own),
            "s": sum(n for n, own in zip(nq, free, strict=True) if not own),
            "ds": sum(n for n, own in zip(nv, free, strict=True) if not own),
        }
        taken_as = {"q": "q", "e": "v", "v": "v", "a": "v", "s": "s", "es": "ds", "ds": "ds", "dds": "ds", "seen": "v"}
        return Symbols(
            **{name: ca.SX.sym(name, sizes[as_]) for name, as_ in taken_as.items()}, u=ca.SX.sym("u", inputs)
        )

    def function(self, name: str, output: SX) -> Any:
        """CasADi function of (q, v, a, s, ds, dds, u), evaluated at the state itself: displacements are set to zero."""
        moved = ca.vertcat(self.e, self.es, self.seen)
        stayed = ca.vertcat(self.e * 0, self.es * 0, self.v)
        at_state = ca.substitute(output, moved, stayed)
        return ca.Function(name, [self.q, self.v, self.a, self.s, self.ds, self.dds, self.u], [at_state])


class Lagrangian:
    """Kinetic and potential energy of a tree, and the equations that follow from them.

    Args:
        nodes: Parents before children; coordinates are in this order, a joint's before its beam's.
        gravity: Acceleration of gravity in the world [m/s^2].
        symbols: Symbols of which loads are formulas; None: new ones.
    """

    def __init__(
        self, nodes: Sequence[Node], gravity: Sequence[float] = (0.0, 0.0, -9.81), symbols: Symbols | None = None
    ) -> None:
        self.symbols = x = Symbols.of(nodes) if symbols is None else symbols
        self.gravity = ca.SX(np.array(gravity, dtype=float))
        self.T = self.weight = self.strain = ca.SX(0)
        self.viscous = ca.SX(0)  # Rayleigh's dissipation function.
        self.power = ca.SX(0)  # Of loads.
        self.shown: list[Pose] = []  # What each body shows its children: its frame, or its tip.
        self._sections: dict[int, Callable[[float], Pose]] = {}  # Sections of beams, by node.
        speeds: list[SX] = []
        at = {False: (0, 0), True: (0, 0)}  # Next coordinate and speed: free, prescribed.
        for node in nodes:
            i, k = node.at or at[node.prescribed]
            at[node.prescribed] = i + node.coordinates, k + node.count
            own = self._joint(node, i, k) if node.station is None else self._sections[node.parent](node.station)
            speeds.append((x.ds if node.prescribed else x.v)[k : k + node.count])
            if isinstance(node.body, Flexible | ExactRod):
                i, k = (i + node.coordinates, k + node.count) if not node.prescribed else at[False]
                at[False] = i + node.modes, k + node.modes
                self.shown.append(self._beam(node.body, own, i, k))
                if node.tip is not None:
                    self._solid(node.tip, self.shown[-1])
            else:
                self.shown.append(own)
                if node.body is not None:
                    self._solid(node.body, own)
        for node, rates in zip(nodes, speeds, strict=True):
            for rotor in node.rotors:
                self._rotor(rotor, rates[rotor.coordinate])
        self._derive()

    def __call__(self, q: Array, v: Array, driven: Sequence[Sequence[float]] = ((), (), ())) -> Terms:
        """All terms at a state; `driven` are the prescribed coordinates, their rates and second rates."""
        s, ds, dds = (np.array(x, dtype=float) for x in driven)
        nv = self.symbols.v.shape[0]
        unit, still, u = np.eye(nv), np.zeros(nv), np.zeros(self.symbols.u.shape[0])
        M = np.array([self.momentum(q, column, still, s, 0 * ds, dds, u) for column in unit]).reshape(nv, nv)
        given = q, v, still, s, ds, dds, u
        h, Q = (np.array(f(*given)).ravel() for f in (self.force, self.applied))
        return Terms(M, h, Q, float(self.kinetic(*given)), float(self.potential(*given)))

    def _derive(self) -> None:
        """The functions: momentum (M v + of the driven), force (M a + h), applied (Q), kinetic, potential."""
        x = self.symbols
        momentum = ca.gradient(self.T, x.v)
        force = rate_of(x, momentum) - ca.gradient(self.T - self.weight, x.e)
        applied = ca.gradient(self.power - self.viscous, x.v) - ca.gradient(self.strain, x.e)
        self.momentum = x.function("momentum", momentum)
        self.force = x.function("force", force)
        self.applied = x.function("applied", applied)
        self.kinetic = x.function("kinetic", self.T)
        self.potential = x.function("potential", self.weight + self.strain)

    def _joint(self, node: Node, i: int, k: int) -> Pose:
        x = self.symbols
        q, e, v = (x.s, x.es, x.ds) if node.prescribed else (x.q, x.e, x.v)
        e, v = e[k : k + node.count], v[k : k + node.count]
        p, R = node.motion(displaced(node.manifold, q[i : i + node.coordinates], e))
        parent = self.shown[node.parent] if node.parent != WORLD else GROUND
        return parent.carried(p, R, _rate(p, e, v), _rate(R, e, v))

    def _solid(self, body: Solid, pose: Pose) -> None:
        c, velocity = pose.place(ca.SX(np.array(body.center)), ca.SX.zeros(3))
        xx, yy, zz, xy, xz, yz = (*body.moments, *(0.0,) * (6 - len(body.moments)))
        J = ca.SX(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        spin = pose.spin()
        self.T += 0.5 * (body.mass * ca.sumsqr(velocity) + ca.dot(spin, J @ spin))
        self.weight -= body.mass * ca.dot(self.gravity, c)

    def _rotor(self, rotor: Rotor, speed: SX) -> None:
        """What spinning adds to a rotor that its carrier counts as locked."""
        spin = rotor.ratio * speed
        turning = ca.SX(0)
        if rotor.carrier != WORLD:
            turning = ca.dot(ca.SX(np.array(rotor.axis)), self.shown[rotor.carrier].spin())
        self.T += 0.5 * rotor.inertia * ((turning + spin) ** 2 - turning**2)

    def _beam(self, beam: Flexible | ExactRod, pose: Pose, i: int, k: int) -> Pose:
        """Add a beam's energies; return its tip."""
        x = self.symbols
        theory: Any = rods if isinstance(beam, ExactRod) else beams
        e, rates = x.e[k : k + beam.modes], x.v[k : k + beam.modes]
        q = x.q[i : i + beam.modes] + e

        def rate(expression: SX) -> SX:
            return _rate(expression, e, rates)

        # One more than a rod has sections with the root: products of two places are integrated exactly.
        points = beam.points + 2 if isinstance(beam, ExactRod) else beam.points
        at, weight = beams.stations(beam.length, beam.breaks, points)
        rhoA = ca.SX(beams.at_stations(beam.rhoA, at) * weight)
        r = rods.mass_centers(beam, at, q) if isinstance(beam, ExactRod) else beams.centroids(beam, at, q)
        places, velocities = pose.place(r, rate(r))
        self.T += 0.5 * ca.dot(rhoA, ca.sum1(velocities**2).T) + theory.turning_energy(beam, q, rate, pose.spin())
        self.weight -= ca.dot(rhoA, (self.gravity.T @ places).T)
        self.strain += theory.strain_energy(beam, q)
        self.viscous += theory.dissipation(beam, rates)

        def section(at: float) -> Pose:
            p, R = theory.section(beam, at, q)
            return pose.carried(p, R, rate(p), rate(R))

        for line in beam.loads:
            self._load(beam, line, pose, section)
        self._sections[len(self.shown)] = section
        return section(beam.length)

    def _load(self, beam: Flexible | ExactRod, line: beams.Line, pose: Pose, section: Callable[[float], Pose]) -> None:
        """The power of a load: of its force on the centroid, of its moment on the section, which turns exactly."""
        if line.at is not None:
            x, weight = np.array([line.at]), np.ones(1)
        elif isinstance(beam, ExactRod):
            x, weight = beam.at, beam.weights
        else:
            x, weight = beams.stations(beam.length, beam.breaks, beam.points)
        for xi, w in zip(x, weight, strict=True):
            here = section(float(xi))
            axes = {"world": ca.SX.eye(3), "body": pose.R, "section": here.R}[line.axes]
            self.power += w * ca.dot(axes @ ca.vertcat(*line.force(xi)), here.dp)
            if line.torque is not None:
                self.power += w * ca.dot(axes @ ca.vertcat(*line.torque(xi)), here.R @ here.spin())


def rate_of(x: Symbols, expression: SX) -> SX:
    """The rate of a function of displacements and speeds on a motion with the accelerations a and dds."""
    rate = ca.jtimes(expression, ca.vertcat(x.e, x.es), ca.vertcat(x.v, x.ds))
    return rate + ca.jtimes(expression, ca.vertcat(x.v, x.ds), ca.vertcat(x.a, x.dds))


def turning_of(x: Symbols, expression: SX) -> SX:
    """The rate of a function of displacements and speeds as its displacements change by a and dds, its speeds not."""
    return ca.jtimes(expression, ca.vertcat(x.e, x.es), ca.vertcat(x.a, x.dds))


def _rate(expression: SX, e: SX, v: SX) -> SX:
    return ca.reshape(ca.jtimes(ca.vec(expression), e, v), *expression.shape)
