"""Modes say how far their frequencies are too high by too few shape functions (docs/theory/beams.md, section 10)."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams.beam import STATIONS
from symofros.description.beams.shapes import Family

# beta L squared of the uniform cantilever.
EXACT = np.array([3.5160152685, 22.034491565, 61.697214421, 120.90191605, 199.85953])
TOO_FEW = "has too few shape functions for mode"


def cantilever(
    functions: int,
    family: Family = "spline",
    mass: float = 0.0,
    root: str = "fixed",
    theory: Literal["second_order", "strain"] = "second_order",
    stations: tuple[float, ...] = STATIONS,
) -> sf.System:
    """A uniform beam of unit stiffness, mass and length, with a mass at its tip."""
    joint = sf.Joint("root", root)
    beam = sf.Beam("b", joint, 1.0, 1.0, EI_z=1.0, bend_y=functions, family=family, theory=theory, stations=stations)
    bodies: list[sf.Body] = [beam]
    if mass:
        bodies.append(sf.RigidBody("m", sf.Joint("j", "fixed", parent="b", frame="tip"), sf.Inertia(mass)))
    return sf.System("cantilever", bodies, gravity=(0, 0, 0))


@pytest.mark.parametrize(
    ("functions", "family", "theory"),
    [
        (4, "spline", "second_order"),
        (1, "spline", "second_order"),
        (2, "hermite", "second_order"),
        (4, "polynomial", "second_order"),
        (6, "legendre", "second_order"),
        (1, "spline", "strain"),
        (3, "legendre", "strain"),
    ],
)
def test_the_estimate_is_the_error_within_a_factor_of_two(
    functions: int, family: Family, theory: Literal["second_order", "strain"]
) -> None:
    found = sf.modes(sf.compile(cantilever(functions, family, theory=theory)), np.zeros(functions))
    shown = min(functions, len(EXACT))
    error = found.frequencies[:shown] / EXACT[:shown] - 1.0
    # Errors of a few thousandths of a per cent are those of the nine stations.
    assert np.all(found.too_high[:shown] > 0.5 * error - 1e-4) and np.all(found.too_high[:shown] < 2.0 * error + 1e-3)
    assert (found.too_high > 0.05).any() == any(TOO_FEW in note for note in found.notes)


def test_the_fourth_mode_of_four_splines_bears_a_note() -> None:
    (note,) = sf.modes(sf.compile(cantilever(4)), np.zeros(4)).notes
    assert note == (
        "beam 'b' has too few shape functions for mode 3: its frequency of 251.9 rad/s is too high by about 82 %;"
        " state more functions, or divide the beam into segments"
    )


def test_modes_that_the_functions_have_bear_none() -> None:
    found = sf.modes(sf.compile(cantilever(4, "clamped_free")), np.zeros(4))
    assert found.too_high.max() < 1e-3 and not found.notes


@pytest.mark.parametrize("functions", [4, 10])
def test_with_a_mass_at_the_tip_and_a_hinge(functions: int) -> None:
    """Against the same with many functions; what is right to 1 % is below the note."""
    for mass, root in ((5.0, "fixed"), (0.5, "revolute")):
        some, many = (
            sf.compile(cantilever(n, family, mass, root)) for n, family in ((functions, "spline"), (14, "legendre"))
        )
        found, exact = (sf.modes(model, model.neutral()) for model in (some, many))
        compared = slice(int(root != "fixed"), functions)
        error = found.frequencies[compared] / exact.frequencies[compared] - 1.0
        estimate = found.too_high[compared]
        assert np.all(estimate[error < 0.01] < 0.03) and np.all(estimate[error > 0.15] > 0.05)


def test_a_stretched_blade_is_judged_on_its_deformed_shape() -> None:
    """Centrifugal forces are in the moments by equilibrium."""
    hub = sf.Joint("hub", "revolute", prescribed=True)
    beam = sf.Beam("b", hub, 1.0, 1.0, EI_z=1.0, bend_y=6, family="legendre")
    model = sf.compile(sf.System("rotor", [beam], gravity=(0, 0, 0)))
    found = sf.modes(model, np.zeros(6), u=[0.0, 6.0, 0.0])
    assert np.all(found.too_high[:3] < 0.01) and np.all(found.too_high[3:] > 0.05)


def column(functions: int, family: Family) -> sf.Model:
    """A cantilever under a load P along it, whose direction stays."""
    beam = sf.Beam("b", sf.Joint("root", "fixed"), 1.0, 1.0, EI_z=1.0, bend_y=functions, family=family)
    push = sf.Load(force=("-P", 0, 0), axes="world")
    tip = sf.RigidBody("m", sf.Joint("j", "fixed", parent="b", frame="tip"), sf.Inertia(0.01), loads=[push])
    return sf.compile(sf.System("column", [beam, tip], [sf.Parameter("P", 0.0)], gravity=(0, 0, 0)))


@pytest.mark.parametrize(("functions", "family"), [(2, "spline"), (3, "polynomial")])
def test_tension_and_compression_are_in_the_estimate(functions: int, family: Family) -> None:
    """From a cable to a column near its critical load, pi^2/4; the note speaks of what is off, and not of a cable."""
    few, many = column(functions, family), column(10, "legendre")
    for load in (-100.0, -10.0, 1.2, 2.2, 2.44, 2.465):
        found, exact = (sf.modes(m, m.neutral(), par=[load], beam_limit=np.inf) for m in (few, many))
        error = found.frequencies / exact.frequencies[:functions] - 1.0
        assert np.all(found.too_high > 0.6 * error - 1e-4), load
        assert np.all(found.too_high < 1.8 * error + 1e-3), load
        assert np.any(error > 0.1) <= any(TOO_FEW in note for note in found.notes)


def test_a_column_that_may_buckle_has_no_error_in_per_cent() -> None:
    model = column(1, "spline")
    found = sf.modes(model, model.neutral(), par=[2.6], beam_limit=np.inf)
    (note,) = (note for note in found.notes if TOO_FEW in note)
    assert np.isinf(found.too_high[0]) and "rad/s is too high, if it has one at all; state" in note


def test_modes_that_do_not_oscillate_and_models_without_beams_are_not_judged() -> None:
    hinged = sf.compile(cantilever(3, root="revolute"))
    assert np.isnan(sf.modes(hinged, hinged.neutral()).too_high[0])
    body = sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(50.0),)), sf.Inertia(2.0))
    assert np.isnan(sf.modes(sf.compile(sf.System("s", [body])), [0.0]).too_high).all()


def coupled(functions: int) -> sf.Modes:
    """Of a curved rod of five strains, its three centres off its axis."""
    turning = dict.fromkeys(("bend_y", "bend_z", "twist"), functions)
    moving = dict.fromkeys(("stretch", "shear_y"), functions - 1)
    stiffness = {"EI_z": 1.0, "EI_y": 2.0, "GJ": 1.5, "EA": 300.0, "GA_y": 100.0}
    inertia: dict[str, Any] = {"rhoJ": 4e-3, "rhoI_z": 2e-3, "rotary_inertia": True, "mass_center": (0.0, 0.02)}
    centers: dict[str, Any] = {"tension_center": (0.02, 0.03), "shear_center": (-0.04, 0.02), "curvature_z": 0.8}
    joint, entries = sf.Joint("root", "fixed"), {**turning, **moving, **stiffness, **inertia, **centers}
    rod = sf.Beam("b", joint, 1.0, 1.0, theory="strain", **entries)
    model = sf.compile(sf.System("coupled", [rod], gravity=(0, 0, 0)), sf.Options(backend="interpreter"))
    return sf.modes(model, model.neutral())


@pytest.mark.slow
def test_the_estimate_of_a_rod_of_coupled_sections() -> None:
    """The torque and moments at the centres are those that the strains with functions work against."""
    few, many = coupled(3), coupled(5)
    error, estimate = few.frequencies[:5] / many.frequencies[:5] - 1.0, few.too_high[:5]
    assert error.max() > 0.03, "a mode is not quite resolved"
    assert np.all(estimate > 0.5 * error) and np.all(estimate < 2.0 * error)


@pytest.mark.parametrize("left_out", ["section_forces", "stations"])
def test_a_note_says_why_there_is_no_estimate(left_out: str) -> None:
    options = sf.Options(("forward_dynamics", "forward_dynamics_derivatives", "mass_matrix"))
    if left_out == "stations":
        model, reason = sf.compile(cantilever(4, stations=())), "stations are stated as none"
    else:
        model, reason = sf.compile(cantilever(4), options), "the model was compiled without section_forces"
    found = sf.modes(model, np.zeros(4))
    assert np.isnan(found.too_high).all()
    assert found.notes == (f"how far too few shape functions of beam 'b' raise frequencies is not estimated: {reason}",)
