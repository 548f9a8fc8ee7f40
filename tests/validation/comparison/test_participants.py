"""What engines are asked, and how far solutions of ours are determined."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from validation.comparison.participants import worst_condition


def with_inertia(*moments: float) -> Any:
    return SimpleNamespace(model=SimpleNamespace(nc=0), mass_matrix=lambda _: np.array([np.eye(2), np.diag(moments)]))


@pytest.mark.parametrize("smallest", [5e-17, 0.0, -5e-17, -0.5])
def test_the_sign_of_rounding_does_not_decide_whether_inertia_is_definite(smallest: float) -> None:
    """A file's inertias left 5e-17 beside 29: of one sign in one run, and of the other in another."""
    assert worst_condition(with_inertia(29.0, smallest), None) == np.inf  # type: ignore[arg-type]


def test_the_condition_is_the_largest_of_all_states() -> None:
    assert worst_condition(with_inertia(1.0, 1e-9), None) == pytest.approx(1e9)  # type: ignore[arg-type]
