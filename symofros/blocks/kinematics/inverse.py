"""Inverse kinematics: the joints' motion that a frame's takes (sections 6.1 and 8 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from symofros.blocks.checks import number, whole
from symofros.blocks.kinematics.tasks import Chosen, Task, damped, resolved, rows_of
from symofros.blocks.quantities import motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Ports, Values
from symofros.diagrams.tensor import Tensor


@dataclass(frozen=True, kw_only=True)
class InverseKinematics(Block):
    """Joint motion q, v, a of a frame's desired motion, by resolved rates with damped least squares.

    Sampled, each sample starts from the q of the one before and takes Newton steps q += J^+ e, so that nothing drifts;
    then v = J^+ v_d and a = J^+ (a_d - J' v). Continuous, q is a state with q' = v = J^+ (v_d + K e), and
    a = J^+ (a_d + K (v_d - J v) - J' v), of orientations to first order in e.

    J^+ is exact away from singular postures and damped near them. Closures of the model are rows of the task with
    nothing desired. Joints that don't follow stay where the model has them first, at rest: passive and elastic ones of
    a control model, and free bases.

    Attributes:
        model: The model.
        frame: Frame of the model.
        rows: What to follow: some of x, y, z (world axes) and rx, ry, rz (rotation about them), in this order. One
            rotation is followed by an angle, several by a matrix R.
        joints: Names of coordinates that move; none: the actuated ones, or, of a model with closures or without named
            actuators, all that have one coordinate.
        steps: Newton steps at a sample.
        gain: K, of the continuous form [1/s].
        damping: Damping of the rates near singular postures [m/rad, or 1].
        near: Below which least singular value of J, about, a posture is nearly singular [m/rad, or 1].
        stride: Most that a joint moves in a Newton step, in proportion with the others [rad or m].
    """

    model: str
    frame: str
    rows: Any = ("x", "y", "z")
    joints: Any = ()
    steps: int = 3
    gain: float = 20.0
    damping: float = 0.02
    near: float = 0.02
    stride: float = 0.2

    def __post_init__(self) -> None:
        """Known rows, and numbers within bounds."""
        rows_of(self.name, self.rows)
        whole(self.name, "steps", self.steps, 1, 20)
        number(self.name, "gain", self.gain, 0.0)
        for field in ("damping", "near", "stride"):
            number(self.name, field, getattr(self, field), 0.0, exclusive=True)

    def _chosen(self, environment: Environment) -> Chosen:
        return Chosen.of(environment, self.name, self.model, self.joints)

    def _task(self, environment: Environment) -> Task:
        frame, columns = environment.frame(self.model, self.frame), list(self._chosen(environment).v)
        return Task(self.model, frame, rows_of(self.name, self.rows), columns, bool(environment.model(self.model).nc))

    def ports(self, environment: Environment) -> Ports:
        """Desired p, angle or R as the rows ask, v and a of the rows; out q (nq), v, a (nv), error of the rows."""
        task, record = self._task(environment), environment.model(self.model)
        motion = (motion_port(name, record, name) for name in ("q", "v", "a"))
        return Ports(tuple(task.ports()), (*motion, task.row_port("error", "m", "rad")))

    def _first(self, environment: Environment) -> dict[str, Any]:
        chosen = self._chosen(environment)
        return {"joints": chosen.start[list(chosen.q)]}

    def states(self, environment: Environment) -> dict[str, Any]:
        """Continuous: the joints."""
        return self._first(environment) if self.period is None else {}

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Sampled: the joints at the sample before."""
        return {} if self.period is None else self._first(environment)

    def _placed(self, context: EvaluationContext) -> Tensor:
        """Joints at which the frame is where it should be."""
        if self.period is None:
            return context.states["joints"]
        task, chosen = self._task(context.environment), self._chosen(context.environment)
        joints = context.memory["joints"]
        for _ in range(self.steps):
            q = chosen.configuration(context, joints)
            step = resolved(damped(task.jacobian(context, q), self.damping, self.near), task.error(context, q))
            largest = context.numbers(self.stride)
            for entry in step:
                largest = largest.apply("max", entry.apply("abs"))
            joints = joints + step * (self.stride / largest)
        return joints

    def _moved(self, context: EvaluationContext, joints: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Rates and accelerations of the joints, and the residual of the task without the closures."""
        task, chosen = self._task(context.environment), self._chosen(context.environment)
        q = chosen.configuration(context, joints)
        J, error = task.jacobian(context, q), task.error(context, q)
        system = damped(J, self.damping, self.near)
        rates, accelerations = task.desired(context, context.inputs["v"]), task.desired(context, context.inputs["a"])
        gain = self.gain if self.period is None else 0.0
        v = resolved(system, rates + gain * error)
        drift = task.drift(context, q, chosen.speeds_of(context, v))
        a = resolved(system, accelerations + gain * (rates - J @ v) - drift)
        return v, a, error[: len(task.rows)]

    def compute(self, context: EvaluationContext) -> Values:
        """Position first, then rates there."""
        chosen, joints = self._chosen(context.environment), self._placed(context)
        v, a, error = self._moved(context, joints)
        return {
            "q": chosen.configuration(context, joints),
            "v": chosen.speeds_of(context, v),
            "a": chosen.speeds_of(context, a),
            "error": error,
        }

    def rates(self, context: EvaluationContext) -> Values:
        """Time derivatives of the joint coordinates, which are the state of the continuous block; none if sampled."""
        return {"joints": self._moved(context, context.states["joints"])[0]} if self.period is None else {}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: the joint coordinates found, from which the next sample iterates."""
        return {} if self.period is None else {"joints": self._placed(context)}
