"""A beam as numbers: its sections' places, tangents and rotations in the frame of its root, with their derivatives.

The field of docs/theory/beams.md, section 1, stated anew as (5) of docs/theory/elements.md: place (x + u, v, w), its
derivative, rotation Rz(P) Ry(T) Rx(F). Shape functions are those of `shape_functions`; the integral of u runs over
Gauss nodes between stations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

import symofros as sf

from .geometry import Array
from .quadrature import STATION, gauss_stations
from .shape_functions import Shape, of_family, stretched, through

# Gauss nodes between two stations: the product of two slopes of degree 15 is integrated exactly.
POINTS = 16
# Degree of the polynomial that takes the place of a user's formula; smooth functions are met to rounding.
DEGREE = 30
# Name of the dimensionless station in formulas of shape functions.
XI = "xi"


@dataclass(frozen=True)
class Curve:
    """A vector of the root's frame at K stations for N states, as a function of the n elastic coordinates.

    Attributes:
        value: (N, K, 3).
        partial: Derivatives with respect to the elastic coordinates (N, K, 3, n).
        bend: Second time derivative at constant elastic speeds (N, K, 3).
    """

    value: Array
    partial: Array
    bend: Array


@dataclass(frozen=True)
class Turn:
    """The rotations of K sections for N states.

    Attributes:
        R: From the section to the root's frame (N, K, 3, 3).
        partial: Angular velocities of unit elastic speeds (N, K, 3, n).
        bend: Angular acceleration at constant elastic speeds (N, K, 3).
    """

    R: Array
    partial: Array
    bend: Array


class BeamSection:
    """The section of a beam of a description at the default parameters.

    Args:
        beam: The beam.
        parameters: Values of the description's parameters.

    Attributes:
        beam: The beam.
        length: Length [m].
    """

    def __init__(self, beam: sf.Beam, parameters: dict[str, float]) -> None:
        self.beam, self._parameters = beam, parameters
        self.length = self.number(beam.length)

    def section(self, name: str, x: Array) -> Array:
        """A property of the section at stations (K,)."""
        value = getattr(self.beam, name)
        return np.array([self.number(value, **{STATION: at}) for at in x.tolist()])

    def number(self, value: sf.Expression | float, **symbols: float) -> float:
        """A formula of parameters, and of symbols with values of their own."""
        return float(sf.evaluate(value, {**self._parameters, **symbols}))


class ElasticBeam(BeamSection):
    """A beam of second order in its displacements, of a description at the default parameters.

    Args:
        beam: The beam.
        parameters: Values of the description's parameters.

    Attributes:
        knots: Ends of the intervals on which shape functions are smooth, from 0 to the length (k,) [m].
    """

    def __init__(self, beam: sf.Beam, parameters: dict[str, float]) -> None:
        super().__init__(beam, parameters)
        L = self.length
        counts = {"bend_y": beam.bend_y, "bend_z": beam.bend_z, "twist": beam.twist}
        functions, knots = [], {0.0, L}
        for direction, count in counts.items():
            shapes, breaks = self._shapes(direction, count) if count else ((), ())
            functions.append(shapes)
            knots |= {at for at in breaks if 0.0 < at < L}
        self.knots = tuple(sorted(knots))
        self._v, self._w, self._twist = functions

    def axis(self, x: Array, q: Array, v: Array) -> Curve:
        """Places of the axis at rising stations x (K,), for elastic coordinates and speeds (N, n)."""
        linear = self._functions(x, 0)
        H = self._foreshortening(x)
        return self._curved(linear, H, x, q, v)

    def tangent(self, x: Array, q: Array, v: Array) -> Curve:
        """Derivatives of the axis with respect to x."""
        linear = self._functions(x, 1)
        H = self._slope_products(x) if self.beam.foreshortening else np.zeros((len(x), *2 * [linear.shape[2]]))
        return self._curved(linear, H, np.ones_like(x), q, v)

    def rotation(self, x: Array, q: Array, v: Array, bending: bool = True) -> Turn:
        """Rotations of the sections; without bending, only the turn F about the root's own axis."""
        slopes, twist = self._functions(x, 1), self._twisting(x)
        P, T, F = (self._angle(part, q) for part in (slopes[:, 1], -slopes[:, 2], twist))
        if not bending:
            P, T, slopes = 0.0 * P, 0.0 * T, 0.0 * slopes
        dP, dT, dF = (np.broadcast_to(part, (len(q), *part.shape)) for part in (slopes[:, 1], -slopes[:, 2], twist))
        e_x, e_y, e_z = np.eye(3)
        Rz, Ry, Rx = _about(2, P), _about(1, T), _about(0, F)
        y, x_axis = Rz @ e_y, Rz @ Ry @ e_x
        partial = (
            e_z[:, None] * dP[..., None, :] + y[..., None] * dT[..., None, :] + x_axis[..., None] * dF[..., None, :]
        )
        P_rate, T_rate, F_rate = (np.einsum("nki,ni->nk", part, v)[..., None] for part in (dP, dT, dF))
        # The axes of later turns are carried by the earlier ones.
        first = P_rate * e_z
        second = first + T_rate * y
        bend = np.cross(first, T_rate * y) + np.cross(second, F_rate * x_axis)
        return Turn(Rz @ Ry @ Rx, partial, bend)

    def _curved(self, linear: Array, H: Array, along: Array, q: Array, v: Array) -> Curve:
        """The curve (along - q.H q/2, 0, 0) plus the terms linear in q."""
        n = len(q)
        Hq, Hv = np.einsum("kij,nj->nki", H, q), np.einsum("kij,nj->nki", H, v)
        value = np.einsum("kci,ni->nkc", linear, q)
        value[..., 0] += along - np.einsum("nki,ni->nk", Hq, q) / 2.0
        partial = np.repeat(linear[None], n, axis=0)
        partial[:, :, 0] -= Hq
        bend = np.zeros_like(value)
        bend[..., 0] = -np.einsum("nki,ni->nk", Hv, v)
        return Curve(value, partial, bend)

    def _functions(self, x: Array, order: int) -> Array:
        """Derivatives by x of the shape functions of the x, y, z displacements (K, 3, n)."""
        values = np.zeros((len(x), 3, self.beam.modes))
        for i, shape in enumerate(self._v):
            values[:, 1, i] = shape[order](x)
        for i, shape in enumerate(self._w, len(self._v)):
            values[:, 2, i] = shape[order](x)
        return values

    def _twisting(self, x: Array) -> Array:
        values = np.zeros((len(x), self.beam.modes))
        for i, shape in enumerate(self._twist, len(self._v) + len(self._w)):
            values[:, i] = shape.value(x)
        return values

    def _slope_products(self, x: Array) -> Array:
        """Products phi' phi'^T of both planes (K, n, n)."""
        slopes = self._functions(x, 1)
        return np.asarray(np.einsum("kci,kcj->kij", slopes, slopes))

    def _foreshortening(self, x: Array) -> Array:
        """H, the integral of the products of slopes from the root to each station (K, n, n)."""
        H = np.zeros((len(x), self.beam.modes, self.beam.modes))
        if not self.beam.foreshortening:
            return H
        ends = sorted({0.0, *x.tolist(), *(knot for knot in self.knots if knot < x[-1])})
        upto, total = {0.0: 0.0 * H[0]}, 0.0 * H[0]
        for a, b in pairwise(ends):
            inner, weights = gauss_stations((a, b), POINTS)
            total = total + np.einsum("k,kij->ij", weights, self._slope_products(inner))
            upto[b] = total
        return np.array([upto[at] for at in x.tolist()])

    @staticmethod
    def _angle(shapes: Array, q: Array) -> Array:
        return np.asarray(q @ shapes.T)

    def _shapes(self, direction: str, count: int) -> tuple[tuple[Shape, ...], Sequence[float]]:
        bending = direction != "twist"
        if self.beam.family != "user":
            return of_family(self.beam.family, count, self.length, bending)
        shapes: list[Shape] = []
        breaks: set[float] = set()
        stated: Any
        for stated in self.beam.user_shapes(direction):  # type: ignore[arg-type]
            if isinstance(stated, sf.Samples):
                shapes.append(through(stated.xi, stated.values, self.length, bending))
                breaks |= {self.length * xi for xi in stated.xi}
            else:
                shapes.append(self._interpolated(stated))
        return tuple(shapes), sorted(breaks)

    def _interpolated(self, stated: sf.Expression | float) -> Shape:
        """A formula of xi as a polynomial through Chebyshev's nodes, and its derivatives."""

        def values(xi: Array) -> Array:
            return np.array([self.number(stated, **{XI: at}) for at in xi.tolist()])

        p = np.polynomial.Chebyshev.interpolate(values, DEGREE, domain=[0.0, 1.0])
        return stretched(p, p.deriv(), p.deriv(2), self.length)


def _about(axis: int, angle: Array) -> Array:
    """Rotations about a unit axis of coordinates (..., 3, 3)."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.zeros((*angle.shape, 3, 3))
    R[..., axis, axis] = 1.0
    R[..., i, i] = R[..., j, j] = np.cos(angle)
    R[..., j, i] = np.sin(angle)
    R[..., i, j] = -np.sin(angle)
    return R
