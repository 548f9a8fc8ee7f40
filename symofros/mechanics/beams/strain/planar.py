"""Inertia of a rod that bends in one plane: two components a vector (docs/theory/rods.md, section 4, 16a to 16f).

The plane has the axes i = x and j, and e = i x j is the axis of all turns: y or z.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import chain, combinations, combinations_with_replacement
from typing import NamedTuple

from symofros.description.beams.beam import Beam
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.beams.fields import EVERY_DEGREE
from symofros.mechanics.beams.integrals import LengthIntegrator, Lower
from symofros.mechanics.beams.strain.equations import StrainEquations
from symofros.mechanics.beams.strain.strains import strains_of

# Terms of a sum in packs at most: their check descends term by term.
_LONGEST_IN_PACKS = 64


class _Plane(NamedTuple):
    """Components of a vector along i, j and e."""

    i: Edge
    j: Edge
    e: Edge


class _Products(NamedTuple):
    """Products of the components of a tangent t and of its z, named by these: ij is t_i z_j."""

    ii: Edge
    ij: Edge
    ji: Edge
    jj: Edge


class _RootMotion(NamedTuple):
    """Motion of the root: w, alpha, and entries of U = [w][w] + [alpha] (16e), ij without alpha_e."""

    w: _Plane
    alpha: _Plane
    ii: Edge
    jj: Edge
    ij: Edge
    ei: Edge
    ej: Edge


class PlanarStrainEquations(StrainEquations):
    """A rod whose tangents turn in one plane, and that neither stretches nor shears."""

    def _split(self, vector: Vec3) -> _Plane:
        x, y, z = vector
        return _Plane(x, y, z) if self.axis == 2 else _Plane(x, -z, y)

    def _joined(self, i: Edge, j: Edge, e: Edge) -> Vec3:
        return Vec3(self.g, i, j, e) if self.axis == 2 else Vec3(self.g, i, e, -j)

    @cached_property
    def _tangents(self) -> list[_Plane]:
        return [self._split(t) for t in self.tangents]

    @cached_property
    def _turns(self) -> tuple[tuple[float, ...], ...]:
        """Angle by which a unit of each coordinate turns each section: a row a section."""
        return self.strains.turns(self.strains.sections.stations)

    @cached_property
    def _columns(self) -> list[list[Edge]]:
        """The same of the sections beside the root, a row a coordinate."""
        return [list(map(self.g.constant, column)) for column in zip(*self._turns[1:], strict=True)]

    def _by_turns(self, i: int, values: Sequence[Edge]) -> Edge:
        """The sum of one value a section times the angles by which a unit of coordinate i turns them."""
        g = self.g
        return g.sum(g.mul(g.constant(row[i]), value) for row, value in zip(self._turns, values, strict=True))

    # Weights: numbers, or functions of parameters alone.

    @cached_property
    def _rotary(self) -> tuple[list[Edge], list[Edge], list[Edge]]:
        """Coefficients of (O x t)^2, O^2 and O_e^2 in twice the energy of each section's rotary inertia (16a)."""
        beam, g = self.beam, self.g
        others = (beam.rhoI_y, beam.rhoI_z) if self.axis == 2 else (beam.rhoI_z, beam.rhoI_y)
        nodes = self.strains.sections
        polar, across, about = (
            self.shares(value, nodes.stations, nodes.weights)
            for value in (beam.rhoJ, *(others if beam.rotary_inertia else (0.0, 0.0)))
        )
        of_tangents = [g.sub(a, p) for a, p in zip(across, polar, strict=True)]
        return of_tangents, list(polar), [g.sub(b, a) for a, b in zip(across, about, strict=True)]

    @cached_property
    def _about_axis(self) -> list[Edge]:
        """Moment of inertia of each section about e that is the same at all turns (16a)."""
        _, spheres, axial = self._rotary
        return [self.g.add(a, b) for a, b in zip(spheres, axial, strict=True)]

    @cached_property
    def _second_moments(self) -> list[list[Edge]]:
        """Second moments of the tangents (12)."""
        g, points, n = self.g, self.mass_points, len(self.sections)
        return [[g.sum(g.mul(row[k], row[m]) for row in points) for m in range(n)] for k in range(n)]

    @cached_property
    def _weights(self) -> list[list[Edge]]:
        """The same with the share of rotary inertia (16b)."""
        W = [list(row) for row in self._second_moments]
        for k, extra in enumerate(self._rotary[0]):
            W[k][k] = self.g.add(W[k][k], extra)
        return W

    # Quadratic forms of the tangents.

    def _sums(self, factors: Sequence[Edge], rows: Sequence[Sequence[Edge]]) -> list[Edge]:
        """Sums of a row's weights times the factors, one a row.

        In packs where sums are short and weights are numbers: to put parameters into lanes costs more than packs save.
        """
        g, sums = self.g, list[Edge]()
        if len(factors) > _LONGEST_IN_PACKS or not all(map(g.is_constant, chain(*rows))):
            return [g.sum(g.mul(factor, x) for factor, x in zip(factors, row, strict=True)) for row in rows]
        for at in range(0, len(rows), WIDTH):
            part = rows[at : at + WIDTH]
            columns = (Pack((*column, *[ZERO] * (WIDTH - len(part)))) for column in zip(*part, strict=True))
            terms = [(factor, (ONE, column)) for factor, column in zip(factors, columns, strict=True)]
            sign, pack = linear_combination(g, terms, range(len(part)))
            sums += [g.mul(sign, lane) for lane in pack.lanes[: len(part)]]
        return sums

    @cached_property
    def _linear(self) -> tuple[list[_Plane], _Plane, list[_Plane]]:
        """Terms linear in the tangents: z, first moment, its partial derivatives."""
        g, n = self.g, len(self.coordinates)
        S = self.first_moment_weights
        partials = [[g.mul(g.constant(row[i]), x) for row, x in zip(self._turns, S, strict=True)] for i in range(n)]
        rows = [*self._weights[1:], S, *partials, self._weights[0]]  # The root last: its j is of no use.
        i, j = (self._sums([t[at] for t in self._tangents], rows) for at in (0, 1))
        sections = len(S) - 1
        z = [_Plane(x, y, ZERO) for x, y in zip(i, j, strict=True)]
        moved = [_Plane(-y, x, ZERO) for x, y in zip(i, j, strict=True)]
        return [z[-1], *z[:sections]], z[sections], moved[sections + 1 : -1]

    @property
    def _z(self) -> list[_Plane]:
        """The sum of W_kl t_l for each k (16b)."""
        return self._linear[0]

    @cached_property
    def _products(self) -> list[_Products]:
        mul = self.g.mul
        return [
            _Products(mul(t.i, z.i), mul(t.i, z.j), mul(t.j, z.i), mul(t.j, z.j))
            for t, z in zip(self._tangents, self._z, strict=True)
        ]

    @cached_property
    def _E(self) -> tuple[Edge, Edge, Edge]:
        """Second moments about the root, ii, jj and ij (16c)."""
        ii, _, ji, jj = map(self.g.sum, zip(*self._products, strict=True))  # ji is ij, and zero at the root.
        return ii, jj, ji

    def moments(self) -> tuple[Vec3, Sym3]:
        """First moment and inertia tensor about the root, in B (13), (16c)."""
        g, S = self.g, self.first_moment_about_root()
        (ii, jj, ij), (_, spheres, axial) = self._E, self._rotary
        sphere = g.sum(spheres)
        J_ii, J_jj, J_ee = g.add(sphere, jj), g.add(sphere, ii), g.add(g.add(sphere, g.sum(axial)), g.add(ii, jj))
        if self.axis == 2:
            return S, Sym3(g, J_ii, J_jj, J_ee, -ij, ZERO, ZERO)
        return S, Sym3(g, J_ii, J_ee, J_jj, ZERO, ij, ZERO)

    def modal_mass(self, i: int, j: int) -> Edge:
        """M_ij of two strain coordinates (16d)."""
        return self.modal_masses[min(i, j), max(i, j)]

    @cached_property
    def modal_masses(self) -> dict[tuple[int, int], Edge]:
        """M_ij of two coordinates i <= j (16d): by pairs of sections, or where these are too many by points (12)."""
        g, n, sections = self.g, len(self.coordinates), len(self._tangents) - 1
        entries = list(combinations_with_replacement(range(n), 2))
        own = [g.add(a, b) for a, b in zip(self._rotary[0], self._about_axis, strict=True)]
        still = [
            g.sum(g.mul(g.constant(row[i] * row[j]), x) for row, x in zip(self._turns, own, strict=True))
            for i, j in entries
        ]
        by_pairs = sections * (sections - 1) // 2 * (3 + 2 * len(entries))
        weights = sum(x != ZERO for row in self.mass_points for x in row)
        by_points = 4 * (n * weights + len(entries) * len(self.mass_points))
        masses = self._masses_by_pairs if by_pairs <= by_points else self._masses_by_points
        return dict(zip(entries, masses(entries, still), strict=True))

    def _masses_by_pairs(self, entries: Sequence[tuple[int, int]], still: Sequence[Edge]) -> list[Edge]:
        g, t, turns = self.g, self._tangents, self._turns
        pairs, W = list(combinations(range(1, len(t)), 2)), self._second_moments
        rows = []
        for (i, j), constant in zip(entries, still, strict=True):
            total = g.sum(g.mul(g.constant(row[i] * row[j]), W[k][k]) for k, row in enumerate(turns))
            both = (turns[k][i] * turns[m][j] + turns[k][j] * turns[m][i] for k, m in pairs)
            products = (g.mul(g.constant(x), W[k][m]) for x, (k, m) in zip(both, pairs, strict=True))
            rows.append([g.add(constant, total), *products])
        factors = [g.add(g.mul(t[k].i, t[m].i), g.mul(t[k].j, t[m].j)) for k, m in pairs]
        return self._sums([ONE, *factors], rows)

    def _masses_by_points(self, entries: Sequence[tuple[int, int]], still: Sequence[Edge]) -> list[Edge]:
        g = self.g
        moved = [
            [
                g.sum(
                    g.mul(g.mul(g.constant(turn), x), t[at])
                    for turn, x, t in zip(turns, row, self._tangents, strict=True)
                )
                for row in self.mass_points
                for at in (0, 1)
            ]
            for turns in zip(*self._turns, strict=True)
        ]
        return [
            g.add(constant, g.sum(g.mul(x, y) for x, y in zip(moved[i], moved[j], strict=True)))
            for (i, j), constant in zip(entries, still, strict=True)
        ]

    @cached_property
    def _about_root(self) -> list[Edge]:
        """K_i about e of each coordinate (16d)."""
        g = self.g
        still = [self._by_turns(i, self._about_axis) for i in range(len(self.coordinates))]
        rows = [[x, *column] for x, column in zip(still, self._columns, strict=True)]
        return self._sums([ONE, *(g.add(p.ii, p.jj) for p in self._products[1:])], rows)

    def first_moment_about_root(self) -> Vec3:
        """First moment, in B (13)."""
        return self._joined(*self._linear[1])

    def root_momentum(self, i: int) -> tuple[Vec3, Vec3]:
        """Linear momentum and angular momentum about the root, in B, per unit rate of a coordinate (16d)."""
        return self._joined(*self._linear[2][i]), self._joined(ZERO, ZERO, self._about_root[i])

    # Forces.

    def root_forces(
        self, w: Vec3, alpha: Vec3, a: Vec3, speeds: Sequence[Edge], rates: Sequence[Edge]
    ) -> tuple[Vec3, Vec3, list[Edge]]:
        """Force and moment on the root, and the force on each coordinate, as of `StrainEquations` (16e), (16f)."""
        g, motion = self.g, self._root_motion(w, alpha)
        turn_rates = [ZERO, *self._sums(speeds, list(zip(*self._columns, strict=True)))]
        twice = _Plane(*(g.add(x, x) for x in motion.w))
        inward = [g.mul(g.add(twice.e, rate), rate) for rate in turn_rates]
        outward = [
            g.mul(rate, g.add(g.mul(twice.i, t.i), g.mul(twice.j, t.j)))
            for rate, t in zip(turn_rates, self._tangents, strict=True)
        ]
        f, n = self._force(motion, inward, outward), self._moment(motion, speeds, inward, outward)
        n, forces = n + self.first_moment_about_root().cross(a), []
        elastic = self._sums(self._torques(motion, inward)[1:], self._columns)
        for i, (torque, rate) in enumerate(zip(elastic, rates, strict=True)):
            linear, angular = self.root_momentum(i)
            f, n = f + linear.scaled(rate), n + angular.scaled(rate)
            own = g.sum(g.mul(self.modal_mass(i, j), other) for j, other in enumerate(rates))
            root = g.add(linear.dot(a), g.mul(self._about_root[i], motion.alpha.e))
            forces.append(g.add(own, g.add(root, torque)))
        return f, n, forces

    def _root_motion(self, w: Vec3, alpha: Vec3) -> _RootMotion:
        g, x, y = self.g, self._split(w), self._split(alpha)
        ii, jj, ee = (g.mul(component, component) for component in x)
        return _RootMotion(
            w=x,
            alpha=y,
            ii=-g.add(jj, ee),
            jj=-g.add(ii, ee),
            ij=g.mul(x.i, x.j),
            ei=g.sub(g.mul(x.e, x.i), y.j),
            ej=g.add(g.mul(x.e, x.j), y.i),
        )

    def _force(self, motion: _RootMotion, inward: Sequence[Edge], outward: Sequence[Edge]) -> Vec3:
        """Force on the root without that of its own acceleration and of rates of speeds (16e)."""
        g, weights = self.g, self.first_moment_weights
        S = self._linear[1]
        shares = [g.mul(weight, x) for weight, x in zip(weights, inward, strict=True)]
        to_i, to_j = (g.sum(g.mul(x, t[at]) for x, t in zip(shares, self._tangents, strict=True)) for at in (0, 1))
        f_i = g.add(g.mul(motion.ii, S.i), g.mul(g.sub(motion.ij, motion.alpha.e), S.j))
        f_j = g.add(g.mul(g.add(motion.ij, motion.alpha.e), S.i), g.mul(motion.jj, S.j))
        f_e = g.add(g.mul(motion.ei, S.i), g.mul(motion.ej, S.j))
        along = g.sum(g.mul(weight, x) for weight, x in zip(weights, outward, strict=True))
        return self._joined(g.sub(f_i, to_i), g.sub(f_j, to_j), g.add(f_e, along))

    def _moment(
        self, motion: _RootMotion, speeds: Sequence[Edge], inward: Sequence[Edge], outward: Sequence[Edge]
    ) -> Vec3:
        """Moment about the root without that of its own acceleration and of rates of speeds (16e)."""
        g, (ii, jj, ij), (_, spheres, axial) = self.g, self._E, self._rotary
        sphere, extra = g.sum(spheres), g.sum(axial)
        by_z = [g.sum(g.mul(x, z[at]) for x, z in zip(outward, self._z, strict=True)) for at in (0, 1)]
        n_i = g.add(g.add(g.mul(motion.ei, ij), g.mul(motion.ej, jj)), by_z[1])
        n_j = -g.add(g.add(g.mul(motion.ei, ii), g.mul(motion.ej, ij)), by_z[0])
        n_e = g.add(g.mul(motion.ij, g.sub(ii, jj)), g.mul(g.sub(motion.jj, motion.ii), ij))
        turned = g.sum(g.mul(x, g.sub(p.ij, p.ji)) for x, p in zip(inward, self._products, strict=True))
        own = g.mul(motion.alpha.e, g.add(g.add(sphere, extra), g.add(ii, jj)))
        # Rotary inertia: sections spin about e while the root turns about i and j.
        spin = g.add(
            g.mul(extra, motion.w.e),
            g.sum(g.mul(self._by_turns(i, self._about_axis), speed) for i, speed in enumerate(speeds)),
        )
        n_i = g.add(n_i, g.add(g.mul(sphere, motion.alpha.i), g.mul(spin, motion.w.j)))
        n_j = g.add(n_j, g.sub(g.mul(sphere, motion.alpha.j), g.mul(spin, motion.w.i)))
        return self._joined(n_i, n_j, g.add(g.add(n_e, turned), own))

    def _torques(self, motion: _RootMotion, inward: Sequence[Edge]) -> list[Edge]:
        """Moment about e that each section takes, without that of alpha_e and of rates of speeds (16f)."""
        g, t, torques = self.g, self._tangents, []
        crossed = {
            (k, m): g.mul(self._weights[k][m], g.sub(g.mul(t[k].i, t[m].j), g.mul(t[k].j, t[m].i)))
            for k, m in combinations(range(1, len(t)), 2)
        }
        for k, p in enumerate(self._products):
            of_root = g.add(g.mul(motion.ij, g.sub(p.ii, p.jj)), g.sub(g.mul(motion.jj, p.ij), g.mul(motion.ii, p.ji)))
            before = g.sum(g.mul(x, inward[m]) for (m, other), x in crossed.items() if other == k)
            after = g.sum(g.mul(x, inward[m]) for (other, m), x in crossed.items() if other == k)
            torques.append(g.add(of_root, g.sub(before, after)))
        return torques


def strain_equations(
    g: Graph, lower: Lower, beam: Beam, coordinates: tuple[Edge, ...], R_LB: Mat3 | None = None
) -> StrainEquations:
    """A rod in a graph, by the formulas for a plane where they hold; arguments as of `BeamTheory.equations`."""
    strains = strains_of(beam)
    along = LengthIntegrator(g, lower, beam.length, coordinates, strains.knots)
    given = beam, along, R_LB or Mat3.identity(g), EVERY_DEGREE, strains
    rod = StrainEquations(*given)
    is_plane = rod.axis in (1, 2) and {k for k, _ in strains.axes} == {rod.axis}
    is_plane = is_plane and not rod.law.following and rod.mass_center is None and beam.rhoI_yz == 0.0
    return PlanarStrainEquations(*given) if is_plane else rod
