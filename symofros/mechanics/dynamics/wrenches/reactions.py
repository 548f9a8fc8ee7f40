"""Wrenches of joints, efforts of prescribed motions (docs/theory/rigid.md, 11), forces inside beams (beams.md, 9)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symofros.expr.derivative import along
from symofros.expr.edges import Edge
from symofros.mechanics.dynamics.applied.beam_loads import loads_beyond
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.dynamics.bodies.inertia import stated_inertias
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.dynamics.jourdain import link_wrenches, power, spin_effort, subtree_wrenches, wrench_in_parent
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


def transmitted_wrenches(
    kinematics: TreeKinematics,
    rotors: list[MovingRotor],
    motions: Sequence[LinkMotion],
    v_rate: Sequence[Edge],
    acting: Sequence[Sequence[Wrench]],
) -> list[Wrench]:
    """The wrench that each joint transmits to its link, about Lo, in L (eq. 47).

    Inertias are those of the description: regrouped ones (section 4) leave the power of a wrench as it is, not the
    wrench itself.

    Args:
        kinematics: Kinematics of the tree.
        rotors: Rotors that spin in links.
        motions: Velocity and acceleration of the links, with gravity as an acceleration of the base.
        v_rate: v' (nv).
        acting: Lists of wrenches on the links other than those of joints, one a link.
    """
    total, _ = link_wrenches(kinematics, stated_inertias(kinematics), rotors, motions, v_rate)
    for wrenches in acting:
        total = [Wrench(x.f - y.f, x.n - y.n) for x, y in zip(total, wrenches, strict=True)]
    return [wrench for _, wrench in sorted(subtree_wrenches(kinematics, total), key=lambda item: item[0])]


def in_body_frames(kinematics: TreeKinematics, wrenches: Sequence[Wrench]) -> list[list[Edge]]:
    """Force and moment about Bo of each link's wrench, in its body frame B (6)."""
    rows = []
    for link, wrench in zip(kinematics.links, wrenches, strict=True):
        R_BL = link.R_LB.T
        rows.append([*R_BL.times(wrench.f), *R_BL.times(wrench.n)])
    return rows


def prescribed_efforts(
    kinematics: TreeKinematics,
    rotors: list[MovingRotor],
    motions: Sequence[LinkMotion],
    v_rate: Sequence[Edge],
    wrenches: Sequence[Wrench],
) -> list[Edge]:
    """Effort of the drive of each prescribed speed (eq. 49).

    Args:
        kinematics: Kinematics of the tree.
        rotors: Rotors, those that a drive turns among them.
        motions: Velocity and acceleration of the links.
        v_rate: v' (nv).
        wrenches: Wrench that each joint transmits to its link.
    """
    g, lowering = kinematics.g, kinematics.lowering
    energy = g.sum(lowering.value(potential.energy) for potential in kinematics.tree.system.potentials)
    slopes = iter(along(g, [energy], rates_per_speed(kinematics, prescribed=True))[0])
    efforts = []
    for i, (link, wrench) in enumerate(zip(kinematics.links, wrenches, strict=True)):
        if link.rates is None:
            continue
        for k, partial in enumerate(link.partial_velocities):
            driven = [rotor for rotor in rotors if (rotor.link, rotor.coordinate) == (i, k)]
            spins = [spin_effort(kinematics, rotor, motions, v_rate) for rotor in driven]
            efforts.append(g.sum([power(partial, wrench), next(slopes), *spins]))
    return efforts
