"""The box of a body: its inertia is the body's."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.physics import moments_about_center
from symofros.studio.viewer.drawing.inertia_box import inertia_box

INERTIAS = {
    "principal": sf.Inertia(2.0, (0.1, 0.2, 0.3), (0.03, 0.04, 0.05)),
    "products": sf.Inertia(2.0, (0.1, 0.2, 0.3), (0.03, 0.04, 0.05, 0.004, -0.006, 0.002)),
    "about the body": sf.Inertia(2.0, (0.1, -0.2, 0.3), (0.5, 0.4, 0.35, 0.05, -0.06, 0.12), about="body"),
    "turned axes": sf.Inertia(2.0, (0.0, 0.0, 0.1), (0.03, 0.04, 0.05), rotation=sf.Rotation.rpy(0.3, -0.7, 1.1)),
    "rod": sf.Inertia(1.0, (0.5, 0.0, 0.0), (0.0, 1 / 12, 1 / 12)),
}


def body(inertia: sf.Inertia | None) -> sf.RigidBody:
    return sf.RigidBody("b", sf.Joint("j", "free"), inertia)


@pytest.mark.parametrize("name", INERTIAS)
def test_the_box_has_the_inertia_of_the_body(name: str) -> None:
    inertia, numbers = INERTIAS[name], Numbers(sf.System("s"))
    found = inertia_box(body(inertia), numbers)
    assert found is not None
    a, b, c = found.edges**2
    J = found.axes @ np.diag(np.array([b + c, a + c, a + b]) * inertia.mass / 12) @ found.axes.T
    R = numbers.rotation(inertia.rotation) if inertia.about == "center_of_mass" else np.eye(3)
    assert np.allclose(J, R @ moments_about_center(body(inertia), numbers) @ R.T, atol=1e-12)
    assert np.linalg.det(found.axes) == pytest.approx(1.0)
    assert np.allclose(found.center, inertia.center_of_mass)


@pytest.mark.parametrize("inertia", [None, sf.Inertia(0.0), sf.Inertia(0.0, moments=(0.1, 0.1, 0.1))])
def test_massless_bodies_have_no_box(inertia: sf.Inertia | None) -> None:
    assert inertia_box(body(inertia), Numbers(sf.System("s"))) is None


def test_an_impossible_inertia_has_a_flat_box() -> None:
    found = inertia_box(body(sf.Inertia(1.0, moments=(0.1, 0.1, 0.5))), Numbers(sf.System("s")))
    assert found is not None and found.edges.min() == 0.0 and np.all(np.isfinite(found.edges))


def test_parameters_change_the_box() -> None:
    system = sf.System("s", [body(sf.Inertia("m", moments=("m/6",) * 3))], [sf.Parameter("m", 2.0)])
    found = inertia_box(system.bodies[0], Numbers(system, {"m": 8.0}))
    assert found is not None and np.allclose(found.edges, 1.0)  # A cube of edge one, whatever its mass.
