"""Constraints for engines that know trees: phi, G and gamma from an engine's own frames, and the solve in NumPy.

Written apart from `symofros.mechanics.dynamics.constraints`: conditions are stated by relative rotation matrices and
their derivatives rather than by pairs of axes, and multipliers come from a pseudo-inverse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import symofros as sf

from ..contract.interface import States, Subject, TreeEngine
from ..contract.memory import LatestResults
from ..contract.quantities import CONSTRAINED
from ..mechanics.assembly import Assembly, anchor_name
from ..mechanics.geometry import Array, skew
from . import by_formula

AXES = "xyz"
# As in our solver: what is smaller, relative to the largest, repeats other conditions.
RANK = 1e-6
# Within this factor of it, one algorithm may keep a condition that another one drops.
BORDER = 100.0


@dataclass(frozen=True)
class _Kinematics:
    """One frame in world axes for N states; accelerations at v' = 0."""

    p: Array
    R: Array
    v: Array
    w: Array
    a: Array
    alpha: Array
    Jv: Array
    Jw: Array


@dataclass(frozen=True)
class Rows:
    """Conditions for N states: phi (N, m), G (N, m, nv), gamma (N, m)."""

    phi: Array
    G: Array
    gamma: Array


class ConstrainedEngine:
    """A tree engine with the constraints of a description.

    Args:
        tree: Engine of the tree, for everything that constraints leave as it is.
        anchored: The same engine, built for the frames that constraints join.
        subject: Subject that both were built from.
        names: Names of those frames, in order.
    """

    def __init__(self, tree: TreeEngine, anchored: TreeEngine, subject: Subject, names: tuple[str, ...]) -> None:
        self._tree, self._anchored, self._subject, self._names = tree, anchored, subject, names
        self.name, self.version = tree.name, tree.version
        self.capabilities = tree.capabilities | CONSTRAINED
        self._assembly = subject.assembly
        self._latest_rows: LatestResults[Rows] = LatestResults()
        self._latest_solutions: LatestResults[tuple[Array, Array]] = LatestResults()

    def __getattr__(self, name: str) -> Callable[[States], Array]:
        """Quantities that constraints do not change."""
        method: Callable[[States], Array] = getattr(self._tree, name)
        return method

    def constraint(self, states: States) -> Array:
        """Residuals phi (N, nc)."""
        return self._rows(states).phi

    def constraint_jacobian(self, states: States) -> Array:
        """G (N, nc, nv)."""
        return self._rows(states).G

    def constraint_bias(self, states: States) -> Array:
        """What G v' equals (N, nc)."""
        return self._rows(states).gamma

    def forward_dynamics(self, states: States) -> Array:
        """Acceleration v' of M v' - G^T lam = Q - h, G v' = gamma."""
        return self._solved(states)[0]

    def multipliers(self, states: States) -> Array:
        """Multipliers lam of least norm."""
        return self._solved(states)[1]

    def _solved(self, states: States) -> tuple[Array, Array]:
        arguments = states.q, states.v, states.u, states.applied
        return self._latest_solutions.get(arguments, lambda: self._solve(states))

    def _solve(self, states: States) -> tuple[Array, Array]:
        M, rows = self._tree.mass_matrix(states), self._rows(states)
        free = states.applied - self._tree.bias(states)
        solutions = [_solve(*state) for state in zip(M, free, rows.G, rows.gamma, strict=True)]
        return np.array([a for a, _ in solutions]), np.array([lam for _, lam in solutions])

    def _rows(self, states: States) -> Rows:
        return self._latest_rows.get((states.q, states.v, states.u), lambda: self._formed(states))

    def _formed(self, states: States) -> Rows:
        frames = self._kinematics(states)
        parts = [self._one(item, frames, states) for item in self._subject.system.constraints]
        shares = [engaged(self._subject.system, item.name) for item in self._subject.system.constraints]
        scaled = [[share * array for array in part] for part, share in zip(parts, shares, strict=True)]
        stacked = [np.concatenate(arrays, axis=1) for arrays in zip(*scaled, strict=True)]
        return Rows(*stacked)

    def _kinematics(self, states: States) -> dict[str, _Kinematics]:
        n, nv = len(states), states.v.shape[1]
        still = np.zeros((n, 3))
        none = np.zeros((n, 3, nv))
        kinematics = {"": _Kinematics(still, np.tile(np.eye(3), (n, 1, 1)), still, still, still, still, none, none)}
        if not self._names:
            return kinematics
        pose = self._anchored.frame_pose(states)
        velocity, J = self._anchored.frame_velocity(states), self._anchored.frame_jacobian(states)
        drift = self._anchored.frame_acceleration(replace(states, a=0.0 * states.a))
        for i, name in enumerate(self._names):
            kinematics[name] = _Kinematics(
                pose[:, i, :3],
                pose[:, i, 3:].reshape(n, 3, 3),
                velocity[:, i, :3],
                velocity[:, i, 3:],
                drift[:, i, :3],
                drift[:, i, 3:],
                J[:, i, :3],
                J[:, i, 3:],
            )
        return kinematics

    def _one(self, item: sf.Constraint, frames: dict[str, _Kinematics], states: States) -> tuple[Array, Array, Array]:
        parameters = self._subject.system.parameter_values()
        if isinstance(item, sf.Nonholonomic):
            return by_formula.condition_on_speeds(item, parameters, self._assembly, states)
        if isinstance(item, sf.Coupling):
            return by_formula.coupling(item, parameters, self._assembly, states)
        if not isinstance(item, sf.Closure | sf.Rod | sf.KnifeEdge | sf.Rolling):
            raise TypeError(f"no equations of our own for {type(item).__name__}")
        anchors = [item.first, item.second] if isinstance(item, sf.Closure | sf.Rod) else [item.anchor]
        bodies = [frames[anchor_name(self._assembly, anchor)] for anchor in anchors]
        if isinstance(item, sf.Closure):
            return _closure(item, *bodies)
        if isinstance(item, sf.Rod):
            return _rod(self._number(item.length), *bodies)
        if isinstance(item, sf.KnifeEdge):
            return _edge(item, *bodies)
        return _rolling(self._number(item.radius), self._number(item.height), item.shape, *bodies)

    def _number(self, value: sf.Expression | float) -> float:
        return float(sf.evaluate(value, self._subject.system.parameter_values()))


def engaged(system: sf.System, name: str) -> float:
    """Whether a constraint holds at the stated parameters, 1, or is released, 0; what it holds is the stated pose."""
    formulas = [switch.engaged for switch in system.switches if switch.constraint == name]
    return float(sf.evaluate(formulas[0], system.parameter_values())) if formulas else 1.0


def joined_frames(assembly: Assembly, system: sf.System) -> tuple[str, ...]:
    """The frames that constraints join, each once."""
    anchors: list[tuple[str, str | None]] = []
    for item in system.constraints:
        if isinstance(item, sf.Closure | sf.Rod):
            anchors += [item.first, item.second]
        elif isinstance(item, sf.KnifeEdge | sf.Rolling):
            anchors.append(item.anchor)
    return tuple(dict.fromkeys(name for anchor in anchors if (name := anchor_name(assembly, anchor))))


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.einsum("ni,ni->n", a, b)
    return product


def _closure(item: sf.Closure, A: _Kinematics, B: _Kinematics) -> tuple[Array, Array, Array]:
    RT = A.R.transpose(0, 2, 1)
    d, v, a = B.p - A.p, B.v - A.v, B.a - A.a
    W, W2 = skew(A.w), skew(A.alpha) + skew(A.w) @ skew(A.w)
    # Everything as A sees it: position, and what its derivatives are with the turning of A taken out.
    seen = np.einsum("nij,nj->ni", RT, d)
    J = RT @ (B.Jv - A.Jv + skew(d) @ A.Jw)
    drift = np.einsum(
        "nij,nj->ni",
        RT,
        a - 2 * np.einsum("nij,nj->ni", W, v) - np.einsum("nij,nj->ni", W2, d) + 2 * np.einsum("nij,nj->ni", W @ W, d),
    )
    rows = [(seen[:, k], J[:, k], drift[:, k]) for k in map(AXES.index, item.translations)]
    # The relative rotation: R' = [w] R and R'' = ([alpha] + [w][w]) R, w of B in A, in A.
    R = RT @ B.R
    w = np.einsum("nij,nj->ni", RT, B.w - A.w)
    alpha = np.einsum("nij,nj->ni", RT, B.alpha - A.alpha - np.einsum("nij,nj->ni", W, B.w - A.w))
    Jw = RT @ (B.Jw - A.Jw)
    R2 = (skew(alpha) + skew(w) @ skew(w)) @ R
    for weights in _rotation_weights(item.rotations):
        phi = np.einsum("ij,nij->n", weights, R)
        # d/dt of weights : R is w . vee, with the components of the spin that turns R.
        lever = np.einsum("ij,kil,nlj->nk", weights, _EPSILON, R)
        rows.append((phi, np.einsum("nk,nkj->nj", lever, Jw), np.einsum("ij,nij->n", weights, R2)))
    return _stacked(rows)


# [e_k] for each axis k: row i, column l.
_EPSILON = skew(np.eye(3))


def _rotation_weights(blocked: tuple[str, ...]) -> list[Array]:
    """Matrices whose inner product with R_AB is a condition."""
    weights = []
    free = [k for k in range(3) if AXES[k] not in blocked]
    for k in map(AXES.index, blocked):
        E = np.zeros((3, 3))
        if len(blocked) == 3:
            E = 0.5 * _EPSILON[k]
        elif len(blocked) == 2:
            # Turning about k carries the free axis into the other blocked one, or against it.
            carried = np.cross(np.eye(3)[k], np.eye(3)[free[0]])
            E[int(np.argmax(np.abs(carried))), free[0]] = carried.sum()
        else:
            i, j = (k + 1) % 3, (k + 2) % 3
            E[j, i] = 1.0
        weights.append(E)
    return weights


def _rod(length: float, A: _Kinematics, B: _Kinematics) -> tuple[Array, Array, Array]:
    d, v, a = B.p - A.p, B.v - A.v, B.a - A.a
    phi = (_dot(d, d) - length**2) / (2 * length)
    G = np.einsum("ni,nij->nj", d, B.Jv - A.Jv) / length
    return _stacked([(phi, G, (_dot(v, v) + _dot(d, a)) / length)])


def _edge(item: sf.KnifeEdge, B: _Kinematics) -> tuple[Array, Array, Array]:
    n = B.R[:, :, AXES.index(item.axis)]
    drift = _dot(B.a, n) + _dot(B.v, np.cross(B.w, n))
    return _stacked([(0.0 * drift, np.einsum("ni,nij->nj", n, B.Jv), drift)])


def _rolling(radius: float, height: float, shape: str, B: _Kinematics) -> tuple[Array, Array, Array]:
    up = np.tile([0.0, 0.0, 1.0], (len(B.p), 1))
    n = B.R[:, :, 2]
    if shape == "sphere":
        r, r_rate = -radius * up, np.zeros_like(up)
    else:
        n_rate = np.cross(B.w, n)
        s = up - n[:, 2:] * n
        s_rate = -n_rate[:, 2:] * n - n[:, 2:] * n_rate
        size = np.linalg.norm(s, axis=1, keepdims=True)
        r = -radius * s / size
        r_rate = -radius * (s_rate / size - s * _dot(s, s_rate)[:, None] / size**3)
    J = B.Jv - skew(r) @ B.Jw
    drift = B.a + np.cross(B.alpha, r) + np.cross(B.w, r_rate)
    level = B.p[:, 2] - height + r[:, 2]
    return _stacked([(level if k == 2 else 0.0 * level, J[:, k], drift[:, k]) for k in range(3)])


def _stacked(rows: list[tuple[Array, Array, Array]]) -> tuple[Array, Array, Array]:
    """Residuals phi, Jacobian G and gamma = -drift of several conditions."""
    phi, G, drift = (np.stack(parts, axis=1) for parts in zip(*rows, strict=True))
    return phi, G, -drift


def condition(M: Array, G: Array) -> float:
    """Factor by which the multipliers amplify rounding: the square of the condition of G in the metric of M."""
    worst = 1.0
    for one, row in zip(M, G, strict=True):
        s = _sizes(one, row)
        kept = s[s > RANK * s.max(initial=0.0)]
        worst = max(worst, float((kept[0] / kept[-1]) ** 2) if kept.size else 1.0)
    return worst


def of_clear_rank(M: Array, G: Array) -> Array:
    """Which states (N,) have a Jacobian whose rank every algorithm must find: no singular value near the border.

    Where M is not positive definite, nothing is solved for, and the rank is in nobody's way.
    """
    clear = np.zeros(len(G), dtype=bool)
    for i, (one, row) in enumerate(zip(M, G, strict=True)):
        if np.all(np.isfinite(row)):
            try:
                s = _sizes(one, row)
            except np.linalg.LinAlgError:
                clear[i] = True
                continue
            share = s / max(float(s.max(initial=0.0)), 1e-300)
            clear[i] = not np.any((share > RANK / BORDER) & (share < RANK * BORDER))
    return clear


def _sizes(M: Array, G: Array) -> Array:
    """Singular values of G in the metric of M."""
    return np.asarray(np.linalg.svd(np.linalg.solve(np.linalg.cholesky(M), G.T), compute_uv=False))


def _solve(M: Array, r: Array, G: Array, c: Array) -> tuple[Array, Array]:
    """Accelerations and multipliers under constraints, by the pseudo-inverse of G M^-1 G^T in the metric of M."""
    if not np.all(np.isfinite(G)):
        return np.full(len(r), np.nan), np.full(len(c), np.nan)
    L = np.linalg.cholesky(M)
    Y, y = np.linalg.solve(L, G.T), np.linalg.solve(L, r)
    U, s, Vt = np.linalg.svd(Y, full_matrices=False)
    kept = s > RANK * s.max(initial=0.0)
    lam = Vt[kept].T @ ((Vt[kept] @ (c - Y.T @ y)) / s[kept] ** 2)
    return np.linalg.solve(L.T, y + Y @ lam), lam
