"""A formula has the unit of its entry, where the units of what is in it are stated."""

from __future__ import annotations

from pathlib import Path

import pytest

import symofros as sf
from symofros.mechanics.topology.units import unit_problems

MODELS = Path(__file__).parents[3] / "reference_models"


def pendulum(unit: str = "kg m^2", moment: str = "J", **joint: object) -> sf.System:
    arm = sf.RigidBody(
        "arm",
        sf.Joint("q", "revolute", axis=(0, 1, 0), **joint),  # type: ignore[arg-type]
        sf.Inertia("m", center_of_mass=("L", 0, 0), moments=("1", moment, "1")),
    )
    return sf.System(
        "pendulum",
        bodies=[arm],
        parameters=[
            sf.Parameter("J", 1.0, unit),
            sf.Parameter("m", 1.0, "kg"),
            sf.Parameter("L", 1.0, "m"),
            sf.Parameter("k", 1.0, "N m/rad"),
            sf.Parameter("c", 1.0),
        ],
        inputs=[sf.Input("u", "N m")],
    )


def texts(system: sf.System) -> list[str]:
    return [str(problem) for problem in unit_problems(system)]


@pytest.mark.parametrize("path", sorted(MODELS.glob("*/*.yaml")), ids=lambda path: path.stem)
def test_reference_models_state_units_that_fit(path: Path) -> None:
    assert list(unit_problems(sf.load(path))) == []


def test_an_inertia_is_no_torque() -> None:
    (text,) = texts(pendulum("N m"))
    assert "body 'arm': inertia: unit N m" in text and "'J'" in text and "its unit is kg m^2" in text


def test_a_unit_that_does_not_exist_is_named() -> None:
    (text,) = texts(pendulum("bananas"))
    assert "parameter 'J': no such unit" in text and "'bananas'" in text


@pytest.mark.parametrize("moment", ["m*L^2", "sqrt(m*L*m*L^3)", "J + m*L^2", "max(J, m*L^2)", "J*cos(L/L)", "-J"])
def test_products_powers_and_sums_have_their_units(moment: str) -> None:
    assert texts(pendulum(moment=moment)) == []


@pytest.mark.parametrize(
    ("moment", "unit"),
    [("m*L", "kg m"), ("J/L", "kg m"), ("m*L^3", "kg m^3"), ("m^2*L^2/J", "kg"), ("L/k", "s^2/kg m")],
)
def test_another_power_is_another_unit(moment: str, unit: str) -> None:
    (text,) = texts(pendulum(moment=moment))
    assert f"inertia: unit {unit}\n" in text


@pytest.mark.parametrize("moment", ["J + m", "J + m*L", "atan2(J, m)*J", "min(J, m)"])
def test_terms_of_two_units_do_not_go_together(moment: str) -> None:
    (text,) = texts(pendulum(moment=moment))
    assert "terms have one unit" in text and "in kg m^2" in text


def test_an_argument_of_a_sine_is_an_angle() -> None:
    (text,) = texts(pendulum(moment="J*sin(L)"))
    assert "the argument of sin is a ratio or an angle; 'L' is in m" in text


@pytest.mark.parametrize("moment", ["2*L", "c*L", "L^c", "J + 0.1", "c"])
def test_numbers_and_names_without_a_unit_leave_it_open(moment: str) -> None:
    assert texts(pendulum(moment=moment)) == []


def test_a_spring_of_a_slide_is_stated_in_newtons_per_metre() -> None:
    spring = [sf.Spring("k")]
    assert texts(pendulum(elements=spring)) == []
    slide = pendulum(elements=spring)
    slide = sf.System(
        "slide",
        bodies=[
            sf.RigidBody("arm", sf.Joint("q", "prismatic", axis=(1, 0, 0), elements=spring), sf.Inertia("m"))  # type: ignore[arg-type]
        ],
        parameters=slide.parameters,
    )
    (text,) = texts(slide)
    assert "joint 'q': spring stiffness: unit N m" in text and "its unit is N/m" in text


@pytest.mark.parametrize(
    ("effort", "fits"), [("u - k*q", True), ("u - k*dq", False), ("u - c*dq", True), ("m*q", False)]
)
def test_efforts_have_the_units_of_coordinates_and_speeds(effort: str, fits: bool) -> None:
    assert (texts(pendulum(effort=(effort,))) == []) == fits


def test_what_is_loaded_says_so(tmp_path: Path) -> None:
    text = (MODELS / "rigid" / "cart_pole.yaml").read_text()
    assert sf.load(MODELS / "rigid" / "cart_pole.yaml").notes == ()
    path = tmp_path / "cart_pole.yaml"
    path.write_text(text.replace("unit: kg,", "unit: s,").replace("unit: kg}", "unit: s}"))
    assert any("mass" in note and "kg" in note for note in sf.load(path).notes)
