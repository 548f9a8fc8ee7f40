"""Continuous blocks of parts that a signal enables: states and outputs against closed forms, instants located."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.block import Block, Port, Ports
from symofros.diagrams.files.command import as_data
from tests.diagrams.parts import Counter, Lag
from tests.models import bounds
from validation.references import MODELS

FIRST, BEFORE, TAU = 0.25, -3.0, 0.4
EVERY: dict[str, sf.Condition] = {
    f"{outputs}_{states}": sf.Condition(enabled="signal.y", outputs=outputs, states=states, initial={"x": BEFORE})  # type: ignore[arg-type]
    for outputs, states in product(("held", "reset"), repeat=2)
}
# The signal is above zero from the start to the first of these instants, and from each second one on.
RATE, PHASE = 3.0, 0.4
WAVE = [(k * np.pi - PHASE) / RATE for k in range(1, 6)]


def moving() -> sf.Diagram:
    """An integral and a lag of what it is given; an outlet reads a gain behind the integral."""
    part = sf.Diagram("moving")
    part.add(blocks.Integrator(name="sum", start=FIRST))
    part.add(blocks.Gain(name="gain", gain=2.0), u="sum")
    part.add(Lag(name="lag", tau=TAU), x="gain")
    part.add_inlet("u", "sum.u")
    part.outlets = {"x": "gain", "y": "lag"}
    return part


def whole(conditions: dict[str, sf.Condition], signal: str = "wave") -> sf.Diagram:
    """The part on each condition: the integral is one of cos(t)."""
    diagram = sf.Diagram("whole")
    wave = f"sin({RATE}*t + {PHASE})"
    if signal == "sampled":
        diagram.add(blocks.Formula(name="signal", formulas={"y": wave}, period=0.1))
    elif signal == "relay":  # From 0 to 1 and back.
        diagram.add(blocks.Formula(name="wave", formulas={"y": wave}))
        diagram.add(blocks.Relay(name="signal", lower=-1e-9, upper=1e-9, on=1.0, off=0.0), u="wave")
    elif signal == "logic":
        diagram.add(blocks.Formula(name="signal", formulas={"y": f"0.5 + 0.5*sign({wave})"}))
    else:
        diagram.add(blocks.Formula(name="signal", formulas={"y": f"-{wave}" if signal == "below" else wave}))
    diagram.add(blocks.Formula(name="given", formulas={"y": "cos(t)"}))
    for name, condition in conditions.items():
        diagram.include(name, moving(), None, condition, u="given")
    return diagram


def spans(signal: str, t_end: float) -> Iterator[tuple[float, float, bool]]:
    """Spans of time in which the part is enabled, or is not."""
    ends = [0.0, *(t for t in WAVE if t < t_end), t_end]
    if signal == "sampled":
        k = np.arange(int(np.ceil(10 * t_end)))
        on = np.sin(RATE * k / 10 + PHASE) > 0.0
        ends = [0.0, *((k[1:] / 10)[on[1:] != on[:-1]].tolist()), t_end]
    for i, (begin, end) in enumerate(zip(ends, ends[1:], strict=False)):
        yield begin, end, (i % 2 == 0) != (signal == "below")


def by_hand(condition: sf.Condition, signal: str, t: np.ndarray, t_end: float) -> tuple[np.ndarray, np.ndarray]:
    """Outlets in closed form: x = 2 s with s' = cos t, and the lag y' = (x - y)/TAU."""
    s, y, held = FIRST, 0.0, (BEFORE, 0.0)
    found = np.zeros((2, len(t)))

    def motion(at: Any, begin: float) -> tuple[Any, Any]:
        # x = c + 2 sin t; a particular solution of the lag is c + 2 (sin t - TAU cos t)/(1 + TAU^2).
        c = 2.0 * (s - np.sin(begin))
        w = 1.0 / (1.0 + TAU**2)
        own = c + 2.0 * w * (np.sin(at) - TAU * np.cos(at))
        first = c + 2.0 * w * (np.sin(begin) - TAU * np.cos(begin))
        return c + 2.0 * np.sin(at), own + (y - first) * np.exp(-(at - begin) / TAU)

    for begin, end, on in spans(signal, t_end):
        rows = (t >= begin) & (t <= end)
        if not on:
            found[:, rows] = np.array(held if condition.outputs == "held" else (BEFORE, 0.0))[:, None]
            continue
        if begin > 0.0 and condition.states == "reset":
            s, y = FIRST, 0.0
        found[:, rows] = motion(t[rows], begin)
        x, y = motion(end, begin)
        s, held = x / 2.0, (x, y)
    return found[0], found[1]


@pytest.mark.parametrize("options", [{"method": "rk4", "dt": 5e-3}, {"method": "dopri5", "rtol": 1e-10, "atol": 1e-12}])
@pytest.mark.parametrize("signal", ["wave", "below", "relay", "logic", "sampled"])
def test_states_and_outputs_follow_the_signal(signal: str, options: dict[str, Any]) -> None:
    run = sf.Simulation(whole(EVERY, signal)).run(4.0, record=0.0125, **options)
    assert run.outcome.ok and not run.outcome.notes, run.outcome
    seen = set()
    for name, condition in EVERY.items():
        # What samples or a relay say at the start is met there.
        instants = [begin for begin, _, _ in spans(signal, 4.0)][signal not in ("relay", "sampled") :]
        away = np.abs(run.t[:, None] - np.array(instants)).min(axis=1) > 2e-9  # Either side at the instant itself.
        for outlet, values in zip("xy", by_hand(condition, signal, run.t, 4.0), strict=True):
            said = f"{name}.{outlet}"
            np.testing.assert_allclose(run[said][away], values[away], atol=2e-9, err_msg=said)
            seen.add((outlet, tuple(np.round(values, 6))))
        met = [one for one in run.crossings if one.block == f"{name}/sum"]
        assert [one.t for one in met] == pytest.approx(instants, abs=1e-9)
        named = ["disables", "enables"] * 3 if instants[0] and signal != "below" else ["enables", "disables"] * 3
        assert [one.crossing for one in met] == named[: len(met)]
    assert len(seen) == 2 * len(EVERY)  # The signals tell all conditions apart.
    for states in ("held", "reset"):  # What no outlet reads is held.
        assert np.array_equal(run[f"reset_{states}/sum.y"], run[f"held_{states}/sum.y"])


def test_mechanisms_do_not_run_on_conditions() -> None:
    part = sf.Diagram("part")
    part.add_model("arm", MODELS["double_pendulum"])
    part.add(blocks.ForwardDynamics(name="arm", model="arm"))
    with pytest.raises(sf.DescriptionError, match="moves a mechanism"):
        whole({}).include("part", part, None, sf.Condition(enabled="signal.y"))


def test_blocks_of_every_rate_live_in_one_part() -> None:
    """What is sampled looks at its samples, what is continuous at the instant; a reset counts while it is enabled."""
    part = sf.Diagram("both")
    part.add(blocks.Integrator(name="time", start=1.0, reset="rising"), u="one", reset="again")
    part.add(blocks.Constant(name="one", value=1.0))
    part.add(blocks.Formula(name="again", formulas={"y": "(t - 0.3)*(t - 1.1)*(t - 1.5)*(t - 1.9)*(t - 2.3)"}))
    part.add(Counter(name="runs", period=0.1))
    part.outlets = {"time": "time", "runs": "runs"}
    diagram = whole({})
    diagram.include("part", part, None, sf.Condition(enabled="signal.y"))
    run = sf.Simulation(diagram).run(2.9, dt=1e-3, record=0.1)
    rises, falls = WAVE[1], WAVE[0]
    # From 1, anew at 0.3 s; held from WAVE[0] to WAVE[1], at 1.5 s, too; anew at 2.3 s, as it is enabled again.
    for t, value in ((0.2, 1.2), (0.5, 1.2), (1.0, 1.0 + falls - 0.3), (1.9, 1.0 + falls - 0.3), (2.8, 1.5)):
        assert run["part.time"][np.searchsorted(run.t, t + 1e-9) - 1] == pytest.approx(value, abs=1e-9), t
    before = 1.0 + (falls - 0.3) + (2.2 - rises)
    assert run["part.time"][np.searchsorted(run.t, 2.2 + 1e-9) - 1] == pytest.approx(before, abs=1e-9)
    assert run["part.runs"][-1] == (np.sin(RATE * np.arange(30) / 10 + PHASE) > 0.0).sum() - 1


def test_files_state_them(tmp_path: Path) -> None:
    sf.save_diagram(whole(EVERY), tmp_path / "a.yaml")
    again = sf.load_diagram(tmp_path / "a.yaml", blocks=[Lag])
    runs = [sf.Simulation(one).run(1.0, dt=1e-2, record=0.1) for one in (whole(EVERY), again)]
    assert all(np.array_equal(runs[0][f"{name}.y"], runs[1][f"{name}.y"]) for name in EVERY)
    assert as_data(sf.Simulation(again).resolved)["blocks"]["held_held/sum"]["kind"] == "integrator"


# Of the input of a relay. At 7.3 rad/s it is enabled once above the one and off, once below the other and on; at 7.8
# rad/s between them, once on and once off.
UPPER, LOWER = 0.5, -0.6


def relay_by_hand(
    states: str, starts_on: bool, fast: float, t: np.ndarray, t_end: float
) -> tuple[np.ndarray, np.ndarray]:
    """A relay of sin(fast t) while WAVE enables it: its output, held between, and the integral of that."""
    level = [(np.arcsin(UPPER) + 2 * np.pi * k) / fast for k in range(12)]
    fall = [(np.pi - np.arcsin(LOWER) + 2 * np.pi * k) / fast for k in range(12)]
    marks = sorted([*((at, "on") for at in level), *((at, "off") for at in fall), *((at, "wave") for at in WAVE)])
    enabled, on, held = True, starts_on, 0.0
    ends, values = [0.0], [float(on)]
    for at, what in marks:
        if what == "wave":
            enabled = not enabled
            if enabled:
                u = np.sin(fast * at)
                on = starts_on if states == "reset" else on
                on = u >= UPPER or (on and u > LOWER)
            else:
                held = float(on)
        elif enabled:
            on = what == "on"
        ends.append(at)
        values.append(float(on) if enabled else held)
    ends_, values_ = np.array(ends), np.array(values)
    sums = np.concatenate([[0.0], np.cumsum(np.diff(ends_) * values_[:-1])])
    which = np.searchsorted(ends_, t, side="right") - 1
    return values_[which], sums[which] + values_[which] * (t - ends_[which])


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("starts_on", [False, True])
@pytest.mark.parametrize("states", ["held", "reset"])
@pytest.mark.parametrize("fast", [7.3, 7.8])
def test_a_relay_switches_while_it_is_enabled(fast: float, states: Any, starts_on: bool, method: str) -> None:
    """At its levels, located in time, and as it is enabled beyond one; its integral tells the instants."""
    part = sf.Diagram("part")
    part.add(blocks.Relay(name="relay", lower=LOWER, upper=UPPER, starts_on=starts_on))
    part.add_inlet("u", "relay.u")
    part.outlets = {"y": "relay"}
    diagram = whole({})
    diagram.add(blocks.Formula(name="fast", formulas={"y": f"sin({fast}*t)"}))
    diagram.include("part", part, None, sf.Condition(enabled="signal.y", states=states), u="fast")
    diagram.add(blocks.Integrator(name="sum"), u="part.y")
    simulation = sf.Simulation(diagram)
    run = simulation.run(5.0, dt=5e-3, method=method, record=0.0125, **bounds(method, 1e-9, 1e-11))
    y, total = relay_by_hand(states, starts_on, fast, run.t, 5.0)
    assert run.outcome.ok and run["sum.y"] == pytest.approx(total, abs=2e-9)
    if method == "rk4" and starts_on:
        other = simulation.interpret(5.0, dt=5e-3, record=0.0125)
        assert [one.t for one in other.crossings] == pytest.approx([one.t for one in run.crossings], abs=1e-9)
        assert other["sum.y"][-1] == pytest.approx(total[-1], abs=2e-9)
    equal = np.abs(run["part.y"] - y) < 1e-12  # But for one side of each instant.
    assert equal.mean() > 0.97 and 0.1 < y.mean() < 0.9


@dataclass(frozen=True, kw_only=True)
class Keeper(Block):
    """A continuous block whose memory nothing changes."""

    def ports(self, environment: Any) -> Ports:
        return Ports((), (Port("y", ()),))

    def memory(self, environment: Any) -> dict[str, Any]:
        return {"kept": 1.0}

    def compute(self, context: Any) -> dict[str, Any]:
        return {"y": context.memory["kept"]}


def test_memory_that_no_crossing_changes_is_refused() -> None:
    part = sf.Diagram("part")
    part.add(Keeper(name="keeper"))
    diagram = whole({})
    diagram.include("part", part, None, sf.Condition(enabled="signal.y"))
    with pytest.raises(sf.DescriptionError, match="(?s)'part/keeper'.*keeps memory.*kept.*give it a period"):
        sf.Simulation(diagram)


def machine(**fields: Any) -> blocks.StateMachine:
    return blocks.StateMachine(
        name="machine",
        machine_states={"rest": blocks.MachineState({"y": 1.0}), "late": blocks.MachineState({"y": "2 + t"})},
        transitions=[blocks.Transition("rest", "late", "elapsed - 0.3")],
        outputs={"y": 0.0},
        **fields,
    )


def test_a_state_machine_begins_anew_where_it_is_enabled() -> None:
    """Entered at the instant, late 0.3 s later; held in between; time passes, so that it can't go on."""
    part = sf.Diagram("part")
    part.add(machine())
    part.outlets = {"y": "machine.y"}
    diagram = whole({})
    diagram.include("part", part, None, sf.Condition(enabled="signal.y", states="reset"))
    run = sf.Simulation(diagram).run(4.0, dt=5e-3, record=0.0125)
    y = np.zeros(len(run.t))
    for begin, end, on in spans("wave", 4.0):
        rows = (run.t >= begin) & (run.t <= end)
        y[rows] = np.where(run.t[rows] >= begin + 0.3, 2.0 + run.t[rows], 1.0) if on else 2.0 + begin
    away = np.abs(run.t[:, None] - np.array([0.3, *WAVE, *(np.array(WAVE) + 0.3)])).min(axis=1) > 1e-8
    assert run["part.y"][away] == pytest.approx(y[away], abs=1e-9)
    late = [one.t for one in run.crossings if one.crossing == "rest_to_late"]
    assert late == pytest.approx([0.3, WAVE[1] + 0.3, WAVE[3] + 0.3][: len(late)], abs=1e-9) and len(late) >= 2
    with pytest.raises(sf.DescriptionError, match="keeps instants"):
        whole({}).include("part", part, None, sf.Condition(enabled="signal.y"))


@pytest.mark.parametrize("dt", [0.05, 0.01])
def test_a_signal_that_passes_zero_where_a_step_ends_enables_there(dt: float) -> None:
    diagram = sf.Diagram("whole")
    diagram.add(blocks.Ramp(name="signal", start=-0.5))
    part = sf.Diagram("part")
    part.add(blocks.Constant(name="one", value=1.0))
    part.add(blocks.Integrator(name="sum"), u="one.y")
    part.outlets = {"y": "sum"}
    diagram.include("part", part, None, sf.Condition(enabled="signal.y"))
    simulation = sf.Simulation(diagram)
    for run in (simulation.run(1.0, dt=dt), simulation.interpret(1.0, dt=dt)):
        assert run["part.y"][-1] == pytest.approx(0.5, abs=1e-12)
