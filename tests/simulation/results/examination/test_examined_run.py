"""What counts as rounding in speeds and energies of a run, and by what it is made once more."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

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


def examined(model: sf.Model, states: list[np.ndarray]) -> ExaminedRun:
    """A run of the model by these records."""
    stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
    settings = Settings.of(model, SimulationOptions(method="rk4", dt=0.1), 0.4)
    return ExaminedRun(stepper, settings, (states[1][0], states[2][0]), states, len(states[0]) - 1)


@pytest.mark.parametrize("first", [0.0, 3.0])
@pytest.mark.parametrize("weight", [0.0, 9.81])
def test_rounding_is_a_share_of_the_last_place_a_record_and_of_what_weight_would_give(
    first: float, weight: float
) -> None:
    """In the norm of the kinetic energy, of 4 kg."""
    model = sf.compile(slide(mass=4.0, gravity=(weight, 0, 0)))
    t, q = np.arange(5) * 0.1, np.linspace(first, -10.0, 5)[:, np.newaxis]
    states = [t, q, np.zeros((5, 1)), np.zeros((5, 0))]
    run = examined(model, states)
    expected = 2.0 * (10.0 * 4.0 / 0.4 + 0.4 * weight)
    assert run.rounding(states) == pytest.approx(AT_REST * expected, rel=1e-9, abs=0.0)
    assert run.rounding([x[:1] for x in states]) == 0.0


@pytest.mark.parametrize("speed", [0.0, 1e-6])
def test_the_last_place_of_a_large_potential_energy_is_no_change_of_the_motion(speed: float) -> None:
    """A body of 4 kg that hardly moves, 4 MJ deep: half the step moves it by the last place."""
    model = sf.compile(slide(mass=4.0, gravity=(9.81, 0, 0)))
    t, q = np.arange(5) * 0.1, np.full((5, 1), 1e5)
    states, finer = ([t, x, np.full((5, 1), speed), np.zeros((5, 0))] for x in (q, np.nextafter(q, np.inf)))
    assert model.potential_energy(finer[1]).max() != model.potential_energy(q).max()
    assert examined(model, states).whole_change(states, finer) < 0.01


@pytest.mark.parametrize("function", [None, lambda t, q, v: np.zeros(1)])
def test_a_method_with_a_history_is_replaced_by_one_that_inputs_by_functions_allow(
    function: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rosenbrock methods take the rate of forces, which differences of a function of the user's would have to give."""
    asked = list[Any]()
    monkeypatch.setattr(ExaminedRun, "repeated", lambda self, *given, **stated: asked.append((given, stated)))
    stepper: Any = SimpleNamespace(method=METHODS["cvode"], inputs=SimpleNamespace(callback=function))
    run = ExaminedRun(stepper, SimpleNamespace(adaptive=True), (np.zeros(1),) * 2, [], 0)  # type: ignore[arg-type]
    run.in_short_steps((0.0, [0.0], [0.0]), 2.0, 0.25)
    ((given, stated),) = asked
    assert given[1:] == (2.0, 0.0) and stated["max_step"] == 0.25
    assert stated["method"].name == ("rodas4" if function is None else "dopri5")
