"""Extrapolation over meshes: what it removes, and the rates that it reports."""

import numpy as np
import pytest

from validation.mechanics.extrapolation import Refined

STEPS = 0.5 ** np.arange(5)


@pytest.mark.parametrize("powers", [(4, 6, 8, 10), (2, 4, 6, 8)])
def test_extrapolation_removes_the_stated_powers(powers: tuple[int, ...]) -> None:
    values = [np.array([3.0 + sum((k + 1) * h**power for k, power in enumerate(powers))]) for h in STEPS]
    refined = Refined("series", powers, values)
    assert refined.limit() == pytest.approx(3.0, abs=1e-13)
    assert refined.rate() == pytest.approx(powers[0], abs=0.2)


def test_a_wrong_convergence_rate_is_detected() -> None:
    refined = Refined("first order", (4, 6, 8, 10), [np.array([1.0 + h]) for h in STEPS])
    rate = refined.rate()
    assert rate is not None and rate < 2.0


def test_values_that_are_exact_on_every_mesh_show_no_rate() -> None:
    assert Refined("exact", (4, 6, 8, 10), [np.array([1.0])] * 5).rate() is None
