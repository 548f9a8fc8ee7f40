"""The second-order displacement field: how far it is from an inextensible axis with sections square to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symofros as sf
from symofros.mechanics.beams.fields import Field
from symofros.mechanics.beams.second_order.deformation import Deformation, deformation_of

L = 1.3
RNG = np.random.default_rng(4)
STATE, RATES = 0.04 * RNG.standard_normal(7), RNG.standard_normal(7)
STATIONS = np.linspace(0.15, 1.0, 5) * L
# Third-order errors fall eightfold when the state is halved, second-order ones fourfold.
THIRD, SECOND = 7.5, 3.7


def deformation(**more: Any) -> Deformation:
    given: dict[str, Any] = {"bend_y": 3, "bend_z": 2, "twist": 2, "family": "legendre"}
    return deformation_of(sf.Beam("b", sf.Joint("j"), L, 1.0, **(given | more)))


def at(field: Field, q: np.ndarray, x: float) -> float:
    terms = ((mono, float(f(x / L))) for mono, f in field.terms.items())
    return sum(value * L ** field.exponent(mono) * float(np.prod(q[list(mono)])) for mono, value in terms)


def values(fields: Sequence[Field], q: np.ndarray, x: float) -> np.ndarray:
    return np.array([at(field, q, x) for field in fields])


def matrix(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    return np.array([values(row, q, x) for row in shape.rotation])


def exact(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    """Rz(P) Ry(T) Rx(F), as the tip turns."""
    return Rotation.from_euler("ZYX", values((shape.yaw, shape.pitch, shape.roll), q, x)).as_matrix()


def tangent(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    return values([field.along() for field in shape.position], q, x)


def axial(W: np.ndarray) -> np.ndarray:
    """The vector of a matrix's skew part."""
    return np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]]) / 2


def rate(matrices: tuple[np.ndarray, np.ndarray], step: float) -> np.ndarray:
    return (matrices[1] - matrices[0]) / (2 * step)


def stretch(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    return np.linalg.norm(tangent(shape, q, x)) - 1.0


def shear(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    return exact(shape, q, x)[:, 0] - tangent(shape, q, x)


def orthogonality(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    R = matrix(shape, q, x)
    return R.T @ R - np.eye(3)


def rotation(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    return matrix(shape, q, x) - exact(shape, q, x)


def curvature(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    h = 1e-5
    slope = rate((exact(shape, q, x - h), exact(shape, q, x + h)), h)
    return values(shape.curvatures, q, x) - axial(exact(shape, q, x).T @ slope)


def spin(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    """Angular velocity along the section's axes, per unit rates: of second order in the state alone."""
    h = 1e-5
    turning = rate((exact(shape, q - h * RATES, x), exact(shape, q + h * RATES, x)), h)
    partial = np.array([values(triple, q, x) for triple in shape.partial_spins])
    return RATES @ partial - axial(exact(shape, q, x).T @ turning)


def turning(shape: Deformation, q: np.ndarray, x: float) -> np.ndarray:
    """The same in the axes of B."""
    h = 1e-5
    rates = rate((exact(shape, q - h * RATES, x), exact(shape, q + h * RATES, x)), h)
    partial = np.array([values(triple, q, x) for triple in shape.turning])
    return RATES @ partial - axial(rates @ exact(shape, q, x).T)


@pytest.mark.parametrize("error", [stretch, shear, orthogonality, rotation, curvature])
def test_errors_of_strains_and_rotations_are_of_third_order(error: Any) -> None:
    shape = deformation()
    for x in STATIONS:
        sizes = [np.linalg.norm(error(shape, scale * STATE, x)) for scale in (0.5, 0.25)]
        assert sizes[0] > THIRD * sizes[1] > 1e-9, (error.__name__, x, sizes)


@pytest.mark.parametrize("error", [spin, turning])
def test_partial_spins_err_by_second_order(error: Any) -> None:
    shape = deformation()
    for x in STATIONS:
        sizes = [np.linalg.norm(error(shape, scale * STATE, x)) for scale in (0.5, 0.25)]
        assert sizes[0] > SECOND * sizes[1] > 1e-9, (error.__name__, x, sizes)


def test_the_root_does_not_move() -> None:
    shape = deformation()
    np.testing.assert_array_equal(values(shape.position, STATE, 0.0), 0.0)
    np.testing.assert_array_equal(matrix(shape, STATE, 0.0), np.eye(3))


def test_beams_with_equal_functions_share_their_field() -> None:
    assert deformation() is deformation()
    assert deformation() is not deformation(foreshortening=False)
