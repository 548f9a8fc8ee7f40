"""A rod that flies, pushed at its tip, against Exudyn's geometrically exact elements, in the plane and in space."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from tests.validation.adapters.exudyn.test_parallel import is_planar, pushes, rod_of
from validation.adapters.exudyn.parallel import Robot, extrapolated, flying
from validation.mechanics.geometry import Array

PLANE = Robot(foot=(0.0, 0.3, 0.0), push=(-3.0, 8.0, 0.0))
SPACE = Robot(push=(-3.0, 8.0, 6.0))
ELEMENTS, STEP, END = 8, 0.01, 1.0


def error(robot: Robot, bends: int, strains: int) -> float:
    """Largest distance of the tip over L, of so many functions a curvature, and a stretch and shear."""
    t, known = extrapolated(robot, ELEMENTS, STEP, END, flying)
    assert np.abs(known).max() > 1.4  # It turns by radians and flies on.
    p = flown(robot, bends, strains, t)
    assert len(p) == len(known)
    return float(np.abs(p - known).max())


def flown(robot: Robot, bends: int, strains: int, instants: Array) -> Array:
    """Displacement of our tip (n, 3)."""
    base = sf.Joint("base", "planar" if is_planar(robot) else "free")
    load = sf.BeamLoad(pushes(robot), at=1.0, axes="world")
    beam = sf.Beam("rod", base, 1.0, loads=(load,), **rod_of(robot, bends, strains))
    m = sf.compile(sf.System("flying", (beam,), gravity=(0, 0, 0)))
    run = sf.simulate(m, t_end=END, method="dopri5", rtol=1e-7, atol=1e-8, output=instants[1])
    return np.asarray(m.frame_pose("tip", run.q)[0] - (1.0, 0.0, 0.0))


# What functions leave out: that of Exudyn's elements, by the next test, is 4e-5 and 9e-5.
@pytest.mark.parametrize(
    ("robot", "bends", "strains", "bound"),
    [
        (PLANE, 2, 1, 2.4e-2),
        (PLANE, 4, 3, 9e-4),
        (PLANE, 5, 4, 8e-5),
        (SPACE, 2, 2, 3e-2),
        pytest.param(SPACE, 3, 3, 4e-3, marks=pytest.mark.slow),  # Compiled for seconds.
        pytest.param(SPACE, 4, 4, 1.1e-3, marks=pytest.mark.slow),
    ],
    ids=["plane 2", "plane 4", "plane 5", "space 2", "space 3", "space 4"],
)
def test_a_rod_flies_as_elements_of_exudyn_do(robot: Robot, bends: int, strains: int, bound: float) -> None:
    assert error(robot, bends, strains) < bound


@pytest.mark.parametrize("robot", [PLANE, SPACE], ids=["plane", "space"])
def test_elements_of_exudyn_converge(robot: Robot) -> None:
    """Extrapolated from elements and steps that are halved together: an error of fourth order falls to a sixteenth."""
    coarse, middle, fine = (extrapolated(robot, n, 0.08 / n, END, flying)[1] for n in (4, 8, 16))
    last = np.abs(middle - fine[::2]).max()
    assert last < 1e-4
    assert last < np.abs(coarse - middle[::2]).max() / 8.0
