"""Vibration modes: eigenvalues of the linearised equations, on the constraints (docs/theory/linear.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.runtime.constrained import RANK
from symofros.runtime.kernel import Array
from symofros.runtime.model import Given, Model

Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Modes:
    """Modes in the order of their frequencies; pairs of conjugate eigenvalues count once.

    Attributes:
        eigenvalues: s of each mode, with Im(s) >= 0 [1/s] (k).
        frequencies: |s| [rad/s] (k).
        damping: -Re(s)/|s|: positive decays, negative grows; a rigid motion (s = 0) counts 0 (k).
        shapes: Coordinates of each mode, scaled to a largest entry of 1 (nv, k).
    """

    eigenvalues: Complex
    frequencies: Array
    damping: Array
    shapes: Complex


def modes(
    model: Model, q: Given, v: Given | None = None, u: Given | None = None, *, par: Given | None = None, t: float = 0.0
) -> Modes:
    """Modes of small motions about a state, which should be an equilibrium or a steady motion (`equilibrium`).

    Args:
        model: Any.
        q: Configuration (nq).
        v: Speeds (nv); zero if not given.
        u: Inputs (nu); the defaults if not given.
        par: Run-time parameters.
        t: Time.
    """
    v = np.zeros(model.nv) if v is None else np.asarray(v, dtype=np.float64)
    u = np.asarray(model.record.u_default if u is None else u, dtype=np.float64)
    A, _, basis = reduced(model, q, v, u, par=par, t=t)
    s, X = np.linalg.eig(A)
    kept = s.imag >= 0.0
    s, X = s[kept], (basis @ X[:, kept])[: model.nv]
    order = np.argsort(np.abs(s), kind="stable")
    s, X = s[order], X[:, order]
    size = np.abs(s)
    damping = np.where(size > 0.0, -s.real / np.where(size > 0.0, size, 1.0), 0.0)
    largest = np.take_along_axis(X, np.abs(X).argmax(axis=0)[None], axis=0)
    shapes = X / np.where(largest == 0.0, 1.0, largest)
    return Modes(s, size, damping, shapes)


def reduced(
    model: Model, q: Given, v: Given, u: Given, *, par: Given | None = None, t: float = 0.0
) -> tuple[Array, Array, Array]:
    """A, B of the independent small changes, and the basis S that leads from them to the state's: x = S xi.

    Without constraints S is the identity. With them, its columns span what phi = 0 and G v = b allow.
    """
    A, B = model.linearize(q, v, u, par=par, t=t)
    nv = model.nv
    if not model.nc:
        return A, B, np.eye(2 * nv)
    rate_by_q = model.constraint_rate_derivative(q, v, u=u, par=par, t=t)
    G = model.constraint_jacobian(q, u=u, par=par, t=t)
    binds_coordinates = np.array([name not in model.record.speed_conditions for name in model.names.constraints])
    bound = np.block([[G[binds_coordinates], np.zeros((int(binds_coordinates.sum()), nv))], [rate_by_q, G]])
    _, sizes, Vt = np.linalg.svd(bound)
    rank = int(np.sum(sizes > RANK * sizes.max(initial=0.0)))
    S = Vt[rank:].T
    return S.T @ A @ S, S.T @ B, S
