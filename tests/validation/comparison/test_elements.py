"""Verdicts on rates and powers, from made-up values."""

import numpy as np
import pytest

from validation.comparison.elements import judge_rates
from validation.mechanics.extrapolation import Refined

STEPS = 0.5 ** np.arange(5)


def refined(power: int, powers: tuple[int, ...]) -> Refined:
    return Refined("mass", powers, [np.array([1.0 + 0.1 * h**power]) for h in STEPS])


@pytest.mark.parametrize(("power", "status"), [(4, "agree"), (3, "disagree"), (2, "disagree")])
def test_meshes_must_converge_at_the_rate_that_they_are_extrapolated_by(power: int, status: str) -> None:
    row = judge_rates("beam", "engine", [refined(2, (2, 4, 6, 8)), refined(power, (4, 6, 8, 10))])
    assert row.status == status and row.error is not None
    assert (row.error <= row.tolerance) == (status == "agree")


def test_converged_meshes_show_no_rate() -> None:
    row = judge_rates("beam", "engine", [Refined("mass", (4, 6, 8, 10), [np.array([1.0])] * 5)])
    assert row.status == "unsupported" and "to rounding" in row.note
