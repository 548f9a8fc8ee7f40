"""Small vectors and matrices whose entries are edges of a graph."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph


@dataclass(frozen=True, slots=True)
class Vec3:
    """Three edges x, y, z of one graph."""

    g: Graph
    x: Edge = ZERO
    y: Edge = ZERO
    z: Edge = ZERO

    @staticmethod
    def unit(g: Graph, axis: int) -> Vec3:
        """The unit vector of axis 0, 1 or 2."""
        return Vec3(g, *(ONE if i == axis else ZERO for i in range(3)))

    def __iter__(self) -> Iterator[Edge]:
        return iter((self.x, self.y, self.z))

    def __add__(self, other: Vec3) -> Vec3:
        add = self.g.add
        return Vec3(self.g, add(self.x, other.x), add(self.y, other.y), add(self.z, other.z))

    def __sub__(self, other: Vec3) -> Vec3:
        return self + -other

    def __neg__(self) -> Vec3:
        return Vec3(self.g, -self.x, -self.y, -self.z)

    def scaled(self, factor: Edge) -> Vec3:
        """Factor times the vector."""
        mul = self.g.mul
        return Vec3(self.g, mul(factor, self.x), mul(factor, self.y), mul(factor, self.z))

    def dot(self, other: Vec3) -> Edge:
        """Scalar product."""
        mul, add = self.g.mul, self.g.add
        return add(add(mul(self.x, other.x), mul(self.y, other.y)), mul(self.z, other.z))

    def cross(self, other: Vec3) -> Vec3:
        """Vector product self x other."""
        g = self.g
        mul = g.mul
        return Vec3(
            g,
            g.sub(mul(self.y, other.z), mul(self.z, other.y)),
            g.sub(mul(self.z, other.x), mul(self.x, other.z)),
            g.sub(mul(self.x, other.y), mul(self.y, other.x)),
        )

    @property
    def is_zero(self) -> bool:
        """Whether all three are the number zero."""
        return self.x == self.y == self.z == ZERO

    @property
    def is_constant(self) -> bool:
        """Whether all three are numbers."""
        return all(map(self.g.is_constant, self))

    def named(self, label: str) -> Vec3:
        """Give the three nodes the names label[0..2]."""
        for i, edge in enumerate(self):
            self.g.name(edge, f"{label}[{i}]")
        return self


@dataclass(frozen=True, slots=True)
class Mat3:
    """Nine edges, row by row."""

    g: Graph
    entries: tuple[Edge, ...]

    @staticmethod
    def identity(g: Graph) -> Mat3:
        """The unit matrix."""
        return Mat3(g, (ONE, ZERO, ZERO, ZERO, ONE, ZERO, ZERO, ZERO, ONE))

    @staticmethod
    def from_columns(g: Graph, columns: Sequence[Vec3]) -> Mat3:
        """The matrix of three columns."""
        return Mat3(g, tuple(edge for row in zip(*columns, strict=True) for edge in row))

    def row(self, i: int) -> Vec3:
        """Row i."""
        return Vec3(self.g, *self.entries[3 * i : 3 * i + 3])

    def column(self, j: int) -> Vec3:
        """Column j."""
        return Vec3(self.g, *self.entries[j::3])

    def at(self, i: int, j: int) -> Edge:
        """Entry (i, j)."""
        return self.entries[3 * i + j]

    @property
    def T(self) -> Mat3:
        """The transpose."""
        e = self.entries
        return Mat3(self.g, (e[0], e[3], e[6], e[1], e[4], e[7], e[2], e[5], e[8]))

    def __add__(self, other: Mat3) -> Mat3:
        return Mat3(self.g, tuple(self.g.add(a, b) for a, b in zip(self.entries, other.entries, strict=True)))

    def times(self, v: Vec3) -> Vec3:
        """Matrix times vector."""
        return Vec3(self.g, self.row(0).dot(v), self.row(1).dot(v), self.row(2).dot(v))

    def __matmul__(self, other: Mat3) -> Mat3:
        columns = [self.times(other.column(j)) for j in range(3)]
        return Mat3.from_columns(self.g, columns)

    @property
    def is_constant(self) -> bool:
        """Whether all nine are numbers."""
        return all(map(self.g.is_constant, self.entries))

    def numbers(self) -> list[list[float]]:
        """The rows of a constant matrix."""
        flat = [self.g.number(edge) for edge in self.entries]
        assert None not in flat
        return [[float(x) for x in flat[3 * i : 3 * i + 3] if x is not None] for i in range(3)]


@dataclass(frozen=True, slots=True)
class Sym3:
    """A symmetric matrix: xx, yy, zz, xy, xz, yz."""

    g: Graph
    xx: Edge = ZERO
    yy: Edge = ZERO
    zz: Edge = ZERO
    xy: Edge = ZERO
    xz: Edge = ZERO
    yz: Edge = ZERO

    def __iter__(self) -> Iterator[Edge]:
        return iter((self.xx, self.yy, self.zz, self.xy, self.xz, self.yz))

    def __add__(self, other: Sym3) -> Sym3:
        return Sym3(self.g, *(self.g.add(a, b) for a, b in zip(self, other, strict=True)))

    def __neg__(self) -> Sym3:
        return Sym3(self.g, *(-edge for edge in self))

    def matrix(self) -> Mat3:
        """All nine entries."""
        return Mat3(self.g, (self.xx, self.xy, self.xz, self.xy, self.yy, self.yz, self.xz, self.yz, self.zz))

    def times(self, v: Vec3) -> Vec3:
        """Matrix times vector."""
        return self.matrix().times(v)

    def named(self, label: str) -> Sym3:
        """Give the six nodes the names label[xx] and so on."""
        for key, edge in zip(("xx", "yy", "zz", "xy", "xz", "yz"), self, strict=True):
            self.g.name(edge, f"{label}[{key}]")
        return self
