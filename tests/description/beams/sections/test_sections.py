"""Sections: what material and shape bring to a beam."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams import sections
from symofros.description.beams.sections import Material, Section, polygons
from symofros.errors import DescriptionError
from tests.late import needs_extra

STEEL = Material(E=2.6, G=1.0, rho=3.0)  # Poisson's ratio 0.3.
elements = pytest.mark.skipif(
    find_spec("sectionproperties") is None, reason=needs_extra("sections", "sectionproperties")
)


def number(value: Any, **values: float) -> float:
    return float(sf.evaluate(value, values))


@pytest.mark.parametrize(("ratio", "torsion"), [(1.0, 0.140577), (2.0, 0.228682), (10.0, 0.312325), (1e6, 1 / 3)])
def test_torsion_of_rectangles_matches_published_tables(ratio: float, torsion: float) -> None:
    # Timoshenko and Goodier, Theory of Elasticity, table of k_1: J = k_1 (2a)^3 (2b).
    for y, z in ((ratio, 1.0), (1.0, ratio)):
        assert number(sections.rectangle(STEEL, y, z).GJ) == pytest.approx(torsion * ratio, rel=4e-6)


def ellipse(y: float, z: float) -> list[tuple[float, float]]:
    return [(y * math.cos(x), z * math.sin(x)) for x in np.linspace(0, 2 * math.pi, 721)[:-1]]


@elements
@pytest.mark.parametrize(
    ("closed", "outline", "holes"),
    [
        (sections.rectangle(STEEL, 2.0, 1.0), [(0, 0), (2, 0), (2, 1), (0, 1)], ()),
        (sections.ellipse(STEEL, 1.5, 0.6), ellipse(1.5, 0.6)[::4], ()),
        (sections.tube(STEEL, 1.0, 0.4), ellipse(1.0, 1.0)[::4], (ellipse(0.6, 0.6)[::4],)),
    ],
    ids=["rectangle", "ellipse", "tube"],
)
def test_closed_forms_match_finite_elements(
    closed: Section, outline: list[tuple[float, float]], holes: tuple[list[tuple[float, float]], ...]
) -> None:
    meshed = sections.polygon(STEEL, outline, holes)
    # A polygon of 180 corners lacks 4e-4 of the moments of its circle; thin meshes err by 1e-5.
    error = 8e-4 if len(outline) == 180 else 6e-5
    for label in ("EA", "GJ", "EI_y", "EI_z", "GA_y", "GA_z", "rhoA", "rhoI_y", "rhoI_z"):
        assert number(getattr(meshed, label)) == pytest.approx(number(getattr(closed, label)), rel=error), label


@pytest.mark.parametrize("nu", [0.0, 0.25, 0.5])
def test_shear_areas_of_thin_tubes_and_circles_match_known_formulas(nu: float) -> None:
    """Its wall is sheared by 2 V/A sin(theta), whatever Poisson's ratio; 6 (1 + nu)^2/(7 + 14 nu + 8 nu^2) is known."""
    material = Material(E=2.0 * (1.0 + nu), G=1.0, rho=1.0)
    thin = sections.tube(material, 1.0, 1e-5)
    assert number(thin.GA_y) / number(thin.EA) * 2.0 * (1.0 + nu) == pytest.approx(0.5, rel=2e-5)
    known = 6.0 * (1.0 + nu) ** 2 / (7.0 + 14.0 * nu + 8.0 * nu**2)
    for full in (sections.circle(material, 2.0), sections.tube(material, 2.0, 2.0)):
        assert number(full.GA_z) / (4.0 * math.pi) == pytest.approx(known, rel=1e-14)


def test_a_tube_is_a_circle_without_its_core() -> None:
    whole, core, tube = (sections.circle(STEEL, 1.0), sections.circle(STEEL, 0.6), sections.tube(STEEL, 1.0, 0.4))
    for label in ("EA", "GJ", "EI_y", "EI_z", "rhoA", "rhoI_y"):
        assert number(getattr(tube, label)) == pytest.approx(
            number(getattr(whole, label)) - number(getattr(core, label)), rel=1e-14
        )


def test_sizes_may_be_formulas() -> None:
    stated = sections.rectangle(Material("E", "G", "rho"), "b*(1 - x/2)", "h")
    values = {"E": 2.6, "G": 1.0, "rho": 3.0, "b": 0.4, "h": 0.3, "x": 1.0}
    numeric = sections.rectangle(STEEL, 0.2, 0.3)
    for label in ("EA", "GJ", "EI_y", "EI_z", "GA_y", "GA_z", "rhoA", "rhoI_y", "rhoI_z"):
        assert number(getattr(stated, label), **values) == pytest.approx(number(getattr(numeric, label)), rel=1e-14)


def test_bending_is_stiffer_across_the_longer_side() -> None:
    tall = sections.rectangle(STEEL, 2.0, 1.0).beam_properties()
    assert tall["EI_z"] == pytest.approx(2.6 * 1.0 * 2.0**3 / 12)
    assert tall["EI_y"] == pytest.approx(2.6 * 2.0 * 1.0**3 / 12)
    assert tall["rhoJ"] == pytest.approx(3.0 * 2.0 * (1.0 + 4.0) / 12)


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_a_turned_section_stores_the_same_energy(angle: float) -> None:
    section = Section(1.0, 2.0, 3.0, 5.0, 7.0, 11.0, 13.0, EI_yz=0.5, rhoI_yz=-0.7, mass_center=(0.1, 0.2))
    turned = section.turned(angle)
    c, s = math.cos(angle), math.sin(angle)
    R = np.array([[1, 0, 0], [0, c, s], [0, -s, c]])  # Components along the new axes by those along the old.
    T = np.kron(np.eye(2), R)
    np.testing.assert_allclose(T.T @ turned.mass_matrix() @ T, section.mass_matrix(), atol=1e-14)


def test_matrices_are_integrals_over_points() -> None:
    """Two fibres: stretch of each by the strains of the axis, momentum of each by its velocity."""
    fibres = [(0.3, -0.2), (0.1, 0.5)]
    center = np.mean(fibres, axis=0)
    (yy, yz), (_, zz) = sum(np.outer(p - center, p - center) for p in np.array(fibres))
    point = (float(center[0]), float(center[1]))
    section = Section(2.0, 0.0, zz, yy, 2.0, zz, yy, 0.0, 0.0, yz, yz, tension_center=point, mass_center=point)
    stretch = np.array([[1, 0, 0, 0, z, -y] for y, z in fibres])
    np.testing.assert_allclose(section.stiffness_matrix(), stretch.T @ stretch, atol=1e-15)
    velocity = [np.array([[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, 0], [0, 0, 1, y, 0, 0]]) for y, z in fibres]
    np.testing.assert_allclose(section.mass_matrix(), sum(J.T @ J for J in velocity), atol=1e-15)


@elements
def test_an_l_section_turned_to_its_principal_axes_has_no_coupling() -> None:
    angle_section = sections.l_section(STEEL, 2.0, 3.0, 0.2)
    assert abs(number(angle_section.EI_yz)) > 0.1
    with pytest.raises(sf.DescriptionError, match=r"shear_center's y is not zero"):
        angle_section.beam_properties()
    turned = angle_section.turned(angle_section.principal_angle)
    assert abs(number(turned.EI_yz)) < 1e-12
    assert number(turned.EI_z) > number(turned.EI_y)


@pytest.mark.parametrize(
    "outline",
    [
        [(0, 0), (1, 0)],
        [(0, 0), (1, 0), (math.nan, 1)],
        pytest.param([(0, 0), (1, 1), (1, 0), (0, 1)], marks=elements),
    ],
    ids=["two", "nan", "crossing"],
)
def test_unusable_outlines_are_refused(outline: list[tuple[float, float]]) -> None:
    with pytest.raises(sf.DescriptionError, match="unusable outline"):
        sections.polygon(STEEL, outline)


@pytest.mark.parametrize(
    ("shape", "sizes", "found"),
    [
        (sections.rectangle, (0.0, 0.1), "section: y = 0"),
        (sections.rectangle, (0.1, -0.02), "section: z = -0.02"),
        (sections.circle, (0.0,), "section: radius = 0"),
        (sections.ellipse, (0.1, 0.0), "section: z = 0"),
        (sections.tube, (0.02, 0.0), "section: thickness = 0"),
        (sections.tube, (0.02, 0.03), "section: thickness = 0.03"),
        (sections.box, (0.02, 0.03, 0.011), "box: thickness = 0.011"),
        (sections.i_section, (0.02, 0.03, 0.001, 0.011), "I section: flange = 0.011"),
        (sections.i_section, (0.02, 0.03, 0.04, 0.001), "I section: web = 0.04"),
        (sections.l_section, (0.02, 0.03, 0.025), "L section: thickness = 0.025"),
    ],
)
def test_sizes_of_no_section_are_refused(shape: Any, sizes: tuple[float, ...], found: str) -> None:
    """A wall thicker than its radius was a tube of another area; a size of zero ended in a division by zero."""
    with pytest.raises(sf.DescriptionError, match=found):
        shape(STEEL, *sizes)


@pytest.mark.parametrize(
    ("entries", "found"),
    [
        ({"E": 0.0}, "material: E = 0"),
        ({"G": -1.0}, "material: G = -1"),
        ({"rho": 0.0}, "material: rho = 0"),
        ({"G": 60e9}, "Poisson's ratio E/2G - 1 is 0.75"),
    ],
)
def test_materials_that_do_not_exist_are_refused(entries: dict[str, float], found: str) -> None:
    with pytest.raises(sf.DescriptionError, match=found):
        Material(**({"E": 210e9, "G": 80e9, "rho": 7850.0} | entries))
    assert Material(E=3.0, G=1.0, rho=1.0).E == 3.0  # Poisson's ratio 1/2.


def test_an_outline_of_parameters_is_refused() -> None:
    with pytest.raises(sf.DescriptionError, match="it depends on E"):
        sections.polygon(Material("E", 1.0, 1.0), [(0, 0), (1, 0), (0, 1)])


FILE = """
symofros: 1
parameters: {{b: 0.02, L: 1}}
bodies:
  boom:
    joint: {{kind: fixed}}
    beam:
      length: L
      bend_y: 2
      {section}
"""


def test_a_section_in_a_file_equals_the_same_section_in_python(tmp_path: Path) -> None:
    entry = "section: {shape: rectangle, E: 70e9, G: 26e9, rho: 2700, y: b*(2 - x/L), z: 0.005}"
    (tmp_path / "a.yaml").write_text(FILE.format(section=entry))
    (beam,) = sf.load(tmp_path / "a.yaml").bodies
    expected = sections.rectangle(Material(70e9, 26e9, 2700.0), "b*(2 - x/L)", 0.005).beam_properties()
    assert {label: getattr(beam, label) for label in expected} == expected


COUPLED = Section(
    EA=100.0,
    GJ=2.0,
    EI_y=3.0,
    EI_z=5.0,
    EI_yz=0.5,
    GA_y=30.0,
    GA_z=20.0,
    rhoA=2.0,
    rhoI_y=0.03,
    rhoI_z=0.02,
    rhoI_yz=0.004,
    tension_center=(0.1, -0.2),
    shear_center=(0.05, 0.03),
    mass_center=(0.02, -0.04),
)
# Rows of x, y, z where the axis is x, by those where it is z.
BEAMDYN = np.argsort([2, 0, 1, 5, 3, 4])


@pytest.mark.parametrize("axis", ["x", "z"])
def test_a_section_is_recovered_from_its_matrices(axis: str) -> None:
    K, M = COUPLED.stiffness_matrix(), COUPLED.mass_matrix()
    if axis == "z":
        K, M = K[np.ix_(BEAMDYN, BEAMDYN)], M[np.ix_(BEAMDYN, BEAMDYN)]
    found = Section.of_matrices(K, M, axis)  # type: ignore[arg-type]
    for item in fields(Section):
        stated = getattr(COUPLED, item.name)
        assert getattr(found, item.name) == pytest.approx(stated, rel=1e-12, abs=1e-15) if stated is not None else True
    assert not found.stiffness


def test_noise_in_a_matrix_has_no_side() -> None:
    """Entries of a program's output that differ across the diagonal count half each."""
    noise = 1.0 + 1e-8 * np.random.default_rng(2).standard_normal((6, 6))
    K, M = COUPLED.stiffness_matrix() * noise, COUPLED.mass_matrix()
    assert Section.of_matrices(K, M) == Section.of_matrices(K.T, M) == Section.of_matrices(0.5 * (K + K.T), M)


def test_a_matrix_with_more_couplings_is_kept() -> None:
    K = COUPLED.stiffness_matrix()
    K[3, 4] = K[4, 3] = 0.7
    found = Section.of_matrices(K, COUPLED.mass_matrix())
    assert found.stiffness_matrix() == pytest.approx(K, rel=1e-15)
    entries = found.beam_properties("strain")
    assert np.array(entries["stiffness"]) == pytest.approx(K, rel=1e-15)
    assert not {"EA", "GJ", "EI_y", "EI_yz", "shear_center"} & entries.keys()
    with pytest.raises(DescriptionError, match="theory: strain"):
        found.beam_properties()
    turned = found.turned(0.3)
    assert turned.turned(-0.3).stiffness_matrix() == pytest.approx(K, rel=1e-12, abs=1e-13)
    strain = np.array([0.1, 0.2, -0.3, 0.4, 0.5, -0.6])
    c, s = np.cos(0.3), np.sin(0.3)
    along = np.kron(np.eye(2), [[1, 0, 0], [0, c, s], [0, -s, c]]) @ strain
    assert along @ turned.stiffness_matrix() @ along == pytest.approx(strain @ K @ strain, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda K, M: (K[:5], M), "shape"),
        (lambda K, M: (K + np.triu(np.ones((6, 6)), 1), M), "not symmetric"),
        (lambda K, M: (K - 3.0 * np.eye(6), M), "not positive definite"),
        (lambda K, M: (K, M + np.diag([0, 0, 0, 0.1, 0, 0])), "no mass matrix of a section"),
        (lambda K, M: (K, M * np.nan), "not finite"),
        (lambda K, M: ("abc", M), "six rows of six numbers"),
        (lambda K, M: ([[1.0], [1.0, 2.0]], M), "six rows of six numbers"),
        (lambda K, M: (K + 1j, M), "six rows of six numbers"),
        (lambda K, M: (K, 0.0 * M), "M has no mass"),
        (lambda K, M: (K, M, "y"), "axis along the beam is x"),
    ],
)
def test_matrices_of_no_section_are_refused(change: Any, message: str) -> None:
    with pytest.raises(DescriptionError, match=message):
        Section.of_matrices(*change(COUPLED.stiffness_matrix(), COUPLED.mass_matrix()))


def test_a_rod_accepts_a_section_off_its_axis() -> None:
    entries = COUPLED.beam_properties("strain")
    beam = sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, theory="strain", bend_y=1, twist=1, **entries)
    assert (beam.tension_center, beam.shear_center, beam.mass_center) == ((0.1, -0.2), (0.05, 0.03), (0.02, -0.04))
    assert (beam.EI_yz, beam.rhoI_yz) == (0.5, 0.004)
    # Shears along y and z are coupled then, by what is not known.
    assert not {"GA_y", "GA_z"} & entries.keys()


def test_a_product_is_small_beside_both_stiffnesses() -> None:
    flat = replace(COUPLED, EI_y=1e-3, EI_z=10.0, EI_yz=5e-4)
    assert flat.beam_properties("strain")["EI_yz"] == 5e-4


def test_outlines_enclose_what_their_names_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """Area, centre and second moments of the outlines, by Green's theorem, beside sums of rectangles."""

    def integrals(material: Material, outer: Any, holes: Any = ()) -> np.ndarray:
        total = np.zeros(4)
        for sign, ring in ((1.0, outer), *((-1.0, hole) for hole in holes)):
            p, n = np.array(ring), np.roll(np.array(ring), -1, axis=0)
            cross = p[:, 0] * n[:, 1] - n[:, 0] * p[:, 1]
            squares = p**2 + p * n + n**2
            total += sign * np.array([cross.sum() / 2, *((p + n).T @ cross / 6)[:1], *(squares.T @ cross / 12)])
        return total

    monkeypatch.setattr(polygons, "polygon", integrals)
    y, z, t, f = 0.2, 0.1, 0.01, 0.02

    def rectangle(y: float, z: float, at: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
        A = y * z
        return np.array([A, A * at[0], A * (y**2 / 12 + at[0] ** 2), A * (z**2 / 12 + at[1] ** 2)])

    hollow = rectangle(y, z) - rectangle(y - 2 * t, z - 2 * t)
    np.testing.assert_allclose(polygons.box(STEEL, y, z, t), hollow, rtol=1e-12, atol=1e-18)
    flanges = sum(rectangle(f, z, (s * (y - f) / 2, 0.0)) for s in (1, -1))
    np.testing.assert_allclose(polygons.i_section(STEEL, y, z, t, f), rectangle(y - 2 * f, t) + flanges, atol=1e-16)
    legs = rectangle(y, t, (y / 2, t / 2)) + rectangle(t, z - t, (t / 2, (z + t) / 2))
    np.testing.assert_allclose(polygons.l_section(STEEL, y, z, t), legs, rtol=1e-12)


def test_a_section_turned_by_a_right_angle_has_its_stiffnesses_of_shear_the_other_way_round() -> None:
    section = sections.rectangle(STEEL, 2.0, 1.0)
    for quarters in range(-3, 5):
        turned = section.turned(quarters * math.pi / 2)
        wanted = (section.GA_z, section.GA_y) if quarters % 2 else (section.GA_y, section.GA_z)
        assert (turned.GA_y, turned.GA_z) == wanted
    assert section.turned(0.3).GA_y is None
