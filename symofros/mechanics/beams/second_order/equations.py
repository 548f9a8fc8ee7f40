"""A beam of second order in the equations of motion (docs/theory/beams.md, sections 1 and 4).

A beam is one body in the recursion: a wrench on its root, and one force for each elastic coordinate. Everything
follows from its kinetic energy by Boltzmann and Hamel's equations, so the same forms give M, h and T.

From the root to a section, elastic coordinates move it as a joint's coordinates would. The displacement is that of the
second-order field, the rotation is the product of the section's yaw, pitch and roll (eqs. 1-5), so it is a rotation at
any deflection.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from symofros.description.beams.beam import BeamLoad
from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.beams.fields import Form
from symofros.mechanics.beams.second_order import loads
from symofros.mechanics.beams.second_order.forms import BeamForms, Vector
from symofros.mechanics.spatial.across import (
    AcrossJoint,
    JointRotation,
    PartialVelocity,
    across_rotations,
    rotation_about,
)
from symofros.mechanics.spatial.inertia import PAIRS, LinkInertia, rotated
from symofros.mechanics.spatial.rotations import RotationProduct
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench, inertia_wrench


@dataclass(frozen=True)
class SecondOrderEquations(BeamForms):
    """A beam whose displacements are kept to second order."""

    # Kinematics.

    def across(self, xi: float, speeds: Sequence[Edge], deflected: bool) -> AcrossJoint:
        """The motion of a section in B; of zeroth order about its undeformed place unless `deflected`."""
        g, point = self.g, self.point(xi)
        if not deflected and self.order <= 0:
            angles, zero = self.angles(xi), Vec3(g)
            partials = tuple(_constant_partial(g, point, angles, i, zero) for i in range(len(self.coordinates)))
            return AcrossJoint(RotationProduct(g, ()), _values(g, point, 0), partials)
        return across_rotations(g, self.coordinates, speeds, _values(g, point), _turns(self, xi))

    def section(self, xi: float) -> tuple[Vec3, Mat3]:
        """p_BS and R_BS of the section at a station."""
        g, point = self.g, self.point(xi)
        if self.order == 0:
            return _values(g, point, 0), Mat3.identity(g)
        p_BS = _values(g, point)
        return p_BS, RotationProduct(g, tuple(turn.factor for turn in _turns(self, xi))).matrix()

    # Inertia.

    def undeformed(self) -> LinkInertia:
        """The inertia of the straight beam."""
        return self._inertia(lambda form: form.terms.get((), ZERO), self.mass)

    def deformed(self) -> LinkInertia:
        """Change of the inertia by deformation, to the beam's order."""
        return self._inertia(lambda form: form.without_constant().value(self.order), ZERO)

    def _inertia(self, value: Callable[[Form], Edge], m: Edge) -> LinkInertia:
        """Moments about the root, from B to the link frame."""
        g, R = self.g, self.R_LB
        S = R.times(Vec3(g, *map(value, self.first_moment)))
        xx, yy, zz, xy, xz, yz = map(value, self.second_moment)
        J = Sym3(g, g.add(yy, zz), g.add(xx, zz), g.add(xx, yy), -xy, -xz, -yz)
        return LinkInertia(m, S, rotated(R, J))

    def first_moment_change(self) -> Vec3:
        """Change of the first moment by deformation, one order further."""
        S = Vec3(self.g, *(form.without_constant().value(self.order + 1) for form in self.first_moment))
        return self.R_LB.times(S)

    def modal_mass(self, i: int, j: int) -> Edge:
        """M_ij of two elastic coordinates (eq. 11)."""
        return _form_mass(self, i, j)

    def momentum(self, i: int) -> tuple[Vec3, Vec3]:
        """Linear momentum and angular momentum about the root per unit rate of coordinate i."""
        linear = Vec3(self.g, *(form.gradient[i].value(self.order) for form in self.first_moment))
        return self.R_LB.times(linear), self.R_LB.times(_vector(self.g, self.angular[i], self.order))

    def inertia_forces(
        self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]
    ) -> tuple[Wrench, list[Edge]]:
        """Inertia forces that deformation adds to those of the undeformed beam (eqs. 15-17)."""
        w, alpha, a = self.root_motion(motion)
        wrench = self._deformation_wrench(motion, speeds, rates)
        return wrench, [_modal_force(self, i, w, alpha, a, speeds, rates) for i in range(len(speeds))]

    def _deformation_wrench(self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]) -> Wrench:
        """Wrench on the root that deformation adds to the inertia of the undeformed beam (eqs. 15, 16)."""
        R_LB = self.R_LB
        relative = _relative_wrench(self, R_LB.T.times(motion.w_WL_L), speeds, rates)
        straight = inertia_wrench(self.deformed(), motion)
        return straight + Wrench(R_LB.times(relative.f), R_LB.times(relative.n))

    def inertia_beyond(self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]) -> Iterator[Wrench]:
        """Wrench about the root, in B, that the inertia beyond each of the beam's stations takes."""
        R_BL = self.R_LB.T
        for xi in self.beam.stations:
            part = self.beyond(xi)
            whole = inertia_wrench(part.undeformed(), motion)
            whole = whole + part._deformation_wrench(motion, speeds, rates)
            yield Wrench(R_BL.times(whole.f), R_BL.times(whole.n))

    def kinetic_energy_twice(self, w: Vec3, v: Vec3, speeds: Sequence[Edge]) -> Edge:
        """Twice what deformation adds to the kinetic energy (eq. 12)."""
        g = self.g
        change = self.deformed()
        crossed = w.cross(change.mp_LLcm)
        total = g.add(v.dot(crossed + crossed), w.dot(change.I_LLo_L.times(w)))
        for i, speed in enumerate(speeds):
            p, n = self.momentum(i)
            coupling = g.add(p.dot(v), n.dot(w))
            own = g.sum(g.mul(self.modal_mass(i, j), other) for j, other in enumerate(speeds))
            total = g.add(total, g.mul(speed, g.add(g.add(coupling, coupling), own)))
        return total

    # Forces.

    def load(self, load: BeamLoad, k: int, d: Vec3) -> tuple[Wrench, list[Edge]]:
        """Component k of a load: the wrench about the root in B, and the force on each coordinate (eqs. 18, 19)."""
        return loads.along(self, load.at, d, load.force[k], load.torque[k])

    def load_beyond(self, load: BeamLoad, k: int, d: Vec3, xi: float) -> Iterator[Wrench]:
        """The wrench about the root, in B, of component k of a load beyond a station."""
        part = self if load.at is not None else self.beyond(xi)
        yield loads.wrench_along(part, load.at, d, load.force[k], load.torque[k])


def _turns(forms: BeamForms, xi: float) -> list[JointRotation]:
    """Yaw, pitch and roll of the section at a station, those that are not zero."""
    g = forms.along.g
    return [
        rotation_about(Vec3.unit(g, k), angle, k, False)
        for k, angle in zip((2, 1, 0), (form.value() for form in forms.angles(xi)), strict=True)
        if angle != ZERO
    ]


def _values(g: Graph, forms: Vector, upto: float = float("inf")) -> Vec3:
    return Vec3(g, *(form.value(upto) for form in forms))


def _constant_partial(g: Graph, point: Vector, angles: Vector, i: int, zero: Vec3) -> PartialVelocity:
    v = Vec3(g, *(form.gradient[i].value(0) for form in point))
    yaw, pitch, roll = (form.gradient[i].value(0) for form in angles)
    return PartialVelocity(Vec3(g, roll, pitch, yaw), v, zero, zero)


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
    return forms.modal_masses[min(i, j), max(i, j)].value(forms.order)


def _convective(forms: BeamForms, i: int, speeds: Sequence[Edge]) -> Edge:
    """The sum over j, k of (d_k M_ij - 1/2 d_i M_jk) v_j v_k."""
    g, order, M = forms.along.g, forms.order, forms.modal_masses
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


def _vector(g: Graph, forms: Vector, upto: float) -> Vec3:
    return Vec3(g, *(form.value(upto) for form in forms))


def _slopes(forms: Vector, i: int) -> Vector:
    x, y, z = (form.gradient[i] for form in forms)
    return x, y, z


def _moment_rate(g: Graph, E_rate: Sequence[Edge]) -> Mat3:
    """J' = tr(E') 1 - E'."""
    xx, yy, zz, xy, xz, yz = E_rate
    return Mat3(g, (g.add(yy, zz), -xy, -xz, -xy, g.add(xx, zz), -yz, -xz, -yz, g.add(xx, yy)))
