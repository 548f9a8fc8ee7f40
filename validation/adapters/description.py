"""The description's own formulas of efforts, evaluated by NumPy: what Q must be, without the generator."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import symofros as sf
from validation.assembly import Assembly, Mover, assemble
from validation.geometry import Array
from validation.interface import States, Subject
from validation.quantities import FORCES_STATED

NAME = "description"

_QUATERNION = ("qx", "qy", "qz", "qw")
_COORDINATES = {"ball": _QUATERNION, "free": ("px", "py", "pz", *_QUATERNION)}
_SPEEDS = {"ball": ("wx", "wy", "wz"), "free": ("vx", "vy", "vz", "wx", "wy", "wz")}
_NUMPY: Mapping[str, Callable[..., Any]] = {
    "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "pow": np.power, "neg": np.negative,
    "sqrt": np.sqrt, "exp": np.exp, "log": np.log, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin,
    "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh,
    "abs": np.abs, "sign": np.sign, "min": np.minimum, "max": np.maximum,
}  # fmt: skip


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
        values: dict[str, Any] = {"pi": np.pi, "t": 0.0, **self.system.parameter_values()}
        values |= {item.name: states.u[:, i] for i, item in enumerate(self.system.inputs)}
        for mover in self.assembly.movers:
            values |= dict(_named(mover, states))
        Q = np.zeros_like(states.v)
        motor = len(self.system.inputs)
        for mover in self.assembly.movers:
            for i, effort in enumerate(mover.joint.effort):
                Q[:, mover.v.start + i] += evaluate(effort, values)
            if mover.joint.actuated:
                size = mover.v.stop - mover.v.start
                Q[:, mover.v] += states.u[:, motor : motor + size]
                motor += size
        return Q


def _named(mover: Mover, states: States) -> Iterator[tuple[str, Array]]:
    """What formulas call a joint's coordinates and speeds, and their values."""
    name = mover.joint.name
    if mover.kind not in _COORDINATES:
        yield name, states.q[:, mover.q.start]
        yield f"d{name}", states.v[:, mover.v.start]
        return
    for suffix, column in zip(_COORDINATES[mover.kind], states.q[:, mover.q].T, strict=True):
        yield f"{name}.{suffix}", column
    for suffix, column in zip(_SPEEDS[mover.kind], states.v[:, mover.v].T, strict=True):
        yield f"{name}.{suffix}", column


def evaluate(formula: sf.Expression | float, values: Mapping[str, Any]) -> Any:
    """The value of a formula where symbols are arrays."""
    if not isinstance(formula, sf.Expression):
        return formula
    if formula.kind == "number":
        return formula.number
    if formula.kind == "symbol":
        return values[formula.name]
    return _NUMPY[formula.kind](*(evaluate(arg, values) for arg in formula.args))


def build(subject: Subject) -> StatedForces:
    """From the description alone."""
    return StatedForces(subject.system, assemble(subject.system))
