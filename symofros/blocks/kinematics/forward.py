"""Direct kinematics: where frames are and how they move; their Jacobians (section 6.1 of the paper)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from symofros.blocks.checks import refuse
from symofros.blocks.quantities import ACCELERATION, NO_UNIT, VELOCITY, Quantity, motion_port
from symofros.blocks.rotations import quaternion_of_matrix
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, stacked


def _motion_ports(environment: Environment, model: str, names: Sequence[Quantity]) -> tuple[Port, ...]:
    """Inputs q, v, a of a model, rates zero where nothing is connected."""
    record = environment.model(model)
    return tuple(motion_port(name, record, name, None if name == "q" else 0.0) for name in names)


def _frame_ports(*count: int) -> tuple[Port, ...]:
    """Outputs of `_frame_motion`, of one frame or of a count of them."""
    return (
        Port("p", (*count, 3), "m"),
        Port("R", (*count, 3, 3), NO_UNIT),
        Port("quaternion", (*count, 4), NO_UNIT),
        Port("velocity", (*count, 6), units=VELOCITY),
        Port("acceleration", (*count, 6), units=ACCELERATION),
    )


def _frame_motion(context: EvaluationContext, model: str, frame: str) -> dict[str, Tensor]:
    q, v, a = (context.inputs[name] for name in "qva")
    pose = context.call(model, "frame_pose", frame, q=q, t=context.t)
    V = context.call(model, "frame_velocity", frame, q=q, v=v, t=context.t)["V"]
    A = context.call(model, "frame_acceleration", frame, q=q, v=v, a=a, t=context.t)["A"]
    return {
        "p": pose["p"],
        "R": pose["R"],
        "quaternion": quaternion_of_matrix(pose["R"]),
        "velocity": V,
        "acceleration": A,
    }


@dataclass(frozen=True, kw_only=True)
class ForwardKinematics(Block):
    """Pose, velocity and acceleration of a frame: p, R, J v, J a + J' v.

    Attributes:
        model: The model.
        frame: Frame of the model.
    """

    model: str
    frame: str

    def ports(self, environment: Environment) -> Ports:
        """Motion q, v, a in; p (3), R (3, 3), quaternion (4), velocity and acceleration (6), linear first, out."""
        environment.frame(self.model, self.frame)
        return Ports(_motion_ports(environment, self.model, ("q", "v", "a")), _frame_ports())

    def compute(self, context: EvaluationContext) -> Values:
        """Pose and motion of the frame, by the model's generated functions."""
        return _frame_motion(context, self.model, self.frame)


@dataclass(frozen=True, kw_only=True)
class Extremities(Block):
    """Poses, velocities and accelerations of several frames at once.

    Attributes:
        model: The model.
        frames: Names of the frames; none: all of the model's but the world's.
    """

    model: str
    frames: Any = ()

    def _frames(self, environment: Environment) -> list[str]:
        chosen = list(self.frames) or [name for name in environment.model(self.model).frame_names if name != "world"]
        if not chosen:
            raise refuse(self.name, "no frames", f"model '{self.model}'", "a model with frames", "add a frame")
        return [environment.frame(self.model, name) for name in chosen]

    def ports(self, environment: Environment) -> Ports:
        """Motion in; p (k, 3), R (k, 3, 3), quaternion (k, 4), velocity and acceleration (k, 6) out."""
        k = len(self._frames(environment))
        return Ports(_motion_ports(environment, self.model, ("q", "v", "a")), _frame_ports(k))

    def compute(self, context: EvaluationContext) -> Values:
        """Motions of all frames, stacked in their order; common subexpressions are computed once."""
        motions = [_frame_motion(context, self.model, frame) for frame in self._frames(context.environment)]
        return {key: stacked([motion[key] for motion in motions]) for key in motions[0]}


@dataclass(frozen=True, kw_only=True)
class Jacobian(Block):
    """J and J' of a frame, in translation and rotation: J v is its velocity (linear; angular), world axes.

    Attributes:
        model: The model.
        frame: Frame of the model.
    """

    model: str
    frame: str

    def ports(self, environment: Environment) -> Ports:
        """Motion q, v in; J, rate (6, nv); translation and rotation are rows 0 to 2 and 3 to 5 of J (3, nv)."""
        environment.frame(self.model, self.frame)
        nv = len(environment.model(self.model).v_names)
        return Ports(
            _motion_ports(environment, self.model, ("q", "v")),
            (
                Port("J", (6, nv)),
                Port("rate", (6, nv)),
                Port("translation", (3, nv)),
                Port("rotation", (3, nv)),
            ),
        )

    def compute(self, context: EvaluationContext) -> Values:
        """Frame Jacobian and its time derivative by the model's generated functions; also its two halves."""
        q, v = context.inputs["q"], context.inputs["v"]
        J = context.call(self.model, "frame_jacobian", self.frame, q=q, t=context.t)["J"]
        rate = context.call(self.model, "frame_jacobian_rate", self.frame, q=q, v=v, t=context.t)["dJ"]
        return {"J": J, "rate": rate, "translation": J[:3], "rotation": J[3:]}
