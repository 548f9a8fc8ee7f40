"""Events of simulations: each zero of a formula along the motion is found once, in its direction, or noted."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.util import find_spec
from typing import Any, Literal

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Integrator, Relay, Sine

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
        run = sf.simulate(
            thrown,
            [0.0],
            [v],
            2 * v / G,
            method=method,
            dt=2e-2,
            events=events,
            par={"level": level},
            rtol=1e-9,
            atol=1e-12,
        )
        # An error of the state moves the zero by as much over the speed there.
        assert_met(run, [up, up, down, down], 1e-7 / root + 1e-9)
        assert [e.name for e in run.events if e.name != "any"] == ["up", "down"]


@pytest.mark.parametrize("method", METHODS)
def test_a_rotor_meets_each_zero_of_a_periodic_formula(rotor: sf.Model, method: str) -> None:
    rng = np.random.default_rng(2)
    for _ in range(6):
        rate, level = rng.uniform(1, 30), rng.uniform(0.3, 0.999)
        run = sf.simulate(
            rotor, [0.0], [rate], 2.0, method=method, dt=0.08, events={"level": "sin(a) - level"}, par={"level": level}
        )
        assert_met(run, periodic(level, rate, 2.0), 1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_two_zeros_near_each_other(rotor: sf.Model, method: str) -> None:
    """Down to a hundred thousandth of a step: a parabola, and a formula with a kink between them."""
    rng = np.random.default_rng(3)
    for formula in ("(a - level)*(a - other)", "abs(a - (level + other)/2) - (other - level)/2"):
        for _ in range(6):
            first = rng.uniform(0.05, 1.9)
            second = first + 0.05 * 10 ** rng.uniform(-5, 0)
            run = sf.simulate(
                rotor,
                [0.0],
                [1.0],
                2.0,
                method=method,
                dt=0.05,
                events={"e": formula},
                par={"level": first, "other": second},
            )
            # The relative accuracy of a formula near its double zero is lost with their distance.
            assert_met(run, [first, second], 1e-9 + 1e-13 / (second - first))


@pytest.mark.parametrize("method", ADAPTIVE)
def test_a_pendulum_that_turns_back_beyond_a_level(pendulum: sf.Model, method: str) -> None:
    top = float(2 * np.arcsin(1.5 / np.sqrt(G * 0.5 / 0.33)))  # where a start at 3 rad/s turns back
    for share in (0.5, 0.9, 0.99, 0.9999):
        stop = {"limit": sf.Event("q - level", terminal=True)}
        options: dict[str, Any] = {"events": stop, "par": {"level": share * top}}
        fine = sf.simulate(
            pendulum, [0.0], [3.0], 10.0, method="dop853", rtol=1e-12, atol=1e-12, max_step=1e-3, **options
        )
        run = sf.simulate(pendulum, [0.0], [3.0], 10.0, method=method, rtol=1e-8, atol=1e-10, **options)
        assert run.outcome.kind == fine.outcome.kind == "event"
        assert run.outcome.t == pytest.approx(fine.outcome.t, abs=1e-6)


@pytest.mark.parametrize("method", FIXED)
@pytest.mark.parametrize("dt", [0.25, 0.1])
def test_zeros_at_the_ends_of_steps(rotor: sf.Model, method: str, dt: float) -> None:
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
def test_the_start_is_no_arrival_and_the_end_is_one(rotor: sf.Model, method: str) -> None:
    events = {
        "start": "t",
        "angle": "a",
        "end": "t - 1",
        "beyond": "t - 1.001",
        "always": "0*a",
        "rests": "max(t - 0.6, 0)",
    }
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
def test_more_events_in_a_step_than_are_kept_at_once(rotor: sf.Model, method: str) -> None:
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
def test_what_steps_cannot_tell_is_noted_and_nothing_else(thrown: sf.Model, method: str) -> None:
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
    options: dict[str, Any] = {"method": method, "dt": 1e-2, "rtol": 1e-6, "output": [2.0]}
    plain = sf.simulate(pendulum, [1.0], [0.0], 2.0, **options)
    run = sf.simulate(pendulum, [1.0], [0.0], 2.0, events={"low": "q", "far": "q - 9"}, **options)
    assert run.statistics.steps == plain.statistics.steps and len(run.events) == 2
    assert run.statistics.evaluations <= 1.3 * plain.statistics.evaluations + 3
    np.testing.assert_array_equal(run.q[-1], plain.q[-1])


def test_crossings_of_a_diagram_at_the_same_time_are_all_handled() -> None:
    diagram = sf.Diagram("relays")
    diagram.add(Sine(name="u", frequency=1.0))
    for k in range(6):
        diagram.add(Relay(name=f"relay{k}", lower=-0.5, upper=0.5), u="u.y")
        diagram.add(Integrator(name=f"x{k}"), u=f"relay{k}.y")
    ways: list[dict[str, Any]] = [{"dt": 1e-3}, {"dt": 1 / 12}, {"method": "dopri5"}]
    for options in ways:
        run = sf.Simulation(diagram).run(1.0, **options)
        assert [c.t for c in run.crossings] == pytest.approx([1 / 12] * 6 + [7 / 12] * 6, abs=1e-9)
        assert [run[f"x{k}.y"][-1] for k in range(6)] == pytest.approx([0.5] * 6, abs=1e-9)


@pytest.mark.parametrize("options", [{"dt": 0.4}, {"method": "dopri5"}])
def test_a_relay_of_a_diagram_switches_within_a_long_step(options: dict[str, Any]) -> None:
    """On above 0.999, off below 0.995: both within one of the steps."""
    diagram = sf.Diagram("within")
    diagram.add(Sine(name="u", frequency=0.5))
    diagram.add(Relay(name="relay", lower=0.995, upper=0.999), u="u.y")
    diagram.add(Integrator(name="x"), u="relay.y")
    run = sf.Simulation(diagram).run(1.6, **options)
    on, off = np.arcsin(0.999) / np.pi, 1 - np.arcsin(0.995) / np.pi
    assert [c.t for c in run.crossings] == pytest.approx([on, off], abs=1e-9)
    assert run["x.y"][-1] == pytest.approx(off - on, abs=1e-9)


@pytest.mark.parametrize("method", ["dopri5", "rodas4"])
def test_an_event_too_fast_to_be_followed_is_noted(thrown: sf.Model, method: str) -> None:
    """Some hundred turns in a step; a slower one of the same form is followed."""
    for formula, noted in (("2 + sin(1000*z)", True), ("2 + sin(z)", False)):
        run = sf.simulate(thrown, [0.0], [10.0], 0.5, method=method, dt=0.01, events={"fast": formula})
        assert any("changes too often in the step" in note for note in run.outcome.notes) == noted, (
            formula,
            run.outcome,
        )


def test_a_step_with_very_many_events_is_kept_once(thrown: sf.Model) -> None:
    """It is cut where their records are full; a state for the diagnosis at each cut doubled their spacing for ever."""
    run = sf.simulate(thrown, [0.0], [10.0], 0.5, method="dopri5", events={"many": "sin(2e5*z)"})
    assert len(run.events) > 100_000


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


@pytest.mark.parametrize("method", ["rk4", "dop853", "dopri5", "rodas4", SUNDIALS[0]])
def test_an_event_that_turns_often_in_a_step_loses_no_zero_in_silence(fast: sf.Model, method: str) -> None:
    """Up to thousands of turns in one step, which look like any other function where they are looked at seldom."""
    rng, silent = np.random.default_rng(5), 0
    for _ in range(25):
        rate, level, end, speed = (
            10.0 ** rng.uniform(0, 3),
            rng.uniform(0.1, 0.9),
            rng.uniform(0.3, 2.0),
            rng.uniform(-9, 9),
        )
        options = {"method": method, "par": [rate, level], "dt": 10.0 ** rng.uniform(-3, -1)}
        run = sf.simulate(fast, [0.0], [speed], end, events={"often": "sin(rate*z) - level"}, **options)
        noted = any("zeros may be missing" in note or "cannot tell" in note for note in run.outcome.notes)
        assert noted or len(run.events) == crossings(rate, level, speed, end), (rate, level, end, speed)
        silent += not noted
    assert silent >= 20


@pytest.mark.parametrize(("dt", "looks"), [(1e-3, 1.0), (0.1, 5.0)])
def test_events_that_are_far_are_seldom_looked_at(dt: float, looks: float) -> None:
    """Of short steps at their ends, of long ones at five points; at the rate of events in few places more."""
    calls: list[float] = []

    def push(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        calls.append(t)
        return [0.0]

    body = sf.RigidBody("body", sf.Joint("z", "prismatic", axis=(0, 0, 1)), SOLID, loads=(sf.Load((0, 0, "F")),))
    model = sf.compile(sf.System("pushed", (body,), inputs=(sf.Input("F"),)))
    counts = []
    for events in ({}, {"far": "z - 50 + F"}):
        calls.clear()
        steps = sf.simulate(model, t_end=0.5, method="rk4", dt=dt, u=push, events=events).statistics.steps
        counts.append(len(calls))
    assert looks * steps <= counts[1] - counts[0] <= 1.3 * looks * steps + 10
