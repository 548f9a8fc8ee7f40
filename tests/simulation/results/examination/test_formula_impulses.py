"""Fixed steps say where they misjudge forces by a model's own formulas of time, and are silent where they do not."""

from __future__ import annotations

from typing import Any

import pytest

import symofros as sf
from tests.pulses import END, SHAPES, cart
from tests.simulation.results.examination.test_input_impulses import FIXED

STEP = 0.01
# A step of rk4 sees this far from its nodes.
PLACES = (5.0023, 5.0 + 0.25 * STEP, 7.3371)


@pytest.fixture(scope="module", params=SHAPES)
def pulse(request: pytest.FixtureRequest) -> sf.Model:
    return sf.compile(cart(SHAPES[request.param][0]))


@pytest.mark.parametrize("method", FIXED)
@pytest.mark.parametrize("place", PLACES)
def test_no_fixed_step_passes_over_a_pulse_in_silence(pulse: sf.Model, method: str, place: float) -> None:
    """A pulse of a thousandth of a step, whose nodes all miss it or make far too much of it."""
    run = _run(pulse, method, place, 1e-5)
    assert any("smaller dt" in note for note in run.outcome.notes), run.v[-1]


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler", "generalized_alpha", "dopri5", "rodas4"])
def test_resolved_pulses_get_no_note(pulse: sf.Model, method: str) -> None:
    """Wherever between two steps they begin."""
    for place in PLACES:
        assert not _run(pulse, method, place, 0.5).outcome.notes


def _run(model: sf.Model, method: str, place: float, width: float) -> Any:
    return sf.simulate(
        model.with_parameters(late=place, width=width), t_end=END, method=method, dt=STEP, **FIXED[method]
    )
