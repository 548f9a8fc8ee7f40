"""Distances between the eigenvalues of two states; the speed that changes most."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.simulation.analysis.imbalance import _change, _changes, imbalance


def test_changes_of_eigenvalues_are_shares_of_each_to_the_nearest_other() -> None:
    """On the same side of the axes; those that are zero have none, and no others are infinitely far."""
    some, others = np.array([2.0 + 0j, -4.0, 3.0j, 0.0]), np.array([2.2 + 0j, -3.0, 3.3j, 100.0])
    np.testing.assert_allclose(_changes(some, others), [0.1, 0.25, 0.1, np.inf], rtol=1e-12)
    assert np.isinf(_changes(some, others[:0])).all()


def test_the_largest_change_counts_in_both_directions_above_rounding() -> None:
    here, there = np.array([2.0 + 0j, 5.0]), np.array([2.0 + 0j, 8.0])
    assert _change((here, here), (there, there)) == 0.6
    assert _change((here, here[:1]), (there, there)) == 0.375
    assert _change((here, here), (there, there[:1])) == 0.6
    assert _change((here, here[:0]), (there, there[:0])) == 0.0


@pytest.mark.parametrize("lean", [0.3, -0.3])
def test_the_speed_that_changes_most_does_so_either_way(lean: float) -> None:
    """That of a pole, more than that of its cart, which it pushes the other way."""
    model = sf.compile(MODELS["cart_pole"], sf.Options(backend="interpreter"))
    q, v, u = np.array([0.0, lean]), np.zeros(2), np.zeros(model.nu)
    a = model.forward_dynamics(q, v, u)
    assert a[0] * a[1] < 0.0 and abs(a[1]) > abs(a[0])
    assert imbalance(model, (q, v, u, np.zeros(0)), None, 0.0) == (model.names.v[1], a[1])
    assert imbalance(model, (0.0 * q, v, u, np.zeros(0)), None, 0.0) == ("", 0.0)
