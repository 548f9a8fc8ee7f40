"""The search for a configuration in which all forces balance: Newton's method, and a relaxation where it stalls.

docs/theory/linear.md, section 3; with states of forces docs/theory/states.md, section 6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.base.measures import TRANSLATION
from symofros.runtime.constrained import HALVINGS, LARGEST_STEP, null_space, pseudo_inverse
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.mass_matrix import mass_matrix
from symofros.simulation.analysis.reach import Reach
from symofros.simulation.analysis.states import prescribed_rates

Indices = npt.NDArray[np.intp]
# Rounding of a force at a configuration, relative to the forces that moving by the reach brings.
_ROUNDING = 8 * float(np.finfo(float).eps)
# Imbalance, relative to the largest force, at which a relaxation leaves the rest of the way to Newton's method.
_NEAR = 1e-6
# Stiffness, of the largest, that is neutral: an axis of symmetry leaves rounding.
_NEUTRAL = 1e-9
# Asymmetry of the stiffness, of the largest entry, from which forces have no potential.
_NO_POTENTIAL = 1e-6
# Mass that the relaxation adds to every motion, of their mean: bodies without mass have none.
_ADDED_MASS = 1e-9
# Difference of the residual's fall from a linear one, over it, up to which the next step may shift twice as far.
_LINEAR = 0.1
# By how much the damping of the relaxation may change from step to step.
_SLOWEST, _FASTEST = 4.0, 0.1


@dataclass(frozen=True)
class Balance:
    """Forces h - Q - G^T lam of a model whose speeds stay, and what binds its coordinates.

    States of forces are among the speeds (`Model.carried`): the last ones, whose rates have to vanish as forces have
    to balance. They are searched for beside the coordinates.

    Attributes:
        model: Model in double precision, its states of forces among its speeds.
        free: Indices of the speeds whose forces have to balance.
        searched: Indices of the states, among the speeds, that are searched for; others stay.
        v: Speeds that stay, and the guess of states (nv).
        u: Inputs (nu).
        par: Run-time parameters.
        t: Time [s].
        reach: How far the mechanism reaches.
    """

    model: Model
    free: Indices
    searched: Indices
    v: Array
    u: Array
    par: ArrayLike | None
    t: float
    reach: Reach

    @property
    def n(self) -> int:
        """Number of speeds of the mechanism, without states of forces."""
        return self.model.nv - len(self.model.record.state_names)

    @property
    def moves(self) -> bool:
        """Whether anything does, prescribed motions included."""
        return bool(np.any(self.v[: self.n]) or np.any(prescribed_rates(self.model, self.u)))

    @property
    def rows(self) -> Indices:
        """Indices of the conditions: balances of free speeds, rates of states, constraints."""
        return np.concatenate([self.free, np.arange(self.n, self.model.nv + self.model.nc)])

    @property
    def unknowns(self) -> Indices:
        """Indices of what is searched for: changes along free speeds, of states, multipliers."""
        return np.concatenate([self.free, self.searched, np.arange(self.model.nv, self.model.nv + self.model.nc)])

    def jacobian(self, q: Array) -> Array:
        """Constraint Jacobian G (nc, nv)."""
        if not self.model.nc:
            return np.zeros((0, self.model.nv))
        return self.model.constraint_jacobian(q, u=self.u, par=self.par, t=self.t)

    def forces(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Forces h - Q (nv), those of states their rates turned round, and the size of each condition (nv + nc).

        That of a force is the largest of h and Q, that of a rate its own, that of a constraint one. At rest by a
        function that knows no speeds, and no states.
        """
        n = self.n
        if np.any(v) or n < self.model.nv or not self.model.has("rest_forces"):
            _, h, Q = self.model.dynamics(q, v, self.u, par=self.par, t=self.t)
        else:
            h, Q = self.model.evaluate("rest_forces", q=q, u=self.u, par=self.par, t=self.t)
        sizes = np.concatenate([np.ones(self.model.nv), self.reach.conditions])
        sizes[:n] = np.maximum(self._largest(h), self._largest(Q))
        sizes[n : self.model.nv] = np.where(Q[n:] == 0.0, 1.0, np.abs(Q[n:]))
        return h - Q, sizes

    def mass(self, q: Array) -> Array:
        """Mass matrix M (nv, nv)."""
        return mass_matrix(self.model, q, self.v, self.u, self.par, self.t)

    def residual(self, q: Array, v: Array, lam: Array) -> tuple[Array, Array]:
        """Imbalance h - Q - G^T lam and residual phi (nv + nc), and the size of each condition (nv + nc)."""
        forces, sizes = self.forces(q, v)
        reaction = self.jacobian(q).T @ lam
        sizes[: self.n] = np.maximum(sizes[: self.n], self._largest(reaction))
        sizes[: self.n][sizes[: self.n] == 0.0] = 1.0
        return self.imbalance(q, forces, reaction), sizes

    def _largest(self, forces: Array) -> Array:
        """The largest force by its work along the reach, as the force on each speed that does as much (n)."""
        reach = self.reach.speeds[: self.n]
        return np.asarray(np.abs(forces[: self.n] * reach).max(initial=0.0) / reach)

    def units(self, K: Array, R: Array, sizes: Array) -> tuple[Array, Array]:
        """Units of the conditions and of the unknowns (nv + nc), in which no choice of kilogram or metre shows (7f).

        Args:
            K: Derivative of the conditions by the unknowns (nv + nc, nv + nc).
            R: Conditions (nv + nc).
            sizes: Their sizes (nv + nc).
        """
        n, nv, reach = self.n, self.model.nv, self.reach.speeds[: self.n]
        energies = np.abs(K[:n, :n]) * np.outer(reach, reach), np.abs(R[:n]) * reach, [1.0]
        energy = next(size for one in energies if (size := float(np.max(one, initial=0.0))) > 0.0)
        conditions = np.concatenate([energy / reach, sizes[n:nv], self.reach.conditions])
        unknowns = np.concatenate([reach, np.ones(nv - n), energy / self.reach.conditions])
        return conditions, unknowns

    def imbalance(self, q: Array, forces: Array, reaction: Array) -> Array:
        """Forces less reaction, and phi (nv + nc)."""
        if not self.model.nc:
            return forces - reaction
        return np.concatenate([forces - reaction, self.model.constraint(q, u=self.u, par=self.par, t=self.t)])

    def size(self, R: Array, sizes: Array) -> float:
        """The largest imbalance relative to the largest force; residuals of constraints as they are."""
        return float((np.abs(R) / sizes)[self.rows].max(initial=0.0))

    def stiffness(self, q: Array, v: Array, lam: Array) -> Array:
        """Derivative of h - Q - G^T lam by q, of states by themselves, at v' = 0 (nv, nv).

        At rest by a function that knows no speeds.
        """
        model, n = self.model, self.n
        if np.any(v) or n < model.nv:
            arguments = (q, v, np.zeros(model.nv), self.u, lam)
            by_q, by_v, *_ = model.residual_derivatives(*arguments, par=self.par, t=self.t)
            return np.concatenate([by_q[: model.nv, :n], by_v[: model.nv, n:]], axis=1)
        (K,) = model.evaluate("rest_stiffness", q=q, u=self.u, lam=lam, par=self.par, t=self.t)
        return np.asarray(K)

    def brought_rates(self, K: Array, v: Array, reach: Array) -> Array:
        """Rates (nz) that motions of the reach and states of the present size bring, by their derivatives (nz, nv)."""
        return np.asarray(np.abs(K) @ np.append(reach[: self.n], np.abs(v[self.n :])))

    def moved(self, q: Array, v: Array, step: Array) -> tuple[Array, Array]:
        """Configuration and speeds after a step (nv) along the coordinates, and of the states."""
        if self.n == self.model.nv:
            return self.model.integrate(q, step), v
        along, change = step.copy(), np.zeros(self.model.nv)
        along[self.n :], change[self.n :] = 0.0, step[self.n :]
        return self.model.integrate(q, along), v + change


@dataclass(frozen=True)
class Search:
    """State of a search for an equilibrium.

    Attributes:
        q: Configuration (nq).
        v: Speeds that stay, and states of forces (nv).
        lam: Multipliers (nc).
        R: Residual (nv + nc).
        sizes: Largest size of each condition on the way (nv + nc).
        count: Steps taken.
    """

    q: Array
    v: Array
    lam: Array
    R: Array
    sizes: Array
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
    lam = np.zeros(balance.model.nc)
    start = Search(q, balance.v, lam, *balance.residual(q, balance.v, lam), 0)
    newton = _newton(balance, start, tolerance, iterations)
    if balance.size(newton.R, newton.sizes) <= tolerance:
        return newton
    relaxed = _relax(balance, start, iterations)
    again = None if relaxed is None else _newton(balance, relaxed, tolerance, relaxed.count + iterations)
    if again is None or not balance.size(again.R, again.sizes) <= tolerance:
        return newton
    return again


def _newton(balance: Balance, start: Search, tolerance: float, most: int) -> Search:
    """Newton's method with exact derivatives; the norm of the residual falls from the second step on."""
    model, rows, unknowns, n = balance.model, balance.rows, balance.unknowns, balance.n
    nv, nc, reach = model.nv, model.nc, balance.reach.speeds
    q, v, lam, R, sizes, count = start.q, start.v, start.lam, start.R, start.sizes, start.count
    wider = 1.0
    while balance.size(R, sizes) > tolerance and count < most:
        G = balance.jacobian(q)
        K = np.zeros((nv + nc, nv + nc))
        K[:nv, :nv], K[:nv, nv:], K[nv:, :nv] = balance.stiffness(q, v, lam), -G.T, G
        if not np.all(np.isfinite(K)):  # As of sqrt(x) at zero, by which no force would be large.
            break
        if nv > n:
            sizes[n:nv] = np.fmax(sizes[n:nv], balance.brought_rates(K[n:nv, :nv], v, reach))
        brought = (np.abs(K[:n, :n]) @ reach[:n])[balance.free]  # Forces that a motion of the reach brings.
        if np.all(np.abs(R[balance.free]) <= _ROUNDING * brought):
            # A guess at rest but for rounding, where all forces vanish: nothing on the way says what small is.
            sizes[:n] = np.maximum(sizes[:n], (brought * reach[balance.free]).max(initial=0.0) / reach[:n])
        if balance.size(R, sizes) <= tolerance:
            break
        step = np.zeros(nv + nc)
        of_conditions, of_unknowns = balance.units(K, R, sizes)
        of_conditions, of_unknowns = of_conditions[rows], of_unknowns[unknowns]
        step[unknowns] = -of_unknowns * _least_change(
            K[np.ix_(rows, unknowns)] * of_unknowns / of_conditions[:, None],
            R[rows] / of_conditions,
            slice(len(balance.free), len(balance.free) + nv - n),
        )
        share, before = _bounded(step[:n], balance, wider), np.linalg.norm(R[rows] / of_conditions)
        step[:nv] *= share
        for _ in range(HALVINGS):
            (tried, v_tried), lam_tried = balance.moved(q, v, step[:nv]), lam + step[nv:]
            R_tried, sizes_tried = balance.residual(tried, v_tried, lam_tried)
            left = np.linalg.norm(R_tried[rows] / of_conditions)
            if left < before or count == 0:
                break
            step, share = 0.5 * step, 0.5 * share
        # Shifts of a mechanism have no size of their own that a first step could know.
        wider *= 2.0 if abs(left - (1.0 - share) * before) <= _LINEAR * share * before else 1.0
        # Forces may vanish one and all at rest: the largest on the way there is what small is measured by.
        sizes, count = np.fmax(sizes, sizes_tried), count + 1
        q, v, lam, R = tried, v_tried, lam_tried, R_tried
    return Search(q, v, lam, R, sizes, count)


def _least_change(K: Array, R: Array, rates: slice) -> Array:
    """The least x with K x = R; rows of rates, in units of their own, are brought to the size of the others."""
    largest = np.abs(K).max(axis=1, initial=0.0)
    for row in range(len(R))[rates]:
        factor = largest.max() / largest[row] if largest[row] > 0.0 else 1.0
        K[row], R[row] = factor * K[row], factor * R[row]
    return np.asarray(np.linalg.lstsq(K, R, rcond=1e-13)[0])


def _relax(balance: Balance, start: Search, iterations: int) -> Search | None:
    """A heavily damped motion towards a stable rest: steps (7b) of the implicit Euler method, the longer the nearer.

    States of forces follow: their rates vanish all the way.

    Returns:
        None where it does not come near balance.
    """
    model, free = balance.model, balance.free
    measures = model.record.measures.of_speeds(free)
    q, v, sizes, damping, before = start.q, start.v, start.sizes, 0.0, np.inf
    for count in range(iterations):
        forces, largest = balance.forces(q, v)
        jacobian = balance.jacobian(q)
        if not np.all(np.isfinite(jacobian)):  # As of a disc that lies flat, which touches the ground everywhere.
            return None
        G = jacobian[:, free]
        inverse, Z = pseudo_inverse(G, measures), null_space(G, measures)
        lam = inverse.T @ forces[free]
        R = balance.imbalance(q, forces, jacobian.T @ lam)
        sizes = np.fmax(sizes, largest)
        K = balance.stiffness(q, v, lam)
        if not (np.all(np.isfinite(R)) and np.all(np.isfinite(K))):
            return None
        following = _following(K, R, balance)
        by_states = K[np.ix_(free, balance.searched)]
        changed = by_states @ following.change
        K = K[np.ix_(free, free)] + by_states @ following.by_q
        Y = Z @ _unit_mass(Z.T @ balance.mass(q)[np.ix_(free, free)] @ Z)
        pull = Y.T @ (R[free] + changed)
        K, stable = _downhill(Y.T @ K @ Y)
        if stable and balance.size(R, sizes) <= _NEAR:
            return Search(q, v, lam, R, sizes, count)
        size = float(np.abs(pull).max(initial=0.0))
        if not count:  # The first step moves by the reach at most.
            damping = float(np.abs(Y @ pull / balance.reach.speeds[free]).max(initial=0.0)) / LARGEST_STEP
        elif size:
            damping *= min(_SLOWEST, max(_FASTEST, size / before))
        before = size or before
        step = np.zeros(model.nv)
        step[free] = -Y @ np.linalg.lstsq(K + damping * np.eye(len(K)), pull)[0]
        step *= _bounded(step[: balance.n], balance)
        for _ in range(HALVINGS):  # The forces at its end push back by half of what they push at its begin at most.
            step[balance.searched] = following.change + following.by_q @ step[free]
            ahead, _ = balance.forces(*balance.moved(q, v, step))
            if ahead[free] @ step[free] <= 0.5 * abs((forces[free] + changed) @ step[free]):
                break
            step *= 0.5
        step[free] -= inverse @ R[model.nv :]
        q, v = balance.moved(q, v, step)
    return None


def leaving(balance: Balance, end: Search) -> tuple[int, float] | None:
    """How an unstable rest is left by forces with a potential: along the least of the k_i of (7b).

    Returns:
        Speed that takes part most, by its reach, and sqrt(-k_i), the rate without damping [1/s]; None of a rest that is
        not unstable so.
    """
    model, free = balance.model, balance.free
    K, M = balance.stiffness(end.q, end.v, end.lam), balance.mass(end.q)[np.ix_(free, free)]
    if not (np.all(np.isfinite(K)) and np.all(np.isfinite(M))):
        return None
    Z = null_space(balance.jacobian(end.q)[:, free], model.record.measures.of_speeds(free))
    K = K[np.ix_(free, free)] + K[np.ix_(free, balance.searched)] @ _following(K, end.R, balance).by_q
    Y = Z @ _unit_mass(Z.T @ M @ Z)
    own = Y.T @ K @ Y
    if not own.size or np.abs(own - own.T).max() > _NO_POTENTIAL * np.abs(own).max():
        return None
    x = Y @ np.linalg.eigh(own)[1][:, 0]
    k = float(x @ K @ x)
    brought = float(x**2 @ (end.sizes[: model.nv] / balance.reach.speeds)[free])  # By forces that turn with the motion.
    if not k < -_NEUTRAL * max(brought, float(np.abs(x) @ np.abs(K) @ np.abs(x))):
        return None
    return int(free[np.argmax(np.abs(x) / balance.reach.speeds[free])]), float(np.sqrt(-k))


class _Following(NamedTuple):
    """States of forces as they follow the coordinates, so that their rates vanish.

    Attributes:
        change: Their change where the coordinates stay (nz).
        by_q: Their change by the free coordinates (nz, n).
    """

    change: Array
    by_q: Array


def _following(K: Array, R: Array, balance: Balance) -> _Following:
    """How the searched states follow, to first order; those that rest at any value stay (states.md, (22a))."""
    own, free = balance.searched, balance.free
    inverse = np.linalg.pinv(K[np.ix_(own, own)], rcond=_NEUTRAL)
    return _Following(-inverse @ R[own], -inverse @ K[np.ix_(own, free)])


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


def _bounded(step: Array, balance: Balance, wider: float = 1.0) -> float:
    """The factor of a step (n) that makes it no longer than LARGEST_STEP of the reach, shifts so many times wider."""
    shifts = np.equal(balance.model.record.measures.kinds(balance.model.nv)[: len(step)], TRANSLATION)
    extent = np.abs(step / balance.reach.steps[: len(step)]) / np.where(shifts, wider, 1.0)
    return min(1.0, LARGEST_STEP / max(float(extent.max(initial=0.0)), 1e-300))
