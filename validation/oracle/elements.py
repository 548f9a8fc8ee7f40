"""Forces that are stated per speed, and energies that are stated per configuration; from their definitions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy

import symofros as sf

from ..mechanics.parts import coordinate_symbols, speed_symbols
from .scope import Scope


def stated_forces(scope: Scope) -> dict[str, Any]:
    """Efforts, motors, virtual power and whatever dissipates: speed -> force on it."""
    Q: dict[str, Any] = dict.fromkeys(scope.speeds, sympy.Integer(0))
    for joint in _free_joints(scope):
        speeds = speed_symbols(joint)
        for speed, effort in zip(speeds, joint.effort, strict=False):
            Q[speed] += scope.value(effort)
        for element in joint.elements:
            # An element that stores nothing needs no coordinate: a damper on a ball joint.
            stores = isinstance(element, sf.Stop)
            q = scope.function[coordinate_symbols(joint)[element.coordinate]] if stores else None
            Q[speeds[element.coordinate]] += _dissipation(scope, element, q, scope.rate[speeds[element.coordinate]])
    for speed, motor in scope.motors.items():
        Q[speed] += motor
    for power in scope.system.virtual_power:
        for speed, force in power.forces:
            Q[speed] += scope.value(force)
    return Q


def stored_energy(scope: Scope) -> Any:
    """Potential energy of springs, stops and potentials by formula."""
    total = sum((scope.value(potential.energy) for potential in scope.system.potentials), sympy.Integer(0))
    for joint in _free_joints(scope):
        for element in joint.elements:
            if isinstance(element, sf.Spring):
                x = scope.function[coordinate_symbols(joint)[element.coordinate]] - scope.value(element.rest)
                total += scope.value(element.stiffness) * x**2 / 2 + scope.value(element.cubic) * x**4 / 4
            elif isinstance(element, sf.Stop):
                q = scope.function[coordinate_symbols(joint)[element.coordinate]]
                beyond = (_positive(x) ** 2 for _, x in _beyond(scope, element, q))
                total += scope.value(element.stiffness) * sum(beyond, sympy.Integer(0)) / 2
    return total


def _free_joints(scope: Scope) -> Iterator[sf.Joint]:
    return (joint for joint in scope.joints if not joint.prescribed)


def _positive(x: Any) -> Any:
    return sympy.Piecewise((x, x > 0), (0, True))


def _beyond(scope: Scope, stop: sf.Stop, q: Any) -> list[tuple[int, Any]]:
    """The way out at each limit, and how far q is out there; negative where it is not."""
    sides = ((1, stop.upper), (-1, stop.lower))
    return [(out, out * (q - scope.value(limit))) for out, limit in sides if limit is not None]


def _dissipation(scope: Scope, element: Any, q: Any, v: Any) -> Any:
    """The part of an element's force that does not come from its energy."""

    def x(name: str) -> Any:
        return scope.value(getattr(element, name))

    if isinstance(element, sf.Damper):
        return -x("coefficient") * v - x("quadratic") * v * sympy.Abs(v)
    if isinstance(element, sf.Stop):
        sides = _beyond(scope, element, q)
        damper = [-out * x("damping") * sympy.Piecewise((_positive(out * v), far > 0), (0, True)) for out, far in sides]
        return sum(damper, sympy.Integer(0))
    if isinstance(element, sf.Friction):
        static = "dynamic" if element.static is None else "static"
        wide = 10 * x("minimum_velocity") if element.stribeck_velocity is None else x("stribeck_velocity")
        dry = _dry_friction(x(static), x("dynamic"), x("minimum_velocity"), wide, v)
        return -sympy.Max(x("factor"), 0) * dry - x("viscous") * v
    return sympy.Integer(0)


def _dry_friction(static: Any, dynamic: Any, slow: Any, wide: Any, v: Any) -> Any:
    """Rises to `static` at the peak, falls to `dynamic` beyond."""
    peak = sympy.Min(sympy.Rational(15, 8) * slow, sympy.Rational(3, 2) * wide)
    xi, beyond = v / peak, sympy.Abs(v) - peak
    # The polynomial c1 xi + c3 xi^3 + c5 xi^5 that has the value, slope and curvature of what falls.
    bend = 2 * (static - dynamic) * (peak / wide) ** 2
    c1, c3, c5 = (15 * static - bend) / 8, (bend - 5 * static) / 4, (3 * static - bend) / 8
    falling = dynamic + (static - dynamic) * sympy.exp(-((beyond / wide) ** 2))
    return sympy.Piecewise((c1 * xi + c3 * xi**3 + c5 * xi**5, beyond < 0), (sympy.sign(v) * falling, True))
