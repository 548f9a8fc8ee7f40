"""The mass matrix by entries: pattern and values are the whole of it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.models import model


@pytest.mark.parametrize("backend", ["c", "interpreter"])
@pytest.mark.parametrize("case", ["double_pendulum", "tree2", "gyroscope", "friction_arm", "slider_crank"])
def test_pattern_and_values_are_the_lower_triangle(case: str, backend: str, rng: np.random.Generator) -> None:
    m = model(case, backend)
    q = np.array([m.random_state(rng)[0] for _ in range(3)])
    rows, columns = m.mass_matrix_pattern()
    assert (rows >= columns).all()
    L = np.zeros((3, m.nv, m.nv))
    L[:, rows, columns] = m.mass_matrix_values(q)
    np.testing.assert_allclose(L, np.tril(m.mass_matrix(q)), rtol=1e-14, atol=0)
    assert np.array_equal(m.mass_matrix_values(q[0]), m.mass_matrix_values(q)[0])


def test_speeds_on_different_branches_have_no_entry() -> None:
    rows, _ = model("tree2").mass_matrix_pattern()
    assert len(rows) < model("tree2").nv * (model("tree2").nv + 1) // 2
