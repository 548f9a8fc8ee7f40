"""Continuous blocks of parts that a signal enables: states and outputs against closed forms, instants located."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.files.command import as_data
from tests.diagrams.parts import Counter, Lag
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
    """From when to when the part is enabled, or is not."""
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
    assert run.outcome.ok and all("changes too often" in note for note in run.outcome.notes), run.outcome
    assert bool(run.outcome.notes) == (signal == "logic")  # It jumps within steps.
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
