"""Rods whose centres are off the axis, or whose strains are coupled (docs/theory/rods.md, sections 2 to 4)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams.sections import Section
from tests.mechanics.beams.rods import BODY, GRAVITY, HUB, STIFF, rod

L = 1.3
ARM = np.array([0.0, 0.07, -0.04])  # From the axis to all three centres.
TREE = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy", "frame_pose")


def on_hub(off: bool, **more: Any) -> sf.Model:
    """A rod on a hub, its axis through its centres, or beside them so that these are where they were."""
    position, given = np.array((0.1, 0.05, 0.02)), dict(more)
    if off:
        position = position - ARM
        given |= dict.fromkeys(("tension_center", "shear_center", "mass_center"), tuple(ARM[1:]))
    joint = sf.Joint("clamp", "fixed", "hub", position=tuple(position.tolist()))
    system = sf.System("s", (sf.RigidBody("hub", HUB, BODY), rod((2, 2, 2), joint, L, **given)), gravity=GRAVITY)
    return sf.compile(system, sf.Options(TREE, ("tip",), backend="interpreter"))


def strains_at_the_axis(nv: int) -> np.ndarray:
    """Coordinates of the rod beside its centres by those of the rod through them: stretch and shears differ."""
    T, (_, y, z) = np.eye(nv), ARM
    if nv > 7:
        bend_y, bend_z, twist, stretch, shear_y, shear_z = (1 + 2 * i + np.arange(2) for i in range(6))
        T[stretch, bend_z], T[stretch, bend_y] = z / L, y / L
        T[shear_y, twist], T[shear_z, twist] = z / L, -y / L
    return T


@pytest.mark.parametrize(
    ("more", "errors"),
    # Sections err by the sixth power of their distance, in either rod by itself.
    [
        ({"sections": 6}, (4e-8, 4e-10)),
        pytest.param({"sections": 12}, (2e-9, 1e-11), marks=pytest.mark.slow),
        ({"sections": 8, "stretch": 2, "shear_y": 2, "shear_z": 2, "rotary_inertia": True} | STIFF, (1e-8, 2e-11)),
    ],
    ids=["6 sections", "12 sections", "stretched and sheared"],
)
def test_results_do_not_depend_on_the_reference_axis(more: dict[str, Any], errors: tuple[float, float]) -> None:
    through, beside = on_hub(False, **more), on_hub(True, **more)
    T, rng = strains_at_the_axis(through.nv), np.random.default_rng(0)
    q, v = 0.5 * rng.standard_normal(through.nv), rng.standard_normal(through.nv)
    q[7:] *= 0.2
    p, w = T @ q, T @ v
    dynamics, places = errors
    assert T.T @ beside.mass_matrix(p) @ T == pytest.approx(through.mass_matrix(q), abs=dynamics)
    assert T.T @ beside.bias(p, w) == pytest.approx(through.bias(q, v), abs=dynamics)
    assert T.T @ beside.generalized_force(p, w, ()) == pytest.approx(through.generalized_force(q, v, ()), abs=1e-12)
    assert beside.kinetic_energy(p, w) == pytest.approx(through.kinetic_energy(q, v), abs=dynamics)
    weights = [m.potential_energy(x) - m.potential_energy(0 * x) for m, x in ((through, q), (beside, p))]
    assert weights[1] == pytest.approx(weights[0], abs=dynamics)
    (place, _), (tip, R) = through.frame_pose("tip", q), beside.frame_pose("tip", p)
    assert tip + R @ ARM == pytest.approx(place, abs=places)


@pytest.mark.parametrize("shears", [{}, {"stretch": 1}, {"stretch": 1, "shear_y": 1, "shear_z": 1}], ids=str)
def test_section_matrices_follow_from_centres_and_stiffnesses(shears: dict[str, int]) -> None:
    stated: dict[str, Any] = {"EI_z": 3.0, "EI_y": 5.0, "GJ": 1.5, "EI_yz": 1.2} | STIFF
    centers: dict[str, Any] = {"tension_center": (0.06, -0.02), "shear_center": (0.04, -0.05)}
    matrix = Section(rhoA=2.0, rhoI_y=0.03, rhoI_z=0.02, **stated, **centers).stiffness_matrix()
    options = sf.Options(("mass_matrix", "generalized_force"), backend="interpreter")
    found = []
    for given in (stated | centers, {"stiffness": matrix.tolist()} | dict.fromkeys(("EI_y", "EI_z", "GJ"), 0.0)):
        m = sf.compile(sf.System("s", (rod((1, 1, 1), **shears, **given),)), options)
        q = 0.3 * np.random.default_rng(2).standard_normal(m.nv)
        found.append((m.mass_matrix(q), m.generalized_force(q, 0 * q, ())))
    for a, b in zip(*found, strict=True):
        assert a == pytest.approx(b, rel=1e-12, abs=1e-14)


def test_a_force_through_the_shear_centre_does_not_twist() -> None:
    P, (y, z), GJ = 1e-4, (0.05, -0.03), 1.5
    for torque, twist in ((0.0, z * P), (-z * P, 0.0)):
        load = sf.BeamLoad((0.0, P, 0.0), (torque, 0.0, 0.0), at=1.0)
        system = sf.System(
            "s", (rod((2, 2, 1), None, L, shear_center=(y, z), GJ=GJ, loads=(load,)),), gravity=(0, 0, 0)
        )
        q = sf.equilibrium(sf.compile(system)).q
        assert q[4] == pytest.approx(twist * L / GJ, rel=1e-5, abs=1e-6 * P)


def test_a_rod_with_the_maximum_number_of_sections_is_judged() -> None:
    """Twice as many would be more than there may be: it is compared with half of them."""
    m = sf.compile(sf.System("s", (rod((2, 0, 0), sections=40),), gravity=(0, 0, 0)))
    run = sf.simulate(m, [0.3, 0.1], t_end=0.01)
    assert run.bendings[0].error < 1e-6
