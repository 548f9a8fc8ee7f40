"""Derivatives of the acceleration of rigid trees by sweeps, in NumPy: the twin of native/model/responses.c.in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symofros.runtime.calls.kernel import Array


def respond(
    steps: Array, fields: Array, direct: Array, tables: Sequence[Sequence[int]], sizes: Sequence[int]
) -> list[Array]:
    """Derivatives by q, v and u (docs/theory/linear.md, eqs. 31-35).

    Args:
        steps: Of each state and speed -G, s, -h, -1 / D (states x n x 16).
        fields: Of each by q and by v: wrench, acceleration and w of the change beyond its joint (states x n x 30).
        direct: Changes of forces (states x changes).
        tables: Speeds before each and first speeds of joints (2 n); begins of rows (n + 1); derivative and column of
            each change.
        sizes: Columns by q, v and u.

    Returns:
        One (states x n x columns) each.
    """
    states, n = steps.shape[:2]
    parent, first = np.reshape(tables[0], (2, n))
    offsets = np.cumsum([0, *sizes])
    free = np.zeros((states, n, offsets[-1]))
    rows = np.repeat(np.arange(n), np.diff(tables[1]))
    by, columns = np.reshape(np.array(tables[2], dtype=np.intp), (-1, 2)).T
    free[:, rows, offsets[by] + columns] = direct
    # By columns: of each the wrench (6), the acceleration (6) and w (3).
    entering = np.zeros((states, n, 15, offsets[-1]))
    for k in range(n):
        for which in (0, 1):
            entering[:, first[k], :, offsets[which] + k] = fields[:, k, 15 * which : 15 * which + 15]
    wrenches = np.zeros((states, n, 6, offsets[-1]))
    for k in reversed(range(n)):
        d = free[:, k] + np.einsum("zc,zcj->zj", steps[:, k, 6:12], wrenches[:, k])
        wrench = wrenches[:, k] + steps[:, k, :6, None] * d[:, None] + entering[:, k, :6]
        free[:, k] = steps[:, k, 15, None] * d
        if parent[k] >= 0:
            wrenches[:, parent[k]] += wrench
    motions = np.zeros((states, n, 9, offsets[-1]))
    for k in range(n):
        x = entering[:, k, 6:] + (motions[:, parent[k]] if parent[k] >= 0 else 0.0)
        free[:, k] += np.einsum("zc,zcj->zj", steps[:, k][:, [0, 1, 2, 3, 4, 5, 12, 13, 14]], x)
        x[:, :6] += steps[:, k, 6:12, None] * free[:, k, None]
        motions[:, k] = x
    return np.split(free, offsets[1:-1], axis=2)
