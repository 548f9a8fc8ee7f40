"""Normal stress of sections against closed forms, and against itself in turned axes."""

from __future__ import annotations

import math

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams import sections
from symofros.description.beams.sections import Material, Section

STEEL = Material(E=210e9, G=80e9, rho=7850.0)
FORCES = np.array([900.0, 10.0, 20.0, 5.0, 7.0, -3.0])


def test_a_rectangle_is_stressed_most_at_a_corner() -> None:
    """N/A +- 6 My/(y z^2) +- 6 Mz/(z y^2)."""
    y, z = 0.04, 0.02
    N, _, _, _, My, Mz = FORCES
    low, high = sections.rectangle(STEEL, y, z).extreme_stresses(FORCES)
    bending = 6 * abs(My) / (y * z**2) + 6 * abs(Mz) / (z * y**2)
    assert [low, high] == pytest.approx([N / (y * z) - bending, N / (y * z) + bending], rel=1e-13)


@pytest.mark.parametrize(
    "shape", [sections.circle(STEEL, 0.03), sections.tube(STEEL, 0.03, 0.004)], ids=["full", "tube"]
)
def test_round_sections_bend_equally_about_any_axis(shape: Section) -> None:
    radius, M = 0.03, math.hypot(FORCES[4], FORCES[5])
    area, moment = (sf.evaluate(value, {}) / 210e9 for value in (shape.EA, shape.EI_y))
    low, high = shape.extreme_stresses(FORCES)
    assert [low, high] == pytest.approx(
        [FORCES[0] / area - M * radius / moment, FORCES[0] / area + M * radius / moment]
    )


@pytest.mark.parametrize(
    "shape", [sections.rectangle(STEEL, 0.05, 0.02), sections.ellipse(STEEL, 0.05, 0.02)], ids=["rectangle", "ellipse"]
)
@pytest.mark.parametrize("angle", [0.3, -1.2, 2.0])
def test_stress_does_not_depend_on_the_axes(shape: Section, angle: float) -> None:
    """The same moments along turned axes, in which EI_yz does not vanish."""
    c, s = math.cos(angle), math.sin(angle)
    R = np.array([[c, s], [-s, c]])
    turned = np.concatenate([FORCES[:1], R @ FORCES[1:3], FORCES[3:4], R @ FORCES[4:]])
    points = np.array([[0.01, 0.0], [0.02, -0.01], [-0.03, 0.004]])
    stress = shape.normal_stress(FORCES, points)
    np.testing.assert_allclose(shape.turned(angle).normal_stress(turned, points @ R.T), stress, rtol=1e-10)
    np.testing.assert_allclose(shape.turned(angle).extreme_stresses(turned), shape.extreme_stresses(FORCES), rtol=1e-10)


def test_stress_integrates_to_the_forces_about_the_axis() -> None:
    """Of a rectangle whose centre is off the axis: N, My and Mz come back as its integrals."""
    y, z, a, b = 0.04, 0.02, 0.013, -0.006
    own = sections.rectangle(STEEL, y, z)
    shifted = Section(own.EA, own.GJ, own.EI_y, own.EI_z, 1.0, 1.0, 1.0, tension_center=(a, b), E=STEEL.E)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    points = np.array([(a + y / 2 * i, b + z / 2 * k) for i in nodes for k in nodes])
    areas = np.array([i * k for i in weights for k in weights]) * y * z / 4
    stress = shifted.normal_stress(FORCES, points)
    sums = [areas @ stress, areas @ (stress * points[:, 1]), -areas @ (stress * points[:, 0])]
    np.testing.assert_allclose(sums, FORCES[[0, 4, 5]], rtol=1e-12)


def test_stresses_without_modulus_or_outline_are_refused() -> None:
    plain = Section(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    with pytest.raises(sf.DescriptionError, match="Young's modulus is not known"):
        plain.extreme_stresses(FORCES)
    with pytest.raises(sf.DescriptionError, match="outline is not known"):
        Section(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, E=1.0).extreme_stresses(FORCES)
