"""A rotor behind a reducer equals the same rotor as a body with a geared coordinate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from symofros.description.forces import Rotor
from tests.models import interpreted, sampled

RATIO, AXIAL, TRANSVERSE, MASS = 37.0, 3e-4, 2e-4, 0.6
# Ratios squared multiply the rotor's inertia; rounding is relative to the largest entry.
ROUNDING = 1e-12


def moving(system: sf.System) -> list[sf.RigidBody]:
    return [body for body in system.bodies if body.joint is not None]


@pytest.mark.parametrize("seed", sampled(range(6), (0, 1)))
@pytest.mark.parametrize("carrier_choice", ["parent", "own link", "elsewhere"])
def test_rotor_equals_a_geared_body(seed: int, carrier_choice: str, rng: np.random.Generator) -> None:
    """Speeds of the explicit model are G v; then M = G^T M' G and h = G^T h' (G is constant).

    Seed 1 drives a revolute joint, which turns the rotor's own carrier.
    """
    stated = random_tree(200 + seed, kinds=("revolute", "ball", "prismatic", "free"))
    bodies = moving(stated)
    driven = next(body for body in reversed(bodies) if body.joint and body.joint.kind in ("revolute", "prismatic"))
    assert driven.joint is not None
    carrier = {"parent": driven.joint.parent, "own link": driven.name, "elsewhere": bodies[0].name}[carrier_choice]
    axis = tuple(rng.standard_normal(3))

    # The rotor's body frame has its spin axis along z.
    z = np.array(axis) / np.linalg.norm(axis)
    x = np.cross(z, [0.3, -0.5, 0.8])
    x /= np.linalg.norm(x)
    frame = sf.Rotation.matrix(np.column_stack([x, np.cross(z, x), z]).tolist())
    solid = sf.Inertia(MASS, (0, 0, 0), (TRANSVERSE, TRANSVERSE, AXIAL))
    bearing = sf.Joint("spin", "revolute", carrier, position=(0.1, 0.2, 0.3), rotation=frame)
    spinning = sf.RigidBody("rotor", bearing, solid)
    assert spinning.joint is not None
    locked = replace(spinning, joint=replace(spinning.joint, kind="fixed"))
    geared = replace(driven, joint=replace(driven.joint, rotors=(Rotor(AXIAL, RATIO, axis, carrier),), actuated=False))
    ours = interpreted(stated.with_bodies(geared, locked))
    explicit = interpreted(stated.with_bodies(spinning))

    k = ours.names.v.index(driven.joint.name)
    G = np.zeros((explicit.nv, ours.nv))
    for i, name in enumerate(explicit.names.v):
        if name == "spin":
            G[i, k] = RATIO
        else:
            G[i, ours.names.v.index(name)] = 1.0
    for _ in range(10):
        q, v = ours.random_state(rng)
        q_full = np.array(
            [
                RATIO * q[ours.names.q.index(driven.joint.name)] if name == "spin" else q[ours.names.q.index(name)]
                for name in explicit.names.q
            ]
        )
        M, h = explicit.mass_matrix(q_full), explicit.bias(q_full, G @ v)
        np.testing.assert_allclose(ours.mass_matrix(q), G.T @ M @ G, atol=ROUNDING * np.abs(G.T @ M @ G).max())
        scale = max(np.abs(h).max(), AXIAL * RATIO * np.abs(v).max() ** 2)
        np.testing.assert_allclose(ours.bias(q, v), G.T @ h, atol=ROUNDING * 10 * scale)
        assert ours.kinetic_energy(q, v) == pytest.approx(float(explicit.kinetic_energy(q_full, G @ v)), rel=1e-12)
        assert ours.potential_energy(q) == pytest.approx(float(explicit.potential_energy(q_full)), rel=1e-11, abs=1e-11)


def test_a_rotor_on_the_ground_is_an_armature(rng: np.random.Generator) -> None:
    solid = sf.Inertia(1.0, (0.2, 0, 0), (1, 1, 1))

    def arm(**joint: object) -> sf.Model:
        return interpreted(sf.System("s", [sf.RigidBody("b", sf.Joint("q", "revolute", **joint), solid)]))  # type: ignore[arg-type]

    rotor, armature = arm(rotors=(Rotor(2e-3, 10.0),)), arm(armature=0.2)
    q, v = rotor.random_state(rng)
    np.testing.assert_allclose(rotor.mass_matrix(q), armature.mass_matrix(q), rtol=1e-15)
    np.testing.assert_allclose(rotor.bias(q, v), armature.bias(q, v), rtol=1e-15)
    assert armature.mass_matrix(q)[0, 0] == pytest.approx(1.0 + 0.04 + 0.2)
