"""Momentum about the mass centre: its matrix, its rate, what changes it, and Pinocchio's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import SAMPLE, system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

FUNCTIONS = (
    "center_of_mass",
    "centroidal_momentum",
    "centroidal_momentum_matrix",
    "centroidal_momentum_rate",
    "forward_dynamics",
)


@pytest.mark.parametrize("name", SAMPLE)
def test_momenta_are_those_of_the_bodies_about_the_mass_centre(name: str) -> None:
    assert_agrees(identities.momenta, system(name))


@pytest.mark.parametrize("name", ["double_pendulum", "space_arm", "spinning_beam", "soft_pendulum", "free_boom"])
def test_the_mass_centre_is_where_the_weight_acts(name: str, rng: np.random.Generator) -> None:
    """A field g along an axis adds -m g.p_WScm to the potential energy, of deflected beams as well."""
    functions = ("center_of_mass", "potential_energy")
    zero, *fields = (
        sf.compile(
            replace(MODELS[name], gravity=tuple(map(float, g))), sf.Options(functions=functions, backend="interpreter")
        )
        for g in (np.zeros(3), *np.eye(3))
    )
    masses = []
    for _ in range(2):
        q, _ = zero.random_state(rng)
        u = rng.normal(size=zero.nu)
        moment = np.array([zero.potential_energy(q, u=u) - m.potential_energy(q, u=u) for m in fields])
        p_WScm = zero.center_of_mass(q, u=u)
        masses.append(moment @ p_WScm / (p_WScm @ p_WScm))
        np.testing.assert_allclose(masses[-1] * p_WScm, moment, rtol=0, atol=1e-10 * np.linalg.norm(moment))
    assert masses[0] == pytest.approx(masses[1], rel=1e-10)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (1.0, -2.0, -9.81)], ids=["no weight", "weight"])
@pytest.mark.parametrize("name", ["space_arm", "torque_free_body", "free_boom"])
def test_momentum_of_a_floating_system_changes_by_its_weight(
    name: str, gravity: tuple[float, float, float], rng: np.random.Generator
) -> None:
    """Efforts of joints are internal; of a beam, deflections too."""
    if name == "free_boom" and any(gravity):
        pytest.skip("the weight of a beam's deflections counts one order further than its momentum")
    system = replace(MODELS[name], gravity=gravity)
    m = sf.compile(system, sf.Options(functions=FUNCTIONS, backend="interpreter"))
    q, v = m.random_state(rng)
    v[6:] *= 0.1
    # The boom's only input is a thrust, from outside.
    a = m.forward_dynamics(q, v, np.zeros(m.nu) if name == "free_boom" else rng.normal(size=m.nu))
    rate = m.centroidal_momentum_rate(q, v, a)
    # Along the base's own axes all moves alike: these columns are the mass times a rotation.
    mass = np.cbrt(np.linalg.det(m.centroidal_momentum_matrix(q)[:3, :3]))
    scale = max(1.0, np.abs(m.centroidal_momentum_matrix(q) @ a).max())
    np.testing.assert_allclose(rate[:3], mass * np.array(gravity), rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(rate[3:], 0.0, rtol=0, atol=1e-9 * scale)


def test_a_prescribed_base_brings_its_momentum(rng: np.random.Generator) -> None:
    """A lump on a slide whose motion is prescribed: momentum m x', rate m x''."""
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), prescribed=True)
    m = sf.compile(
        sf.System("driven", [sf.RigidBody("lump", slide, sf.Inertia(3.0))]), sf.Options(backend="interpreter")
    )
    none, u = np.zeros(0), np.array([0.2, 0.5, -0.7])
    assert m.center_of_mass(none, u=u) == pytest.approx([0.2, 0, 0])
    assert m.centroidal_momentum(none, none, u=u)[:3] == pytest.approx([1.5, 0, 0])
    assert m.centroidal_momentum_rate(none, none, none, u=u)[:3] == pytest.approx([-2.1, 0, 0])


MOTOR = """\
symofros: 1
bodies:
  shaft:
    waive: [massless_tip]
    joint: {name: q, kind: revolute, armature: 1}
"""


def test_massless_models_have_no_mass_centre(tmp_path: Path) -> None:
    file = tmp_path / "motor.yaml"
    file.write_text(MOTOR, encoding="utf-8")
    m = sf.compile(sf.load(file))
    with pytest.raises(sf.DescriptionError, match="no mass centre"):
        m.center_of_mass([0.1])
