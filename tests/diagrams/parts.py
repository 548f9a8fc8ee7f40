"""Small blocks and diagrams that the tests of diagrams are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import symofros as sf
from symofros import blocks
from symofros.diagrams.block import Block, Crossing, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.external_block import ExternalBlock, Running


@dataclass(frozen=True, kw_only=True)
class Lag(Block):
    """A first-order lag: rate s' = (x - s) / tau."""

    tau: float = 0.1

    def ports(self, environment: Environment) -> Ports:
        return Ports((Port("x"),), (Port("y"),))

    def states(self, environment: Environment) -> Mapping[str, Any]:
        return {"s": 0.0}

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": context.states["s"]}

    def rates(self, context: EvaluationContext) -> Values:
        return {"s": (context.inputs["x"] - context.states["s"]) / self.tau}


@dataclass(frozen=True, kw_only=True)
class Counter(Block):
    """How many samples there have been."""

    def ports(self, environment: Environment) -> Ports:
        return Ports((), (Port("n"),))

    def memory(self, environment: Environment) -> Mapping[str, Any]:
        return {"n": 0.0}

    def compute(self, context: EvaluationContext) -> Values:
        return {"n": context.memory["n"]}

    def update(self, context: EvaluationContext) -> Values:
        return {"n": context.memory["n"] + 1.0}


@dataclass(frozen=True, kw_only=True)
class Twice(Block):
    """Two inputs' sum: it passes its inputs on at once."""

    def ports(self, environment: Environment) -> Ports:
        return Ports((Port("a", (), "m"), Port("b", (), "m", 0.0)), (Port("y", (), "m"),))

    def compute(self, context: EvaluationContext) -> Values:
        return {"y": context.inputs["a"] + context.inputs["b"]}


@dataclass(frozen=True, kw_only=True)
class Spoken(ExternalBlock):
    """A function of Python's."""

    heard: list[float]

    def ports(self, environment: Environment) -> Ports:
        return Ports((Port("x", environment.inputs.get("x")),), (Port("y", environment.inputs.get("x")),))

    def begin(self, environment: Environment) -> Running:
        return Speaking(self.heard)


class Speaking(Running):
    """It doubles what it hears."""

    def __init__(self, heard: list[float]) -> None:
        self.heard = heard

    def call(self, t: float, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        self.heard.append(t)
        return {"y": 2.0 * inputs["x"]}


@dataclass(frozen=True, kw_only=True)
class Ball(Block):
    """A ball above a floor: it bounces where its height crosses zero."""

    restitution: float = 0.5

    def ports(self, environment: Environment) -> Ports:
        return Ports((), (Port("height"), Port("bounces")))

    def states(self, environment: Environment) -> Mapping[str, Any]:
        return {"h": 1.0, "w": 0.0}

    def memory(self, environment: Environment) -> Mapping[str, Any]:
        return {"n": 0.0}

    def compute(self, context: EvaluationContext) -> Values:
        return {"height": context.states["h"], "bounces": context.memory["n"]}

    def rates(self, context: EvaluationContext) -> Values:
        return {"h": context.states["w"], "w": context.numbers(-9.81)}

    def crossings(self, context: EvaluationContext) -> Mapping[str, Crossing]:
        return {"floor": Crossing(context.states["h"], "falling")}

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        return {"w": -self.restitution * context.states["w"], "h": context.numbers(0.0), "n": context.memory["n"] + 1.0}


def ramp() -> blocks.Ramp:
    """Time, and twice of it."""
    return blocks.Ramp(name="ramp", slope=[1.0, 2.0], unit="s")


def moving(
    model: sf.System, start: Mapping[str, float] | None = None, title: str = "moving", **wires: str
) -> sf.Diagram:
    """A diagram whose block "plant" moves a model; it engages the model's constraints where a wire says so."""
    diagram = sf.Diagram(title)
    diagram.add_model("plant", model, start=start or {})
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant", engaged="engaged" in wires), **wires)
    return diagram


def arm(model: sf.System, period: float | None = 1e-3, **start: float) -> sf.Diagram:
    """A mechanism under joint PD."""
    diagram = moving(model, start, "arm", u="pd.effort")
    diagram.add(blocks.Constant(name="goal", value=[0.5, -0.2]))
    diagram.add(
        blocks.JointPD(name="pd", kp=[50.0, 30.0], kd=[5.0, 3.0], period=period),
        q="plant.q",
        v="plant.v",
        q_desired="goal",
    )
    return diagram
