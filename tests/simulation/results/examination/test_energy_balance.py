"""Energy that changes without work is noted; what works between the states that are kept is work all the same."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination.energy_balance import _REPEATED, _between, _norms, _power
from tests.models import interpreted
from tests.simulation.mechanisms import slide

CART = slide(actuated=True)
METHODS = ("rk4", "semi_implicit_euler", "dopri5", "dop853", "rodas4")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("begins", "lasts"), [(5.0, 0.004), (0.0, 0.01), (9.9, 0.1), (3.0, 5.0)])
def test_a_push_between_kept_states_is_work(method: str, begins: float, lasts: float) -> None:
    """2 N s on 1 kg at rest."""
    values = [0.0] * (begins > 0.0) + [2.0 / lasts, 0.0, 0.0]
    push = sf.Signal(sorted({0.0, begins, begins + lasts, 11.0}), values, "hold")
    run = sf.simulate(sf.compile(CART), t_end=10.0, method=method, u={"x": push})
    assert run.v[-1, 0] == pytest.approx(2.0, rel=1e-6) and not run.outcome.notes, run.outcome


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("force", ["2*sin(t)", "2*t"])
def test_a_force_that_depends_on_time_is_work(method: str, force: str) -> None:
    """Without an input, from rest, and zero at first."""
    run = sf.simulate(sf.compile(slide(loads=(sf.Load((force, 0, 0)),))), t_end=2.0, method=method)
    exact = 2.0 * (1.0 - np.cos(2.0)) if "sin" in force else 4.0
    assert run.v[-1, 0] == pytest.approx(exact, rel=1e-5) and not run.outcome.notes, run.outcome


@pytest.mark.parametrize("method", METHODS)
def test_a_force_by_a_clock_of_its_own_is_work(method: str) -> None:
    """A state of a force that moves by itself drives as time does: 1 N s about its value of 5.3, from rest."""
    clock, force = (sf.ForceState("clock", sf.formula("1")),), sf.formula("2*max(0, 1 - abs(clock - 5.3)/0.5)")
    tent = (sf.VirtualPower("tent", (("dx", force),)),)
    body = sf.RigidBody("mass", sf.Joint("x", "prismatic"), sf.Inertia(1.0))
    model = sf.compile(sf.System("mass", (body,), gravity=(0, 0, 0), virtual_power=tent, states=clock))
    run = sf.simulate(model, t_end=10.0, method=method)
    assert run.v[-1, 0] == pytest.approx(1.0, abs=1e-4) and not run.outcome.notes, run.outcome


@pytest.mark.parametrize("pace", [2e5, 1e7])
def test_weight_does_no_work_on_what_turns_many_times_in_a_step(pace: float) -> None:
    """Steps of 1000 s: over 2e5 rad speeds of one instant gain 1e6 W, and at 1e7 rad/s rounding alone 1e8 W."""
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0))
    pendulum = sf.RigidBody("arm", joint, sf.Inertia(2.0, (0.25, 0, 0), (0.01, 0.05, 0.05)))
    model = interpreted(sf.System("pendulum", [pendulum]))
    run: Any = SimpleNamespace(model=model, stepper=SimpleNamespace(par=np.zeros(0)))
    states = [np.zeros(200), np.linspace(0.3, 6.3, 200)[:, None], np.full((200, 1), pace), np.zeros((200, 0))]
    assert np.abs(_power(run, 1e3, states)).max() < 1e-3 * 2.0 * 9.81 * 0.25 * pace


@pytest.mark.parametrize("method", [*METHODS, "generalized_alpha"])
def test_speeds_that_a_force_drives_grow_without_a_note(method: str) -> None:
    """A damper of -2 N s/m, which feeds the motion, on 1 kg: its speed is exp(2 t)."""
    run = sf.simulate(sf.compile(slide(sf.Damper(-2.0))), v0=[1.0], t_end=10.0, method=method)
    right = pytest.approx(np.exp(20.0), rel=0.03 if method == "semi_implicit_euler" else 1e-3)
    assert run.v[-1, 0] == right and not run.outcome.notes, run.outcome


@pytest.mark.parametrize(("atol", "said"), [(1e9, True), (1e-9, False)])
@pytest.mark.parametrize("method", ["dopri5", "dop853"])
def test_speeds_that_steps_make_grow_are_noted(method: str, atol: float, said: bool) -> None:
    """A spring that hardens keeps its energy; a tolerance that bounds nothing lets the steps explode."""
    spring = sf.compile(slide(sf.Spring(1.0, 0.0, 1.0)))
    run = sf.simulate(spring, [1.0], t_end=50.0, method=method, atol=atol, max_steps=500)
    assert bool([note for note in run.outcome.notes if "although no input acts" in note]) == said, run.outcome


@pytest.mark.parametrize(("mass", "said"), [(1e250, True), (1.0, False)])
def test_infinite_energy_is_reported_as_not_judged(mass: float, said: bool) -> None:
    run = sf.simulate(sf.compile(slide(mass=mass)), v0=[1e40], t_end=1.0, method="rk4", dt=0.1)
    assert run.q[-1, 0] == pytest.approx(1e40)
    notes = [note.startswith("energy overflows, although the states do not") for note in run.outcome.notes]
    assert notes == [True] * said


def test_the_intervals_whose_energy_changes_most_are_repeated() -> None:
    """Up or down, at most so many, the largest change first."""
    count, asked = 3 * _REPEATED, list[float]()
    changes = (
        np.random.default_rng(2).permutation(np.r_[0.0, np.arange(1.0, count)]) * np.tile([1.0, -1.0], count)[:count]
    )
    t = np.arange(count + 1.0)

    def repeated(start: tuple[float, ...], t_end: float, dt: float) -> tuple[int, list[np.ndarray]]:
        assert (t_end, dt) == (start[0] + 1.0, 1e-3)
        asked.append(start[0])
        return 0, [np.array([start[0]])]

    run: Any = SimpleNamespace(
        states=(t, t, t, t),
        steps=1000 * count,
        settings=SimpleNamespace(adaptive=False, dt=1e-3),
        repeatable=True,
        repeated=repeated,
        energies=lambda ends: None,
    )
    assert len(list(_between(run, np.r_[0.0, np.cumsum(changes)]))) == _REPEATED
    assert asked == np.argsort(-np.abs(changes))[:_REPEATED].tolist()


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-170, 1.0, 1e170, 1e300])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_norms_are_those_of_rows_of_any_size(size: float, sign: float) -> None:
    rows = sign * np.array([[3.0, 4.0], [0.0, 0.0], [0.0, 1e-3]])
    np.testing.assert_allclose(_norms(size * rows), size * np.array([5.0, 0.0, 1e-3]), rtol=1e-14)
