"""Runs of diagrams are held as a whole: what is wrong by a tenth says so, what is right is quiet."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import factorial
from typing import Any

import numpy as np
import pytest
from numpy.linalg import matrix_power
from scipy.linalg import expm

import symofros as sf
from symofros import blocks
from symofros.diagrams.run.examination.examined import Examined, _whole_change
from symofros.simulation.results.examination.finer_steps import Part
from tests.diagrams.run.examination.test_remarks import sampled_loop

FINE: dict[str, Any] = {"method": "dop853", "rtol": 1e-11, "atol": 1e-12}


@cache
def driven(law: str) -> sf.Simulation:
    """A mass under a sine, and under a stop with play, a relay, or walls that it strikes."""
    force, events = {
        "play": ("80*(min(0, 0.3 - x) + max(0, -0.3 - x))", {}),
        "relay": ("-2*x - 6*relay", {}),
        "walls": ("-20*x", {"strike": sf.Event("x + 0.6", "falling", action={"dx": "-0.95*dx"})}),
    }[law]
    diagram = sf.Diagram(law)
    diagram.add_model("m", _mass(), start={"x": 0.3, "dx": 1.0})
    diagram.add(blocks.ForwardDynamics(name="plant", model="m", events=events), u="force.y")
    diagram.add(blocks.Formula(name="x", formulas={"y": "q[0]"}), q="plant.q")
    diagram.add(blocks.Relay(name="relay", lower=-0.05, upper=0.05, on=1.0, off=-1.0), u="x.y")
    push = blocks.Formula(name="force", formulas={"y": [f"{force} + 4*sin(4.4*t) + 0*relay"]})
    diagram.add(push, x="x.y", relay="relay.y")
    return sf.Simulation(diagram)


def _mass() -> sf.System:
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
    return sf.System("mass", (sf.RigidBody("mass", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0))


def off(run: Any, right: Any) -> float:
    """Error at the end, relative to the largest displacement and speed."""
    x, v = right["plant.q"], right["plant.v"]
    apart, faster = run["plant.q"][-1] - x[-1], run["plant.v"][-1] - v[-1]
    return max(float(np.abs(apart).max() / np.abs(x - x[0]).max()), float(np.abs(faster).max() / np.abs(v).max()))


LOOSE: dict[str, Any] = {"method": "dopri5", "atol": 1e-5}
SYMPLECTIC: dict[str, Any] = {"method": "semi_implicit_euler"}


@pytest.mark.parametrize(
    ("law", "t_end", "options", "wrong"),
    [
        ("play", 8.0, LOOSE | {"rtol": 1e-3}, True),
        ("play", 20.0, LOOSE | {"rtol": 1e-7}, True),
        ("walls", 8.0, SYMPLECTIC | {"dt": 0.02}, True),
        ("relay", 8.0, SYMPLECTIC | {"dt": 5e-3}, True),
        ("play", 8.0, LOOSE | {"rtol": 1e-8, "atol": 1e-9}, False),
        ("relay", 20.0, LOOSE | {"rtol": 1e-2}, False),
        ("relay", 8.0, {"method": "rk4", "dt": 1e-3}, False),
        ("walls", 20.0, {"method": "rk4", "dt": 0.01}, False),
    ],
)
def test_runs_off_by_a_tenth_bear_a_note_and_right_ones_do_not(
    law: str, t_end: float, options: dict[str, Any], wrong: bool
) -> None:
    """Against tolerances of 1e-11."""
    right, run = (driven(law).run(t_end, record=0.1, **one) for one in (FINE, options))
    error = off(run, right)
    assert (error > 0.09) == wrong and (error < 0.01) == (not wrong), error
    assert ["do not determine the motion of 'plant'" in note for note in run.outcome.notes] == [True] * wrong
    assert run.outcome.ok and not right.outcome.notes


@pytest.mark.parametrize(
    ("options", "record", "made"),
    [
        ({"method": "rk4", "dt": 1e-3}, 0.1, [-2]),  # Steps four times as long say enough.
        ({"method": "rk4", "dt": 1e-3}, 1e-3, [1]),  # Records forbid longer steps.
        ({"method": "rk4", "dt": 1e-4}, 1e-4, []),  # So many steps are not made once more.
        ({"method": "dopri5", "rtol": 1e-8}, 0.5, [-2]),
        ({"method": "dopri5", "rtol": 1e-2}, 0.5, [1, 2]),  # What a hundredth of them changes is held once more.
    ],
)
def test_the_examination_of_a_right_run_is_bounded(
    options: dict[str, Any], record: float, made: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The whole is made once more one time, or with tolerances twice tightened."""
    asked, change = list[int](), Examined.fine

    def noted(run: Examined, window: Any, refinements: int, every: int) -> Any:
        if window == run.window:
            asked.append(refinements)
        return change(run, window, refinements, every)

    monkeypatch.setattr(Examined, "fine", noted)
    run = driven("walls").run(4.0, record=record, **options)
    assert asked == made and not run.outcome.notes and len(run.events["plant"]) > 1


def test_runs_with_python_functions_are_not_examined_as_a_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """A function of Python's is not called again; formulas are, of interpreted runs too."""
    parts, change = list[Part](), Examined.change

    def noted(run: Examined, coarse: Any, fine: Any, part: Part) -> Any:
        parts.append(part)
        return change(run, coarse, fine, part)

    monkeypatch.setattr(Examined, "change", noted)
    assert sampled_loop("python").run(1.0, dt=2e-3, record=0.1).outcome.ok and "whole" not in parts
    assert sampled_loop("formula").run(1.0, dt=2e-3, record=0.1).outcome.ok and "whole" in parts
    parts.clear()
    assert sampled_loop("formula").interpret(0.5, dt=0.01, record=0.1).outcome.ok and "whole" in parts


def test_speeds_count_at_the_end_and_in_the_mean_displacements_at_any_instant() -> None:
    layout = driven("walls").resolved.layout
    t, v = np.arange(11.0), np.linspace(1.0, 2.0, 11)[:, np.newaxis]
    q, last = np.cumsum(v, axis=0), (np.arange(11) == 10)[:, np.newaxis]
    v = np.concatenate([v, np.zeros((11, len(layout.v0) - 1))], axis=1)

    def change(q_finer: Any, v_finer: Any) -> float:
        return _whole_change(layout, "plant", [t, q, v], [t, q_finer, v_finer])

    assert change(q, v) == 0.0
    assert change(q, v * (1.0 + 0.25 * last)) == pytest.approx(0.25 / 1.25)
    assert change(q, v * (1.0 + 0.1 * ~last)) == pytest.approx(0.1 * v[:-1].sum() / 11 / 2.09, rel=0.01)
    assert change(q + 0.5 * (t == 3.0)[:, np.newaxis], v) == pytest.approx(0.5 / (q[-1, 0] - q[0, 0]))


def held_mass(method: str, kind: str) -> Callable[[str], Any]:
    """A function of a method: the run of a mass under a sampled relay that begins so near its level that steps of the
    given method decide otherwise than the exact motion, and half of them as wrongly."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(9.0), sf.Damper(0.6)), actuated=True)
    system = sf.System("mass", (sf.RigidBody("mass", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0))
    period, first = 0.05, np.array([0.3, 2.0])
    rate = np.array([[0.0, 1.0], [-9.0, -0.6]]) * period
    half = matrix_power(sum(matrix_power(rate / 2, k) / factorial(k) for k in range(5)), 2)

    def highest(factor: np.ndarray) -> float:  # Of the samples while the relay is off.
        rest = np.array([-0.5, 0.0])
        return max(float((rest + matrix_power(factor, k) @ (first - rest))[0]) for k in range(1, 41))

    exact = highest(expm(rate))
    level = {"euler": exact + 1e-5, "semi_implicit_euler": exact - 1e-5, "rk4": 0.5 * (exact + highest(half))}[method]
    dt = period if method == "rk4" else period / 10

    def run(chosen: str) -> Any:
        diagram = sf.Diagram("sampled")
        diagram.add_model("m", system, start={"x": 0.3, "dx": 2.0})
        diagram.add(blocks.ForwardDynamics(name="plant", model="m"), u="relay")
        diagram.add(blocks.Relay(name="relay", lower=-2.0, upper=level, on=4.5, off=-4.5, period=period), u="plant.q")
        simulation = sf.Simulation(diagram)
        if chosen == "dop853":
            return simulation.run(2.0, method=chosen, rtol=1e-12, atol=1e-13, record=period)
        if kind == "interpreted" and chosen == method:
            return simulation.interpret(2.0, method=chosen, dt=dt, record=period)
        return simulation.run(2.0, method=chosen, dt=dt, record=period)

    return run


@pytest.mark.parametrize(
    ("method", "better", "kind"),
    [
        ("euler", "rk4", "compiled"),
        ("semi_implicit_euler", "rk4", "compiled"),
        ("rk4", "dop853", "compiled"),
        ("rk4", "dop853", "interpreted"),
    ],
)
def test_wrong_decisions_at_samples_that_half_the_step_repeats_are_noted(method: str, better: str, kind: str) -> None:
    """A relay that is sampled, started so near its level that steps decide otherwise, however halved."""
    run = held_mass(method, kind)
    wrong, right = run(method), run(better)
    assert np.abs(wrong["plant.q"] - right["plant.q"]).max() > 0.2 and not right.outcome.notes
    said = f"their error changes what is decided at a sample, and '{better}'"
    assert any(said in note for note in wrong.outcome.notes), wrong.outcome


def states_alone(rates: dict[str, str], **first: float) -> sf.Simulation:
    """A diagram of integrators: state -> its rate, a formula of all; and their first values."""
    diagram = sf.Diagram("states")
    diagram.add(blocks.Formula(name="law", formulas={f"d{name}": rate for name, rate in rates.items()}))
    for name in rates:
        diagram.add(blocks.Integrator(name=name, start=first.get(name, 0.0)), u=f"law.d{name}")
        diagram.connect(f"{name}.y", f"law.{name}")
    return sf.Simulation(diagram)


LORENZ = {"x": "10*(y - x)", "y": "x*(28 - z) - y", "z": "x*y - 8/3*z"}


@pytest.mark.parametrize("options", [{"dt": 0.02}, {"dt": 0.005}, {"method": "dopri5"}])
def test_states_of_blocks_that_finer_steps_change_bear_a_note(options: dict[str, Any]) -> None:
    """No mechanism moves here; in 40 s a Lorenz system forgets its start, in 5 s it does not."""
    simulation = states_alone(LORENZ, x=1.0, y=1.0, z=1.0)
    (note,) = simulation.run(40.0, **options).outcome.notes
    assert "do not determine the motion of 'x'" in note
    if "method" in options:
        options = {"method": "dopri5", "rtol": 1e-9, "atol": 1e-9}
    assert not simulation.run(5.0, **options | ({"dt": 0.005} if "dt" in options else {})).outcome.notes


def test_states_of_blocks_of_interpreted_runs_are_held_against_finer_steps() -> None:
    simulation = states_alone(LORENZ, x=1.0, y=1.0, z=1.0)
    assert any("do not determine" in note for note in simulation.interpret(40.0, dt=0.02, record=0.02).outcome.notes)
    assert not simulation.interpret(1.0, dt=0.005, record=0.01).outcome.notes


@pytest.mark.parametrize("options", [{"dt": 0.01}, {"method": "dopri5"}])
def test_states_that_are_rounding_bear_no_note(options: dict[str, Any]) -> None:
    """A loop at rest that nothing but 1e-17 moves, and one that oscillates, beside a state that stays."""
    rates = {"x": "1e-17*sin(50*t) - 3*x + i", "i": "0 - x", "stays": "7 - stays"}
    assert not states_alone(rates, stays=7.0).run(5.0, **options).outcome.notes
    assert not states_alone({"x": "v", "v": "0 - x"}, x=1.0).run(5.0, **options).outcome.notes


@pytest.mark.parametrize("phase", [0.0, 0.25])
def test_records_at_one_phase_alone_show_the_size_of_a_state(phase: float) -> None:
    """Records at the zeros of an oscillation, and at its peaks: what differs there is rounding and little."""
    diagram = sf.Diagram("phase")
    diagram.add(blocks.Sine(name="rate", frequency=1.0, phase=2 * np.pi * (phase + 0.25)))
    diagram.add(blocks.Integrator(name="x", start=np.sin(2 * np.pi * phase) / (2 * np.pi)), u="rate.y")
    run = sf.Simulation(diagram).run(5.0, dt=0.05, record=1.0)
    assert np.ptp(run["x.y"]) < 1e-4 and not run.outcome.notes
