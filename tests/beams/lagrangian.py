"""An oracle for trees with beams: Lagrange's equations by quadrature and automatic differentiation (CasADi).

The energies are written down as they stand in docs/theory/beams.md, for everything kept; nothing is derived by hand,
and nothing is shared with the generator: velocities, momenta, M and h are derivatives that CasADi takes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from tests.beams.shapes import Shape

Section = float | Callable[[float], float]
SX = Any  # CasADi has no types.

# Gauss nodes an interval: exact to degree 23, and clamped-free modes to rounding.
POINTS = 12


class Line(NamedTuple):
    """A force and a moment on the axis: at a station x [m], or per length at every x, in B or in the world."""

    force: Callable[[float], Sequence[float]]
    torque: Callable[[float], Sequence[float]] | None = None
    at: float | None = None
    world: bool = False


@dataclass(frozen=True)
class Flexible:
    """A beam along x, clamped to its frame; its functions are of x [m], and smooth between breaks."""

    length: float
    rhoA: Section
    v: tuple[Shape, ...] = ()
    w: tuple[Shape, ...] = ()
    twist: tuple[Shape, ...] = ()
    EI_z: Section = 0.0
    EI_y: Section = 0.0
    GJ: Section = 0.0
    rhoJ: Section = 0.0
    rhoI_y: Section = 0.0
    rhoI_z: Section = 0.0
    damping: float = 0.0
    foreshortening: bool = True
    rotary_inertia: bool = False
    breaks: tuple[float, ...] = ()
    loads: tuple[Line, ...] = ()


@dataclass(frozen=True)
class Solid:
    """A rigid body: mass, mass centre in its frame, moments of inertia about it along the frame's axes."""

    mass: float
    center: tuple[float, float, float] = (0.0, 0.0, 0.0)
    moments: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Node:
    """A body with the joint that carries it on the world (-1), on a body, or on a beam's tip.

    `motion` gives position and rotation in the parent's frame, of the joint's coordinates (a CasADi vector).
    """

    parent: int
    body: Flexible | Solid
    count: int = 0
    motion: Callable[[SX], tuple[SX, SX]] = lambda q: (ca.SX.zeros(3), ca.SX.eye(3))
    prescribed: bool = False


class Terms(NamedTuple):
    """M (nv, nv), h and Q (nv), kinetic and potential energy at one state."""

    M: np.ndarray
    h: np.ndarray
    Q: np.ndarray
    T: float
    V: float


def about(axis: Sequence[float], angle: SX) -> SX:
    """The rotation about a unit axis (Rodrigues)."""
    n = np.array(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return ca.SX(np.eye(3)) + ca.sin(angle) * ca.SX(K) + (1 - ca.cos(angle)) * ca.SX(K @ K)


class Lagrangian:
    """Kinetic and potential energy of a tree, and the equations that follow from them."""

    def __init__(self, nodes: Sequence[Node], gravity: Sequence[float] = (0.0, 0.0, -9.81)) -> None:
        self.gravity = ca.SX(np.array(gravity, dtype=float))
        nq = sum(_modes(node.body) + (0 if node.prescribed else node.count) for node in nodes)
        ns = sum(node.count for node in nodes if node.prescribed)
        self.q, self.v = ca.SX.sym("q", nq), ca.SX.sym("v", nq)
        s, s_rate, s_rate2 = (ca.SX.sym(name, ns) for name in ("s", "ds", "dds"))
        self.all_q, self.all_v = ca.vertcat(self.q, s), ca.vertcat(self.v, s_rate)
        self.T = self.weight = self.strain = ca.SX(0)
        self.viscous = ca.SX(0)  # Rayleigh's dissipation function.
        self.power = ca.SX(0)  # Of loads.
        at_q = at_s = 0
        carried: list[tuple[SX, SX]] = []  # What each body shows its children: its frame, or its tip.
        for node in nodes:
            if node.prescribed:
                own, at_s = s[at_s : at_s + node.count], at_s + node.count
            else:
                own, at_q = self.q[at_q : at_q + node.count], at_q + node.count
            p, R = node.motion(own)
            if node.parent >= 0:
                p_A, R_A = carried[node.parent]
                p, R = p_A + R_A @ p, R_A @ R
            if isinstance(node.body, Solid):
                self._solid(node.body, p, R)
                carried.append((p, R))
            else:
                modes = _modes(node.body)
                carried.append(self._beam(node.body, p, R, slice(at_q, at_q + modes)))
                at_q += modes
        momentum = ca.gradient(self.T, self.v)
        h = ca.jtimes(momentum, self.all_q, self.all_v) - ca.gradient(self.T - self.weight, self.q)
        if ns:
            h += ca.jtimes(momentum, s_rate, s_rate2)
        Q = ca.gradient(self.power - self.viscous, self.v) - ca.gradient(self.strain, self.q)
        outputs = [ca.jacobian(momentum, self.v), h, Q, self.T, self.weight + self.strain]
        self._terms = ca.Function("terms", [self.q, self.v, s, s_rate, s_rate2], outputs)

    def __call__(self, q: np.ndarray, v: np.ndarray, driven: Sequence[Sequence[float]] = ((), (), ())) -> Terms:
        """All terms at a state; `driven` are the prescribed coordinates, their rates and second rates."""
        M, h, Q, T, V = (np.array(x) for x in self._terms(q, v, *(np.array(x, dtype=float) for x in driven)))
        return Terms(M, h.ravel(), Q.ravel(), float(T.item()), float(V.item()))

    def _rate(self, x: SX) -> SX:
        return ca.reshape(ca.jtimes(ca.vec(x), self.all_q, self.all_v), *x.shape)

    def _spin(self, R: SX) -> SX:
        """Angular velocity along the turned axes."""
        W = R.T @ self._rate(R)
        return ca.vertcat(W[2, 1], W[0, 2], W[1, 0])

    def _solid(self, body: Solid, p: SX, R: SX) -> None:
        c = p + R @ ca.SX(np.array(body.center))
        velocity, spin = self._rate(c), self._spin(R)
        self.T += 0.5 * (body.mass * ca.sumsqr(velocity) + ca.dot(ca.SX(np.array(body.moments)), spin**2))
        self.weight -= body.mass * ca.dot(self.gravity, c)

    def _beam(self, beam: Flexible, p: SX, R: SX, elastic: slice) -> tuple[SX, SX]:
        """Add a beam's energies; return position and rotation of its tip."""
        q, rates = self.q[elastic], self.v[elastic]
        x, weight = stations(beam.length, beam.breaks)
        r, angles, slopes = _deformed(beam, x, q)
        sections = [[_at(value, xi) for xi in x] for value in (beam.rhoA, beam.GJ, beam.EI_y, beam.EI_z)]
        rhoA, GJ, EI_y, EI_z = (np.array(values) * weight for values in sections)
        places = ca.repmat(p, 1, len(x)) + R @ r
        self.T += 0.5 * ca.dot(ca.SX(rhoA), ca.sum1(self._rate(places) ** 2).T)
        self.weight -= ca.dot(ca.SX(rhoA), (self.gravity.T @ places).T)
        self._turning(beam, x, weight, angles, self._spin(R))
        self.strain += _strain_energy(angles, slopes, GJ, EI_y, EI_z)
        squares = ca.dot(ca.SX(GJ), slopes[0] ** 2) + ca.dot(ca.SX(EI_y), slopes[1] ** 2)
        stiffness = ca.hessian(0.5 * (squares + ca.dot(ca.SX(EI_z), slopes[2] ** 2)), q)[0]
        self.viscous += 0.5 * beam.damping * rates.T @ stiffness @ rates
        for line in beam.loads:
            self._load(beam, line, p, R, q)
        return _section(beam, beam.length, p, R, q)

    def _load(self, beam: Flexible, line: Line, p: SX, R: SX, q: SX) -> None:
        """The power of a load: of its force on the centroid, of its moment on the section, which turns exactly."""
        x, weight = ([line.at], [1.0]) if line.at is not None else stations(beam.length, beam.breaks)
        for xi, w in zip(x, weight, strict=True):
            place, turned = _section(beam, xi, p, R, q)
            axes = ca.SX.eye(3) if line.world else R
            self.power += w * ca.dot(axes @ ca.SX(np.array(line.force(xi), dtype=float)), self._rate(place))
            if line.torque is not None:
                moment = axes @ ca.SX(np.array(line.torque(xi), dtype=float))
                self.power += w * ca.dot(moment, turned @ self._spin(turned))

    def _turning(self, beam: Flexible, x: np.ndarray, weight: np.ndarray, angles: tuple[SX, ...], w_B: SX) -> None:
        """Kinetic energy of sections that turn: about the axis alone, or about all three of their own axes."""
        F, T, P = angles
        dF, dT, dP = (self._rate(angle) for angle in angles)
        rhoJ, rhoI_y, rhoI_z = (
            np.array([_at(value, xi) for xi in x]) * weight for value in (beam.rhoJ, beam.rhoI_y, beam.rhoI_z)
        )
        if not beam.rotary_inertia:
            self.T += 0.5 * ca.dot(ca.SX(rhoJ), (w_B[0] + dF) ** 2)
            return
        one = 1 - P**2 / 2 - T**2 / 2, P, -T
        two = F * T - P, 1 - F**2 / 2 - P**2 / 2, F
        three = F * P + T, P * T - F, 1 - F**2 / 2 - T**2 / 2
        spins = dF - T * dP, dT + F * dP, dP - F * dT
        for inertia, axis, spin in zip((rhoJ, rhoI_y, rhoI_z), (one, two, three), spins, strict=True):
            rate = axis[0] * w_B[0] + axis[1] * w_B[1] + axis[2] * w_B[2] + spin
            self.T += 0.5 * ca.dot(ca.SX(inertia), rate**2)


def stations(length: float, breaks: Sequence[float], points: int = POINTS) -> tuple[np.ndarray, np.ndarray]:
    """Gauss nodes and weights from 0 to length, interval by interval between breaks."""
    node, w = np.polynomial.legendre.leggauss(points)
    ends = [0.0, *(b for b in sorted(breaks) if 0.0 < b < length), length]
    half = np.diff(ends) / 2
    x = np.concatenate([a + h * (node + 1) for a, h in zip(ends, half, strict=False)])
    return x, np.concatenate([h * w for h in half])


def _strain_energy(angles: tuple[SX, ...], slopes: tuple[SX, ...], GJ: Any, EI_y: Any, EI_z: Any) -> SX:
    """1/2 the integral of GJ k1^2 + EI_y k2^2 + EI_z k3^2 up to third degree."""
    F, T, _ = angles
    dF, dT, dP = slopes
    first = dF**2 - 2 * dF * T * dP
    second = dT**2 + 2 * dT * F * dP
    third = dP**2 - 2 * dP * F * dT
    return 0.5 * (ca.dot(ca.SX(GJ), first) + ca.dot(ca.SX(EI_y), second) + ca.dot(ca.SX(EI_z), third))


def _deformed(beam: Flexible, x: np.ndarray, q: SX) -> tuple[SX, tuple[SX, ...], tuple[SX, ...]]:
    """Centroids (3, n), angles F, T, P (n) and their derivatives by x, at stations of a deformed beam."""
    ends = np.cumsum([0, len(beam.v), len(beam.w), len(beam.twist)])
    q_v, q_w, q_F = (q[int(a) : int(b)] for a, b in zip(ends, ends[1:], strict=False))

    def modal(shapes: tuple[Shape, ...], own: SX, order: int) -> SX:
        if not shapes:
            return ca.SX.zeros(len(x))
        return ca.SX(np.array([shape[order](x) for shape in shapes]).T) @ own

    u = ca.SX.zeros(len(x))
    if beam.foreshortening:
        for shapes, own in ((beam.v, q_v), (beam.w, q_w)):
            if shapes:
                u -= ca.vertcat(*(0.5 * own.T @ ca.SX(_slopes_squared(beam, shapes, xi)) @ own for xi in x))
    r = ca.horzcat(ca.SX(x) + u, modal(beam.v, q_v, 0), modal(beam.w, q_w, 0)).T
    angles = modal(beam.twist, q_F, 0), -modal(beam.w, q_w, 1), modal(beam.v, q_v, 1)
    slopes = modal(beam.twist, q_F, 1), -modal(beam.w, q_w, 2), modal(beam.v, q_v, 2)
    return r, angles, slopes


def _section(beam: Flexible, x: float, p: SX, R: SX, q: SX) -> tuple[SX, SX]:
    """Position and rotation of one section in the world."""
    r, (F, T, P), _ = _deformed(beam, np.array([x]), q)
    return p + R @ r, R @ about((0, 0, 1), P) @ about((0, 1, 0), T) @ about((1, 0, 0), F)


def _slopes_squared(beam: Flexible, shapes: tuple[Shape, ...], x: float) -> np.ndarray:
    """H: the integral of phi' phi'^T from the root to x."""
    inner, weight = stations(x, beam.breaks)
    slopes = np.array([shape[1](inner) for shape in shapes])
    return (slopes * weight) @ slopes.T


def _modes(body: Flexible | Solid) -> int:
    return len(body.v) + len(body.w) + len(body.twist) if isinstance(body, Flexible) else 0


def _at(value: Section, x: float) -> float:
    return float(value(x)) if callable(value) else value
