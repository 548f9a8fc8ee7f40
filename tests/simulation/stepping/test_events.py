"""Events of simulations: each zero of a formula along the motion is found once, in its direction, or noted."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from typing import Any, Literal

import numpy as np
import pytest

import symofros as sf
from tests.models import bounds

G = 9.81
FIXED = ["euler", "semi_implicit_euler", "rk4", "implicit_euler", "generalized_alpha", "variational"]
ADAPTIVE = ["dopri5", "dop853", "rodas4"]
SUNDIALS = [
    pytest.param(name, marks=pytest.mark.skipif(find_spec("sksundae") is None, reason="scikit-sundae is not installed"))
    for name in ("cvode", "cvode_adams", "ida")
]
METHODS = [*FIXED, *ADAPTIVE, *SUNDIALS]
# Methods whose own error on a thrown body is below the tolerance of these tests: exact, or by rtol.
EXACT_ON_PARABOLAS = ["rk4", *ADAPTIVE, *SUNDIALS]
# Levels of events are run-time parameters: one formula, compiled once.
LEVELS = (sf.Parameter("level", 0.5), sf.Parameter("other", 0.6))
SOLID = sf.Inertia(1.0, moments=(1, 1, 1))


def moving(name: str, kind: Literal["prismatic", "revolute"], axis: tuple[int, int, int]) -> sf.Model:
    body = sf.RigidBody("body", sf.Joint(name, kind, axis=axis), SOLID)
    return sf.compile(sf.System(f"moving_{name}", (body,), parameters=LEVELS))


@pytest.fixture(scope="module")
def thrown() -> sf.Model:
    return moving("z", "prismatic", (0, 0, 1))


@pytest.fixture(scope="module")
def rotor() -> sf.Model:
    return moving("a", "revolute", (0, 0, 1))


@pytest.fixture(scope="module")
def pendulum() -> sf.Model:
    rod = sf.Inertia(1.0, (0, 0, -0.5), (0.08, 0.08, 0.01))
    body = sf.RigidBody("rod", sf.Joint("q", "revolute", axis=(0, -1, 0)), rod)
    return sf.compile(sf.System("pendulum_of_events", (body,), parameters=LEVELS))


def assert_met(run: sf.Trajectory, expected: Iterable[float], tolerance: float) -> None:
    """The events of a run are at these times, or a note says that steps can't tell."""
    times = np.array(sorted(expected))
    found = np.array([event.t for event in run.events])
    if any("cannot tell" in note for note in run.outcome.notes):
        assert len(found) <= len(times)
        return
    assert len(found) == len(times), (found, times)
    np.testing.assert_allclose(found, times, rtol=0, atol=tolerance)


def periodic(level: float, rate: float, end: float) -> list[float]:
    """Times within (0, end) at which sin(rate t) is at a level."""
    first = np.arcsin(level)
    turns = 2 * np.pi * np.arange(int(rate * end / (2 * np.pi)) + 1)
    times = np.concatenate([first + turns, np.pi - first + turns]) / rate
    return [t for t in times.tolist() if 0.0 < t < end]


@pytest.mark.parametrize("method", EXACT_ON_PARABOLAS)
def test_a_thrown_body_passes_any_level_on_its_way_up_and_down(thrown: sf.Model, method: str) -> None:
    rng = np.random.default_rng(1)
    for _ in range(8):
        v, short = rng.uniform(3, 15), 10 ** rng.uniform(-5, -0.1)
        level = (1 - short) * v**2 / (2 * G)
        root = np.sqrt(v**2 - 2 * G * level)
        up, down = (v - root) / G, (v + root) / G
        events = {"any": "z - level", "up": sf.Event("z - level", "rising"), "down": sf.Event("level - z", "rising")}
        options: dict[str, Any] = {"method": method, "dt": 2e-2, "par": {"level": level}}
        options |= bounds(method, 1e-9, 1e-12)
        run = sf.simulate(thrown, [0.0], [v], 2 * v / G, events=events, **options)
        # An error of the state moves the zero by as much over the speed there.
        assert_met(run, [up, up, down, down], 1e-7 / root + 1e-9)
        assert [e.name for e in run.events if e.name != "any"] == ["up", "down"]


@pytest.mark.parametrize("method", METHODS)
def test_a_rotor_meets_each_zero_of_a_periodic_formula(rotor: sf.Model, method: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(6):
        rate, level = rng.uniform(1, 30), rng.uniform(0.3, 0.999)
        options: dict[str, Any] = {"method": method, "dt": 0.08, "par": {"level": level}}
        run = sf.simulate(rotor, [0.0], [rate], 2.0, events={"level": "sin(a) - level"}, **options)
        assert_met(run, periodic(level, rate, 2.0), 1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_two_nearby_zeros_are_both_found(rotor: sf.Model, method: str) -> None:
    """Down to a hundred thousandth of a step: a parabola, and a formula with a kink between them."""
    rng = np.random.default_rng(3)
    for formula in ("(a - level)*(a - other)", "abs(a - (level + other)/2) - (other - level)/2"):
        for _ in range(6):
            first = rng.uniform(0.05, 1.9)
            second = first + 0.05 * 10 ** rng.uniform(-5, 0)
            par = {"level": first, "other": second}
            run = sf.simulate(rotor, [0.0], [1.0], 2.0, method=method, dt=0.05, events={"e": formula}, par=par)
            # The relative accuracy of a formula near its double zero is lost with their distance.
            assert_met(run, [first, second], 1e-9 + 1e-13 / (second - first))


@pytest.mark.parametrize("method", ADAPTIVE)
def test_a_level_just_below_the_turning_point_ends_the_run_on_time(pendulum: sf.Model, method: str) -> None:
    top = float(2 * np.arcsin(1.5 / np.sqrt(G * 0.5 / 0.33)))  # where a start at 3 rad/s turns back
    for share in (0.9, 0.9999):
        options: dict[str, Any] = {
            "events": {"limit": sf.Event("q - level", terminal=True)},
            "par": {"level": share * top},
        }
        fine, run = (
            sf.simulate(pendulum, [0.0], [3.0], 10.0, method=way, rtol=r, atol=1e-2 * r, **options)
            for way, r in (("dop853", 1e-12), (method, 1e-8))
        )
        assert run.outcome.kind == fine.outcome.kind == "event"
        assert run.outcome.t == pytest.approx(fine.outcome.t, abs=1e-6)


@pytest.mark.parametrize("method", FIXED)
@pytest.mark.parametrize("dt", [0.25, 0.1])
def test_zeros_at_the_ends_of_steps_are_counted_once(rotor: sf.Model, method: str, dt: float) -> None:
    """One event exactly at an end of a step, and both zeros of one at the two ends, each met once."""
    events: dict[str, sf.Event | str] = {
        "rising": sf.Event("t - 0.5", "rising"),
        "falling": sf.Event("0.5 - t", "falling"),
        "neither": sf.Event("0.5 - t", "rising"),
        "touching": "-(t - 0.5)^2",
    }
    run = sf.simulate(rotor, [0.0], [1.0], 1.0, method=method, dt=dt, events=events)
    assert sorted(e.name for e in run.events if e.name != "touching") == ["falling", "rising"]
    assert [e.t for e in run.events] == pytest.approx([0.5] * len(run.events), abs=1e-12)
    assert [e.name for e in run.events].count("touching") <= 1
    pairs = {f"pair{k}": f"(a - {k}*{dt})*(a - {k + 1}*{dt})" for k in range(1, 3)}
    run = sf.simulate(rotor, [0.0], [1.0], 1.0, method=method, dt=dt, events=pairs)
    assert_met(run, [dt, 2 * dt, 2 * dt, 3 * dt], 1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_a_zero_at_the_start_is_not_an_event_and_one_at_the_end_is(rotor: sf.Model, method: str) -> None:
    events = {"start": "t", "angle": "a", "end": "t - 1", "beyond": "t - 1.001", "always": "0*a"}
    events["rests"] = "max(t - 0.6, 0)"
    run = sf.simulate(rotor, [0.0], [1.0], 1.0, method=method, dt=0.1, events=events)
    assert [e.name for e in run.events] == ["end"] and run.events[0].t == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_an_event_that_rests_at_zero_arrives_once(rotor: sf.Model, method: str) -> None:
    events = {
        "rests": "max(0.305 - a, 0)",
        "from below": "min(a - 0.305, 0)",
        "passes": "max(0.305 - a, 0) + min(0.605 - a, 0)",
    }
    run = sf.simulate(rotor, [0.0], [1.0], 1.0, method=method, dt=0.04, events=events)
    assert sorted(e.name for e in run.events) == ["from below", "passes", "rests"]
    assert [e.t for e in run.events] == pytest.approx([0.305] * 3, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_events_come_in_order_and_the_first_terminal_one_ends(rotor: sf.Model, method: str) -> None:
    events = {
        "late": sf.Event("a - 0.79", terminal=True),
        "back": sf.Event("(a - 0.72)*(a - 0.76)", "rising", terminal=True),
        "pair": "(a - 0.71)*(a - 0.73)",
        "same": "2*a - 1.52",
    }
    run = sf.simulate(rotor, [0.0], [1.0], 3.0, method=method, dt=0.3, events=events, output=0.5)
    assert run.outcome.kind == "event" and run.outcome.t == pytest.approx(0.76, abs=1e-9)
    assert "'back'" in str(run.outcome)
    assert [e.name for e in run.events][:2] == ["pair", "pair"]
    assert [e.t for e in run.events][:2] == pytest.approx([0.71, 0.73], abs=1e-9)
    assert {e.name for e in run.events[2:]} <= {"back", "same"} and run.events[-1].t == pytest.approx(0.76, abs=1e-9)


@pytest.mark.parametrize("method", ["rk4", "dopri5", *SUNDIALS])
def test_more_events_than_the_buffer_holds_are_kept(rotor: sf.Model, method: str) -> None:
    levels = [0.05 * k for k in range(15)]
    events = {f"e{k}": f"sin(20*a) - {level!r}" for k, level in enumerate(levels)}
    run = sf.simulate(rotor, [0.1], [1.0], 1.0, method=method, dt=0.5, events=events, output=0.25)
    expected = [t - 0.1 for level in levels for t in periodic(level, 20.0, 1.1) if t > 0.1]
    found = [e.t for e in run.events]
    assert found == sorted(found)
    np.testing.assert_allclose(found, sorted(expected), rtol=0, atol=1e-9)
    np.testing.assert_allclose(run.t, [0.0, 0.25, 0.5, 0.75, 1.0], atol=1e-12)
    np.testing.assert_allclose(run["a"], 0.1 + run.t, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_a_step_that_jumps_in_an_input_is_met_at_its_instant(rotor: sf.Model, method: str) -> None:
    body = sf.RigidBody("body", sf.Joint("a", "revolute", effort=("tau",)), SOLID)  # type: ignore[arg-type]
    model = sf.compile(sf.System("pushed_rotor", (body,), inputs=(sf.Input("tau"),)))
    signal = sf.Signal(np.array([0.0, 0.3, 0.6]), np.array([-1.0, 1.0, -1.0]), "hold")
    run = sf.simulate(model, [0.0], [1.0], 1.0, method=method, dt=0.1, u={"tau": signal}, events={"sign": "tau"})
    assert [e.t for e in run.events] == pytest.approx([0.3, 0.6], abs=1e-9)


@pytest.mark.parametrize("method", ["rk4", *ADAPTIVE, *SUNDIALS])
def test_events_that_steps_cannot_resolve_are_noted_and_no_others(thrown: sf.Model, method: str) -> None:
    top = 10.0**2 / (2 * G)
    for level, noted in ((top + 1e-13, True), (top - 1e-13, True), (0.99 * top, False), (1.01 * top, False)):
        run = sf.simulate(
            thrown, [0.0], [10.0], 1.9, method=method, dt=1e-2, events={"top": "z - level"}, par={"level": level}
        )
        assert any("event 'top' turns" in note for note in run.outcome.notes) == noted
        if not noted:
            assert len(run.events) == 2 * (level < top)


@pytest.mark.parametrize("method", METHODS)
def test_looking_for_events_changes_no_step(pendulum: sf.Model, method: str) -> None:
    """Nor does it cost many evaluations: three on twelve for the dense output of dop853, one a step elsewhere."""
    options: dict[str, Any] = {"method": method, "dt": 1e-2, "output": [2.0]}
    plain = sf.simulate(pendulum, [1.0], [0.0], 2.0, **options)
    run = sf.simulate(pendulum, [1.0], [0.0], 2.0, events={"low": "q", "far": "q - 9"}, **options)
    assert run.statistics.steps == plain.statistics.steps and len(run.events) == 2
    assert run.statistics.evaluations <= 1.3 * plain.statistics.evaluations + 3
    np.testing.assert_array_equal(run.q[-1], plain.q[-1])


@pytest.fixture(scope="module")
def fast() -> sf.Model:
    """A body that falls, and the rate and level of a periodic event."""
    body = sf.RigidBody("body", sf.Joint("z", "prismatic", axis=(0, 0, 1)), SOLID)
    return sf.compile(sf.System("fast", (body,), parameters=(sf.Parameter("rate", 1.0), sf.Parameter("level", 0.0))))


def crossings(rate: float, level: float, speed: float, end: float) -> int:
    """How often sin(rate z) passes a level that is not zero, in a throw that begins at z = 0."""
    turns = [0.0, *([speed / G] if 0.0 < speed / G < end else []), end]
    angles = [rate * (speed * t - 0.5 * G * t**2) for t in turns]
    bases = (np.arcsin(level), np.pi - np.arcsin(level))
    laps = [[np.floor((angle - base) / (2 * np.pi)) for angle in angles] for base in bases]
    return int(np.abs(np.diff(laps, axis=1)).sum())


@pytest.mark.parametrize("method", ["rk4", "dop853", "dopri5", "rodas4"])
def test_an_event_that_turns_often_in_a_step_loses_no_zero_in_silence(fast: sf.Model, method: str) -> None:
    """Up to thousands of turns in one step, which look like any other function where they are looked at seldom."""
    rng, silent = np.random.default_rng(5), 0
    for _ in range(15):
        rate, level, end, speed = 10.0 ** rng.uniform(0, 3), *rng.uniform([0.1, 0.3, -9], [0.9, 2.0, 9])
        options = {"method": method, "par": [rate, level], "dt": 10.0 ** rng.uniform(-3, -1)}
        run = sf.simulate(fast, [0.0], [speed], end, events={"often": "sin(rate*z) - level"}, **options)
        noted = any("zeros may be missing" in note or "cannot tell" in note for note in run.outcome.notes)
        assert noted or len(run.events) == crossings(rate, level, speed, end), (rate, level, end, speed)
        silent += not noted
    assert silent >= 10


# Formulas of time that pass zero twice about t = c within about w, one narrow part of which lies between two looks.
NARROW = {
    "tent": "abs(t - {c}) - {w}",
    "bell": "exp(-((t - {c})/{w})^2) - 0.5",
    "window": "sign(t - {c}) - sign(t - {c} - {w}) - 1",
    "resonance": "1/(1 + ((t - {c})/{w})^2) - 0.5",
    "of the state, too": "z - 1 + 9*exp(-((t - {c})/{w})^2)",
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("shape", NARROW)
def test_formulas_of_time_lose_no_zero_and_bear_no_note(rotor: sf.Model, shape: str, method: str) -> None:
    """Anywhere in steps, at their ends, too, and a stepper finds what a run does."""
    rng, formula = np.random.default_rng(3), NARROW[shape].replace("z", "a")
    for place in (rng.uniform(0.2, 0.8), 0.7 + rng.uniform(-1e-3, 1e-3), 0.7):
        c, w = float(place), float(10.0 ** rng.uniform(-6, -2))
        options: dict[str, Any] = {"method": method, "dt": 0.1}
        events = {"twice": formula.format(c=repr(c), w=repr(w))}
        run = sf.simulate(rotor, [0.1], t_end=1.0, events=events, **options)
        assert len(run.events) == 2 and not run.outcome.notes, (c, w, run.events, run.outcome.notes)
        assert all(abs(one.t - c) <= 2.0 * w for one in run.events)
        if method not in ("cvode", "cvode_adams", "ida"):
            stepper = sf.Stepper(rotor, events=events, method=method, dt=0.1)
            stepper.reset([0.1])
            stepper.step(steps=10)
            assert [one.t for one in stepper.events] == pytest.approx([one.t for one in run.events], abs=1e-9)


def test_a_formula_of_the_state_that_jumps_is_not_noted_as_turning_often(rotor: sf.Model) -> None:
    """Beside a point at which the events are looked at: a jump there is no fast change."""
    run = sf.simulate(rotor, [0.0], [1.0], 1.0, method="rk4", dt=0.1, events={"jump": "sign(a - 0.40000000000005)"})
    assert [one.t for one in run.events] == pytest.approx([0.4]) and not run.outcome.notes
