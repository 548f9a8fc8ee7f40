"""A model at a state, as procedures are asked about it: our equations behind plain functions, and its manifold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from scipy.linalg import expm, null_space
from scipy.spatial.transform import Rotation

import symofros as sf

from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array, skew

# Inputs as a function of time and state.
Law = Callable[[float, Array, Array], Array]
# Coordinates of a ball joint and of a free joint; all others are linear.
BALL, POSE = 4, 7
# Relative step of central differences of fourth order, whose error is some 1e-13 of the function.
DIFFERENCE = 1e-3


@dataclass(frozen=True)
class Cell:
    """One comparison of a procedure.

    Attributes:
        name: What was asked.
        error: Error, relative to the size of what is compared.
        tolerance: Bound of the error.
        note: A remark.
        absent: What is not installed that it takes; then nothing was compared.
    """

    name: str
    error: float
    tolerance: float
    note: str = ""
    absent: str = ""


@dataclass(frozen=True)
class Manifold:
    """Configurations as scipy and matrix exponentials have them, independent of the C (docs/theory/simulation.md, 1).

    Attributes:
        segments: First coordinate, first speed and number of coordinates of each joint, or part of one.
        nq: Number of coordinates; nv: number of speeds.
    """

    segments: tuple[tuple[int, int, int], ...]
    nq: int
    nv: int

    @classmethod
    def of(cls, assembly: Assembly) -> Manifold:
        """The manifold of a model."""
        parts: list[tuple[int, int, int]] = []
        for mover in assembly.movers:
            size = mover.q.stop - mover.q.start
            if mover.kind in ("ball", "free"):
                parts.append((mover.q.start, mover.v.start, size))
            else:  # A beam may have as many coordinates as a quaternion has components.
                parts += [(mover.q.start + k, mover.v.start + k, 1) for k in range(size)]
        return cls(tuple(parts), assembly.nq, assembly.nv)

    def retract(self, q: Array, theta: Array, twist: bool = False) -> Array:
        """Configuration q (+) theta, (1); with `twist`, poses move along the screw of that twist."""
        moved = np.array(q, dtype=float)
        for at, to, size in self.segments:
            if size not in (BALL, POSE):
                moved[at : at + size] += theta[to : to + size]
                continue
            p, r = at + size - BALL, to + size - BALL
            R = Rotation.from_quat(q[p : p + 4])
            if size == POSE:
                ahead = theta[to : to + 3]
                if twist:
                    screw = np.zeros((4, 4))
                    screw[:3, :3], screw[:3, 3] = skew(theta[r : r + 3]), ahead
                    ahead = expm(screw)[:3, 3]
                moved[at : at + 3] += R.apply(ahead)
            moved[p : p + 4] = (R * Rotation.from_rotvec(theta[r : r + 3])).as_quat()
        return moved

    def same_sign(self, q: Array, like: Array) -> Array:
        """Coordinates (n, nq) with each quaternion's sign as in `like`."""
        q = np.array(q)
        for at, _, size in self.segments:
            if size in (BALL, POSE):
                part = slice(at + size - 4, at + size)
                q[..., part] *= np.where((q[..., part] * like[..., part]).sum(-1, keepdims=True) < 0.0, -1.0, 1.0)
        return q

    def rate(self, theta: Array, v: Array) -> Array:
        """Rate of theta at speeds v, (2): the right Jacobian of the rotation is inverted, not its series."""
        rate = np.array(v, dtype=float)
        for _, to, size in self.segments:
            if size in (BALL, POSE):
                r = slice(to + size - BALL, to + size - 1)
                rate[r] = np.linalg.solve(tangent(-skew(theta[r])), v[r])
                if size == POSE:
                    rate[to : to + 3] = Rotation.from_rotvec(theta[r]).apply(v[to : to + 3])
        return rate

    def adjoint(self, theta: Array) -> Array:
        """Matrix ad(theta) (nv, nv): commutators of the twist theta with others."""
        ad = np.zeros((self.nv, self.nv))
        for _, to, size in self.segments:
            if size in (BALL, POSE):
                r = slice(to + size - BALL, to + size - 1)
                ad[r, r] = skew(theta[r])
                if size == POSE:
                    p = slice(to, to + 3)
                    ad[p, p], ad[p, r] = skew(theta[r]), skew(theta[p])
        return ad


def tangent(ad: Array) -> Array:
    """(exp(ad) - 1)/ad, by the exponential of a larger matrix."""
    n = len(ad)
    block = np.zeros((2 * n, 2 * n))
    block[:n, :n], block[:n, n:] = ad, np.eye(n)
    result: Array = expm(block)[:n, n:]
    return result


@dataclass(frozen=True)
class Scene:
    """A model at a first state.

    Attributes:
        model: Our compiled model.
        system: Description.
        manifold: Its configurations.
        q: First configuration, on the constraints.
        v: First speeds (nv).
        law: Inputs, as the reference evaluates them.
        u: The same inputs, as our runs are given them.
        gains: Baumgarte's gains, where constraints are kept by them.
        projects: Whether each state is projected onto the constraints.
        backend: How further models of the system are evaluated.
    """

    model: sf.Model
    system: sf.System
    manifold: Manifold
    q: Array
    v: Array
    law: Law
    u: Any = None
    gains: tuple[float, float] = (0.0, 0.0)
    projects: bool = True
    backend: Literal["c", "interpreter"] = "c"

    def equations(self, t: float, q: Array, v: Array) -> tuple[Array, Array, Array, Array]:
        """M, Q - h, G and the right side of G v' = ..., Baumgarte's terms included."""
        model, u = self.model, self.law(t, q, v)
        M, h, Q = model.dynamics(q, v, u, t=t)
        G, right = np.zeros((0, model.nv)), np.zeros(0)
        if model.nc:
            G = model.constraint_jacobian(q, u=u, t=t)
            right = model.constraint_bias(q, v, u=u, t=t)
            alpha, beta = self.gains
            phi = model.constraint(q, u=u, t=t)
            right = right - 2 * alpha * model.constraint_rate(q, v, u=u, t=t) - beta**2 * phi
        return M, Q - h, G, right

    def acceleration(self, t: float, q: Array, v: Array) -> Array:
        """Rates of the speeds: M v' = Q - h + G^T lam, G v' as stated, by one least-squares solution."""
        M, force, G, right = self.equations(t, q, v)
        n, nc = len(M), len(G)
        matrix = np.block([[M, -G.T], [G, np.zeros((nc, nc))]])
        a: Array = np.linalg.lstsq(matrix, np.concatenate([force, right]), rcond=1e-12)[0][:n]
        return a

    def projected(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """The nearest state on the constraints; the same one where there are none, or they are kept otherwise."""
        if not self.model.nc or not self.projects:
            return q, v
        on_q, on_v, _ = self.model.project(q, v, u=self.law(t, q, v), t=t)
        return on_q, on_v

    def slope(self, t: float, y: Array) -> Array:
        """Rate of y = (theta, v) in the chart about q."""
        nv = self.model.nv
        theta, v = y[:nv], y[nv:]
        a = self.acceleration(t, self.manifold.retract(self.q, theta), v)
        return np.concatenate([self.manifold.rate(theta, v), a])


def derivative(function: Callable[[Array], Array], x: Array, step: float = DIFFERENCE) -> Array:
    """Derivative (m, n) by central differences of fourth order."""
    columns = []
    for e in np.eye(len(x)) * step:
        near, far = function(x + e) - function(x - e), function(x + 2 * e) - function(x - 2 * e)
        columns.append((8 * near - far) / (12 * step))
    return np.stack(columns, axis=-1)


def freedoms(G: Array) -> Array:
    """An orthonormal basis (nv, k) of the speeds that conditions allow."""
    basis: Array = null_space(G) if len(G) else np.eye(G.shape[1])
    return basis


def off(ours: Array, reference: Array) -> float:
    """Largest difference relative to the largest entry; infinite for other shapes or NaN."""
    ours, reference = np.asarray(ours, dtype=float), np.asarray(reference, dtype=float)
    if ours.shape != reference.shape:
        return float("inf")
    size = float(np.abs(reference).max(initial=0.0)) or 1.0
    worst = float(np.abs(ours - reference).max(initial=0.0)) / size
    return worst if np.isfinite(worst) else float("inf")
