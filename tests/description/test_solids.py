"""Inertia of solids against integrals over their points, pieces put together, and limits."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros import solids
from symofros.description.system import Inertia
from symofros.mechanics.topology.units import unit_problems

Array = np.ndarray
RHO = 2700.0


def numbers(inertia: Inertia) -> tuple[float, Array, Array]:
    """Mass, mass centre, inertia matrix about it."""
    xx, yy, zz, xy, xz, yz = map(float, inertia.moments)
    return (
        float(inertia.mass),
        np.array(inertia.center_of_mass, dtype=float),
        np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
    )


def about(mass: float, offset: Array) -> Array:
    """What a mass at an offset adds to an inertia matrix."""
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


def integrated(volume: Callable[[float, float, float], tuple[Array, float]]) -> tuple[float, Array]:
    """Mass and inertia matrix by Gauss's points of three coordinates from 0 to 1: exact for these polynomials.

    The second of them is an angle: equal steps integrate its sines and cosines exactly.
    """
    s, weights = np.polynomial.legendre.leggauss(6)
    mass, matrix = 0.0, np.zeros((3, 3))
    for (a, wa), b, (c, wc) in product(
        zip((s + 1) / 2, weights / 2, strict=True), np.arange(8) / 8, zip((s + 1) / 2, weights / 2, strict=True)
    ):
        r, density = volume(a, b, c)
        dm = RHO * density * wa * wc / 8
        mass += dm
        matrix += about(dm, r)
    return mass, matrix


def in_cylinder(radius: float, length: float, hole: float) -> Callable[[float, float, float], tuple[Array, float]]:
    def at(a: float, b: float, c: float) -> tuple[Array, float]:
        r, angle = hole + (radius - hole) * a, 2 * np.pi * b
        place = np.array([r * np.cos(angle), r * np.sin(angle), length * (c - 0.5)])
        return place, 2 * np.pi * r * (radius - hole) * length

    return at


def in_ellipsoid(semi: tuple[float, float, float], hole: float) -> Callable[[float, float, float], tuple[Array, float]]:
    """Integrals over an ellipsoid by the cosine of the polar angle; `hole` is the share of its size that is hollow."""

    def at(a: float, b: float, c: float) -> tuple[Array, float]:
        r, angle, cosine = hole + (1 - hole) * a, 2 * np.pi * b, 2 * c - 1
        sine = np.sqrt(1 - cosine**2)
        place = np.array(semi) * r * np.array([sine * np.cos(angle), sine * np.sin(angle), cosine])
        return place, float(np.prod(semi)) * 4 * np.pi * r**2 * (1 - hole)

    return at


@pytest.mark.parametrize(
    ("solid", "volume"),
    [
        (solids.cylinder(RHO, 0.3, 1.1), in_cylinder(0.3, 1.1, 0.0)),
        (solids.cylinder(RHO, 0.3, 1.1, hole=0.2), in_cylinder(0.3, 1.1, 0.2)),
        (solids.sphere(RHO, 0.3), in_ellipsoid((0.3, 0.3, 0.3), 0.0)),
        (solids.sphere(RHO, 0.3, hole=0.24), in_ellipsoid((0.3, 0.3, 0.3), 0.8)),
        (solids.ellipsoid(RHO, 0.3, 0.2, 0.5), in_ellipsoid((0.3, 0.2, 0.5), 0.0)),
    ],
    ids=["cylinder", "tube", "sphere", "shell", "ellipsoid"],
)
def test_solids_match_integrals_over_points(
    solid: Inertia, volume: Callable[[float, float, float], tuple[Array, float]]
) -> None:
    mass, _, matrix = numbers(solid)
    expected = integrated(volume)
    assert mass == pytest.approx(expected[0], rel=1e-13)
    np.testing.assert_allclose(matrix, expected[1], rtol=1e-12, atol=1e-13 * matrix.max())


size = st.floats(1e-3, 1e3)


@given(x=size, y=size, z=size, share=st.floats(0.05, 0.95))
def test_two_parts_of_a_box_add_up_to_the_box(x: float, y: float, z: float, share: float) -> None:
    parts = [
        solids.box(RHO, share * x, y, z, center=((share - 1) * x / 2, 0, 0)),
        solids.box(RHO, (1 - share) * x, y, z, center=(share * x / 2, 0, 0)),
    ]
    mass, center, matrix = numbers(solids.box(RHO, x, y, z))
    stated = [numbers(part) for part in parts]
    assert sum(m for m, _, _ in stated) == pytest.approx(mass, rel=1e-12)
    np.testing.assert_allclose(sum(m * c for m, c, _ in stated), mass * center, atol=1e-9 * mass * x)
    np.testing.assert_allclose(sum(J + about(m, c) for m, c, J in stated), matrix, rtol=1e-9, atol=1e-12 * matrix.max())


def test_cylinders_turn_with_their_axis_and_thin_shells_keep_accuracy() -> None:
    along = {axis: numbers(solids.cylinder(RHO, 0.1, 2.0, axis=axis))[2].diagonal() for axis in ("x", "y", "z")}
    assert along["x"][0] == along["y"][1] == along["z"][2] < along["z"][0]
    assert sorted(along["x"]) == sorted(along["y"]) == sorted(along["z"])
    # 4 pi r^2 d rho, and 2/3 of that times r^2, to the first order in the thickness d.
    mass, _, matrix = numbers(solids.sphere(RHO, 1.0, hole=1.0 - 1e-9))
    assert mass == pytest.approx(4 * np.pi * RHO * 1e-9, rel=1e-7)
    assert matrix[0, 0] == pytest.approx(2 / 3 * mass, rel=1e-7)


def test_formulas_follow_parameters() -> None:
    link = sf.RigidBody(
        "link", sf.Joint("q", "revolute"), solids.cylinder("rho", "r", 0.5, axis="x", center=("r", 0, 0))
    )
    system = sf.System("s", [link], [sf.Parameter("rho", 1000.0), sf.Parameter("r", 0.1)])
    model = sf.compile(system, sf.Options(("mass_matrix",), (), backend="interpreter"))
    for r in (0.1, 0.2):
        mass, _, matrix = numbers(solids.cylinder(1000.0, r, 0.5, axis="x"))
        M = model.with_parameters(r=r).mass_matrix([0.0])
        assert M[0, 0] == pytest.approx(matrix[2, 2] + mass * r**2, rel=1e-13)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: solids.box(-1.0, 1, 1, 1), "density is not positive"),
        (lambda: solids.box(1.0, 0.0, 1, 1), "x is not positive"),
        (lambda: solids.sphere(1.0, float("nan")), "radius"),
        (lambda: solids.cylinder(1.0, 0.1, 1.0, hole=0.1), "no such hole"),
        (lambda: solids.sphere(1.0, 0.1, hole=-0.1), "no such hole"),
    ],
)
def test_impossible_solids_are_refused(make: Callable[[], Inertia], message: str) -> None:
    with pytest.raises(sf.DescriptionError, match=message):
        make()


FILE = """symofros: 1
parameters: {rho: {value: 2700, unit: kg/m^3}, d: {value: 0.1, unit: m}}
bodies:
  link:
    joint: {kind: revolute, axis: [0, 1, 0]}
    solid: {shape: cylinder, density: rho, radius: d/2, length: 0.5, hole: 0.02, axis: x, center: [0.25, 0, 0]}
    frames: {tip: {position: [0.5, 0, 0]}}
"""


def test_a_file_states_a_solid_in_place_of_an_inertia(tmp_path: Path) -> None:
    path = tmp_path / "link.yaml"
    path.write_text(FILE)
    (link,) = sf.load(path).bodies
    assert link.inertia == solids.cylinder("rho", "d/2", 0.5, hole=0.02, axis="x", center=(0.25, 0, 0))
    again = tmp_path / "again.yaml"
    sf.save(sf.load(path), again)
    assert sf.load(again).bodies == sf.load(path).bodies


def test_units_of_densities_and_sizes_are_judged(tmp_path: Path) -> None:
    path = tmp_path / "link.yaml"
    solid = FILE[FILE.index("solid: ") : FILE.index("    frames")]
    text = FILE.replace(solid, "solid: {shape: box, density: rho, x: d, y: d, z: d}\n")
    path.write_text(text)
    assert not list(unit_problems(sf.load(path)))
    path.write_text(text.replace("unit: kg/m^3", "unit: kg"))
    assert any("mass" in str(problem) for problem in unit_problems(sf.load(path)))
