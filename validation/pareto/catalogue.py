"""The problems, in the order of the report."""

from __future__ import annotations

from .problem import BenchmarkProblem
from .problems import andrews, arm, four_bar, pendulum, robot, soft_pendulum, spin_up, walls

PROBLEMS: dict[str, BenchmarkProblem] = {
    "spin_up": spin_up.PROBLEM,
    "robot": robot.PROBLEM,
    "soft_pendulum": soft_pendulum.PROBLEM,
    "arm": arm.PROBLEM,
    "four_bar": four_bar.PROBLEM,
    "andrews": andrews.PROBLEM,
    "pendulum": pendulum.PROBLEM,
    "walls": walls.PROBLEM,
}
