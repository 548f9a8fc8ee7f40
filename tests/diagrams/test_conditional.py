"""Parts that run while a signal is above zero, or at its edges: against rules written once more, in all ways to run."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.files.command import as_data
from tests.diagrams.parts import Counter, Lag, Spoken

STEP, STEPS = 0.01, 80
RNG = np.random.default_rng(11)
# Zero is not above zero, the least number is; runs of either sign are long enough to be entered and left.
LEVELS = np.array([-1.0, 0.0, -0.0, 5e-324, 1.0, 2.0])
ENABLE = LEVELS[RNG.integers(0, 6, STEPS)].repeat(3)[:STEPS]
TRIGGER, OTHER = LEVELS[RNG.integers(0, 6, (2, STEPS))]
GIVEN = RNG.uniform(-1.0, 1.0, STEPS)
# Two that begin on either side of zero: neither is an edge.
TRIGGER[0], OTHER[0] = 0.0, 1.0
SIGNALS = {"enable": ENABLE, "trigger": TRIGGER, "other": OTHER, "given": GIVEN}
FIRST, BEFORE = 0.25, -3.0

# Flags by which compiled blocks have the bits of interpreted ones: no fused products.
SAME_BITS = sf.Options(flags=("-O1", "-ffp-contract=off"))
EVERY: dict[str, sf.Condition] = {
    f"{outputs}_{states}": sf.Condition(enabled="enable", outputs=outputs, states=states, initial={"x": BEFORE})  # type: ignore[arg-type]
    for outputs, states in product(("held", "reset"), repeat=2)
}
EVERY |= {edge: sf.Condition(triggered="trigger", edge=edge) for edge in ("rising", "falling", "either")}  # type: ignore[arg-type]
EVERY["from_above"] = sf.Condition(triggered="other", edge="either")
EVERY["both"] = sf.Condition(enabled="enable", triggered="trigger", edge="either", outputs="reset", states="reset")


def summing() -> sf.Diagram:
    """A sum of what it is given, and how often it ran; what is continuous inside is read inside."""
    part = sf.Diagram("summing")
    part.add(blocks.Gain(name="twice", gain=2.0))
    part.add(blocks.Integrator(name="sum", start=FIRST, period=STEP), u="twice")
    part.add(Counter(name="runs", period=STEP))
    part.add_inlet("u", "twice.u")
    part.outlets = {"x": "sum.y", "runs": "runs"}
    return part


def whole(conditions: dict[str, sf.Condition]) -> sf.Diagram:
    """The part on each condition."""
    diagram = sf.Diagram("whole")
    for name, values in SIGNALS.items():
        diagram.add(blocks.Sequence(name=f"{name}s", t=STEP * np.arange(STEPS), values=values[:, None], kind="hold"))
        diagram.add(blocks.Reshape(name=name, shape=()), u=f"{name}s")
    for name, condition in conditions.items():
        diagram.include(name, summing(), None, condition, u="given")
    return diagram


def by_hand(condition: sf.Condition) -> dict[str, list[float]]:
    """What the part does, by rules written once more."""
    x, runs, out, count, enabled, before = FIRST, 0, condition.initial.get("x", 0.0), 0.0, False, None
    found: dict[str, list[float]] = {"x": [], "runs": []}
    for k in range(STEPS):
        now = not condition.enabled or ENABLE[k] > 0.0
        if condition.enabled and now and not enabled and condition.states == "reset":
            x, runs = FIRST, 0
        enabled, above = now, bool(SIGNALS[str(condition.triggered or "trigger")][k] > 0.0)
        rises, falls = before is False and above, before is True and not above
        edges = {"rising": rises, "falling": falls, "either": rises or falls}
        before = above
        if now and (not condition.triggered or edges[condition.edge]):
            out, count = x, float(runs)
            x, runs = x + STEP * 2.0 * GIVEN[k], runs + 1
        elif not now and condition.outputs == "reset":
            out, count = condition.initial.get("x", 0.0), 0.0
        found["x"].append(out)
        found["runs"].append(count)
    return found


def test_parts_run_by_the_rules_of_their_conditions() -> None:
    """In C, and block by block with the same bits."""
    simulation = sf.Simulation(whole(EVERY), SAME_BITS)
    end = STEP * (STEPS - 1)
    run, other = (
        simulation.run(end, dt=STEP, record=STEP),
        simulation.interpret(end, dt=STEP, record=STEP, compiled=False),
    )
    assert run.outcome.ok and len(run.t) == STEPS
    seen = set()
    for name, condition in EVERY.items():
        for signal, values in by_hand(condition).items():
            np.testing.assert_allclose(run[f"{name}.{signal}"], values, rtol=1e-13, err_msg=f"{name}.{signal}")
            assert np.array_equal(run[f"{name}.{signal}"], other[f"{name}.{signal}"]), name
            seen.add(tuple(values))
        if condition.enabled:
            assert np.array_equal(run[f"{name}/enabled.on"], ENABLE > 0.0)
    assert len(seen) == 2 * len(EVERY)  # The signals tell all conditions apart.


def test_a_condition_within_a_condition() -> None:
    """The inner part runs where both signals are above zero; each begins anew by its own."""
    inner = sf.Diagram("inner")
    inner.include("part", summing(), None, sf.Condition(enabled=True, states="reset"))
    inner.add_inlet("u", "part.u")
    inner.add_inlet("on", "part.enabled")
    inner.outlets |= {"x": "part.x", "same": "part.x"}
    diagram = whole({})
    # The value of an outlet is that of its output, which other outlets read, too: "part.x" is one that is not named.
    condition = sf.Condition(enabled="trigger", outputs="reset", initial={"x": BEFORE})
    diagram.include("outer", inner, None, condition, u="given", on="enable")
    simulation = sf.Simulation(diagram, SAME_BITS)
    end = STEP * (STEPS - 1)
    run, other = (
        simulation.run(end, dt=STEP, record=STEP),
        simulation.interpret(end, dt=STEP, record=STEP, compiled=False),
    )
    x, was, out, found = FIRST, False, 0.0, []
    for k in range(STEPS):
        if TRIGGER[k] > 0.0:
            on = bool(ENABLE[k] > 0.0)
            x = FIRST if on and not was else x
            out, x, was = (x, x + STEP * 2.0 * GIVEN[k], on) if on else (out, x, on)
        found.append(out if TRIGGER[k] > 0.0 else BEFORE)
    np.testing.assert_allclose(run["outer.x"], found, rtol=1e-13)
    assert np.array_equal(run["outer.same"], run["outer.x"])
    assert np.array_equal(run["outer.x"], other["outer.x"])
    assert as_data(simulation.resolved)["blocks"]["outer/part/sum"]["kind"] == "integrator"


def test_an_enabled_part_has_rates_of_its_own() -> None:
    """A block of thrice the period looks at the signal at its own samples."""
    part = summing()
    part.add(Counter(name="slow", period=3 * STEP))
    part.outlets["slow"] = "slow"
    diagram = whole({})
    diagram.include("part", part, None, sf.Condition(enabled="enable"), u="given")
    run = sf.Simulation(diagram).run(STEP * (STEPS - 1), dt=STEP, record=STEP)
    for name, every in (("slow", 3), ("runs", 1)):
        on, count = ENABLE[::every] > 0.0, np.cumsum(ENABLE[::every] > 0.0)
        held = np.where(on, count - 1, np.maximum(count - 1, 0)).repeat(every)[:STEPS]
        assert np.array_equal(run[f"part.{name}"], held), name


def test_parameters_are_those_of_the_blocks() -> None:
    diagram = whole({"part": EVERY["held_held"]})
    simulation = sf.Simulation(diagram)
    runs = [simulation.run(0.5, dt=STEP, parameters={"part/twice.gain": k}) for k in (2.0, 6.0)]
    assert np.allclose(runs[1]["part.x"][-1] - FIRST, 3.0 * (runs[0]["part.x"][-1] - FIRST))


def test_files_state_conditions(tmp_path: Path) -> None:
    diagram = whole(EVERY)
    sf.save_diagram(diagram, tmp_path / "a.yaml")
    again = sf.load_diagram(tmp_path / "a.yaml", blocks=[Counter])
    assert again.parts == diagram.parts and again.wires == diagram.wires
    sf.save_diagram(again, tmp_path / "b.yaml")
    assert (tmp_path / "a.yaml").read_text() == (tmp_path / "b.yaml").read_text()


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ("{}", ["condition: no signal"]),
        ("{enabled: wave.z}", ["has no output 'z'", ":8"]),
        ("{enabled: wave.y, edge: up}", ["condition does not fit", "rising or falling or either", ":8"]),
        ("{triggered: wave.y, states: reset}", ["a reset without `enabled`"]),
        ("{enabled: wave.y, initial: {xx: 1}}", ["no such outlet", "did you mean 'x'"]),
        ("{enabled: wave.y, initial: {x: [1, 2]}}", ["initial value of 'y'", "shape ()"]),
        ("{enabled: true}", ["'part/enabled.signal' is not connected"]),
        ("{enabled: wave.y, by: 3}", ["condition does not fit", "one of enabled"]),
    ],
)
def test_faults_of_conditions_in_files_have_their_line(stated: str, words: list[str], tmp_path: Path) -> None:
    sf.save_diagram(summing(), tmp_path / "part.yaml")
    head = "symofros_diagram: 1\nblocks:\n  wave: {kind: sine}\nparts:\n  part:\n    file: part.yaml\n"
    (tmp_path / "d.yaml").write_text(f"{head}    inputs: {{u: wave.y}}\n    condition: {stated}\n")
    with pytest.raises(sf.DescriptionError) as caught:
        sf.Simulation(sf.load_diagram(tmp_path / "d.yaml", blocks=[Counter]))
    for word in words:
        assert word in str(caught.value), str(caught.value)


def _with(block: Any, outlet: str = "", inner: bool = False, **wires: str) -> sf.Diagram:
    part = summing()
    part.add(block, **wires)
    part.outlets |= {"more": outlet} if outlet else {}
    if not inner:
        return part
    around = sf.Diagram("around")
    around.include("inner", part, None, sf.Condition(enabled="inner.x"))
    around.add_inlet("u", "inner.u")
    return around


@pytest.mark.parametrize(
    ("part", "condition", "words"),
    [
        (_with(Lag(name="lag"), x="sum"), {"triggered": "trigger"}, ["'lag'", "is continuous", "enable the part"]),
        (_with(blocks.Gain(name="g"), "g", u="sum"), {"triggered": "trigger"}, ["'g'", "an outlet reads it"]),
        (
            _with(blocks.Relay(name="r"), "r", u="sum"),
            {"triggered": "trigger"},
            ["'r'", "is continuous", "enable the part"],
        ),
        (_with(Lag(name="lag", tau=1.0), x="sum", inner=True), {}, ["a condition within another", "one signal"]),
        (_with(Spoken(name="talk", heard=[], period=STEP), x="sum"), {}, ["'talk'", "calls Python"]),
        (_with(Counter(name="enabled", period=STEP)), {}, ["'enabled' is taken", "rename the block"]),
        (_with(Counter(name="n", period=0.03)), {"triggered": "trigger"}, ["several rates", "0.03 s from"]),
        (
            _with(blocks.Formula(name="f", formulas={"y": "enabled + 1"}, period=STEP), enabled="sum"),
            {},
            ["input 'enabled' is taken"],
        ),
        (_with(Counter(name="n", period=STEP), "sum"), {"initial": {"x": 1, "more": 2}}, ["'x' and 'more' differ"]),
        (summing(), {"initial": {"x": float("nan")}}, ["finite numbers"]),
        (summing(), {"edge": "up"}, ["unknown edge"]),
        (summing(), {"states": "kept"}, ["unknown states"]),
    ],
)
def test_unsuitable_parts_and_conditions_are_refused(
    part: sf.Diagram, condition: dict[str, Any], words: list[str]
) -> None:
    diagram = whole({})
    with pytest.raises(sf.DescriptionError) as caught:
        diagram.include("part", part, None, sf.Condition(**{"enabled": "enable", **condition}), u="given")
        sf.Simulation(diagram)
    for word in words:
        assert word in str(caught.value), str(caught.value)


def test_outlets_of_parts_within_parts_are_wired() -> None:
    """What reads the outlet of a part reads it where both are a part of a third diagram, too."""
    middle = sf.Diagram("middle")
    middle.include("part", summing())
    middle.add(blocks.Gain(name="gain", gain=3.0), u="part.x")
    middle.add_inlet("u", "part/twice.u")
    middle.outlets |= {"y": "gain", "x": "part.x"}
    diagram = whole({})
    diagram.include("middle", middle, u="given")
    run = sf.Simulation(diagram).run(0.3, dt=STEP, record=STEP)
    assert np.array_equal(run["middle.y"], 3.0 * run["middle.x"]) and np.ptp(run["middle.y"]) > 0.0
