"""Run-time parameters of a diagram's models are judged by the models' descriptions."""

from __future__ import annotations

from functools import cache

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
