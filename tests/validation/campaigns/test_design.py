from __future__ import annotations

import numpy as np
import pytest

from validation.campaigns.design import Design, Range, points_of

OVER = {"a": Range(low=1.0, high=2.0), "b": Range(low=1e-3, high=10.0, log=True)}


def test_a_grid_combines_all_values() -> None:
    over = {"a": Range(low=0.0, high=1.0, count=3), "b": Range(low=1.0, high=100.0, count=3, log=True)}
    points = points_of(over, "grid", None, 0)
    assert points[:, 0].tolist() == [0.0] * 3 + [0.5] * 3 + [1.0] * 3
    np.testing.assert_allclose(points[:3, 1], [1.0, 10.0, 100.0], rtol=1e-14)
    assert points[2, 1] == 100.0  # The ends are exact.


@pytest.mark.parametrize("design", ["latin_hypercube", "sobol"])
def test_batches_are_parts_of_the_whole(design: Design) -> None:
    whole = points_of(OVER, design, 64, 1)
    parts = [points_of(OVER, design, 64, 1, first, 24) for first in range(0, 64, 24)]
    assert np.array_equal(np.concatenate(parts), whole)
    assert not np.array_equal(whole, points_of(OVER, design, 64, 2))
