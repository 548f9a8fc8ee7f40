"""What is wrong with a diagram is said before it runs: object, found, rule, remedy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from tests.diagrams.parts import Counter, Hold, Lag, Number, Twice, arm

PENDULUM = sf.load(Path(__file__).parents[2] / "reference_models" / "rigid" / "double_pendulum.yaml")


def refused(diagram: sf.Diagram, *parts: str) -> str:
    """The message, which has all these parts and the four of every message."""
    with pytest.raises(sf.DescriptionError) as caught:
        sf.Simulation(diagram)
    message = str(caught.value)
    for part in (*parts, "found:", "rule:", "remedy:"):
        assert part in message, (part, message)
    return message


def test_an_input_without_a_source() -> None:
    diagram = sf.Diagram("loose")
    diagram.add(Twice(name="sum"))
    refused(diagram, "input 'sum.a' is not connected", "in m")


def test_every_fault_is_listed_at_once() -> None:
    diagram = sf.Diagram("loose")
    diagram.add(Twice(name="sum"), a="sun")
    diagram.add(Hold(name="hold", period=0.1))
    diagram.connect("sum.z", "hold.x")
    diagram.connect("sum.y", "hold.w")
    diagram.connect("sum.y", "hole.x")
    message = refused(diagram, "no block 'sun'", "no output 'z'", "no input 'w'", "no block 'hole'")
    assert "did you mean 'sum'" in message and "did you mean 'hold'" in message


def test_a_source_of_several_outputs_is_named() -> None:
    diagram = arm(PENDULUM)
    diagram.add(Hold(name="hold", period=0.1), x="plant")
    refused(diagram, "block 'plant' has 4 outputs, and none is named", "outputs: q, v, a, friction")


def test_shapes_differ() -> None:
    diagram = arm(PENDULUM)
    diagram.blocks["goal"] = Number(name="goal", value=[1.0, 2.0, 3.0])
    refused(diagram, "goal.y -> pd.q_desired: shapes differ", "(3,)", "(2,)")


@pytest.mark.parametrize(("unit", "fits"), [("m", True), ("mm", False), ("rad", False), ("", True), ("km m/km", True)])
def test_units_differ(unit: str, fits: bool) -> None:
    diagram = sf.Diagram("units")
    diagram.add(Number(name="one", value=1.0, unit=unit))
    diagram.add(Twice(name="sum"), a="one")
    if fits:
        sf.Simulation(diagram)
    else:
        refused(diagram, "one.y -> sum.a: units differ", unit)


def test_a_unit_that_is_none() -> None:
    diagram = sf.Diagram("units")
    diagram.add(Number(name="one", value=1.0, unit="furlong"))
    refused(diagram, "'one.y'", "'furlong'")


def test_an_algebraic_loop_is_named_by_its_path() -> None:
    diagram = sf.Diagram("loop")
    diagram.add(Number(name="one", value=1.0, unit="m"))
    diagram.add(Twice(name="first"), a="one", b="second")
    diagram.add(Twice(name="second"), a="first")
    message = refused(diagram, "an algebraic loop", "delay")
    assert "first.y -> second.y -> first.y" in message or "second.y -> first.y -> second.y" in message


def test_a_loop_through_a_state_is_none() -> None:
    diagram = sf.Diagram("loop")
    diagram.add(Number(name="one", value=1.0))
    diagram.add(Lag(name="lag"), x="mix")
    diagram.add(Mix(name="mix"), a="one", b="lag")
    run = sf.Simulation(diagram).run(5.0, record=1.0)
    assert run["lag"][-1] == pytest.approx(0.5, abs=1e-9)


@dataclass(frozen=True, kw_only=True)
class Mix(Block):
    """The difference of two signals."""

    def ports(self, environment: Environment) -> Ports:
        return Ports((Port("a"), Port("b")), (Port("y"),))

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": context.inputs["a"] - context.inputs["b"]}


@pytest.mark.parametrize(("period", "offset"), [(0.0, 0.0), (-1.0, 0.0), (0.1, 0.1), (0.1, -0.05), (float("nan"), 0.0)])
def test_sample_times_that_are_none(period: float, offset: float) -> None:
    diagram = sf.Diagram("late")
    diagram.add(Counter(name="ticks", period=period, offset=offset))
    refused(diagram, "block 'ticks' has no sample time")


def test_sample_times_that_do_not_fit_together() -> None:
    diagram = sf.Diagram("late")
    diagram.add(Counter(name="ticks", period=0.1))
    diagram.add(Counter(name="other", period=0.100000001))
    refused(diagram, "sample times do not fit together", "multiples of each other")


def test_a_sampled_block_may_not_move() -> None:
    diagram = sf.Diagram("late")
    diagram.add(Number(name="one", value=1.0))
    diagram.add(Lag(name="lag", period=0.1), x="one")
    refused(diagram, "block 'lag' is sampled and moves between samples")


def test_python_has_a_sample_time() -> None:
    from tests.diagrams.parts import Spoken

    diagram = sf.Diagram("late")
    diagram.add(Number(name="one", value=1.0))
    diagram.add(Spoken(name="spoken", heard=[]), x="one")
    refused(diagram, "block 'spoken' calls Python and has no sample time")


def test_no_such_model() -> None:
    diagram = arm(PENDULUM)
    diagram.blocks["plant"] = blocks.ForwardDynamics(name="plant", model="plan")
    refused(diagram, "no model 'plan'", "did you mean 'plant'")


def test_no_such_coordinate_at_the_start() -> None:
    refused(arm(PENDULUM, q9=1.0), "model 'plant' has no coordinate or speed 'q9'")


def test_names() -> None:
    diagram = arm(PENDULUM)
    for add in (
        lambda: diagram.add(Number(name="pd", value=1.0)),
        lambda: diagram.add(Number(name="1 x", value=1.0)),
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


def test_a_block_that_does_not_keep_its_word() -> None:
    diagram = sf.Diagram("liar")
    diagram.add(Liar(name="liar"))
    refused(diagram, "block 'liar': outputs 'y'", "(2,)")


def test_accelerations_under_constraints_are_for_samples() -> None:
    system = sf.load(Path(__file__).parents[2] / "reference_models" / "closed" / "slider_crank.yaml")
    diagram = sf.Diagram("early")
    diagram.add_model("plant", system)
    diagram.add(Norm(name="norm"), x="plant.lam")
    diagram.add(Lag(name="lag"), x="norm")
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant"))
    with pytest.raises(sf.DescriptionError, match="needed between samples"):
        sf.Simulation(diagram).run(0.1)


@dataclass(frozen=True, kw_only=True)
class Norm(Block):
    """The size of a signal."""

    def ports(self, environment: Environment) -> Ports:
        return Ports((Port("x", environment.inputs.get("x")),), (Port("y"),))

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": context.inputs["x"].norm()}


def part() -> sf.Diagram:
    """A controller with inlets and an outlet."""
    inner = sf.Diagram("controller")
    inner.add(blocks.JointPD(name="pd", kp=[50.0, 30.0], kd=[5.0, 3.0], period=1e-3))
    inner.inlets = {"q": ["pd.q"], "v": ["pd.v"], "goal": ["pd.q_desired"]}
    inner.outlets = {"effort": "pd.effort"}
    return inner


def test_a_part_is_what_its_blocks_are() -> None:
    whole = arm(PENDULUM, q1=0.3)
    diagram = sf.Diagram("arm", dict(whole.models))
    for name in ("plant", "goal"):
        diagram.add(whole.blocks[name])
    diagram.include("control", part(), q="plant.q", v="plant.v", goal="goal")
    diagram.connect("control.effort", "plant.u")
    apart, together = sf.Simulation(whole).run(0.2, record=0.01), sf.Simulation(diagram).run(0.2, record=0.01)
    assert (apart["plant.q"] == together["plant.q"]).all()
    assert (together["control.effort"] == together["control/pd.effort"]).all()


def test_parts_have_the_inlets_they_state() -> None:
    diagram = sf.Diagram("arm")
    with pytest.raises(sf.DescriptionError, match="no inlet 'qq'"):
        diagram.include("control", part(), qq="plant.q")


def test_memory_is_a_mapping_of_arrays() -> None:
    @dataclass(frozen=True, kw_only=True)
    class Odd(Counter):
        def update(self, context: EvaluationContext) -> Mapping[str, Any]:
            return {"m": context.t}

    diagram = sf.Diagram("odd")
    diagram.add(Odd(name="odd", period=0.1))
    refused(diagram, "block 'odd': memory 'm'")
