"""Shape functions through samples: cubics are met exactly, smooth functions to the fourth order."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from symofros.description.beams.elastic import Direction
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.shape_functions import shapes
from symofros.runtime.calls.kernel import Array
from validation.mechanics.shape_functions import through

DIRECTIONS: tuple[Direction, ...] = ("bend_y", "bend_z", "twist")
STATIONS = np.linspace(0.0, 1.0, 401)
# Stations by name of a grid, for a parameter that runs evenly from 0 to 1.
GRIDS: dict[str, Callable[[Array], Array]] = {
    "even": lambda t: t,
    "dense at the root": lambda t: t**1.5,
    "dense at the tip": lambda t: 1.0 - (1.0 - t) ** 1.5,
    "wavy": lambda t: t + 0.1 * np.sin(2.0 * np.pi * t),
    "short and long in turn": lambda t: t + 0.25 * t[1] * np.sin(np.pi * (t / t[1] + 0.5)),
}


def sampled(xi: Array, values: Array, direction: Direction) -> Piecewise:
    (shape,) = shapes("user", direction, 1, (sf.Samples(tuple(xi), tuple(values)),))
    return shape.phi


def grid(name: str, intervals: int) -> Array:
    xi = GRIDS[name](np.linspace(0.0, 1.0, intervals + 1))
    xi[0], xi[-1] = 0.0, 1.0
    return xi


def at(phi: Piecewise, order: int) -> Array:
    for _ in range(order):
        phi = phi.derivative()
    return np.array([float(phi(x)) for x in STATIONS])


@settings(max_examples=60)
@given(
    st.sampled_from(DIRECTIONS),
    st.tuples(*[st.floats(-10.0, 10.0)] * 3),
    st.lists(st.floats(0.05, 1.0), min_size=3, max_size=30),
)
def test_a_sampled_cubic_is_that_cubic(
    direction: Direction, coefficients: tuple[float, float, float], distances: list[float]
) -> None:
    """For any cubic that the root allows, and samples at any distances."""
    xi = np.concatenate([[0.0], np.cumsum(distances) / np.sum(distances)])
    xi[-1] = 1.0
    cubic = np.polynomial.Polynomial([0.0, *coefficients])
    if direction != "twist":
        cubic = cubic - cubic.deriv()(0.0) * np.polynomial.Polynomial([0.0, 1.0])
    phi = sampled(xi, cubic(xi), direction)
    scale, shortest = 1e-15 + float(np.abs(coefficients).max()), float(np.diff(xi).min())
    # A cubic through samples close together is extrapolated over the long interval beside them: their rounding grows as
    # Lagrange's polynomials there, as the square of the ratio of the intervals.
    growth = 0.9 + 0.1 * (float(np.diff(xi).max()) / shortest) ** 2
    for order in (0, 1, 2):
        # Samples are rounded to doubles: differences of that order divide it by as many distances.
        error = np.abs(at(phi, order) - (cubic.deriv(order) if order else cubic)(STATIONS)).max()
        assert error <= 1e-14 * scale * growth / shortest**order


@pytest.mark.parametrize("name", GRIDS)
@pytest.mark.parametrize("direction", ["bend_y", "twist"])
def test_sampled_functions_converge_with_the_fourth_order(direction: Direction, name: str) -> None:
    """Values as 1/N^4, curvature as 1/N^2: at the ends as elsewhere."""

    def errors(order: int, intervals: int) -> float:
        xi = grid(name, intervals)
        phi = sampled(xi, function(xi, 0), direction)
        return float(np.abs(at(phi, order) - function(STATIONS, order)).max())

    function = partial(exact, bending=direction != "twist")
    for order, power in ((0, 4.0), (2, 2.0)):
        coarse, fine = errors(order, 32), errors(order, 128)
        # Steeper where a coarse grid's largest error sits in the interval at an end, which shares its cubic.
        assert power - 0.35 <= np.log(coarse / fine) / np.log(4.0) <= power + 1.0


def exact(xi: Array, order: int, bending: bool) -> Array:
    """A function of curvature at the tip, 1 - cos 2 xi in bending and sin 2 xi in twist, or a derivative."""
    phase = np.pi if bending else -0.5 * np.pi
    value = 2.0**order * np.cos(2.0 * xi + phase + 0.5 * np.pi * order)
    return value + 1.0 if bending and not order else value


@pytest.mark.parametrize("name", GRIDS)
@pytest.mark.parametrize("direction", ["bend_y", "twist"])
@pytest.mark.parametrize("samples", [4, 5, 17])
def test_samples_of_anything_agree_with_an_independent_interpolation(
    samples: int, direction: Direction, name: str
) -> None:
    xi, rng = grid(name, samples - 1), np.random.default_rng(samples)
    values = np.concatenate([[0.0], rng.normal(size=samples - 1)])
    phi, known = sampled(xi, values, direction), through(tuple(xi), tuple(values), 1.0, direction != "twist")
    for order in (0, 1):
        scale = np.abs(known[order](STATIONS)).max()
        np.testing.assert_allclose(at(phi, order), known[order](STATIONS), atol=1e-9 * scale)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_non_finite_samples_are_refused(value: float) -> None:
    with pytest.raises(sf.DescriptionError, match=r"at xi = 0.5|values\[2\] is not a number"):
        sf.Samples((0, 0.25, 0.5, 1), (0, 0.1, value, 1))
