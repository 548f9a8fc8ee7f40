"""What is wrong with a diagram is said before it runs: object, found, rule, remedy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from tests.diagrams.parts import Counter, Lag, Spoken, Twice, arm, moving

PENDULUM = sf.load(Path(__file__).parents[2] / "reference_models" / "rigid" / "double_pendulum.yaml")


def refused(diagram: sf.Diagram, *parts: str) -> str:
    """The message, which has all these parts and the four of every message."""
    with pytest.raises(sf.DescriptionError) as caught:
        sf.Simulation(diagram)
    message = str(caught.value)
    for part in (*parts, "found:", "rule:", "remedy:"):
        assert part in message, (part, message)
    return message


def test_every_fault_is_listed_at_once() -> None:
    diagram = sf.Diagram("loose")
    diagram.add(Twice(name="sum"), a="sun")
    diagram.add(blocks.Hold(name="hold", period=0.1))
    diagram.connect("sum.z", "hold.u")
    diagram.connect("sum.y", "hold.w")
    diagram.connect("sum.y", "hole.x")
    message = refused(diagram, "no block 'sun'", "no output 'z'", "no input 'w'", "no block 'hole'")
    assert "did you mean 'sum'" in message and "did you mean 'hold'" in message


def test_a_source_of_several_outputs_is_named() -> None:
    diagram = arm(PENDULUM)
    diagram.add(blocks.Hold(name="hold", period=0.1), u="plant")
    refused(diagram, "block 'plant' has 4 outputs, and none is named", "outputs: q, v, a, friction")


def test_an_algebraic_loop_is_named_by_its_path() -> None:
    diagram = sf.Diagram("loop")
    diagram.add(blocks.Constant(name="one", value=1.0, unit="m"))
    diagram.add(Twice(name="first"), a="one", b="second")
    diagram.add(Twice(name="second"), a="first")
    message = refused(diagram, "an algebraic loop", "delay")
    assert "first.y -> second.y -> first.y" in message or "second.y -> first.y -> second.y" in message


def test_invalid_names_and_connections_are_refused() -> None:
    diagram = arm(PENDULUM)
    for add in (
        lambda: diagram.add(blocks.Constant(name="pd", value=1.0)),
        lambda: diagram.add(blocks.Constant(name="1 x", value=1.0)),
        lambda: diagram.connect("goal", "pd.q_desired"),
        lambda: diagram.connect("goal", "pd"),
    ):
        with pytest.raises(sf.DescriptionError, match=r"rule:[\s\S]*remedy:"):
            add()


@dataclass(frozen=True, kw_only=True)
class Liar(Block):
    """Its formulas do not have the shapes that its ports promise."""

    def ports(self, environment: Environment) -> Ports:
        return Ports((), (Port("y", (2,)),))

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": context.t}


def test_constrained_accelerations_are_available_at_samples_only() -> None:
    system = sf.load(Path(__file__).parents[2] / "reference_models" / "closed" / "slider_crank.yaml")
    diagram = moving(system)
    diagram.add(blocks.Formula(name="norm", formulas="abs(x[0])"), x="plant.lam")
    diagram.add(Lag(name="lag"), x="norm")
    with pytest.raises(sf.DescriptionError, match="needed between samples"):
        sf.Simulation(diagram).run(0.1)


def part() -> sf.Diagram:
    """A controller with inlets and an outlet."""
    inner = sf.Diagram("controller")
    inner.add(blocks.JointPD(name="pd", kp=[50.0, 30.0], kd=[5.0, 3.0], period=1e-3))
    inner.inlets = {"q": ["pd.q"], "v": ["pd.v"], "goal": ["pd.q_desired"]}
    inner.outlets = {"effort": "pd.effort"}
    return inner


def test_a_part_runs_like_its_blocks_in_the_diagram() -> None:
    whole = arm(PENDULUM, q1=0.3)
    diagram = sf.Diagram("arm", dict(whole.models))
    for name in ("plant", "goal"):
        diagram.add(whole.blocks[name])
    diagram.include("control", part(), q="plant.q", v="plant.v", goal="goal")
    diagram.connect("control.effort", "plant.u")
    apart, together = sf.Simulation(whole).run(0.2, record=0.01), sf.Simulation(diagram).run(0.2, record=0.01)
    assert (apart["plant.q"] == together["plant.q"]).all()
    assert (together["control.effort"] == together["control/pd.effort"]).all()


def test_a_loop_whose_first_values_are_numbers_is_one_of_scalars() -> None:
    """x' = -3 x by samples, late by four; a first value of two entries makes it one of two."""
    for start in (1.0, [1.0, 2.0]):
        diagram = sf.Diagram("decay")
        diagram.add(blocks.Integrator(name="x", period=0.01, start=start))
        diagram.add(blocks.TransportDelay(name="late", delay=0.04, period=0.01, start=1.0), u="x.y")
        diagram.add(blocks.Gain(name="gain", gain=-3.0), u="late.y")
        diagram.connect("gain.y", "x.u")
        run = sf.Simulation(diagram).run(1.0, dt=0.01, record=0.01)
        assert run["x.y"].shape[1:] == np.shape(start)
        expected = [np.asarray(start)]
        for k in range(100):
            expected.append(expected[-1] - 0.03 * (expected[k - 4] if k >= 4 else 1.0))
        np.testing.assert_allclose(run["x.y"], expected, atol=1e-12)


def test_outlets_of_parts_stay_where_outlets_are_assigned_anew() -> None:
    """As the pages do, `outlets = {...}` after parts came in: of a part of a part, too, and for signals of a run."""
    innermost, inner, diagram = sf.Diagram("innermost"), sf.Diagram("inner"), sf.Diagram("outer")
    innermost.add(Counter(name="ticks", period=0.1))
    innermost.outlets = {"n": "ticks.n"}
    inner.include("count", innermost)
    inner.outlets = {"shown": "count.n"}
    diagram.include("part", inner)
    diagram.outlets = {"all": "part.shown"}
    run = sf.Simulation(diagram).run(0.5, dt=0.1, record=0.1)
    for signal in ("all", "part.shown", "part.count.n", "part/count/ticks.n"):
        assert run[signal].tolist() == [0, 1, 2, 3, 4, 5], signal


@dataclass(frozen=True, kw_only=True)
class Odd(Counter):
    """It updates what it does not remember."""

    def update(self, context: EvaluationContext) -> Mapping[str, Any]:
        return {"m": context.t}


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ([Counter(name="ticks", period=0.0)], "block 'ticks' has no sample time"),
        ([Counter(name="ticks", period=0.1, offset=0.1)], "block 'ticks' has no sample time"),
        ([Counter(name="ticks", period=0.1, offset=-0.05)], "block 'ticks' has no sample time"),
        ([Counter(name="ticks", period=float("nan"))], "block 'ticks' has no sample time"),
        ([Counter(name="ticks", period="0.1")], "block 'ticks' has no sample time"),  # type: ignore[arg-type]
        ([Counter(name="ticks", period=[0.1])], "block 'ticks' has no sample time"),  # type: ignore[arg-type]
        ([Counter(name="ticks", period=True)], "block 'ticks' has no sample time"),
        ([Counter(name="ticks", period=0.1, offset="0")], "block 'ticks' has no sample time"),  # type: ignore[arg-type]
        ([Counter(name="a", period=0.1), Counter(name="b", period=0.100000001)], "sample times do not fit together"),
        ([Lag(name="lag", period=0.1)], "block 'lag' is sampled and moves between samples"),
        ([Spoken(name="spoken", heard=[])], "block 'spoken' calls Python and has no sample time"),
        ([Liar(name="liar")], "block 'liar': outputs 'y'"),
        ([Odd(name="odd", period=0.1)], "block 'odd': memory 'm'"),
    ],
)
def test_invalid_blocks_are_refused(stated: list[Block], words: str) -> None:
    diagram = sf.Diagram("wrong")
    diagram.add(blocks.Constant(name="one", value=1.0))
    for block in stated:
        diagram.add(block, **({"x": "one"} if isinstance(block, Lag | Spoken) else {}))
    refused(diagram, words)


@pytest.mark.parametrize("made", [np.array, list])
def test_blocks_keep_what_they_were_stated_by(made: Any) -> None:
    """A buffer that a loop fills anew for its next diagram changes no diagram before."""
    value, table, gain = made([1.0, 2.0]), [made([0.0, 1.0])], {"rows": made([3.0])}
    held = blocks.Constant(name="c", value=value)
    nested = blocks.Constant(name="d", value=table)
    named = Kept(name="e", table=gain)
    value[0] = table[0][1] = gain["rows"][0] = 50.0
    diagram = sf.Diagram("held")
    diagram.add(held)
    diagram.add(nested)
    run = sf.Simulation(diagram).run(0.1, dt=0.1)
    assert list(run["c.y"][-1]) == [1.0, 2.0] and list(run["d.y"][-1][0]) == [0.0, 1.0]
    assert named.table["rows"][0] == 3.0


@dataclass(frozen=True, kw_only=True)
class Kept(Block):
    """A block of a user's with a table of arrays."""

    table: Any


def test_blocks_that_call_python_share_what_they_fill() -> None:
    seen: list[float] = []
    assert Spoken(name="s", heard=seen, period=0.1).heard is seen
