"""Couplings: conditions on coordinates by formula, against the tree that has one coordinate less, and against time."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.models import interpreted

LEVER = sf.Inertia(1.5, (0.3, 0.1, 0.0), (0.1, 0.2, 0.25))


def arm(*couplings: sf.Coupling, **changes: object) -> sf.System:
    """Three levers in a row, the last of which slides."""
    bodies = (
        sf.RigidBody("a", sf.Joint("q1", "continuous", axis=(0, 1, 0), actuated=True), LEVER),
        sf.RigidBody("b", sf.Joint("q2", "continuous", "a", position=(0.6, 0, 0), axis=(0, 1, 0)), LEVER),
        sf.RigidBody("c", sf.Joint("q3", "prismatic", "b", axis=(1, 0, 0)), LEVER),
    )
    return sf.System("arm", bodies, (sf.Parameter("ratio", 2.5),), constraints=couplings)


GEAR = sf.Coupling("gear", "q2 - ratio*q1 - 0.25")
CAM = sf.Coupling("cam", "q3 - 0.2*sin(q1) - 0.05*q2^2")


def test_a_gear_moves_as_the_mechanism_with_one_coordinate_less() -> None:
    tree, geared = interpreted(arm()), interpreted(arm(GEAR))
    q, v, u = np.array([0.4, 1.25, 0.1]), np.array([0.7, 1.75, -0.3]), np.array([3.0])
    T = np.array([[1.0, 0.0], [2.5, 0.0], [0.0, 1.0]])
    force = tree.generalized_force(q, v, u) - tree.bias(q, v)
    reduced = np.linalg.solve(T.T @ tree.mass_matrix(q) @ T, T.T @ force)
    np.testing.assert_allclose(geared.forward_dynamics(q, v, u), T @ reduced, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(geared.constraint(q), 0.0, atol=1e-15)


@pytest.mark.parametrize("seed", range(5))
def test_rows_are_the_slope_and_the_curvature_of_the_residual(seed: int) -> None:
    model = interpreted(arm(GEAR, CAM))
    q, v = np.random.default_rng(seed).normal(size=(2, 3))
    G = [[-2.5, 1.0, 0.0], [-0.2 * np.cos(q[0]), -0.1 * q[1], 1.0]]
    np.testing.assert_allclose(model.constraint_jacobian(q), G, atol=1e-14)
    gamma = [0.0, -0.2 * np.sin(q[0]) * v[0] ** 2 + 0.1 * v[1] ** 2]
    np.testing.assert_allclose(G @ model.forward_dynamics(q, v, [0.0]), gamma, atol=1e-11)


def test_runs_stay_on_a_cam_and_keep_their_energy() -> None:
    model = sf.compile(arm(GEAR, CAM))
    start = sf.assemble(model, q=[0.2, 0.75, 0.1], held=["q1"]).q
    run = sf.simulate(model, start, t_end=0.5, u=[0.0])
    assert np.abs([model.constraint(q) for q in run.q]).max() < 1e-9
    energy = np.array(
        [model.kinetic_energy(q, v) + model.potential_energy(q) for q, v in zip(run.q, run.v, strict=True)]
    )
    assert np.ptp(energy) < 1e-6 * np.abs(energy).max()


def test_a_prescribed_coordinate_drives_coupled_ones() -> None:
    bodies = list(arm().bodies)
    bodies[0] = sf.RigidBody("a", sf.Joint("q1", "continuous", axis=(0, 1, 0), prescribed=True), LEVER)
    model = interpreted(sf.System("arm", bodies, (sf.Parameter("ratio", 2.5),), constraints=(GEAR,)))
    u = [0.3, 0.8, -2.0]
    assert model.forward_dynamics([1.0, 0.1], [2.0, 0.0], u)[0] == pytest.approx(2.5 * -2.0, rel=1e-12)
