"""A diagram that is stepped by hand moves as `Simulation.run` moves it, to the last bit."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Formula, PythonBlock
from symofros.diagrams import stepper as stepper_module
from tests.diagrams.parts import Ball, Counter, Lag, Spoken, arm, moving, ramp
from tests.simulation.oscillator import oscillator_system

PENDULUM = sf.load(Path(__file__).parents[3] / "reference_models" / "rigid" / "double_pendulum.yaml")
FOUR_PARTS = r"[\s\S]*found:[\s\S]*rule:[\s\S]*remedy:"


def sampled_arm() -> sf.Diagram:
    return arm(PENDULUM, 2.5e-3, q1=0.3)


def bouncing() -> sf.Diagram:
    diagram = sf.Diagram("ball")
    diagram.add(Ball(name="ball"))
    return diagram


def counted() -> sf.Diagram:
    """Samples of 2 and 3 ms, a block of Python's among them."""
    diagram = sf.Diagram("counted")
    diagram.add(ramp())
    diagram.add(Counter(name="count", period=2e-3))
    diagram.add(Spoken(name="spoken", heard=[], period=3e-3), x="ramp.y")
    diagram.add(Lag(name="lag"), x="count.n")
    return diagram


DIAGRAMS: dict[str, tuple[Callable[[], sf.Diagram], tuple[str, ...], float]] = {
    "arm": (sampled_arm, ("plant.q", "plant.v", "pd.effort", "plant.a"), 2.5e-3),
    "ball": (bouncing, ("ball.height", "ball.bounces"), 1e-2),
    "rates": (counted, ("count.n", "lag.y", "spoken.y"), 1e-3),
}


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler"])
@pytest.mark.parametrize("case", DIAGRAMS)
def test_each_step_has_the_bits_of_a_run(case: str, method: str) -> None:
    make, signals, period = DIAGRAMS[case]
    diagram, options = make(), {"method": method, "dt": 1e-2 if case == "ball" else 1e-3}
    simulation, n = sf.Simulation(diagram), 60
    run = simulation.run(n * period, output=period, **options)
    stepper = simulation.stepper(**options)
    assert stepper.period == period and stepper.t == 0.0
    for again in range(2):
        for k in range(n + 1):
            for name in signals:
                np.testing.assert_array_equal(stepper[name], run[name][np.flatnonzero(run.t == stepper.t)[-1]])
            if k < n:
                assert stepper.step()
        assert stepper.t == run.t[-1] and not (again and run.crossings and not stepper.trajectory().crossings)
        stepper.reset()
    assert stepper.step(steps=n)
    made = stepper.trajectory()
    assert (made.outcome.kind, made.outcome.notes) == (run.outcome.kind, run.outcome.notes)
    for name in ("t", "q", "v", "u"):
        np.testing.assert_array_equal(getattr(made, name), getattr(run, name))
    if case == "arm":
        q, v = stepper.motion("plant")
        np.testing.assert_array_equal(np.r_[q, v], np.r_[run["plant.q"][-1], run["plant.v"][-1]])


def test_parameters_of_a_reset_are_those_of_the_motion() -> None:
    simulation = sf.Simulation(sampled_arm())
    given = {"pd.kp": [20.0, 10.0]}
    run, stepper = (
        simulation.run(0.05, output=0.01, dt=1e-3, parameters=given),
        simulation.stepper(output=0.01, dt=1e-3),
    )
    stepper.step(steps=3)
    stepper.reset(parameters=given)
    stepper.step(steps=5)
    np.testing.assert_array_equal(stepper["plant.q"], run["plant.q"][-1])
    assert stepper.outcome.ok


def test_inlets_have_what_is_given_for_them() -> None:
    diagram = sf.Diagram("lagging")
    diagram.add(Lag(name="lag", tau=0.05))
    diagram.add_inlet("x", "lag.x", shape=())
    simulation, given = sf.Simulation(diagram), {"x": "sin(9*t)"}
    run, stepper = simulation.run(0.1, output=0.01, inputs=given), simulation.stepper(output=0.01, inputs=given)
    assert stepper.step(steps=10)
    np.testing.assert_array_equal(stepper["lag.y"], run["lag.y"][-1])
    with pytest.raises(sf.DescriptionError, match="'x'"):
        simulation.stepper()


@pytest.mark.parametrize(("method", "tolerance"), [("rk4", 0.0), ("dopri5", 1e-9)])
def test_steps_end_where_formulas_of_time_jump(method: str, tolerance: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stepper_module, "_AHEAD", 8)  # Jumps are found for so many steps at a time.
    diagram = sf.Diagram("jumps")
    diagram.add(Formula(name="jump", formulas={"y": "sign(t - 0.0303) + sign(t - 0.2707)"}))
    diagram.add(Lag(name="lag", tau=0.05), x="jump.y")
    simulation = sf.Simulation(diagram)
    run = simulation.run(0.4, output=0.01, method=method, dt=1e-3)
    stepper = simulation.stepper(output=0.01, method=method, dt=1e-3)
    for k in range(1, 41):
        assert stepper.step() and stepper.t == run.t[k]
        np.testing.assert_allclose(stepper["lag.y"], run["lag.y"][k], rtol=tolerance, atol=tolerance)


def pushed(function: Callable[[float, Any], Any]) -> sf.Diagram:
    diagram = moving(oscillator_system(), u="law.force")
    diagram.add(PythonBlock(name="law", function=function, outputs={"force": (1,)}, period=0.01))
    return diagram


def raises(t: float, inputs: Any) -> dict[str, list[float]]:
    if t > 0.095:
        raise LookupError("no such gain")
    return {"force": [0.0]}


def not_finite(t: float, inputs: Any) -> dict[str, list[float]]:
    return {"force": [np.nan if t > 0.095 else 0.0]}


@pytest.mark.parametrize("function", [raises, not_finite])
def test_the_outcome_of_a_stepper_equals_that_of_a_run(function: Callable[[float, Any], Any]) -> None:
    simulation = sf.Simulation(pushed(function))
    want = simulation.run(0.2, output=0.01, dt=1e-3).outcome
    stepper = simulation.stepper(dt=1e-3)
    while stepper.t < 0.2 and stepper.step():
        pass
    assert not stepper.running and (stepper.outcome.kind, stepper.outcome.t) == (want.kind, want.t)
    assert stepper.outcome.reason == want.reason
    with pytest.raises(sf.SymofrosError, match="motion has ended" + FOUR_PARTS):
        stepper.step()
    stepper.reset()
    assert stepper.step(steps=9)
    stepper.close()
    assert not stepper.running


def made(**options: Any) -> Any:
    return sf.Simulation(bouncing()).stepper(**options)


REFUSED: dict[str, tuple[Callable[[], object], str]] = {
    "steps": (lambda: made().step(steps=0), "no number of steps" + FOUR_PARTS),
    "pace": (lambda: made(realtime=True), "whole runs" + FOUR_PARTS),
    "method": (lambda: made(method="rodas4"), "method 'rodas4'" + FOUR_PARTS),
    "option": (lambda: made(timestep=1.0), "did you mean 'dt'"),
    "motion": (lambda: made().outcome, "no motion yet" + FOUR_PARTS),
    "block": (lambda: made().motion("ball"), "moves no mechanism" + FOUR_PARTS),
    "copy": (lambda: copy.copy(made()), "no copy" + FOUR_PARTS),
    "pickle": (lambda: pickle.dumps(made()), "not pickled" + FOUR_PARTS),
    "assigned": (lambda: setattr(made(), "t", 1.0), "t is not assigned" + FOUR_PARTS),
}


@pytest.mark.parametrize("case", REFUSED)
def test_messages_name_what_is_meant(case: str) -> None:
    call, said = REFUSED[case]
    with pytest.raises(sf.SymofrosError, match=said):
        call()
