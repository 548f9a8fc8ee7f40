"""Energies of one beam for the Lagrangian engine: the field of docs/theory/beams.md, summed over Gauss stations.

Everything that the second-order field implies is kept. Integrals are sums over stations and derivatives are CasADi's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import casadi as ca
import numpy as np

from ...mechanics.geometry import Array
from ...mechanics.shape_functions import Shape

Section = float | Callable[[float], float]
SX = Any  # CasADi has no types.

# Gauss nodes an interval: exact to degree 23, and smooth sections to rounding.
POINTS = 12


class Line(NamedTuple):
    """A force and a moment on the axis: at a station x [m], or per length at every x, along axes.

    Components are numbers, or CasADi expressions of a motion's symbols.
    """

    force: Callable[[float], Sequence[Any]]
    torque: Callable[[float], Sequence[Any]] | None = None
    at: float | None = None
    axes: Literal["body", "world", "section"] = "body"


@dataclass(frozen=True)
class Flexible:
    """A beam along x, clamped to its frame; its functions are of x [m], and smooth between breaks."""

    length: float
    rhoA: Section
    v: tuple[Shape, ...] = ()
    w: tuple[Shape, ...] = ()
    twist: tuple[Shape, ...] = ()
    EI_z: Section = 0.0
    EI_y: Section = 0.0
    GJ: Section = 0.0
    rhoJ: Section = 0.0
    rhoI_y: Section = 0.0
    rhoI_z: Section = 0.0
    damping: float = 0.0
    foreshortening: bool = True
    rotary_inertia: bool = False
    breaks: tuple[float, ...] = ()
    loads: tuple[Line, ...] = ()
    points: int = POINTS

    @property
    def modes(self) -> int:
        """Number of elastic coordinates of the beam, in the order v, w, twist."""
        return len(self.v) + len(self.w) + len(self.twist)


class Angles(NamedTuple):
    """Angles of sections: twist F, pitch T and yaw P, at n stations each."""

    F: SX
    T: SX
    P: SX


def rotation_about(axis: SX, angle: SX) -> SX:
    """The rotation about an axis of any length, numbers or expressions (Rodrigues)."""
    n = ca.SX(ca.vertcat(*axis) if isinstance(axis, list | tuple) else axis)
    K = ca.skew(n / ca.norm_2(n))
    return ca.SX.eye(3) + ca.sin(angle) * K + (1 - ca.cos(angle)) * (K @ K)


def stations(length: float, breaks: Sequence[float], points: int = POINTS) -> tuple[Array, Array]:
    """Gauss nodes and weights from 0 to length, interval by interval between breaks."""
    node, w = np.polynomial.legendre.leggauss(points)
    ends = [0.0, *(b for b in sorted(breaks) if 0.0 < b < length), length]
    half = np.diff(ends) / 2
    x = np.concatenate([a + h * (node + 1) for a, h in zip(ends, half, strict=False)])
    return x, np.concatenate([h * w for h in half])


def centroids(beam: Flexible, x: Array, q: SX) -> SX:
    """Places of the axis at stations, in B (3, n)."""
    q_v, q_w, _ = _parts(beam, q)
    u = ca.SX.zeros(len(x))
    if beam.foreshortening:
        for shapes, own in ((beam.v, q_v), (beam.w, q_w)):
            if shapes:
                u -= ca.vertcat(*(0.5 * own.T @ ca.SX(_slopes_squared(beam, shapes, xi)) @ own for xi in x))
    return ca.horzcat(ca.SX(x) + u, _modal(beam.v, q_v, x, 0), _modal(beam.w, q_w, x, 0)).T


def angles(beam: Flexible, x: Array, q: SX, order: int = 0) -> Angles:
    """Angles of sections at stations, or their derivative by x."""
    q_v, q_w, q_F = _parts(beam, q)
    return Angles(
        _modal(beam.twist, q_F, x, order), -_modal(beam.w, q_w, x, order + 1), _modal(beam.v, q_v, x, order + 1)
    )


def section(beam: Flexible, x: float, q: SX) -> tuple[SX, SX]:
    """Place and rotation of one section in B; it turns exactly."""
    at = np.array([x])
    F, T, P = angles(beam, at, q)
    turned = rotation_about((0, 0, 1), P) @ rotation_about((0, 1, 0), T) @ rotation_about((1, 0, 0), F)
    return centroids(beam, at, q), turned


def at_stations(value: Section, x: Array) -> Array:
    """A section's property at stations (n,)."""
    return np.array([float(value(xi)) if callable(value) else value for xi in x])


def strain_energy(beam: Flexible, q: SX) -> SX:
    """1/2 the integral of GJ k1^2 + EI_y k2^2 + EI_z k3^2 up to third degree."""
    x, weight = stations(beam.length, beam.breaks, beam.points)
    GJ, EI_y, EI_z = (ca.SX(at_stations(value, x) * weight) for value in (beam.GJ, beam.EI_y, beam.EI_z))
    F, T, _ = angles(beam, x, q)
    dF, dT, dP = angles(beam, x, q, 1)
    first = dF**2 - 2 * dF * T * dP
    second = dT**2 + 2 * dT * F * dP
    third = dP**2 - 2 * dP * F * dT
    return 0.5 * (ca.dot(GJ, first) + ca.dot(EI_y, second) + ca.dot(EI_z, third))


def dissipation(beam: Flexible, rates: SX) -> SX:
    """Rayleigh's function of Voigt-Kelvin damping: the quadratic strain energy of the rates, times its time."""
    x, weight = stations(beam.length, beam.breaks, beam.points)
    GJ, EI_y, EI_z = (ca.SX(at_stations(value, x) * weight) for value in (beam.GJ, beam.EI_y, beam.EI_z))
    dF, dT, dP = angles(beam, x, rates, 1)
    return 0.5 * beam.damping * (ca.dot(GJ, dF**2) + ca.dot(EI_y, dT**2) + ca.dot(EI_z, dP**2))


def turning_energy(beam: Flexible, q: SX, rate: Callable[[SX], SX], w_B: SX) -> SX:
    """Kinetic energy of sections that turn: about the axis alone, or about all three of their own axes.

    Args:
        beam: The beam.
        q: Elastic coordinates of the beam.
        rate: The rate of an expression of them.
        w_B: Angular velocity of its frame, along its axes.
    """
    x, weight = stations(beam.length, beam.breaks, beam.points)
    F, T, P = angles(beam, x, q)
    dF, dT, dP = (rate(angle) for angle in (F, T, P))
    inertias = [ca.SX(at_stations(value, x) * weight) for value in (beam.rhoJ, beam.rhoI_y, beam.rhoI_z)]
    if not beam.rotary_inertia:
        return 0.5 * ca.dot(inertias[0], (w_B[0] + dF) ** 2)
    one = 1 - P**2 / 2 - T**2 / 2, P, -T
    two = F * T - P, 1 - F**2 / 2 - P**2 / 2, F
    three = F * P + T, P * T - F, 1 - F**2 / 2 - T**2 / 2
    spins = dF - T * dP, dT + F * dP, dP - F * dT
    total = ca.SX(0)
    for inertia, axis, spin in zip(inertias, (one, two, three), spins, strict=True):
        total += 0.5 * ca.dot(inertia, (axis[0] * w_B[0] + axis[1] * w_B[1] + axis[2] * w_B[2] + spin) ** 2)
    return total


def _parts(beam: Flexible, q: SX) -> list[SX]:
    ends = np.cumsum([0, len(beam.v), len(beam.w), len(beam.twist)])
    return [q[int(a) : int(b)] for a, b in zip(ends, ends[1:], strict=False)]


def _modal(shapes: tuple[Shape, ...], own: SX, x: Array, order: int) -> SX:
    if not shapes:
        return ca.SX.zeros(len(x))
    return ca.SX(np.array([shape[order](x) for shape in shapes]).T) @ own


def _slopes_squared(beam: Flexible, shapes: tuple[Shape, ...], x: float) -> Array:
    """H: the integral of phi' phi'^T from the root to x."""
    inner, weight = stations(x, beam.breaks, beam.points)
    slopes = np.array([shape[1](inner) for shape in shapes])
    return np.asarray((slopes * weight) @ slopes.T)
