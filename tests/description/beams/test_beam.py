"""What a beam has that is not stated."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import pytest

import symofros as sf

NAMES = ["EI_z", "EI_y", "GJ", "rhoJ", "rhoI_y", "rhoI_z", "EA", "GA_y", "GA_z", "damping"]
NAMES += ["curvature_y", "curvature_z", "twist_rate", "EI_yz", "rhoI_yz"]


def test_unstated_stiffnesses_inertias_and_damping_are_zero() -> None:
    beam = sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, 1.0)
    assert {name: getattr(beam, name) for name in NAMES} == dict.fromkeys(NAMES, 0.0)
    stated = {item.name for item in fields(sf.Beam) if item.type == "Value" and isinstance(item.default, float)}
    assert stated == set(NAMES)


IDENTITY = [[float(i == j) for j in range(6)] for i in range(6)]


def rod_by(**entries: object) -> sf.Beam:
    return sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, 1.0, theory="strain", bend_y=1, **entries)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"stiffness": IDENTITY[:5]}, "5 rows"),
        ({"stiffness": [[1.0, 0.1, 0, 0, 0, 0], *IDENTITY[1:]]}, r"not symmetric[\s\S]*\[0\]\[1\] is 0.1"),
        ({"stiffness": IDENTITY, "EI_z": 2.0, "shear_center": (0.1, 0.0)}, "stiffness and EI_z, shear_center"),
        ({"mass_center": (0.1,)}, "mass_center: wrong number of entries"),
        ({"mass_center": None}, "mass_center: wrong number of entries"),
        ({"shear_center": {"y": 1.0, "z": 2.0}}, "shear_center: wrong number of entries"),
        ({"stiffness": 5.0}, "1 rows"),
        ({"stiffness": "EI"}, "1 rows"),
        ({"stiffness": [1.0] * 6}, r"stiffness\[0\]: wrong number of entries"),
        ({"stiffness": [[None] * 6] * 6}, "neither a number nor a formula"),
    ],
)
def test_sections_that_contradict_themselves_are_refused(entries: dict[str, object], message: str) -> None:
    with pytest.raises(sf.DescriptionError, match=message):
        rod_by(**entries)


def test_rounding_across_the_diagonal_is_not_asymmetry() -> None:
    rows = [list(row) for row in IDENTITY]
    rows[0][3], rows[3][0] = 0.1, 0.1 + 1e-9
    stated = rod_by(stiffness=rows).stiffness
    assert stated[0][3] == stated[3][0] == pytest.approx(0.1, rel=1e-8)


def test_centres_that_the_sections_do_not_follow_are_refused() -> None:
    def compiled(**more: int) -> sf.Model:
        beam = rod_by(EI_z=1.0, EI_y=1.0, mass_center=("0.1*sin(4*x)", 0.0), **more)
        return sf.compile(sf.System("s", (beam,)), sf.Options(("mass_matrix",), backend="interpreter"))

    with pytest.raises(sf.DescriptionError, match=r"mass_center changes more[\s\S]*more sections"):
        compiled()
    matrix = [list(row) for row in IDENTITY]
    matrix[0][5] = matrix[5][0] = "0.02*sin(9*x)"
    for entries in ({"EI_z": 1.0, "tension_center": ("0.02*sin(9*x)", 0.0)}, {"stiffness": matrix}):
        system = sf.System("s", (rod_by(**entries),))
        with pytest.raises(sf.DescriptionError, match=r"(tension_center|stiffness).* changes more"):
            sf.compile(system, sf.Options(("mass_matrix",), backend="interpreter"))
    few, many = (compiled(sections=n).mass_matrix([0.3])[0, 0] for n in (6, 12))
    assert few == pytest.approx(many, rel=1e-4)


def test_indefinite_sections_are_refused_by_the_model_and_at_run_time() -> None:
    matrix = [[*row] for row in IDENTITY]
    matrix[0][3] = matrix[3][0] = "c"
    for c, ok in ((0.5, True), (1.5, False)):
        system = sf.System("s", (rod_by(stiffness=matrix),), parameters=(sf.Parameter("c", c, constant=False),))
        if not ok:
            with pytest.raises(sf.DescriptionError, match="stiffness is not positive definite"):
                sf.compile(system, sf.Options(("mass_matrix",), backend="interpreter"))
            continue
        m = sf.compile(system, sf.Options(("potential_energy",), backend="interpreter"))
        m.potential_energy([0.1])
        with pytest.raises(sf.ParameterError, match=r"run-time parameters[\s\S]*stiffness is not positive definite"):
            m.potential_energy([0.1], par=[2.0])
    product = sf.System("s", (rod_by(EI_z=1.0, EI_y=2.0, EI_yz=1.5),))
    with pytest.raises(sf.DescriptionError, match="EI_yz too large"):
        sf.compile(product, sf.Options(("mass_matrix",), backend="interpreter"))


COUPLINGS = {
    "mass_center": (0.01, 0.0),
    "tension_center": (0.0, -0.02),
    "shear_center": (0.01, 0.02),
    "EI_yz": 0.1,
    "rhoI_yz": 1e-3,
    "stiffness": tuple(map(tuple, [[float(i == j) for j in range(6)] for i in range(6)])),
}


@pytest.mark.parametrize("name", [None, *COUPLINGS])
def test_a_section_is_coupled_by_each_of_its_couplings(name: str | None) -> None:
    given: dict[str, Any] = {} if name == "stiffness" else {"EI_z": 1.0, "EI_y": 2.0}
    given |= {} if name is None else {name: COUPLINGS[name]}
    beam = sf.Beam("b", sf.Joint("clamp", "fixed"), 1.0, 1.0, theory="strain", **given)
    assert beam.is_coupled == (name is not None)
