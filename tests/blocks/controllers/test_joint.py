"""Control of joints one by one."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.blocks import JointPD, JointPID
from tests.blocks.support import STEP, run


def motion(rng: np.random.Generator, count: int = 8) -> dict[str, np.ndarray]:
    return {name: rng.normal(size=(count, 2)) for name in ("q_desired", "v_desired", "q", "v")}


def test_joint_pd_adds_proportional_and_derivative_terms(rng: np.random.Generator) -> None:
    given = motion(rng)
    found = run(JointPD(name="c", kp=[100.0, 50.0], kd=3.0), given)["effort"]
    expected = [100.0, 50.0] * (given["q_desired"] - given["q"]) + 3.0 * (given["v_desired"] - given["v"])
    np.testing.assert_allclose(found, expected, rtol=1e-13)


def test_sampled_pid_follows_its_recursion(rng: np.random.Generator) -> None:
    given = motion(rng, 30)
    block = JointPID(name="c", kp=10.0, ki=[40.0, 0.0], kd=1.0, low=-8.0, high=[5.0, 9.0], tracking=0.05, period=STEP)
    found = run(block, given)["effort"]
    i = np.zeros(2)
    for k in range(30):
        error, rate = given["q_desired"][k] - given["q"][k], given["v_desired"][k] - given["v"][k]
        wanted = 10.0 * error + i + rate
        effort = np.clip(wanted, -8.0, [5.0, 9.0])
        np.testing.assert_allclose(found[k], effort, atol=1e-12)
        i = i + STEP * ([40.0, 0.0] * error + (effort - wanted) / 0.05)


@pytest.mark.parametrize("tracking", [0.02, 1e6])
def test_the_integral_does_not_wind_up(tracking: float) -> None:
    """An error that lasts one second at a limit: once its sign changes, the effort leaves the limit soon."""
    t = STEP * np.arange(300)
    error = np.where(t < 1.0, 1.0, -0.5)[:, None]
    rest = np.zeros_like(error)
    block = JointPID(name="c", kp=1.0, ki=10.0, kd=0.0, low=-2.0, high=2.0, tracking=tracking)
    found = run(block, {"q_desired": error, "q": rest, "v": rest})["effort"][:, 0]
    left = t[np.flatnonzero(found < 2.0 - 1e-9)]
    late = left[left > 1.0].min() - 1.0
    # Followed: within a few time constants. Not followed: the integral of one second at 10 is unwound at 5 1/s.
    assert late < 0.05 if tracking < 1.0 else late > 1.0
