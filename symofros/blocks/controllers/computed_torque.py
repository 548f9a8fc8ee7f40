"""Computed torque: a model's inverse dynamics closes the loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import numbers
from symofros.blocks.manifold import difference
from symofros.blocks.quantities import entry_units, motion_port, with_units
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values


@dataclass(frozen=True, kw_only=True)
class ComputedTorque(Block):
    """tau = M(q) (a_d + kd (v_d - v) + kp (q_d - q)) + h(q, v) - Q(q, v, 0): errors decay as e'' + kd e' + kp e = 0.

    The difference of configurations is along their manifold: of ball and free joints, a rotation vector in body axes.
    Efforts of passive joints are those that the same motion would take of them; pick the others.

    Attributes:
        model: The model, a rigid one say.
        kp: One number or one a speed (nv) [1/s^2].
        kd: Derivative gain of each joint, or one for all [1/s].
    """

    model: str
    kp: Any
    kd: Any
    tunable: ClassVar[tuple[str, ...]] = ("kp", "kd")

    def __post_init__(self) -> None:
        """Gains are numbers."""
        numbers(self.name, "kp", self.kp)
        numbers(self.name, "kd", self.kd)

    def ports(self, environment: Environment) -> Ports:
        """Desired q, v, a and actual q, v in; tau (nv) and the error (nv) out."""
        record = environment.model(self.model)
        nv = len(record.v_names)
        for field in ("kp", "kd"):
            if np.ndim(getattr(self, field)):
                numbers(self.name, field, getattr(self, field), (nv,))
        inputs = (
            motion_port("q_desired", record, "q"),
            motion_port("v_desired", record, "v", 0.0),
            motion_port("a_desired", record, "a", 0.0),
            motion_port("q", record, "q"),
            motion_port("v", record, "v"),
        )
        turns = tuple(unit.removesuffix("/s") for unit in entry_units(record, "v"))
        return Ports(inputs, (motion_port("tau", record, "effort"), with_units(Port("error", (nv,)), turns)))

    def compute(self, context: EvaluationContext) -> Values:
        """Inverse dynamics at the acceleration that the errors ask for."""
        q, v = context.inputs["q"], context.inputs["v"]
        error = difference(context.environment.model(self.model), q, context.inputs["q_desired"])
        rate = context.inputs["v_desired"] - v
        a = context.inputs["a_desired"] + context.parameters["kp"] * error + context.parameters["kd"] * rate
        return {"tau": context.call(self.model, "inverse_dynamics", q=q, v=v, a=a, t=context.t)["tau"], "error": error}
