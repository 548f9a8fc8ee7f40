"""A description in SymPy: its symbols, its values, and which of them is which entry of q, v and u."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy
from sympy.physics.mechanics import dynamicsymbols

import symofros as sf

from ..mechanics.parts import coordinate_symbols, has_quaternion, input_symbol, rates_by_coordinate, speed_symbols

TIME = dynamicsymbols._t
# Functions that SymPy spells otherwise.
_NAMES = {"abs": "Abs", "min": "Min", "max": "Max"}


class NotDerivable(Exception):
    """The oracle has no equations for something in the description."""


@dataclass(frozen=True)
class Derived:
    """A model as SymPy derived it.

    Attributes:
        q: Symbols of the coordinates, in order; v of the speeds, u of the inputs.
        symbols: name -> symbol of the parameters and of t.
        shorts: Symbol -> what it is short for, in inputs and the other symbols.
        quaternions: Indices in q at which quaternions start.
        values: The entries (row by row) of each function, by its name.
    """

    q: tuple[Any, ...]
    v: tuple[Any, ...]
    u: tuple[Any, ...]
    symbols: Mapping[str, Any]
    shorts: Mapping[Any, Any]
    quaternions: tuple[int, ...]
    values: Mapping[str, Sequence[Any]]


class Scope:
    """What the names of a description stand for.

    Args:
        system: The description.

    Raises:
        NotDerivable: A prescribed motion has quaternions, or there are beams or constraints.

    Attributes:
        bodies: Bodies with a joint, depth first in the order of description.
        joints: Joints that move.
        free: Names of the coordinates that are not prescribed.
        speeds: Names of their speeds in formulas.
        motors: Speed -> the input of its actuator.
        function: Coordinate -> function of time.
        rate: Speed, as formulas call it -> the derivative of a coordinate, or a function of time of its own.
    """

    def __init__(self, system: sf.System) -> None:
        self.system = system
        if system.constraints:
            raise NotDerivable(f"constraint '{system.constraints[0].name}': the oracle has no multipliers")
        if system.contacts:
            raise NotDerivable(f"contact '{system.contacts[0].name}': the oracle has no surfaces")
        self.bodies = list(self._carried_by(None))
        joints = [body.joint for body in self.bodies if body.joint is not None and body.joint.kind != "fixed"]
        self.joints = tuple(joints)
        for joint in joints:
            if joint.prescribed and has_quaternion(joint):
                raise NotDerivable(f"joint '{joint.name}': a prescribed motion with quaternions")
        free = [joint for joint in joints if not joint.prescribed]
        driven = [joint for joint in joints if joint.prescribed]
        self.free = tuple(name for joint in free for name in coordinate_symbols(joint))
        self.speeds = tuple(name for joint in free for name in speed_symbols(joint))
        self.function: dict[str, Any] = {}
        self.rate: dict[str, Any] = {}
        self._plain: dict[Any, Any] = {}
        self._shorts: dict[Any, Any] = {}
        for joint in joints:
            self._add_coordinates(joint)
        self._constant = {item.name: sympy.Dummy(item.name) for item in system.parameters}
        self._constant |= {"t": sympy.Dummy("t")}
        stated = {input_symbol(item.name): sympy.Dummy(item.name) for item in system.inputs}
        self.motors = {name: sympy.Dummy(name) for joint in free if joint.actuated for name in speed_symbols(joint)}
        self._known = {"pi": sympy.pi, **self._constant, **stated, **self.rate, **self.function}
        for joint in joints:
            self._known |= {
                name: self.rate[v] for name, v in zip(rates_by_coordinate(joint)[0], speed_symbols(joint), strict=True)
            }
        self._inputs = [*stated.values(), *self.motors.values()]
        for joint in driven:
            q = [self.function[name] for name in coordinate_symbols(joint)]
            self._inputs += [self._plain[x.diff(TIME, n) if n else x] for n in range(3) for x in q]
            for names in ([f"d{name}" for name in speed_symbols(joint)], rates_by_coordinate(joint)[1]):
                self._known |= {name: x.diff(TIME, 2) for name, x in zip(names, q, strict=True)}

    def _carried_by(self, name: str | None) -> list[sf.RigidBody]:
        """Depth first; None for the ground, which the base is, too."""
        bases = {"world"} | {body.name for body in self.system.bodies if body.joint is None}
        carried: list[sf.RigidBody] = []
        for body in self.system.bodies:
            if body.joint is not None and (body.joint.parent in bases if name is None else body.joint.parent == name):
                if isinstance(body, sf.Beam):
                    raise NotDerivable(f"beam '{body.name}': the oracle knows rigid bodies")
                carried += [body, *self._carried_by(body.name)]
        return carried

    def _add_coordinates(self, joint: sf.Joint) -> None:
        names, speeds = coordinate_symbols(joint), speed_symbols(joint)
        for name in names:
            q = self.function[name] = sympy.Function(f"q{len(self.function)}")(TIME)
            # A second derivative is looked for before the first within it: xreplace works from the outside in.
            for order in (2, 1, 0):
                self._plain[q.diff(TIME, order) if order else q] = sympy.Dummy(f"{'d' * order}{name}")
        for k, speed in enumerate(speeds):
            if has_quaternion(joint):
                self.rate[speed] = sympy.Function(f"v{len(self.rate)}")(TIME)
                self._plain[self.rate[speed]] = sympy.Dummy(speed)
            else:
                self.rate[speed] = self.function[names[k]].diff(TIME)

    def value(self, value: sf.Expression | float) -> Any:
        """A value of the description; a float is the binary fraction that it is."""
        if not isinstance(value, sf.Expression):
            return sympy.Rational(value)
        if value.kind == "number":
            return sympy.Rational(value.number)
        if value.kind == "symbol":
            return self._known[value.name]
        a = [self.value(arg) for arg in value.args]
        simple = {
            "add": lambda: a[0] + a[1],
            "sub": lambda: a[0] - a[1],
            "mul": lambda: a[0] * a[1],
            "div": lambda: a[0] / a[1],
            "pow": lambda: a[0] ** a[1],
            "neg": lambda: -a[0],
        }
        return simple[value.kind]() if value.kind in simple else getattr(sympy, _NAMES.get(value.kind, value.kind))(*a)

    def vector(self, values: Iterable[sf.Expression | float]) -> Any:
        """A column of values."""
        return self._short([self.value(value) for value in values])

    def unit(self, values: Iterable[sf.Expression | float]) -> Any:
        """A column of length one along these values."""
        x = [self.value(value) for value in values]
        return self._short([e / sympy.sqrt(sum(e**2 for e in x)) for e in x])

    def _short(self, entries: Iterable[Any], columns: int = 1) -> Any:
        """A matrix in which whatever does not change with the motion is one symbol: SymPy's work is by terms."""
        listed = [sympy.sympify(x) for x in entries]
        for k, x in enumerate(listed):
            if not x.is_Atom and TIME not in x.free_symbols:
                listed[k] = self._shorts.setdefault(x, sympy.Dummy("c"))
        return sympy.Matrix(len(listed) // columns, columns, listed)

    def rotation(self, rotation: sf.Rotation) -> Any:
        """R_AB."""
        x = [self.value(value) for value in rotation.values]
        if rotation.kind == "matrix":
            return self._short(x, 3)
        if rotation.kind == "quaternion":
            e, n2 = sympy.Matrix(x[:3]), sum(c**2 for c in x)
            return self._short(((x[3] ** 2 - e.dot(e)) * sympy.eye(3) + 2 * e * e.T + 2 * x[3] * skew(e)) / n2, 3)
        R = sympy.eye(3)
        for axis, angle in turns(rotation):
            R = R * turn(self.unit(axis), self.value(angle))
        return self._short(R, 3)

    def inertia(self, inertia: sf.Inertia) -> tuple[Any, Any, Any]:
        """Mass, p_BC, and the inertia matrix about C along the axes of B."""
        m, c = self.value(inertia.mass), self.vector(inertia.center_of_mass)
        xx, yy, zz, xy, xz, yz = (self.value(value) for value in inertia.moments)
        J = sympy.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if inertia.about == "body":
            return m, c, self._short(J + m * skew(c) * skew(c), 3)
        R = self.rotation(inertia.rotation)
        return m, c, self._short(R * J * R.T, 3)

    def derived(self, values: Mapping[str, Any], more: Mapping[Any, Any] | None = None) -> Derived:
        """Expressions in functions of time, as expressions in symbols.

        Args:
            values: Values by function name; lists or matrices.
            more: Further functions of time -> what they stand for.
        """
        quaternions, at = [], 0
        for joint in self.joints:
            at += 0 if joint.prescribed else len(coordinate_symbols(joint))
            quaternions += [at - 4] if has_quaternion(joint) else []
        meanings: dict[Any, Any] = {}
        for meaning, symbol in self._shorts.items():
            meanings[symbol] = meaning.xreplace(meanings)
        rules = self._plain | {key: self._plain[value] for key, value in (more or {}).items()}
        return Derived(
            tuple(self._plain[self.function[name]] for name in self.free),
            tuple(self._plain[self.rate[name]] for name in self.speeds),
            tuple(self._inputs),
            self._constant,
            meanings,
            tuple(quaternions),
            {name: [sympy.sympify(x).xreplace(rules) for x in listed] for name, listed in values.items()},
        )


def turns(rotation: sf.Rotation) -> list[tuple[Any, sf.Expression | float]]:
    """A rotation stated by angles as turns about axes, each in the frame that the one before leads to."""
    if rotation.kind == "axis_angle":
        return [(rotation.values[:3], rotation.values[3])]
    roll, pitch, yaw = rotation.values
    return [((0.0, 0.0, 1.0), yaw), ((0.0, 1.0, 0.0), pitch), ((1.0, 0.0, 0.0), roll)]


def skew(a: Any) -> Any:
    """The matrix of the cross product with a."""
    return sympy.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def turn(n: Any, angle: Any) -> Any:
    """Rodrigues' formula for a unit vector."""
    c, s = sympy.cos(angle), sympy.sin(angle)
    return c * sympy.eye(3) + s * skew(n) + (1 - c) * n * n.T
