"""The description's own formulas of efforts, evaluated by NumPy: what Q must be, without the generator."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import symofros as sf

from ..contract.interface import States, Subject, Unsupported
from ..contract.quantities import FORCES_STATED
from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array
from ..mechanics.parts import coordinate_symbols, input_symbol, rate_symbols, rates_by_coordinate, speed_symbols

NAME = "description"

_NUMPY: Mapping[str, Callable[..., Any]] = {
    "add": np.add,
    "sub": np.subtract,
    "mul": np.multiply,
    "div": np.divide,
    "pow": np.power,
    "neg": np.negative,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "sinh": np.sinh,
    "cosh": np.cosh,
    "tanh": np.tanh,
    "abs": np.abs,
    "sign": np.sign,
    "min": np.minimum,
    "max": np.maximum,
}


@dataclass(frozen=True)
class StatedForces:
    """Q = formulas + S u: each effort is the power factor of its own speed, actuated joints add their inputs."""

    system: sf.System
    assembly: Assembly
    name: str = NAME
    version: str = sf.__version__
    capabilities: frozenset[str] = FORCES_STATED

    def generalized_force(self, states: States) -> Array:
        """Q (N, nv)."""
        values = self.values(states)
        Q = np.zeros_like(states.v)
        motor = len(self.system.inputs)
        for described in self.assembly.free_joints:
            joint, start = described.joint, described.v.start
            for i, effort in enumerate(joint.effort):
                Q[:, start + i] += evaluate(effort, values)
            for element in joint.elements:
                k = element.coordinate
                x = states.q[:, described.q.start + k] if k < described.q.stop - described.q.start else 0.0
                Q[:, start + k] += element_force(element, x, states.v[:, start + k], values)
            if joint.actuated:
                size = described.v.stop - start
                Q[:, described.v] += states.u[:, motor : motor + size]
                motor += size
        return Q + self._by_power(values, Q.shape)

    def stored_energy(self, states: States) -> Array:
        """The energy of joints' springs and stops (N,) [J]."""
        values, total = self.values(states), np.zeros(len(states))
        for described in self.assembly.free_joints:
            for element in described.joint.elements:
                if isinstance(element, sf.Spring | sf.Stop):
                    total += element_energy(element, states.q[:, described.q.start + element.coordinate], values)
        return total

    def values(self, states: States) -> dict[str, Any]:
        """What formulas' symbols stand for, one value a state."""
        values: dict[str, Any] = {"pi": np.pi, "t": 0.0, **self.system.parameter_values()}
        values |= {input_symbol(item.name): states.u[:, i] for i, item in enumerate(self.system.inputs)}
        for described in self.assembly.free_joints:
            for names in (speed_symbols(described.joint), rates_by_coordinate(described.joint)[0]):
                values |= dict(zip(names, states.v[:, described.v].T, strict=True))
        for described in self.assembly.free_joints:  # Rather than the rate of another joint, if both have one name.
            values |= dict(zip(coordinate_symbols(described.joint), states.q[:, described.q].T, strict=True))
        motion = len(self.system.inputs) + self.assembly.motors
        for joint in self.assembly.driven_joints:
            q, (v, a) = coordinate_symbols(joint), rates_by_coordinate(joint)
            plain, others = (*q, *speed_symbols(joint), *rate_symbols(joint)), (*q, *v, *a)
            for names in zip(plain, others, strict=True):
                values |= dict.fromkeys(names, states.u[:, motion])
                motion += 1
        return values

    def _by_power(self, values: Mapping[str, Any], shape: tuple[int, ...]) -> Array:
        """Forces stated by their virtual power, each on the speed it names."""
        speeds = [name for described in self.assembly.free_joints for name in speed_symbols(described.joint)]
        Q = np.zeros(shape)
        for power in self.system.virtual_power:
            for speed, formula in power.forces:
                Q[:, speeds.index(speed)] += evaluate(formula, values)
        return Q


def element_force(element: Any, x: Any, v: Array, values: Mapping[str, Any]) -> Array:
    """What a spring, damper, stop or friction does to its own speed, from its definition."""

    def number(name: str) -> Any:
        return evaluate(getattr(element, name), values)

    if isinstance(element, sf.Spring):
        stretch = x - number("rest")
        return np.asarray(-number("stiffness") * stretch - number("cubic") * stretch**3)
    if isinstance(element, sf.Damper):
        return np.asarray(-number("coefficient") * v - number("quadratic") * v * np.abs(v))
    if isinstance(element, sf.Stop):
        force = np.zeros_like(v)
        for limit, side in (("upper", 1.0), ("lower", -1.0)):
            if getattr(element, limit) is not None:
                beyond = np.maximum(side * (x - number(limit)), 0.0)
                inward = np.where(beyond > 0.0, np.maximum(side * v, 0.0), 0.0)
                force -= side * (number("stiffness") * beyond + number("damping") * inward)
        return force
    factor = np.maximum(number("factor"), 0.0)
    return np.asarray(-factor * _dry_friction(element, v, number) - number("viscous") * v)


def _dry_friction(element: sf.Friction, v: Array, number: Callable[[str], Any]) -> Array:
    """Size of dry friction with the sign of v: one formula up to the peak, one beyond."""
    slow, dynamic = number("minimum_velocity"), number("dynamic")
    peak, static, wide = 1.875 * slow, dynamic, 10.0 * slow
    if element.static is not None:
        static = number("static")
    if element.stribeck_velocity is not None:
        wide = number("stribeck_velocity")
        peak = np.minimum(peak, 1.5 * wide)
    x, drop = v / peak, static - dynamic
    rising = static * x * (15 - 10 * x**2 + 3 * x**4) / 8 - drop * (peak / wide) ** 2 * x * (1 - x**2) ** 2 / 4
    with np.errstate(under="ignore"):
        falling = np.sign(v) * (dynamic + drop * np.exp(-(((np.abs(v) - peak) / wide) ** 2)))
    return np.asarray(np.where(np.abs(v) < peak, rising, falling))


def element_energy(element: sf.Spring | sf.Stop, x: Array, values: Mapping[str, Any]) -> Array:
    """What a spring or stop stores, from its definition."""
    if isinstance(element, sf.Spring):
        stretch = x - evaluate(element.rest, values)
        stiffness, cubic = evaluate(element.stiffness, values), evaluate(element.cubic, values)
        return np.asarray(stiffness * stretch**2 / 2 + cubic * stretch**4 / 4)
    energy = np.zeros_like(x)
    for limit, side in ((element.upper, 1.0), (element.lower, -1.0)):
        if limit is not None:
            beyond = np.maximum(side * (x - evaluate(limit, values)), 0.0)
            energy += evaluate(element.stiffness, values) * beyond**2 / 2
    return energy


def evaluate(
    formula: sf.Expression | float, values: Mapping[str, Any], rules: Mapping[str, Callable[..., Any]] = _NUMPY
) -> Any:
    """The value of a formula where symbols are arrays, or what the rules of its operations take."""
    if not isinstance(formula, sf.Expression):
        return formula
    if formula.kind == "number":
        return formula.number
    if formula.kind == "symbol":
        return values[formula.name]
    return rules[formula.kind](*(evaluate(arg, values, rules) for arg in formula.args))


def build(subject: Subject) -> StatedForces | Unsupported:
    """Forces as the description alone states them; Unsupported where they need kinematics or derivatives."""
    kinds = {
        "loads": any(body.loads for body in subject.system.bodies),
        "connections": subject.system.connections,
        "potentials": subject.system.potentials,
        "beams": bool(subject.system.beams),
    }
    beyond = [name for name, stated in kinds.items() if stated]
    if beyond:
        return Unsupported(f"{' and '.join(beyond)}: their forces take kinematics or derivatives, not formulas alone")
    return StatedForces(subject.system, subject.assembly)
