"""Controllers (section 6.2 of the paper): joint PD and what goes with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from symofros.diagrams.block import At, Block, Known, Port, Ports, Values


@dataclass(frozen=True, kw_only=True)
class JointPD(Block):
    """Efforts kp (q_d - q) + kd (v_d - v), entry by entry.

    Attributes:
        kp: Of each joint, or one for all [N m/rad].
        kd: Likewise [N m s/rad].
    """

    kp: Any
    kd: Any
    tunable: ClassVar[tuple[str, ...]] = ("kp", "kd")

    def ports(self, known: Known) -> Ports:
        """Desired and actual motion of one size; the effort alike."""
        size = known.inputs.get("q", known.inputs.get("q_desired"))
        inputs = (Port("q_desired", size), Port("v_desired", size, "", 0.0), Port("q", size), Port("v", size))
        return Ports(inputs, (Port("effort", size),))

    def compute(self, at: At) -> Values:
        """Proportional and derivative terms."""
        error, rate = (at.inputs[f"{name}_desired"] - at.inputs[name] for name in ("q", "v"))
        return {"effort": at.parameters["kp"] * error + at.parameters["kd"] * rate}
