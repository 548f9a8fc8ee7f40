"""Derivatives of a frame's pose, velocity and acceleration (docs/theory/linear.md, eq. 7)."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.graph import Edge
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.derivatives import Matrix, by_configuration, by_inputs
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.topology.tree import NamedFrame


def frame_derivatives(
    frames: FrameKinematics, frame: NamedFrame, v_rate: Sequence[Edge], inputs: int
) -> dict[str, tuple[int, Matrix]]:
    """Name -> (columns, 6 rows), in world axes: the linear part first.

    Args:
        frames: Of the tree.
        frame: Which.
        v_rate: The speeds' rates (nv).
        inputs: How many there are; those of prescribed motions move the frame.
    """
    motion, nv = frames.motion, frames.motion.nv
    pose = frames.pose(frame)
    place = [*pose.p, *pose.R.entries]
    velocity, acceleration = frames.velocity(frame), frames.acceleration(frame, v_rate)
    return {
        "pose_by_q": (nv, _small_motion(pose.R, by_configuration(motion, place), nv)),
        "pose_by_u": (inputs, _small_motion(pose.R, by_inputs(motion, place, "u", inputs), inputs)),
        "velocity_by_q": (nv, by_configuration(motion, velocity)),
        "velocity_by_v": (nv, frames.jacobian(frame)),
        "velocity_by_u": (inputs, by_inputs(motion, velocity, "u", inputs)),
        "acceleration_by_q": (nv, by_configuration(motion, acceleration)),
        "acceleration_by_v": (nv, by_inputs(motion, acceleration, "v", nv)),
        "acceleration_by_u": (inputs, by_inputs(motion, acceleration, "u", inputs)),
    }


def _small_motion(R: Mat3, change: Matrix, columns: int) -> Matrix:
    """Changes of p and of R's entries -> (dp; the small rotation whose cross product is dR R^T)."""
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
