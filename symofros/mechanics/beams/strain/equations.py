"""A geometrically exact beam in the equations of motion: sums over its sections (docs/theory/rods.md, 3 and 4).

Positions are sums of tangents with weights that are numbers, so that every integral over the mass is a quadratic form
of the tangents: it is taken over points with the same second moments.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from symofros.description.beams.beam import BeamLoad
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.beams.strain import loads
from symofros.mechanics.beams.strain.sections import BeamSections, InertiaAxis
from symofros.mechanics.beams.strain.strains import TURNING
from symofros.mechanics.spatial.across import AcrossJoint, with_rates
from symofros.mechanics.spatial.inertia import PAIRS, LinkInertia, rotated
from symofros.mechanics.spatial.rotations import AxisRotation, MatrixRotation, RotationProduct
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench


@dataclass(frozen=True, eq=False)
class StrainEquations(BeamSections):
    """A beam whose strains are sums of functions; nothing of it but its mass, put at the root, is constant."""

    # Kinematics.

    def across(self, xi: float, speeds: Sequence[Edge], deflected: bool) -> AcrossJoint:
        """The motion of a section in the root frame B (section 3)."""
        g, section = self.g, self.section_at(xi)
        R_BS = section.R_BS
        if self.axis is None:
            factor: AxisRotation | MatrixRotation = MatrixRotation(R_BS)
        else:
            i, j = (self.axis + 1) % 3, (self.axis + 2) % 3
            factor = AxisRotation(self.axis, R_BS.at(i, i), R_BS.at(j, i))
        R = RotationProduct(g, (factor,))
        partials = tuple(
            with_rates(
                g, self.coordinates, speeds, R.apply_inverse(spin), R.apply_inverse(self.partial_position(xi, i))
            )
            for i, spin in enumerate(section.spins)
        )
        return AcrossJoint(R, self.position(xi), partials)

    def section(self, xi: float) -> tuple[Vec3, Mat3]:
        """p_BS and R_BS of the section at a station."""
        return self.position(xi), self.section_at(xi).R_BS

    # Inertia.

    def undeformed(self) -> LinkInertia:
        """The mass, at the root."""
        return LinkInertia(self.mass, Vec3(self.g), Sym3(self.g))

    def deformed(self) -> LinkInertia:
        """All but the mass."""
        S, J = self.moments()
        return LinkInertia(ZERO, self.R_LB.times(S), rotated(self.R_LB, J))

    def first_moment_change(self) -> Vec3:
        """The first moment."""
        return self.R_LB.times(self.first_moment(self.mass_vectors))

    def momentum(self, i: int) -> tuple[Vec3, Vec3]:
        """Linear momentum and angular momentum about the root per unit rate of a coordinate (13), (14)."""
        p, n = self.root_momentum(i)
        return self.R_LB.times(p), self.R_LB.times(n)

    def inertia_forces(
        self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]
    ) -> tuple[Wrench, list[Edge]]:
        """Inertia forces but for that of the mass at the root (15), (16)."""
        f, n, forces = self.root_forces(*self.root_motion(motion), speeds, rates)
        return Wrench(self.R_LB.times(f), self.R_LB.times(n)), forces

    def kinetic_energy_twice(self, w: Vec3, v: Vec3, speeds: Sequence[Edge]) -> Edge:
        """Twice the kinetic energy but for that of the mass at the root (17)."""
        return self._energy_twice(self.R_LB.T.times(w), self.R_LB.T.times(v), speeds)

    def moments(self) -> tuple[Vec3, Sym3]:
        """First moment and inertia tensor about the root, in B (13), (14)."""
        g, points = self.g, self.point_positions
        E = [g.sum(g.mul(tuple(y)[a], tuple(y)[b]) for y in points) for a, b in PAIRS]
        J = Sym3(g, g.add(E[1], E[2]), g.add(E[0], E[2]), g.add(E[0], E[1]), -E[3], -E[4], -E[5])
        for axis in self.inertia_axes:
            c = axis.direction
            J = J + Sym3(g, *(g.mul(axis.inertia, g.mul(tuple(c)[a], tuple(c)[b])) for a, b in PAIRS))
        return self.first_moment(self.mass_vectors), J

    def modal_mass(self, i: int, j: int) -> Edge:
        """M_ij of two strain coordinates (13), (14)."""
        g = self.g
        total = g.sum(a.dot(b) for a, b in zip(self.point_partials[i], self.point_partials[j], strict=True))
        for axis in self.inertia_axes:
            spins = self.sections[axis.section].spins
            momentum = g.mul(axis.inertia, axis.direction.dot(spins[i]))  # One for all j.
            total = g.add(total, g.mul(momentum, axis.direction.dot(spins[j])))
        return total

    def root_momentum(self, i: int) -> tuple[Vec3, Vec3]:
        """Linear momentum and angular momentum about the root, in B, per unit rate of a coordinate (13), (14)."""
        g, angular = self.g, Vec3(self.g)
        for y, d in zip(self.point_positions, self.point_partials[i], strict=True):
            angular = angular + y.cross(d)
        for axis in self.inertia_axes:
            spin = axis.direction.dot(self.sections[axis.section].spins[i])
            angular = angular + axis.direction.scaled(g.mul(axis.inertia, spin))
        return self.first_moment(self.partial_mass_vectors[i]), angular

    def root_forces(
        self, w: Vec3, alpha: Vec3, a: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]
    ) -> tuple[Vec3, Vec3, list[Edge]]:
        """Inertia forces of a rod but for that of its mass at the root (15), (16).

        Args:
            w: Angular velocity of the root, in B.
            alpha: Angular acceleration of the root, in B.
            a: Acceleration of the root with gravity as one of the base, in B.
            speeds: Rates of the strain coordinates.
            rates: Second derivatives of the strain coordinates.

        Returns:
            Force and moment on the root, in B, and the force on each coordinate.
        """
        motion = self._section_motion(w, alpha, speeds, rates)
        curves = motion.curves
        points = [self.weighted(row, curves) for row in self.mass_points]
        # Force per unit change of each mass vector, f_k of (16).
        arms = [self.weighted(column, points) for column in zip(*self.mass_points, strict=True)]
        arms = [arm + a.scaled(weight) for arm, weight in zip(arms, self.first_moment_weights, strict=True)]
        count = len(self.sections)
        torques = [t.cross(arm) for t, arm in zip(self.tangents, arms[:count], strict=True)]
        for k, (vector, arm) in enumerate(zip(self.mass_vectors[count:], arms[count:], strict=True)):
            torques[k] = torques[k] + vector.cross(arm)
        for axis in self.inertia_axes:
            torques[axis.section] = torques[axis.section] + _torque(axis, motion)
        moment = Vec3(self.g)
        for torque in torques:
            moment = moment + torque
        return self.first_moment(curves), moment, [self._power(i, arms, torques) for i in range(len(self.coordinates))]

    def _section_motion(self, w: Vec3, alpha: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]) -> _SectionMotion:
        motion = _SectionMotion([], [], [])
        turning, slips, slip_rates = self.angular_rates(w, alpha, speeds), self.shifted(speeds), self.shifted(rates)
        for section, t, (total, total_rate), slip, slip_rate in zip(
            self.sections, self.tangents, turning, slips, slip_rates, strict=True
        ):
            for spin, rate in zip(section.spins, rates, strict=True):
                total_rate = total_rate + spin.scaled(rate)
            motion.spins.append(total)
            motion.accelerations.append(total_rate)
            motion.curves.append(total_rate.cross(t) + total.cross(total.cross(t) + (slip + slip)) + slip_rate)
        arms = self.mass_vectors[len(self.sections) :]
        for arm, total, total_rate in zip(arms, motion.spins, motion.accelerations, strict=False):
            motion.curves.append(total_rate.cross(arm) + total.cross(total.cross(arm)))
        return motion

    def _power(self, i: int, arms: Sequence[Vec3], torques: Sequence[Vec3]) -> Edge:
        """Power per unit rate of a coordinate: of torques where it turns sections, of forces where it moves them."""
        power = [slip.dot(arm) for slip, arm in zip(self.partial_slips[i], arms, strict=False)]
        if self.strains.axes[i][0] < TURNING:
            power += [section.spins[i].dot(torque) for section, torque in zip(self.sections, torques, strict=True)]
        return self.g.sum(power)

    def _energy_twice(self, w: Vec3, v: Vec3, speeds: Sequence[Edge]) -> Edge:
        """Twice the kinetic energy but for that of the mass at the root (17).

        Args:
            w: Angular velocity of the root, in B.
            v: Velocity of the root, in B.
            speeds: Rates of the strain coordinates.
        """
        g = self.g
        spins = [w + self.spin(section, speeds) for section in self.sections]
        moved = [spin.cross(t) + slip for spin, t, slip in zip(spins, self.tangents, self.shifted(speeds), strict=True)]
        count = len(spins)
        moved += [spin.cross(vector) for spin, vector in zip(spins, self.mass_vectors[count:], strict=False)]
        points = [self.weighted(row, moved) for row in self.mass_points]
        linear = self.first_moment(moved).dot(v)
        total = g.add(g.add(linear, linear), g.sum(p.dot(p) for p in points))
        for axis in self.inertia_axes:
            spin = axis.direction.dot(spins[axis.section])
            total = g.add(total, g.mul(axis.inertia, g.mul(spin, spin)))
        return total

    def inertia_beyond(self, motion: LinkMotion, speeds: Sequence[Edge], rates: Sequence[Edge]) -> Iterator[Wrench]:
        """Wrench about the root, in B, that the inertia beyond each of the beam's stations takes (20)."""
        w, alpha, a = self.root_motion(motion)
        sections = self._section_motion(w, alpha, speeds, rates)
        positions, relative = self.mass_positions(self.mass_vectors), self.mass_positions(sections.curves)
        for xi in self.beam.stations:
            weights = self.strains.masses.beyond(xi)
            f, n = Vec3(self.g), Vec3(self.g)
            for p, acceleration, share in zip(positions, relative, self.masses(weights), strict=True):
                force = (a + acceleration).scaled(share)
                f, n = f + force, n + p.cross(force)
            for axis in self.inertia_axes_of(self.strains.sections.beyond(xi)):
                n = n + _torque(axis, sections)
            yield Wrench(f, n)

    # Forces.

    def load(self, load: BeamLoad, k: int, d: Vec3) -> tuple[Wrench, list[Edge]]:
        """Component k of a load: the wrench about the root in B, and the force on each coordinate (18)."""
        return loads.on_sections(self, load, k, d)

    def load_beyond(self, load: BeamLoad, k: int, d: Vec3, xi: float) -> Iterator[Wrench]:
        """Wrenches about the root, in B, that component k of a load adds up to beyond a station."""
        return loads.beyond(self, load, k, d, xi)


class _SectionMotion(NamedTuple):
    """Angular velocity and acceleration of each section in the world; second derivative of each mass vector, in B."""

    spins: list[Vec3]
    accelerations: list[Vec3]
    curves: list[Vec3]


def _torque(axis: InertiaAxis, motion: _SectionMotion) -> Vec3:
    """Moment that the motion of a section takes about one of its axes."""
    g, k, c = axis.direction.g, axis.section, axis.direction
    # Without stretch c is the tangent of its section, and O x c is known.
    turned = motion.spins[k].cross(c).scaled(g.mul(axis.inertia, c.dot(motion.spins[k])))
    return c.scaled(g.mul(axis.inertia, c.dot(motion.accelerations[k]))) + turned
