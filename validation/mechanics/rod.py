"""A geometrically exact rod as numbers: its sections' places, tangents and rotations with their derivatives.

The field of docs/theory/rods.md, (1) and (1a), by collocation in its differential equations along the axis (section 2
of docs/theory/elements.md): no series of Magnus, no Gibbs vector, no tangents at a few sections. Between knots all
fields are polynomials through many Gauss nodes; what is left is below 1e-12 for turns of up to two radians.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

import symofros as sf

from .elastic import XI, BeamSection, Curve, Turn
from .geometry import Array, skew
from .shape_functions import strain_family

# Strain that a rod's coordinates of a direction are of (0 to 2 turn sections, 3 to 5 stretch, shear), and their sign.
STRAINS: dict[str, tuple[int, float]] = {
    "bend_y": (2, 1.0),
    "bend_z": (1, -1.0),
    "twist": (0, 1.0),
    "stretch": (3, 1.0),
    "shear_y": (4, 1.0),
    "shear_z": (5, 1.0),
}
# Strains without stress, by axis.
PRE_STRAINS = ("twist_rate", "curvature_y", "curvature_z")
# Gauss nodes between knots.
NODES = 20


class _Fields(NamedTuple):
    """Fields at K stations of N states, in the frame of the root.

    Attributes:
        R: Rotations (N, K, 3, 3).
        spins: Angular velocities of unit speeds (N, K, 3, n).
        alpha: Angular accelerations at constant speeds (N, K, 3).
        p: Places (N, K, 3).
        J: Velocities of unit speeds (N, K, 3, n).
        a: Accelerations at constant speeds (N, K, 3).
    """

    R: Array
    spins: Array
    alpha: Array
    p: Array
    J: Array
    a: Array


@dataclass(frozen=True)
class _Interval:
    """Integration between two knots.

    Attributes:
        start: The knot where it starts [m].
        length: Distance of the knots [m].
    """

    start: float
    length: float

    @cached_property
    def nodes(self) -> Array:
        """Gauss nodes (NODES,) [m]."""
        return self.start + self.length * (np.polynomial.legendre.leggauss(NODES)[0] + 1.0) / 2.0

    def integration(self, x: Array) -> Array:
        """Weights (K, NODES) of the nodes in integrals from the start to stations (K,) [m]."""
        legendre = np.polynomial.legendre
        coefficients = np.linalg.inv(legendre.legvander(legendre.leggauss(NODES)[0], NODES - 1))
        primitives = legendre.legint(np.eye(NODES), lbnd=-1)
        at = legendre.legvander(2.0 * (x - self.start) / self.length - 1.0, NODES)
        return np.asarray(self.length / 2.0 * at @ primitives @ coefficients)


class StrainRod(BeamSection):
    """A rod of a description at the default parameters; it stands where an `ElasticBeam` does.

    Its sections have their centres on the axis, and couple no strains.

    Args:
        beam: The rod.
        parameters: Values of the description's parameters.

    Attributes:
        knots: Ends of the intervals on which strain functions are smooth, from 0 to the length (k,) [m].
    """

    def __init__(self, beam: sf.Beam, parameters: dict[str, float]) -> None:
        super().__init__(beam, parameters)
        self._functions: list[tuple[int, float, Callable[[Array], Array]]] = []
        knots = {0.0, self.length}
        for direction, (axis, sign) in STRAINS.items():
            functions, breaks = self._family(direction, getattr(beam, direction))
            self._functions += [(axis, sign, function) for function in functions]
            knots |= {self.length * xi for xi in breaks}
        self.knots = tuple(sorted(knots))
        self._intervals = [_Interval(a, b - a) for a, b in pairwise(self.knots)]
        self._solved: tuple[bytes, list[tuple[_Fields, _Fields]]] | None = None

    def axis(self, x: Array, q: Array, v: Array) -> Curve:
        """Places of the axis at rising stations x (K,), for strain coordinates and speeds (N, n)."""
        at = self._at(x, q, v)
        return Curve(at.p, at.J, at.a)

    def tangent(self, x: Array, q: Array, v: Array) -> Curve:
        """Derivatives of the axis with respect to x."""
        return _tangents(self._at(x, q, v), self._table(x), q, v)

    def rotation(self, x: Array, q: Array, v: Array) -> Turn:
        """Rotations of the sections."""
        at = self._at(x, q, v)
        return Turn(at.R, at.spins, at.alpha)

    def _at(self, x: Array, q: Array, v: Array) -> _Fields:
        """Fields at rising stations."""
        parts = []
        for interval, (start, rates) in zip(self._intervals, self._solution(q, v), strict=True):
            end = interval.start + interval.length
            last = interval is self._intervals[-1]
            inside = (x >= interval.start) & ((x <= end) if last else (x < end))
            parts.append(_integrated(start, rates, interval.integration(x[inside])))
        return _Fields(*(np.concatenate(arrays, axis=1) for arrays in zip(*parts, strict=True)))

    def _solution(self, q: Array, v: Array) -> list[tuple[_Fields, _Fields]]:
        """Fields at the start of each interval (K = 1), their derivatives by x at its nodes; the latest are kept."""
        key = q.tobytes() + v.tobytes()
        if self._solved is None or self._solved[0] != key:
            count, n = q.shape
            still, none = np.zeros((count, 1, 3)), np.zeros((count, 1, 3, n))
            start = _Fields(np.broadcast_to(np.eye(3), (count, 1, 3, 3)), none, still, still, none, still)
            solution = []
            for interval in self._intervals:
                rates = self._rates(interval, start, q, v)
                solution.append((start, rates))
                start = _integrated(start, rates, interval.integration(np.array([interval.start + interval.length])))
            self._solved = key, solution
        return self._solved[1]

    def _rates(self, interval: _Interval, start: _Fields, q: Array, v: Array) -> _Fields:
        """Derivatives by x at the nodes of an interval (9) to (11) of docs/theory/elements.md."""
        x, count = interval.nodes, len(q)
        A, table = interval.integration(x), self._table(x)
        k = self._unstressed(x) + np.einsum("kci,ni->nkc", table[:, :3], q)
        K = skew(k)
        # R = R_start + A R K at the nodes: each row of R by itself, transposed.
        operator = np.eye(3 * NODES) - np.einsum("jk,nkba->njakb", A, K).reshape(count, 3 * NODES, 3 * NODES)
        first = np.tile(start.R[:, 0].swapaxes(1, 2), (1, NODES, 1))
        R = np.linalg.solve(operator, first).reshape(count, NODES, 3, 3).swapaxes(2, 3)
        spin_rates = np.einsum("nkab,kbi->nkai", R, table[:, :3])
        spins = start.spins + np.einsum("jk,nkai->njai", A, spin_rates)
        w, w_rates = _of_speeds(spins, v), _of_speeds(spin_rates, v)
        alpha_rates = np.cross(w, w_rates)
        alpha = start.alpha + np.einsum("jk,nka->nja", A, alpha_rates)
        tangents = _tangents(_Fields(R, spins, alpha, *start[3:]), table, q, v)
        return _Fields(R @ K, spin_rates, alpha_rates, tangents.value, tangents.partial, tangents.bend)

    def _table(self, x: Array) -> Array:
        """Strains of unit coordinates at stations (K, 6, n): turns a length [1/m], stretch and shears."""
        values = np.zeros((len(x), 6, len(self._functions)))
        for i, (axis, sign, function) in enumerate(self._functions):
            scale = sign / (self.length if axis < 3 else 1.0)
            values[:, axis, i] = scale * function(x / self.length)
        return values

    def _unstressed(self, x: Array) -> Array:
        """Strains without stress (K, 3) [1/m]."""
        return np.stack([self.section(name, x) for name in PRE_STRAINS], axis=1)

    def _family(self, direction: str, count: int) -> tuple[list[Callable[[Array], Array]], tuple[float, ...]]:
        if self.beam.family != "user":
            return strain_family(self.beam.family, count)
        return [self._formula(stated) for stated in self.beam.user_shapes(direction)], ()  # type: ignore[arg-type]

    def _formula(self, stated: sf.Expression | float) -> Callable[[Array], Array]:
        return lambda xi: np.array([self.number(stated, **{XI: at}) for at in xi.tolist()])


def _integrated(start: _Fields, rates: _Fields, A: Array) -> _Fields:
    """Fields at stations by their derivatives at the nodes.

    Args:
        start: Fields at the start of the interval (K = 1).
        rates: Their derivatives by x at the nodes.
        A: Weights of the nodes in integrals to the stations (K, NODES).
    """
    return _Fields(*(first + np.einsum("jk,nk...->nj...", A, rate) for first, rate in zip(start, rates, strict=True)))


def _tangents(at: _Fields, table: Array, q: Array, v: Array) -> Curve:
    """Tangents t = R (e_x + g) where R, spins and alpha are known, their derivatives and second rates."""
    shifts = np.einsum("nkab,kbi->nkai", at.R, table[:, 3:])
    t = at.R[..., 0] + _of_speeds(shifts, q)
    w, slip = _of_speeds(at.spins, v), _of_speeds(shifts, v)
    partial = np.cross(at.spins, t[..., None], axis=2) + shifts
    bend = np.cross(at.alpha, t) + np.cross(w, np.cross(w, t)) + 2.0 * np.cross(w, slip)
    return Curve(t, partial, bend)


def _of_speeds(J: Array, v: Array) -> Array:
    return np.asarray((J @ v[:, None, :, None])[..., 0])
