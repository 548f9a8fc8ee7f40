"""What is known of a mechanism's forces, fed forward: friction and gravity (sections 6.1 and 8 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import numbers
from symofros.blocks.dynamics import friction
from symofros.blocks.quantities import joint_units
from symofros.diagrams.block import At, Block, Known, Port, Ports, Values


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

    def ports(self, known: Known) -> Ports:
        """Motion q, v in; effort (nv) out, zero where there is no friction."""
        q, v, _, effort = joint_units(known.model(self.model))
        record = known.model(self.model)
        nv = len(record.v_names)
        if np.ndim(self.factor):
            numbers(self.name, "factor", self.factor, (nv,))
        return Ports((Port("q", (len(record.q_names),), q), Port("v", (nv,), v)), (Port("effort", (nv,), effort),))

    def compute(self, at: At) -> Values:
        """The opposite of the friction."""
        return {"effort": -at.parameters["factor"] * friction(at, self.model, at.inputs["q"], at.inputs["v"])}


@dataclass(frozen=True, kw_only=True)
class GravityCompensation(Block):
    """Efforts that hold a model still: tau = h(q, 0) - Q(q, 0, 0), gravity and springs.

    Attributes:
        model: The model.
    """

    model: str

    def ports(self, known: Known) -> Ports:
        """Configuration q in; effort (nv) out."""
        record = known.model(self.model)
        q, _, _, effort = joint_units(record)
        return Ports((Port("q", (len(record.q_names),), q),), (Port("effort", (len(record.v_names),), effort),))

    def compute(self, at: At) -> Values:
        """Inverse dynamics at rest."""
        rest = at.numbers(np.zeros(len(at.known.model(self.model).v_names)))
        tau = at.call(self.model, "inverse_dynamics", q=at.inputs["q"], v=rest, a=rest, t=at.t)["tau"]
        return {"effort": tau}
