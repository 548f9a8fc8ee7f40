"""Trajectories through points: of joints, and of frames with their orientation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.units import parse
from symofros.blocks.checks import choice, increasing, number, numbers, refuse
from symofros.blocks.inputs.laws import LAWS, Share, moves, spline
from symofros.blocks.quantities import ACCELERATION, NO_UNIT, VELOCITY
from symofros.blocks.rotations import matrix_of_quaternion, matrix_of_vector, quaternion_of_matrix, vector_of_matrix
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor, joined

# Formulas grow with the points; tables over time (`Sequence`) take as many as there are.
MAX_POINTS = 64
SPLINE = "spline"


@dataclass(frozen=True, kw_only=True)
class JointTrajectory(Block):
    """Any coordinates through via points: q(t), v = q', a = q''.

    Attributes:
        points: One a row (k, n); the first is the start.
        times: Time when each is reached (k) [s].
        law: quintic, septic or trapezoidal, which stop at each point, or spline (cubic, at rest at both ends).
        accelerating: Share of a move's time that a trapezoidal law accelerates.
        unit: Unit of the coordinates; "" where they differ.
    """

    points: Any
    times: Any
    law: str = "quintic"
    accelerating: float = 0.25
    unit: str = ""

    def __post_init__(self) -> None:
        """Points at increasing times, and a known law."""
        via_points(self, self.points, self.times, None)
        parse(self.unit)

    def ports(self, environment: Environment) -> Ports:
        """Outputs q, v, a (n)."""
        shape = (np.shape(self.points)[1],)
        v, a = (f"{self.unit}/s", f"{self.unit}/s^2") if self.unit else ("", "")
        return Ports((), (Port("q", shape, self.unit), Port("v", shape, v), Port("a", shape, a)))

    def compute(self, context: EvaluationContext) -> Values:
        """The points, each with its share."""
        points = np.asarray(self.points, dtype=np.float64)
        return dict(zip("qva", _through(context, self.law, self.times, points, self.accelerating), strict=True))


@dataclass(frozen=True, kw_only=True)
class CartesianTrajectory(Block):
    """A frame through via points, in position or in position and orientation.

    The orientation is R = R_0 prod exp(d_k s_k(t)), d_k the rotation vector from one point to the next: between two
    points with stops the turn is about one axis (slerp), with law spline it is smooth through all points. Turns from
    point to point are of less than half a revolution.

    Attributes:
        points: Positions, one a row (k, n), n up to 3 [m].
        times: Time when each is reached (k) [s].
        quaternions: Orientations (k, 4), x y z w, of any length; None: positions only.
        law: quintic, septic or trapezoidal, which stop at each point, or spline (at rest at both ends).
        accelerating: Share of a move's time that a trapezoidal law accelerates.
    """

    points: Any
    times: Any
    quaternions: Any = None
    law: str = "quintic"
    accelerating: float = 0.25

    def __post_init__(self) -> None:
        """Points at increasing times, orientations for all or none, and a known law."""
        count = via_points(self, self.points, self.times, 3)
        if self.quaternions is not None:
            given = numbers(self.name, "quaternions", self.quaternions, (count, 4))
            if np.min(np.linalg.norm(given, axis=1)) < 1e-6:
                raise refuse(self.name, "a quaternion is zero", given, "quaternions have a length", "write 0 0 0 1")
            numbers(self.name, "points", self.points, (count, 3))

    def ports(self, environment: Environment) -> Ports:
        """Outputs p, v, a (n); with orientation R (3, 3), quaternion (4), v and a (6): linear, then angular."""
        n = np.shape(self.points)[1]
        if self.quaternions is None:
            return Ports((), (Port("p", (n,), "m"), Port("v", (n,), "m/s"), Port("a", (n,), "m/s^2")))
        return Ports(
            (),
            (
                Port("p", (3,), "m"),
                Port("R", (3, 3), NO_UNIT),
                Port("quaternion", (4,), NO_UNIT),
                Port("v", (6,), units=VELOCITY),
                Port("a", (6,), units=ACCELERATION),
            ),
        )

    def compute(self, context: EvaluationContext) -> Values:
        """Positions, and turns from point to point."""
        points = np.asarray(self.points, dtype=np.float64)
        p, v, a = _through(context, self.law, self.times, points, self.accelerating)
        if self.quaternions is None:
            return {"p": p, "v": v, "a": a}
        R, w, alpha = self._orientation(context)
        return {"p": p, "R": R, "quaternion": quaternion_of_matrix(R), "v": joined([v, w]), "a": joined([a, alpha])}

    def _orientation(self, context: EvaluationContext) -> tuple[Tensor, Tensor, Tensor]:
        """R, and w and alpha in world axes.

        With E = exp(d s): R E turns at w_b' = E^T w_b + d s', alpha_b' = E^T alpha_b - d s' x E^T w_b + d s''.
        """
        quaternions = [context.numbers(row) for row in np.asarray(self.quaternions, dtype=np.float64)]
        matrices = [matrix_of_quaternion(one) for one in quaternions]
        shares = _cumulative(context, self.law, self.times, self.accelerating)
        R, w, alpha = matrices[0], context.numbers(np.zeros(3)), context.numbers(np.zeros(3))
        for k, (before, after) in enumerate(zip(matrices, matrices[1:], strict=False)):
            d = vector_of_matrix(before.T @ after)
            E = matrix_of_vector(d * shares.s[k])
            spin, turned = d * shares.rate[k], E.T @ w
            w, alpha = turned + spin, E.T @ alpha - spin.cross(turned) + d * shares.acceleration[k]
            R = R @ E
        return R, R @ w, R @ alpha


def via_points(block: Any, points: Any, times: Any, most: int | None) -> int:
    """The number of points of a trajectory, once its fields are found right.

    Raises:
        DescriptionError: They are not.
    """
    choice(block.name, "law", block.law, [*LAWS, SPLINE])
    number(block.name, "accelerating", block.accelerating, 0.0, 0.5, exclusive=True)
    given = increasing(block.name, "times", times)
    array = numbers(block.name, "points", points, (len(given), None))
    if len(array) > MAX_POINTS:
        raise refuse(block.name, "too many points", len(array), f"at most {MAX_POINTS}", "use a Sequence over time")
    if not array.shape[1] or (most is not None and array.shape[1] > most):
        raise refuse(
            block.name,
            "points have the wrong size",
            array.shape,
            f"rows of 1 to {most or 'any'} numbers",
            "mend the rows",
        )
    return len(array)


def _through(
    context: EvaluationContext, law: str, times: Any, points: Array, accelerating: float
) -> tuple[Tensor, Tensor, Tensor]:
    """Position, speed, acceleration along some points (n)."""
    if law == SPLINE:
        return tuple(spline(context.t, np.asarray(times, dtype=np.float64), points))  # type: ignore[return-value]
    share, steps = _cumulative(context, law, times, accelerating), np.diff(points, axis=0)
    return share.s @ steps + points[0], share.rate @ steps, share.acceleration @ steps


def _cumulative(context: EvaluationContext, law: str, times: Sequence[float], accelerating: float) -> Share:
    """Share of the way from each point to the next that is covered (k - 1)."""
    knots = np.asarray(times, dtype=np.float64)
    if law == SPLINE:
        return spline(context.t, knots, np.tri(len(knots), len(knots) - 1, -1))
    return moves(context.t, law, knots[:-1], np.diff(knots), accelerating)
