"""Sections by matrices of stiffness and mass, as programs of composites write them (docs/theory/beams.md, 8)."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.errors import DescriptionError, did_you_mean

# What counts as a matrix of a section's form, relative to its diagonal: programs write six or seven digits.
OF_SECTION = 1e-6
CHECK = "check the order of the axes (axis='x' or 'z'), and the units"

Matrix = npt.NDArray[np.float64]


def matrices_about_x(stiffness: npt.ArrayLike, mass: npt.ArrayLike, axis: str) -> tuple[Matrix, Matrix]:
    """Both matrices (6, 6) with x along the beam, and y and z across.

    Args:
        stiffness: Force and moment per strain (6, 6).
        mass: Momentum and angular momentum per length, per velocity and angular velocity (6, 6).
        axis: The axis of both that is along the beam, "x" or "z".

    Raises:
        DescriptionError: A matrix is of another shape, or the axis is none of these.
    """
    orders = {"x": [0, 1, 2, 3, 4, 5], "z": [2, 0, 1, 5, 3, 4]}
    if axis not in orders:
        rule, remedy = "the axis along the beam is x (VABS) or z (BeamDyn)", did_you_mean(str(axis), orders)
        raise DescriptionError("section: no such axis", repr(axis), rule, remedy)
    order = np.ix_(orders[axis], orders[axis])
    return symmetric_matrix(stiffness, "K")[order], symmetric_matrix(mass, "M")[order]


def properties_of_stiffness(K: Matrix) -> dict[str, Any]:
    """Stiffnesses about the centres, and the centres, of a stiffness about the axis (6, 6).

    Raises:
        DescriptionError: It is not positive definite.
    """
    least = float(np.linalg.eigvalsh(K)[0])
    if not least > 0.0:
        rule, found = "every strain takes energy", f"its least eigenvalue is {least:.3g}"
        raise DescriptionError("section: stiffness is not positive definite", found, rule, CHECK)
    flexibility = np.linalg.inv(K[:3, :3])
    to_centers = flexibility @ K[:3, 3:]
    bending = K[3:, 3:] - K[3:, :3] @ to_centers
    EA, GA_y, GA_z = (1.0 / np.diag(flexibility)).tolist()
    GJ, EI_y, EI_z = np.diag(bending).tolist()
    return {
        "EA": EA,
        "GA_y": GA_y,
        "GA_z": GA_z,
        "GJ": GJ,
        "EI_y": EI_y,
        "EI_z": EI_z,
        "EI_yz": -float(bending[1, 2]),
        "tension_center": (-float(to_centers[0, 2]), float(to_centers[0, 1])),
        "shear_center": (float(to_centers[2, 0]), -float(to_centers[1, 0])),
    }


def properties_of_mass(M: Matrix) -> dict[str, Any]:
    """Mass, mass centre and moments of inertia about it, of a mass matrix about the axis (6, 6).

    Raises:
        DescriptionError: It has no mass.
    """
    m = float(M[0, 0])
    if not m > 0.0:
        found, rule = f"its first entry is {m:g}", "a section has mass"
        raise DescriptionError("section: M has no mass", found, rule, CHECK)
    y, z = -float(M[0, 5]) / m, float(M[0, 4]) / m
    return {
        "rhoA": m,
        "rhoI_y": float(M[4, 4]) - m * z * z,
        "rhoI_z": float(M[5, 5]) - m * y * y,
        "rhoI_yz": -float(M[4, 5]) - m * y * z,
        "mass_center": (y, z),
    }


def symmetric_matrix(stated: npt.ArrayLike, label: str) -> Matrix:
    """A symmetric matrix (6, 6).

    Raises:
        DescriptionError: It is of another shape, not finite, or not symmetric.
    """
    rule = "six rows of six numbers, symmetric"
    try:
        matrix = np.asarray(stated).astype(np.float64, casting="same_kind")
    except (TypeError, ValueError):
        found = f"{stated!r:.60}"
        raise DescriptionError(f"section: matrix {label}", found, rule, "give numbers") from None
    if matrix.shape != (6, 6) or not np.isfinite(matrix).all():
        found = f"of shape {matrix.shape}" if matrix.shape != (6, 6) else "entries that are not finite"
        raise DescriptionError(f"section: matrix {label}", found, rule, "give all, zeros included")
    unlike = difference(matrix, matrix.T)
    if not unlike <= OF_SECTION:
        found = f"off by {unlike:.2g} of the diagonal"
        raise DescriptionError(f"section: matrix {label} is not symmetric", found, rule, CHECK)
    return 0.5 * (matrix + matrix.T)


def difference(matrix: Matrix, other: Matrix) -> float:
    """Largest difference of two matrices, over the roots of the diagonal's entries."""
    size = np.sqrt(np.abs(np.diag(matrix)))
    scale = np.outer(size, size)
    return float(np.max(np.abs(matrix - other) / np.where(scale > 0.0, scale, 1.0)))
