"""Runs of diagrams whose steps do not follow the motion say so, short or long, compiled or interpreted."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Formula, PythonBlock
from symofros.diagrams.program.layout import Place
from symofros.diagrams.run.examination.examined import _change, _largest
from symofros.runtime.record import Segment
from tests.diagrams.parts import moving
from tests.models import GUESSES, compiled, sampled
from tests.simulation.oscillator import oscillator_system
from validation.references import MODELS


def pushed(law: str, force: str, **start: float) -> sf.Simulation:
    """A mass of 1 kg under a continuous force and a sampled one of zero, by a formula or a function of Python's."""
    diagram = moving(oscillator_system(k=1e-6), start=start, u="all.force")
    if law == "formula":
        diagram.add(Formula(name="law", formulas={"force": ["0*t"]}, period=0.1))
    else:
        calls: list[float] = []

        def push(t: float, _: object) -> dict[str, list[float]]:
            """No run goes back: only a new one begins at zero."""
            assert t == 0.0 or t > calls[-1]
            calls.append(t)
            return {"force": [0.0]}

        diagram.add(PythonBlock(name="law", function=push, outputs={"force": (1,)}, period=0.1))
    diagram.add(
        Formula(name="all", formulas={"force": [f"{force} + u[0] + 0*v[0]"]}), x="plant.q", v="plant.v", u="law.force"
    )
    return sf.Simulation(diagram)


def bounce(law: str, damping: float) -> sf.Simulation:
    """A ball on a floor that it touches for 10 ms at a time."""
    return pushed(law, f"-9.81 + max(0, -1e5*x[0] - {damping}*v[0])*(0.5 - 0.5*sign(x[0]))", x=1.0)


@pytest.mark.parametrize(("first", "whole", "size"), [(0, False, 1.4), (0, True, 5.0), (5, True, 3.4)])
def test_a_change_is_relative_to_the_motion_until_then(first: int, whole: bool, size: float) -> None:
    """A window at the start is beside all of the run, which gets faster; a later one beside what led to it."""
    place = Place(0, (1,))
    segments = (Segment("linear", 0, 0, 1),)
    layout: Any = SimpleNamespace(v={"arm": place}, moved=lambda block: (place, place), segments=segments)
    t, still = np.arange(11.0), np.zeros((11, 1))
    v = 1.0 + 0.4 * t[:, np.newaxis]
    rows = slice(first, first + 2)
    fine, coarse = [t[rows], still[rows], v[rows]], [t[rows], still[rows], v[rows] + 0.05]
    found = _change(layout, "arm", [t, still, v] if whole else None, coarse, fine, _largest)
    assert found == pytest.approx(0.05 / size)


@pytest.mark.parametrize("law", ["formula", "python"])
@pytest.mark.parametrize("t_end", [5.0, 40.0])
def test_long_steps_on_a_hardening_spring_are_noted(law: str, t_end: float) -> None:
    simulation = pushed(law, "-2000*x[0]^3", dx=2.0)
    assert len(simulation.run(t_end, dt=0.05, record=0.05).outcome.notes) == 1
    assert not simulation.run(0.5 * t_end, dt=1e-3, record=0.05).outcome.notes


@pytest.mark.parametrize("law", ["formula", "python"])
@pytest.mark.parametrize("damping", [0.0, 100.0])
@pytest.mark.parametrize("record", [0.01, 0.25])
def test_contacts_that_steps_skip_are_reported_and_resolved_ones_are_not(
    law: str, damping: float, record: float
) -> None:
    """No mode at the few states examined knows of the floor; a contact between two records does work unseen."""
    simulation = bounce(law, damping)
    coarse, fine = (simulation.run(10.0, dt=dt, record=record) for dt in (1e-2, 2e-4))
    assert coarse.outcome.notes and not fine.outcome.notes, (coarse.outcome, fine.outcome)
    assert np.abs(coarse.v - fine.v).max() > 0.3 * np.abs(fine.v).max()


def sampled_loop(law: str) -> sf.Simulation:
    """A mass of 1 kg that a sampled law holds with 100 N/m and 2 N s/m, too late to hold it still."""
    diagram = moving(oscillator_system(k=1.0), start={"x": 1.0}, u="law.force")
    given = {"x": "plant.q", "v": "plant.v"}
    if law == "formula":
        diagram.add(Formula(name="law", formulas={"force": ["-100*x[0] - 2*v[0]"]}, period=0.1), **given)
    else:

        def held(t: float, inputs: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
            return {"force": -100.0 * inputs["x"] - 2.0 * inputs["v"]}

        ports = {"x": (1,), "v": (1,)}
        diagram.add(PythonBlock(name="law", function=held, inputs=ports, outputs={"force": (1,)}, period=0.1), **given)
    return sf.Simulation(diagram)


@pytest.mark.parametrize("law", ["formula", "python"])
@pytest.mark.parametrize("method", ["euler", "semi_implicit_euler"])
@pytest.mark.parametrize("dt", [0.01, 0.003])
@pytest.mark.parametrize("t_end", [5.0, 15.0])
def test_errors_that_accumulate_over_samples_are_reported(law: str, method: str, dt: float, t_end: float) -> None:
    """A window shows a percent: held between samples, the motion knows nothing of the loop that amplifies it."""
    simulation = sampled_loop(law)
    coarse, fine = (simulation.run(t_end, dt=h, record=0.1, method=m) for h, m in ((dt, method), (dt, "rk4")))
    assert np.abs(coarse.v - fine.v)[-1] > 0.1 * np.abs(fine.v).max()
    assert coarse.outcome.notes and not fine.outcome.notes, (coarse.outcome, fine.outcome)


def test_phase_drift_from_amplitude_errors_is_reported() -> None:
    """Half the step changes a window by less than a thousandth, and the run by all of it."""
    simulation = pushed("formula", "-1e9*x[0]^3", x=1e-3)
    coarse, fine = (simulation.run(8.0, dt=dt, record=0.05) for dt in (1e-2, 2e-3))
    assert np.abs(coarse.v - fine.v).max() > 0.3 * np.abs(fine.v).max()
    assert coarse.outcome.notes and not fine.outcome.notes, (coarse.outcome, fine.outcome)


def test_energy_errors_of_repeated_contacts_are_reported() -> None:
    simulation = pushed("python", "-9.81 + max(0, -1e3*x[0])", x=1.0)
    coarse, fine = (simulation.run(20.0, method=m, dt=1e-3, record=0.1) for m in ("euler", "rk4"))
    assert np.abs(coarse.v).max() > 1.5 * np.abs(fine.v).max()
    assert coarse.outcome.notes and not fine.outcome.notes, (coarse.outcome, fine.outcome)


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_unbounded_growth_is_divergence_before_energy_overflows(method: str) -> None:
    simulation = pushed("formula", "4e3*x[0]", x=1.0)
    options = {"dt": 1e-3} if method == "rk4" else {}
    runs = [simulation.run(20.0, method=method, **options)]
    if method == "rk4":
        runs.append(simulation.interpret(20.0, method=method, dt=1e-3, record=0.1))
    for run in runs:
        assert run.outcome.kind == "diverged", run.outcome
        assert np.isfinite(np.square(run.v)).all()


def test_an_unstable_interpreted_step_is_reported_with_its_mode() -> None:
    diagram = moving(oscillator_system(k=1e6), start={"x": 1e-3})
    simulation = sf.Simulation(diagram)
    (note,) = simulation.interpret(0.3, dt=3e-3, record=3e-3, compiled=False).outcome.notes
    assert "past the limit of stability" in note and "oscillates at 1000 rad/s" in note
    assert not simulation.interpret(0.1, dt=1e-4, record=1e-3, compiled=False).outcome.notes


@pytest.mark.parametrize("scale", sampled((1e-6, 1.0, 1e6), (1e-6, 1e6)))
def test_work_of_dampers_and_sampled_efforts_is_not_noted_at_any_scale(scale: float) -> None:
    joint = sf.Joint("q", "revolute", axis=(0, -1, 0), elements=(sf.Damper(0.2 * scale),), actuated=True)
    bar = sf.RigidBody("bar", joint, sf.Inertia(scale, (1.0, 0, 0), (0.01 * scale,) * 3))
    diagram = moving(sf.System("swing", (bar,)), start={"q": 1.0}, u="push.effort")
    diagram.add(Formula(name="push", formulas={"effort": [f"{0.5 * scale}*sin(3*t)"]}, period=0.1))
    for record in (0.01, 0.1):
        run = sf.Simulation(diagram).run(30.0, dt=0.01, record=record)
        assert run.outcome.ok and not run.outcome.notes, run.outcome


@pytest.mark.parametrize(
    ("t_end", "dt", "instant", "said"),
    [
        (1.0, 0.05, 0.1125, "do not show the motion: with half of that it does not come to this end; a smaller dt"),
        (15.0, 0.05, 0.1125, "do not show the motion: with half of that it does not come to this end from t = 0 s"),
        (8.0, 0.01, 3.0025, "do not show the motion: with half of that it does not come to this end; a smaller dt"),
        (15.0, 0.05, 0.1107, ""),
    ],
)
def test_forces_that_are_not_finite_between_steps_are_reported(
    t_end: float, dt: float, instant: float, said: str
) -> None:
    """A force that is no number for an instant: half the step asks for it there, in a window or in all of the run.

    The phase of the third one drifts, so that all of the run is made once more; in the last one no step asks.
    """
    spring = 1000.0 if t_end == 8.0 else 1.0
    force = f"-{spring}*x[0]^3 + 1e-9*sqrt((t - {instant})^2 - 1e-8)"
    run = pushed("formula", force, x=1.0).run(t_end, dt=dt, record=0.05)
    assert [said in note for note in run.outcome.notes] == [True] * bool(said), run.outcome


@pytest.mark.parametrize(("method", "said"), [("euler", True), ("rk4", False)])
def test_long_runs_without_a_comparison_to_finer_steps_are_reported(method: str, said: bool) -> None:
    """An external block would have to answer again; where the steps are right nothing adds up."""
    notes = sampled_loop("python").run(15.0, method=method, dt=1e-3, record=0.1).outcome.notes
    assert [" are not held against " in note and "'law' is not called again" in note for note in notes] == [True] * said


@pytest.mark.parametrize("record", [0.01, 0.1])
def test_a_passed_singular_posture_is_noted_as_for_the_model_alone(record: float) -> None:
    """Between records that are far apart the motion is made once more; off such a posture nothing is said."""
    model = compiled("parallelogram")
    first = sf.assemble(model, GUESSES["parallelogram"], np.full(model.nv, 3.0))
    start = {**dict(zip(model.names.q, first.q, strict=True)), "dq1": float(first.v[0])}
    simulation = sf.Simulation(moving(MODELS["parallelogram"], start=start))
    alone = sf.simulate(model, first.q, first.v, 0.6, method="rk4", dt=1e-3).outcome.notes
    notes = simulation.run(0.6, method="rk4", dt=1e-3, record=record).outcome.notes
    assert ["singular posture" in note for note in alone] == ["singular posture" in note for note in notes] == [True]
    assert not simulation.run(0.1, method="rk4", dt=1e-3, record=record).outcome.notes
