"""Which eigenvalues are rigid motions: zeros but for rounding, two of each that nothing damps (linear.md, 4)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array

Complex = npt.NDArray[np.complex128]

# Rounding of the entries of A^2, relative to the sum of the sizes of their terms: A itself has passed through M^-1 and,
# with constraints, through projections.
_ROUNDING = 1e4 * np.finfo(np.float64).eps
# Share of a direction that others do not have, above which it is a motion of its own: eigenvectors of one motion agree
# to the root of rounding, those of different motions are seldom closer than a thousandth.
_INDEPENDENT = 1e-5


class RigidMotions(NamedTuple):
    """Rigid motions among eigenvalues.

    Attributes:
        zeros: Whether an eigenvalue is zero but for rounding (k).
        chosen: Indices of eigenvectors, one for each rigid motion.
    """

    zeros: npt.NDArray[np.bool_]
    chosen: list[int]


def rigid_motions(A: Array, basis: Array, s: Complex, states: Complex, inertia: Array) -> RigidMotions:
    """Rigid motions of x = basis y, y' = A y, and states of forces that rest wherever they are.

    The s of a motion that nothing drives back is zero, and twice so if nothing damps it; rounding makes a pair of it
    that is real, imaginary or zero. s^2 is an eigenvalue of A^2, whose entries err by rounding of the terms they are
    sums of, eq. (7c). So a soft mode beside stiff ones is none as long as its own stiffness is no small difference.

    Args:
        A: Matrix of the independent changes (k x k).
        basis: Changes of the state of each of them (2 nv + nz x k): along q, of v, of states of forces.
        s: Its eigenvalues [1/s] (k).
        states: Changes of the state by the eigenvectors (2 nv + nz x k).
        inertia: Diagonal of the mass matrix (nv), in which coordinates of different units are compared.
    """
    nv = len(inertia)
    fastest = np.abs(s).max(initial=0.0)
    of_states = np.ones(len(basis) - 2 * nv)  # Carried as speeds of unit inertia (states.md, (2)).
    scale = np.sqrt(np.concatenate([inertia, inertia, of_states]))[:, None]
    still = np.r_[0:nv, 2 * nv : len(basis)]
    if fastest == 0.0:
        return RigidMotions(np.ones(len(s), bool), _independent(_unit(scale[still] * states[still])))
    scale[nv:] /= fastest
    size = np.abs(basis.T) @ np.abs(basis @ A @ basis.T) @ np.abs(basis)
    terms = np.abs(basis) @ (size @ (size @ np.abs(basis.T @ states)))
    error = _ROUNDING * np.linalg.norm(scale * terms, axis=0) / np.linalg.norm(scale * states, axis=0)
    zeros = np.abs(s) ** 2 <= error
    of_zeros = np.flatnonzero(zeros)
    return RigidMotions(zeros, [int(of_zeros[i]) for i in _independent(_unit((scale * states)[still][:, zeros]))])


def _unit(directions: Complex) -> Complex:
    """Directions of unit length."""
    lengths = np.linalg.norm(directions, axis=0)
    unit: Complex = directions / np.where(lengths > 0.0, lengths, 1.0)
    return unit


def _independent(directions: Complex) -> list[int]:
    """Indices of directions that span all: each the first at least half as far from those before as the farthest."""
    rest, chosen = directions.copy(), list[int]()
    while rest.size:
        lengths = np.linalg.norm(rest, axis=0)
        farthest = int(np.argmax(lengths >= 0.5 * lengths.max()))
        if lengths.max() <= _INDEPENDENT:
            break
        chosen.append(farthest)
        unit = rest[:, farthest] / lengths[farthest]
        for _ in range(2):  # Twice, for orthogonality.
            rest -= np.outer(unit, unit.conj() @ rest)
    return chosen
