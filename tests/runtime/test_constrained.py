"""Pseudo-inverses and null spaces of Jacobians: the same in all units, rounding left out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.base.measures import ANGLE, FORMULA, LENGTH, OTHER, ROTATION, TRANSLATION, Measures
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import (
    RANK,
    WEAK_LEAST,
    WEAK_SIZE,
    WEAK_WORTH,
    deviation,
    eliminate,
    motion,
    natural_sizes,
    null_space,
    pseudo_inverse,
    solve,
)

PLANAR_LOOP = Measures((0, 0, 0), (LENGTH, LENGTH, LENGTH), (ROTATION, ROTATION, ROTATION))


@pytest.mark.parametrize(
    ("phi", "share"), [([0.1, -0.2, 0.05, 0.0], 0.4), ([0.0, 0.0, -0.3, 0.0], 0.3), ([0.0, 0.0, 0.0, 0.7], 0.7)]
)
def test_a_deviation_is_an_angle_or_a_share_of_the_reach(phi: list[float], share: float) -> None:
    """Of a place that turns move by half a metre a radian, of a rotation, of a place that slides alone move."""
    measures = Measures((0, 0, 2, 3), (LENGTH, LENGTH, ANGLE, LENGTH), (ROTATION, TRANSLATION))
    G = np.array([[0.5, 1.0], [0.3, 0.0], [1.0, 0.0], [0.0, 1.0]])
    assert deviation(G, measures, np.array(phi)) == pytest.approx(share)


@pytest.mark.parametrize("L", [1e-7, 1e-3, 1.0, 1e6])
def test_rounding_noise_across_the_plane_is_not_a_constraint(L: float) -> None:
    """Rounding in a row of G was brought to the size of the others: the inverse had entries of 1e16."""
    rng = np.random.default_rng(0)
    G = L * rng.normal(size=(3, 3))
    G[1] = 1e-17 * L * rng.normal(size=3)
    inverse, Z = pseudo_inverse(G, PLANAR_LOOP), null_space(G, PLANAR_LOOP)
    assert Z.shape == (3, 1) and np.abs(G @ Z).max() < 1e-15 * L
    np.testing.assert_allclose(G @ inverse @ G, G, rtol=0, atol=1e-13 * L)
    assert np.abs(inverse[:, 1]).max() <= 1e-3 * np.abs(inverse).max()


@pytest.mark.parametrize("L", 10.0 ** np.arange(-8.0, 9.0, 4.0))
def test_positions_and_rotations_of_a_frame_are_of_full_rank_at_all_sizes(L: float) -> None:
    rng = np.random.default_rng(1)
    measures = Measures((0, 0, 0, 3, 3, 3), (LENGTH,) * 3 + (ANGLE,) * 3, (ROTATION,) * 6 + (TRANSLATION, OTHER))
    size = np.array([L, L, L, 1.0, 1.0, 1.0])
    J = size[:, None] * rng.normal(size=(6, 8))
    J[:, 6] = [0.6, 0.0, 0.8, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(
        J @ pseudo_inverse(J, measures) * size / size[:, None], np.eye(6), atol=1e-7
    )  # Condition 1e8.
    assert null_space(J, measures).shape == (8, 2)


def pivots_one_by_one(G: Array, measures: Measures, inertia: Array) -> list[tuple[int, int]]:
    """Pivots (row, column) of complete pivoting, every entry judged before each."""
    left, size = G.copy(), natural_sizes(G, measures)
    worth = 1.0 / np.sqrt(np.where(inertia > 0.0, inertia, 1e-12 * inertia[inertia > 0.0].min()))
    own = np.abs(G * worth).max(axis=1)
    is_open, pivots = own > 0.0, list[tuple[int, int]]()
    while len(pivots) < G.shape[1]:
        strong = (np.abs(left) > RANK * size) & is_open[:, None]
        is_open &= strong.any(axis=1)
        if not is_open.any():
            break
        weak = (np.abs(left) > WEAK_LEAST * size) & is_open[:, None] & (inertia > 0.0)
        merit = np.where(strong, 1.0, np.where(weak, WEAK_WORTH, 0.0)) * np.abs(left) * worth
        p, d = divmod(int(np.argmax(merit / np.where(own > 0.0, own, 1.0)[:, None])), G.shape[1])
        pivots.append((p, d))
        is_open[p] = False
        of_pivot = size[p] if strong[p, d] else np.maximum(np.abs(left[p]), WEAK_SIZE * size[p])
        for i in np.flatnonzero(is_open):
            factor = left[i, d] / left[p, d]
            size[i] = np.maximum(size[i], abs(factor) * of_pivot)
            left[i] = left[i] - factor * left[p]
            left[i, d] = 0.0
    return pivots


@given(
    st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(1, 12), st.floats(0.1, 1.0), st.sampled_from([0, 3, 12])
)
def test_rows_that_a_pivot_leaves_alone_are_not_judged_again(
    seed: int, nc: int, nv: int, share: float, decades: int
) -> None:
    """The same pivots as if all were: of sparse, of repeated and of badly scaled rows, and with massless speeds."""
    rng = np.random.default_rng(seed)
    G = rng.standard_normal((nc, nv)) * (rng.random((nc, nv)) < share)
    G[rng.integers(nc)] = G[rng.integers(nc)]
    G *= 10.0 ** rng.uniform(-decades, 0.0, (nc, 1))
    inertia = np.where(rng.random(nv) < 0.2, 0.0, 10.0 ** rng.uniform(-decades, 0.0, nv))
    inertia[rng.integers(nv)] = 1.0
    measures = Measures(tuple(range(nc)), (LENGTH,) * nc, (ROTATION,) * nv)
    made = eliminate(G, measures, inertia)
    assert list(zip(made.rows, made.columns, strict=True)) == pivots_one_by_one(G, measures, inertia)
    scale = np.abs(G).max(axis=1, keepdims=True) + 1e-9
    assert (np.abs(made.L @ made.U - G)[made.rows] <= 1e-9 * scale[made.rows]).all()


def test_a_weak_entry_of_a_massless_speed_is_no_pivot() -> None:
    """Beside a heavy body that the row binds: an entry that is rounding of none, of a speed without inertia."""
    measures = Measures((0,), (LENGTH,), (TRANSLATION,) * 3)
    G = np.array([[0.0, 1.0, 1e-8]])
    for inertia, column in (([1.0, 1e12, 0.0], 1), ([1.0, 1e12, 1e-12], 2), ([1.0, 1.0, 0.0], 1)):
        assert eliminate(G, measures, np.array(inertia)).columns.tolist() == [column]


FADING = Measures((0, 1, 2, 3), (FORMULA,) * 4, (0,) * 4)


def fading_terms(q: np.ndarray) -> list[np.ndarray]:
    """q0 = 0, q0 + q3/20 = 0, q3^2 (1 + q1) = 0, which binds nothing more there; beyond q1 = 1/2 q2 = 0."""
    beyond = float(q[1] >= 0.5)
    phi = np.array([q[0], q[0] + 0.05 * q[3], q[3] ** 2 * (1.0 + q[1]), beyond * q[2]])
    G = np.array([[1, 0, 0, 0], [1, 0, 0, 0.05], [0, q[3] ** 2, 0, 2.0 * q[3] * (1.0 + q[1])], [0, 0, beyond, 0.0]])
    return [np.eye(4), np.zeros(4), G, np.zeros(4), np.ones(4), phi]


def fading_rank(q: np.ndarray) -> int:
    """The rank that the motion beside these constraints is given."""
    return motion(fading_terms(q), fading_terms, lambda at, step: at + step, q, FADING)[2]


@pytest.mark.parametrize("size", [1e-3, 1e-4])
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_rows_that_fade_take_no_part_in_steps_towards_the_constraints(size: float, share: float) -> None:
    """A step by what the third leaves of q1 leads where q2 is bound; the second waits until |phi| does not fall."""
    q = np.array([size, 0.0, 0.0, 0.9 * share * size / 0.05])
    M, r, G, c, *_ = fading_terms(q)
    assert solve(M, r, G, c, FADING)[2] == 3
    assert fading_rank(q) == 2


@pytest.mark.parametrize("backend", ["interpreter", "tape"])
@pytest.mark.parametrize("scale", [1e-30, 1e20])
def test_a_coupling_holds_whatever_its_formula_is_multiplied_by(scale: float, backend: Any) -> None:
    """It has no unit in which anything would be small: a mass that falls draws another one along."""
    falls, drawn = (
        sf.RigidBody(name, sf.Joint(name, "prismatic", axis=axis), sf.Inertia(1.0))
        for name, axis in (("z", (0, 0, 1)), ("x", (1, 0, 0)))
    )
    line = sf.Coupling("line", f"{scale!r}*(z - x)")
    model = sf.compile(sf.System("drawn", (falls, drawn), constraints=(line,)), sf.Options(backend=backend))
    np.testing.assert_allclose(model.forward_dynamics([0, 0], [0, 0], []), [-9.81 / 2] * 2, rtol=1e-12)
