"""Formulas of coordinates that frameworks differentiate, by NumPy's operations: the manifold's, at any angle."""

from __future__ import annotations

import numpy as np
from hypothesis import example, given, settings

from symofros.base.arrays import Array
from symofros.interop.coordinates import Coordinates, Operations
from symofros.runtime import manifold
from tests.runtime.test_manifold import ANGLES, NV, ROUNDING, SEEDS, SEGMENTS, configuration, step

QUATERNIONS = (slice(2, 6), slice(9, 13))
COORDINATES = Coordinates(
    SEGMENTS,
    Operations(
        lambda q: list(np.moveaxis(q, -1, 0)),
        lambda entries: np.stack(np.broadcast_arrays(*entries), axis=-1),
        np.sqrt,
        np.sin,
        np.cos,
        np.arctan2,
        np.where,
    ),
)


def stretched(q: Array, rng: np.random.Generator) -> Array:
    """The configuration with quaternions of other lengths."""
    q = q.copy()
    for turning in QUATERNIONS:
        q[turning] *= rng.uniform(0.5, 2.0)
    return q


@example(0, 0.0999, 0.0999)  # Series, at the end of their reach.
@example(0, 0.1001, 0.1001)
@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=60)
def test_steps_and_differences_are_those_of_the_manifold(seed: int, first: float, second: float) -> None:
    """Of quaternions of any length and either sign."""
    rng = np.random.default_rng(seed)
    q, dq = configuration(rng), step(rng, (first, second))
    moved = COORDINATES.integrate(stretched(q, rng), dq)
    np.testing.assert_allclose(moved, manifold.integrate(SEGMENTS, q, dq), atol=2 * ROUNDING, rtol=0)
    back = COORDINATES.difference(stretched(q, rng), stretched(moved, rng))
    np.testing.assert_allclose(back, manifold.difference(SEGMENTS, q, moved), atol=4 * ROUNDING, rtol=0)
    np.testing.assert_allclose(COORDINATES.unit(stretched(q, rng)), q, atol=ROUNDING, rtol=0)


@given(SEEDS)
@settings(max_examples=20)
def test_rates_and_derivatives_belong_to_the_motion_along_the_manifold(seed: int) -> None:
    """q' = N v keeps lengths; derivatives by coordinates times N are those along the motions of the speeds."""
    rng = np.random.default_rng(seed)
    h, q, v = 1e-6, stretched(configuration(rng), rng), rng.standard_normal(NV)
    ahead, behind = (manifold.integrate(SEGMENTS, COORDINATES.unit(q), x * v) for x in (h, -h))
    rates = COORDINATES.rates(q, v)
    lengths = np.ones_like(q)
    for turning in QUATERNIONS:
        lengths[turning] = np.linalg.norm(q[turning])
    # The third derivative of a motion with speeds of a few units, and rounding over h.
    np.testing.assert_allclose(rates / lengths, (ahead - behind) / (2 * h), atol=1e-8)
    by_speeds = rng.standard_normal(NV)
    by_coordinates = COORDINATES.by_coordinates(q, by_speeds)
    assert abs(by_coordinates @ rates - by_speeds @ v) < 1e-13 * np.abs(by_speeds).sum() * np.abs(v).sum()
    for turning in QUATERNIONS:  # Lengths of quaternions change nothing.
        assert abs(by_coordinates[turning] @ q[turning]) < 1e-13


def test_configurations_without_rotations_are_added_up() -> None:
    """Whatever they are: the framework's own sum and difference."""
    plain = Coordinates(SEGMENTS[:1], COORDINATES._f)
    q, dq = np.array([[1.0, 2.0]]), np.array([[0.5, -4.0]])
    np.testing.assert_array_equal(plain.integrate(q, dq), q + dq)
    np.testing.assert_array_equal(plain.difference(dq, q), q - dq)
    assert plain.unit(q) is q and plain.rates(q, dq) is dq and plain.by_coordinates(q, dq) is dq
    assert COORDINATES.curved and not plain.curved
