"""A body free of forces: regular precession, and Jacobi's elliptic functions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipj

import symofros as sf
from tests.reference.motion import Array, free, move, reference, rotation

# The integrator's 1e-12 a step, over the hundred or so steps of these motions.
MOTION = 1e-9
TIMES = np.linspace(0.0, 6.0, 61)


def started(model: sf.Model, w: Array) -> tuple[Array, Array]:
    """The body at an arbitrary place, moving along and turning with w."""
    quaternion = np.array([0.1, -0.5, 0.3, 0.7])
    q = np.concatenate([[1.0, 2.0, 3.0], quaternion / np.linalg.norm(quaternion)])
    return q, np.concatenate([[0.4, -0.1, 0.2], w])


def test_an_axisymmetric_body_precesses_regularly() -> None:
    """In the body, w turns about the axis with (C - A)/A w_z; in space, the axis turns about H with |H|/A."""
    model = reference("torque_free_body").with_parameters(B=0.3, C=0.5)
    A, C = model.parameters["A"], model.parameters["C"]
    w = np.array([0.8, 0.3, 1.5])
    q, v = started(model, w)
    y = move(model, q, v, TIMES, free).y

    phase = (C - A) / A * w[2] * TIMES
    expected = [w[0] * np.cos(phase) - w[1] * np.sin(phase), w[0] * np.sin(phase) + w[1] * np.cos(phase)]
    np.testing.assert_allclose(y[10:12], expected, atol=MOTION)
    np.testing.assert_allclose(y[12], w[2], atol=MOTION)

    R = np.array([rotation(quaternion) for quaternion in y[3:7].T])
    H = R[0] @ (np.array([A, A, C]) * w)
    axis, up = R[:, :, 2], H / np.linalg.norm(H)
    across = axis[0] - up * (axis[0] @ up)
    angle = (np.linalg.norm(H) / A * TIMES)[:, None]
    turned = up * (axis[0] @ up) + np.cos(angle) * across + np.sin(angle) * np.cross(up, across)
    np.testing.assert_allclose(axis, turned, atol=MOTION)


@pytest.mark.parametrize("spin", [1.5, 0.4], ids=["about the largest moment", "about the smallest"])
def test_a_triaxial_body_matches_elliptic_functions(spin: float) -> None:
    """Landau and Lifshitz, section 37: w = (w_x cn, w_y sn, w_z dn), if H^2 > 2 T B; else x and z change places."""
    model = reference("torque_free_body")
    moments = np.array([model.parameters[name] for name in "ABC"])
    w = np.array([0.9, 0.0, spin])
    H2, T2 = float((moments * w) @ (moments * w)), float(moments @ w**2)
    # Numbered so that the moment of the axis that w goes round is the last.
    first, last = (0, 2) if H2 > T2 * moments[1] else (2, 0)
    I1, I2, I3 = moments[[first, 1, last]]
    rate = np.sqrt((I3 - I2) * (H2 - T2 * I1) / (I1 * I2 * I3))
    modulus = (I2 - I1) * (T2 * I3 - H2) / ((I3 - I2) * (H2 - T2 * I1))
    assert 0.0 < modulus < 1.0
    sn, cn, dn, _ = ellipj(rate * TIMES, modulus)
    # The sign of w_y, from B w_y' = (C - A) w_z w_x at the start, where sn rises.
    middle = np.sqrt((T2 * I3 - H2) / (I2 * (I3 - I2))) * np.sign((moments[2] - moments[0]) * w[2] * w[0])
    expected = np.empty((3, len(TIMES)))
    expected[first], expected[1], expected[last] = w[first] * cn, middle * sn, w[last] * dn

    q, v = started(model, w)
    np.testing.assert_allclose(move(model, q, v, TIMES, free).y[10:], expected, atol=MOTION)
