"""A model that is stepped by hand moves as `simulate` moves it, to the last bit, whatever is asked of it between."""

from __future__ import annotations

import copy
import gc
import weakref
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
import symofros.simulation.stepper as front
import symofros.simulation.stepping.by_hand as by_hand
from tests.models import GUESSES, compiled, sampled
from tests.simulation.constraints.test_prescribed_motions import crane
from tests.simulation.mechanisms import slide

DT, STEPS = 5e-4, 12
FIXED = ["rk4", "euler", "semi_implicit_euler", "implicit_euler", "generalized_alpha", "variational"]
# Fixed steps by adaptive methods, whose last slope is the first of the next step (dopri5).
BY_DT = ["dopri5", "dop853", "rodas4"]
# A tree; ball and free joints; a free joint with beams on it; loops; beams; loops with a free joint.
SCENES = ("cart_pole", "random_tree1", "slider_crank", "planar_robot", "space_arm", "free_boom", "delta")
SAMPLE = ("cart_pole", "random_tree1", "slider_crank", "planar_robot")


@cache
def start(name: str) -> tuple[np.ndarray, np.ndarray]:
    model, rng = compiled(name), np.random.default_rng(3)
    if name in GUESSES:
        posture = sf.assemble(model, GUESSES[name], 0.3 * rng.standard_normal(model.nv))
        return posture.q, posture.v
    q, v = model.random_state(rng)
    return (model.neutral(), 1e-2 * v) if model.beams() else (q, v)


def pushes(model: sf.Model, steps: int = STEPS) -> np.ndarray:
    """Inputs of each step: some stay as they were, for which a method may go on with what it knows."""
    u = np.random.default_rng(5).standard_normal((steps, model.nu))
    u[3:5], u[8] = u[2], u[7]
    return u


def held(model: sf.Model, u: np.ndarray, t0: float = 0.0) -> sf.Signal:
    return sf.Signal(t0 + DT * np.arange(len(u)), u, "hold")


def assert_same_bits(stepper: sf.Stepper, run: sf.Trajectory, u: np.ndarray, first: int = 0) -> None:
    for k in range(first, len(u)):
        assert stepper.step(u[k])
        np.testing.assert_array_equal(stepper.q, run.q[k + 1])
        np.testing.assert_array_equal(stepper.v, run.v[k + 1])
        assert stepper.t == run.t[k + 1]


@pytest.mark.parametrize("name", sampled(SCENES, SAMPLE))
@pytest.mark.parametrize("method", [*FIXED, *BY_DT])
def test_each_step_has_the_bits_of_simulate(name: str, method: str) -> None:
    model, (q, v) = compiled(name), start(name)
    options: dict[str, Any] = {"method": method, "dt": DT} | ({"adaptive": False} if method in BY_DT else {})
    if method == "variational" and model.nc:
        with pytest.raises(sf.SymofrosError, match="trees of free motion only"):
            sf.Stepper(model, **options)
        return
    u = pushes(model)
    run = sf.simulate(model, q, v, DT * STEPS, u=held(model, u), **options)
    assert run.outcome.ok, run.outcome
    stepper = sf.Stepper(model, **options)
    for t in (1.0, 0.0):  # Once more after a reset.
        stepper.reset(q, v, t)
        if t == 0.0:
            assert_same_bits(stepper, run, u)
        else:
            assert stepper.step(u[0], 3)
    assert stepper.trajectory().q.tobytes() == run.q.tobytes()
    assert str(stepper.outcome) == str(run.outcome)


@pytest.mark.parametrize("name", ["cart_pole", "random_tree1", "slider_crank"])
@pytest.mark.parametrize("method", ["rk4", "generalized_alpha", "implicit_euler", "dopri5"])
def test_a_saved_state_goes_on_to_the_same_bits(name: str, method: str) -> None:
    model, u = compiled(name), pushes(compiled(name))
    stepper = sf.Stepper(model, method=method, dt=DT, events={"turn": "sin(1000*t)"})
    stepper.reset(*start(name))
    for row in u[:5]:
        assert stepper.step(row)
    saved, ends = stepper.save(), []
    other, again = stepper.copy(), copy.deepcopy(saved)
    for one, state in ((stepper, None), (stepper, saved), (other, None), (other, again)):
        if state is not None:
            assert one.step(10.0 * u[0], 2)  # Somewhere else.
            one.restore(state)
            assert one.t == pytest.approx(5 * DT, abs=1e-15)
        for row in u[5:]:
            assert one.step(row)
        met = [(event.t, *event.q, *event.v) for event in one.events]
        ends.append((one.q.tobytes(), one.v.tobytes(), one.t, str(met), one.trajectory().u.tobytes()))
    assert len(set(ends)) == 1 and stepper.events


def test_copies_share_nothing_that_steps_change() -> None:
    model = compiled("cart_pole")
    stepper = sf.Stepper(model, dt=DT)
    stepper.reset([0.1, 0.2], [0.3, 0.4])
    assert stepper.step([1.0])
    before = stepper.save()
    other = stepper.copy()
    assert other.step([5.0], 20)
    assert stepper.t == DT and stepper.u == 1.0
    np.testing.assert_array_equal(stepper.q, before.q)
    with pytest.raises(ValueError, match="read-only"):
        stepper.q[0] = 1.0
    assert stepper.step([2.0], 7) and other.t == 21 * DT and stepper.trajectory().u[-1] == 2.0


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_events_are_found_at_the_same_instants(method: str) -> None:
    model, u = compiled("cart_pole"), 20.0 * pushes(compiled("cart_pole"), 60)
    events = {"cart": "x - 0.0305", "force": sf.Event("F - 3", "falling"), "end": sf.Event("q - 0.22", terminal=True)}
    options: dict[str, Any] = {"dt": DT, "method": method, "events": events} | (
        {"adaptive": False} if method != "rk4" else {}
    )
    run = sf.simulate(model, [0.03, 0.2], [0.1, 1.0], DT * 60, u=held(model, u), **options)
    stepper = sf.Stepper(model, **options)
    stepper.reset([0.03, 0.2], [0.1, 1.0])
    on = [stepper.step(row) for row in u[: int(run.t[-1] / DT) + 1]]
    assert run.outcome.kind == "event" and on[-1] is False and all(on[:-1]) and not stepper.running
    assert [event.name for event in stepper.events] == [event.name for event in run.events]
    assert [event.t for event in stepper.events] == [event.t for event in run.events]
    np.testing.assert_array_equal(stepper.q, run.q[-1])
    assert stepper.t == run.outcome.t and str(stepper.outcome) == str(run.outcome)
    with pytest.raises(
        sf.SymofrosError, match=r"the motion has ended[\s\S]*event 'end'[\s\S]*reset\(\) or restore\(\)"
    ):
        stepper.step(u[0])
    stepper.reset(stepper.q, -stepper.v, stepper.t)  # A wall.
    assert stepper.step(u[0]) and not stepper.events


def test_more_events_in_a_call_than_the_buffer_holds_are_kept() -> None:
    model = compiled("cart_pole")
    stepper = sf.Stepper(model, dt=DT, events={"beat": "sin(500*t)"})
    stepper.step([0.0], 1200)
    run = sf.simulate(model, t_end=stepper.t, dt=DT, events={"beat": "sin(500*t)"})
    assert len(run.events) > 64
    assert [event.t for event in stepper.events] == [event.t for event in run.events]


def test_laws_and_manual_inputs_combine() -> None:
    model = crane()
    law = {"th": "0.3*sin(2*t)"}
    stepper = sf.Stepper(model, u=law, dt=DT)
    run = sf.simulate(model, [0.2], [0.1], DT * STEPS, u=law, dt=DT)
    stepper.reset([0.2], [0.1])
    assert stepper.inputs == ()
    assert_same_bits(stepper, run, np.zeros((STEPS, 0)))
    np.testing.assert_array_equal(stepper.u, run.u[-1])
    np.testing.assert_array_equal(stepper.a, run.a[-1])
    arm = compiled("slider_crank")
    free = sf.Stepper(arm, u={arm.names.u[0]: 3.0}, dt=DT)
    free.reset(*start("slider_crank"))
    assert free.inputs == () and free.step() and free.u[0] == 3.0


@pytest.mark.parametrize("name", ["slider_crank", "planar_robot", "random_tree1"])
def test_quantities_on_demand_match_a_trajectory(name: str) -> None:
    model, (q, v) = compiled(name), start(name)
    u = pushes(model)[0]
    stepper = sf.Stepper(model, dt=DT)
    stepper.reset(q, v)
    assert stepper.step(u, 4)
    run = sf.simulate(model, q, v, 4 * DT, dt=DT, u=u)
    np.testing.assert_array_equal(stepper.a, run.a[-1])
    np.testing.assert_array_equal(stepper.lam, run.lam[-1])
    assert (stepper.kinetic_energy, stepper.potential_energy) == (run.kinetic_energy[-1], run.potential_energy[-1])
    assert stepper.energy == run.energy[-1]
    before = stepper.q.copy(), stepper.v.copy()
    assert stepper.step(u)  # Nothing that was asked has moved it.
    run = sf.simulate(model, q, v, 5 * DT, dt=DT, u=u)
    np.testing.assert_array_equal(stepper.q, run.q[-1])
    assert not np.array_equal(before[0], stepper.q)


def test_failures_are_reported_as_by_simulate() -> None:
    model = compiled("cart_pole")
    stepper, push = sf.Stepper(model, dt=0.5, method="euler"), np.array([1e7])
    while stepper.step(push):
        push = 1e3 * push
    run = stepper.trajectory()
    assert run.outcome.kind == "diverged" and stepper.outcome == run.outcome
    assert run.t[-1] == stepper.t and np.isfinite(stepper.q).all()


def test_beams_beyond_their_theory_end_the_motion_and_a_reset_forgets_them() -> None:
    model = compiled("flexible_pendulum")
    stepper = sf.Stepper(model, dt=DT, beam_limit=0.002)
    bent = np.zeros(model.nq)
    bent[1] = 0.4
    stepper.reset(bent)
    assert not stepper.step() and stepper.outcome.kind == "beyond theory"
    stepper.reset()
    assert stepper.step(steps=3) and stepper.outcome.ok
    assert max(bending.error for bending in stepper.trajectory().bendings) < 0.002


def test_a_stepper_has_its_own_parameters() -> None:
    model = compiled("double_pendulum")
    par = 1.1 * np.asarray(model.parameter_values)
    q, v = start("double_pendulum")
    stepper = sf.Stepper(model, par=par, dt=DT)
    stepper.reset(q, v)
    assert stepper.step(steps=STEPS) and stepper.copy().par.tobytes() == par.tobytes()
    run = sf.simulate(model, q, v, DT * STEPS, par=par, dt=DT)
    np.testing.assert_array_equal(stepper.q, run.q[-1])


@pytest.mark.parametrize("name", ["cart_pole", "spatial_rod"])
def test_a_reset_may_change_the_parameters_and_a_saved_state_has_its_own(name: str) -> None:
    model = compiled(name)
    par = np.array(model.parameter_values) * np.linspace(1.01, 1.05, model.npar)
    q, v, events = (
        *start(name),
        {"level": f"{model.names.q[0]} - {model.names.q[0]}*{next(iter(model.parameters))} - 1e3"},
    )
    stepper = sf.Stepper(model, dt=1e-4, events=events)
    stepper.reset(q, v)
    assert stepper.step(steps=2)
    saved = stepper.save()
    assert stepper.step(steps=4)
    ends = [stepper.q.tobytes()]
    stepper.reset(q, v, par=par)
    np.testing.assert_array_equal(stepper.par, par)
    assert stepper.step(steps=6)
    again = sf.simulate(model, q, v, 6 * 1e-4, dt=1e-4, par=par)
    np.testing.assert_array_equal(stepper.q, again.q[-1])
    assert [str(b) for b in stepper.trajectory().bendings] == [str(b) for b in again.bendings]
    stepper.restore(saved)
    np.testing.assert_array_equal(stepper.par, model.parameter_values)
    assert stepper.step(steps=4)
    assert stepper.q.tobytes() == ends[0] != again.q[-1].tobytes()


@pytest.mark.parametrize("name", ["random_tree1", "slider_crank"])
def test_without_the_extension_everything_is_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model, u = compiled(name), pushes(compiled(name))
    ends = []
    for plain in (False, True):
        if plain:
            monkeypatch.setattr(front, "fast_step", lambda *_: None)
        stepper = sf.Stepper(model, dt=DT)
        assert ("step" in vars(stepper)) != plain
        stepper.reset(*start(name))
        for row in u:
            assert stepper.step(row.astype(np.float64)) and stepper.step(list(row), steps=3) and stepper.step()
        ends.append((stepper.q.tobytes(), stepper.v.tobytes(), stepper.t))
    assert ends[0] == ends[1]


def test_an_unreferenced_stepper_is_freed() -> None:
    stepper = sf.Stepper(compiled("cart_pole"), dt=DT)
    assert stepper.step([1.0])
    gone = weakref.ref(stepper)
    del stepper
    gc.collect()
    assert gone() is None


def test_a_long_motion_keeps_only_its_last_inputs_and_notes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(by_hand, "MOST_NOTED", 600)
    monkeypatch.setattr(front, "MOST_NOTED", 600)
    model, u = compiled("cart_pole"), pushes(compiled("cart_pole"), 1000)
    stepper = sf.Stepper(model, dt=DT)
    for row in u:
        assert stepper.step(row)
    run = stepper.trajectory()
    assert 0.0 < run.t[0] < stepper.t and any("was not looked at" in note for note in run.outcome.notes)
    np.testing.assert_allclose(run.q[-1], stepper.q, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("adaptive", [False, True])
def test_states_outlive_the_stepper(adaptive: bool) -> None:
    """What a function returns of a stepper of its own is no freed memory."""

    def states() -> tuple[np.ndarray, ...]:
        own = sf.Stepper(compiled("cart_pole"), method="dopri5" if adaptive else "rk4", dt=1e-2)
        own.reset([0.25, 0.5], [1.0, 2.0])
        return own.q, own.v

    q, v = states()
    gc.collect()
    others = [np.full(n, np.nan) for n in range(1, 9) for _ in range(2000)]  # Would take the places of what was freed.
    assert list(q) == [0.25, 0.5] and list(v) == [1.0, 2.0] and others


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_an_event_at_a_mark_costs_no_step(method: str) -> None:
    """Rounding may put it behind the mark: steps that were asked for were then one too few."""
    model = sf.compile(replace(slide(), parameters=(*slide().parameters, sf.Parameter("mark", 0.0))))
    events = {"here": sf.Event("x - mark", "rising", action={"dx": "2*dx"})}
    stepper = sf.Stepper(model, dt=1e-2, method=method, events=events)
    marks = 0.01 * np.arange(1, 60)
    ends = marks + 2.0 * (1.0 - marks)
    for mark, end in zip(marks, ends, strict=True):
        stepper.reset([0.0], [1.0], par={"mark": mark})
        assert stepper.step(steps=100) and len(stepper.events) == 1
        assert stepper.t == pytest.approx(1.0, abs=1e-12) and stepper.q[0] == pytest.approx(end, abs=1e-12)
    if method == "rk4":
        steppers = sf.Steppers(model, 59, dt=1e-2, method=method, events=events)
        steppers.reset([0.0], [1.0], par={"mark": marks})
        assert steppers.step(steps=100).all() and np.abs(steppers.q[:, 0] - ends).max() < 1e-12


@pytest.mark.parametrize("law", ["abs(t - 0.5)", "sign(t - 0.55)", "max(0, t - 0.5)", "exp(-((t - 0.5)/1e-3)^2)"])
@pytest.mark.parametrize("method", ["dopri5", "dop853", "rodas4"])
def test_adaptive_steps_by_hand_end_where_laws_bend(law: str, method: str) -> None:
    """A motion by hand has no end: instants of laws were looked for without end, until memory was full."""
    model = compiled("cart_pole")
    laws = {model.names.u[0]: law}
    stepper = sf.Stepper(model, dt=0.1, u=laws, method=method)
    stepper.reset([0.0, 0.3])
    assert stepper.step(steps=10)
    run = sf.simulate(model, [0.0, 0.3], t_end=1.0, u=laws, method=method)
    np.testing.assert_allclose(stepper.v, run.v[-1], atol=2e-5)


def test_inputs_by_name_leave_laws_as_they_are() -> None:
    """Names that are left out are zero; those that have a law, or a number, are not given by hand."""
    joints = [sf.Joint(n, "prismatic", axis=(1, 0, 0), effort=(f"F{n}",)) for n in "xyz"]
    bodies = [sf.RigidBody(f"b{j.name}", j, sf.Inertia(1.0)) for j in joints]
    system = sf.System("s", bodies, inputs=[sf.Input(f"F{n}") for n in "xyz"], gravity=(0, 0, 0))
    stepper = sf.Stepper(sf.compile(system, sf.Options(backend="tape")), u={"Fy": 3.0}, dt=0.01)
    assert stepper.inputs == ("Fx", "Fz")
    stepper.reset(np.zeros(3))
    stepper.step({"Fz": 2.0})
    np.testing.assert_allclose(stepper.v, [0.0, 0.03, 0.02], atol=1e-15)
    stepper.step({"Fx": 1.0})
    np.testing.assert_allclose(stepper.v, [0.01, 0.06, 0.02], atol=1e-15)
    with pytest.raises(sf.UnknownNameError, match="no input 'Fy' by hand"):
        stepper.step({"Fy": 1.0})
