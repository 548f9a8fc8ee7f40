"""The state machine: transitions, time in states, actions; against a machine of dictionaries."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import MachineState, StateMachine, Transition
from tests.blocks.support import STEP, run

STATES = {
    "idle": MachineState(during={"y": "0"}, exit={"count": "count + 1", "z": "10*elapsed"}),
    "push": MachineState(during={"y": "k*u"}, entry={"y": "-1", "count": "count + 0.5"}),
    "wait": MachineState(during={"z": "elapsed"}),
}
WAYS = (
    Transition("idle", "push", "u - 1"),
    Transition("push", "wait", "u - 3"),
    Transition("push", "idle", "0.5 - u"),
    Transition("wait", "wait", "x[1] - 1"),
    Transition("wait", "idle", "elapsed - 0.03"),
)


def machine(**changes: Any) -> StateMachine:
    """The machine of the tests."""
    stated = {"machine_states": STATES, "transitions": WAYS, "outputs": {"y": 7.0, "z": 8.0, "count": 0.0}}
    return StateMachine(**{"name": "m", "period": STEP, "constants": {"k": 2.0}, **stated, **changes})


def by_hand(u: np.ndarray, x: np.ndarray) -> dict[str, list[float]]:
    """What the machine does, by rules written once more."""
    names, state, entered = list(STATES), "", 0
    values = {"y": 7.0, "z": 8.0, "count": 0.0}
    found: dict[str, list[float]] = {name: [] for name in ("state", *values)}
    for k in range(len(u)):
        known = {"u": u[k], "x": x[k], "k": 2.0, **values}

        def value(formula: str | float, since: int, k: int = k, known: dict[str, Any] = known) -> float:
            return float(eval(str(formula), {}, {**known, "elapsed": (k - since) * STEP}))  # noqa: S307

        ways = [w for w in WAYS if w.leave == state and value(w.when, entered) >= -1e-9]
        went = state == "" or bool(ways)
        if ways:
            values |= {name: value(formula, entered) for name, formula in STATES[state].exit.items()}
            known.update(values)
        if went:
            state, entered = ways[0].enter if ways else "idle", k
        values |= {name: value(formula, entered) for name, formula in STATES[state].during.items()}
        if went:
            values |= {name: value(formula, entered) for name, formula in STATES[state].entry.items()}
        for name, item in values.items():
            found[name].append(item)
        found["state"].append(names.index(state))
    return found


def test_a_machine_is_that_of_its_rules() -> None:
    """Random inputs visit all states, by all transitions; the run in C and the interpreted one agree, too."""
    rng = np.random.default_rng(4)
    u, x = rng.uniform(-1.0, 4.0, 200), rng.uniform(0.0, 1.2, (200, 2))
    wanted = by_hand(u, x)
    assert set(wanted["state"]) == {0, 1, 2}
    found = run(machine(), {"u": u, "x": x})
    for name, values in wanted.items():
        np.testing.assert_allclose(found[name], values, atol=1e-12, err_msg=name)


def test_time_in_a_state_is_counted_without_drift() -> None:
    """19 samples of 0.009 s are 0.171 s, though their product rounds below."""
    assert 19 * 0.009 < 0.171
    states = {"a": MachineState(), "b": MachineState()}
    ways = (Transition("a", "b", "elapsed - 0.171"), Transition("b", "a", "elapsed - 0.171"))
    block = StateMachine(name="m", period=0.009, machine_states=states, transitions=ways)
    found = run(block, t_end=0.531, dt=0.009)["state"]
    assert np.flatnonzero(np.diff(found)).tolist() == [18, 37, 56]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"machine_states": {}}, "1 to 64"),
        ({"machine_states": ["idle"]}, "a mapping"),
        ({"machine_states": {"idle": {"during": {"y": 0.0}}}}, "state 'idle' is none"),
        ({"transitions": (("idle", "push", "u"),)}, "a transition is none"),
        ({"transitions": WAYS[:1]}, "state 'wait' is never entered"),
        ({"transitions": (*WAYS, Transition("idle", "pushh", "u"))}, "did you mean 'push'"),
        ({"first": "none"}, "no state 'none'"),
        ({"outputs": {"y": 0.0, "z": 0.0}}, "no output 'count'"),
        ({"outputs": {"y": 0.0, "z": 0.0, "count": 0.0, "t": 0.0}}, "name 't' is taken"),
        ({"outputs": {"y": math.nan, "z": 0.0, "count": 0.0}}, "not finite"),
        ({"transitions": (*WAYS, Transition("idle", "push", "u -"))}, "formula of 'idle to push'"),
        ({"units": {"w": "m"}}, "no input or output 'w'"),
    ],
)
def test_bad_machines_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(sf.DescriptionError, match=words):
        machine(**changes)


def test_a_condition_on_what_is_not_there_is_refused() -> None:
    diagram = sf.Diagram("d")
    diagram.add(machine(transitions=(*WAYS, Transition("idle", "push", "lever"))))
    with pytest.raises(sf.DescriptionError, match=r"input 'm\.lever' is not connected"):
        sf.Simulation(diagram)


def test_a_machine_in_a_file_is_the_one_in_python(tmp_path: Path) -> None:
    diagram = sf.Diagram("d")
    diagram.add(sf.blocks.Sine(name="u", frequency=1.0, amplitude=4.0))
    diagram.add(sf.blocks.Constant(name="x", value=[0.0, 1.0]))
    diagram.add(machine(), u="u.y", x="x.y")
    sf.save_diagram(diagram, tmp_path / "d.yaml")
    found = sf.load_diagram(tmp_path / "d.yaml")
    again, first = (sf.Simulation(d).run(1.0, dt=STEP)["m.y"] for d in (found, diagram))
    assert found.blocks["m"] == diagram.blocks["m"]
    assert again.tolist() == first.tolist()


def continuous(*ways: Transition, states: Any = None, **changes: Any) -> sf.DiagramRun:
    """A run of a continuous machine that a sine of one hertz feeds."""
    diagram = sf.Diagram("continuous")
    diagram.add(sf.blocks.Sine(name="u", frequency=1.0))
    diagram.add(sf.blocks.Relay(name="relay", lower=-0.5, upper=0.5), u="u.y")
    stated = states or {name: MachineState() for name in ("a", "b", "c")}
    diagram.add(
        StateMachine(name="m", machine_states=stated, transitions=ways, **changes),
        **({"u": "u.y"} if any("u" in way.when.split("-") for way in ways) else {}),
        **({"on": "relay.y"} if any("on" in way.when for way in ways) else {}),
    )
    options: Any = {"method": "dopri5"} if changes.get("constants") else {"dt": 0.02}
    return sf.Simulation(diagram).run(2.0, record=0.125, **options)


@pytest.mark.parametrize("constants", [{}, {"unused": 1.0}], ids=["rk4", "dopri5"])
def test_a_continuous_machine_changes_where_its_conditions_become_true(constants: dict[str, float]) -> None:
    """Instants and outputs are those of closed form; `elapsed` counts from the instant itself."""
    states = {
        "low": MachineState(
            during={"y": "0-u"}, entry={"k": "k + 10*elapsed + 10"}, exit={"n": "n + 1", "z": "elapsed"}
        ),
        "high": MachineState(during={"y": "2*u"}),
        "wait": MachineState(entry={"k": "k + y"}),
    }
    ways = (
        Transition("low", "high", "u-0.5"),
        Transition("high", "wait", "elapsed - 0.05"),
        Transition("wait", "low", "0-u"),
    )
    outputs = {"y": 0.0, "n": 0.0, "z": -1.0, "k": 5.0}
    run = continuous(*ways, states=states, outputs=outputs, constants=constants)
    up, names = np.arcsin(0.5) / (2 * np.pi), ("low_to_high", "high_to_wait", "wait_to_low")
    wanted = [(name, t + k) for k in (0, 1) for name, t in zip(names, (up, up + 0.05, 0.5), strict=True)]
    found = [(met.crossing, met.t) for met in run.crossings if met.block == "m"]
    assert [name for name, _ in found] == [name for name, _ in wanted]
    np.testing.assert_allclose([t for _, t in found], [t for _, t in wanted], atol=1e-12)
    left = 2.0 * np.sin(2 * np.pi * (up + 0.05))  # What `y` was as it was left, which `wait` keeps.
    at = {t: i for i, t in enumerate(run.t)}
    for t, state, y, n, z, k in (
        (0.0, 0, 0.0, 0, -1.0, 15.0),
        (0.125, 1, 2.0 * np.sin(np.pi / 4), 1, up, 15.0),
        (0.25, 2, left, 1, up, 15.0 + left),
        (0.75, 0, 1.0, 1, up, 25.0 + left),
        (1.25, 2, left, 2, 0.5 + up, 25.0 + 2 * left),
        (2.0, 0, 0.0, 2, 0.5 + up, 35.0 + 2 * left),
    ):
        row = [float(run[f"m.{name}"][at[t]]) for name in ("state", "y", "n", "z", "k")]
        np.testing.assert_allclose(row, [state, y, n, z, k], atol=1e-10, err_msg=f"t = {t}")


def test_a_state_is_entered_with_what_the_exit_before_assigned() -> None:
    """Both count: 10 at each exit and 1 at each entry; a counter that both changed lost what the exit added."""
    states = {
        "a": MachineState(exit={"n": "n + 10"}),
        "b": MachineState(entry={"n": "n + 1"}, exit={"n": "2*n"}),
        "c": MachineState(entry={"n": "n + 1"}),
    }
    ways = Transition("a", "b", "u-0.5"), Transition("b", "c", "0-u"), Transition("c", "a", "elapsed - 5")
    assert continuous(*ways, states=states, outputs={"n": 0.0})["m.n"][-1] == 23.0
    assert continuous(*ways, states=states, outputs={"n": 0.0}, period=0.01)["m.n"][-1] == 23.0


def test_conditions_that_hold_as_a_state_is_entered_are_met_there() -> None:
    """At the start, after a transition, and where another block switches at that instant."""
    run = continuous(Transition("a", "b", "t + 1"), Transition("b", "c", "on - 0.5"), Transition("c", "a", "2 - on"))
    up = np.arcsin(0.5) / (2 * np.pi)
    found = [(met.crossing, met.t) for met in run.crossings if met.block == "m"]
    assert run.outcome.kind == "interrupted"
    assert all(name in run.outcome.reason for name in ("m.a_to_b", "m.b_to_c", "m.c_to_a"))
    assert found[0] == ("a_to_b", 0.0)
    np.testing.assert_allclose([t for _, t in found[1:]], up, atol=1e-12)
    run = continuous(Transition("a", "b", "t + 1"), Transition("b", "c", "on - 0.5"))
    assert run.outcome.ok and [met.crossing for met in run.crossings if met.block == "m"] == ["a_to_b", "b_to_c"]


def test_of_conditions_that_become_true_together_the_first_stated_counts() -> None:
    ways = [Transition("a", "c", "u-0.5"), Transition("a", "b", "u-0.5"), Transition("c", "b", "t - 1")]
    for first, second in ((0, 1), (1, 0)):
        run = continuous(ways[first], ways[second], ways[2])
        assert [met.crossing for met in run.crossings if met.block == "m"][0] == ("a_to_c", "a_to_b")[first]
        assert run["m.state"][-1] == 1.0 and run["m.state"].max() == (2.0, 1.0)[first]


def test_a_state_entered_anew_counts_its_time_anew() -> None:
    run = continuous(
        Transition("a", "a", "elapsed - 0.375"), Transition("a", "b", "t - 1"), Transition("b", "c", "t - 9")
    )
    found = [(met.crossing, met.t) for met in run.crossings if met.block == "m"]
    assert [name for name, _ in found] == ["a_to_a", "a_to_a", "a_to_b"]
    np.testing.assert_allclose([t for _, t in found], [0.375, 0.75, 1.0], atol=1e-12)
