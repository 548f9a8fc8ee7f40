"""Shear stress of sections: its integrals are the forces, its energy the stiffness, and it leaves the outline free."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams import sections
from symofros.description.beams.sections import Material, Section

STEEL = Material(E=210e9, G=80e9, rho=7850.0)
SHAPES = {
    "square": sections.rectangle(STEEL, 0.03, 0.03),
    "high": sections.rectangle(STEEL, 0.05, 0.02),
    "wide": sections.rectangle(STEEL, 0.004, 0.06),
    "circle": sections.circle(STEEL, 0.02),
    "ellipse": sections.ellipse(STEEL, 0.05, 0.02),
    "tube": sections.tube(STEEL, 0.03, 0.012),
    "thin tube": sections.tube(STEEL, 0.03, 0.0001),
}
Array = np.ndarray


def number(value: object) -> float:
    return float(sf.evaluate(value, {}))


def quadrature(section: Section) -> tuple[Array, Array]:
    """Points (n, 2) and areas of a rule of Gauss over the section."""
    assert section.shape is not None
    a, b = (number(size) for size in section.shape.sizes)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    if section.shape.kind == "rectangle":
        points = np.stack(np.meshgrid(0.5 * a * nodes, 0.5 * b * nodes, indexing="ij"), axis=-1)
        return points.reshape(-1, 2), np.outer(weights, weights).reshape(-1) * a * b / 4.0
    inner = b / a if section.shape.kind == "tube" else 0.0
    radius, angle = 0.5 * (1.0 + inner) + 0.5 * (1.0 - inner) * nodes, np.arange(64) * (2.0 * math.pi / 64)
    axes = (a, a) if section.shape.kind == "tube" else (a, b)
    points = np.stack([axes[0] * np.outer(radius, np.cos(angle)), axes[1] * np.outer(radius, np.sin(angle))], axis=-1)
    areas = np.outer(0.5 * (1.0 - inner) * weights * radius, np.full(64, 2.0 * math.pi / 64)) * axes[0] * axes[1]
    return points.reshape(-1, 2), areas.reshape(-1)


UNITS = np.eye(6)[1:4]  # Vy, Vz, T.


@pytest.mark.parametrize("name", SHAPES)
def test_shear_stresses_integrate_to_the_section_forces(name: str) -> None:
    points, areas = quadrature(SHAPES[name])
    stress = SHAPES[name].shear_stress(UNITS, points)
    forces = np.einsum("p,kpi->ki", areas, stress)
    torque = np.einsum("p,kp->k", areas, points[:, 0] * stress[..., 1] - points[:, 1] * stress[..., 0])
    size = math.sqrt(areas.sum())
    np.testing.assert_allclose(forces[:2], np.eye(2), atol=1e-6)
    np.testing.assert_allclose(forces[2] * size, 0.0, atol=1e-6)
    np.testing.assert_allclose(torque, [0.0, 0.0, 1.0], atol=1e-6 * size + 1e-6)


@pytest.mark.parametrize("name", SHAPES)
def test_shear_energy_matches_the_stiffnesses(name: str) -> None:
    """1/GA_y, 1/GA_z, 1/GJ, and none between them: what (27), (28), (28b) and (28d) say in sums of their own."""
    section = SHAPES[name]
    points, areas = quadrature(section)
    stress = section.shear_stress(UNITS, points)
    energy = np.einsum("p,kpi,lpi->kl", areas, stress, stress) / 80e9
    stated = np.array([1.0 / number(getattr(section, label)) for label in ("GA_y", "GA_z", "GJ")])
    scale = np.sqrt(stated)
    np.testing.assert_allclose(energy / np.outer(scale, scale), np.eye(3), atol=2e-5)


@pytest.mark.parametrize("name", SHAPES)
def test_shear_stress_is_in_equilibrium_and_compatible(name: str) -> None:
    """div tau = -dsigma_x/dx; the curl is constant under a torque, and 2 nu/(1 + nu)/2 of the bending under a force."""
    section, size = SHAPES[name], math.sqrt(quadrature(SHAPES[name])[1].sum())
    points = quadrature(section)[0][500::700]
    h = 1e-5 * size
    rates = [
        (section.shear_stress(UNITS, points + step) - section.shear_stress(UNITS, points - step)) / (2.0 * h)
        for step in (np.array([h, 0.0]), np.array([0.0, h]))
    ]
    divergence = rates[0][..., 0] + rates[1][..., 1]
    curl = rates[1][..., 0] - rates[0][..., 1]
    I_z, I_y, J = (number(getattr(section, label)) for label in ("EI_z", "EI_y", "GJ"))
    bending = np.stack([points[:, 0] * 210e9 / I_z, points[:, 1] * 210e9 / I_y, 0.0 * points[:, 0]])
    lateral = 1.0 - 2.0 * 80.0 / 210.0
    across = [
        lateral * points[:, 1] * 210e9 / I_z,
        -lateral * points[:, 0] * 210e9 / I_y,
        np.full(len(points), -2 * 80e9 / J),
    ]
    scale = np.abs(divergence).max(axis=1, keepdims=True) + np.abs(curl).max(axis=1, keepdims=True)
    np.testing.assert_allclose(divergence / scale, -bending / scale, atol=1e-5)
    np.testing.assert_allclose(curl / scale, np.stack(across) / scale, atol=1e-5)


@pytest.mark.parametrize("name", SHAPES)
def test_shear_stress_is_tangential_at_the_outline(name: str) -> None:
    section = SHAPES[name]
    assert section.shape is not None
    a, b = (number(size) for size in section.shape.sizes)
    angle = np.linspace(0.1, 6.3, 23)
    c, s = np.cos(angle), np.sin(angle)
    if section.shape.kind == "rectangle":
        at = np.linspace(-0.5, 0.5, 9)
        outlines = [
            (np.stack([0 * at + a / 2, at * b], -1), np.array([1.0, 0.0])),
            (np.stack([at * a, 0 * at - b / 2], -1), np.array([0.0, 1.0])),
        ]
    elif section.shape.kind == "tube":
        outlines = [(radius * np.stack([c, s], -1), np.stack([c, s], -1)) for radius in (a, b)]
    else:
        outlines = [(np.stack([a * c, b * s], -1), np.stack([b * c, a * s], -1) / np.hypot(b * c, a * s)[:, None])]
    most = np.abs(section.shear_stress(UNITS, quadrature(section)[0])).max(axis=(1, 2))
    for points, normal in outlines:
        across = np.sum(section.shear_stress(UNITS, points) * normal, axis=-1)
        np.testing.assert_allclose(across / most[:, None], 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["high", "ellipse", "tube"])
@pytest.mark.parametrize("angle", [0.3, -2.0])
def test_shear_stress_does_not_depend_on_axes_or_origin(name: str, angle: float) -> None:
    section, points = SHAPES[name], quadrature(SHAPES[name])[0][::300]
    forces = np.array([900.0, 10.0, 20.0, 0.05, 7.0, -3.0])
    expected = section.shear_stress(forces, points)
    c, s = math.cos(angle), math.sin(angle)
    R = np.array([[c, s], [-s, c]])
    turned = np.concatenate([forces[:1], R @ forces[1:3], forces[3:4], R @ forces[4:]])
    np.testing.assert_allclose(section.turned(angle).shear_stress(turned, points @ R.T), expected @ R.T, rtol=1e-9)
    # An axis beside the centre: forces through it twist.

    center = np.array([0.02, -0.01])
    moved = replace(section, tension_center=tuple(center), shear_center=tuple(center))
    about = forces + np.array([0.0, 0.0, 0.0, center[0] * forces[2] - center[1] * forces[1], 0.0, 0.0])
    np.testing.assert_allclose(moved.shear_stress(about, points + center), expected, rtol=1e-9)


def test_shear_stress_of_a_varying_section_takes_values_of_its_symbols() -> None:
    section = sections.rectangle(STEEL, "h*(1 - x/2)", 0.02)
    forces = np.random.default_rng(0).normal(size=(4, 3, 6))
    stress = section.shear_stress(forces, [[0.001, 0.002], [0.0, 0.0]], {"h": 0.04, "x": 0.5})
    plain = sections.rectangle(STEEL, 0.03, 0.02)
    assert stress.shape == (4, 3, 2, 2)
    np.testing.assert_allclose(stress[2, 1], plain.shear_stress(forces[2, 1], [[0.001, 0.002], [0.0, 0.0]]), rtol=1e-12)
    with pytest.raises(sf.DescriptionError, match="it depends on h, x"):
        section.shear_stress(forces, [[0.0, 0.0]])


def test_shear_stress_without_a_shape_or_outside_it_is_refused() -> None:
    with pytest.raises(sf.DescriptionError, match="shear stress is not known"):
        Section(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0).shear_stress(UNITS, [[0.0, 0.0]])
    for name, point in (
        ("high", (0.026, 0.0)),
        ("ellipse", (0.04, 0.019)),
        ("tube", (0.0, 0.01)),
        ("circle", (0.02, 0.02)),
    ):
        with pytest.raises(sf.DescriptionError, match="shear stress outside of it"):
            SHAPES[name].shear_stress(UNITS, [[0.0, 0.02], point] if name == "tube" else [point])
