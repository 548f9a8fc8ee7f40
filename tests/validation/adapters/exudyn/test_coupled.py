"""A rod beside its centres, its axes no principal ones, against Exudyn's geometrically exact elements."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.description.beams.sections import Section
from tests.validation.adapters.exudyn.test_parallel import pushes
from validation.adapters.exudyn.parallel import Robot, cantilever, extrapolated

# Exudyn's elements have centres on their axis, and principal axes: they stand beside ours, and turned.
ROBOT = Robot(push=(-2.0, 4.0, 3.5), stiffness=(200.0, 110.0, 110.0, 0.8, 1.0, 2.5), turn=0.6, center=(0.08, -0.05))
END = 0.5


def off_axis(robot: Robot) -> dict[str, Any]:
    """What a beam has of the section of a robot."""
    EA, GA_y, GA_z, GJ, EI_y, EI_z = robot.stiffness
    rhoA, _, rhoI_y, rhoI_z = robot.inertia
    plain = Section(EA=EA, GJ=GJ, EI_y=EI_y, EI_z=EI_z, rhoA=rhoA, rhoI_y=rhoI_y, rhoI_z=rhoI_z)
    given = plain.turned(-robot.turn).beam_properties("strain")
    centers = dict.fromkeys(("tension_center", "shear_center", "mass_center"), robot.center)
    return given | centers | {"GA_y": GA_y, "GA_z": GA_z, "rotary_inertia": True}


@pytest.mark.slow  # Rods of 12 to 24 coordinates are compiled.
@pytest.mark.parametrize(("functions", "error"), [(2, 2e-2), (3, 1e-3), (4, 2e-4)])
def test_a_rod_off_its_centres_moves_as_elements_of_exudyn_do(functions: int, error: float) -> None:
    t, known = extrapolated(ROBOT, 8, 0.02, END, cantilever)
    assert np.abs(known).max() > 0.4
    load = sf.BeamLoad(pushes(ROBOT), at=1.0, axes="world")
    counts: dict[str, Any] = dict.fromkeys(("bend_y", "bend_z", "twist", "stretch", "shear_y", "shear_z"), functions)
    counts |= {"family": "legendre", "theory": "strain"}
    beam = sf.Beam("rod", sf.Joint("root", "fixed"), 1.0, loads=(load,), **counts, **off_axis(ROBOT))
    m = sf.compile(sf.System("pushed", (beam,), gravity=(0, 0, 0)))
    run = sf.simulate(m, t_end=END, method="dopri5", rtol=1e-6, atol=1e-8, output=t[1])
    found = m.frame_pose("tip", run.q)[0] - (1.0, 0.0, 0.0)
    assert found == pytest.approx(known, abs=error)
