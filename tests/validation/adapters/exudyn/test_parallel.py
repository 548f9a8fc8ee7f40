"""A parallel robot of two exact rods in motion against Exudyn's elements, in the plane and in space."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from validation.adapters.exudyn.parallel import Robot, cantilever, extrapolated
from validation.mechanics.geometry import Array

PLANE = Robot(foot=(0.0, 0.3, 0.0), push=(-1.0, 4.0, 0.0))
SPACE = Robot()
END = 1.0


def rod_of(robot: Robot, bends: int, strains: int) -> dict[str, Any]:
    """Entries of a rod of so many functions a curvature, and a stretch and shear."""
    EA, GA_y, GA_z, GJ, EI_y, EI_z = robot.stiffness
    rhoA, rhoJ, rhoI_y, rhoI_z = robot.inertia
    given: dict[str, Any] = {"rhoA": rhoA, "EA": EA, "GA_y": GA_y, "EI_z": EI_z, "rhoI_z": rhoI_z}
    given |= {"bend_y": bends, "stretch": strains, "shear_y": strains}
    given |= {"family": "legendre", "theory": "strain", "rotary_inertia": True}
    if not is_planar(robot):
        given |= {"GA_z": GA_z, "GJ": GJ, "EI_y": EI_y, "rhoJ": rhoJ, "rhoI_y": rhoI_y}
        given |= {"bend_z": bends, "twist": strains, "shear_z": strains}
    return given


def is_planar(robot: Robot) -> bool:
    """Whether it stays in the plane of x and y."""
    return robot.push[2] == robot.foot[2] == 0.0


def pushes(robot: Robot) -> tuple[str, ...]:
    """The force on the tip, as formulas of the time up to the duration."""
    return tuple(f"{largest}*sin(pi*t/{robot.duration})^2" for largest in robot.push)


def tip(robot: Robot, bends: int, strains: int, instants: Array) -> Array:
    """Displacement of the first tip (n, 3), of so many functions a curvature, and a stretch and shear."""
    given, push = rod_of(robot, bends, strains), pushes(robot)
    platform = sf.RigidBody(
        "platform",
        sf.Joint("weld", "fixed", "first", "tip"),
        sf.Inertia(robot.mass, (0.0, 0.0, 0.0), (robot.moment,) * 3),
        frames=(sf.Frame("seat", robot.foot),),
        loads=(sf.Load(push, axes="world"),),
    )
    bodies = (
        sf.Beam("first", sf.Joint("foot", "fixed"), 1.0, **given),
        sf.Beam("second", sf.Joint("other foot", "fixed", position=robot.foot), 1.0, **given),
        platform,
    )
    ball = sf.Closure(
        "ball", ("platform", "seat"), ("second", "tip"), ("x", "y") if is_planar(robot) else ("x", "y", "z")
    )
    m = sf.compile(sf.System("robot", bodies, gravity=(0, 0, 0), constraints=(ball,)))
    run = sf.simulate(m, t_end=END, method="dopri5", rtol=1e-7, atol=1e-8, output=instants[1])
    return np.asarray(m.frame_pose("first.tip", run.q)[0] - (1.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("bends", "strains", "error"), [(2, 1, 2e-2), (3, 2, 1.5e-3), (5, 3, 7e-5)], ids=["2", "3", "5"]
)
def test_a_pushed_rod_moves_as_elements_of_exudyn_do(bends: int, strains: int, error: float) -> None:
    """In the plane, by 0.7 of its length; errors are what functions leave out, Exudyn's own is 9e-6."""
    t, known = extrapolated(PLANE, 8, 0.02, 0.6, cantilever)
    assert np.abs(known).max() > 0.4
    load = sf.BeamLoad(pushes(PLANE), at=1.0, axes="world")
    beam = sf.Beam("rod", sf.Joint("root", "fixed"), 1.0, loads=(load,), **rod_of(PLANE, bends, strains))
    m = sf.compile(sf.System("pushed", (beam,), gravity=(0, 0, 0)))
    run = sf.simulate(m, t_end=0.6, method="dopri5", rtol=1e-6, atol=1e-8, output=t[1])
    found = m.frame_pose("tip", run.q)[0] - (1.0, 0.0, 0.0)
    assert found == pytest.approx(known, abs=error)


@pytest.mark.slow  # A loop of rods is compiled: seconds in the plane, a minute for 36 coordinates in space.
@pytest.mark.parametrize(
    ("robot", "bends", "strains", "error"),
    # What functions leave out: Exudyn errs by 7e-6 in the plane, by the difference to twice as many elements.
    [(PLANE, 2, 1, 4e-3), (PLANE, 3, 2, 1e-3), (PLANE, 4, 3, 2e-5), (SPACE, 2, 2, 4e-3), (SPACE, 3, 3, 6e-4)],
    ids=["plane 2", "plane 3", "plane 4", "space 2", "space 3"],
)
def test_two_joined_rods_move_as_elements_of_exudyn_do(robot: Robot, bends: int, strains: int, error: float) -> None:
    t, known = extrapolated(robot, 8, 0.01, END)
    assert np.abs(known).max() > 0.3
    assert tip(robot, bends, strains, t) == pytest.approx(known, abs=error)


def test_extrapolation_converges_with_the_fourth_order() -> None:
    """The reference itself, elements and steps halved together: a factor of 16, of which 8 tells it from the third."""
    end = 0.4
    coarse, middle, fine = (extrapolated(PLANE, n, 0.08 / n, end)[1] for n in (2, 4, 8))
    assert np.abs(middle[::2] - fine[::4]).max() < np.abs(coarse - middle[::2]).max() / 8.0
    assert np.abs(middle[::2] - fine[::4]).max() < 1e-3 * np.abs(fine).max()
