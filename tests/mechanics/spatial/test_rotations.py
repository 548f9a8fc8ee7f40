from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference_models.rigid.random_tree import random_rotation
from symofros.description.values import Rotation
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.generator.passes.count import count_operations
from symofros.mechanics.spatial.rotations import (
    AxisRotation,
    RotationProduct,
    constant_rotation,
    frame_with_axis,
    snapped,
    stated_rotation,
    unit_vector,
)
from symofros.mechanics.topology.numbers import Numbers


def numbers(m: Mat3 | Vec3 | Sym3, g: Graph) -> np.ndarray:
    edges = m.entries if isinstance(m, Mat3) else m.matrix().entries if isinstance(m, Sym3) else tuple(m)
    flat = np.array([g.number(edge) for edge in edges], dtype=float)
    return flat if isinstance(m, Vec3) else flat.reshape(3, 3)


@pytest.mark.parametrize("seed", range(40))
def test_stated_rotations_agree_with_the_checker(seed: int) -> None:
    """Two implementations: the symbolic one, and the numeric one that judges descriptions."""
    import symofros as sf

    rotation = random_rotation(np.random.default_rng(seed))
    g = Graph()
    R = numbers(stated_rotation(rotation, g, {}), g)
    np.testing.assert_allclose(R, Numbers(sf.System("s")).rotation(rotation), atol=1e-15)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("seed", range(40))
def test_constant_factors_multiply_to_the_rotation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    g = Graph()
    R = stated_rotation(random_rotation(rng), g, {})
    rotation = constant_rotation(R)
    expected = numbers(R, g)
    np.testing.assert_allclose(numbers(rotation.matrix(), g), expected, atol=1e-15)
    v = Vec3(g, *map(g.constant, rng.standard_normal(3)))
    np.testing.assert_allclose(numbers(rotation.apply(v), g), expected @ numbers(v, g), atol=1e-14)
    np.testing.assert_allclose(numbers(rotation.apply_inverse(v), g), expected.T @ numbers(v, g), atol=1e-14)
    S = Sym3(g, *map(g.constant, rng.standard_normal(6)))
    turned = numbers(rotation.conjugate(S), g)
    np.testing.assert_allclose(turned, expected @ numbers(S, g) @ expected.T, atol=1e-14)
    B = Mat3(g, tuple(map(g.constant, rng.standard_normal(9))))
    turned = numbers(rotation.conjugate_any(B), g)
    np.testing.assert_allclose(turned, expected @ numbers(B, g) @ expected.T, atol=1e-14)


@pytest.mark.parametrize("tilt", [1e-3, 1e-6, 1e-8, 1e-10, 1e-14])
@pytest.mark.parametrize("form", [(1, 0, 0), (1, 1, 0), (1, 1, 1), (0, 1, 2)])
def test_slight_tilts_survive_every_form(tilt: float, form: tuple[float, ...]) -> None:
    """Near a permutation of axes entries round to 1 before the others round to 0."""
    g = Graph()
    R = stated_rotation(Rotation.rpy(*(x * tilt for x in form[:2]), form[2] * 0.25), g, {})
    rotation, expected = constant_rotation(R), numbers(R, g)
    S = Sym3(g, *map(g.constant, (1.0, 20.0, 300.0, 2.0, -3.0, 5.0)))
    np.testing.assert_allclose(numbers(rotation.matrix(), g), expected, atol=1e-16)
    np.testing.assert_allclose(numbers(rotation.conjugate(S), g), expected @ numbers(S, g) @ expected.T, atol=1e-13)


def test_right_angles_are_exact_and_cost_nothing() -> None:
    g = Graph()
    rotation = constant_rotation(stated_rotation(Rotation.rpy(np.pi / 2, 0.0, -np.pi), g, {}))
    v = Vec3(g, *(g.input("q", i) for i in range(3)))
    assert count_operations(g, list(rotation.apply(v))).total == 0
    assert {abs(edge) for edge in rotation.apply(v)} == {abs(edge) for edge in v}


@pytest.mark.parametrize("k", range(3))
def test_an_axis_rotation_has_the_operation_count_of_the_theory(k: int) -> None:
    """Vectors 4 + 2, symmetric tensors 8 + 8, others 12 + 11 (docs/theory/rigid.md, eq. 12)."""
    g = Graph()
    rotation = RotationProduct(g, (AxisRotation(k, g.input("q", 0), g.input("q", 1)),))
    v = Vec3(g, *(g.input("v", i) for i in range(3)))
    S = Sym3(g, *(g.input("u", i) for i in range(6)))
    vector, tensor = count_operations(g, list(rotation.apply(v))), count_operations(g, list(rotation.conjugate(S)))
    assert (vector.mul, vector.add) == (4, 2)
    # d + d counts as a multiplication by two: 8 + 8 in all.
    assert (tensor.mul + tensor.add, tensor.total) == (16, 16)
    other = count_operations(g, rotation.conjugate_any(Mat3(g, tuple(g.input("a", i) for i in range(9)))).entries)
    assert (other.mul, other.add) == (12, 11)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda x: np.linalg.norm(x) > 0.1))
def test_any_axis_becomes_a_coordinate_axis(x: list[float]) -> None:
    g = Graph()
    axis = unit_vector(Vec3(g, *map(g.constant, x)))
    found = frame_with_axis(axis)
    assert found is not None
    A, k, negative = found
    R = numbers(A, g)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
    assert np.linalg.det(R) > 0
    np.testing.assert_allclose(R[:, k] * (-1 if negative else 1), np.array(x) / np.linalg.norm(x), atol=1e-14)


def test_snapping_changes_only_rounding() -> None:
    g = Graph()
    R = Mat3(g, tuple(map(g.constant, (1 - 1e-16, 6e-17, 0, 1e-10, 1, 0, 0, 0, -1 + 2e-16))))
    assert numbers(snapped(R), g).tolist() == [[1, 0, 0], [1e-10, 1, 0], [0, 0, -1]]
