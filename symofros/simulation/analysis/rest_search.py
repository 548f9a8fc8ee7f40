"""The search for a configuration in which all forces balance: Newton's method, and a relaxation where it stalls.

docs/theory/linear.md, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.runtime.constrained import HALVINGS, LARGEST_STEP, null_space, pseudo_inverse
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.mass_matrix import mass_matrix

# Rounding of a force at a configuration, relative to the forces that moving by the reach brings.
_ROUNDING = 8 * float(np.finfo(float).eps)
# Imbalance, relative to the largest force, at which a relaxation leaves the rest of the way to Newton's method.
_NEAR = 1e-6
# Stiffness, of the largest, that is neutral: an axis of symmetry leaves rounding.
_NEUTRAL = 1e-9
# Mass that the relaxation adds to every motion, of their mean: bodies without mass have none.
_ADDED_MASS = 1e-9
# By how much the damping of the relaxation may change from step to step.
_SLOWEST, _FASTEST = 4.0, 0.1


@dataclass(frozen=True)
class Balance:
    """Forces h - Q - G^T lam of a model whose speeds stay, and what binds its coordinates.

    Attributes:
        model: Model in double precision.
        free: Indices of the speeds whose forces have to balance.
        v: Speeds that stay (nv).
        u: Inputs (nu).
        par: Run-time parameters.
        t: Time [s].
    """

    model: Model
    free: npt.NDArray[np.intp]
    v: Array
    u: Array
    par: ArrayLike | None
    t: float

    @property
    def rows(self) -> npt.NDArray[np.intp]:
        """Indices of the conditions: balances of free speeds, then constraints."""
        return np.concatenate([self.free, np.arange(self.model.nv, self.model.nv + self.model.nc)])

    def jacobian(self, q: Array) -> Array:
        """Constraint Jacobian G (nc, nv)."""
        if not self.model.nc:
            return np.zeros((0, self.model.nv))
        return self.model.constraint_jacobian(q, u=self.u, par=self.par, t=self.t)

    def forces(self, q: Array) -> tuple[Array, float]:
        """Forces h - Q (nv), and the largest of h and Q; at rest by a function that knows no speeds."""
        if np.any(self.v) or not self.model.has("rest_forces"):
            _, h, Q = self.model.dynamics(q, self.v, self.u, par=self.par, t=self.t)
        else:
            h, Q = self.model.evaluate("rest_forces", q=q, u=self.u, par=self.par, t=self.t)
        return h - Q, max(float(np.abs(h).max(initial=0.0)), float(np.abs(Q).max(initial=0.0)))

    def mass(self, q: Array) -> Array:
        """Mass matrix M (nv, nv)."""
        return mass_matrix(self.model, q, self.v, self.u, self.par, self.t)

    def residual(self, q: Array, lam: Array) -> tuple[Array, float]:
        """Imbalance h - Q - G^T lam and residual phi (nv + nc), and the largest force."""
        forces, scale = self.forces(q)
        reaction = self.jacobian(q).T @ lam
        return self.imbalance(q, forces, reaction), max(scale, float(np.abs(reaction).max(initial=0.0))) or 1.0

    def imbalance(self, q: Array, forces: Array, reaction: Array) -> Array:
        """Forces less reaction, and phi (nv + nc)."""
        if not self.model.nc:
            return forces - reaction
        return np.concatenate([forces - reaction, self.model.constraint(q, u=self.u, par=self.par, t=self.t)])

    def size(self, R: Array, scale: float) -> float:
        """The largest imbalance relative to the largest force; residuals of constraints as they are."""
        phi = R[self.model.nv :]
        return max(float(np.abs(R[self.free]).max(initial=0.0)) / scale, float(np.abs(phi).max(initial=0.0)))

    def stiffness(self, q: Array, lam: Array) -> Array:
        """Derivative of h - Q - G^T lam by q at v' = 0 (nv, nv); at rest by a function that knows no speeds."""
        model = self.model
        if np.any(self.v):
            arguments = (q, self.v, np.zeros(model.nv), self.u, lam)
            return model.residual_derivatives(*arguments, par=self.par, t=self.t)[0][: model.nv]
        (K,) = model.evaluate("rest_stiffness", q=q, u=self.u, lam=lam, par=self.par, t=self.t)
        return np.asarray(K)


@dataclass(frozen=True)
class Search:
    """State of a search for an equilibrium.

    Attributes:
        q: Configuration (nq).
        lam: Multipliers (nc).
        R: Residual (nv + nc).
        scale: Largest force on the way.
        count: Steps taken.
    """

    q: Array
    lam: Array
    R: Array
    scale: float
    count: int


def search_rest(balance: Balance, q: Array, tolerance: float, iterations: int) -> Search:
    """Newton's method from q; where it stalls, relaxation from q, and Newton's method from where that leads.

    Args:
        balance: What has to vanish.
        q: Guess (nq).
        tolerance: Bound of the imbalance, relative to the largest force.
        iterations: Most steps of each part.

    Returns:
        Where the search ends, whether or not there is balance: of two failures the one of Newton's method alone.
    """
    R, scale = balance.residual(q, np.zeros(balance.model.nc))
    start = Search(q, np.zeros(balance.model.nc), R, scale, 0)
    reach = _reach(balance.model, balance.par)
    newton = _newton(balance, start, reach, tolerance, iterations)
    if balance.size(newton.R, newton.scale) <= tolerance:
        return newton
    relaxed = _relax(balance, start, reach, iterations)
    again = None if relaxed is None else _newton(balance, relaxed, reach, tolerance, relaxed.count + iterations)
    if again is None or not balance.size(again.R, again.scale) <= tolerance:
        return newton
    return again


def _newton(balance: Balance, start: Search, reach: Array, tolerance: float, most: int) -> Search:
    """Newton's method with exact derivatives; the norm of the residual falls from the second step on."""
    model, rows = balance.model, balance.rows
    nv, nc = model.nv, model.nc
    q, lam, R, scale, count = start.q, start.lam, start.R, start.scale, start.count
    while balance.size(R, scale) > tolerance and count < most:
        G = balance.jacobian(q)
        K = np.zeros((nv + nc, nv + nc))
        K[:nv, :nv], K[:nv, nv:], K[nv:, :nv] = balance.stiffness(q, lam), -G.T, G
        brought = (np.abs(K[:nv, :nv]) @ reach)[balance.free]  # Forces that a motion of the reach brings.
        if np.all(np.abs(R[balance.free]) <= _ROUNDING * brought):
            # A guess at rest but for rounding, where all forces vanish: nothing on the way says what small is.
            scale = max(scale, float(brought.max(initial=0.0)))
            if balance.size(R, scale) <= tolerance:
                break
        step = np.zeros(nv + nc)
        step[rows] = -np.linalg.lstsq(K[np.ix_(rows, rows)], R[rows], rcond=1e-13)[0]
        step[:nv] *= _bounded(step[:nv], reach)
        for _ in range(HALVINGS):
            tried, lam_tried = model.integrate(q, step[:nv]), lam + step[nv:]
            R_tried, scale_tried = balance.residual(tried, lam_tried)
            if np.linalg.norm(R_tried[rows]) < np.linalg.norm(R[rows]) or count == 0:
                break
            step *= 0.5
        # Forces may vanish one and all at rest: the largest on the way there is what small is measured by.
        q, lam, R, scale, count = tried, lam_tried, R_tried, max(scale, scale_tried), count + 1
    return Search(q, lam, R, scale, count)


def _relax(balance: Balance, start: Search, reach: Array, iterations: int) -> Search | None:
    """A heavily damped motion towards a stable rest: steps (7b) of the implicit Euler method, the longer the nearer.

    Returns:
        None where it does not come near balance.
    """
    model, free = balance.model, balance.free
    measures = model.record.measures.of_speeds(free)
    q, scale, damping, before = start.q, start.scale, 0.0, np.inf
    for count in range(iterations):
        forces, largest = balance.forces(q)
        jacobian = balance.jacobian(q)
        G = jacobian[:, free]
        inverse, Z = pseudo_inverse(G, measures), null_space(G, measures)
        lam = inverse.T @ forces[free]
        R = balance.imbalance(q, forces, jacobian.T @ lam)
        scale = max(scale, largest)
        K = balance.stiffness(q, lam)
        if not (np.all(np.isfinite(R)) and np.all(np.isfinite(K))):
            return None
        Y = Z @ _unit_mass(Z.T @ balance.mass(q)[np.ix_(free, free)] @ Z)
        pull = Y.T @ R[free]
        K, stable = _downhill(Y.T @ K[np.ix_(free, free)] @ Y)
        if stable and balance.size(R, scale) <= _NEAR:
            return Search(q, lam, R, scale, count)
        size = float(np.abs(pull).max(initial=0.0))
        if not count:
            damping = size / LARGEST_STEP
        elif size:
            damping *= min(_SLOWEST, max(_FASTEST, size / before))
        before = size or before
        step = np.zeros(model.nv)
        step[free] = -Y @ np.linalg.lstsq(K + damping * np.eye(len(K)), pull)[0]
        step *= _bounded(step, reach)
        for _ in range(HALVINGS):  # The forces at its end push back by half of what they push at its begin at most.
            ahead, _ = balance.forces(model.integrate(q, step))
            if ahead[free] @ step[free] <= 0.5 * abs(forces[free] @ step[free]):
                break
            step *= 0.5
        step[free] -= inverse @ R[model.nv :]
        q = model.integrate(q, step)
    return None


def _unit_mass(M: Array) -> Array:
    """L^-T of (7a), which makes the mass of motions (n, n) the identity; _ADDED_MASS of its mean is added to it."""
    least = _ADDED_MASS * float(np.trace(M)) / max(len(M), 1) or 1.0
    return np.asarray(np.linalg.inv(np.linalg.cholesky(M + least * np.eye(len(M)))).T)


def _downhill(K: Array) -> tuple[Array, bool]:
    """A stiffness (n, n) with its negative directions turned round (7b), and whether it had none."""
    sizes, directions = np.linalg.eigh(0.5 * (K + K.T))
    turned = 2.0 * np.maximum(-sizes, 0.0)
    stable = bool(turned.max(initial=0.0) <= 2.0 * _NEUTRAL * np.abs(sizes).max(initial=0.0))
    return np.asarray(K + (directions * turned) @ directions.T), stable


def _bounded(step: Array, reach: Array) -> float:
    """The factor that makes a step no longer than LARGEST_STEP."""
    return min(1.0, LARGEST_STEP / max(float(np.abs(step / reach).max(initial=0.0)), 1e-300))


def _reach(model: Model, par: ArrayLike | None) -> Array:
    """Size of each speed's coordinate for the bound of a step (nv): the length of a beam for displacements along it."""
    reach = np.ones(model.nv)
    for beam in model.beams(par):
        reach[beam.in_v] = 1.0 / beam.scale
    return reach
