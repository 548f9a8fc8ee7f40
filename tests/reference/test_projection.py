"""M and h of whole mechanisms by projecting Newton's and Euler's equations of each body on its partial velocities.

Another route than the recursion's: world axes, the mass centre of every body, Jacobians of frames.
"""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.mechanics.topology.numbers import Numbers
from tests.models import sampled
from tests.reference.motion import Array, reference

# Of sums of some ten bodies' terms, relative to the largest entry.
ROUNDING = 1e-12
NAMES = (
    "torque_free_body",
    "heavy_top",
    "puma560",
    "stanford_arm",
    "friction_arm",
    "joint_zoo",
    "car",
    "space_arm",
    "random_tree1",
    "random_tree4",
    "random_tree70",
)
# Wheels, rotors and friction, joints of every kind, branches.
SMALL = ("heavy_top", "friction_arm", "joint_zoo", "car", "space_arm", "random_tree4")


def central(body: sf.RigidBody, numbers: Numbers) -> tuple[float, Array, Array]:
    """Mass, mass centre, and inertia about it in body axes."""
    assert body.inertia is not None
    mass, center = numbers.value(body.inertia.mass), numbers.values(body.inertia.center_of_mass)
    xx, yy, zz, xy, xz, yz = numbers.values(body.inertia.moments)
    J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if body.inertia.about == "body":
        return mass, center, J - mass * (center @ center * np.eye(3) - np.outer(center, center))
    R = numbers.rotation(body.inertia.rotation)
    return mass, center, R @ J @ R.T


@pytest.mark.parametrize("name", sampled(NAMES, SMALL))
def test_equations_match_projected_newton_euler_equations(name: str, rng: np.random.Generator) -> None:
    model, system = reference(name), MODELS[name]
    numbers = Numbers(system)
    gravity = numbers.values(system.gravity)
    for _ in range(5):
        q, v = model.random_state(rng)
        M, h = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
        for body in system.bodies:
            assert isinstance(body, sf.RigidBody)
            if body.joint is not None and body.joint.armature:
                k = model.names.v.index(body.joint.name)
                M[k, k] += numbers.value(body.joint.armature)
            if body.joint is None or body.inertia is None:
                continue
            mass, center, J = central(body, numbers)
            _, R = model.frame_pose(body.name, q)
            jacobian, still = model.frame_jacobian(body.name, q), np.zeros(model.nv)
            w, bias = model.frame_velocity(body.name, q, v)[3:], model.frame_acceleration(body.name, q, v, still)
            r, inertia = R @ center, R @ J @ R.T
            turn = jacobian[3:]
            move = jacobian[:3] - np.cross(r, turn, axisb=0, axisc=0)
            M += mass * move.T @ move + turn.T @ inertia @ turn
            acceleration = bias[:3] + np.cross(bias[3:], r) + np.cross(w, np.cross(w, r)) - gravity
            h += move.T @ (mass * acceleration) + turn.T @ (inertia @ bias[3:] + np.cross(w, inertia @ w))
        np.testing.assert_allclose(model.mass_matrix(q), M, rtol=0, atol=ROUNDING * np.abs(M).max())
        np.testing.assert_allclose(model.bias(q, v), h, rtol=0, atol=ROUNDING * max(np.abs(h).max(), 1.0))
