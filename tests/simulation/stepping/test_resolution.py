"""How fast a mode may be for a number of steps to resolve it."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.resolution import _resolved_radius, _step_errors

JUDGED = [name for name, method in METHODS.items() if method.family.judged]


@pytest.mark.parametrize("name", JUDGED)
def test_fewer_steps_resolve_no_slower_modes_only(name: str) -> None:
    """From one step to a million the radius falls, and within it lies no mode whose errors add up to the tolerance."""
    radii, errors = _step_errors(name)
    resolved = [_resolved_radius(name, steps) for steps in (1, 10, 100, 10_000, 1_000_000)]
    assert all(later <= before for before, later in zip(resolved, resolved[1:], strict=False))
    for steps, radius in zip((1, 10, 100), resolved, strict=False):
        assert (errors[radii < radius] * steps <= 0.5 * 0.1 / 4).all()
        beyond = errors[radii > radius] * steps
        assert not beyond.size or beyond[0] > 0.5 * 0.1 / 4


def test_one_step_of_high_order_resolves_whatever_is_judged() -> None:
    assert _resolved_radius("dop853", 1) == pytest.approx(float(np.max(_step_errors("dop853")[0])))
