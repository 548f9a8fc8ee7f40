"""Lagrange's equations: positions and energies by matrices, velocities by d/dt, the rest by SymPy's LagrangesMethod."""

from __future__ import annotations

from typing import Any

import sympy
from sympy.physics.mechanics import LagrangesMethod

import symofros as sf

from ..mechanics.parts import coordinate_symbols, has_quaternion, series, speed_symbols
from .elements import stated_forces, stored_energy
from .scope import TIME, Derived, NotDerivable, Scope, turn

Pose = tuple[Any, Any]
_STILL = sympy.zeros(3, 1)


def derive(system: sf.System) -> Derived:
    """A model by Lagrange's equations.

    Args:
        system: System with generalized coordinates: no ball or free joints.

    Raises:
        NotDerivable: It has quaternions.
    """
    for body in system.bodies:
        if body.joint is not None and has_quaternion(body.joint):
            raise NotDerivable(f"joint '{body.joint.name}': quaternions are no generalized coordinates")
    scope = Scope(system)
    bodies = _Bodies(scope)
    T, weight = _kinetic(scope, bodies), _weight(scope, bodies)
    q = [scope.function[name] for name in scope.free]
    lagrange = LagrangesMethod(T - weight, q)
    lagrange.form_lagranges_equations()
    V = stored_energy(scope) + sum((x.energy() for x in _lines(scope, bodies)), sympy.Integer(0))
    stated, power = stated_forces(scope), _dissipation(scope, bodies)
    Q = [
        stated[speed] - V.diff(x) - power.diff(scope.rate[speed]) + _work(scope, bodies, scope.rate[speed])
        for speed, x in zip(scope.speeds, q, strict=True)
    ]
    return scope.derived(
        {
            "mass_matrix": lagrange.mass_matrix,
            "bias": -lagrange.forcing,
            "generalized_force": Q,
            "kinetic_energy": [T],
            "potential_energy": [weight + V],
        }
    )


class _Bodies:
    """Poses and angular velocities of bodies and of their frames."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.named = {body.name: body for body in scope.system.bodies}
        self.poses: dict[str, Pose] = {"world": (sympy.eye(3), _STILL)}
        self.poses |= {body.name: (sympy.eye(3), _STILL) for body in scope.system.bodies if body.joint is None}
        self.w: dict[str, Any] = dict.fromkeys(self.poses, _STILL)
        for body in scope.bodies:
            assert body.joint is not None
            R, p = self.frame(body.joint.parent, body.joint.frame)
            R_PD, p_PD = _across(scope, body.joint)
            placed = scope.rotation(body.joint.rotation)
            p = p + R * scope.vector(body.joint.position)
            self.poses[body.name] = (R * placed * R_PD, p + R * placed * p_PD)
            self.w[body.name] = (self.on_parent(body.joint) * R_PD).T * self.w[body.joint.parent] + _spin(R_PD)

    def on_parent(self, joint: sf.Joint) -> Any:
        """R_AP of a joint on its parent."""
        return self._in_body(joint.parent, joint.frame) * self.scope.rotation(joint.rotation)

    def _in_body(self, name: str, frame: str | None) -> Any:
        return sympy.eye(3) if frame is None else self.scope.rotation(self._frame(name, frame).rotation)

    def _frame(self, name: str, frame: str) -> sf.Frame:
        return next(item for item in self.named[name].frames if item.name == frame)

    def frame(self, name: str, frame: str | None) -> Pose:
        """R_WE and p_WE of a body's frame."""
        R, p = self.poses[name]
        if frame is None:
            return R, p
        return R * self._in_body(name, frame), p + R * self.scope.vector(self._frame(name, frame).position)


def _spin(R: Any) -> Any:
    """Angular velocity in the turning frame: the axial vector of R^T R'."""
    S = R.T * R.diff(TIME)
    return sympy.Matrix([S[2, 1], S[0, 2], S[1, 0]])


def _across(scope: Scope, joint: sf.Joint) -> Pose:
    """R_PD and p_PD."""
    R, p = sympy.eye(3), _STILL
    if joint.kind == "general":
        return scope.rotation(joint.moving_rotation), scope.vector(joint.moving_position)
    names = coordinate_symbols(joint)
    for part in series(joint) if joint.kind != "fixed" else ():
        axis, q = scope.unit(part.axis), scope.function[names[part.first]]
        pitch = {"prismatic": sympy.Integer(1), "screw": scope.value(joint.pitch)}.get(part.kind)
        if pitch is not None:
            p = p + R * axis * pitch * q
        if part.kind != "prismatic":
            R = R * turn(axis, q)
    return R, p


def _kinetic(scope: Scope, bodies: _Bodies) -> Any:
    """Kinetic energy of the bodies, rotors and armatures."""
    T = sympy.Integer(0)
    for body in scope.bodies:
        joint = body.joint
        assert joint is not None
        if body.inertia is not None:
            R, p = bodies.poses[body.name]
            m, c, J = scope.inertia(body.inertia)
            v, w = (p + R * c).diff(TIME), bodies.w[body.name]
            T += m * v.dot(v) / 2 + (w.T * J * w)[0] / 2
        rates = [scope.rate[speed] for speed in speed_symbols(joint)] if joint.kind != "fixed" else []
        T += sum((scope.value(joint.armature) * rate**2 / 2 for rate in rates), sympy.Integer(0))
        for rotor in joint.rotors:
            axis = bodies.on_parent(joint) * scope.unit(joint.axis) if rotor.axis is None else scope.unit(rotor.axis)
            along = bodies.w[rotor.carrier or joint.parent].dot(axis)
            spin = scope.value(rotor.ratio) * rates[rotor.coordinate]
            # What the rotor has when locked is in the carrier's own inertia.
            T += scope.value(rotor.inertia) * ((along + spin) ** 2 - along**2) / 2
    return T


def _weight(scope: Scope, bodies: _Bodies) -> Any:
    """Potential energy of the weight, of the base's too."""
    V, g = sympy.Integer(0), scope.vector(scope.system.gravity)
    for body in scope.system.bodies:
        if body.inertia is not None:
            R, p = bodies.poses[body.name]
            m, c, _ = scope.inertia(body.inertia)
            V -= m * g.dot(p + R * c)
    return V


class _Line:
    """A connection, from its first frame to its second."""

    def __init__(self, scope: Scope, bodies: _Bodies, connection: sf.Connection) -> None:
        one, two = (bodies.frame(*anchor)[1] for anchor in (connection.first, connection.second))
        self.d = two - one
        self.k, self.c, self.rest = (
            scope.value(x) for x in (connection.stiffness, connection.damping, connection.length)
        )

    def energy(self) -> Any:
        """Potential energy of the connection's spring."""
        return self.k * (sympy.sqrt(self.d.dot(self.d)) - self.rest) ** 2 / 2

    def rayleigh(self) -> Any:
        """Half of the power the damper takes: of all relative motion where there is no rest length, else along it."""
        v = self.d.diff(TIME)
        if self.rest == 0:
            return self.c * v.dot(v) / 2
        return self.c * self.d.dot(v) ** 2 / self.d.dot(self.d) / 2


def _lines(scope: Scope, bodies: _Bodies) -> list[_Line]:
    return [_Line(scope, bodies, connection) for connection in scope.system.connections]


def _dissipation(scope: Scope, bodies: _Bodies) -> Any:
    """Rayleigh's function of the connections' dampers."""
    return sum((line.rayleigh() for line in _lines(scope, bodies)), sympy.Integer(0))


def _work(scope: Scope, bodies: _Bodies, rate: Any) -> Any:
    """Power of the loads per unit of one speed."""
    total = sympy.Integer(0)
    for body in scope.bodies:
        for load in body.loads:
            R, p = bodies.frame(body.name, None if load.at == "center_of_mass" else _at(load))
            R_WB = bodies.poses[body.name][0]
            if load.at == "center_of_mass":
                assert body.inertia is not None
                p = p + R * scope.vector(body.inertia.center_of_mass)
            axes = sympy.eye(3) if load.axes == "world" else R
            force, torque = axes * scope.vector(load.force), axes * scope.vector(load.torque)
            total += force.dot(p.diff(TIME).diff(rate)) + torque.dot((R_WB * bodies.w[body.name]).diff(rate))
    return total


def _at(load: sf.Load) -> str | None:
    return None if load.at == "body" else load.at
