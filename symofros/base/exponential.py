"""The exponential of a matrix."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array

# Taylor's series of a matrix of norm 1/2 at most ends below rounding: 0.5^16 / 16! < 1e-18.
_TERMS, _NORM = 16, 0.5


def matrix_exponential(A: Array) -> Array:
    """exp(A) (n, n) by Taylor's series of A / 2^k, squared k times."""
    norm = float(np.linalg.norm(A, 1)) if A.size else 0.0
    squarings = max(0, int(np.ceil(np.log2(norm / _NORM)))) if norm > _NORM else 0
    scaled, term, total = A / 2.0**squarings, np.eye(len(A)), np.eye(len(A))
    for k in range(1, _TERMS):
        term = term @ scaled / k
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total
