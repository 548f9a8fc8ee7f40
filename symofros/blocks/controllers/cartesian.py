"""Control of a frame in space: linear control, and feedback of its dynamics (section 6.1 of the paper)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import number, numbers, refuse
from symofros.blocks.kinematics.tasks import Task, near_singular, rows_of
from symofros.blocks.quantities import motion_port
from symofros.diagrams.block import Block, Environment, EvaluationContext, Ports, Values
from symofros.diagrams.tensor import Tensor, solved, stacked


@dataclass(frozen=True, kw_only=True)
class _Cartesian(Block):
    """A frame of a model, rows of its motion, and gains of them."""

    model: str
    frame: str
    rows: Any = ("x", "y", "z")

    def __post_init__(self) -> None:
        """Known rows, gains one or one a row."""
        size = len(rows_of(self.name, self.rows))
        for field in self.tunable:
            value = getattr(self, field)
            numbers(self.name, field, value, (size,) if np.ndim(value) else ())

    def _task(self, environment: Environment) -> Task:
        columns = list(range(len(environment.model(self.model).v_names)))
        frame, rows = environment.frame(self.model, self.frame), rows_of(self.name, self.rows)
        return Task(self.model, frame, rows, columns, suffix="_desired")

    def _ports(self, environment: Environment, result: str) -> Ports:
        record, task = environment.model(self.model), self._task(environment)
        inputs = (*task.ports(), motion_port("q", record, "q"), motion_port("v", record, "v"))
        wrench, error = task.row_port("wrench", "N", "N m"), task.row_port("error", "m", "rad")
        return Ports(inputs, (motion_port(result, record, "effort"), wrench, error))


@dataclass(frozen=True, kw_only=True)
class CartesianLinear(_Cartesian):
    """Springs and dampers between a frame and where it should be: tau = J^T (stiffness e + damping e').

    Compensate gravity and friction beside it.

    Attributes:
        model: The model.
        frame: Frame of the model.
        rows: Rows of its motion, as in `InverseKinematics`.
        stiffness: One, or one a row [N/m, N m/rad].
        damping: Damping of each row [N s/m, N m s/rad].
    """

    stiffness: Any
    damping: Any
    tunable: ClassVar[tuple[str, ...]] = ("stiffness", "damping")

    def ports(self, environment: Environment) -> Ports:
        """Desired p, angle or R, v; actual q, v in; effort (nv), wrench and error of the rows out."""
        ports = self._ports(environment, "effort")
        return Ports(tuple(port for port in ports.inputs if port.name != "a_desired"), ports.outputs)

    def compute(self, context: EvaluationContext) -> Values:
        """The wrench, and the efforts that make it."""
        task, q = self._task(context.environment), context.inputs["q"]
        J, error = task.jacobian(context, q), task.error(context, q)
        rate = context.inputs["v_desired"] - J @ context.inputs["v"]
        wrench = context.parameters["stiffness"] * error + context.parameters["damping"] * rate
        return {"effort": J.T @ wrench, "wrench": wrench, "error": error}


@dataclass(frozen=True, kw_only=True)
class CartesianFeedback(_Cartesian):
    """Operational space control: the frame moves as e'' + kd e' + kp e = 0.

    tau = J^T F + N^T tau_0 + h - Q(q, v, 0), F = L (a_d + kd e' + kp e - J' v), L = (J M^-1 J^T)^-1, where
    tau_0 = -idle M v slows what the task leaves free and N^T = 1 - J^T L J M^-1 keeps it out of the task. O. Khatib,
    A unified approach for motion and force control of robot manipulators, IEEE J. Robotics and Automation 3 (1987).

    Attributes:
        model: The model; it has no closures.
        frame: Frame of the model.
        rows: Rows of its motion, as in `InverseKinematics`.
        kp: One, or one a row [1/s^2].
        kd: Derivative gain of each row, or one for all [1/s].
        idle: Damping of motion that the task leaves free [1/s].
        regular: Added to L^-1 where J is nearly singular, relative to its mean diagonal.
        near: Below which least singular value of J, about, a posture is nearly singular [m/rad, or 1].
    """

    kp: Any
    kd: Any
    idle: float = 1.0
    regular: float = 1e-3
    near: float = 0.02
    tunable: ClassVar[tuple[str, ...]] = ("kp", "kd")

    def __post_init__(self) -> None:
        """Gains, and numbers within bounds."""
        super().__post_init__()
        number(self.name, "idle", self.idle, 0.0)
        number(self.name, "regular", self.regular, 0.0)
        number(self.name, "near", self.near, 0.0, exclusive=True)

    def ports(self, environment: Environment) -> Ports:
        """Desired p, angle or R, v, a; actual q, v in; tau (nv), wrench and error of the rows out."""
        record = environment.model(self.model)
        if record.nc:
            raise refuse(
                self.name,
                "a model with constraints",
                f"model '{self.model}', {record.nc} conditions",
                "feedback of dynamics is for trees of joints",
                "use CartesianLinear, or a model without",
            )
        return self._ports(environment, "tau")

    def compute(self, context: EvaluationContext) -> Values:
        """Inverse dynamics of the frame."""
        task, q, v = self._task(context.environment), context.inputs["q"], context.inputs["v"]
        J, error = task.jacobian(context, q), task.error(context, q)
        x = (
            context.inputs["a_desired"]
            + context.parameters["kd"] * (context.inputs["v_desired"] - J @ v)
            + context.parameters["kp"] * error
        )
        M = context.call(self.model, "mass_matrix", q=q, t=context.t)["M"]
        mobility = self._regular(J, J @ stacked([context.solved(M, row) for row in J]).T)
        idle = -self.idle * v
        F = solved(mobility, x - task.drift(context, q, v) - J @ idle)
        at_rest = context.numbers(np.zeros(len(v)))
        bias = context.call(self.model, "inverse_dynamics", q=q, v=v, a=at_rest, t=context.t)["tau"]
        return {"tau": J.T @ F + M @ idle + bias, "wrench": F, "error": error}

    def _regular(self, J: Tensor, mobility: Tensor) -> Tensor:
        m = len(mobility)
        share = near_singular(J, self.near, self.near)[1] / (self.near * self.near)
        mean = _diagonal(mobility).sum() / float(m)
        return mobility + (self.regular * share * mean) * np.eye(m)


def _diagonal(A: Tensor) -> Tensor:
    return Tensor(A.g, A.edges.diagonal().copy())
