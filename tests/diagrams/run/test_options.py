"""Options of diagrams' runs: each is known by name, and reaches the stepping."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import ForwardDynamics
from symofros.diagrams.settings import RunSettings
from tests.diagrams.parts import Ball
from tests.simulation.oscillator import oscillator_system


def bouncing() -> sf.Simulation:
    diagram = sf.Diagram("bounce")
    diagram.add(Ball(name="ball", restitution=0.8))
    return sf.Simulation(diagram)


def test_an_unknown_option_is_refused_with_the_nearest_known_one() -> None:
    with pytest.raises(sf.UnknownNameError, match="metod") as refusal:
        bouncing().run(1.0, metod="rk4")
    assert "'method'" in refusal.value.problems[0].remedy
    assert "SimulationOptions" in refusal.value.problems[0].rule


def test_start_and_record_interval_follow_the_options() -> None:
    run = bouncing().run(1.5, t0=1.0, dt=1e-2, record=0.1)
    np.testing.assert_allclose(run.t[[0, -1]], [1.0, 1.5])
    np.testing.assert_allclose(np.diff(run.t[np.searchsorted(run.t, [1.1, 1.2])]), 0.1)


@pytest.mark.parametrize("how", ["run", "interpret"])
def test_the_end_is_recorded_once_wherever_rounding_puts_it(how: str) -> None:
    """The last interval may end an ulp before or behind t_end: 38 times 0.05 is 1.9, 0.05 times 38 is not."""
    diagram = sf.Diagram("still")
    diagram.add_model("plant", oscillator_system(k=1.0), start={"x": 1.0})
    diagram.add(ForwardDynamics(name="plant", model="plant"))
    simulation = sf.Simulation(diagram)
    for t_end, interval in ((1.9000000000000001, 0.05), (2.4000000000000004, 0.1), (0.35, 0.001), (0.7, 0.1)):
        run = getattr(simulation, how)(t_end, dt=0.05, record=interval)
        assert len(run.t) == round(t_end / interval) + 1 and run.t[-1] == t_end


def test_options_of_single_models_are_refused() -> None:
    for option in ({"every": 2}, {"max_steps": 10}, {"output": [0.1, 0.2]}):
        with pytest.raises(sf.SymofrosError, match="diagram: "):
            bouncing().run(1.0, **option)


def test_max_step_bounds_adaptive_steps_and_adaptive_can_be_turned_off() -> None:
    diagram = sf.Diagram("oscillator")
    diagram.add_model("plant", oscillator_system(k=100.0), start={"x": 1.0})
    diagram.add(ForwardDynamics(name="plant", model="plant"))
    simulation = sf.Simulation(diagram)
    free, bounded, fixed = (
        simulation.run(0.2, method="dopri5", record=0.1, **bounds).cost
        for bounds in ({}, {"max_step": 1e-3}, {"adaptive": False, "dt": 1e-3})
    )
    assert free.steps < 50 and 200 <= bounded.steps < 210 and fixed.steps == 200 and fixed.method == "dopri5"


def test_bounds_of_errors_are_refused_where_steps_are_fixed(tmp_path: Path) -> None:
    """Those that a diagram states beside a method of its own stay behind where one of fixed steps is chosen."""
    for method in ({}, {"method": "euler"}):
        for way in (bouncing().run, lambda _, **options: bouncing().stepper(**options)):
            with pytest.raises(sf.SymofrosError, match="an option of adaptive steps, 'rtol'"):
                way(0.1, rtol=1e-9, **method)
    diagram = sf.Diagram("oscillator", simulation=RunSettings(method="dopri5", rtol=1e-9, atol=1e-12, record=0.1))
    diagram.add_model("plant", oscillator_system(k=100.0), start={"x": 1.0})
    diagram.add(ForwardDynamics(name="plant", model="plant"))
    assert sf.Simulation(diagram).run(0.2, method="rk4").cost.steps == 200
    assert sf.Simulation(diagram).stepper(method="rk4").step()
    for given in ({"method": "rk4", "rtol": 1e-9}, {"method": "euler", "atol": 1e-9}):
        with pytest.raises(sf.ExportError, match="has no effect"):
            sf.export(diagram, "c", tmp_path, **given)
