"""Rods that bend in one plane: their formulas against those of rods in space (docs/theory/rods.md, section 4)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.compiler import program_of
from symofros.generator.passes.count import count_program
from symofros.mechanics.beams.strain import planar
from symofros.mechanics.beams.strain.equations import StrainEquations
from tests.mechanics.beams.rods import GRAVITY, HUB, rod

FREE = sf.Joint("base", "free")
PLANES: dict[str, tuple[tuple[int, int, int], sf.Joint, dict[str, Any]]] = {
    "free, about z": ((3, 0, 0), FREE, {}),
    "free, about y, with rotary inertia": ((0, 2, 0), FREE, {"rotary_inertia": True}),
    "at a hub, about z, curved and tapered": (
        (2, 0, 0),
        HUB,
        {"rotary_inertia": True, "curvature_z": "0.3 + x", "rhoA": "2 + x", "rhoJ": "0.04 + 0.01*x"},
    ),
    "more sections than pairs serve, about z": ((2, 0, 0), FREE, {"rotary_inertia": True, "sections": 20}),
    "splines with knots, about y": ((0, 5, 0), FREE, {"family": "spline"}),
}


@pytest.mark.parametrize("name", PLANES)
def test_a_rod_in_a_plane_has_the_inertia_of_one_in_space(
    name: str, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    counts, joint, more = PLANES[name]
    system = sf.System("s", (rod(counts, joint, **more),), gravity=GRAVITY)
    options = sf.Options(("mass_matrix", "bias", "inverse_dynamics", "kinetic_energy"), backend="interpreter")
    plane = sf.compile(system, options)
    monkeypatch.setattr(planar, "PlanarStrainEquations", StrainEquations)
    space = sf.compile(system, options)
    q = plane.integrate(plane.neutral(), 0.7 * rng.standard_normal(plane.nv))
    v, a = rng.standard_normal((2, plane.nv))
    M = space.mass_matrix(q)
    assert plane.mass_matrix(q) == pytest.approx(M, abs=1e-14 * np.abs(M).max())
    assert plane.kinetic_energy(q, v) == pytest.approx(0.5 * v @ M @ v, rel=1e-13)
    for ours, theirs in (
        (plane.bias(q, v), space.bias(q, v)),
        (plane.inverse_dynamics(q, v, a), space.inverse_dynamics(q, v, a)),
    ):
        assert ours == pytest.approx(theirs, abs=1e-13 * np.abs(theirs).max())


def test_mass_matrix_uses_points_if_section_pairs_are_too_many() -> None:
    """Eight splines between knots have 20 sections: by pairs 15234 operations; twelve make sums too long for packs."""
    system = sf.System("s", (rod((8, 0, 0), FREE, family="spline", rhoI_y=0.0, rhoI_z=0.0),))
    assert count_program(program_of(system, ["dynamics"]))["dynamics", ""].total <= 13554
