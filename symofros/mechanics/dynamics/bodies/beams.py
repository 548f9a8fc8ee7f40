"""Terms that the deformation of beams adds to the equations of motion (docs/theory/beams.md, section 4; rods.md, 4).

A beam is one body in the recursion: a wrench on its root, and one force for each elastic coordinate. Everything
follows from its kinetic energy by Boltzmann and Hamel's equations, so the same forms give M, h and T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.beams.elastic import PAIRS, BeamForms
from symofros.mechanics.beams.fields import Form
from symofros.mechanics.beams.rod import Rod
from symofros.mechanics.beams.rod_inertia import rod_energy_twice, rod_forces, rod_modal_mass, rod_momentum
from symofros.mechanics.dynamics.acceleration import LinkMotion, Wrench, inertia_wrench
from symofros.mechanics.dynamics.bodies.inertia import deformed
from symofros.mechanics.kinematics.links import MovingBeam, TreeKinematics

Triple = tuple[Form, Form, Form]


def modal_mass(beam: MovingBeam, i: int, j: int) -> Edge:
    """M_ij of two elastic coordinates of one beam (eq. 11)."""
    if isinstance(beam.forms, Rod):
        return rod_modal_mass(beam.forms, i, j)
    return _form_mass(beam.forms, i, j)


def added_momentum(kinematics: TreeKinematics, beam: MovingBeam, i: int) -> tuple[Vec3, Vec3]:
    """Linear momentum and angular momentum about the root, in the link frame, per unit rate of coordinate i."""
    order, R_LB = beam.order, kinematics.links[beam.root].R_LB
    if isinstance(beam.forms, Rod):
        p, n = rod_momentum(beam.forms, i)
        return R_LB.times(p), R_LB.times(n)
    linear = Vec3(kinematics.g, *(form.gradient[i].value(order) for form in beam.forms.first_moment))
    return R_LB.times(linear), R_LB.times(_vector(kinematics.g, beam.forms.angular[i], order))


def beam_forces(
    kinematics: TreeKinematics, beam: MovingBeam, state: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]
) -> tuple[Wrench, list[Edge]]:
    """Inertia forces that deformation adds to those of the undeformed beam (eqs. 15-17).

    Args:
        kinematics: Kinematics of the tree.
        beam: The beam.
        state: Motion of the beam's root.
        speeds: Rates of the elastic coordinates.
        rates: Second derivatives of the elastic coordinates.

    Returns:
        The wrench on the root in the link frame, and the force on each elastic coordinate.
    """
    R_LB = kinematics.links[beam.root].R_LB
    w, alpha, a = root_motion(kinematics, beam, state)
    if isinstance(beam.forms, Rod):
        f, n, forces = rod_forces(beam.forms, w, alpha, a, speeds, rates)
        return Wrench(R_LB.times(f), R_LB.times(n)), forces
    wrench = deformation_wrench(kinematics, beam, beam.forms, state, speeds, rates)
    return wrench, [_modal_force(beam.forms, i, w, alpha, a, speeds, rates) for i in range(len(speeds))]


def root_motion(kinematics: TreeKinematics, beam: MovingBeam, state: LinkMotion) -> tuple[Vec3, Vec3, Vec3]:
    """Angular velocity, angular acceleration and acceleration of a beam's root, in B."""
    R_BL = kinematics.links[beam.root].R_LB.T
    return R_BL.times(state.w_WL_L), R_BL.times(state.alpha_WL_L), R_BL.times(state.a_WLo_L)


def deformation_wrench(
    kinematics: TreeKinematics,
    beam: MovingBeam,
    forms: BeamForms,
    state: LinkMotion,
    speeds: Sequence[Edge],
    rates: Sequence[Edge],
) -> Wrench:
    """Wrench on the root, in the link frame, that deformation adds to the inertia of the undeformed beam (eqs. 15, 16).

    Args:
        kinematics: Kinematics of the tree.
        beam: The beam.
        forms: Forms of the beam, or of the part beyond a station.
        state: Motion of the beam's root.
        speeds: Rates of the elastic coordinates.
        rates: Second derivatives of the elastic coordinates.
    """
    R_LB = kinematics.links[beam.root].R_LB
    relative = _relative_wrench(forms, R_LB.T.times(state.w_WL_L), speeds, rates)
    straight = inertia_wrench(deformed(kinematics, replace(beam, forms=forms)), state)
    return straight + Wrench(R_LB.times(relative.f), R_LB.times(relative.n))


def _relative_wrench(forms: BeamForms, w: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]) -> Wrench:
    """Force and moment of the motion relative to B, and of Coriolis' acceleration (eqs. 15, 16).

    Forms of what is zero, at rest and without accelerations, are not asked for their values.
    """
    g, order = w.g, forms.order
    S_rate = Vec3(g, *(form.rate(speeds, order) for form in forms.first_moment))
    twice = w + w
    f = twice.cross(S_rate) + Vec3(g, *(form.second_rate(speeds, order) for form in forms.first_moment))
    E_rate = [form.rate(speeds, order) for form in forms.second_moment]
    n = _moment_rate(g, E_rate).times(w)
    spin = Vec3(g)
    for i, (angular, speed, rate) in enumerate(zip(forms.angular, speeds, rates, strict=True)):
        if rate != ZERO:
            linear = Vec3(g, *(form.gradient[i].value(order) for form in forms.first_moment))
            f = f + linear.scaled(rate)
            n = n + _vector(g, angular, order).scaled(rate)
        if speed != ZERO:
            n = n + Vec3(g, *(form.rate(speeds, order - 1) for form in angular)).scaled(speed)
            spin = spin + _vector(g, angular, order - 1).scaled(speed)
    return Wrench(f, n + w.cross(spin))


def _modal_force(
    forms: BeamForms, i: int, w: Vec3, alpha: Vec3, a: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]
) -> Edge:
    """The inertia force on elastic coordinate i (eq. 17)."""
    g, order = w.g, forms.order
    linear = Vec3(g, *(form.gradient[i].value(order) for form in forms.first_moment))
    total = g.add(linear.dot(a), _vector(g, forms.angular[i], order).dot(alpha))
    total = g.add(total, g.sum(g.mul(_form_mass(forms, i, j), rate) for j, rate in enumerate(rates) if rate != ZERO))
    total = g.add(total, _centrifugal(g, w, [form.gradient[i].value(order) for form in forms.second_moment]))
    curl = Vec3(g)
    for j, speed in enumerate(speeds):
        if speed == ZERO:
            continue
        there = _vector(g, _slopes(forms.angular[i], j), order - 1)
        back = _vector(g, _slopes(forms.angular[j], i), order - 1)
        curl = curl + (there - back).scaled(speed)
    return g.add(g.add(total, w.dot(curl)), _convective(forms, i, speeds))


def _centrifugal(g: Graph, w: Vec3, E: Sequence[Edge]) -> Edge:
    """-1/2 w . J w for J = tr(E) 1 - E: the sum over axes of 1/2 (w w^T - w.w 1) : E."""
    x, y, z = w
    xx, yy, zz = g.mul(x, x), g.mul(y, y), g.mul(z, z)
    half = g.constant(0.5)
    squares = (g.add(yy, zz), g.add(xx, zz), g.add(xx, yy))
    total = g.sum(-g.mul(g.mul(half, E[k]), squares[k]) for k in range(3))
    for k, (a, b) in enumerate(PAIRS[3:], start=3):
        total = g.add(total, g.mul(E[k], g.mul(tuple(w)[a], tuple(w)[b])))
    return total


def _form_mass(forms: BeamForms, i: int, j: int) -> Edge:
    return forms.modal_mass[min(i, j), max(i, j)].value(forms.order)


def _convective(forms: BeamForms, i: int, speeds: Sequence[Edge]) -> Edge:
    """The sum over j, k of (d_k M_ij - 1/2 d_i M_jk) v_j v_k."""
    g, order, M = forms.along.g, forms.order, forms.modal_mass
    half, total = g.constant(0.5), ZERO
    for j, speed in enumerate(speeds):
        if speed == ZERO:
            continue
        total = g.add(total, g.mul(M[min(i, j), max(i, j)].rate(speeds, order - 1), speed))
        for k in range(j, len(speeds)):
            slope = M[j, k].gradient[i].value(order - 2)
            product = g.mul(speed, speeds[k])
            total = g.sub(total, g.mul(slope, g.mul(half, product) if j == k else product))
    return total


def kinetic_energy_twice(
    kinematics: TreeKinematics, beam: MovingBeam, w_WL_L: Vec3, v_WLo_L: Vec3, speeds: Sequence[Edge]
) -> Edge:
    """Twice what deformation adds to the kinetic energy (eq. 12).

    Args:
        kinematics: Kinematics of the tree.
        beam: The beam.
        w_WL_L: Angular velocity of the root's link [rad/s].
        v_WLo_L: Velocity of the root [m/s].
        speeds: Rates of the elastic coordinates.
    """
    g = kinematics.g
    if isinstance(beam.forms, Rod):
        R_LB = kinematics.links[beam.root].R_LB
        return rod_energy_twice(beam.forms, R_LB.T.times(w_WL_L), R_LB.T.times(v_WLo_L), speeds)
    change = deformed(kinematics, beam)
    crossed = w_WL_L.cross(change.mp_LLcm)
    total = g.add(v_WLo_L.dot(crossed + crossed), w_WL_L.dot(change.I_LLo_L.times(w_WL_L)))
    for i, speed in enumerate(speeds):
        p, n = added_momentum(kinematics, beam, i)
        coupling = g.add(p.dot(v_WLo_L), n.dot(w_WL_L))
        own = g.sum(g.mul(modal_mass(beam, i, j), other) for j, other in enumerate(speeds))
        total = g.add(total, g.mul(speed, g.add(g.add(coupling, coupling), own)))
    return total


def elastic_forces(kinematics: TreeKinematics, beam: MovingBeam) -> list[Edge]:
    """Elastic and damping forces on the elastic coordinates (eqs. 7, 14)."""
    g, forms = kinematics.g, beam.forms
    dissipation = forms.damping_energy(() if beam.tip is None else kinematics.links[beam.tip].speeds)
    return [
        -g.add(elastic.value(), viscous.value())
        for elastic, viscous in zip(forms.strain_energy.gradient, dissipation.gradient, strict=True)
    ]


def _vector(g: Graph, forms: Triple, upto: float) -> Vec3:
    return Vec3(g, *(form.value(upto) for form in forms))


def _slopes(forms: Triple, i: int) -> Triple:
    x, y, z = (form.gradient[i] for form in forms)
    return x, y, z


def _moment_rate(g: Graph, E_rate: Sequence[Edge]) -> Mat3:
    """J' = tr(E') 1 - E'."""
    xx, yy, zz, xy, xz, yz = E_rate
    return Mat3(g, (g.add(yy, zz), -xy, -xz, -xy, g.add(xx, zz), -yz, -xz, -yz, g.add(xx, yy)))
