"""What is asked of inverse kinematics is checked: rotations are rotations, arrays fit and are finite."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from symofros.simulation.analysis.kinematics.targets import ROTATION_TOLERANCE, Task


@cache
def wrist() -> sf.Model:
    joint = sf.Joint("ball", "ball")
    body = sf.RigidBody("hand", joint, sf.Inertia(1.0, moments=(1.0, 1.0, 1.0, 0, 0, 0)), (sf.Frame("tip", (1, 0, 0)),))
    return sf.compile(sf.System("wrist", (body,)), sf.Options(functions=("frame_pose", "frame_jacobian")))


def rotation(seed: int) -> np.ndarray[Any, Any]:
    Q, R = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    Q = Q * np.sign(np.diag(R))
    return Q if np.linalg.det(Q) > 0.0 else -Q


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 1.0, np.pi - 1e-9, np.pi])
def test_rotation_vectors_match_the_exponential(angle: float) -> None:
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    R = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    vector = Task(wrist(), {"tip": sf.Target(rotation=R)}, None, None).error(wrist().neutral())
    assert min(np.abs(vector - angle * axis).max(), np.abs(vector + angle * axis).max()) < 1e-7


@settings(max_examples=60)
@given(st.integers(0, 1000), st.floats(-12, 1), st.integers(0, 8), st.sampled_from([-1.0, 1.0]))
def test_a_matrix_is_taken_exactly_if_it_is_a_rotation_to_seven_digits(
    seed: int, magnitude: float, entry: int, sign: float
) -> None:
    """Any deviation, of any size: it is refused, or a rotation as near as the deviation is reached."""
    R = rotation(seed)
    given_R = R.copy()
    given_R.flat[entry] += sign * 10.0**magnitude
    off = float(np.linalg.norm(given_R @ given_R.T - np.eye(3), 2))
    if off > ROTATION_TOLERANCE:
        with pytest.raises(sf.SymofrosError, match=r"not a rotation\n  found: .*\n  rule: .*\n  remedy:"):
            sf.inverse_kinematics(wrist(), {"tip": sf.Target(rotation=given_R)})
        return
    reached = sf.inverse_kinematics(wrist(), {"tip": sf.Target(rotation=given_R)})
    R_WF = wrist().frame_pose("tip", reached.q)[1]
    assert reached.converged and np.abs(R_WF - given_R).max() <= 2.0 * ROTATION_TOLERANCE


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_reflections_are_refused_as_rotations(seed: int) -> None:
    with pytest.raises(sf.SymofrosError, match="determinant -1"):
        sf.inverse_kinematics(wrist(), {"tip": sf.Target(rotation=rotation(seed) @ np.diag([1.0, 1.0, -1.0]))})


@pytest.mark.parametrize(
    ("target", "says"),
    [
        (sf.Target([0.5, 0]), r"position does not fit\n  found:  shape \(2,\)\n  rule:   .*\(3,\)"),
        (sf.Target([0.5, np.nan, 0]), "nan among its numbers"),
        (sf.Target(["0.5", "0", "0"]), r"found:  list \['0.5'"),
        (sf.Target([0.5, 1j, 0]), "found:  list"),
        (sf.Target(rotation=[0, 0, 0, 1]), r"rotation does not fit\n  found:  shape \(4,\)"),
        (sf.Target(rotation=np.full((3, 3), np.nan)), "nan among its numbers"),
        (sf.Target(), "says nothing of where the frame is wanted"),
    ],
)
def test_an_invalid_target_is_refused(target: Any, says: str) -> None:
    with pytest.raises(sf.SymofrosError, match=says) as raised:
        sf.inverse_kinematics(wrist(), {"tip": target})
    assert "frame 'tip'" in raised.value.problem.what
    assert all((raised.value.problem.found, raised.value.problem.rule, raised.value.problem.remedy))


@pytest.mark.parametrize("which", ["q", "rest"])
@pytest.mark.parametrize("bad", [[0.0, 0, 0], [0, 0, 0, np.nan], [0.0, 0, 0, 0], ["a"] * 4])
def test_guess_and_rest_are_configurations(which: str, bad: Any) -> None:
    with pytest.raises(sf.ShapeError, match=rf"inverse kinematics: {which} does not fit|: {which} holds a quaternion"):
        sf.inverse_kinematics(wrist(), {"tip": sf.Target([0, 1, 0])}, **{which: bad})


def test_arrays_of_a_motion_fit_each_other() -> None:
    p = [[1.0, 0, 0], [1.0, 0, 0]]
    with pytest.raises(sf.ShapeError, match="velocities does not fit"):
        sf.joint_motion(wrist(), "tip", p, np.zeros((2, 6)), np.zeros((2, 3)))
    with pytest.raises(sf.ShapeError, match="rotations does not fit"):
        sf.joint_motion(wrist(), "tip", p, np.zeros((2, 6)), np.zeros((2, 6)), np.eye(3))
    with pytest.raises(sf.SymofrosError, match="sample 1 is not a rotation"):
        sf.joint_motion(wrist(), "tip", p, np.zeros((2, 6)), np.zeros((2, 6)), [np.eye(3), 2 * np.eye(3)])


@pytest.mark.parametrize("rotated", [False, True])
def test_rows_share_sizes_within_one_target_or_one_constraint(rotated: bool) -> None:
    """Rows of the error: three a position, three a rotation, then those of the constraints in groups of their own."""
    model = sf.compile(MODELS["parallelogram"], sf.Options(backend="interpreter"))
    rotation = np.eye(3) if rotated else None
    wanted = Task(model, {model.names.frames[-1]: sf.Target(np.zeros(3), rotation)}, None, None)
    rows, of = wanted.measures, model.record.measures.of_rows(wanted.coordinates)
    first = 6 if rotated else 3
    assert len(wanted.coordinates) > 2 and len(set(of.group)) > 1
    assert rows.group == (*((0,) * 3), *((3,) * 3 if rotated else ()), *(first + row for row in of.group))
    assert len(rows.group) == len(rows.unit) == len(wanted.error(model.neutral()))
