"""Singular postures are found wherever the singular direction points, and damped least squares are least squares."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from symofros.blocks.kinematics.tasks import Task, damped, near_singular, resolved
from symofros.diagrams.tensor import Tensor
from symofros.expr.graph import Graph

NEAR = 0.05


def numbers(value: Tensor) -> np.ndarray:
    found = np.array([value.g.number(edge) for edge in value.flat], dtype=float)
    return found.reshape(value.shape)


def jacobian(rng: np.random.Generator, m: int, n: int, least: float) -> np.ndarray:
    """A matrix of random directions with a stated least singular value, the others about one."""
    U, V = (np.linalg.qr(rng.normal(size=(size, size)))[0] for size in (m, n))
    sizes = np.linspace(1.5, 0.8, min(m, n))
    sizes[-1] = least
    return (U[:, : min(m, n)] * sizes) @ V[: min(m, n)]


@pytest.mark.parametrize(("m", "n"), [(1, 3), (2, 2), (3, 7), (6, 6), (7, 4)])
@pytest.mark.parametrize("least", [0.0, 1e-4, 0.01, 0.04, 0.06, 0.5])
def test_damping_acts_whenever_a_singular_value_is_small(
    m: int, n: int, least: float, rng: np.random.Generator
) -> None:
    for _ in range(5):
        J = jacobian(rng, m, n, least)
        _, extra = near_singular(Tensor.numbers(Graph(), J), 0.02, NEAR)
        share = float(numbers(extra)) / 0.02**2
        if least < NEAR:
            assert share > 0.0
        if least < 1e-3:
            assert share == pytest.approx(1.0, abs=1e-3)
        if least == 0.5:
            assert share == 0.0


@pytest.mark.parametrize(("m", "n"), [(3, 7), (6, 6), (7, 4)])
def test_rates_are_least_squares(m: int, n: int, rng: np.random.Generator) -> None:
    J, x = jacobian(rng, m, n, 0.5), rng.normal(size=m)
    g = Graph()
    found = numbers(resolved(damped(Tensor.numbers(g, J), 0.02, NEAR), Tensor.numbers(g, x)))
    np.testing.assert_allclose(found, np.linalg.pinv(J) @ x, atol=1e-11)
    # In a singular posture rates stay bounded by 1/(2 damping).
    J = jacobian(rng, m, n, 0.0)
    g = Graph()
    found = numbers(resolved(damped(Tensor.numbers(g, J), 0.02, NEAR), Tensor.numbers(g, x)))
    np.testing.assert_allclose(found, np.linalg.pinv(J, rcond=1e-6) @ x, atol=1e-2)


@pytest.mark.parametrize("axis", range(3))
def test_a_turn_is_what_is_left_to_an_angle_about_the_axis(axis: int, rng: np.random.Generator) -> None:
    """Of any size; the shorter way round."""
    g, task = Graph(), Task("m", "tool", [0, 3 + axis], [0])
    for angle, left in rng.uniform(-3.0, 3.0, (6, 2)):
        R = Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix()
        found = task._turn(Tensor.numbers(g, angle + left), Tensor.numbers(g, R))
        assert float(numbers(found)) == pytest.approx(left, abs=1e-14)
