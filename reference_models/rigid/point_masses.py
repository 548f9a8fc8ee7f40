"""Inertia of point masses: a simple way to random inertias that a body can have."""

from __future__ import annotations

from math import fsum

import numpy as np
import numpy.typing as npt

Triple = tuple[float, float, float]

# Pairs of axes in the order in which inertias are stated: xx, yy, zz, xy, xz, yz.
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def mass_and_center(masses: npt.NDArray[np.float64], points: npt.NDArray[np.float64]) -> tuple[float, Triple]:
    """Mass [kg] and centre of mass [m] of point masses (n) at points (n, 3).

    Sums are exact and rounded once, as everywhere in this module: those of BLAS depend on the processor.
    """
    mass = fsum(masses)
    x, y, z = (fsum(masses * points[:, i]) / mass for i in range(3))
    return mass, (x, y, z)


def moments_of_inertia(masses: npt.NDArray[np.float64], points: npt.NDArray[np.float64]) -> tuple[float, ...]:
    """Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the origin [kg m^2] of point masses (n) at points (n, 3)."""
    second = {pair: masses * points[:, pair[0]] * points[:, pair[1]] for pair in _PAIRS}
    squares = [second[i, i] for i in range(3)]
    diagonal = [fsum((*squares[i - 1], *squares[i - 2])) for i in range(3)]
    return (*diagonal, *(-fsum(second[pair]) for pair in _PAIRS[3:]))
