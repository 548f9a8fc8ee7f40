"""A few real robots, on a few states: the whole set is `python -m validation`."""

import pytest

from validation.check import Settings
from validation.inputs.cases import robot_case
from validation.worker_pool import run_case


@pytest.mark.parametrize("label", ["ur5", "kinova", "solo12"])
def test_robot(label: str) -> None:
    result = run_case(robot_case(label), Settings(states=20))
    assert result.ok, [row for row in result.comparisons if not row.ok]
    assert {row.engine for row in result.comparisons if row.status == "agree"} >= {
        "pinocchio",
        "mujoco",
        "pinocchio-urdf",
        "mujoco-urdf",
        "interpreted",
        "description",
    }
