"""The quantities of one frame, each formed when it is first needed: `symofros/base/functions.py` names them."""

from __future__ import annotations

from functools import cached_property

from symofros.expr.edges import Edge
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.derivatives.differentiation import Matrix
from symofros.mechanics.dynamics.derivatives.hessians import hessian, stacked
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.kinematics.frames import Pose
from symofros.mechanics.topology.tree import NamedFrame


class FrameEquations:
    """Pose, velocity, acceleration of one frame and their derivatives, in world axes, linear part first.

    Args:
        equations: Equations of the tree, whose graph holds the results.
        frame: The frame.
    """

    def __init__(self, equations: Equations, frame: NamedFrame) -> None:
        self._equations, self._frames, self._frame = equations, equations.frames, frame

    @cached_property
    def _pose(self) -> Pose:
        return self._frames.pose(self._frame)

    @property
    def p(self) -> Vec3:
        """Position p_WF of the frame's origin (3)."""
        return self._pose.p_WF

    @property
    def R(self) -> tuple[Edge, ...]:
        """Rotation R_WF, row by row (9)."""
        return self._pose.R_WF.entries

    @cached_property
    def velocity(self) -> list[Edge]:
        """Velocity of the origin, then angular velocity (6)."""
        return self._frames.velocity(self._frame)

    @cached_property
    def acceleration(self) -> list[Edge]:
        """Rate of `velocity` at v' = a (6)."""
        return self._frames.acceleration(self._frame, self._equations.v_rate)

    @cached_property
    def jacobian(self) -> Matrix:
        """Jacobian J with velocity = J v + contribution of prescribed motions (6 x nv)."""
        return self._frames.jacobian(self._frame)

    @cached_property
    def jacobian_rate(self) -> Matrix:
        """Rate of the Jacobian (6 x nv)."""
        return self._frames.jacobian_rate(self._frame)

    # Derivatives: docs/theory/linear.md, eq. 7.

    @property
    def _placement(self) -> list[Edge]:
        return [*self.p, *self.R]

    @cached_property
    def pose_by_q(self) -> Matrix:
        """Change of the origin and small rotation, by q (6 x nv)."""
        return _small_motion(self._pose.R_WF, self._equations.by_q(self._placement), self._equations.nv)

    @cached_property
    def position_by_par(self) -> Matrix:
        """Derivative of the origin by the run-time parameters (3 x npar)."""
        return self._equations.by_par(list(self.p))

    @cached_property
    def position_hessian(self) -> Matrix:
        """Second derivatives of p_WF_bar . p_WF by (q, par) (nv + npar x nv + npar)."""
        e, by = self._equations, ("q", "par")
        weights = [e.g.input("p_WF_bar", k) for k in range(3)]
        return stacked(hessian(e.kinematics, list(self.p), weights, by), by, by)

    @cached_property
    def pose_by_u(self) -> Matrix:
        """Change of the origin and small rotation, by u (6 x nu)."""
        return _small_motion(self._pose.R_WF, self._equations.by_u(self._placement), self._equations.nu)

    @cached_property
    def velocity_by_q(self) -> Matrix:
        """Derivative of `velocity` by q (6 x nv)."""
        return self._equations.by_q(self.velocity)

    @cached_property
    def velocity_by_u(self) -> Matrix:
        """Derivative of `velocity` by u (6 x nu)."""
        return self._equations.by_u(self.velocity)

    @cached_property
    def acceleration_by_q(self) -> Matrix:
        """Derivative of `acceleration` by q (6 x nv)."""
        return self._equations.by_q(self.acceleration)

    @cached_property
    def acceleration_by_v(self) -> Matrix:
        """Derivative of `acceleration` by v (6 x nv)."""
        return self._equations.by_v(self.acceleration)

    @cached_property
    def acceleration_by_u(self) -> Matrix:
        """Derivative of `acceleration` by u (6 x nu)."""
        return self._equations.by_u(self.acceleration)


def _small_motion(R: Mat3, change: Matrix, columns: int) -> Matrix:
    """Changes of p and of R's entries -> (dp; the small rotation whose cross product is dR R^T).

    Args:
        R: Rotation R_WF.
        change: Derivatives of p and of the entries of R, row by row (12 x columns).
        columns: Number of columns.

    Returns:
        (6 x columns).
    """
    rows: Matrix = [list(row) for row in change[:3]] + [[], [], []]
    half = R.g.constant(0.5)
    for k in range(columns):
        dR = Mat3(R.g, tuple(change[3 + i][k] for i in range(9)))
        # dR R^T = [w]: each column of R turns by w x column, so the sum of column x change is 2 w.
        turn = Vec3(R.g)
        for j in range(3):
            turn = turn + R.column(j).cross(dR.column(j))
        for row, edge in zip(rows[3:], turn.scaled(half), strict=True):
            row.append(edge)
    return rows
