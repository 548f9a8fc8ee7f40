"""phi, G and G v against the rows that MuJoCo's `connect` hands to its own solver."""

from __future__ import annotations

import numpy as np
import pytest

from validation.adapters.mujoco.closures import connections
from validation.stability.closed_loops import four_bars


@pytest.mark.parametrize("loops", [1, 2, 5])
def test_a_row_of_four_bars_agrees_with_mujoco(loops: int) -> None:
    """At any posture, closed or not: ours are the same vectors, along the axes of the crank's end."""
    m = four_bars.linkage(loops)
    text = four_bars.mjcf(loops, "Euler", 1e-3, "0.02 1", "0.9 0.95 0.001", stated_at=0.0)
    rng = np.random.default_rng(loops)
    for _ in range(5):
        q, v = rng.uniform(-3, 3, m.nq), rng.standard_normal(m.nv)
        # MuJoCo's coordinates in the order of its tree, which is ours.
        gaps, J, rates = connections(text, q, v)
        phi, G = m.constraint(q).reshape(loops, 2), m.constraint_jacobian(q).reshape(loops, 2, m.nv)
        rate = m.constraint_rate(q, v).reshape(loops, 2)
        for i in range(loops):
            _, R = m.frame_pose(f"crank{i + 1}.end", q)
            across = R[:, [0, 2]].T  # The blocked directions: x and z of the crank's end.
            sign = -1.0  # MuJoCo subtracts the second body's point, we the reference's.
            np.testing.assert_allclose(sign * across @ gaps[i], phi[i], atol=1e-14)
            turned = _turning(m, q, i, phi[i])
            np.testing.assert_allclose(sign * across @ J[i] + turned, G[i], atol=1e-13)
            np.testing.assert_allclose(sign * across @ rates[i] + turned @ v, rate[i], atol=1e-13)


def _turning(m, q: np.ndarray, i: int, phi: np.ndarray) -> np.ndarray:
    """The axes turn with the crank: w x gap, seen in them, for an open loop; zero where it is closed."""
    w = m.frame_jacobian(f"crank{i + 1}.end", q)[3:]
    _, R = m.frame_pose(f"crank{i + 1}.end", q)
    gap = R[:, [0, 2]] @ phi
    return -(R[:, [0, 2]].T @ np.cross(w.T, gap).T)
