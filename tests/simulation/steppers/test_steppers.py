"""Many motions that are stepped by hand together move as `simulate_batch` moves them, to the last bit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import symofros as sf
import tests.models
from tests.models import compiled
from tests.simulation.oscillator import oscillator_system
from tests.simulation.steppers.test_stepper import DT, start

N = 70  # More than the slots of one group.


def starts(name: str, n: int = N) -> tuple[np.ndarray, np.ndarray]:
    q, v = start(name)
    return np.tile(q, (n, 1)), np.linspace(0.5, 1.5, n)[:, np.newaxis] * v


def pushes(model: sf.Model, steps: int, n: int = N) -> np.ndarray:
    u = np.random.default_rng(5).standard_normal((n, steps, model.nu))
    u[::2, 3] = u[::2, 2]
    return u


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize(
    ("name", "method"),
    [
        ("cart_pole", "rk4"),
        ("cart_pole", "euler"),
        ("cart_pole", "semi_implicit_euler"),
        ("random_tree1", "dopri5"),
        ("random_tree1", "semi_implicit_euler"),
        ("slider_crank", "rk4"),
        ("planar_robot", "rk4"),
    ],
)
def test_each_step_has_the_bits_of_simulate_batch(name: str, method: str, threads: int) -> None:
    model, (q, v) = compiled(name), starts(name)
    u, options = pushes(model, 6), {"method": method, "dt": DT, "adaptive": False if method == "dopri5" else None}
    runs = sf.simulate_batch(
        model, q, v, 6 * DT, u=sf.Signal(DT * np.arange(6), u, "hold"), output=DT * np.arange(7), **options
    )
    assert runs.ok.all()
    steppers = sf.Steppers(model, N, threads=threads, **options)
    for _ in range(2):
        steppers.reset(q, v)
        np.testing.assert_array_equal(steppers.q, q)
        for k in range(6):
            assert steppers.step(u[:, k]).all()
            np.testing.assert_array_equal(steppers.q, runs.q[:, k + 1])
            np.testing.assert_array_equal(steppers.v, runs.v[:, k + 1])
        np.testing.assert_array_equal(steppers.t, runs.t_last)


@pytest.mark.parametrize(
    ("name", "method"), [("random_tree1", "dopri5"), ("cart_pole", "rk4"), ("slider_crank", "rk4")]
)
def test_saved_states_and_copies_go_on_to_the_same_bits(name: str, method: str) -> None:
    model, (q, v) = compiled(name), starts(name)
    u, options = pushes(model, 6), {"method": method, "adaptive": False if method == "dopri5" else None, "dt": DT}
    steppers = sf.Steppers(model, N, threads=2, **options)
    steppers.reset(q, v)
    for k in range(3):
        steppers.step(u[:, k])
    again = np.arange(N) % 7 == 0
    steppers.reset(q, v, which=again)  # Slots and motions have another order from here on.
    steppers.step(u[:, 2])
    saved, copied, ends = steppers.save(), steppers.copy(), []
    for steps_of in (steppers, copied, steppers, copied):
        steps_of.step()  # With the inputs that are held since before.
        for k in range(3, 6):
            steps_of.step(u[:, k])
        ends.append((steps_of.q.tobytes(), steps_of.v.tobytes(), steps_of.t.tobytes()))
        steps_of.reset()
        steps_of.step()
        steps_of.restore(saved)
        np.testing.assert_array_equal(steps_of.q, saved.q)
    assert len(set(ends)) == 1
    with pytest.raises(sf.SymofrosError, match=r"no state of these steppers[\s\S]*remedy:"):
        sf.Steppers(model, N, **options).restore(saved)


INPUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "constant": lambda u: u[:, 0],
    "held": lambda u: sf.Signal(0.7 * DT * np.arange(u.shape[1]), u, "hold"),
    "linear": lambda u: sf.Signal(0.7 * DT * np.arange(u.shape[1]), u, "linear"),
    "law": lambda _: {"F": "-3*q + 0.1*dx + sin(t)"},
}


@pytest.mark.parametrize("method", ["rk4", "euler", "semi_implicit_euler"])
@pytest.mark.parametrize("inputs", INPUTS)
@pytest.mark.parametrize("n", [1, 3, 70])
def test_steps_by_columns_have_the_bits_of_steps_by_rows(method: str, inputs: str, n: int) -> None:
    """By functions in C, as those on tape have no columns."""
    model, (q, v) = tests.models.model("cart_pole", "c"), starts("cart_pole", n)
    u = np.random.default_rng(n).standard_normal((n, 20, 1))
    u[n // 2] *= 1e120 if n > 1 else 1.0  # One is not finite within its first steps.
    ends = [
        sf.simulate_batch(model, q, v, 20 * DT, u=INPUTS[inputs](u), output=times, method=method, dt=DT)
        for times in (None, DT * np.arange(21), DT * (np.arange(20) + 0.5))  # Records within a step take it by rows.
    ]
    for run in ends[1:]:
        for name in ("t_last", "q_last", "v_last", "status", "steps"):
            np.testing.assert_array_equal(getattr(run, name), getattr(ends[0], name))
    ok = ends[1].ok
    np.testing.assert_array_equal(ends[1].q[ok, -1], ends[0].q_last[ok])


def test_a_partial_reset_with_parameters_leaves_the_others_running() -> None:
    model, (q, v) = compiled("cart_pole"), starts("cart_pole")
    par = np.tile(np.asarray(model.parameter_values), (N, 1)) * np.linspace(0.9, 1.1, N)[:, np.newaxis]
    steppers = sf.Steppers(model, N, par=par, dt=DT)
    steppers.reset(q, v)
    u = np.ones((N, 1))
    steppers.step(u, 4)
    which = np.arange(N) % 3 == 0
    steppers.reset(q, v, 1.0, par=1.2 * par, which=which)
    np.testing.assert_array_equal(steppers.v[which], v[which])
    steppers.step(u, 5)
    new = sf.simulate_batch(model, q, v, 1.0 + 5 * DT, t0=1.0, u=u, par=1.2 * par, dt=DT)
    old = sf.simulate_batch(model, q, v, 9 * DT, u=u, par=par, dt=DT)
    for run, some in ((new, which), (old, ~which)):
        np.testing.assert_array_equal(steppers.q[some], run.q_last[some])
        np.testing.assert_array_equal(steppers.t[some], run.t_last[some])
    np.testing.assert_array_equal(steppers.par[which], 1.2 * par[which])
    np.testing.assert_allclose(
        steppers.energy[which],
        steppers.model.kinetic_energy(steppers.q, steppers.v, par=steppers.par)[which]
        + steppers.model.potential_energy(steppers.q, par=steppers.par)[which],
    )


def test_a_finished_member_stays_until_it_is_reset() -> None:
    model, (q, v) = compiled("cart_pole"), starts("cart_pole")
    steppers = sf.Steppers(model, N, dt=DT)
    steppers.reset(q, v)
    u = np.zeros((N, 1))
    u[[2, 66]] = 1e120
    on = steppers.step(u, 3)
    assert np.flatnonzero(~on).tolist() == [2, 66] and steppers.outcome(2).kind == "diverged"
    assert not steppers.outcome(0).notes and steppers.outcome(0).ok
    np.testing.assert_array_equal(steppers.q[2], q[2])
    before = steppers.q[3].copy()
    assert not steppers.step(0.0 * u)[2] and not np.array_equal(steppers.q[3], before)
    steppers.reset(q, v, which=~on)
    assert steppers.step(0.0 * u, 4).all()
    np.testing.assert_array_equal(steppers.q[2], sf.simulate_batch(model, q, v, 4 * DT, dt=DT).q_last[2])


@pytest.mark.parametrize("gap", [0.1, 1e-4])
@pytest.mark.parametrize("went_before", [False, True])
def test_motions_off_their_constraints_do_not_start(gap: float, went_before: bool) -> None:
    model, (q, v) = compiled("slider_crank"), starts("slider_crank")
    steppers = sf.Steppers(model, N, dt=DT)
    if went_before:
        steppers.reset(q, v)
        assert steppers.step().all()
    q[5, 0] += gap
    steppers.reset(q, v)
    assert np.flatnonzero(~steppers.step()).tolist() == [5]
    assert steppers.outcome(5).kind == "constraints lost" and "off the constraints" in str(steppers.outcome(5))
    assert steppers.t[5] == 0.0 and np.array_equal(steppers.q[5], q[5])


def test_a_beam_that_was_beyond_its_theory_is_judged_again() -> None:
    model = compiled("flexible_pendulum")
    bent = np.zeros((3, model.nq))
    bent[1, 1] = 0.4
    steppers = sf.Steppers(model, 3, dt=1e-4, beam_limit=0.002)
    steppers.reset(bent)
    assert steppers.step().tolist() == [True, False, True] and steppers.outcome(1).kind == "beyond theory"
    steppers.reset()
    assert steppers.step(steps=2).all() and steppers.outcome(1).ok
    assert not any("second-order theory errs" in note for note in steppers.outcome(1).notes)
    unlimited = sf.Steppers(model, 3, dt=1e-4, beam_limit=np.inf)
    unlimited.reset(bent)
    assert unlimited.step().all() and unlimited.outcome(1).reason == "the end asked for"
    assert [any("second-order theory errs" in note for note in unlimited.outcome(i).notes) for i in (0, 1)] == [0, 1]


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "implicit": ({"method": "rodas4"}, r"no fixed explicit steps[\s\S]*rule:[\s\S]*remedy:"),
    "adaptive": ({"method": "dopri5"}, r"no fixed explicit steps[\s\S]*adaptive=False"),
    "number": ({"n": 0}, r"n is no number of them[\s\S]*rule:[\s\S]*remedy:"),
    "parameters": ({"par": np.ones((3, 5))}, r"par does not fit[\s\S]*\(3, 5\)[\s\S]*remedy:"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_unsupported_options_of_batches_are_refused(case: str) -> None:
    options, said = REFUSED[case]
    with pytest.raises(sf.SymofrosError, match=said):
        sf.Steppers(**({"model": compiled("cart_pole"), "n": 4} | options))


def test_wrong_inputs_of_steppers_are_refused_without_a_step() -> None:
    steppers = sf.Steppers(compiled("cart_pole"), 4, dt=DT)
    for u in (np.zeros((3, 1)), np.zeros((4, 2)), np.full((4, 1), np.nan)):
        with pytest.raises(sf.ShapeError, match=r"u does not fit[\s\S]*found:[\s\S]*rule:[\s\S]*remedy:"):
            steppers.step(u)
    for wrong in ({"q": np.zeros((3, 2))}, {"v": np.full(2, np.inf)}):
        with pytest.raises(sf.ShapeError, match=r"does not fit[\s\S]*found:[\s\S]*rule:[\s\S]*remedy:"):
            steppers.reset(**wrong)
    with pytest.raises(sf.SymofrosError, match="which does not fit"):
        steppers.reset(which=[True, False])
    with pytest.raises(sf.SymofrosError, match="one set for all"):
        steppers.reset(par=steppers.par)
    assert not steppers.t.any()


def test_outcomes_tell_what_the_motions_with_kept_inputs_bear() -> None:
    """Of seven a Stepper makes four once more, through saves, copies and changes of inputs; the others tell of them."""
    model = sf.compile(oscillator_system(k=1e7))
    steppers = sf.Steppers(model, 7, dt=1e-3, method="rk4")
    steppers.reset([0.0], [1.0])
    assert "not examined:" in steppers.outcome(0).notes[0]
    steppers.step(np.zeros((7, model.nu)), 10)
    steppers.step(None, 10)
    kept = steppers.save()
    one = sf.Stepper(model, dt=1e-3, method="rk4")
    one.reset([0.0], [1.0])
    one.step(np.zeros(model.nu), 20)
    wanted = one.outcome.notes
    assert any("past the limit of stability" in note for note in wanted)
    assert all(steppers.outcome(i).notes == wanted for i in (0, 2, 4, 6))
    (said,) = (note for note in steppers.outcome(1).notes if "not examined" in note)
    assert "of motions 0, 2, 4, 6, which are" in said and "past the limit" in said
    steppers.step(None, 5)
    steppers.restore(kept)
    assert steppers.outcome(6).notes == steppers.copy().outcome(6).notes == wanted


def test_inputs_that_are_kept_are_forgotten_after_many_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until the next reset, which may be of that motion alone."""
    monkeypatch.setattr("symofros.simulation.steppers._MOST_CALLS", 3)
    steppers = sf.Steppers(sf.compile(oscillator_system()), 2, dt=1e-3, method="rk4")
    said = []
    for calls in range(5):
        if calls == 4:
            steppers.reset(which=np.array([False, True]))
        steppers.step()
        said.append([any("not examined" in note for note in steppers.outcome(i).notes) for i in range(2)])
    assert said == [[False, False]] * 3 + [[True, True], [True, False]]


def test_a_motion_with_kept_inputs_is_made_once_more_for_each_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever asks for the outcomes of all motions waits for those few, once."""
    made: list[sf.Model] = []

    def counted(model: sf.Model, **options: Any) -> sf.Stepper:
        made.append(model)
        return sf.Stepper(model, **options)

    monkeypatch.setattr("symofros.simulation.steppers.Stepper", counted)
    steppers = sf.Steppers(sf.compile(oscillator_system()), 7, dt=1e-3, method="rk4")
    for times in range(1, 4):
        steppers.step(None, 2)
        before = [steppers.outcome(i).notes for i in range(7)]
        assert [steppers.outcome(i).notes for i in range(7)] == before and len(made) == 4 * times
    steppers.reset()
    steppers.step(None, 2)
    assert steppers.outcome(0).ok and len(made) == 13
