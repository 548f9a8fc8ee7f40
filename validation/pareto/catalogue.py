"""The scenes, in the order of the report."""

from __future__ import annotations

from validation.pareto.scene import Scene
from validation.pareto.scenes import andrews, arm, four_bar, pendulum, robot, spin_up

SCENES: dict[str, Scene] = {
    "spin_up": spin_up.SCENE,
    "robot": robot.SCENE,
    "arm": arm.SCENE,
    "four_bar": four_bar.SCENE,
    "andrews": andrews.SCENE,
    "pendulum": pendulum.SCENE,
}
