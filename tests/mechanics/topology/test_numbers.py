"""Which matrices are taken for rotations, and what is made of them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import symofros as sf
from symofros.description.values import Rotation
from symofros.mechanics.topology.numbers import ROTATION_TOLERANCE, Numbers


@example(ROTATION_TOLERANCE)
@example(float(np.nextafter(ROTATION_TOLERANCE, 1.0)))
@given(st.floats(0.0, 2.0 * ROTATION_TOLERANCE))
def test_a_matrix_is_refused_or_taken_for_the_nearest_rotation(shear: float) -> None:
    """One whose digits are few, up to the bound itself, is used as a rotation to rounding."""
    numbers = Numbers(sf.System("s", [sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0))]))
    stated = Rotation("matrix", (1.0, shear, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
    problems, R = list(numbers.rotation_problems("frame", stated, "")), numbers.rotation(stated)
    assert bool(problems) == (shear > ROTATION_TOLERANCE)
    if not problems:
        np.testing.assert_allclose(R @ R.T, np.eye(3), rtol=0, atol=1e-15)
        np.testing.assert_allclose(R, np.eye(3), rtol=0, atol=shear)


def test_rotations_of_invalid_numbers_are_nan() -> None:
    """So that what is made of it is no number either, and the check tells the description's fault in words."""
    body = sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0))
    numbers = Numbers(sf.System("s", [body], [sf.Parameter("a", 1.0)]))
    for stated in (Rotation("rpy", ("1/(a - a)", 0.0, 0.0)), Rotation("quaternion", (0.0, 0.0, 0.0, 0.0))):
        R = numbers.rotation(stated)
        assert R.shape == (3, 3) and np.isnan(R).all()


@given(st.tuples(*[st.floats(-3.0, 3.0)] * 3), st.floats(-7.0, 7.0))
def test_stated_rotations_are_those_of_another_library(x: tuple[float, float, float], angle: float) -> None:
    """Axes and quaternions of any length, angles of either sign: by SciPy."""
    transform = pytest.importorskip("scipy.spatial.transform")
    numbers = Numbers(sf.System("s", [sf.RigidBody("b", sf.Joint("q", "revolute"), sf.Inertia(1.0))]))
    axis = np.array(x) + (0.0, 0.0, 4.0)
    known = {
        "rpy": (x, transform.Rotation.from_euler("xyz", x)),
        "quaternion": ((*x, 4.0), transform.Rotation.from_quat((*x, 4.0))),
        "axis_angle": ((*axis, angle), transform.Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))),
    }
    for kind, (stated, by_scipy) in known.items():
        R = numbers.rotation(Rotation(kind, tuple(map(float, stated))))  # type: ignore[arg-type]
        np.testing.assert_allclose(R, by_scipy.as_matrix(), rtol=0, atol=4e-15)
