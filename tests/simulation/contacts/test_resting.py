"""Contacts that come to rest and open again (docs/theory/constraints.md, section 13)."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import bounds

G, E = 9.81, 0.5


@cache
def ball() -> sf.Model:
    """A ball of 1 kg above a floor, and under a ceiling at 1 m, at which an input pulls."""
    body = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1), actuated=True), sf.Inertia(1.0))
    walls = (sf.Coupling("floor", "z"), sf.Coupling("ceiling", "z - 1"))
    switches = (sf.Switch("floor", "down"), sf.Switch("ceiling", "up"))
    parameters = (sf.Parameter("down", 0), sf.Parameter("up", 0))
    return sf.compile(sf.System("ball", (body,), parameters, constraints=walls, switches=switches))


def floor(e: float = E, **changes: Any) -> dict[str, sf.Event]:
    """The contact of ball and floor."""
    stated: dict[str, Any] = {"formula": "z", "direction": "falling", "action": {"down": 1}}
    return {"strike": sf.Event(**stated | {"restitution": e, "rests": "lam.floor"} | changes)}


def ceiling() -> dict[str, sf.Event]:
    """The contact of ball and ceiling."""
    return {"knock": sf.Event("z - 1", "rising", action={"up": 1}, restitution=E, rests="-lam.ceiling")}


def instants(h: float, n: int) -> Any:
    """Instants of the first n strikes from rest at a height, and the one at which they accumulate."""
    first = np.sqrt(2 * h / G)
    return first * (1 + 2 * E * (1 - E ** np.arange(n)) / (1 - E)), first * (1 + E) / (1 - E)


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_a_bouncing_ball_comes_to_rest_and_is_lifted(method: str) -> None:
    """By the closed form to 1e-12 until the strikes accumulate; it rests until the pull is its weight, then flies."""
    options: dict[str, Any] = {"method": method, "dt": 1e-2} | bounds(method, 1e-10, 1e-13)
    run = sf.simulate(ball(), [0.7], t_end=2.6, u={"z": "20*(t - 1.5)"}, events=floor(), **options)
    assert [found.name for found in run.events[-2:]] == ["strike", "strike opens"]
    # Up to the first strike the pull is felt, too: without it the closed form holds.
    free = sf.simulate(ball(), [0.7], t_end=2.0, events=floor(), **options)
    met, (known, end) = np.array([found.t for found in free.events]), instants(0.7, len(free.events))
    assert len(met) > 15 and met == pytest.approx(known, abs=1e-12) and abs(met[-1] - end) < 1e-5
    assert free.outcome.kind == "finished" and all(found.energy_lost >= 0.0 for found in free.events)
    (note,) = free.outcome.notes
    within = 1e-5 if method == "rk4" else 1e-6 * met[-1]
    said = f"event 'strike': the contact persists from t = {met[-1]:.12g} s on, where strikes would follow within"
    assert note == f"{said} {within:.3g} s"
    still = free.t > met[-1]
    assert np.abs(free.q[still]).max() < 1e-15 and not free.v[still].any()
    assert free.lam[still][1:, 0] == pytest.approx(G, abs=1e-12) and free.par_over_time[-1, 0] == 1
    opened = run.events[-1].t
    assert opened == pytest.approx(1.5 + G / 20, abs=1e-12) and not run.par_over_time[-1].any()
    assert run.q[-1, 0] == pytest.approx(20 / 6 * (2.6 - opened) ** 3, abs=1e-12)


@pytest.mark.parametrize("e", [0.5, 0.9])
@pytest.mark.parametrize("method", ["semi_implicit_euler", "implicit_euler"])
def test_methods_of_order_one_come_to_rest_on_the_floor(method: str, e: float) -> None:
    """They fell through it where a flight was shorter than a step; strikes approach, and rests follow (4d)."""
    run = sf.simulate(ball(), [1.0], t_end=12.0, events=floor(e), method=method, dt=1e-2)
    assert run.outcome.kind == "finished" and any("the contact persists" in note for note in run.outcome.notes)
    assert all(found.v[0] < 0.0 < found.v_after[0] for found in run.events[:-1])
    assert run.q.min() > -1e-12 and abs(run.q[-1, 0]) < 1e-12 and run.lam[-1] == pytest.approx([G, 0.0], abs=1e-9)
    without = sf.simulate(ball(), [1.0], t_end=12.0, events=floor(e, rests=None), method=method, dt=1e-2)
    assert without.outcome.kind == "interrupted" and "without end" in without.outcome.reason
    assert without.q.min() > -1e-12


@pytest.mark.parametrize("e", [0.3, 0.6, 0.8])
def test_bounces_by_explicit_euler_end_where_the_method_adds_what_strikes_take(e: float) -> None:
    """They went on for ever, at a height of h^2 g; flights of less than (32d) are the last, and the note says so."""
    h = 1e-2 * (1.0 - e)
    run = sf.simulate(ball(), [0.1], t_end=2.0, events=floor(e), method="euler", dt=h)
    assert run.q.min() > -1e-12 and run.q[-1, 0] == pytest.approx(0.0, abs=1e-12) and not run.v[-1].any()
    (note,) = (note for note in run.outcome.notes if "persists" in note)
    assert note.endswith(f"would follow within {2.0 * h / (1.0 - e):.3g} s")
    flights = np.diff([found.t for found in run.events])
    assert flights[-1] <= 2.0 * h / (1.0 - e) < flights[-2]
    assert run.events[-1].t == pytest.approx(np.sqrt(0.2 / G) * (1.0 + e) / (1.0 - e), rel=0.1)


def test_a_plastic_strike_rests_at_once_and_residuals_of_complementarity_are_rounding() -> None:
    """Gap and force are never below zero, and one of them is zero, over openings and strikes."""
    pull = {"z": "12*sin(2*t)"}
    run = sf.simulate(ball(), [0.3], t_end=6.0, u=pull, events=floor(0.0), method="dopri5", rtol=1e-10)
    assert [found.name for found in run.events] == ["strike", "strike opens"] * 2 + ["strike"]
    many = sf.simulate_batch(ball(), [[0.3]], t_end=6.0, u=pull, events=floor(0.0), method="dopri5", rtol=1e-10)
    for outcome in (run.outcome, many[0].outcome):
        (note,) = (note for note in outcome.notes if "persists" in note)
        assert note.endswith(f"from t = {run.events[0].t:.12g} s on"), "the first rest; no strikes follow"
    gap, force = run.q[:, 0], run.lam[:, 0]
    assert gap.min() > -1e-12 and force.min() > -1e-12 * G and np.minimum(abs(gap), abs(force) / G).max() < 1e-12


def test_a_ball_between_two_planes() -> None:
    """It strikes both in turn, comes to rest below, is drawn up and rests above."""
    events = floor() | ceiling()
    run = sf.simulate(ball(), [0.5], [7.0], 6.0, u={"z": "8*(t - 2)"}, events=events, method="dopri5", rtol=1e-10)
    rested = [note for note in run.outcome.notes if "persists" in note]
    assert run.events[0].name == "knock" and run.events[1].name == "strike" and rested
    assert [found.name for found in run.events if "opens" in found.name] == ["strike opens"]
    assert run.q[-1] == pytest.approx([1.0], abs=1e-12) and run.par_over_time[-1] == pytest.approx([0, 1])
    assert run.q.min() > -1e-12 and run.q.max() < 1 + 1e-12


def test_a_ball_that_begins_at_the_ceiling_drops_when_the_pull_is_less_than_its_weight() -> None:
    """A contact from below is held away from its strike, too, (32b)."""
    pull = sf.Signal([0.0, 0.5], [20.0, 0.0], "hold")
    run = sf.simulate(ball(), [1.0], t_end=0.8, par={"up": 1}, u={"z": pull}, events=ceiling(), dt=1e-2)
    assert run.outcome.kind == "finished" and not run.outcome.notes
    assert [(found.name, found.t) for found in run.events] == [("knock opens", 0.5)]
    assert run.q[-1, 0] == pytest.approx(1.0 - 0.5 * G * 0.3**2, abs=1e-12) and not run.par_over_time[-1].any()


def test_a_contact_may_open_before_its_force_falls_to_zero() -> None:
    """The force of a contact that is open says nothing of it, (32b): here it is below zero."""
    pull = sf.Signal([0.0, 1.5], [0.0, 20.0], "hold")
    run = sf.simulate(ball(), [0.3], t_end=2.0, u={"z": pull}, events=floor(rests="lam.floor - 0.5"), dt=1e-2)
    assert run.outcome.kind == "finished" and {found.name for found in run.events[:-1]} == {"strike"}
    assert (run.events[-1].name, run.events[-1].t) == ("strike opens", 1.5)
    assert run.q[-1, 0] == pytest.approx(0.5 * (20 - G) * 0.5**2, abs=1e-12)


def test_a_plastic_strike_that_forces_part_at_once_is_no_rest() -> None:
    """A pull above the weight lifts a ball that it has let strike, (32a), whatever force would open the contact."""
    run = sf.simulate(ball(), [0.3], [-5.0], 1.0, u={"z": 20.0}, events=floor(0.0), dt=1e-2)
    struck = (5 - np.sqrt(25 - 4 * (20 - G) * 0.15)) / (20 - G)
    assert run.outcome.kind == "finished" and not run.outcome.notes and not run.par_over_time.any()
    assert [found.t for found in run.events] == pytest.approx([struck], abs=1e-12)
    assert run.q[-1, 0] == pytest.approx(0.5 * (20 - G) * (1 - struck) ** 2, abs=1e-12)


def test_a_ball_that_slides_down_a_hill_does_not_strike_it() -> None:
    """While a contact holds its gap is zero but for drift, which crosses zero either way and is no strike, (32b)."""
    slide = sf.RigidBody("slide", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    body = sf.RigidBody("ball", sf.Joint("z", "prismatic", "slide", axis=(0, 0, 1)), sf.Inertia(1.0))
    hill, switch = sf.Coupling("floor", "z - cos(x)"), sf.Switch("floor", "down")
    parameters = (sf.Parameter("down", 0),)
    model = sf.compile(sf.System("hill", (slide, body), parameters, constraints=(hill,), switches=(switch,)))
    options: dict[str, Any] = {"t_end": 1.5, "par": {"down": 1}, "dt": 0.05}
    for rate in (2.0, 0.5, -2.5):
        start = ([-1.0, np.cos(1.0)], [rate, rate * np.sin(1.0)])
        run = sf.simulate(model, *start, events=floor(formula="z - cos(x)"), **options)
        known = sf.simulate(model, *start, **options)
        gap = run.q[:, 1] - np.cos(run.q[:, 0])
        assert gap.min() < 0.0 < gap.max(), "it drifts to both sides"
        assert run.outcome.kind == "finished" and not run.events
        assert run.q[-1] == pytest.approx(known.q[-1], abs=1e-12)


@pytest.mark.parametrize(
    ("method", "pull", "met"),
    [("rk4", "9.81*sin(1.2*t)*1.00001", 12), ("dopri5", "9.81 + 0.01*(t - 1.2) - 1e3*max(t - 1.2, 0)^2", 4)],
)
def test_a_contact_that_barely_opens_and_shuts_again_is_followed(method: str, pull: str, met: int) -> None:
    """It turns near to the floor behind the opening and each strike, where the run has just left it: no doubt."""
    run = sf.simulate(ball(), t_end=2.0, par={"down": 1}, u={"z": pull}, events=floor(), method=method, dt=1e-2)
    assert len(run.events) == met and run.events[0].name == "strike opens"
    (note,) = run.outcome.notes
    assert "persists" in note


def test_times_that_are_asked_for_are_recorded_across_strikes() -> None:
    """Whatever strikes and rests cut a run, as early as they may: once each, at the height that the closed form has."""
    for times in (0.05 * np.arange(21), np.array([0.0, 0.3, 0.31, 1.0])):
        run = sf.simulate(ball(), [0.1], t_end=1.0, events=floor(), dt=1e-2, output=times)
        assert len(run.events) > 10 and run.t == pytest.approx(times, abs=1e-12)
        met, end = instants(0.1, 30)
        at = np.array([np.searchsorted(met, t) for t in times])
        speeds = np.where(at > 0, np.sqrt(2 * G * 0.1) * E**at, 0.0)
        since = times - np.where(at > 0, met[at - 1], 0.0)
        height = np.where(at > 0, speeds * since, 0.1) - 0.5 * G * since**2
        assert run.q[:, 0] == pytest.approx(np.where(times < end, height, 0.0), abs=1e-10)


def test_invalid_contacts_starts_and_forces_are_refused() -> None:
    """What is no contact as it is stated; starts that penetrate or draw, and forces of the wrong sign, as outcomes."""
    wrong: tuple[dict[str, Any], ...] = (
        {"direction": "both"},
        {"once": True},
        {"terminal": True},
        {"action": {"down": 1, "up": 1}},
        {"action": {"down": "1"}},
        {"action": {"down": 0}},
        {"restitution": None},
    )
    for changes in wrong:
        with pytest.raises(sf.SymofrosError, match="no contact that rests"):
            floor(**changes)
    for e in (-0.1, 1.1):
        with pytest.raises(sf.SymofrosError, match="restitution is a number from 0 to 1"):
            floor(e)

    def outcome(z: float, rests: str = "lam.floor", **given: Any) -> sf.Outcome:
        return sf.simulate(ball(), [z], t_end=2.0, events=floor(rests=rests), dt=1e-2, **given).outcome

    assert outcome(-1e-3).kind == "input failed" and "penetrated" in outcome(-1e-3).reason
    assert outcome(-1e-6).kind == "input failed" and outcome(-1e-12).kind == "finished", "rounding is no penetration"
    drawn = outcome(0.0, u={"z": 10.0}, par={"down": 1})
    assert drawn.kind == "input failed" and "force draws" in drawn.reason
    assert "`rests` does not press" in outcome(0.5, "-lam.floor").reason
    assert outcome(0.0, par={"down": 1}).kind == "finished"


def test_steppers_and_batches_rest_as_a_run_does() -> None:
    """To the last bit, with the same parameters behind."""
    options: dict[str, Any] = {"events": floor(), "dt": 1e-2, "method": "rk4"}
    run = sf.simulate(ball(), [0.2], t_end=1.2, **options)
    stepper = sf.Stepper(ball(), **options)
    stepper.reset([0.2])
    while stepper.t < 1.2 - 1e-9 and stepper.step([0.0]):
        pass
    assert stepper.par[0] == 1 and abs(stepper.q[0]) < 1e-15
    many = sf.simulate_batch(ball(), [[0.2], [0.1]], t_end=1.2, **options)
    assert [found.t for found in many.events(0)] == [found.t for found in run.events]
    assert many[0].par_over_time[-1] == pytest.approx([1, 0]) and many[0].outcome.kind == "finished"
    (note,) = (note for note in run.outcome.notes if "persists" in note)
    assert note in many[0].outcome.notes and "within 1e-05 s" in note
    while stepper.t < 1.4 - 1e-9 and stepper.step([20.0]):
        pass
    assert stepper.par[0] == 0 and stepper.q[0] == pytest.approx(0.5 * (20 - G) * 0.2**2, abs=1e-9)


HILLS = (  # height [m], wave number [1/m], where and how fast a ball begins on them [m, m/s]
    (0.4375700081541473, 3.197082511976814, -1.4923945309735092, 3.7029166275458225),
    (0.2723025898978889, 2.566660083852425, 1.6714822087674728, 3.3014663177528822),
    (0.2818198866153153, 1.9110521588337543, 0.7385627443315963, -3.704322415994426),
)


@pytest.mark.parametrize(("method", "dt"), [("rodas4", None), ("rk4", 7.48411930292866e-3), ("dopri5", None)])
def test_a_contact_opens_on_a_hill(method: str, dt: float | None) -> None:
    """Where the path's curvature takes the weight, h'' x'^2 = -g; strikes again where its parabola meets the hill."""
    slide = sf.RigidBody("slide", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    body = sf.RigidBody("ball", sf.Joint("z", "prismatic", "slide", axis=(0, 0, 1)), sf.Inertia(1.0))
    hill, switch = sf.Coupling("floor", "z - A*cos(k*x)"), sf.Switch("floor", "down")
    parameters = [sf.Parameter(name, value) for name, value in (("down", 0), ("A", 1.0), ("k", 1.0))]
    model = sf.compile(sf.System("hill", (slide, body), parameters, constraints=(hill,), switches=(switch,)))
    opened = 0
    for A, k, x, speed in HILLS:
        start = [x, A * np.cos(k * x)], [speed, -A * k * np.sin(k * x) * speed]
        given: dict[str, Any] = {"par": {"A": A, "k": k}, "t_end": 0.6, "method": method} | ({"dt": dt} if dt else {})
        run = sf.simulate(model, *start, events=floor(0.0, formula="z - A*cos(k*x)"), **given)
        gap = run.q[:, 1] - A * np.cos(k * run.q[:, 0])
        assert run.outcome.kind == "finished" and gap.min() > -1e-8, run.outcome
        for i, one in enumerate(run.events):
            if not one.name.endswith("opens"):
                continue
            opened += 1
            rise = -A * k**2 * np.cos(k * one.q[0])
            assert rise * one.v[0] ** 2 == pytest.approx(-G, rel=1e-5)
            for later in run.events[i + 1 : i + 2]:
                flight = later.t - one.t
                landed = one.q + flight * one.v - 0.5 * G * flight**2 * np.array([0, 1])
                assert later.q == pytest.approx(landed, abs=1e-8)
                assert landed[1] == pytest.approx(A * np.cos(k * landed[0]), abs=1e-8)
    assert opened >= len(HILLS) // 2
