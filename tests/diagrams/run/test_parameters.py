"""Run-time parameters of a diagram are judged by the blocks and the models that they belong to."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros import blocks


def pendulum() -> sf.System:
    bob = sf.RigidBody("bob", sf.Joint("q", "revolute"), sf.Inertia("m", ("L", 0, 0)))
    return sf.System("pendulum", (bob,), parameters=(sf.Parameter("m", 1.0), sf.Parameter("L", 1.0)))


@cache
def simulation() -> sf.Simulation:
    diagram = sf.Diagram("bench")
    diagram.add_model("plant", pendulum())
    diagram.add(blocks.Constant(name="goal", value=1.0))
    diagram.add(blocks.ForwardDynamics(name="arm", model="plant"))
    return sf.Simulation(diagram)


@pytest.mark.parametrize(
    ("name", "value", "says"), [("m", -1.0, "mass -1"), ("L", 0.0, "moves no mass"), ("m", 0.0, "moves no mass")]
)
def test_runs_refuse_parameters_that_descriptions_refuse(name: str, value: float, says: str) -> None:
    with pytest.raises(sf.ParameterError, match=rf"diagram 'bench': model 'plant': (.|\n)*{says}"):
        simulation().run(0.01, parameters={f"plant.{name}": value})
    with pytest.raises(sf.ParameterError, match=says):
        simulation().interpret(0.01, parameters={f"plant.{name}": value})


def test_invalid_parameters_of_a_model_are_refused_when_added() -> None:
    diagram = sf.Diagram("bench")
    diagram.add_model("plant", pendulum(), parameters={"m": -1.0})
    diagram.add(blocks.ForwardDynamics(name="arm", model="plants"))
    with pytest.raises(sf.DescriptionError, match="mass -1") as caught:  # Beside all other problems.
        sf.Simulation(diagram).run(0.01)
    assert "'plants'" in str(caught.value)


def test_known_parameters_are_listed_once() -> None:
    with pytest.raises(sf.UnknownNameError) as raised:
        simulation().run(0.01, parameters={"nothing.like": 1.0})
    known = raised.value.problem.rule.removeprefix("known: ").split(", ")
    assert sorted(known) == ["goal.value", "plant.L", "plant.m"]


@pytest.mark.parametrize(
    ("block", "values", "says"),
    [
        (blocks.Saturation(name="b"), {"low": 5.0}, "low is above high"),
        (blocks.Saturation(name="b"), {"low": 3.0, "high": 2.0}, "low is above high"),
        (blocks.Saturation(name="b", high=[1.0, 2.0]), {"high": [1.0, -2.0]}, "low is above high"),
        (blocks.Quantizer(name="b"), {"step": 0.0}, "above zero"),
        (blocks.Relay(name="b", period=0.01), {"lower": 2.0}, "lower is below upper"),
        (blocks.RateLimit(name="b", period=0.01), {"rising": -1.0}, "a rate above zero"),
    ],
)
def test_runs_refuse_values_that_blocks_refuse(block: blocks.Block, values: dict[str, object], says: str) -> None:
    """They ran, and gave numbers; within a part and on a condition, too."""
    part = sf.Diagram("part")
    part.add(block, u="one")
    part.add(blocks.Constant(name="one", value=[1.0, 1.0] if np.ndim(getattr(block, "high", 0.0)) else 1.0))
    part.outlets = {"y": "b"}
    whole = sf.Diagram("whole")
    whole.include("inner", part, None, sf.Condition(enabled="on"))
    whole.add(blocks.Constant(name="on", value=1.0))
    simulation = sf.Simulation(whole)
    given = {f"inner/b.{field}": value for field, value in values.items()}
    with pytest.raises(sf.ParameterError, match=rf"block 'inner/b': (.|\n)*{says}"):
        simulation.interpret(0.01, parameters=given)
    assert simulation.interpret(0.01, parameters={"on.value": 2.0}).outcome.ok


def test_limits_that_change_together_are_judged_together() -> None:
    diagram = sf.Diagram("limits")
    diagram.add(blocks.Constant(name="one", value=1.0))
    diagram.add(blocks.Saturation(name="b"), u="one")
    run = sf.Simulation(diagram).interpret(0.01, parameters={"b.low": 3.0, "b.high": 4.0})
    assert run["b.y"][-1] == 3.0
