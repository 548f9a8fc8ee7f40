"""The matrix of stiffness of a section: force and moment per strain."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

from symofros.base.arguments import entries_of
from symofros.description.beams.elastic import STRAIN_STIFFNESSES
from symofros.description.values import Value, as_values
from symofros.errors import DescriptionError, Problem

# Strains in the order of a matrix of stiffness, and what such a matrix takes the place of.
MATRIX_ORDER = ("stretch", "shear_y", "shear_z", "twist_rate", "curvature_y", "curvature_z")
IN_MATRIX = ("EI_y", "EI_z", "GJ", *STRAIN_STIFFNESSES, "EI_yz", "tension_center", "shear_center")
# Difference of two entries across the diagonal of a matrix of stiffness, over the root of the product of the
# diagonal's: programs for sections write seven digits.
_ASYMMETRY = 1e-6


def stiffness_rows(stated: Any, label: str) -> tuple[tuple[Value, ...], ...]:
    """A matrix of stiffness (6, 6), made symmetric where rounding left a difference; empty where none is stated.

    Args:
        stated: Its rows, or nothing.
        label: What it is, for errors.

    Raises:
        DescriptionError: It has other rows, or is not symmetric.
    """
    listed = entries_of(stated)
    listed = [stated] if listed is None else listed
    if not listed:
        return ()
    size = len(MATRIX_ORDER)
    if len(listed) != size:
        rule = f"{size} rows of {size} entries: {', '.join(MATRIX_ORDER)}"
        raise DescriptionError(Problem(label, f"{len(listed)} rows", rule, "give all, zeros included"))
    rows = [list(as_values(row, size, f"{label}[{i}]")) for i, row in enumerate(listed)]
    for i, j in combinations(range(size), 2):
        a, b, first, second = rows[i][j], rows[j][i], rows[i][i], rows[j][j]
        if a == b:
            continue
        if isinstance(a, float) and isinstance(b, float) and isinstance(first, float) and isinstance(second, float):
            if abs(a - b) <= _ASYMMETRY * math.sqrt(abs(first * second)):
                rows[i][j] = rows[j][i] = 0.5 * (a + b)
                continue
        rule = "a matrix of stiffness is symmetric: forces have the strain energy as their potential"
        found = f"[{i}][{j}] is {a}, [{j}][{i}] is {b}"
        raise DescriptionError(Problem(f"{label} is not symmetric", found, rule, "state the same value for both"))
    return tuple(map(tuple, rows))
