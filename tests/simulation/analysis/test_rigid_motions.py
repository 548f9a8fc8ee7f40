"""Rigid motions among modes: as many as there are, whatever rounding makes of their double zeros."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from symofros.simulation.analysis.rigid_motions import _unit, rigid_motions
from tests.models import interpreted

SOLID = sf.Inertia(1.3, (0.2, 0.1, -0.3), (1.0, 1.2, 0.9))


def test_directions_are_of_unit_length(rng: np.random.Generator) -> None:
    """Those of no length stay so."""
    directions = rng.standard_normal((4, 3)) + 1j * rng.standard_normal((4, 3))
    directions[:, 1] = 0.0
    unit = _unit(directions)
    np.testing.assert_allclose(np.linalg.norm(unit, axis=0), [1.0, 0.0, 1.0], rtol=1e-12)
    factors = unit / np.where(directions == 0.0, 1.0, directions)
    np.testing.assert_allclose(factors, np.tile(factors[0], (4, 1)), rtol=1e-12)


@given(seed=st.integers(0, 10**6))
def test_which_motions_are_rigid_depends_on_neither_their_order_nor_their_size(seed: int) -> None:
    """For any matrix and any eigenvalues about the size of rounding."""
    rng = np.random.default_rng(seed)
    nv = int(rng.integers(1, 4))
    k = 2 * nv
    A, basis = rng.standard_normal((k, k)) * 10.0 ** rng.uniform(-3, 3, (k, 1)), np.eye(k)
    states, inertia = rng.standard_normal((k, k)) + 1j * rng.standard_normal((k, k)), 10.0 ** rng.uniform(-2, 2, nv)
    s = np.linalg.norm(A) * 10.0 ** rng.uniform(-9, 0, k) + 0j
    zeros = rigid_motions(A, basis, s, states, inertia).zeros
    order = rng.permutation(k)
    np.testing.assert_array_equal(rigid_motions(A, basis, s[order], states[:, order], inertia).zeros, zeros[order])
    sized = states * 10.0 ** rng.uniform(-6, 6, k)
    np.testing.assert_array_equal(rigid_motions(A, basis, s, sized, inertia).zeros, zeros)


def floating(noise: np.ndarray, links: int, stiffness: float, damping: float = 0.0) -> sf.System:
    """A chain of links on springs that floats, its frames and axes off by noise (links, 6)."""
    bodies = [sf.RigidBody("base", sf.Joint("base", "free"), SOLID)]
    for i, (position, axis) in enumerate(zip(noise[:, :3], noise[:, 3:], strict=True)):
        place, turn = np.array([0.3, 0.1, 0.2]) + position, np.eye(3)[i % 3] + axis
        elements = [sf.Spring(stiffness * 10.0 ** (i % 3)), *([sf.Damper(damping)] if damping else [])]
        joint = sf.Joint(
            f"q{i}", "revolute", bodies[-1].name, position=tuple(place), axis=tuple(turn), elements=elements
        )
        bodies.append(sf.RigidBody(f"b{i}", joint, SOLID))
    return sf.System("floating", bodies, gravity=(0, 0, 0))


@settings(max_examples=12)
@given(
    seed=st.integers(0, 10**6),
    links=st.integers(1, 6),
    size=st.sampled_from([0.0, 1e-16, 1e-13, 1e-10, 1e-6]),
    stiffness=st.sampled_from([1e-3, 1.0, 1e9]),
    damping=st.sampled_from([0.0, 1e-3]),
)
def test_a_floating_tree_has_six_rigid_motions(
    seed: int, links: int, size: float, stiffness: float, damping: float
) -> None:
    """Base anywhere and turned; by the way of many speeds and by derivatives in motion."""
    rng = np.random.default_rng(seed)
    model = interpreted(floating(size * rng.normal(size=(links, 6)), links, stiffness, damping))
    q = model.integrate(model.neutral(), np.r_[rng.normal(size=6), np.zeros(links)])
    found = sf.modes(model, q)
    assert len(found.frequencies) == model.nv
    np.testing.assert_array_equal(found.eigenvalues[:6], 0.0)
    assert (found.frequencies[6:] > 0.0).all()
    assert (found.damping[:6] == 0.0).all()
    # Shapes of rigid motions leave the springs as they are.
    assert np.abs(found.shapes[6:, :6]).max() < 1e-6
    assert np.linalg.matrix_rank(found.shapes[:6, :6], tol=1e-6) == 6


@pytest.mark.parametrize("ratio", [1e-3, 1e-6, 1e-9])
def test_a_soft_mode_is_not_a_rigid_motion(ratio: float) -> None:
    """Beside one that is faster by up to 1e9: its own stiffness is no small difference."""
    soft = sf.Joint("soft", "prismatic", elements=[sf.Spring(ratio**2)])
    stiff = sf.Joint("stiff", "prismatic", "a", axis=(1, 0, 0), elements=[sf.Spring(1.0)])
    bodies = [sf.RigidBody("a", soft, SOLID), sf.RigidBody("b", stiff, SOLID)]
    found = sf.modes(interpreted(sf.System("s", bodies, gravity=(0, 0, 0))), [0.0, 0.0])
    assert len(found.frequencies) == 2
    assert found.frequencies[0] == pytest.approx(ratio / np.sqrt(2 * 1.3), rel=1e-3)


def test_two_sliding_bodies_joined_by_a_spring_have_one_rigid_motion() -> None:
    """Two bodies joined by a spring, each with a joint to the world: K = k [1, -1; -1, 1], whose zero is rounding."""
    bodies = [
        sf.RigidBody(f"b{i}", sf.Joint(f"q{i}", "prismatic", position=(0, float(i), 0)), SOLID, [sf.Frame(f"f{i}")])
        for i in range(2)
    ]
    spring = sf.Connection("k", ("b0", "f0"), ("b1", "f1"), stiffness=1234.5)
    found = sf.modes(interpreted(sf.System("pair", bodies, connections=[spring], gravity=(0, 0, 0))), [0.3, 0.3])
    assert len(found.frequencies) == 2
    assert found.frequencies[0] == 0.0
    np.testing.assert_allclose(found.shapes[:, 0], found.shapes[0, 0], rtol=1e-6)


def test_a_damped_free_motion_has_one_zero_and_one_rate() -> None:
    joint = sf.Joint("q", "prismatic", elements=[sf.Damper(0.26)])
    found = sf.modes(interpreted(sf.System("s", [sf.RigidBody("b", joint, SOLID)], gravity=(0, 0, 0))), [0.1])
    np.testing.assert_allclose(found.eigenvalues, [0.0, -0.2], rtol=1e-12)


def test_a_freely_turning_loop_has_one_rigid_motion() -> None:
    """A four-bar without weight: one motion, on constraints that repeat each other out of the plane."""
    without = interpreted(replace(MODELS["four_bar"], gravity=(0, 0, 0)))
    q = without.neutral()
    q[0] = 1.2
    closed = sf.assemble(without, q, held=["q1"])
    found = sf.modes(without, closed.q)
    assert len(found.frequencies) == 1
    assert found.frequencies[0] == 0.0
