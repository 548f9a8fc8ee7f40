"""Loads along beams: their virtual power on root and elastic coordinates (docs/theory/beams.md, 5; rods.md, 5)."""

from __future__ import annotations

from symofros.description.beams.beam import BeamLoad
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import MovingBeam, TreeKinematics
from symofros.mechanics.spatial.wrench import Wrench, no_wrench


def beam_loads(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam) -> tuple[Wrench, list[Edge]]:
    """Wrench and generalized forces of the loads along a beam (eqs. 18, 19).

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of frames, for components in world axes.
        beam: The beam.

    Returns:
        The wrench on its root in the link frame, and the force on each elastic coordinate.
    """
    g, R_LB = kinematics.g, kinematics.links[beam.root].R_LB
    wrench = no_wrench(g)
    modal = [ZERO] * beam.equations.beam.modes
    for load in beam.equations.beam.loads:
        directions = _directions(kinematics, frames, beam, load)
        for k, d in enumerate(directions):
            one, forces = beam.equations.load(load, k, d)
            wrench = wrench + Wrench(R_LB.times(one.f), R_LB.times(one.n))
            modal = [g.add(a, b) for a, b in zip(modal, forces, strict=True)]
    return wrench, modal


def loads_beyond(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam, xi: float) -> Wrench:
    """The wrench about the root, in B, of the loads along the part of a beam beyond a station, those at it included.

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of frames, for components in world axes.
        beam: The beam.
        xi: Station x/L.
    """
    wrench = no_wrench(kinematics.g)
    for load in beam.equations.beam.loads:
        if load.at is not None and load.at < xi:
            continue
        directions = _directions(kinematics, frames, beam, load)
        for k, d in enumerate(directions):
            wrench = sum(beam.equations.load_beyond(load, k, d, xi), start=wrench)
    return wrench


def _directions(kinematics: TreeKinematics, frames: FrameKinematics, beam: MovingBeam, load: BeamLoad) -> list[Vec3]:
    """The axes that a load's components are along, in B; of one along those of the sections, the root's."""
    if load.axes != "world":
        return [Vec3.unit(kinematics.g, k) for k in range(3)]
    R_WL, R_LB = frames.link_pose(beam.root).R_WF, kinematics.links[beam.root].R_LB
    return [R_LB.T.times(R_WL.row(k)) for k in range(3)]
