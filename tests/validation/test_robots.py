"""A few real robots, on a few states: the whole set is `python -m validation`."""

import pytest

from tests.models import sampled
from validation.checking import Settings
from validation.inputs.cases import robot_case
from validation.worker_pool import run_case


@pytest.mark.parametrize("label", sampled(("ur5", "kinova", "solo12"), ["ur5"]))
def test_engines_agree_on_every_robot(label: str) -> None:
    result = run_case(robot_case(label), Settings(states=20))
    assert result.ok, [row for row in result.comparisons if not row.ok]
    assert {row.engine for row in result.comparisons if row.status == "agree"} >= {
        "pinocchio",
        "mujoco",
        "pinocchio-urdf",
        "mujoco-urdf",
        "vectors",
        "interpreted",
        "description",
    }
