"""Truths of numbers, vectors and matrices: by NumPy, by steps of the differential equation; MuJoCo's own functions."""

from __future__ import annotations

import numpy as np
import pytest

from validation.engines.functions.vectors import VECTORS
from validation.engines.interface import Slot
from validation.engines.matrix import cells
from validation.engines.models import single
from validation.engines.plugins import OWN
from validation.engines.proving.pieces import Layout
from validation.engines.truth.dynamics import Point, Truth, digits, random_state
from validation.engines.truth.geometry.poses import AWAY
from validation.engines.truth.geometry.vectors import DECAY, FRICTION, ROOTS

_TREE = single.trees()["vectors"]
_LAYOUT = Layout(4, 3, ((Slot("quaternion wxyz, body speeds", (0, 1, 2, 3), (0, 1, 2)),),))
_STATE = random_state(_TREE, _LAYOUT, 3)


def _value(name: str) -> np.ndarray:
    return digits(Truth(_TREE, _LAYOUT).value(VECTORS[name].truth, Point.of(_STATE)))


def test_truths_of_vectors_and_matrices_are_those_of_numpy() -> None:
    q, v, a, tau = _STATE.q, _STATE.v, _STATE.a, _STATE.tau
    u, B = v + AWAY, np.array([v, a, tau])
    A = B @ B.T + np.eye(3)
    band = A * (np.abs(np.subtract.outer(range(3), range(3))) < 2)
    u_m, w = abs(v[0]) / (1 + abs(v[0])), abs(a[0]) / 2
    slower, turned = 0.5 + 1.5 * w, np.arctan2(u[0], u[1])
    wanted = {
        "vector_cross": np.cross(v, a),
        "vector_distance": [np.linalg.norm(u - a)],
        "vector_aligned": [
            np.cos(turned) * v[0] + np.sin(turned) * v[1],
            np.cos(turned) * v[1] - np.sin(turned) * v[0],
            v[2],
        ],
        "number_clipped": np.clip(v, -0.5, 0.25),
        "number_rounded": np.round(64 * a),
        "matrix_square": B.T @ np.diag(u) @ B,
        "matrix_between_vectors": [u @ B @ a],
        "band_times_vector": band @ u,
        "quaternion_normalised": q,
        "history_of_control_interpolated": [(v[1] + v[2]) / 2],
        "muscle_rate": [(u_m - w) / (0.0625 * slower if u_m > w else 0.25 / slower)],
    }
    for name, value in wanted.items():
        np.testing.assert_allclose(_value(name), value, rtol=1e-14, err_msg=name)


@pytest.mark.parametrize("roots", ROOTS)
def test_a_spring_and_damper_decay_as_their_equation_says(roots: str) -> None:
    damping, stiffness = ROOTS[roots]
    matrix = np.array([[0.0, 1.0], [-stiffness, -damping]]) * DECAY
    led, term = np.array([_STATE.v[0], _STATE.a[0]]), np.array([_STATE.v[0], _STATE.a[0]])
    for k in range(1, 30):
        term = matrix @ term / k
        led = led + term
    np.testing.assert_allclose(_value(f"decay_of_{roots}_roots"), [led[0]], rtol=1e-13)


def test_edges_of_friction_add_up_to_the_force() -> None:
    edges, (normal, *tangents) = _value("friction_edges"), _value("friction_edges_back")
    np.testing.assert_allclose(edges.sum(), normal)
    for mu, tangent, pair in zip(FRICTION, tangents, edges.reshape(2, 2), strict=True):
        np.testing.assert_allclose(mu * (pair[0] - pair[1]), tangent)


def test_mujoco_is_right_but_for_edges_of_friction() -> None:
    pytest.importorskip("mujoco")
    verdicts = {cell.function: cell.verdict for cell in cells(OWN["mujoco"], _TREE)}
    red = {name for name, verdict in verdicts.items() if verdict != "right"}
    assert red == {"friction_edges", "friction_edges_back"} and len(verdicts) > 60
