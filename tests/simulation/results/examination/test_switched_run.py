"""What finer steps make of runs over events: what is wrong by a tenth says so, what is right is quiet."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination.finer_steps import Changed
from symofros.simulation.results.examination.switched_run import SwitchedRun
from symofros.simulation.settings import Settings
from tests.simulation.mechanisms import slide

FINE: dict[str, Any] = {"method": "dop853", "rtol": 1e-12, "atol": 1e-13}
Motion = tuple[sf.Model, np.ndarray, np.ndarray, dict[str, Any]]
PARAMETERS = {"k": 20.0, "F": 1.0, "A": 3.0, "w": 5.0, "a": 0.4, "e": 0.8, "side": 1.0, "on": 0.0}


f = sf.formula


@cache
def double_pendulum(kind: str) -> sf.Model:
    """Two links, the first with a spring; what events do depends on the kind."""
    elements: Any = (sf.Spring(f("k")), *([sf.Friction(f("F"), f("1.2*F"), sticks=True)] if kind == "sticks" else []))
    side = sf.Inertia(1.0, (0.3, 0, 0), (0.01, 0.05, 0.05))
    first = sf.Joint("q0", "revolute", axis=(0, 1, 0), elements=elements, actuated=True)
    second = sf.Joint("q1", "revolute", "b0", axis=(0, 1, 0), frame="end")
    bodies = (sf.RigidBody("b0", first, side, (sf.Frame("end", (0.6, 0, 0)),)), sf.RigidBody("b1", second, side))
    locks: dict[str, Any] = {}
    if kind == "locks":
        locks = {"constraints": (sf.Coupling("lock", f("q1")),), "switches": (sf.Switch("lock", f("on"), "moment"),)}
    return sf.compile(
        sf.System(kind, bodies, tuple(sf.Parameter(*item) for item in PARAMETERS.items()), gravity=(0, 0, 0), **locks)
    )


EVENTS = {
    "sticks": {},
    "locks": {
        "on": sf.Event("sin(w*t + 0.1)", "falling", action={"on": 1}),
        "off": sf.Event("sin(w*t + 0.1)", "rising", action={"on": 0}),
    },
    "relay": {
        "up": sf.Event("q0 - 0.05", "rising", action={"side": -1}),
        "down": sf.Event("q0 + 0.05", "falling", action={"side": 1}),
    },
    "walls": {
        "high": sf.Event("q0 - a", "rising", action={"dq0": "-e*dq0"}),
        "low": sf.Event("q0 + a", "falling", action={"dq0": "-e*dq0"}),
    },
}
DRIVES = {"sticks": "A*sin(w*t)", "locks": "A*sin(w*t)", "relay": "A*side", "walls": "A*sin(w*t)"}


def drawn(kind: str, rng: np.random.Generator) -> Motion:
    """A motion over events."""
    if kind == "contact":
        v = rng.uniform(-2, 2, 2)
        return mass_over_floor(), np.array([0.0, rng.uniform(0.05, 0.4)]), v, {"t_end": rng.uniform(0.4, 1.0)}
    ranges = {"k": (0, 30), "F": (0.5, 3), "A": (2, 8), "w": (3, 12), "a": (0.3, 0.6), "e": (0.4, 1)}
    par = {**PARAMETERS, **{name: float(rng.uniform(*span)) for name, span in ranges.items()}}
    given = {"par": par, "events": EVENTS[kind], "u": {"q0": DRIVES[kind]}, "t_end": rng.uniform(1.0, 2.0)}
    q = np.array([0.9 * rng.uniform(-par["a"], par["a"]), rng.uniform(-1, 1)])
    return double_pendulum(kind), q, rng.uniform(-3, 3, 2), given


@cache
def mass_over_floor() -> sf.Model:
    """A mass that bounces on rough ground."""
    x = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    z = sf.RigidBody("z", sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="x"), sf.Inertia(2.0))
    foot = sf.Contact("foot", ("z", None), ("world", None), restitution=0.4, friction=0.4)
    return sf.compile(sf.System("mass", (x, z), connections=(foot,)))


def settings_of(kind: str, rng: np.random.Generator, t_end: float) -> dict[str, Any]:
    """A method, with steps or tolerances from coarse to fine."""
    if rng.random() < 0.3:
        loose = {"rtol": 10 ** rng.uniform(-6, -1.5), "atol": 10 ** rng.uniform(-6, -3)}
        return {"method": str(rng.choice(["dopri5", "dop853"])), **loose}
    names = ["euler", "semi_implicit_euler", "rk4", "dopri5"]
    names += ["generalized_alpha", "implicit_euler", "rodas4"] if kind != "contact" else []
    names += ["variational"] if kind in ("relay", "walls") else []
    method = str(rng.choice(names))
    fixed = {"adaptive": False} if method in ("dopri5", "rodas4") else {}
    return {"method": method, "dt": float(t_end / 10 ** rng.uniform(1.2, 3.0)), **fixed}


def norm(model: sf.Model, q: np.ndarray, par: Any, x: np.ndarray) -> float:
    """Root of x^T M x."""
    return float(np.sqrt(x @ model.mass_matrix(q, par=par) @ x))


def off(run: sf.Trajectory, right: sf.Trajectory, par: Any) -> float:
    """Error of the last state, of displacements and of speeds, relative to the largest of each."""
    model, end = run.model, right.q[-1]
    some = slice(None, None, max(1, len(right.q) // 100))
    far = max(norm(model, q, par, model.difference(right.q[0], q)) for q in right.q[some])
    fast = max(norm(model, q, par, v) for q, v in zip(right.q[some], right.v[some], strict=True))
    apart, faster = model.difference(end, run.q[-1]), run.v[-1] - right.v[-1]
    return max(norm(model, end, par, apart) / far, norm(model, end, par, faster) / fast)


@pytest.mark.parametrize("kind", [*EVENTS, "contact"])
def test_runs_off_by_a_tenth_bear_a_note_and_right_ones_do_not(kind: str) -> None:
    """Random motions, methods and steps; against tolerances of 1e-12."""
    rng = np.random.default_rng(len(kind))
    judged = 0
    for _ in range(8):
        model, q, v, given = drawn(kind, rng)
        options = settings_of(kind, rng, given["t_end"])
        right, run = (sf.simulate(model, q, v, **given, **one) for one in (FINE, options))
        par = given.get("par", model.parameters)
        if not (right.outcome.ok and run.outcome.ok):
            continue
        error = off(run, right, model.checked_parameters(par))
        if error > 0.11:
            assert run.outcome.notes, (error, options, q, v, given)
        if error < 1e-9:
            assert not [note for note in run.outcome.notes if "persists" not in note], (error, options, run.outcome)
        judged += 1
    assert judged >= 4


@cache
def box_over_floor() -> sf.Model:
    """A box in a plane that falls on four compliant corners."""
    x = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    z = sf.RigidBody("z", sf.Joint("z", "prismatic", "x", axis=(0, 0, 1)))
    box = sf.RigidBody(
        "box", sf.Joint("a", "revolute", "z", axis=(0, 1, 0)), sf.Inertia(3.0, (0, 0, 0), (0.02, 0.03, 0.02))
    )
    corners = tuple((0.15 * i, 0.0, 0.05 * j) for i in (-1, 1) for j in (-1, 1))
    stated: dict[str, Any] = {"stiffness": 3e4, "dissipation": 0.3, "friction": 0.5, "points": corners}
    ground = sf.Contact("ground", ("box", None), ("world", None), **stated)
    return sf.compile(sf.System("fall", (x, z, box), connections=(ground,)))


def test_amplification_of_errors_by_contacts_is_noted() -> None:
    """Windows of a long run do not see what contacts amplify: 40 % at the end, without a word; right runs are quiet."""
    model, start = box_over_floor(), ([0.0, 0.3, 0.6], [0.5, 0.0, 1.0], 1.2)
    right, run, finer = (sf.simulate(model, *start, **one) for one in (FINE, {"dt": 4e-3}, {"dt": 2e-4}))
    assert off(run, right, None) > 0.3 and off(finer, right, None) < 0.02
    (note,) = run.outcome.notes
    assert "do not determine the motion over its contacts" in note and "errs by about 41 %, with the order 1.9" in note
    assert not finer.outcome.notes
    rows = [[x, x] for x in start[:2]]
    for dt, wanted in ((4e-3, (note,)), (2e-4, ())):
        batch = sf.simulate_batch(model, *rows, 1.2, dt=dt)
        assert batch.outcome(0).notes == batch.outcome(1).notes == wanted


def relay() -> Motion:
    """A link that a relay drives to and fro."""
    given = {"par": {**PARAMETERS, "A": 6.0}, "events": EVENTS["relay"], "u": {"q0": "A*side"}, "t_end": 2.0}
    return double_pendulum("relay"), np.array([0.0, 0.5]), np.array([1.0, -1.0]), given


@pytest.mark.parametrize("method", ["semi_implicit_euler", "generalized_alpha"])
def test_errors_that_parts_of_a_run_add_up_are_stated(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a note of the whole run where no part has one, with the error to a third of what it is."""
    model, q, v, given = relay()
    right = sf.simulate(model, q, v, **given, **FINE)
    said = list[float]()
    monkeypatch.setattr(SwitchedRun, "error", _noting(SwitchedRun.error, said))
    quiet, errors = 0, list[tuple[float, float]]()
    for n in (120, 270, 600, 6000) if method == "semi_implicit_euler" else (40, 60, 80, 400):
        said.clear()
        run = sf.simulate(model, q, v, **given, method=method, dt=given["t_end"] / n)
        error = off(run, right, model.checked_parameters(given["par"]))
        assert run.outcome.notes or error < 0.11, (n, error)
        if said and error < 0.5:
            errors.append((said[0], error))
        quiet += not run.outcome.notes
    assert quiet and errors, (quiet, errors)
    assert all(0.6 * error < stated < 1.6 * error + 0.01 for stated, error in errors), errors


def _noting(function: Any, said: list[float]) -> Any:
    def noted(*given: Any) -> float:
        said.append(function(*given))
        return said[-1]

    return noted


@pytest.mark.parametrize("method", ["generalized_alpha", "dopri5"])
def test_notes_do_not_depend_on_when_a_run_begins(method: str) -> None:
    """By fixed steps and by tolerances; the relay knows no time."""
    model, q, v, given = relay()
    span = given["t_end"]
    coarse: dict[str, Any] = {"rtol": 1e-2, "atol": 1e-2} if method == "dopri5" else {"dt": 0.05}
    notes = []
    for t0 in (0.0, -span / 2, 64.0):
        stated = {**given, **coarse, "t0": t0, "t_end": t0 + span}
        notes.append(sf.simulate(model, q, v, method=method, **stated).outcome.notes)
    assert notes[0] and notes[0] == notes[1] == notes[2]


@pytest.mark.parametrize(
    ("method", "order"),
    [("euler", 1), ("semi_implicit_euler", 1), ("generalized_alpha", 2), ("variational", 2), ("rk4", 4), ("dopri5", 5)],
)
def test_events_do_not_lower_the_order_of_a_method(method: str, order: int) -> None:
    model, q, v, given = relay()
    given["t_end"] = 1.0
    right = sf.simulate(model, q, v, **given, **FINE)
    par = model.checked_parameters(given["par"])
    options: dict[str, Any] = {"adaptive": False} if method == "dopri5" else {}
    steps = (400, 800) if order < 5 else (50, 100)
    errors = [off(sf.simulate(model, q, v, **given, **options, method=method, dt=1.0 / n), right, par) for n in steps]
    assert len(right.events) > 3 and np.log2(errors[0] / errors[1]) > order - 0.4, errors


def mass_between_walls() -> tuple[sf.Model, dict[str, Any]]:
    """A mass that is thrown to and fro, on a soft spring."""
    model = sf.compile(slide(sf.Spring(1.0)))
    back = {"dx": "-dx"}
    hits = {"right": sf.Event("x - 0.3", "rising", action=back), "left": sf.Event("x + 0.3", "falling", action=back)}
    return model, {"q0": [0.0], "v0": [1.0], "t_end": 2.0, "events": hits}


@pytest.mark.parametrize(
    ("options", "made"),
    [
        ({"method": "rk4", "dt": 0.02}, [1]),  # Parts of 25 steps.
        ({"method": "rk4", "dt": 0.004}, [1]),  # Of 125.
        ({"method": "rk4", "dt": 5e-4}, [-2]),  # Of 1000: steps four times as long say enough.
        ({"method": "semi_implicit_euler", "dt": 5e-4}, [-2]),
        ({"method": "dopri5"}, [-2]),
        ({"method": "dopri5", "rtol": 1e-3}, [1]),
    ],
)
def test_the_examination_of_a_right_run_is_bounded(
    options: dict[str, Any], made: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is made once more one time: short ones by half the step, longer ones by four times the step."""
    model, given = mass_between_walls()
    asked, fine = list[int](), SwitchedRun.fine

    def noted(run: SwitchedRun, window: Any, refinements: int, every: int) -> Any:
        asked.append(refinements)
        return fine(run, window, refinements, every)

    monkeypatch.setattr(SwitchedRun, "fine", noted)
    run = sf.simulate(model, **given, **options)
    assert asked == made and not run.outcome.notes and len(run.events) == 3


def test_the_coarser_and_the_finer_run_have_four_times_and_half_the_step(monkeypatch: pytest.MonkeyPatch) -> None:
    model, given = mass_between_walls()
    found = list[Any]()
    apply = Settings.apply

    def noted(settings: Settings, stepper: Any) -> None:
        found.append(settings)
        apply(settings, stepper)

    monkeypatch.setattr(Settings, "apply", noted)
    every: Any = ({"dt": 5e-4}, {"dt": 0.02}, {"method": "dopri5"}, {"method": "dopri5", "rtol": 1e-3, "atol": 1e-5})
    for options in every:
        sf.simulate(model, **given, **options)
        last = found[-1]
        wanted = {5e-4: 2e-3, 0.02: 0.01}.get(float(options.get("dt", 0.0)), 0.0)
        assert last.dt == pytest.approx(wanted) and last.t_end == given["t_end"] and len(last.grid) > 5
        tolerances = (1e-4, 1e-7) if last.adaptive and "rtol" not in options else (1e-5, 1e-7)
        assert not last.adaptive or (last.rtol, last.atol) == pytest.approx(tolerances)


@pytest.mark.parametrize("options", [{}, {"output": 0.1}, {"output": [2.0]}, {"every": 7}, {"output": [0.1, 1.7]}])
@pytest.mark.parametrize("n", [10, 400])
def test_the_note_does_not_depend_on_what_is_recorded(options: dict[str, Any], n: int) -> None:
    model, q, v, given = relay()
    run = sf.simulate(model, q, v, **given, method="semi_implicit_euler", dt=2.0 / n, **options)
    assert run.outcome.ok and bool(run.outcome.notes)
    over = f"over {len(run.events)} actions of events: "
    assert any(over in note and "errs by" in note for note in run.outcome.notes) or n == 10


def test_runs_that_an_event_ends_are_compared_at_their_end() -> None:
    """By the state before what it does, of steps that would have come there a little earlier or later."""
    actions: Any = ({}, {"action": {"dx": 0.0}})
    for action in actions:
        model, given = mass_between_walls()
        given["events"] |= {"end": sf.Event("t - 1.51", "rising", terminal=True, **action)}
        run = sf.simulate(model, **given, method="rk4", dt=0.02)
        assert run.outcome.kind == "event" and not run.outcome.notes and len(run.events) >= 3, run.outcome


def test_events_that_finer_steps_meet_are_noted() -> None:
    """A link whose coarse steps turn back before the relay's level."""
    model, q, v, given = relay()
    given["events"] = {"up": sf.Event("q0 - level", "rising", action={"side": -30})}
    right = sf.simulate(model, q, v, **(given | {"events": {}}), **FINE)
    given["events"] = {"up": sf.Event(f"q0 - {right.q[:, 0].max() - 1e-3}", "rising", action={"side": -30})}
    run = sf.simulate(model, q, v, **given, method="implicit_euler", dt=0.02)
    assert not run.events and run.outcome.notes


def test_an_event_by_which_finer_steps_end_is_noted() -> None:
    model, q, v, given = relay()
    given["t_end"], far = 0.2, {"far": sf.Event("q0 - 9", "rising", action={"side": -1})}
    top, right = (
        sf.simulate(model, q, v, **(given | {"events": {}}), **one).q[:, 0].max()
        for one in ({"method": "implicit_euler", "dt": 2e-3}, FINE)
    )
    end = sf.Event(f"q0 - {0.7 * top + 0.3 * right}", "rising", terminal=True)
    run = sf.simulate(model, q, v, **(given | {"events": far | {"end": end}}), method="implicit_euler", dt=2e-3)
    assert top < right and run.outcome.kind == "finished" and not run.events
    assert "with half of that it does not come to this end over what its events do" in run.outcome.notes[0]


def test_a_run_in_real_time_is_not_made_once_more(monkeypatch: pytest.MonkeyPatch) -> None:
    model, given = mass_between_walls()
    monkeypatch.setattr(SwitchedRun, "fine", None)
    run = sf.simulate(model, **(given | {"t_end": 0.4}), method="rk4", dt=0.02, realtime=10.0)
    assert len(run.events) == 1 and run.outcome.ok


def test_speeds_count_at_the_end_and_in_the_mean_displacements_at_any_instant(monkeypatch: pytest.MonkeyPatch) -> None:
    """Relative to the largest of each; what jumps is not compared where it does."""
    model, given = mass_between_walls()
    asked, fine = list[SwitchedRun](), SwitchedRun.fine

    def noted(run: SwitchedRun, *of: Any) -> Any:
        asked.append(run)
        return fine(run, *of)

    monkeypatch.setattr(SwitchedRun, "fine", noted)
    made = sf.simulate(model, **given, method="rk4", dt=0.02)
    run = asked[0]
    t, q, v, u = run.coarse(run.window, 1)
    assert not set(t) & {found.t for found in made.events} and t[0] == 0.0 and t[-1] == 2.0 and len(t) > 90

    def change(q_finer: Any, v_finer: Any) -> float:
        return run.change([t, q, v, u], [t, q_finer, v_finer, u], "run")[0]

    last, fastest, far = np.arange(len(t))[:, np.newaxis] == len(t) - 1, np.abs(v).max(), np.abs(q).max()
    assert change(q, v) == 0.0
    assert change(q, v * (1 - 0.3 * last)) == pytest.approx(0.3 * abs(v[-1, 0]) / fastest)
    assert change(q, v * (1 - 0.2 * ~last)) == pytest.approx(
        0.2 * np.abs(v[:-1]).sum() / len(t) / np.abs(v[-1, 0]), rel=0.3
    )
    assert change(q + 0.05 * (t == t[7])[:, np.newaxis], v) == pytest.approx(0.05 / max(far, q[7, 0] + 0.05))
    assert [run.error(0.1, k) for k in (1, 2)] == pytest.approx([0.1 * 16 / 15, 0.1 * 256 / 255])
    assert run.halvings("run") == 4 and replace(run, steps=100_000).halvings("run") == 1


@pytest.mark.parametrize(
    ("method", "share", "order", "words"),
    [
        ("semi_implicit_euler", 0.012, 1.0, ""),
        (
            "semi_implicit_euler",
            0.06,
            1.0,
            "half of that changes it by 6 %, so that it errs by about 12 %; a smaller dt",
        ),
        ("rk4", 0.02, 3.8, ""),
        ("rk4", 0.012, 1.2, ""),
        ("rk4", 0.06, 1.2, "errs by about 11 %, with the order 1.2 in place of 4; a smaller dt"),
        ("rk4", 0.06, 0.2, "errs by about 12 %, with the order 0.2 in place of 4; a smaller dt"),
        ("rk4", 0.12, 1.2, "errs by about 21 %, with the order 1.2 in place of 4; a smaller dt"),
        ("rk4", 0.12, 3.8, "errs by about 13 %; a smaller dt"),
        ("rk4", 0.6, 1.2, "errs by about 64 %; a smaller dt"),
    ],
)
def test_the_error_is_that_of_the_order_and_a_lost_order_is_stated(
    method: str, share: float, order: float, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a change by half the step that is known."""
    model, given = mass_between_walls()
    monkeypatch.setattr(SwitchedRun, "changed", lambda *_: Changed(share, 0.0, 100))
    monkeypatch.setattr(SwitchedRun, "order", lambda _: order)
    notes = sf.simulate(model, **given, method=method, dt=0.01).outcome.notes
    assert len(notes) == bool(words) and all(note.endswith(words) for note in notes), notes


def test_the_order_is_that_of_two_halvings() -> None:
    model, given = mass_between_walls()
    seen = list[float]()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SwitchedRun, "error", _noting(lambda run, *_: run.order(), seen))
        sf.simulate(model, **given, method="generalized_alpha", dt=0.01)
    assert seen == [pytest.approx(2.0, abs=0.2)]
