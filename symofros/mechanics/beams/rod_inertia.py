"""Inertia of a geometrically exact rod: sums over its sections (docs/theory/rods.md, section 4).

Positions are sums of tangents with weights that are numbers, so that every integral over the mass is a quadratic form
of the tangents: it is taken over points with the same second moments.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from symofros.expr.edges import Edge
from symofros.expr.vector import Sym3, Vec3
from symofros.mechanics.beams.elastic import PAIRS
from symofros.mechanics.beams.rod import InertiaAxis, Rod
from symofros.mechanics.beams.rod_plane import PlaneRod
from symofros.mechanics.beams.strains import TURNING


def rod_moments(rod: Rod) -> tuple[Vec3, Sym3]:
    """First moment and inertia tensor about the root, in B (13), (14)."""
    if isinstance(rod, PlaneRod):
        return rod.first_moment_about_root(), rod.inertia()
    g, points = rod.g, rod.point_positions
    E = [g.sum(g.mul(tuple(y)[a], tuple(y)[b]) for y in points) for a, b in PAIRS]
    J = Sym3(g, g.add(E[1], E[2]), g.add(E[0], E[2]), g.add(E[0], E[1]), -E[3], -E[4], -E[5])
    for axis in rod.inertia_axes:
        c = axis.direction
        J = J + Sym3(g, *(g.mul(axis.inertia, g.mul(tuple(c)[a], tuple(c)[b])) for a, b in PAIRS))
    return rod.first_moment(rod.mass_vectors), J


def rod_modal_mass(rod: Rod, i: int, j: int) -> Edge:
    """M_ij of two strain coordinates (13), (14)."""
    if isinstance(rod, PlaneRod):
        return rod.modal_masses[min(i, j), max(i, j)]
    g = rod.g
    total = g.sum(a.dot(b) for a, b in zip(rod.point_partials[i], rod.point_partials[j], strict=True))
    for axis in rod.inertia_axes:
        spins = rod.sections[axis.section].spins
        momentum = g.mul(axis.inertia, axis.direction.dot(spins[i]))  # One for all j.
        total = g.add(total, g.mul(momentum, axis.direction.dot(spins[j])))
    return total


def rod_momentum(rod: Rod, i: int) -> tuple[Vec3, Vec3]:
    """Linear momentum and angular momentum about the root, in B, per unit rate of a coordinate (13), (14)."""
    if isinstance(rod, PlaneRod):
        return rod.momentum(i)
    g, angular = rod.g, Vec3(rod.g)
    for y, d in zip(rod.point_positions, rod.point_partials[i], strict=True):
        angular = angular + y.cross(d)
    for axis in rod.inertia_axes:
        spin = axis.direction.dot(rod.sections[axis.section].spins[i])
        angular = angular + axis.direction.scaled(g.mul(axis.inertia, spin))
    return rod.first_moment(rod.partial_mass_vectors[i]), angular


def rod_forces(
    rod: Rod, w: Vec3, alpha: Vec3, a: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]
) -> tuple[Vec3, Vec3, list[Edge]]:
    """Inertia forces of a rod but for that of its mass at the root (15), (16).

    Args:
        rod: The rod.
        w: Angular velocity of the root, in B.
        alpha: Angular acceleration of the root, in B.
        a: Acceleration of the root with gravity as one of the base, in B.
        speeds: Rates of the strain coordinates.
        rates: Second derivatives of the strain coordinates.

    Returns:
        Force and moment on the root, in B, and the force on each coordinate.
    """
    if isinstance(rod, PlaneRod):
        return rod.forces(w, alpha, a, speeds, rates)
    motion = _section_motion(rod, w, alpha, speeds, rates)
    curves = motion.curves
    points = [rod.weighted(row, curves) for row in rod.mass_points]
    # Force per unit change of each mass vector, f_k of (16).
    arms = [rod.weighted(column, points) for column in zip(*rod.mass_points, strict=True)]
    arms = [arm + a.scaled(weight) for arm, weight in zip(arms, rod.first_moment_weights, strict=True)]
    count = len(rod.sections)
    torques = [t.cross(arm) for t, arm in zip(rod.tangents, arms[:count], strict=True)]
    for k, (vector, arm) in enumerate(zip(rod.mass_vectors[count:], arms[count:], strict=True)):
        torques[k] = torques[k] + vector.cross(arm)
    for axis in rod.inertia_axes:
        torques[axis.section] = torques[axis.section] + _torque(axis, motion)
    moment = Vec3(rod.g)
    for torque in torques:
        moment = moment + torque
    return rod.first_moment(curves), moment, [_power(rod, i, arms, torques) for i in range(len(rod.coordinates))]


class _SectionMotion(NamedTuple):
    """Angular velocity and acceleration of each section in the world; second derivative of each mass vector, in B."""

    spins: list[Vec3]
    accelerations: list[Vec3]
    curves: list[Vec3]


def _section_motion(rod: Rod, w: Vec3, alpha: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]) -> _SectionMotion:
    motion = _SectionMotion([], [], [])
    turning, slips, slip_rates = rod.angular_rates(w, alpha, speeds), rod.shifted(speeds), rod.shifted(rates)
    for section, t, (total, total_rate), slip, slip_rate in zip(
        rod.sections, rod.tangents, turning, slips, slip_rates, strict=True
    ):
        for spin, rate in zip(section.spins, rates, strict=True):
            total_rate = total_rate + spin.scaled(rate)
        motion.spins.append(total)
        motion.accelerations.append(total_rate)
        motion.curves.append(total_rate.cross(t) + total.cross(total.cross(t) + (slip + slip)) + slip_rate)
    arms = rod.mass_vectors[len(rod.sections) :]
    for arm, total, total_rate in zip(arms, motion.spins, motion.accelerations, strict=False):
        motion.curves.append(total_rate.cross(arm) + total.cross(total.cross(arm)))
    return motion


def _torque(axis: InertiaAxis, motion: _SectionMotion) -> Vec3:
    """Moment that the motion of a section takes about one of its axes."""
    g, k, c = axis.direction.g, axis.section, axis.direction
    # Without stretch c is the tangent of its section, and O x c is known.
    turned = motion.spins[k].cross(c).scaled(g.mul(axis.inertia, c.dot(motion.spins[k])))
    return c.scaled(g.mul(axis.inertia, c.dot(motion.accelerations[k]))) + turned


def wrenches_beyond(
    rod: Rod,
    stations: Sequence[float],
    w: Vec3,
    alpha: Vec3,
    a: Vec3,
    speeds: Sequence[Edge],
    rates: Sequence[Edge],
) -> Iterator[tuple[Vec3, Vec3]]:
    """Inertia force, and moment about the root, of the part of a rod beyond each station, in B (20).

    Args:
        rod: The rod.
        stations: Stations x/L.
        w: Angular velocity of the root, in B.
        alpha: Angular acceleration of the root, in B.
        a: Acceleration of the root with gravity as one of the base, in B.
        speeds: Rates of the strain coordinates.
        rates: Second derivatives of the strain coordinates.
    """
    motion = _section_motion(rod, w, alpha, speeds, rates)
    positions, relative = rod.mass_positions(rod.mass_vectors), rod.mass_positions(motion.curves)
    for xi in stations:
        weights = rod.strains.masses.beyond(xi)
        f, n = Vec3(rod.g), Vec3(rod.g)
        for p, acceleration, share in zip(positions, relative, rod.masses(weights), strict=True):
            force = (a + acceleration).scaled(share)
            f, n = f + force, n + p.cross(force)
        for axis in rod.inertia_axes_of(rod.strains.sections.beyond(xi)):
            n = n + _torque(axis, motion)
        yield f, n


def _power(rod: Rod, i: int, arms: Sequence[Vec3], torques: Sequence[Vec3]) -> Edge:
    """Power per unit rate of a coordinate: of torques where it turns sections, of forces where it moves them."""
    power = [slip.dot(arm) for slip, arm in zip(rod.partial_slips[i], arms, strict=False)]
    if rod.strains.axes[i][0] < TURNING:
        power += [section.spins[i].dot(torque) for section, torque in zip(rod.sections, torques, strict=True)]
    return rod.g.sum(power)


def rod_energy_twice(rod: Rod, w: Vec3, v: Vec3, speeds: Sequence[Edge]) -> Edge:
    """Twice the kinetic energy but for that of the mass at the root (17).

    Args:
        rod: The rod.
        w: Angular velocity of the root, in B.
        v: Velocity of the root, in B.
        speeds: Rates of the strain coordinates.
    """
    g = rod.g
    spins = [w + rod.spin(section, speeds) for section in rod.sections]
    moved = [spin.cross(t) + slip for spin, t, slip in zip(spins, rod.tangents, rod.shifted(speeds), strict=True)]
    count = len(spins)
    moved += [spin.cross(vector) for spin, vector in zip(spins, rod.mass_vectors[count:], strict=False)]
    points = [rod.weighted(row, moved) for row in rod.mass_points]
    linear = rod.first_moment(moved).dot(v)
    total = g.add(g.add(linear, linear), g.sum(p.dot(p) for p in points))
    for axis in rod.inertia_axes:
        spin = axis.direction.dot(spins[axis.section])
        total = g.add(total, g.mul(axis.inertia, g.mul(spin, spin)))
    return total
