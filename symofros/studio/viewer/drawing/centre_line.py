"""The deformed axis of a beam in numbers, from the displacement field that its equations come from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from symofros.base.arrays import Array
from symofros.description import Beam
from symofros.mechanics.beams import Deformation, Field, Monomial, RodShape, deformation_of

STATIONS = 17  # Of a beam, ends included: four an arch of the fourth mode. Each costs two messages a picture.


@dataclass(frozen=True)
class _Sampled:
    """A field at stations.

    Attributes:
        values: Monomial -> its coefficient without the power of L (S).
        powers: Monomial -> that power.
    """

    values: Mapping[Monomial, Array]
    powers: Mapping[Monomial, int]

    def at(self, length: float, q: Array) -> Array:
        """Values for coordinates (..., n) at every station (..., S)."""
        total = np.zeros((*q.shape[:-1], STATIONS))
        for mono, values in self.values.items():
            factor = length ** self.powers[mono] * np.prod(q[..., list(mono)], axis=-1)
            total = total + np.asarray(factor)[..., None] * values
        return total


class RodLine:
    """Where the sections of a geometrically exact rod are, for given strain coordinates.

    Args:
        beam: Rod as the user stated it.
        values: Number of each parameter.
    """

    def __init__(self, beam: Beam, values: Mapping[str, float]) -> None:
        self.modes = beam.modes
        self._shape = RodShape(beam, values, [k / (STATIONS - 1) for k in range(STATIONS)])

    def points(self, length: float, q: Array) -> Array:
        """p_BS of the stations, in the axes of the root (..., S, 3) [m]."""
        return length * self._shape.sections(q)[0]

    def axes(self, length: float, q: Array) -> Array:
        """R_BS of the sections (..., S, 3, 3)."""
        return self._shape.sections(q)[1]


class CentreLine:
    """Where a beam's sections are, for given elastic coordinates (docs/theory/beams.md, eqs. 1-3).

    The last station is the tip, and has the pose that the model's own `frame_pose` gives the tip's frame.

    Args:
        beam: Beam as the user stated it.
    """

    def __init__(self, beam: Beam) -> None:
        shape: Deformation = deformation_of(beam)
        self.modes = beam.modes
        self._position = [_sampled(field) for field in shape.position]
        self._angles = [_sampled(field) for field in (shape.yaw, shape.pitch, shape.roll)]

    def points(self, length: float, q: Array) -> Array:
        """p_BS of the stations, in the axes of the root (..., S, 3) [m].

        Args:
            length: Length of the beam [m].
            q: Elastic coordinates (..., modes).
        """
        return np.stack([field.at(length, q) for field in self._position], axis=-1)

    def axes(self, length: float, q: Array) -> Array:
        """R_BS of the sections (..., S, 3, 3): yaw, pitch and roll in turn, so rotations at any deflection."""
        yaw, pitch, roll = (field.at(length, q) for field in self._angles)
        return _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)


def _sampled(field: Field) -> _Sampled:
    stations = [Fraction(k, STATIONS - 1) for k in range(STATIONS)]
    values = {mono: np.array([float(f(xi)) for xi in stations]) for mono, f in field.terms.items()}
    return _Sampled(values, {mono: field.exponent(mono) for mono in values})


def _about(axis: int, angle: Array) -> Array:
    """Rotations about a coordinate axis (..., 3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.zeros((*angle.shape, 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[..., axis, axis] = 1.0
    R[..., i, i] = R[..., j, j] = c
    R[..., i, j], R[..., j, i] = -s, s
    return R
