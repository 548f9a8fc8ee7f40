"""The configuration manifold: numbers and the graph take the same formulas; identities at any angle."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symofros.base.arrays import Array
from symofros.base.rotations import cross, normalized
from symofros.expr.derivative import directional
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges
from symofros.expr.program import Program
from symofros.expr.quaternion import Quaternion
from symofros.expr.terms import edges_of, terms
from symofros.expr.vector import Vec3
from symofros.runtime.manifold import along_speeds, chart_coordinates, chart_rate, difference, integrate, retract
from symofros.runtime.record import Segment

SEGMENTS = (
    Segment("linear", 0, 0, 2),
    Segment("quaternion", 2, 2, 4),
    Segment("pose", 6, 5, 7),
    Segment("linear", 13, 11, 1),
)
NQ, NV = 14, 12
ROTATIONS = (slice(2, 5), slice(8, 11))
# A few operations on numbers of the size of one.
ROUNDING = 2e-15

# Half of the angles are tiny or near a half turn, where closed forms and square roots lose digits.
ANGLES = st.one_of(
    st.sampled_from([0.0, 1e-300, 1e-160, 1e-16, 1e-9, 1e-8, 1e-5, 0.99e-4, 1e-4, 1e-3, 1e-2, 0.0999, 0.1, 0.1001]),
    st.floats(0.0, 3.1),
    st.floats(-14.0, -2.0).map(lambda exponent: np.pi - 10.0**exponent),
)
SEEDS = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize(("a", "b"), [((3,), (3,)), ((4, 3), (4, 3)), ((3,), (7, 3)), ((5, 1, 3), (2, 3))])
def test_products_of_vectors_have_the_bits_of_numpys(a: tuple[int, ...], b: tuple[int, ...]) -> None:
    rng = np.random.default_rng(4)
    x, y = rng.standard_normal(a), rng.standard_normal(b)
    np.testing.assert_array_equal(cross(x, y), np.cross(x, y), strict=True)


def configuration(rng: np.random.Generator) -> Array:
    q = rng.uniform(-1.0, 1.0, NQ)
    for i in (2, 9):
        q[i : i + 4] = normalized(rng.standard_normal(4))
    return q


def step(rng: np.random.Generator, angles: tuple[float, float]) -> Array:
    """A step (NV) whose two rotations have these angles, about random axes."""
    dq = rng.uniform(-1.0, 1.0, NV)
    for rotation, angle in zip(ROTATIONS, angles, strict=True):
        dq[rotation] = angle * normalized(rng.standard_normal(3))
    return dq


class OnGraph:
    """The same manifold by quaternions of a graph, whose inputs are q0, theta and v."""

    def __init__(self) -> None:
        g = self.g = Graph()
        self.q0 = [g.input("q", i) for i in range(NQ)]
        self.theta, self.v = ([g.input(name, i) for i in range(NV)] for name in ("x", "v"))

    def retracted(self) -> list[Edge]:
        """The coordinates at theta in the chart about q0."""
        return edges_of(self.g, retract(SEGMENTS, terms(self.g, self.q0), terms(self.g, self.theta)))

    def rates(self, q: list[Edge]) -> list[Edge]:
        """The rates N(q) v of coordinates."""
        g, v = self.g, self.v

        def rotation_rate(quaternion: Quaternion, start: int) -> list[Edge]:
            columns = [tuple(quaternion.rate(k)) for k in range(3)]
            return [g.sum(g.mul(columns[k][i], v[start + k]) for k in range(3)) for i in range(4)]

        ball, pose = Quaternion.of(g, *q[2:6]), Quaternion.of(g, *q[9:13])
        linear = pose.matrix.times(Vec3(g, *v[5:8]))
        return [v[0], v[1], *rotation_rate(ball, 2), *linear, *rotation_rate(pose, 8), v[11]]


def values(g: Graph, edges: list[Edge], **inputs: Array) -> Array:
    """The values of edges, where the inputs have these values."""
    columns = evaluate_edges(
        Program("manifold", g, {}, ()), edges, {name: value[None] for name, value in inputs.items()}, {}
    )
    return np.array([np.ravel(column)[0] for column in columns])


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=60)
def test_a_chart_leads_where_the_graph_leads(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    q0, theta = configuration(rng), step(rng, (first, second))
    graph = OnGraph()
    expected = values(graph.g, graph.retracted(), q=q0, x=theta)
    np.testing.assert_allclose(retract(SEGMENTS, q0, theta), expected, atol=ROUNDING, rtol=0)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=60)
def test_the_rate_of_a_chart_makes_the_rates_of_the_coordinates(seed: int, first: float, second: float) -> None:
    """The derivative of the graph's retraction along theta' equals N(q) v at the retracted configuration."""
    rng = np.random.default_rng(seed)
    q0, theta, v = configuration(rng), step(rng, (first, second)), rng.uniform(-1.0, 1.0, NV)
    graph = OnGraph()
    g, q = graph.g, graph.retracted()
    theta_rate = [g.input("rate", i) for i in range(NV)]
    moved = directional(g, q, dict(zip(graph.theta, theta_rate, strict=True)))
    inputs = {"q": q0, "x": theta, "v": v, "rate": chart_rate(SEGMENTS, theta, v)}
    by_chart, by_speeds = values(g, moved, **inputs), values(g, graph.rates(q), **inputs)
    # The rate of a rotation vector is at most some pi times the speed up to a half turn.
    np.testing.assert_allclose(by_chart, by_speeds, atol=10 * ROUNDING, rtol=0)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=80)
def test_the_coordinates_of_a_chart_undo_its_retraction(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    q0, theta = configuration(rng), step(rng, (first, second))
    q1 = retract(SEGMENTS, q0, theta)
    again = retract(SEGMENTS, q0, chart_coordinates(SEGMENTS, q0, q1))
    again[2:6], again[9:13] = (x * np.sign(x @ y) for x, y in ((again[2:6], q1[2:6]), (again[9:13], q1[9:13])))
    np.testing.assert_allclose(again, q1, atol=10 * ROUNDING, rtol=0)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=80)
def test_difference_undoes_integrate_at_any_angle(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    q0, dq = configuration(rng), step(rng, (first, second))
    found = difference(SEGMENTS, q0, integrate(SEGMENTS, q0, dq))
    np.testing.assert_allclose(found, dq, atol=20 * ROUNDING, rtol=0)


@given(SEEDS, ANGLES)
@settings(max_examples=40)
def test_graph_and_numeric_differences_of_configurations_agree(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    q0, dq = configuration(rng), step(rng, (angle, angle))
    q1 = integrate(SEGMENTS, q0, dq)
    g = Graph()
    a, b = (terms(g, [g.input(name, i) for i in range(NQ)]) for name in ("a", "b"))
    found = values(g, edges_of(g, difference(SEGMENTS, a, b)), a=q0, b=q1)
    np.testing.assert_allclose(found, difference(SEGMENTS, q0, q1), atol=ROUNDING, rtol=1e-15)


def test_slopes_along_speeds_are_those_of_a_function_of_the_coordinates(rng: np.random.Generator) -> None:
    """Of all kinds of segments, at quaternions of unit length; of many states, too."""
    q = rng.standard_normal((3, NQ))
    for start in (2, 9):
        q[:, start : start + 4] /= np.linalg.norm(q[:, start : start + 4], axis=1, keepdims=True)
    weights, h = rng.standard_normal((3, NQ)), 1e-5
    found = along_speeds(SEGMENTS, q, weights)
    for k, unit in enumerate(np.eye(NV)):
        ahead, behind = (retract(SEGMENTS, q, s * h * unit) for s in (1.0, -1.0))
        slope = ((ahead - behind) * weights).sum(axis=1) / (2 * h)
        np.testing.assert_allclose(found[:, k], slope, atol=1e-9)
