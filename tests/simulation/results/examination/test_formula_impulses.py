"""Fixed steps say where they misjudge forces by a model's own formulas of time, and are silent where they do not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.examination.formula_impulses import _missed
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.stepper import Stepper
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


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler", "generalized_alpha", "dopri5"])
def test_resolved_pulses_get_no_note(pulse: sf.Model, method: str) -> None:
    """Wherever between two steps they begin."""
    for place in PLACES:
        assert not _run(pulse, method, place, 0.5).outcome.notes


@pytest.mark.parametrize("method", FIXED)
def test_the_error_of_a_step_under_a_force_that_grows_with_time_is_known(method: str) -> None:
    """Methods of first order take its value at one end of the step, h/2 from the middle; others miss nothing."""
    model, h, slope = sf.compile(cart("1 + width*t")), 0.1, 3.0
    model = model.with_parameters(width=slope)
    settings = Settings.of(model, SimulationOptions(method=method, dt=h, **FIXED[method]), 1.0)
    stepper = Stepper(model, METHODS[method], plan_inputs(model, None), (), model.parameter_values)
    settings.apply(stepper)
    held = np.zeros((2, 1)), np.zeros((2, 1)), np.zeros((2, 0))
    begin = np.array([0.2, 0.7])
    missed = _missed(stepper, settings, held, np.array([0.25]), begin, begin + h)
    late = {"euler": 0.5, "semi_implicit_euler": 0.5, "implicit_euler": -0.5}.get(method, 0.0)
    np.testing.assert_allclose(missed, np.full((2, 1), late * slope * h**2), atol=1e-8)


def _run(model: sf.Model, method: str, place: float, width: float) -> Any:
    return sf.simulate(
        model.with_parameters(late=place, width=width), t_end=END, method=method, dt=STEP, **FIXED[method]
    )


@pytest.mark.parametrize("t0", [0.0, 3.0, -40.0])
@pytest.mark.parametrize("step", [1e-2, 1e-5])
def test_a_force_within_a_step_is_judged_where_the_step_begins(step: float, t0: float) -> None:
    """A blow in proportion to x: two steps from zero it is twice as large, where the force has gone."""
    late, width = t0 + 1.25 * step, 1e-2 * step
    blow = 0.2 / (width * step * np.sqrt(np.pi))
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=(f"{blow}*x*exp(-((t - {late!r})/{width})^2)",))
    system = sf.System("s", (sf.RigidBody("b", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0))
    model = sf.compile(system, sf.Options(backend="tape"))
    run = sf.simulate(model, [0.0], [1.0], t0 + 10 * step, t0=t0, method="rk4", dt=step)
    (note,) = run.outcome.notes
    assert f"at t = {t0 + 2.0 * step:.6g} s the speeds that they give are off by 20 % of the largest" in note
