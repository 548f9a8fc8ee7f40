"""Trajectories: they pass their points, are as smooth as they say, and their rates are rates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

import symofros as sf
from reference_models import MODELS
from symofros.blocks import CartesianTrajectory, JointTrajectory, Square
from symofros.blocks.inputs.laws import LAWS
from tests.blocks.support import run
from tests.models import sampled

TIMES = np.array([0.2, 0.7, 1.0, 1.6])
POINTS = np.array([[0.0, 1.0], [0.5, -1.0], [0.2, 0.0], [-0.4, 0.3]])
QUATERNIONS = Rotation.from_rotvec([[0, 0, 0], [1.0, 0.5, 0], [1.0, 0.5, 2.0], [0, -2.0, 1.0]]).as_quat()
FINE = 1e-3
# A turning point between samples, relative to the greatest value.
CURVATURE = 2e-3


def is_rate(t: np.ndarray, p: np.ndarray, v: np.ndarray) -> None:
    """A central difference is a mean of the rate: it lies within what the rate is around, where it jumps, too."""
    slope = (p[2:] - p[:-2]) / (t[2] - t[0])
    around = np.stack([v[:-2], v[1:-1], v[2:]])
    slack = CURVATURE * np.abs(v).max()
    assert np.all(slope >= around.min(axis=0) - slack)
    assert np.all(slope <= around.max(axis=0) + slack)


@pytest.mark.parametrize("law", [*LAWS, "spline"])
def test_joint_trajectories_pass_their_points(law: str) -> None:
    found = run(
        JointTrajectory(name="j", points=POINTS, times=TIMES, law=law, unit="rad"), t_end=1.8, dt=FINE, compare=0
    )
    t = found["t"]
    at = [int(np.argmin(abs(t - time))) for time in TIMES]
    np.testing.assert_allclose(found["q"][at], POINTS, atol=1e-9)
    for key in "va":
        assert not found[key][t < 0.2 - FINE].any()
        np.testing.assert_allclose(found[key][t > 1.6 + FINE], 0.0, atol=1e-9)
    is_rate(t, found["q"], found["v"])
    is_rate(t, found["v"], found["a"])
    if law == "spline":
        inside = (t > 0.2) & (t < 1.6)
        spline = CubicSpline(TIMES, POINTS, bc_type="clamped")
        for key, order in zip("qva", range(3), strict=True):
            np.testing.assert_allclose(found[key][inside], spline(t[inside], order), atol=1e-10)
    else:
        np.testing.assert_allclose(found["v"][at], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("law", "speed", "acceleration", "tolerance"),
    [("quintic", 1.875, 5.7735, 1e-4), ("septic", 2.1875, 7.5132, 1e-4), ("trapezoidal", 4 / 3, 16 / 3, 1e-12)],
)
def test_peaks_of_speed_and_acceleration_match_the_laws(
    law: str, speed: float, acceleration: float, tolerance: float
) -> None:
    found = run(JointTrajectory(name="j", points=[[0.0], [1.0]], times=[0.0, 1.0], law=law), t_end=1.0, dt=FINE)
    assert found["v"].max() == pytest.approx(speed, abs=tolerance)
    assert abs(found["a"]).max() == pytest.approx(acceleration, abs=tolerance)
    assert found["q"][-1] == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("law", sampled(("quintic", "septic", "spline"), ("quintic", "spline")))
def test_frame_trajectories_interpolate_rotations(law: str) -> None:
    points = np.hstack([POINTS, POINTS[:, :1]])
    block = CartesianTrajectory(name="c", points=points, times=TIMES, quaternions=-2 * QUATERNIONS, law=law)
    found = run(block, t_end=1.8, dt=FINE, compare=0)
    t, R = found["t"], Rotation.from_matrix(found["R"])
    at = [int(np.argmin(abs(t - time))) for time in TIMES]
    assert (R[at] * Rotation.from_quat(QUATERNIONS).inv()).magnitude() == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(Rotation.from_quat(found["quaternion"]).as_matrix(), found["R"], atol=1e-13)
    # Angular velocity in world axes: the rotation vector from one sample to the one after the next, over their time.
    w = (R[2:] * R[:-2].inv()).as_rotvec() / (2 * FINE)
    np.testing.assert_allclose(found["v"][1:-1, 3:], w, atol=0.05)
    is_rate(t, found["p"], found["v"][:, :3])
    is_rate(t, found["v"], found["a"])
    if law == "quintic":  # Between two points the turn is about one axis: spherical interpolation over the law's share.
        x = (t[at[0] : at[1]] - 0.2) / 0.5
        slerp = Slerp([0, 1], Rotation.from_quat(QUATERNIONS[:2]))(x**3 * (10 - 15 * x + 6 * x**2))
        assert (slerp * R[at[0] : at[1]].inv()).magnitude() == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("law", sampled(LAWS, ["trapezoidal"]))
def test_a_square_stops_at_its_corners(law: str) -> None:
    way: dict[str, Any] = {"start": (0.0, 0.1), "leave": 0.1, "approach": 1.0, "side": 0.5, "laps": 2}
    square = Square(name="s", corner=(0.3, 0.3), first=(0.6, 0), second=(0, -0.6), law=law, **way)
    assert square.finish == pytest.approx(0.1 + 1.0 + 8 * 0.5)
    found = run(square, t_end=5.3, dt=0.05)
    corners = np.array([[0.3, 0.3], [0.9, 0.3], [0.9, -0.3], [0.3, -0.3]])
    t, p = found["t"], found["p"]
    for k in range(9):
        i = int(np.argmin(abs(t - (1.1 + 0.5 * k))))
        np.testing.assert_allclose(p[i], corners[k % 4], atol=1e-9)
        np.testing.assert_allclose(found["v"][i], 0.0, atol=1e-7)
    # Sides are straight.
    top = (t >= 1.1) & (t <= 1.6)
    np.testing.assert_allclose(p[top, 1], 0.3, atol=1e-14)
    fine = run(square, t_end=5.3, dt=FINE, compare=0)
    is_rate(fine["t"], fine["p"], fine["v"])
    is_rate(fine["t"], fine["v"], fine["a"])


def test_blended_corners_are_rounded_smoothly_and_take_less_time() -> None:
    fields = dict(start=(0.0, 0.0), corner=(0.3, 0.0), first=(0.6, 0), second=(0, -0.6), approach=1.0, side=1.0)
    sharp, blended = Square(name="s", **fields), Square(name="s", blend=0.3, **fields)  # type: ignore[arg-type]
    assert blended.finish == pytest.approx(sharp.finish - 4 * 0.3)
    found = run(blended, t_end=4.0, dt=FINE, compare=0)
    is_rate(found["t"], found["p"], found["v"])
    is_rate(found["t"], found["v"], found["a"])
    speed = np.linalg.norm(found["v"], axis=1)[(found["t"] > 0.3) & (found["t"] < blended.finish - 0.4)]
    assert speed.min() > 0.1  # It goes through corners without a stop, and near them:
    nearest = np.linalg.norm(found["p"] - [0.9, 0.0], axis=1).min()
    assert 0.001 < nearest < 0.06
    assert found["p"][-1] == pytest.approx([0.3, 0.0], abs=1e-14)


def test_a_square_starts_at_the_initial_pose() -> None:
    system, start = MODELS["planar_robot"], {"q1": -0.1, "q2": 0.1}
    square = Square(name="s", model="m", frame="tool", corner=(0.3, 0.3), first=(0.6, 0), second=(0, -0.6))
    found = run(square, t_end=0.1, models={"m": (system, start)})
    model = sf.compile(system)
    q = model.neutral()
    q[[0, 5]] = -0.1, 0.1
    np.testing.assert_allclose(found["p"][0], model.frame_pose("tool", q)[0][:2], atol=1e-14)
