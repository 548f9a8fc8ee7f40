"""Short runs are repeated with half the step; of sparse records the intervals in which energy changes."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import symofros as sf
from tests.models import sampled
from tests.simulation.mechanisms import slide
from tests.simulation.oscillator import oscillator


@cache
def two_masses() -> sf.Model:
    """Two masses in a row on springs and dampers; all of them are parameters."""
    names = ("m1", "m2", "k1", "k2", "c1", "c2")

    def mass(i: int, *parent: str) -> sf.RigidBody:
        elements = (sf.Spring(f"k{i}"), sf.Damper(f"c{i}"))
        joint = sf.Joint(f"x{i}", "prismatic", *parent, axis=(1, 0, 0), elements=elements)
        return sf.RigidBody(f"mass{i}", joint, sf.Inertia(f"m{i}"))

    parameters = tuple(sf.Parameter(name, 1.0) for name in names)
    return sf.compile(sf.System("two_masses", (mass(1), mass(2, "mass1")), parameters, gravity=(0, 0, 0)))


def exact_state(par: tuple[float, ...], q: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
    """State after t from rest, and the matrix of twice its energy."""
    m1, m2, k1, k2, c1, c2 = par
    M, K, C = np.array([[m1 + m2, m2], [m2, m2]]), np.diag([k1, k2]), np.diag([c1, c2])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    return scipy.linalg.expm(A * t) @ np.concatenate([q, np.zeros(2)]), scipy.linalg.block_diag(K, M)


@pytest.mark.parametrize(
    "method", sampled(("generalized_alpha", "rodas4", "semi_implicit_euler", "rk4"), ("generalized_alpha", "rk4"))
)
def test_short_runs_with_large_errors_get_a_note(method: str) -> None:
    """Whatever the ratio of masses, the stiffness, the damping and the step."""
    rng, wrong = np.random.default_rng(0), 0
    for _ in range(40):
        mass, stiffness, damping, h = 10.0 ** rng.integers([-4, -4, -5, -2], [5, 5, 3, 1])
        par = (1.0, mass, 1.0, stiffness, damping, damping * np.sqrt(mass * stiffness))
        steps, q = int(rng.integers(3, 80)), rng.uniform(-1.0, 1.0, 2)
        run = sf.simulate(two_masses(), q, t_end=steps * h, method=method, dt=h, adaptive=False, par=par)
        end, energy = exact_state(par, q, steps * h)
        if not run.outcome.ok:
            continue
        error = np.concatenate([run.q[-1], run.v[-1]]) - end
        with np.errstate(over="ignore", invalid="ignore"):  # Of an explosion.
            wrong_state = not error @ energy @ error <= 0.1 * (q @ energy[:2, :2] @ q)
        if wrong_state:
            wrong += 1
            assert run.outcome.notes, (par, h, steps)
    assert wrong


def test_runs_with_pure_functions_are_compared_with_half_the_step_and_others_noted() -> None:
    """A spring that hardens, as a formula, as a function, as a function with a memory of its calls."""
    calls = []

    def pure(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        return [-2000.0 * float(q[0]) ** 3]

    def remembering(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        calls.append(t)
        return [-2000.0 * float(q[0]) ** 3 + 1e-3 * len(calls)]

    def raising(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        calls.append(t)
        if len(calls) > 1 and t < max(calls) - 0.2:
            raise RuntimeError("the past is gone")
        return [-2000.0 * float(q[0]) ** 3]

    def notes(u: object, dt: float = 0.05) -> list[str]:
        calls.clear()
        outcome = sf.simulate(oscillator(), [0.0], [2.0], 5.0, u=u, dt=dt).outcome  # type: ignore[arg-type]
        assert outcome.kind == "finished"
        return [note for note in outcome.notes if note.startswith(f"steps of {dt:g} s")]

    (by_formula,), (by_function,) = notes({oscillator().names.u[0]: "-2000*x^3"}), notes(pure)
    assert by_formula == by_function and "half of that changes it by" in by_function
    for function in (remembering, raising):
        (note,) = notes(function)
        assert "were not held against half of that" in note


def test_energy_is_judged_whatever_is_recorded() -> None:
    """Implicit Euler damps an oscillator that has no damper."""
    par, stepping = (1.0, 1.0, 10.0, 10.0, 0.0, 0.0), {"method": "implicit_euler", "dt": 0.01}
    for output in (None, 20.0, [0.0, 13.0, 40.0]):
        run = sf.simulate(two_masses(), [1.0, 0.0], t_end=40.0, par=par, output=output, **stepping)
        assert any("energy changes" in note for note in run.outcome.notes), output


def test_a_contact_between_two_records_takes_energy_without_a_note() -> None:
    stop = sf.Stop(1e4, damping=40.0, lower=0.0)
    model = sf.compile(slide(stop, name="z", axis=(0, 0, 1), gravity=(0, 0, -9.81)))
    run = sf.simulate(model, [1.0], t_end=1.2, method="rk4", dt=1e-4, output=[0.0, 0.4, 0.8, 1.2])
    assert run.energy[-1] < 0.9 * run.energy[0] and not run.outcome.notes
    many = sf.simulate_batch(model, [[1.0], [1.1]], t_end=1.2, method="rk4", dt=1e-4, output=[0.0, 0.4, 0.8, 1.2])
    assert not many.outcome(0).notes and not many.outcome(1).notes


@pytest.mark.parametrize("method", ["dopri5", "rodas4", "dop853"])
def test_an_absolute_tolerance_beyond_the_speeds_is_noted_where_it_harms(method: str) -> None:
    """Slow oscillators of some millimetres move by nanometres a second."""
    par, t_end, wrong = (1.0, 1.0, 1e-10, 1e-8, 0.0, 0.0), 60e5, 0
    for atol in (1e-10, 1e-7, 1e-6, 1e-4, 1e-3):
        run = sf.simulate(two_masses(), [3e-3, 0.0], t_end=t_end, method=method, atol=atol, par=par)
        end, energy = exact_state(par, np.array([3e-3, 0.0]), t_end)
        error = np.concatenate([run.q[-1], run.v[-1]]) - end
        said = [note for note in run.outcome.notes if f"atol = {atol:.3g} bounds no error of speeds that reach" in note]
        if error @ energy @ error > 0.1 * 9e-6 * par[2]:
            wrong += 1
            assert run.outcome.notes and (said or method != "dopri5"), (atol, run.outcome)
        elif atol == 1e-10:
            assert not said and not run.outcome.notes
    assert wrong


@cache
def stiffened() -> sf.Model:
    """A mass on a spring that is stiffer by k about one instant late in a run, at any scale of time."""
    force = sf.formula("-400/T^2*x*(1 + k*exp(-((t/T - when)/width)^2))", "F")
    parameters = tuple(sf.Parameter(name, 1.0) for name in ("T", "k", "when", "width"))
    return sf.compile(slide(loads=(sf.Load((force, 0.0, 0.0)),), parameters=parameters))


def test_long_runs_with_late_errors_get_a_note() -> None:
    """Fixed steps that suit all but one late part: its states are in no other examination."""
    rng, wrong, noted = np.random.default_rng(0), 0, 0
    for _ in range(20):
        T, amplitude = 10.0 ** rng.integers(-3, 4), 10.0 ** rng.integers(-6, 3)
        par = {"T": T, "k": rng.uniform(20, 90), "when": rng.uniform(6, 18), "width": rng.uniform(0.2, 1.0)}
        given = {"t_end": 20.0 * T, "par": par, "method": "rk4"}
        run = sf.simulate(stiffened(), [amplitude], dt=0.01 * T, **given)
        fine = sf.simulate(stiffened(), [amplitude], dt=0.00125 * T, **given)
        scale = np.abs(fine.v).max()
        assert not fine.outcome.notes
        if run.outcome.ok and abs(np.abs(run.v[-200:]).max() - np.abs(fine.v[-1600:]).max()) > 0.3 * scale:
            wrong += 1
            noted += bool(run.outcome.notes)
    assert wrong >= 5 and noted == wrong


@pytest.mark.parametrize("t_end", [1.0, 15.0])
@pytest.mark.parametrize("met", [True, False])
def test_forces_that_are_not_finite_between_steps_are_noted(t_end: float, met: bool) -> None:
    """A force that is no number for an instant: half the step asks for it there, or no step does."""
    instant = 0.1125 if met else 0.1107
    force = sf.formula(f"-20*x^3 + 1e-9*sqrt((t - {instant})^2 - 1e-7)")
    run = sf.simulate(sf.compile(slide(loads=(sf.Load((force, 0.0, 0.0)),))), [1.0], t_end=t_end, dt=0.05)
    said = "do not show the motion: with half of that it does not come to this end"
    assert [said in note for note in run.outcome.notes] == [True] * met, run.outcome


@pytest.mark.parametrize(
    ("force", "options", "said"),
    [
        ("0*t", {"method": "semi_implicit_euler", "dt": 0.01, "t_end": 60.0}, False),
        ("x - 1e3*x^3", {"method": "rk4", "dt": 0.01, "t_end": 8.0}, True),
        ("x - 1e3*x^3", {"method": "rk4", "dt": 0.002, "t_end": 8.0}, False),
    ],
)
def test_errors_that_add_up_over_a_long_run_are_noted(force: str, options: dict[str, Any], said: bool) -> None:
    """Of which no window shows a tenth (simulation.md, 17b); semi-implicit Euler errs by h/2 for ever."""
    run = sf.simulate(oscillator(), [1.0], u={"x": force}, output=0.07, **options)
    assert bool([note for note in run.outcome.notes if "do not determine the motion" in note]) == said, run.outcome


@pytest.mark.parametrize("options", [{"dt": 0.05}, {"method": "dopri5"}], ids=str)
@pytest.mark.parametrize("kind", ["pure", "remembering"])
def test_an_input_function_is_examined_once_however_many_notes_need_it(options: dict[str, Any], kind: str) -> None:
    """By its calls at the last record and the ones before it, in that order, which only the examination makes."""
    calls: list[float] = []

    def law(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        calls.append(t)
        return [-200.0 * float(q[0]) ** 3 + 1e-3 * len(calls) * (kind == "remembering")]

    run = sf.simulate(oscillator(), [0.0], [2.0], 5.0, u=law, **options)
    asked = run.t[:: -max(1, len(run.t) // 8)]
    count = sum(calls[i : i + 3] == [*asked[:3]] for i in range(len(calls)))
    assert count == 1, run.outcome


@cache
def pushed() -> sf.Model:
    """A pendulum with a damper and a motor."""
    joint = sf.Joint("x", "revolute", axis=(0, 1, 0), elements=(sf.Damper(0.2),), actuated=True)
    body = sf.RigidBody("body", joint, sf.Inertia(1.0, (0.0, 0.0, -0.3), (0.05, 0.05, 0.01)))
    return sf.compile(sf.System("pushed", (body,)))


LAWS: dict[str, Any] = {
    "formula": {"x": "2*sin(3*t)"},
    "function of time": lambda t, q, v: [2.0 * np.sin(3.0 * t)],
    "feedback": lambda t, q, v: [2.0 * np.sin(3.0 * t) - 0.05 * q[0]],
    "relay": lambda t, q, v: [3.0 if np.sin(2.0 * t) > q[0] else -3.0],
}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("method", "dt"), [("semi_implicit_euler", 0.01), ("rk4", 0.01), ("rk4", 0.004)])
def test_long_runs_are_held_to_three_per_cent(law: str, method: str, dt: float) -> None:
    """By steps of order 1 whatever acts, by others where inputs jump: of functions of the caller, too."""
    one, other = (
        sf.simulate(pushed(), [0.5], [0.0], 5.0, u=LAWS[law], method=name, dt=h, output=0.05)
        for name, h in ((method, dt), ("rk4", 2e-4 if law == "relay" else 2e-3))
    )
    error = np.abs(one.q - other.q).max() / np.abs(other.q - 0.5).max()
    assert bool(one.outcome.notes) == (law == "relay" or method != "rk4"), (error, one.outcome)
    assert (error > 0.025) == bool(one.outcome.notes), (error, one.outcome)
