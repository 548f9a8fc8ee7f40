"""What inverse kinematics follows: some rows of a frame's motion, by some coordinates of a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symofros.blocks.checks import known_name, refuse
from symofros.blocks.quantities import actuated_names, scalar_coordinates
from symofros.blocks.rotations import error_vector
from symofros.diagrams.block import At, Known
from symofros.diagrams.tensor import Tensor, joined, solved, stacked
from symofros.runtime.kernel import Array

ROWS = ("x", "y", "z", "rx", "ry", "rz")


def rows_of(name: str, rows: object) -> list[int]:
    """Places of rows in a frame's motion (linear; angular), in that order.

    Raises:
        DescriptionError: They are others, or repeated.
    """
    given = list(rows) if isinstance(rows, (list, tuple)) else []
    if not given or len(set(given)) < len(given) or set(given) - set(ROWS) or given != sorted(given, key=ROWS.index):
        raise refuse(name, "rows", repr(rows), f"some of {', '.join(ROWS)}, each once, in this order",
                     'write for example ("x", "y", "rz")')  # fmt: skip
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
    def of(known: Known, block: str, model: str, joints: Sequence[str]) -> Chosen:
        """The named joints; else those that are actuated, or all that have one coordinate.

        Raises:
            DescriptionError: A name is none, or nothing is left to move.
        """
        record = known.model(model)
        places = scalar_coordinates(record)
        names = list(joints)
        if not names:
            names = [] if record.nc else [name for name in actuated_names(record) if name in places]
            names = names or [name for name in places if "[" not in name]
        for name in names:
            known_name(block, f"joint of one coordinate in model '{model}'", name, places)
        if not names or len(set(names)) < len(names):
            raise refuse(block, "joints", ", ".join(names) or "none", "one joint or more, each once",
                         "name the joints that follow")  # fmt: skip
        q, v = zip(*(places[name] for name in names), strict=True)
        return Chosen(tuple(names), q, v, known.start(model)[0], len(record.v_names))

    def configuration(self, at: At, joints: Tensor) -> Tensor:
        """All of q (nq): the joints, the others where they are first."""
        whole = list(at.numbers(self.start))
        for place, value in zip(self.q, joints, strict=True):
            whole[place] = value
        return joined(whole)

    def speeds_of(self, at: At, joints: Tensor) -> Tensor:
        """All of v or a (nv): that of the joints, zero for the others."""
        whole = list(at.numbers(np.zeros(self.speeds)))
        for place, value in zip(self.v, joints, strict=True):
            whole[place] = value
        return joined(whole)


@dataclass(frozen=True)
class Task:
    """Rows of a frame's motion, and a model's closures, which are followed as well.

    Attributes:
        model: The model.
        frame: Its frame.
        rows: Places in (linear; angular).
        chosen: What follows.
    """

    model: str
    frame: str
    rows: list[int]
    chosen: Chosen

    @property
    def turns(self) -> list[int]:
        """Axes of the rows that are rotations."""
        return [row - 3 for row in self.rows if row > 2]

    def error(self, at: At, q: Tensor, p: Tensor | None, orientation: Tensor | None) -> Tensor:
        """What is missing: of the rows, then -phi of the closures.

        Args:
            at: Where.
            q: Configuration (nq).
            p: Desired position, of the linear rows.
            orientation: Desired R (3, 3), or the angle [rad] about the axis of a single rotation.
        """
        pose = at.call(self.model, "frame_pose", self.frame, q=q, t=at.t)
        parts = []
        if p is not None:
            parts.append(p - pose["p"][[row for row in self.rows if row < 3]])
        if orientation is not None:
            parts.append(self._turn(orientation, pose["R"]))
        if at.known.model(self.model).nc:
            parts.append(-at.call(self.model, "constraint", q=q, t=at.t)["phi"])
        return joined(parts)

    def _turn(self, desired: Tensor, R: Tensor) -> Tensor:
        if desired.shape:
            return error_vector(desired, R)[self.turns]
        i, j = (self.turns[0] + 1) % 3, (self.turns[0] + 2) % 3
        c, s = desired.apply("cos"), desired.apply("sin")
        # The angle of R is that of its axis i, seen along the axis of rotation.
        x, y = R[i, i], R[j, i]
        return joined([(s * x - c * y).apply("atan2", c * x + s * y)])

    def jacobian(self, at: At, q: Tensor) -> Tensor:
        """Rates of the rows, and of the closures, by the joints (rows, joints)."""
        J = at.call(self.model, "frame_jacobian", self.frame, q=q, t=at.t)["J"]
        parts = [J[row] for row in self.rows]
        if at.known.model(self.model).nc:
            parts += list(at.call(self.model, "constraint_jacobian", q=q, t=at.t)["G"])
        return stacked([part[list(self.chosen.v)] for part in parts])

    def drift(self, at: At, q: Tensor, v: Tensor) -> Tensor:
        """The part of the rows' acceleration that is J' v, and -gamma of the closures."""
        zero = at.numbers(np.zeros(self.chosen.speeds))
        A = at.call(self.model, "frame_acceleration", self.frame, q=q, v=v, a=zero, t=at.t)["A"]
        parts = [A[self.rows]]
        if at.known.model(self.model).nc:
            parts.append(-at.call(self.model, "constraint_bias", q=q, v=v, t=at.t)["gamma"])
        return joined(parts)

    def desired(self, at: At, rows: Tensor) -> Tensor:
        """Rates of the rows, zeros for the closures."""
        return joined([rows, at.numbers(np.zeros(at.known.model(self.model).nc))])


def damped(J: Tensor, damping: float, near: float) -> tuple[Tensor, Tensor]:
    """What `resolved` needs of J (m, n): its smaller Gram matrix, damped where it is nearly singular, and J.

    The smallest pivot d of J J^T (or J^T J) + damping^2 tells: damping is left out where d - damping^2 >= near^2, and
    comes in smoothly below, as (1 - (d - damping^2) / near^2) damping^2.
    """
    m, n = J.shape
    gram = J @ J.T if m <= n else J.T @ J
    size = len(gram)
    full = damping * damping
    smallest = _smallest_pivot(gram + full * np.eye(size))
    share = (1.0 - (smallest - full) / (near * near)).clipped(0.0, 1.0)
    return gram + (full * share) * np.eye(size), J


def resolved(system: tuple[Tensor, Tensor], rates: Tensor) -> Tensor:
    """Rates of the joints that make some rates of the rows: least, and least wrong."""
    gram, J = system
    m, n = J.shape
    return J.T @ solved(gram, rates) if m <= n else solved(gram, J.T @ rates)


def _smallest_pivot(A: Tensor) -> Tensor:
    """Of the elimination of a symmetric, positive definite matrix."""
    n = len(A)
    rows = [[A[i, j] for j in range(n)] for i in range(n)]
    smallest = rows[0][0]
    for k in range(n):
        smallest = smallest.apply("min", rows[k][k])
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            for j in range(k + 1, n):
                rows[i][j] = rows[i][j] - factor * rows[k][j]
    return smallest
