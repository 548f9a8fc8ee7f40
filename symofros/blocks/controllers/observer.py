"""Forces from outside by the momentum that they bring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import numbers, refuse
from symofros.blocks.quantities import motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Ports, Values
from symofros.diagrams.tensor import Tensor, joined


@dataclass(frozen=True, kw_only=True)
class MomentumObserver(Block):
    """r = K (p - s), s' = F + ad_v^T p + r: forces that a model does not know, a first-order filter of rate K behind.

    p = M v is the momentum, F + ad_v^T p its rate by the model (docs/theory/diagrams.md, (8)). No acceleration
    is asked for. Sampled, r is that filter of the mean force over each period, whatever K is; the rate by the model is
    that at the beginning of the period (8a).

    Attributes:
        model: The model, a tree; its first state is where it begins.
        gain: K, one number or one a speed (nv), above zero [1/s].
    """

    model: str
    gain: Any = 50.0
    tunable: ClassVar[tuple[str, ...]] = ("gain",)

    def __post_init__(self) -> None:
        """Gains above zero."""
        if np.min(numbers(self.name, "gain", self.gain), initial=np.inf) <= 0.0:
            raise refuse(self.name, "gain is out of bounds", self.gain, "above zero", "choose another")

    def ports(self, environment: Environment) -> Ports:
        """Motion q, v and inputs u (the model's defaults where nothing is connected) in; r (nv) out."""
        record = environment.model(self.model)
        if record.nc:
            rule = "forces of constraints are not distinguished from those outside"
            raise refuse(self.name, "a model with constraints", self.model, rule, "take a model of the tree")
        if np.ndim(self.gain):
            numbers(self.name, "gain", self.gain, (len(record.v_names),))
        inputs = motion_port("q", record, "q"), motion_port("v", record, "v")
        return Ports((*inputs, motion_port("u", record, "u", record.u_default)), (motion_port("r", record, "effort"),))

    def states(self, environment: Environment) -> dict[str, Any]:
        """Continuous: s."""
        return {"s": environment.momentum(self.model)} if self.period is None else {}

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Sampled: s."""
        return {} if self.period is None else {"s": environment.momentum(self.model)}

    def compute(self, context: EvaluationContext) -> Values:
        """What the momentum has beyond that expected."""
        return {"r": self._found(context)[0]}

    def rates(self, context: EvaluationContext) -> Values:
        """Continuous: as the model says, and as it was found."""
        if self.period is not None:
            return {}
        r, known = self._found(context)
        return {"s": known + r}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: the same over the period."""
        if self.period is None:
            return {}
        r, known = self._found(context)
        return {"s": context.memory["s"] + self.period * (known + r)}

    def _found(self, context: EvaluationContext) -> tuple[Tensor, Tensor]:
        """R (nv), and the rate of the momentum that the model knows of (nv)."""
        given = {name: context.inputs[name] for name in ("q", "v", "u")}
        of = context.call(self.model, "momentum", t=context.t, **given)
        gain, s = context.parameters["gain"], (context.states if self.period is None else context.memory)["s"]
        if self.period is not None:
            gain = (1.0 - (-self.period * gain).apply("exp")) / self.period
        return gain * (of["p"] - s), of["F"] + _turning(context, self.model, of["p"])


def _turning(context: EvaluationContext, model: str, p: Tensor) -> Tensor:
    """ad_v^T p (nv): how momentum in body axes changes as these turn and move; zero of joints without quaternions."""
    v, parts = context.inputs["v"], []
    for segment in context.environment.model(model).segments:
        at = segment.v
        if segment.kind == "linear":
            parts.append(context.numbers(np.zeros(segment.size)))
            continue
        turn = at + (3 if segment.kind == "pose" else 0)
        w, moment = v[turn : turn + 3], p[turn : turn + 3].cross(v[turn : turn + 3])
        if segment.kind == "pose":
            parts += [p[at : at + 3].cross(w), moment + p[at : at + 3].cross(v[at : at + 3])]
        else:
            parts.append(moment)
    return joined(parts)
