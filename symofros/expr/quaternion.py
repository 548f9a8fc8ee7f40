"""Unit quaternions whose entries are edges of a graph: rotations, their vectors, and their rates.

The definition of the configuration manifold's rotations. Numbers take the same formulas from `symofros.base.rotations`,
the stepping loop from native/stepping/manifold.c, which select series by branches that a graph does not have.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3

# Added to a squared length: its root, 1e-150, is lost beside any other length, and leaves sin(a)/a at 1 where a is 0.
_TINY = 1e-300


@dataclass(frozen=True, slots=True)
class Quaternion:
    """A quaternion (x, y, z, w): vector and scalar part."""

    vector: Vec3
    scalar: Edge

    @staticmethod
    def of(g: Graph, x: Edge, y: Edge, z: Edge, w: Edge) -> Quaternion:
        """The quaternion of four edges."""
        return Quaternion(Vec3(g, x, y, z), w)

    @staticmethod
    def exponential(w: Vec3) -> Quaternion:
        """The unit quaternion of a rotation vector [rad]."""
        g = w.g
        half = g.mul(g.constant(0.5), length(w))
        factor = g.div(g.mul(g.constant(0.5), g.call("sin", half)), half)
        return Quaternion(w.scaled(factor), g.call("cos", half))

    @property
    def g(self) -> Graph:
        """The graph."""
        return self.vector.g

    def __iter__(self) -> Iterator[Edge]:
        return iter((*self.vector, self.scalar))

    def __mul__(self, other: Quaternion) -> Quaternion:
        """The quaternion of the rotation R_self R_other."""
        g, a, b = self.g, self.vector, other.vector
        vector = b.scaled(self.scalar) + a.scaled(other.scalar) + a.cross(b)
        return Quaternion(vector, g.sub(g.mul(self.scalar, other.scalar), a.dot(b)))

    @property
    def conjugate(self) -> Quaternion:
        """The quaternion of the inverse rotation."""
        return Quaternion(-self.vector, self.scalar)

    @property
    def normalized(self) -> Quaternion:
        """The quaternion divided by its length."""
        g = self.g
        norm = g.sqrt(g.sum(g.mul(edge, edge) for edge in self))
        return Quaternion.of(g, *(g.div(edge, norm) for edge in self))

    @property
    def logarithm(self) -> Vec3:
        """The rotation vector, of at most pi, of a quaternion of any length [rad]."""
        g = self.g
        sign = g.sub(g.mul(g.constant(2.0), g.call("step", self.scalar)), ONE)
        vector, scalar = self.vector.scaled(sign), g.mul(self.scalar, sign)
        size = length(vector)
        return vector.scaled(g.div(g.mul(g.constant(2.0), g.call("atan2", size, scalar)), size))

    @property
    def matrix(self) -> Mat3:
        """The rotation matrix of a unit quaternion."""
        g = self.g
        x, y, z, w = self
        mul, add, sub = g.mul, g.add, g.sub
        tx, ty, tz = add(x, x), add(y, y), add(z, z)
        xx, yy, zz = mul(tx, x), mul(ty, y), mul(tz, z)
        xy, xz, yz = mul(tx, y), mul(tx, z), mul(ty, z)
        wx, wy, wz = mul(tx, w), mul(ty, w), mul(tz, w)
        first = sub(ONE, add(yy, zz)), sub(xy, wz), add(xz, wy)
        second = add(xy, wz), sub(ONE, add(xx, zz)), sub(yz, wx)
        third = sub(xz, wy), add(yz, wx), sub(ONE, add(xx, yy))
        return Mat3(g, (*first, *second, *third))

    def rate(self, axis: int) -> Quaternion:
        """The rate per unit angular velocity along an axis of the rotated frame: half the product with that axis."""
        g, half = self.g, self.g.constant(0.5)
        product = self * Quaternion(Vec3.unit(g, axis), 0)
        return Quaternion.of(g, *(g.mul(half, edge) for edge in product))


def length(v: Vec3) -> Edge:
    """The Euclidean norm, never zero."""
    g = v.g
    return g.sqrt(g.add(v.dot(v), g.constant(_TINY)))
