"""Vibration modes: eigenvalues of the linearised equations, on the constraints (docs/theory/linear.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.state_space import state_space

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
    model: Model,
    q: ArrayLike,
    v: ArrayLike | None = None,
    u: ArrayLike | None = None,
    *,
    par: ArrayLike | None = None,
    t: float = 0.0,
) -> Modes:
    """Modes of small motions about a state, which should be an equilibrium or a steady motion (`equilibrium`).

    Args:
        model: Model, with or without constraints.
        q: Configuration (nq).
        v: Speeds (nv); zero if not given.
        u: Inputs (nu); the defaults if not given.
        par: Run-time parameters.
        t: Time.
    """
    linear_model = state_space(model, q, v, u, par=par, t=t)
    s, X = np.linalg.eig(linear_model.A)
    kept = s.imag >= 0.0
    s, X = s[kept], (linear_model.basis @ X[:, kept])[: model.nv]
    order = np.argsort(np.abs(s), kind="stable")
    s, X = s[order], X[:, order]
    size = np.abs(s)
    damping = np.where(size > 0.0, -s.real / np.where(size > 0.0, size, 1.0), 0.0)
    largest = np.take_along_axis(X, np.abs(X).argmax(axis=0)[None], axis=0)
    shapes = X / np.where(largest == 0.0, 1.0, largest)
    return Modes(s, size, damping, shapes)
