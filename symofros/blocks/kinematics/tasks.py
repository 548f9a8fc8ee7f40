"""What inverse kinematics follows: some rows of a frame's motion, by some coordinates of a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import known_name, refuse
from symofros.blocks.quantities import NO_UNIT, actuated_names, scalar_coordinates, with_units
from symofros.blocks.rotations import error_vector
from symofros.diagrams.block import Environment, EvaluationContext, Port
from symofros.diagrams.tensor import Tensor, joined, solved, stacked

ROWS = ("x", "y", "z", "rx", "ry", "rz")


def rows_of(name: str, rows: object) -> list[int]:
    """Places of rows in a frame's motion (linear; angular), in that order.

    Raises:
        DescriptionError: They are others, or repeated.
    """
    given = list(rows) if isinstance(rows, (list, tuple)) else []
    if not given or len(set(given)) < len(given) or set(given) - set(ROWS) or given != sorted(given, key=ROWS.index):
        raise refuse(
            name,
            "rows",
            repr(rows),
            f"some of {', '.join(ROWS)}, each once, in this order",
            'write for example ("x", "y", "rz")',
        )
    return [ROWS.index(row) for row in given]


@dataclass(frozen=True)
class Chosen:
    """Coordinates that follow a task.

    Attributes:
        names: Their names.
        q: Places in q.
        v: Places in v.
        start: First configuration of the whole model (nq).
        speeds: Number of the model's speeds.
    """

    names: tuple[str, ...]
    q: tuple[int, ...]
    v: tuple[int, ...]
    start: Array
    speeds: int

    @staticmethod
    def of(environment: Environment, block: str, model: str, joints: Sequence[str]) -> Chosen:
        """The named joints; else those that are actuated, or all that have one coordinate.

        Raises:
            DescriptionError: A name is none, or nothing is left to move.
        """
        record = environment.model(model)
        places = scalar_coordinates(record)
        names = list(joints)
        if not names:
            names = [] if record.nc else [name for name in actuated_names(record) if name in places]
            names = names or [name for name in places if "[" not in name]
        for name in names:
            known_name(block, f"joint of one coordinate in model '{model}'", name, places)
        if not names or len(set(names)) < len(names):
            raise refuse(
                block,
                "joints",
                ", ".join(names) or "none",
                "one joint or more, each once",
                "name the joints that follow",
            )
        q, v = zip(*(places[name] for name in names), strict=True)
        return Chosen(tuple(names), q, v, environment.start(model)[0], len(record.v_names))

    def configuration(self, context: EvaluationContext, joints: Tensor) -> Tensor:
        """All of q (nq): the joints, the others where they are first."""
        whole = list(context.numbers(self.start))
        for place, value in zip(self.q, joints, strict=True):
            whole[place] = value
        return joined(whole)

    def speeds_of(self, context: EvaluationContext, joints: Tensor) -> Tensor:
        """All of v or a (nv): that of the joints, zero for the others."""
        whole = list(context.numbers(np.zeros(self.speeds)))
        for place, value in zip(self.v, joints, strict=True):
            whole[place] = value
        return joined(whole)


@dataclass(frozen=True)
class Task:
    """Rows of a frame's motion and, if asked for, a model's closures, which are followed as well.

    Attributes:
        model: The model.
        frame: Frame of the model.
        rows: Places in (linear; angular).
        columns: Places in v of what moves.
        closes: Whether closures count.
        suffix: Suffix of the names of the inputs for the desired motion.
    """

    model: str
    frame: str
    rows: list[int]
    columns: list[int]
    closes: bool = False
    suffix: str = ""

    @property
    def turns(self) -> list[int]:
        """Axes of the rows that are rotations."""
        return [row - 3 for row in self.rows if row > 2]

    def ports(self) -> list[Port]:
        """Inputs for a desired motion: p, angle or R as the rows ask, v and a."""
        linear, turns = sum(row < 3 for row in self.rows), len(self.turns)
        ports = [Port("p", (linear,), "m")] if linear else []
        ports += [Port("angle", (), "rad")] if turns == 1 else [Port("R", (3, 3), NO_UNIT)] if turns else []
        ports += [self.row_port("v", "m/s", "rad/s", 0.0), self.row_port("a", "m/s^2", "rad/s^2", 0.0)]
        return [replace(port, name=port.name + self.suffix) for port in ports]

    def row_port(self, name: str, linear: str, angular: str, default: Any = None) -> Port:
        """A port of one entry a row, in one unit along axes and in another one about them."""
        return with_units(
            Port(name, (len(self.rows),), "", default), [linear if row < 3 else angular for row in self.rows]
        )

    def given(self, context: EvaluationContext, name: str) -> Tensor | None:
        """A desired quantity; None where the rows don't ask for it."""
        return context.inputs.get(name + self.suffix)

    def error(self, context: EvaluationContext, q: Tensor) -> Tensor:
        """Desired minus actual p, and angle or R, at a configuration (nq); then -phi of the closures."""
        pose = context.call(self.model, "frame_pose", self.frame, q=q, t=context.t)
        parts = []
        p, R, angle = (self.given(context, name) for name in ("p", "R", "angle"))
        if p is not None:
            parts.append(p - pose["p"][[row for row in self.rows if row < 3]])
        if R is not None:
            parts.append(error_vector(R, pose["R"])[self.turns])
        if angle is not None:
            parts.append(self._turn(angle, pose["R"]))
        if self.closes:
            parts.append(-context.call(self.model, "constraint", q=q, t=context.t)["phi"])
        return joined(parts)

    def _turn(self, desired: Tensor, R: Tensor) -> Tensor:
        i, j = (self.turns[0] + 1) % 3, (self.turns[0] + 2) % 3
        c, s = desired.apply("cos"), desired.apply("sin")
        # The angle of R is that of its axis i, seen along the axis of rotation.
        x, y = R[i, i], R[j, i]
        return (s * x - c * y).apply("atan2", c * x + s * y)

    def jacobian(self, context: EvaluationContext, q: Tensor) -> Tensor:
        """Rates of the rows, and of the closures, by the columns (rows, columns)."""
        J = context.call(self.model, "frame_jacobian", self.frame, q=q, t=context.t)["J"]
        parts = [J[row] for row in self.rows]
        if self.closes:
            parts += list(context.call(self.model, "constraint_jacobian", q=q, t=context.t)["G"])
        return stacked([part[self.columns] for part in parts])

    def drift(self, context: EvaluationContext, q: Tensor, v: Tensor) -> Tensor:
        """The part of the rows' acceleration that is J' v, and -gamma of the closures."""
        zero = context.numbers(np.zeros(len(v)))
        A = context.call(self.model, "frame_acceleration", self.frame, q=q, v=v, a=zero, t=context.t)["A"]
        parts = [A[self.rows]]
        if self.closes:
            parts.append(-context.call(self.model, "constraint_bias", q=q, v=v, t=context.t)["gamma"])
        return joined(parts)

    def desired(self, context: EvaluationContext, rows: Tensor) -> Tensor:
        """Rates of the rows, zeros for the closures."""
        if not self.closes:
            return rows
        return joined([rows, context.numbers(np.zeros(context.environment.model(self.model).nc))])


def near_singular(J: Tensor, damping: float, near: float) -> tuple[Tensor, Tensor]:
    """The smaller Gram matrix A of J (m, n), and what to add to its diagonal where it is nearly singular.

    With d = 1 / trace((A + damping^2)^-1) - damping^2, which is at most the square of the least singular value of J:
    nothing is added where d >= near^2, and below, smoothly, (1 - d / near^2) damping^2.
    """
    gram = J @ J.T if J.shape[0] <= J.shape[1] else J.T @ J
    full, one = damping * damping, np.eye(len(gram))
    inverse = solved(gram + full * one, Tensor.numbers(J.g, one))
    trace = joined([inverse[i, i] for i in range(len(gram))]).sum()
    least = 1.0 / trace - full
    return gram, full * (1.0 - least / (near * near)).clipped(0.0, 1.0)


def damped(J: Tensor, damping: float, near: float) -> tuple[Tensor, Tensor]:
    """The smaller of J J^T and J^T J, damped where it is nearly singular, and J (m, n) itself, for `resolved`."""
    gram, extra = near_singular(J, damping, near)
    return gram + extra * np.eye(len(gram)), J


def resolved(system: tuple[Tensor, Tensor], rates: Tensor) -> Tensor:
    """Rates of the joints that make some rates of the rows: least, and least wrong."""
    gram, J = system
    m, n = J.shape
    return J.T @ solved(gram, rates) if m <= n else solved(gram, J.T @ rates)
