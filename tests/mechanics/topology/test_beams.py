"""Beams that can't be, beside those of problems.txt: each is refused in words; and those that can."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf

CLAMPED = sf.Joint("root", "fixed")


def beam(**changed: Any) -> sf.Beam:
    plain: dict[str, Any] = {"length": 2.0, "rhoA": 0.5, "EI_z": 3.0, "bend_y": 2}
    return sf.Beam("b", CLAMPED, **(plain | changed))


def problems(one: sf.Beam, **system: Any) -> str:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.compile(sf.System("s", [one], **system))
    return str(caught.value)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"bend_y": 41}, ["41 functions", "40"]),
        ({"family": "polynomial", "bend_y": 10}, ["ill-conditioned", "10 functions", "condition", "legendre"]),
        ({"loads": [sf.Load((1.0, 0, 0))]}, ["Load on a Beam"]),
    ],
)
def test_beams_with_unusable_functions_or_loads_are_refused(changed: dict[str, Any], said: list[str]) -> None:
    text = problems(beam(**changed))
    assert all(part in text for part in said), text


def test_a_parameter_may_not_be_named_like_the_station() -> None:
    assert "'x'" in problems(beam(), parameters=[sf.Parameter("x", 1.0)])


def test_a_load_fits_the_kind_of_its_body() -> None:
    box = sf.RigidBody("box", sf.Joint("q", "revolute"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)), loads=[sf.BeamLoad()])  # type: ignore[list-item]
    with pytest.raises(sf.DescriptionError, match="a BeamLoad on a RigidBody"):
        sf.compile(sf.System("s", [box]))


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"family": "splines"}, "did you mean 'spline'"),
        ({"retain": "second"}, "zeroth_order, first_order, all"),
        ({"bend_y": -1}, "whole number"),
        ({"shapes": {"bend_x": ["xi^2"]}}, "bend_y, bend_z, twist"),
    ],
)
def test_a_beam_is_refused_when_it_is_stated(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(sf.DescriptionError, match=said):
        beam(**changed)


def test_stations_of_samples_rise_from_0_to_1() -> None:
    with pytest.raises(sf.DescriptionError, match="rise from 0 to 1"):
        sf.Samples((0, 0.5, 0.4, 1), (0, 1, 2, 3))


def test_missing_foreshortening_is_warned_of() -> None:
    with pytest.warns(sf.InconsistentModelWarning, match="'b'.*diverges"):
        sf.compile(sf.System("s", [beam(foreshortening=False)]), sf.Options(functions=("mass_matrix",)))


@pytest.mark.parametrize(("functions", "mode", "inertia"), [(2, 1, 0.02), (3, 2, 0.01)])
def test_neglected_rotary_inertia_is_warned_of(functions: int, mode: int, inertia: float) -> None:
    """By as much as it lowers the frequency of the model that has it."""
    stated = beam(bend_y=functions, rhoI_z=inertia, family="clamped_free")
    options = sf.Options(backend="interpreter")
    with pytest.warns(sf.InconsistentModelWarning, match=f"rhoI_z .*bending mode {mode} by") as caught:
        without = sf.compile(sf.System("s", [stated]), options)
    said = float(str(caught[0].message).split(" by ")[1].split("%")[0]) / 100.0
    counted = sf.compile(sf.System("s", [replace(stated, rotary_inertia=True)]), options)
    M = [model.mass_matrix(model.neutral())[mode - 1, mode - 1] for model in (counted, without)]
    assert 1.0 - np.sqrt(M[1] / M[0]) == pytest.approx(said, rel=0.03)


@pytest.mark.parametrize("changed", [{"rhoI_z": 1e-4}, {"rhoI_y": 1.0}, {"rhoI_z": 1.0, "rotary_inertia": True}])
def test_small_or_included_rotary_inertia_is_not_warned_of(changed: dict[str, Any]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", sf.InconsistentModelWarning)
        sf.compile(sf.System("s", [beam(**changed)]), sf.Options(backend="interpreter"))


def test_a_single_clamped_beam_is_a_mechanism() -> None:
    model = sf.compile(sf.System("s", [beam()]), sf.Options(functions=("mass_matrix",)))
    assert model.names.q == ("b.bend_y[0]", "b.bend_y[1]") and "tip" in model.names.frames


@pytest.mark.parametrize(
    ("changed", "remedy"),
    [
        ({"rhoA": "1 + q^2"}, "use parameters and x"),
        ({"family": "user", "bend_y": 1, "shapes": {"bend_y": ["q*xi^2"]}}, "use xi alone"),
    ],
)
def test_sections_and_shapes_that_depend_on_coordinates_are_refused(changed: dict[str, Any], remedy: str) -> None:
    carrier = sf.RigidBody("hub", sf.Joint("q", "revolute"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    plain: dict[str, Any] = {"length": 2.0, "rhoA": 0.5, "EI_z": 3.0, "bend_y": 2}
    with pytest.raises(sf.DescriptionError, match="'q' may not be used here") as caught:
        sf.compile(sf.System("s", [carrier, sf.Beam("b", sf.Joint("root", "fixed", "hub"), **(plain | changed))]))
    assert remedy in str(caught.value)
