"""A formula has the unit of its entry, where the units of what is in it are stated."""

from __future__ import annotations

from pathlib import Path

import pytest

import symofros as sf
from symofros.mechanics.topology.units import unit_problems

MODELS = Path(__file__).parents[3] / "reference_models"


def pendulum(moment: str) -> sf.System:
    inertia = sf.Inertia("m", center_of_mass=("L", 0, 0), moments=("1", moment, "1"))
    units = {"J": "kg m^2", "m": "kg", "L": "m"}
    return sf.System(
        "pendulum",
        [sf.RigidBody("arm", sf.Joint("q", "revolute", axis=(0, 1, 0)), inertia)],
        [sf.Parameter(name, 1.0, unit) for name, unit in units.items()],
    )


@pytest.mark.parametrize("path", sorted(MODELS.glob("*/*.yaml")), ids=lambda path: path.stem)
def test_reference_models_state_units_that_fit(path: Path) -> None:
    assert list(unit_problems(sf.load(path))) == []


@pytest.mark.parametrize("moment", ["m*L^2", "sqrt(m*L*m*L^3)", "J + m*L^2", "max(J, m*L^2)", "J*cos(L/L)", "-J"])
def test_products_powers_and_sums_have_their_units(moment: str) -> None:
    assert list(unit_problems(pendulum(moment))) == []


def test_inconsistent_units_of_a_file_become_notes(tmp_path: Path) -> None:
    text = (MODELS / "rigid" / "cart_pole.yaml").read_text()
    assert sf.load(MODELS / "rigid" / "cart_pole.yaml").notes == ()
    path = tmp_path / "cart_pole.yaml"
    path.write_text(text.replace("unit: kg,", "unit: s,").replace("unit: kg}", "unit: s}"))
    assert any("mass" in note and "kg" in note for note in sf.load(path).notes)
