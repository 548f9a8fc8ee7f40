"""Quadrature over a beam's length: Gauss's nodes, Radau's with one at the root, polynomials through nodes."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from symofros.mechanics.beams.quadrature import Nodes, gauss, radau, stations


@pytest.mark.parametrize("points", [2, 3, 24, 89])
def test_gauss_nodes_are_roots_of_legendre_polynomials(points: int) -> None:
    nodes, weights = gauss(points)
    assert list(nodes) == sorted(nodes)
    for node, weight in zip(nodes, weights, strict=True):
        with mpmath.workdps(40):
            root = mpmath.findroot(lambda x: mpmath.legendre(points, x), 2 * mpmath.mpf(node) - 1)
            expected = 2 * (1 - root**2) / ((points + 1) * mpmath.legendre(points + 1, root)) ** 2
            assert node == float((1 + root) / 2)
            assert weight == float(expected / 2)


def test_stations_integrate_across_a_kink_between_intervals() -> None:
    xi, w = stations((0, Fraction(1, 3), 1), 4)
    kinked = np.abs(np.array(xi) - 1 / 3)
    assert np.dot(w, kinked) == pytest.approx((1 / 9 + 4 / 9) / 2, rel=1e-14)


@pytest.mark.parametrize("points", [2, 3, 24, 61])
def test_radau_nodes_are_roots_to_the_last_digit(points: int) -> None:
    nodes, weights = radau(points)
    for node, weight in zip(nodes[1:], weights[1:], strict=True):
        with mpmath.workdps(40):

            def both(x: mpmath.mpf) -> mpmath.mpf:
                return mpmath.legendre(points - 1, x) + mpmath.legendre(points, x)

            root = mpmath.findroot(both, 2 * mpmath.mpf(node) - 1)
            assert node == float((1 + root) / 2)
            assert weight == float((1 - root) / (2 * (points * mpmath.legendre(points - 1, root)) ** 2))


def test_polynomials_through_nodes_are_integrated_exactly_from_the_root_and_beyond() -> None:
    """A cubic on each of two intervals, through Radau's four nodes and Gauss's."""
    nodes = Nodes((0, Fraction(1, 3), 1), (radau(4), gauss(4)))
    x = np.array(nodes.stations)
    values = np.where(x < 1 / 3, x**3 - x, 2.0 - x**2)
    for xi, expected in ((0.2, 0.2**4 / 4 - 0.02), (0.75, 1 / 324 - 1 / 18 + 2 * 0.75 - 0.75**3 / 3 - 2 / 3 + 1 / 81)):
        assert np.dot(nodes.from_root(xi), values) == pytest.approx(expected, rel=1e-14)
        assert np.dot(nodes.beyond(xi), values) == pytest.approx(np.dot(nodes.weights, values) - expected, rel=1e-13)
