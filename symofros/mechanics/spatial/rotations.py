"""Rotations as products of elementary factors, so that vectors and tensors turn with the fewest operations.

A rotation about a coordinate axis costs a vector 4 multiplications and 2 additions, a symmetric tensor 8 and 8
(docs/theory/rigid.md, eq. 12); a matrix with no zeros costs 9 + 6 and 45 + 30.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from symofros.base.rotations import nearest_rotation, unit_scale
from symofros.description.values import Rotation
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.expression import Expression, lower
from symofros.expr.graph import Graph
from symofros.expr.numerics.extended import nearest
from symofros.expr.quaternion import Quaternion
from symofros.expr.vector import Mat3, Sym3, Vec3

# cos(pi/2) is 6e-17 in doubles; a rotation's entries this close to 0 or 1 were meant as exact.
EXACT = 1e-15


@dataclass(frozen=True, slots=True)
class AxisRotation:
    """Rotation about coordinate axis k, by its cosine and sine."""

    k: int
    c: Edge
    s: Edge

    def matrix(self, g: Graph) -> Mat3:
        """Matrix of the rotation (3 x 3)."""
        i, j = (self.k + 1) % 3, (self.k + 2) % 3
        entries = list(Mat3.identity(g).entries)
        entries[3 * i + i] = entries[3 * j + j] = self.c
        entries[3 * i + j], entries[3 * j + i] = -self.s, self.s
        return Mat3(g, tuple(entries))

    def conjugate(self, g: Graph, S: Sym3) -> Sym3:
        """R S R^T with 8 multiplications and 8 additions.

        With e = c (a - b) - 2 s d for the block [[a, d], [d, b]] across the axis, the turned block is
        [[b + c e, d + s e], [., a - c e]] (docs/theory/rigid.md, eq. 12).
        """
        i, j, k = (self.k + 1) % 3, (self.k + 2) % 3, self.k
        full = S.matrix()
        a, b, d = full.at(i, i), full.at(j, j), full.at(i, j)
        e = g.sub(g.mul(self.c, g.sub(a, b)), g.mul(self.s, g.add(d, d)))
        ce = g.mul(self.c, e)
        new = {(k, k): full.at(k, k), (i, i): g.add(b, ce), (j, j): g.sub(a, ce), (i, j): g.add(d, g.mul(self.s, e))}
        new[i, k], new[j, k] = self._turned(g, full.at(i, k), full.at(j, k))
        new |= {(n, m): edge for (m, n), edge in new.items()}
        return Sym3(g, new[0, 0], new[1, 1], new[2, 2], new[0, 1], new[0, 2], new[1, 2])

    def conjugate_any(self, g: Graph, B: Mat3) -> Mat3:
        """R B R^T of any matrix with 12 multiplications and 11 additions.

        The part of a block across the axis that is not symmetric stays as it is: eq. 12 with d + d for its two.
        """
        i, j, k = (self.k + 1) % 3, (self.k + 2) % 3, self.k
        new = {(m, n): B.at(m, n) for m in range(3) for n in range(3)}
        a, b, d, d_T = new[i, i], new[j, j], new[i, j], new[j, i]
        e = g.sub(g.mul(self.c, g.sub(a, b)), g.mul(self.s, g.add(d, d_T)))
        ce, se = g.mul(self.c, e), g.mul(self.s, e)
        new |= {(i, i): g.add(b, ce), (j, j): g.sub(a, ce), (i, j): g.add(d, se), (j, i): g.add(d_T, se)}
        new[i, k], new[j, k] = self._turned(g, B.at(i, k), B.at(j, k))
        new[k, i], new[k, j] = self._turned(g, B.at(k, i), B.at(k, j))
        return Mat3(g, tuple(new[m, n] for m in range(3) for n in range(3)))

    def _turned(self, g: Graph, x: Edge, y: Edge) -> tuple[Edge, Edge]:
        """Two components across the axis."""
        return g.sub(g.mul(self.c, x), g.mul(self.s, y)), g.add(g.mul(self.s, x), g.mul(self.c, y))


@dataclass(frozen=True, slots=True)
class MatrixRotation:
    """Any rotation by its matrix; free of cost where it permutes axes, because zeros and ones fold."""

    R: Mat3

    def matrix(self, g: Graph) -> Mat3:
        """Matrix of the rotation (3 x 3)."""
        return self.R

    def conjugate(self, g: Graph, S: Sym3) -> Sym3:
        """R S R^T."""
        RS = self.R @ S.matrix()

        def entry(i: int, j: int) -> Edge:
            return RS.row(i).dot(self.R.row(j))

        return Sym3(g, entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2))

    def conjugate_any(self, g: Graph, B: Mat3) -> Mat3:
        """R B R^T of any matrix."""
        return self.R @ B @ self.R.T


Factor = AxisRotation | MatrixRotation


class RotationProduct:
    """R_AB as a product of factors, left to right.

    Attributes:
        factors: Factors that vectors are multiplied by.
        tensor_factors: Factors that tensors are conjugated by; more of them, but cheaper, for a general constant.
    """

    def __init__(self, g: Graph, factors: tuple[Factor, ...], tensor_factors: tuple[Factor, ...] | None = None) -> None:
        self.g = g
        self.factors = factors
        self.tensor_factors = factors if tensor_factors is None else tensor_factors

    def __matmul__(self, other: RotationProduct) -> RotationProduct:
        """R_AB R_BC = R_AC."""
        return RotationProduct(self.g, self.factors + other.factors, self.tensor_factors + other.tensor_factors)

    def apply(self, x_B: Vec3) -> Vec3:
        """R_AB x_B."""
        for factor in reversed(self.factors):
            x_B = factor.matrix(self.g).times(x_B)
        return x_B

    def apply_inverse(self, x_A: Vec3) -> Vec3:
        """R_AB^T x_A."""
        for factor in self.factors:
            x_A = factor.matrix(self.g).T.times(x_A)
        return x_A

    def conjugate(self, S_B: Sym3) -> Sym3:
        """R_AB S_B R_AB^T."""
        for factor in reversed(self.tensor_factors):
            S_B = factor.conjugate(self.g, S_B)
        return S_B

    def conjugate_any(self, B: Mat3) -> Mat3:
        """R_AB B R_AB^T of a matrix that need not be symmetric."""
        for factor in reversed(self.tensor_factors):
            B = factor.conjugate_any(self.g, B)
        return B

    def after(self, R_WA: Mat3) -> Mat3:
        """R_WA R_AB."""
        for factor in self.factors:
            R_WA = R_WA @ factor.matrix(self.g)
        return R_WA

    def matrix(self) -> Mat3:
        """R_AB as a matrix."""
        return self.after(Mat3.identity(self.g))


def constant_rotation(R: Mat3) -> RotationProduct:
    """A rotation that does not change with q, in its cheapest factors.

    A number matrix with an entry +-1 is an axis permutation times one elementary rotation; any other number matrix is
    three elementary rotations for tensors (`_turns_z_x_z`). A matrix of parameters stays as it is: operations on it
    are done once, not per call.
    """
    g = R.g
    if not R.is_constant:
        return RotationProduct(g, (MatrixRotation(R),))
    rows = R.numbers()
    for i, j in product(range(3), range(3)):
        # An entry rounds to 1 long before the others of its row and column round to 0.
        if abs(rows[i][j]) == 1.0 and not any(rows[i][(j + n) % 3] or rows[(i + n) % 3][j] for n in (1, 2)):
            permutation = _axis_permutation(i, j, rows[i][j])
            rest = _transposed_product(permutation, rows)
            k, c, s = j, rest[(j + 1) % 3][(j + 1) % 3], rest[(j + 2) % 3][(j + 1) % 3]
            # Multiples of 90 degrees join the permutation: nothing is left to turn.
            if c in (0.0, 1.0, -1.0):
                return RotationProduct(g, (MatrixRotation(R),)) if R != Mat3.identity(g) else RotationProduct(g, ())
            factors: list[Factor] = [AxisRotation(k, g.constant(c), g.constant(s))]
            if permutation != [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]:
                factors.insert(0, MatrixRotation(_number_matrix(g, permutation)))
            return RotationProduct(g, tuple(factors))
    return RotationProduct(g, (MatrixRotation(R),), _turns_z_x_z(g, rows))


def _turns_z_x_z(g: Graph, R: list[list[float]]) -> tuple[AxisRotation, ...]:
    """The factors Rz(a) Rx(b) Rz(c) of a rotation matrix of numbers (docs/theory/rigid.md, eq. 12a).

    Where b is nearly 0 or pi, a is taken from entries that are noise, and only a +- c is defined. So b and c are read
    off what the first turn leaves of R, Rz(a)^T R = Rx(b) Rz(c), whatever a came out as: the product is R to rounding.
    """
    a = nearest("atan2", R[0][2], -R[1][2])
    cos_a, sin_a = nearest("cos", a), nearest("sin", a)
    first = [cos_a * R[0][n] + sin_a * R[1][n] for n in range(3)]
    tilt = sin_a * R[0][2] - cos_a * R[1][2]
    b, c = nearest("atan2", tilt, R[2][2]), nearest("atan2", -first[1], first[0])
    angles = ((2, cos_a, sin_a), *((k, nearest("cos", x), nearest("sin", x)) for k, x in ((0, b), (2, c))))
    return tuple(AxisRotation(k, g.constant(cosine), g.constant(sine)) for k, cosine, sine in angles)


def _axis_permutation(i: int, j: int, sign: float) -> list[list[float]]:
    """A rotation by signed axes with entry (i, j) equal to sign; the identity if possible."""
    candidates = []
    for columns in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            P = [[signs[r] if columns[r] == col else 0.0 for col in range(3)] for r in range(3)]
            if P[i][j] == sign and _determinant(P) > 0.0:
                candidates.append(P)
    return max(candidates, key=lambda P: P[0][0] + P[1][1] + P[2][2])


def _determinant(P: list[list[float]]) -> float:
    return sum(
        P[0][i] * (P[1][(i + 1) % 3] * P[2][(i + 2) % 3] - P[1][(i + 2) % 3] * P[2][(i + 1) % 3]) for i in range(3)
    )


def _transposed_product(P: list[list[float]], R: list[list[float]]) -> list[list[float]]:
    return [[sum(P[k][i] * R[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def _number_matrix(g: Graph, rows: list[list[float]]) -> Mat3:
    return Mat3(g, tuple(g.constant(x) for row in rows for x in row))


def snapped(R: Mat3) -> Mat3:
    """The matrix with entries that are 0 or +-1 but for rounding made exact."""
    g = R.g

    def snap(edge: Edge) -> Edge:
        number = g.number(edge)
        if number is None or min(abs(number), abs(abs(number) - 1.0)) > EXACT:
            return edge
        return g.constant(round(number))

    return Mat3(g, tuple(map(snap, R.entries)))


def stated_rotation(rotation: Rotation, g: Graph, bindings: Mapping[str, Edge]) -> Mat3:
    """A rotation of the description as a matrix of edges."""
    x = [g.constant(v) if not isinstance(v, Expression) else lower(v, g, bindings) for v in rotation.values]
    if rotation.kind == "matrix":
        return snapped(_orthonormal(Mat3(g, tuple(x))))
    if rotation.kind == "rpy":
        factors = [AxisRotation(k, g.call("cos", x[k]), g.call("sin", x[k])).matrix(g) for k in (2, 1, 0)]
        return snapped(snapped(factors[0]) @ snapped(factors[1]) @ snapped(factors[2]))
    if rotation.kind == "quaternion":
        return snapped(Quaternion.of(g, *_scaled(g, x)).normalized.matrix)
    axis = unit_vector(Vec3(g, *x[:3]))
    return snapped(axis_angle_matrix(axis, g.call("cos", x[3]), g.call("sin", x[3])))


def _orthonormal(R: Mat3) -> Mat3:
    """The rotation nearest to a stated matrix of numbers; one of formulas is taken at its word."""
    if not R.is_constant:
        return R
    rows = nearest_rotation(np.array(R.numbers()))
    return Mat3(R.g, tuple(R.g.constant(float(entry)) for entry in rows.flat))


def _scaled(g: Graph, x: Sequence[Edge]) -> list[Edge]:
    """Numbers times the power of two that lets their squares keep their digits; others as they are."""
    numbers = [g.number(edge) for edge in x]
    stated = [number for number in numbers if number is not None]
    if len(stated) < len(x) or not any(stated):
        return list(x)
    return [g.constant(float(number)) for number in unit_scale(np.array(stated))]


def unit_vector(v: Vec3) -> Vec3:
    """Vector v divided by its length; exact along a coordinate axis, and where it is one but for rounding."""
    g = v.g
    v = Vec3(g, *_scaled(g, tuple(v)))
    length = g.sqrt(v.dot(v))
    unit = Vec3(g, *(g.div(edge, length) for edge in v))
    if not unit.is_constant:
        return unit
    x = [g.number(edge) or 0.0 for edge in unit]
    # An entry rounds to 1 long before the others round to 0, which alone says that the vector is a coordinate axis.
    x = [number if abs(number) > EXACT else 0.0 for number in x]
    if sum(map(bool, x)) == 1:
        x = [math.copysign(1.0, number) if number else 0.0 for number in x]
    return Vec3(g, *map(g.constant, x))


def coordinate_axis(n: Vec3) -> tuple[int, bool] | None:
    """The coordinate axis that a unit vector lies along, and whether it points against it; None if along none."""
    along = [i for i, edge in enumerate(n) if edge != ZERO]
    if len(along) != 1 or abs(tuple(n)[along[0]]) != ONE:
        return None
    return along[0], tuple(n)[along[0]] < 0


def axis_angle_matrix(n: Vec3, c: Edge, s: Edge) -> Mat3:
    """Rodrigues' formula: c 1 + s [n] + (1 - c) n n^T for a unit vector n."""
    g = n.g
    v = n.scaled(g.sub(ONE, c))
    sn = n.scaled(s)
    axis = tuple(n)
    entries = [g.mul(vi, nj) for vi in v for nj in axis]
    for i in range(3):
        entries[4 * i] = g.add(entries[4 * i], c)
    for i, j, edge in ((2, 1, sn.x), (0, 2, sn.y), (1, 0, sn.z)):
        entries[3 * i + j] = g.add(entries[3 * i + j], edge)
        entries[3 * j + i] = g.sub(entries[3 * j + i], edge)
    return Mat3(g, tuple(entries))


def frame_with_axis(n: Vec3) -> tuple[Mat3, int, bool] | None:
    """A constant rotation A whose column k is the number vector n, up to its sign.

    Returns:
        A, k and whether n is minus column k; None if n is not constant.
    """
    g = n.g
    if not n.is_constant:
        return None
    along = coordinate_axis(n)
    if along is not None:
        return Mat3.identity(g), *along
    x = [g.number(edge) or 0.0 for edge in n]
    # Column 2 is n; the first column is the coordinate axis least along n, made orthogonal to it.
    least = min(range(3), key=lambda i: abs(x[i]))
    first = [float(i == least) - x[least] * x[i] for i in range(3)]
    size = math.sqrt(sum(e * e for e in first))
    first = [e / size for e in first]
    second = [x[(i + 1) % 3] * first[(i + 2) % 3] - x[(i + 2) % 3] * first[(i + 1) % 3] for i in range(3)]
    columns = [Vec3(g, *map(g.constant, column)) for column in (first, second, x)]
    return snapped(Mat3.from_columns(g, columns)), 2, False
