"""What is known of a mechanism's forces, fed forward: friction and gravity (sections 6.1 and 8 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import numbers
from symofros.blocks.dynamics import friction
from symofros.blocks.quantities import motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Ports, Values


@dataclass(frozen=True, kw_only=True)
class FrictionCompensation(Block):
    """Efforts against the friction of a model's joints at some speed, desired or measured.

    Attributes:
        model: The model, with friction in its joints.
        factor: Share to compensate, one number or one a joint; more than 1 may let joints creep.
    """

    model: str
    factor: Any = 1.0
    tunable: ClassVar[tuple[str, ...]] = ("factor",)

    def __post_init__(self) -> None:
        """Factors are numbers."""
        numbers(self.name, "factor", self.factor)

    def ports(self, environment: Environment) -> Ports:
        """Motion q, v in; effort (nv) out, zero where there is no friction."""
        record = environment.model(self.model)
        nv = len(record.v_names)
        if np.ndim(self.factor):
            numbers(self.name, "factor", self.factor, (nv,))
        inputs = motion_port("q", record, "q"), motion_port("v", record, "v")
        return Ports(inputs, (motion_port("effort", record, "effort"),))

    def compute(self, context: EvaluationContext) -> Values:
        """The opposite of the friction."""
        effort = friction(context, self.model, context.inputs["q"], context.inputs["v"])
        return {"effort": -context.parameters["factor"] * effort}


@dataclass(frozen=True, kw_only=True)
class GravityCompensation(Block):
    """Efforts that hold a model still: tau = h(q, 0) - Q(q, 0, 0), gravity and springs.

    Attributes:
        model: The model.
    """

    model: str

    def ports(self, environment: Environment) -> Ports:
        """Configuration q in; effort (nv) out."""
        record = environment.model(self.model)
        return Ports((motion_port("q", record, "q"),), (motion_port("effort", record, "effort"),))

    def compute(self, context: EvaluationContext) -> Values:
        """Inverse dynamics at rest."""
        rest = context.numbers(np.zeros(len(context.environment.model(self.model).v_names)))
        tau = context.call(self.model, "inverse_dynamics", q=context.inputs["q"], v=rest, a=rest, t=context.t)["tau"]
        return {"effort": tau}
