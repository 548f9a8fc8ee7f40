"""Forces and moments inside beams: the tip-to-base pass, cut at a station (docs/theory/beams.md, section 9)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from symofros.expr.edges import Edge
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.beams.rod import Rod
from symofros.mechanics.beams.rod_inertia import wrenches_beyond
from symofros.mechanics.dynamics.acceleration import LinkMotion, Wrench, inertia_wrench
from symofros.mechanics.dynamics.applied.beam_loads import loads_beyond
from symofros.mechanics.dynamics.bodies.beams import deformation_wrench, root_motion
from symofros.mechanics.dynamics.bodies.inertia import undeformed
from symofros.mechanics.dynamics.jourdain import wrench_in_parent
from symofros.mechanics.kinematics.flexible import turned_section
from symofros.mechanics.kinematics.frames import FrameKinematics
from symofros.mechanics.kinematics.links import MovingBeam, TreeKinematics


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
        tip, stations = kinematics.links[beam.tip], beam.forms.beam.stations
        carried = list(_carried(kinematics, beam, transmitted))
        inertias = _inertias_beyond(kinematics, beam, motions[beam.root], tip.speeds, tip.speed_rates(v_rate))
        for xi, inertia in zip(stations, inertias, strict=True):
            loads = loads_beyond(kinematics, frames, beam, xi)
            total = sum((wrench for at, wrench in carried if at >= xi), start=inertia)
            f, n = total.f - loads.f, total.n - loads.n
            p_BS, R_BS = _section(beam, xi)
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


def _inertias_beyond(
    kinematics: TreeKinematics, beam: MovingBeam, state: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]
) -> Iterator[Wrench]:
    """Wrench about the root, in B, that the inertia of the part beyond each station takes."""
    forms, stations = beam.forms, beam.forms.beam.stations
    if isinstance(forms, Rod):
        motion = root_motion(kinematics, beam, state)
        yield from (Wrench(f, n) for f, n in wrenches_beyond(forms, stations, *motion, speeds, rates))
        return
    R_BL = kinematics.links[beam.root].R_LB.T
    for xi in stations:
        part = forms.beyond(xi)
        whole = inertia_wrench(undeformed(kinematics, replace(beam, forms=part)), state)
        whole = whole + deformation_wrench(kinematics, beam, part, state, speeds, rates)
        yield Wrench(R_BL.times(whole.f), R_BL.times(whole.n))


def _section(beam: MovingBeam, xi: float) -> tuple[Vec3, Mat3]:
    """Where the equations of motion have a section: p_BS and R_BS."""
    forms = beam.forms
    if isinstance(forms, Rod):
        return forms.position(xi), forms.section_at(xi).R_BS
    g, point = forms.along.g, forms.point(xi)
    if forms.order == 0:
        return Vec3(g, *(form.value(0) for form in point)), Mat3.identity(g)
    return Vec3(g, *(form.value() for form in point)), turned_section(forms, xi).matrix()
