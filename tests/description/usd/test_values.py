"""What is made of the values of a stage, as the process that reads it hands them over."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symofros.description.imported.options import ImportOptions
from symofros.description.remarks import Remarks
from symofros.description.usd.check import faults
from symofros.description.usd.masses import Masses, Units
from symofros.description.usd.reader import _Importer
from symofros.errors import Problem

SIZES = {"centerOfMass": 3, "gravityDirection": 3, "rotation0": 4, "inertia": 6}


def stage(**scene: Any) -> dict[str, Any]:
    scenes = [{"path": "/scene", **scene}] if scene else []
    lists = dict.fromkeys(("bodies", "joints", "shapes", "other units"), [])
    return {"meters": 0.01, "kilograms": 1.0, "up": "Z", "placements": {}, "scenes": scenes, **lists}


@pytest.mark.parametrize("name", SIZES)
def test_a_list_of_numbers_has_no_other_entry_wherever_it_stands(name: str) -> None:
    numbers: list[Any] = [0.5] * SIZES[name]
    assert not list(faults(stage(**{name: numbers})))
    for k in range(len(numbers)):
        for wrong in (None, "far", True, [1.0], float("nan")):
            (fault,) = faults(stage(**{name: [*numbers[:k], wrong, *numbers[k + 1 :]]}))
            assert (fault.path, fault.name) == ("/scene", name) and f"{len(numbers)} numbers" in fault.rule
    for count in (len(numbers) - 1, len(numbers) + 1):
        assert [fault.name for fault in faults(stage(**{name: [0.5] * count}))] == [name]


@pytest.mark.parametrize(
    ("scene", "wanted"),
    [
        ({}, (0.0, 0.0, -9.81)),
        ({"gravityMagnitude": 500.0}, (0.0, 0.0, -5.0)),
        ({"gravityMagnitude": 0.0}, (0.0, 0.0, 0.0)),
        ({"gravityMagnitude": "-inf", "gravityDirection": [3.0, 0.0, 4.0]}, (0.6 * 9.81, 0.0, 0.8 * 9.81)),
        ({"gravityMagnitude": 100.0, "gravityDirection": [0.0, -2.0, 0.0]}, (0.0, -1.0, 0.0)),
    ],
)
def test_gravity_is_that_of_the_scene_in_units_of_the_stage_or_the_earths(
    scene: dict[str, Any], wanted: tuple[float, float, float]
) -> None:
    reader = _Importer("robot.usda", stage(**scene), ImportOptions())
    np.testing.assert_allclose(reader._gravity(), wanted, rtol=2e-3, atol=1e-12)


@pytest.mark.parametrize("mass", [None, 2.0])
@pytest.mark.parametrize("shaped", [False, True])
def test_a_body_without_inertia_is_massless_only_without_mass_and_shapes(mass: float | None, shaped: bool) -> None:
    """A shape of an unknown kind tells nothing, but that there is matter: what is not known is a problem."""
    remarks, problems = Remarks(), list[Problem]()
    unstated = dict.fromkeys(("mass", "density", "centerOfMass", "diagonalInertia", "principalAxes", "inertia"))
    own = {"path": "/b", **unstated, "mass": mass}
    shapes = [{"path": "/b/s", "kind": "Mesh", "sizes": {}, **unstated}] if shaped else []
    made = Masses(Units(1.0, 1.0), {}, remarks, problems).of(own, "b", shapes, "")
    assert made is None and len(problems) == int(shaped or mass is not None)


def test_a_stated_matrix_of_inertia_is_about_the_centre_in_units_of_the_stage() -> None:
    """Newton's entries, in their order, beside the moments of principal axes."""
    own: dict[str, Any] = {"path": "/b", "mass": 2.0, "density": None, "centerOfMass": [10.0, 0.0, -20.0]}
    own |= {"diagonalInertia": None, "principalAxes": None, "inertia": [1.0, 2.0, 3.0, 0.1, 0.2, 0.3]}
    placed = {"/b": SimpleNamespace(scale=0.01)}
    made = Masses(Units(0.01, 1.0), placed, Remarks(), []).of(own, "b", [], "")
    assert made is not None and made.mass == 2.0
    np.testing.assert_allclose(made.center_of_mass, (0.1, 0.0, -0.2))
    np.testing.assert_allclose(made.moments, 1e-4 * np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]))
