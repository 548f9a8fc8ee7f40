"""Forces and moments inside beams: the tip-to-base pass, cut at a station (docs/theory/beams.md, section 9)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symofros.expr.edges import Edge
from symofros.mechanics.dynamics.applied.beam_loads import loads_beyond
from symofros.mechanics.dynamics.jourdain import wrench_in_parent
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import MovingBeam, TreeKinematics
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench


def section_forces(
    kinematics: TreeKinematics,
    frames: FrameKinematics,
    motions: Sequence[LinkMotion],
    v_rate: Sequence[Edge],
    transmitted: Sequence[Wrench],
) -> Iterator[list[Edge]]:
    """Force N, Vy, Vz and moment T, My, Mz at stations of elastic beams, along the axes of the sections (31).

    Args:
        kinematics: Kinematics of the tree.
        frames: Kinematics of frames, for loads in world axes.
        motions: Velocity and acceleration of the links, with gravity as an acceleration of the base.
        v_rate: v' (nv).
        transmitted: Wrench that each joint transmits to its link; a section of a beam to what it carries.
    """
    for beam in kinematics.beams:
        if beam.tip is None:
            continue
        tip, stations = kinematics.links[beam.tip], beam.equations.beam.stations
        carried = list(_carried(kinematics, beam, transmitted))
        inertias = beam.equations.inertia_beyond(motions[beam.root], tip.speeds, tip.speed_rates(v_rate))
        for xi, inertia in zip(stations, inertias, strict=True):
            loads = loads_beyond(kinematics, frames, beam, xi)
            total = sum((wrench for at, wrench in carried if at >= xi), start=inertia)
            f, n = total.f - loads.f, total.n - loads.n
            p_BS, R_BS = beam.equations.section(xi)
            # What the section takes from the part beyond it, not what it gives: tension counts as positive.
            yield [-edge for vector in (f, n - p_BS.cross(f)) for edge in R_BS.T.times(vector)]


def _carried(
    kinematics: TreeKinematics, beam: MovingBeam, transmitted: Sequence[Wrench]
) -> Iterator[tuple[float, Wrench]]:
    """Stations of the sections that carry something, with the wrench that they transmit to it, about the root, in B."""
    assert beam.tip is not None
    R_BL = kinematics.links[beam.root].R_LB.T
    for i in (beam.tip, *beam.stations):
        station, wrench = kinematics.tree.links[i].station, wrench_in_parent(kinematics.links[i], transmitted[i])
        yield 1.0 if station is None else station.xi, Wrench(R_BL.times(wrench.f), R_BL.times(wrench.n))
