"""Energies of one geometrically exact rod for the Lagrangian engine: sections of docs/theory/rods.md, section 3.

Rotations from section to section and positions as sums of tangents are stated as there; velocities, spins and forces
are derivatives of them by CasADi. Tables are quadratures by NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ...mechanics.geometry import Array
from .beam import Line, Section, at_stations, rotation_about, stations

SX = Any  # CasADi has no types.

# Gauss nodes of an interval's moments and energies: exact for strains of degree 15.
NODES = 16
# Sections an interval that the description leaves to the generator, where knots divide the rod.
A_SPAN = 4


@dataclass(frozen=True)
class Strain:
    """One strain function of xi = x/L: a turn about an axis (0 to 2), stretch (3) or shear (4, 5)."""

    axis: int
    sign: float
    value: Callable[[Array], Array]


@dataclass(frozen=True)
class ExactRod:
    """A rod along x, clamped to its frame; it has `points` sections an interval between `breaks`, beside the root."""

    length: float
    rhoA: Section
    strains: tuple[Strain, ...]
    unstressed: tuple[Section, Section, Section]
    breaks: tuple[float, ...]
    points: int
    EI_z: Section = 0.0
    EI_y: Section = 0.0
    GJ: Section = 0.0
    EA: Section = 0.0
    GA_y: Section = 0.0
    GA_z: Section = 0.0
    rhoJ: Section = 0.0
    rhoI_y: Section = 0.0
    rhoI_z: Section = 0.0
    EI_yz: Section = 0.0
    rhoI_yz: Section = 0.0
    tension_center: tuple[Section, Section] = (0.0, 0.0)
    shear_center: tuple[Section, Section] = (0.0, 0.0)
    mass_center: tuple[Section, Section] = (0.0, 0.0)
    stiffness: tuple[tuple[Section, ...], ...] = ()  # About the axis, of stretch, shears, twist rate, curvatures.
    damping: float = 0.0
    rotary_inertia: bool = False
    sixth: bool = True  # Order of Magnus's series; else the fourth.
    loads: tuple[Line, ...] = ()

    @property
    def modes(self) -> int:
        """Number of strain coordinates of the rod."""
        return len(self.strains)

    @cached_property
    def ends(self) -> tuple[float, ...]:
        """Ends of the intervals between knots [m]."""
        return (0.0, *(b for b in sorted(self.breaks) if 0.0 < b < self.length), self.length)

    @cached_property
    def spans(self) -> list[tuple[Array, Array]]:
        """Stations of the sections of each interval, and their weights [m]: Radau's with the root, then Gauss's."""
        rules = [_radau(self.points + 1), *[np.polynomial.legendre.leggauss(self.points)] * (len(self.ends) - 2)]
        return [
            (a + (b - a) * (node + 1) / 2, (b - a) * w / 2)
            for a, b, (node, w) in zip(self.ends, self.ends[1:], rules, strict=False)
        ]

    @cached_property
    def at(self) -> Array:
        """Stations of the sections [m]."""
        return np.concatenate([x for x, _ in self.spans])

    @cached_property
    def weights(self) -> Array:
        """Their weights [m]."""
        return np.concatenate([w for _, w in self.spans])

    @cached_property
    def axes(self) -> set[int]:
        """Axes that anything turns about."""
        stressless = {k for k, value in enumerate(self.unstressed) if callable(value) or value != 0.0}
        return stressless | {strain.axis for strain in self.strains if strain.axis < 3}

    def table(self, x: Array) -> Array:
        """Strains of unit coordinates at stations (K, 6, n): turns a length [1/m], stretch and shears."""
        values = np.zeros((len(x), 6, self.modes))
        for i, strain in enumerate(self.strains):
            scale = strain.sign / (self.length if strain.axis < 3 else 1.0)
            values[:, strain.axis, i] = scale * strain.value(x / self.length)
        return values

    def strained(self, x: Array) -> Array:
        """Strains of unit coordinates (K, 6, n), those that no function has among them where they take least energy."""
        table = self.table(x)
        counted = sorted({strain.axis for strain in self.strains})
        free = [k for k in range(3, 6) if k not in counted]
        for K, values in zip(self.section_stiffness(x), table, strict=True):
            values[free] = -np.linalg.solve(K[np.ix_(free, free)], K[np.ix_(free, counted)] @ values[counted])
        return table

    def section_stiffness(self, x: Array) -> Array:
        """Stiffness about the axis at stations (K, 6, 6): of twist rate, curvatures, stretch and shears.

        Stretch and shear that have no stiffness, since no function is of them, get one: any will do.
        """
        if self.stiffness:
            rows = [[at_stations(value, x) for value in row] for row in self.stiffness]
            return np.roll(np.array(rows).transpose(2, 0, 1), (3, 3), (1, 2))
        stated = (self.GJ, self.EI_y, self.EI_z, self.EA or 1.0, self.GA_y or 1.0, self.GA_z or 1.0)
        about_centers = np.zeros((len(x), 6, 6))
        about_centers[:, range(6), range(6)] = np.stack([at_stations(value, x) for value in stated], axis=1)
        about_centers[:, 1, 2] = about_centers[:, 2, 1] = -at_stations(self.EI_yz, x)
        # Fibres through a centre stretch, and sections shear there, by turning about the axis: strain + k x (0, y, z).
        at_centers = np.tile(np.eye(6), (len(x), 1, 1))
        for center, moved in ((self.tension_center, (3,)), (self.shear_center, (4, 5))):
            y, z = (at_stations(value, x) for value in center)
            arms = _arms(y, z)
            for row in moved:
                at_centers[:, row, :3] = arms[:, row - 3]
        return at_centers.swapaxes(1, 2) @ about_centers @ at_centers

    def moments(self, a: float, b: float, q: SX) -> tuple[SX, SX, SX]:
        """Integral of the strains over an interval, and their first and second moments about its middle (5)."""
        node, w = np.polynomial.legendre.leggauss(NODES)
        # Pieces between knots: the moment of a spline is not that of one polynomial.
        inner = [a, *(end for end in self.ends if a < end < b), b]
        zeroth, first, second = ca.SX.zeros(3), ca.SX.zeros(3), ca.SX.zeros(3)
        for left, right in zip(inner, inner[1:], strict=False):
            x, weight = left + (right - left) * (node + 1) / 2, (right - left) * w / 2
            stressless = np.stack([at_stations(value, x) for value in self.unstressed], axis=1)
            for k, share in enumerate(weight):
                strain = ca.SX(stressless[k]) + ca.SX(self.table(x[k : k + 1])[0, :3]) @ q
                zeroth += share * strain
                at = (x[k] - (a + b) / 2) / (b - a)
                first += share * at * strain
                second += share * (at**2 - 1 / 12) * strain
        return zeroth, first, second


def _arms(y: Array, z: Array) -> Array:
    """Matrices of k -> k x (0, y, z) (K, 3, 3)."""
    place = np.stack([np.zeros_like(y), y, z], axis=1)
    return np.cross(np.eye(3)[None], place[:, None, :]).swapaxes(1, 2)


def _radau(count: int) -> tuple[Array, Array]:
    """Nodes and weights on [-1, 1] of the quadrature with a node at -1, exact to degree 2 count - 2."""
    node = np.polynomial.legendre.legroots([*[0.0] * (count - 1), 1.0, 1.0])
    node[0] = -1.0
    return node, np.linalg.solve(np.polynomial.legendre.legvander(node, count - 1).T, 2.0 * np.eye(count)[0])


def sections_chosen(counts: Sequence[int], family: str, divided: bool) -> int:
    """Number of sections an interval between knots, beside the root, where the description states none."""
    most = max(counts)
    if divided:
        return A_SPAN
    if family == "user":
        return max(3, most + 1)
    return max(2, most + min((most - 1) // 2, 2))


def rotation(rod: ExactRod, x: float, q: SX) -> SX:
    """R_BS at a station."""
    if x <= 0.0:
        return ca.SX.eye(3)
    if len(rod.axes) == 1:
        (axis,) = rod.axes
        total, *_ = rod.moments(0.0, x, q)
        return rotation_about(np.eye(3)[axis].tolist(), total[axis])
    before = [at for at in rod.at.tolist() if at <= x]
    R, start = ca.SX.eye(3), 0.0
    for end in [*before, x]:
        if end > start:
            R, start = R @ _turn(rod, start, end, q), end
    return R


def _turn(rod: ExactRod, start: float, end: float, q: SX) -> SX:
    """The turn of one step (6)-(8), commutators in full."""
    zeroth, first, second = rod.moments(start, end, q)
    across = ca.cross(zeroth, first)
    X = zeroth + across
    if rod.sixth:
        X += ca.cross(zeroth, ca.cross(zeroth, second)) / 2 - 6 * ca.cross(second, first)
        X += 3 / 5 * ca.cross(across, first) - ca.cross(zeroth, ca.cross(zeroth, across)) / 60
    s = ca.dot(X, X) / 4
    a = (105 - 10 * s) / (210 - 90 * s + 2 * s**2) * X
    K = ca.skew(a)
    return ca.SX.eye(3) + 2 / (1 + ca.dot(a, a)) * (K + K @ K)


def rotations(rod: ExactRod, q: SX) -> list[SX]:
    """R_BS of all sections."""
    if len(rod.axes) == 1:
        return [rotation(rod, x, q) for x in rod.at.tolist()]
    turned, R, start = [], ca.SX.eye(3), 0.0
    for end in rod.at.tolist():
        if end > start:
            R, start = R @ _turn(rod, start, end, q), end
        turned.append(R)
    return turned


def _weights(rod: ExactRod, x: float) -> Array:
    """Weights of the sections' tangents in the position at a station (10) [m]."""
    node, w = np.polynomial.legendre.leggauss(rod.points)
    weights = []
    for a, b, (own, _) in zip(rod.ends, rod.ends[1:], rod.spans, strict=False):
        upto = min(max(x, a), b)
        inner = a + (upto - a) * (node + 1) / 2
        for k in range(len(own)):
            others = np.delete(own, k)
            lagrange = np.prod((inner[:, None] - others) / (own[k] - others), axis=1)
            weights.append((upto - a) / 2 * w @ lagrange)
    return np.array(weights)


def _through(rod: ExactRod, x: float) -> Array:
    """Weights of the sections in the value at a station between knots, by the polynomial through its interval's."""
    weights = []
    for a, b, (own, _) in zip(rod.ends, rod.ends[1:], rod.spans, strict=False):
        for k in range(len(own)):
            others = np.delete(own, k)
            weights.append(np.prod((x - others) / (own[k] - others)) if a < x < b else 0.0)
    return np.array(weights)


def mass_centers(rod: ExactRod, x: Array, q: SX) -> SX:
    """Places of the mass at stations, in B (3, n): off the axis, by a polynomial through the sections."""
    y, z = (at_stations(value, rod.at) for value in rod.mass_center)
    arms = (R @ ca.SX([0.0, y[k], z[k]]) for k, R in enumerate(rotations(rod, q)))
    weights = ca.SX(np.stack([_through(rod, at) for at in x.tolist()], axis=1))
    return centroids(rod, x, q) + ca.horzcat(*arms) @ weights


def centroids(rod: ExactRod, x: Array, q: SX) -> SX:
    """Places of the axis at stations, in B (3, n)."""
    shifts = ca.SX(rod.strained(rod.at)[:, 3:].reshape(-1, rod.modes)) @ q
    moved = (ca.SX([1, 0, 0]) + shifts[3 * k : 3 * k + 3] for k in range(len(rod.at)))
    tangents = ca.horzcat(*(R @ t for R, t in zip(rotations(rod, q), moved, strict=True)))
    return tangents @ ca.SX(np.stack([_weights(rod, at) for at in x.tolist()], axis=1))


def section(rod: ExactRod, x: float, q: SX) -> tuple[SX, SX]:
    """Place and rotation of one section in B."""
    return centroids(rod, np.array([x]), q), rotation(rod, x, q)


def strain_energy(rod: ExactRod, q: SX) -> SX:
    """1/2 the integral of the products of the changes of strain and the stiffness against them."""
    x, weight = stations(rod.length, rod.breaks, NODES)
    strained = rod.strained(x)
    K = np.einsum("k,kab,kai,kbj->ij", weight, rod.section_stiffness(x), strained, strained)
    return 0.5 * ca.dot(q, ca.SX(K) @ q)


def dissipation(rod: ExactRod, rates: SX) -> SX:
    """Rayleigh's function: the strain energy of the rates, times the retardation time."""
    return rod.damping * strain_energy(rod, rates)


def turning_energy(rod: ExactRod, q: SX, rate: Callable[[SX], SX], w_B: SX) -> SX:
    """Kinetic energy of sections that turn: about their own x axis, or about all three of their own axes.

    Args:
        rod: The rod.
        q: Its coordinates.
        rate: The rate of an expression of them.
        w_B: Angular velocity of its frame, along its axes.
    """
    stated = (rod.rhoJ, rod.rhoI_y, rod.rhoI_z, rod.rhoI_yz) if rod.rotary_inertia else (rod.rhoJ, 0.0, 0.0, 0.0)
    inertias = np.stack([at_stations(value, rod.at) * rod.weights for value in stated], axis=1)
    total = ca.SX(0)
    for (I_x, I_y, I_z, I_yz), R in zip(inertias, rotations(rod, q), strict=True):
        spin = ca.inv_skew(R.T @ rate(R)) + R.T @ w_B
        inertia = ca.SX(np.array([[I_x, 0.0, 0.0], [0.0, I_y, -I_yz], [0.0, -I_yz, I_z]]))
        total += 0.5 * ca.dot(spin, inertia @ spin)
    return total
