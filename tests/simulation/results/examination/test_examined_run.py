"""What counts as rounding in the speeds of a run."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.examination.run import AT_REST, ExaminedRun
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.stepper import Stepper
from tests.simulation.mechanisms import slide


@pytest.mark.parametrize("first", [0.0, 3.0])
@pytest.mark.parametrize("weight", [0.0, 9.81])
def test_rounding_is_a_share_of_the_last_place_a_record_and_of_what_weight_would_give(
    first: float, weight: float
) -> None:
    """In the norm of the kinetic energy, of 4 kg."""
    model = sf.compile(slide(mass=4.0, gravity=(weight, 0, 0)))
    t, q = np.arange(5) * 0.1, np.linspace(first, -10.0, 5)[:, np.newaxis]
    stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
    settings = Settings.of(model, SimulationOptions(method="rk4", dt=0.1), 0.4)
    states = [t, q, np.zeros((5, 1)), np.zeros((5, 0))]
    run = ExaminedRun(stepper, settings, (q[0], np.zeros(1)), states, 4)
    expected = 2.0 * (10.0 * 4.0 / 0.4 + 0.4 * weight)
    assert run.rounding(states) == pytest.approx(AT_REST * expected, rel=1e-9, abs=0.0)
    assert run.rounding([x[:1] for x in states]) == 0.0
