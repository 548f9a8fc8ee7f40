"""An independent symbolic oracle: SymPy derives the same model from the description by Lagrange's equations.

Rotations, positions and energies are written down with SymPy matrices from the description alone; velocities follow by
differentiating in time, equations by `sympy.physics.mechanics.LagrangesMethod`. Slow, and shares nothing with the
generator's recursion. Both sides are evaluated in extended precision at rational points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

import symofros as sf
from symofros.expr.precise import evaluate_precisely
from validation.parts import coordinate_symbols, series

DIGITS = 50
FUNCTIONS = ("mass_matrix", "bias", "generalized_force", "kinetic_energy", "potential_energy")
_T = dynamicsymbols._t
_NAMES = {"abs": "Abs", "min": "Min", "max": "Max", "sign": "sign"}


class NotDerivable(Exception):
    """The oracle has no equations for something in the description."""


@dataclass(frozen=True)
class Derived:
    """A model by Lagrange's equations.

    Attributes:
        free: Names of the free coordinates.
        driven: Names of the prescribed ones.
        values: M (row by row), h, Q, T, V as SymPy expressions of the symbols below, by function name.
        symbols: name -> plain symbol of every coordinate, speed (d), acceleration (dd), input, parameter and t.
    """

    free: tuple[str, ...]
    driven: tuple[str, ...]
    values: Mapping[str, list[Any]]
    symbols: Mapping[str, Any]


class _Builder:
    def __init__(self, system: sf.System) -> None:
        self.system = system
        joints = [body.joint for body in system.bodies if body.joint is not None]
        self.names = {joint.name: coordinate_symbols(joint) for joint in joints if joint.kind != "fixed"}
        if any(joint.kind in ("ball", "free") for joint in joints):
            raise NotDerivable("quaternion joints have no generalized coordinates")
        self.q = {name: sympy.Function(f"x{i}")(_T) for i, name in enumerate(n for v in self.names.values() for n in v)}
        self.prescribed = {n for joint in joints if joint.prescribed for n in self.names[joint.name]}
        self.scope: dict[str, Any] = {item.name: sympy.Symbol(item.name) for item in system.parameters}
        self.scope |= {item.name: sympy.Symbol(item.name) for item in system.inputs}
        self.scope |= self.q | {f"d{name}": q.diff(_T) for name, q in self.q.items()}
        self.scope |= {"pi": sympy.pi, "t": sympy.Symbol("t_")}
        self.pose: dict[str, tuple[Any, Any]] = {}
        self.w: dict[str, Any] = {}

    def value(self, value: sf.Expression | float) -> Any:
        """A value of the description in SymPy; floats are exact binary fractions."""
        if not isinstance(value, sf.Expression):
            return sympy.Rational(value)
        if value.kind == "number":
            return sympy.Rational(value.number)
        if value.kind == "symbol":
            return self.scope[value.name]
        a = [self.value(arg) for arg in value.args]
        simple = {"add": lambda: a[0] + a[1], "sub": lambda: a[0] - a[1], "mul": lambda: a[0] * a[1],
                  "div": lambda: a[0] / a[1], "pow": lambda: a[0] ** a[1], "neg": lambda: -a[0]}  # fmt: skip
        return simple[value.kind]() if value.kind in simple else getattr(sympy, _NAMES.get(value.kind, value.kind))(*a)

    def vector(self, values: Sequence[sf.Expression | float]) -> Any:
        return sympy.Matrix([self.value(value) for value in values])

    def rotation(self, rotation: sf.Rotation) -> Any:
        x = [self.value(value) for value in rotation.values]
        if rotation.kind == "matrix":
            return sympy.Matrix(3, 3, x)
        if rotation.kind == "rpy":
            axes = [sympy.Matrix([0, 0, 1]), sympy.Matrix([0, 1, 0]), sympy.Matrix([1, 0, 0])]
            return _turn(axes[0], x[2]) * _turn(axes[1], x[1]) * _turn(axes[2], x[0])
        if rotation.kind == "axis_angle":
            return _turn(sympy.Matrix(x[:3]), x[3])
        e = sympy.Matrix(x[:3])
        n2 = sum(c**2 for c in x)
        return ((x[3] ** 2 - e.dot(e)) * sympy.eye(3) + 2 * e * e.T + 2 * x[3] * _skew(e)) / n2

    def body_pose(self, body: sf.RigidBody) -> tuple[Any, Any]:
        """R_WB and p_WB."""
        if body.joint is None:
            return sympy.eye(3), sympy.zeros(3, 1)
        if body.name in self.pose:
            return self.pose[body.name]
        joint = body.joint
        parent = next((b for b in self.system.bodies if b.name == joint.parent), None)
        R, p = self.body_pose(parent) if parent is not None else (sympy.eye(3), sympy.zeros(3, 1))
        if joint.frame is not None and parent is not None:
            frame = next(frame for frame in parent.frames if frame.name == joint.frame)
            R, p = R * self.rotation(frame.rotation), p + R * self.vector(frame.position)
        R, p = R * self.rotation(joint.rotation), p + R * self.vector(joint.position)
        R_PD, p_PD = self.across(joint)
        self.pose[body.name] = (R * R_PD, p + R * p_PD)
        return self.pose[body.name]

    def across(self, joint: sf.Joint) -> tuple[Any, Any]:
        """R_PD and p_PD."""
        if joint.kind == "fixed":
            return sympy.eye(3), sympy.zeros(3, 1)
        if joint.kind == "general":
            return self.rotation(joint.moving_rotation), self.vector(joint.moving_position)
        R, p = sympy.eye(3), sympy.zeros(3, 1)
        names = self.names[joint.name]
        for part in series(joint):
            axis, q = self.vector(part.axis), self.q[names[part.first]]
            unit = axis / sympy.sqrt(axis.dot(axis))
            if part.kind in ("prismatic", "screw"):
                p = p + R * unit * (q if part.kind == "prismatic" else self.value(joint.pitch) * q)
            if part.kind in ("revolute", "screw"):
                R = R * _turn(unit, q)
        return R, p

    def angular(self, body: sf.RigidBody) -> Any:
        """w_WB in B, from R^T R'."""
        if body.name not in self.w:
            R = self.body_pose(body)[0]
            S = R.T * R.diff(_T)
            self.w[body.name] = sympy.Matrix([S[2, 1], S[0, 2], S[1, 0]])
        return self.w[body.name]

    def energies(self) -> tuple[Any, Any]:
        """T and the potential of the weight."""
        T, V = sympy.Integer(0), sympy.Integer(0)
        g = self.vector(self.system.gravity)
        for body in self.system.bodies:
            if body.inertia is None or body.joint is None:
                continue
            R, p = self.body_pose(body)
            m, c = self.value(body.inertia.mass), self.vector(body.inertia.center_of_mass)
            J = self._moments(body.inertia, m, c)
            v, w = (p + R * c).diff(_T), self.angular(body)
            T += m * v.dot(v) / 2 + (w.T * J * w)[0] / 2
            V -= m * g.dot(p + R * c) if R.free_symbols | p.free_symbols | R.atoms(sympy.Function) else 0
        return T + self._spins(), V

    def _moments(self, inertia: sf.Inertia, m: Any, c: Any) -> Any:
        xx, yy, zz, xy, xz, yz = (self.value(value) for value in inertia.moments)
        J = sympy.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if inertia.about == "body":
            return J + m * _skew(c) * _skew(c)
        R = self.rotation(inertia.rotation)
        return R * J * R.T

    def _spins(self) -> Any:
        """Rotors and armatures, by their own kinetic energy."""
        T = sympy.Integer(0)
        for body in self.system.bodies:
            joint = body.joint
            if joint is None:
                continue
            rates = [self.q[name].diff(_T) for name in self.names.get(joint.name, ())]
            T += sum(self.value(joint.armature) * rate**2 / 2 for rate in rates)
            for rotor in joint.rotors:
                carrier = next((b for b in self.system.bodies if b.name == (rotor.carrier or joint.parent)), None)
                if rotor.axis is None:
                    raise NotDerivable("state the rotor's axis for the oracle")
                axis, inertia = self.vector(rotor.axis), self.value(rotor.inertia)
                along = self.angular(carrier).dot(axis) / sympy.sqrt(axis.dot(axis)) if carrier is not None else 0
                spin = self.value(rotor.ratio) * rates[rotor.coordinate]
                T += inertia * ((along + spin) ** 2 - along**2) / 2
        return T

    def forces(self, free: Sequence[str]) -> list[Any]:
        """Q: efforts, elements, virtual power; potentials by their gradient."""
        Q = {name: sympy.Integer(0) for name in free}
        for body in self.system.bodies:
            joint = body.joint
            if joint is None or joint.prescribed:
                continue
            names = self.names.get(joint.name, ())
            for name, effort in zip(names, joint.effort, strict=False):
                Q[name] += self.value(effort)
            for element in joint.elements:
                name = names[element.coordinate]
                Q[name] += self._element(element, self.q[name], self.q[name].diff(_T))
        for power in self.system.virtual_power:
            for speed, force in power.forces:
                Q[speed.removeprefix("d")] += self.value(force)
        for potential in self.system.potentials:
            for name in free:
                Q[name] -= self.value(potential.energy).diff(self.q[name])
        return [Q[name] for name in free]

    def _element(self, element: Any, q: Any, v: Any) -> Any:
        def x(name: str) -> Any:
            return self.value(getattr(element, name))

        if isinstance(element, sf.Spring):
            return -x("stiffness") * (q - x("rest")) - x("cubic") * (q - x("rest")) ** 3
        if isinstance(element, sf.Damper):
            return -x("coefficient") * v - x("quadratic") * v * sympy.Abs(v)
        if isinstance(element, sf.Friction):
            level = x("dynamic")
            if element.static is not None:
                wide = 10 * x("minimum_velocity") if element.stribeck_velocity is None else x("stribeck_velocity")
                level = level + (x("static") - level) * sympy.exp(-((v / wide) ** 2))
            return -level * sympy.tanh(v / x("minimum_velocity")) - x("viscous") * v
        raise NotDerivable(f"no formula for a {type(element).__name__}")


def _skew(a: Any) -> Any:
    return sympy.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def _turn(axis: Any, angle: Any) -> Any:
    """Rodrigues' formula for an axis of any length."""
    n = axis / sympy.sqrt(axis.dot(axis))
    return sympy.eye(3) + sympy.sin(angle) * _skew(n) + (1 - sympy.cos(angle)) * _skew(n) ** 2


def derive(system: sf.System) -> Derived:
    """Lagrange's equations of a description.

    Raises:
        NotDerivable: It has quaternion joints, or forces the oracle does not know.
    """
    builder = _Builder(system)
    free = tuple(name for name in builder.q if name not in builder.prescribed)
    T, V = builder.energies()
    q = [builder.q[name] for name in free]
    lagrange = LagrangesMethod(T - V, q)
    lagrange.form_lagranges_equations()
    stored = sum((builder.value(p.energy) for p in system.potentials), sympy.Integer(0))
    plain = {name: sympy.Symbol(f"q{i}_") for i, name in enumerate(builder.q)}
    values = {
        "mass_matrix": list(lagrange.mass_matrix),
        "bias": list(-lagrange.forcing),
        "generalized_force": builder.forces(free),
        "kinetic_energy": [T],
        "potential_energy": [V + stored],
    }
    symbols = {**{item.name: sympy.Symbol(item.name) for item in (*system.parameters, *system.inputs)},
               "t": sympy.Symbol("t_")}  # fmt: skip
    replacement = []
    for name, function in builder.q.items():
        for order, prefix in ((2, "dd"), (1, "d"), (0, "")):
            symbols[prefix + name] = sympy.Symbol(f"{prefix}{plain[name].name}")
            replacement.append((function.diff(_T, order) if order else function, symbols[prefix + name]))
    replacement.sort(key=lambda pair: -sympy.count_ops(pair[0]) - 10 * len(pair[0].atoms(sympy.Derivative)))
    ordered = [pair for order in (2, 1, 0) for pair in replacement if _order(pair[0]) == order]
    return Derived(free, tuple(sorted(builder.prescribed, key=list(builder.q).index)),
                   {name: [sympy.sympify(e).subs(ordered) for e in listed] for name, listed in values.items()},
                   symbols)  # fmt: skip


def _order(expression: Any) -> int:
    return int(expression.derivative_count) if isinstance(expression, sympy.Derivative) else 0


def compare(system: sf.System, points: int = 2, seed: int = 0) -> dict[str, float]:
    """How many decimal digits the generator and the oracle agree to, by function.

    Args:
        system: With run-time parameters for all that is not a binary fraction, so that no rounding enters.
        points: Rational points to compare at.
        seed: Of the points.
    """
    derived = derive(system)
    program = sf.program_of(system, FUNCTIONS)
    model = sf.compile(system, sf.Options(functions=FUNCTIONS, backend="interpreter"))
    rng = np.random.default_rng(seed)
    worst = dict.fromkeys(FUNCTIONS, float(DIGITS))
    for _ in range(points):
        at = {name: mpmath.mpf(int(rng.integers(-60, 60))) / 64 for name in derived.symbols}
        at |= {item.name: mpmath.mpf(item.value) for item in system.parameters}
        u = [at[name] for name in model.names.u]
        inputs = {"q": [at[n] for n in derived.free], "v": [at[f"d{n}"] for n in derived.free], "u": u,
                  "par": [at[n] for n in model.names.par], "t": [at["t"]]}  # fmt: skip
        for function in program.functions:
            ours = [x for output in evaluate_precisely(program, function, inputs, DIGITS) for x in output]
            theirs = _evaluated(derived, derived.values[function.name], at)
            worst[function.name] = min(worst[function.name], _digits(ours, theirs))
    return worst


def _evaluated(derived: Derived, expressions: list[Any], at: Mapping[str, Any]) -> list[Any]:
    names = list(derived.symbols)
    with mpmath.workdps(DIGITS):
        function = sympy.lambdify([derived.symbols[name] for name in names], expressions, "mpmath")
        return [mpmath.mpf(x) for x in function(*(at[name] for name in names))]


def _digits(ours: Sequence[Any], theirs: Sequence[Any]) -> float:
    with mpmath.workdps(DIGITS):
        scale = max((abs(x) for x in theirs), default=mpmath.mpf(0)) or mpmath.mpf(1)
        error = max((abs(a - b) for a, b in zip(ours, theirs, strict=True)), default=mpmath.mpf(0)) / scale
        return float(DIGITS) if error == 0 else float(-mpmath.log10(error))
