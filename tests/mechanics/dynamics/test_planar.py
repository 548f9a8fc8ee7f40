"""Planar motion of a description in space costs what a planar one costs: what no output needs is never emitted."""

from __future__ import annotations

import pytest

import symofros as sf
from symofros.generator.passes.count import count_program

FUNCTIONS = ("mass_matrix", "bias", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "potential_energy")


def arm(links: int, in_space: bool) -> sf.System:
    """Hinges about y; in space with every moment of inertia and a mass centre beside the plane."""
    moments = ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz") if in_space else (0, "Iyy", 0)
    center = ("c", "cy" if in_space else 0, 0)
    bodies = []
    for i in range(links):
        joint = sf.Joint(f"q{i}", "revolute", *((f"b{i - 1}", "tip") if i else ()), axis=(0, 1, 0))
        inertia = sf.Inertia("m", center, moments)
        tip = [sf.Frame("tip", ("L", 0, 0))]
        bodies.append(sf.RigidBody(f"b{i}", joint, inertia, tip, waive=("nonphysical_inertia",)))
    names = ("m", "c", "cy", "L", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
    return sf.System("arm", bodies, parameters=[sf.Parameter(name, 1.0 + k / 7) for k, name in enumerate(names)])


@pytest.mark.parametrize("links", [1, 2, 3, 6])
def test_planar_motion_costs_the_same_whether_written_in_plane_or_in_space(links: int) -> None:
    planar, spatial = (count_program(sf.program_of(arm(links, space), FUNCTIONS)) for space in (False, True))
    for name in FUNCTIONS:
        assert spatial[name, ""] == planar[name, ""], name


def test_planar_mass_matrix_needs_as_few_operations_as_by_hand() -> None:
    """M of three hinges: 6 entries of 3 regrouped inertias, 2 cosines of one angle, 1 of the sum of two, and L sin."""
    count = count_program(sf.program_of(arm(3, True), ("mass_matrix",)))["mass_matrix", ""]
    assert count.mul <= 10 and count.add <= 10 and count.call <= 4
