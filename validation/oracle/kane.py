"""Kane's equations: frames, points and bodies of sympy.physics.mechanics, and its KanesMethod.

Speeds may be others than the rates of coordinates, so ball and free joints have equations here.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy
from sympy.physics.mechanics import KanesMethod, Point, ReferenceFrame, RigidBody, inertia, outer

import symofros as sf

from ..mechanics.parts import coordinate_symbols, has_quaternion, series, speed_symbols
from .elements import stated_forces, stored_energy
from .scope import TIME, Derived, Scope, turns

Placed = tuple[Any, Any]


def derive(system: sf.System) -> Derived:
    """A model by Kane's equations.

    Raises:
        NotDerivable: A prescribed motion has quaternions.
    """
    scope = Scope(system)
    model = _Model(scope)
    speeds = {name: sympy.Function(f"u{k}")(TIME) for k, name in enumerate(scope.speeds)}
    speeds |= {name: scope.rate[name] for name in scope.speeds if scope.rate[name].is_Function}
    rates = _rates(scope, speeds)
    bodies, ground = model.bodies()
    # One run gives both forces: what is applied carries a mark, the weight does not.
    mark = sympy.Dummy("mark")
    loads = [(where, mark * what) for where, what in (*model.loads(), *model.pulls())]
    loads += [(body.masscenter, body.mass * model.g) for body in bodies]
    kane = KanesMethod(model.N, list(rates), list(speeds.values()), [q.diff(TIME) - x for q, x in rates.items()])
    active, _ = kane.kanes_equations(bodies, loads)
    V = stored_energy(scope)
    stored = sum((V.diff(q) * x for q, x in rates.items()), sympy.Integer(0))
    stated = stated_forces(scope)
    Q = [
        force.xreplace({mark: 1}) - force.xreplace({mark: 0}) + stated[name] - stored.diff(u)
        for force, (name, u) in zip(active, speeds.items(), strict=True)
    ]
    armature = {name: scope.value(joint.armature) for joint in scope.joints for name in speed_symbols(joint)}
    T = sum((body.kinetic_energy(model.N) for body in bodies), sympy.Integer(0))
    T += sum((a * scope.rate[name] ** 2 / 2 for name, a in armature.items()), sympy.Integer(0))
    weight = -sum(
        (body.mass * body.masscenter.pos_from(model.origin).dot(model.g) for body in (*bodies, *ground)),
        sympy.Integer(0),
    )
    return scope.derived(
        {
            "mass_matrix": kane.mass_matrix + sympy.diag(*(armature[name] for name in speeds)),
            "bias": -kane.forcing.xreplace({mark: 0}),
            "generalized_force": Q,
            "kinetic_energy": [T],
            "potential_energy": [weight + V + model.pull_energy()],
        },
        {u: scope.rate[name] for name, u in speeds.items()},
    )


def _rates(scope: Scope, u: dict[str, Any]) -> dict[Any, Any]:
    """Function of each free coordinate -> its rate by the speeds."""
    rates: dict[Any, Any] = {}
    for joint in scope.joints:
        if joint.prescribed:
            continue
        q = [scope.function[name] for name in coordinate_symbols(joint)]
        v = [u[name] for name in speed_symbols(joint)]
        if not has_quaternion(joint):
            rates |= dict(zip(q, v, strict=True))
            continue
        e, s, w = sympy.Matrix(q[-4:-1]), q[-1], sympy.Matrix(v[-3:])
        if joint.kind == "free":
            # R v by the quaternion's sandwich product: v + 2 s e x v + 2 e x (e x v).
            moved = sympy.Matrix(v[:3])
            moved = moved + 2 * s * e.cross(moved) + 2 * e.cross(e.cross(moved))
            rates |= dict(zip(q[:3], moved, strict=True))
        # Half the product of the quaternion with w.
        rates |= dict(zip(q[-4:], [*((s * w + e.cross(w)) / 2), -e.dot(w) / 2], strict=True))
    return rates


def _vector(components: Any, frame: Any) -> Any:
    return sum((x * axis for x, axis in zip(components, frame, strict=True)), 0 * frame.x)


class _Model:
    """Frames and points of a description."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.N, self.origin = ReferenceFrame("N"), Point("O")
        self.origin.set_vel(self.N, 0)
        self.g = self.vector(scope.system.gravity, self.N)
        self.named = {body.name: body for body in scope.system.bodies}
        self.placed: dict[str, Placed] = {"world": (self.N, self.origin)}
        self.placed |= {body.name: (self.N, self.origin) for body in scope.system.bodies if body.joint is None}
        for body in scope.bodies:
            assert body.joint is not None
            self.placed[body.name] = self.across(self.proximal(body.joint), body.joint)

    def vector(self, values: Iterable[sf.Expression | float], frame: Any) -> Any:
        """A SymPy vector from components in a frame."""
        return _vector(self.scope.vector(values), frame)

    def unit(self, values: Iterable[sf.Expression | float], frame: Any) -> Any:
        """A unit vector along components in a frame."""
        return _vector(self.scope.unit(values), frame)

    def fixed(self, placed: Placed, position: sf.Vector, rotation: sf.Rotation) -> Placed:
        """A frame fixed on another one."""
        A, Ao = placed
        B = ReferenceFrame("F")
        B.orient_explicit(A, self.scope.rotation(rotation))
        return B, self.at(placed, self.vector(position, A)) if any(position) else Ao

    def at(self, placed: Placed, offset: Any) -> Any:
        """A point fixed in a frame."""
        A, Ao = placed
        point = Ao.locatenew("P", offset)
        point.v2pt_theory(Ao, self.N, A)
        return point

    def frame(self, name: str, frame: str | None) -> Placed:
        """A body's frame, or one of its extremity frames."""
        if frame is None:
            return self.placed[name]
        stated = next(item for item in self.named[name].frames if item.name == frame)
        return self.fixed(self.placed[name], stated.position, stated.rotation)

    def proximal(self, joint: sf.Joint) -> Placed:
        """Placement of a joint's proximal frame on its parent."""
        return self.fixed(self.frame(joint.parent, joint.frame), joint.position, joint.rotation)

    def across(self, proximal: Placed, joint: sf.Joint) -> Placed:
        """The distal frame."""
        P, Po = proximal
        if joint.kind == "fixed":
            return proximal
        if has_quaternion(joint):
            return self._by_quaternion(proximal, joint)
        if joint.kind == "general":
            position = self.vector(joint.moving_position, P)
            return self._by_formula(P, joint.moving_rotation), self._moved(proximal, position, position.dt(P))
        names, speeds = coordinate_symbols(joint), speed_symbols(joint)
        for part in series(joint):
            axis = self.unit(part.axis, P)
            q, rate = self.scope.function[names[part.first]], self.scope.rate[speeds[part.first]]
            pitch = {"prismatic": sympy.Integer(1), "screw": self.scope.value(joint.pitch)}.get(part.kind)
            if pitch is not None:
                Po = self._moved((P, Po), pitch * q * axis, pitch * rate * axis)
            if part.kind != "prismatic":
                D = ReferenceFrame("D")
                D.orient_axis(P, axis, q)
                P = D
        return P, Po

    def _moved(self, proximal: Placed, position: Any, velocity: Any) -> Any:
        """A point that moves in the proximal frame."""
        P, Po = proximal
        point = Po.locatenew("D", position)
        point.set_vel(P, velocity)
        point.v1pt_theory(Po, self.N, P)
        return point

    def _by_quaternion(self, proximal: Placed, joint: sf.Joint) -> Placed:
        P, Po = proximal
        q = [self.scope.function[name] for name in coordinate_symbols(joint)]
        v = [self.scope.rate[name] for name in speed_symbols(joint)]
        D = ReferenceFrame("D")
        D.orient_quaternion(P, (q[-1], *q[-4:-1]))
        D.set_ang_vel(P, _vector(v[-3:], D))
        if joint.kind == "ball":
            return D, Po
        return D, self._moved(proximal, _vector(q[:3], P), _vector(v[:3], D))

    def _by_formula(self, P: Any, rotation: sf.Rotation) -> Any:
        if rotation.kind in ("matrix", "quaternion"):
            D = ReferenceFrame("D")
            D.orient_explicit(P, self.scope.rotation(rotation))
            return D
        for axis, angle in turns(rotation):
            D = ReferenceFrame("D")
            D.orient_axis(P, self.unit(axis, P), self.scope.value(angle))
            P = D
        return P

    def bodies(self) -> tuple[list[Any], list[Any]]:
        """Everything with inertia that moves, and what rests."""
        moving: list[Any] = []
        resting: list[Any] = []
        for body in self.scope.system.bodies:
            if body.inertia is None:
                continue
            B, _ = self.placed[body.name]
            m, c, J = self.scope.inertia(body.inertia)
            point = self.at(self.placed[body.name], _vector(c, B))
            dyadic = inertia(B, J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[1, 2], J[0, 2])
            solid = RigidBody(body.name, point, B, m, (dyadic, point))
            (resting if body.joint is None else moving).append(solid)
        for joint in self.scope.joints:
            for rotor in joint.rotors:
                moving += self._rotor(joint, rotor)
        return moving, resting

    def _rotor(self, joint: sf.Joint, rotor: sf.Rotor) -> list[Any]:
        """A spinning body, and one that takes away what the carrier's inertia already has of it, locked."""
        B, point = self.placed[rotor.carrier or joint.parent]
        if rotor.axis is None:
            P, _ = self.proximal(joint)
            axis = self.unit(joint.axis, P).express(B)
        else:
            axis = self.unit(rotor.axis, B)
        about = self.scope.value(rotor.inertia) * outer(axis, axis)
        spinning = ReferenceFrame("R")
        # Its angle does not matter: it is symmetric about the axis.
        spinning.orient_axis(B, axis, 0)
        rate = self.scope.rate[speed_symbols(joint)[rotor.coordinate]]
        spinning.set_ang_vel(B, self.scope.value(rotor.ratio) * rate * axis)
        return [
            RigidBody("rotor", point, spinning, 0, (about, point)),
            RigidBody("locked", point, B, 0, (-about, point)),
        ]

    def loads(self) -> list[tuple[Any, Any]]:
        """(point, force) and (frame, torque) of the loads on bodies."""
        loads = []
        for body in self.scope.bodies:
            for load in body.loads:
                B, point = self.frame(body.name, load.at if load.at not in ("body", "center_of_mass") else None)
                if load.at == "center_of_mass":
                    assert body.inertia is not None
                    point = self.at(self.placed[body.name], self.vector(body.inertia.center_of_mass, B))
                axes = self.N if load.axes == "world" else B
                loads += [(point, self.vector(load.force, axes)), (B, self.vector(load.torque, axes))]
        return loads

    def _ends(self, connection: sf.Connection) -> tuple[Any, Any, Any]:
        """Points of both ends, and the line between them."""
        one, two = (self.frame(*anchor)[1] for anchor in (connection.first, connection.second))
        return one, two, two.pos_from(one)

    def pulls(self) -> list[tuple[Any, Any]]:
        """(point, force) of the connections."""
        forces = []
        for connection in self.scope.system.springs:
            one, two, d = self._ends(connection)
            k, c, rest = (self.scope.value(x) for x in (connection.stiffness, connection.damping, connection.length))
            v = two.vel(self.N) - one.vel(self.N)
            force = k * d + c * v
            if rest != 0:
                length = sympy.sqrt(d.dot(d))
                force = (k * (length - rest) + c * v.dot(d) / length) / length * d
            forces += [(one, force), (two, -force)]
        return forces

    def pull_energy(self) -> Any:
        """Potential energy of the connections' springs."""
        total = sympy.Integer(0)
        for connection in self.scope.system.springs:
            d = self._ends(connection)[2]
            stretch = sympy.sqrt(d.dot(d)) - self.scope.value(connection.length)
            total += self.scope.value(connection.stiffness) * stretch**2 / 2
        return total
