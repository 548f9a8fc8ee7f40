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
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sf.InconsistentModelWarning)
        sf.compile(sf.System("s", [beam(**changed)]), sf.Options(backend="interpreter"))
    assert not any("does not count" in str(one.message) for one in caught)


@pytest.mark.parametrize("theory", ["second_order", "strain"])
@pytest.mark.parametrize("depth", [1 / 40, 1 / 10, 1 / 5])
def test_shear_that_is_left_out_is_said(depth: float, theory: Any) -> None:
    """By as much as it lowers the second frequency of a rod that has it, and adds to the tip's deflection."""
    section = sf.sections.rectangle(sf.sections.Material(70e9, 26e9, 2700.0), depth, depth)
    entries = {"length": 1.0, "bend_z": 4, "rotary_inertia": True}
    options = sf.Options(backend="interpreter")

    def compiled(**stated: Any) -> tuple[sf.Model, list[str]]:
        load = sf.BeamLoad((0.0, 0.0, 1.0), at=1.0)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", sf.InconsistentModelWarning)
            one = sf.Beam("b", CLAMPED, loads=(load,), **(entries | stated))
            model = sf.compile(sf.System("s", [one], gravity=(0.0, 0.0, 0.0)), options)
        return model, [str(one.message) for one in caught]

    without, said = compiled(theory=theory, **section.beam_properties(theory))
    sheared, quiet = compiled(theory="strain", shear_z=3, **section.beam_properties("strain"))
    assert not quiet and len(said) == int(depth > 1 / 30)
    if said:
        assert "sections do not shear in bend_z" in said[0]
        frequencies = [sf.modes(model, model.neutral()).frequencies[1] for model in (sheared, without)]
        tips = [model.frame_pose("tip", sf.equilibrium(model).q)[0][2] for model in (sheared, without)]
        lowered, added = (float(part.split(" ")[-1]) / 100.0 for part in said[0].split("%")[:2])
        # (13b) is of shear alone: where rotary inertia counts it lowers less, by an eighth at L/5.
        assert lowered == pytest.approx(1.0 - frequencies[0] / frequencies[1], rel=0.15)
        # Of the nominal factor 3, a square section of this material has 3.24.
        assert added == pytest.approx(tips[0] / tips[1] - 1.0, rel=0.12)


@pytest.mark.parametrize(("polar", "said"), [("3e-4", 0), (3.01e-4, 0), (3e-7, 1), ("6e-4*(1 - x/4)", 1)])
def test_a_polar_moment_that_is_no_sum_is_said(polar: Any, said: int) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sf.InconsistentModelWarning)
        stated = beam(rhoJ=polar, rhoI_y=1e-4, rhoI_z=2e-4, rotary_inertia=True)
        sf.compile(sf.System("s", [stated]), sf.Options(backend="interpreter"))
    assert sum("the polar moment of a section is their sum" in str(one.message) for one in caught) == said


def warnings_of(system: sf.System) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sf.InconsistentModelWarning)
        sf.compile(system, sf.Options(backend="interpreter"))
    return [str(one.message) for one in caught]


@pytest.mark.parametrize(
    ("changed", "singular"),
    [
        ({"shear_y": 2}, True),
        ({"shear_y": 3, "family": "spline"}, True),
        ({"shear_y": 1}, False),
        ({"shear_y": 2, "rotary_inertia": True, "rhoI_z": 1e-3}, False),
    ],
)
def test_bending_and_shear_that_move_no_mass_are_said(changed: dict[str, Any], singular: bool) -> None:
    stated: dict[str, Any] = {"EI_z": 1.0, "GA_y": 100.0, "bend_y": 2, "theory": "strain", "family": "legendre"}
    system = sf.System("s", [sf.Beam("b", CLAMPED, 1.0, 1.0, **(stated | changed))], gravity=(0, 0, 0))
    said = [text for text in warnings_of(system) if "bend_y and shear_y together move no mass" in text]
    model = sf.compile(system, sf.Options(backend="interpreter"))
    M = model.mass_matrix(model.neutral())
    scale = np.sqrt(np.diag(M))
    assert len(said) == singular == (np.linalg.cond(M / np.outer(scale, scale)) > 1e12)
    if singular:
        with pytest.raises(sf.SymofrosError, match="about this state[^§]*together move no mass"):
            sf.modes(model, model.neutral())
    else:
        assert sf.modes(model, model.neutral()).frequencies[0] == pytest.approx(3.5, rel=0.05)


# Of IPE 200 (DIN 1025-5): E times I_z, I_y, and G times I_T; A, all in m.
IPE_200 = {"EI_y": 210e9 * 1.42e-6, "EI_z": 210e9 * 1.943e-5, "GJ": 81e9 * 6.98e-8, "rhoA": 7850 * 2.848e-3}


@pytest.mark.parametrize("length", [2.0, 5.0, 100.0])
def test_warping_that_is_left_out_is_said(length: float) -> None:
    """By the share (27a) of the warping constant of the table."""
    inertia = {"rhoI_y": 7850 * 1.42e-6, "rhoI_z": 7850 * 1.943e-5, "rhoJ": 7850 * 2.085e-5}
    steel = sf.Beam("b", CLAMPED, length, twist=2, **IPE_200, **inertia)
    said = [text for text in warnings_of(sf.System("s", [steel])) if "warping has no part" in text]
    k = np.sqrt(IPE_200["GJ"] / (210e9 * 1.299e-8))
    share = np.tanh(k * length) / (k * length)
    assert len(said) == (share > 0.01)
    if said:
        assert float(said[0].split("by about ")[1].split("%")[0]) / 100.0 == pytest.approx(share, rel=0.15)


@pytest.mark.parametrize("shape", [(0.1, 0.1), (0.1, 0.01)])
def test_full_sections_do_not_warp(shape: tuple[float, float]) -> None:
    section = sf.sections.rectangle(sf.sections.Material(210e9, 81e9, 7850.0), *shape)
    full = sf.Beam("b", CLAMPED, 2.0, twist=2, **section.beam_properties("second_order"))
    assert not any("warping" in text for text in warnings_of(sf.System("s", [full])))


def test_a_beam_without_mass_is_refused_with_what_serves() -> None:
    with pytest.raises(sf.DescriptionError, match="a beam has mass all along[^§]*rigid bodies and joints with springs"):
        sf.sections.Material(70e9, 26e9, 0.0)
    with pytest.raises(sf.DescriptionError, match="rhoA = 0[^§]*rigid bodies and joints with springs"):
        sf.compile(sf.System("s", [beam(rhoA=0.0)]), sf.Options(backend="interpreter"))


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
