"""What a request states of a model's state by name: parameters, first coordinates and speeds, laws of inputs."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

import symofros as sf
from symofros.base.arrays import Array
from symofros.base.names import speed_of
from symofros.errors import UnknownNameError, did_you_mean
from symofros.simulation.analysis.kinematics.starts import closed_start
from symofros.studio.editor.jobs.request import Json, number_of


class StatedStart(NamedTuple):
    """A first state on the constraints.

    Attributes:
        q: Configuration (nq).
        v: Speeds (nv).
        par: Run-time parameters (npar).
        notes: What was stated and changed in its last digits.
    """

    q: Array
    v: Array
    par: Array
    notes: tuple[str, ...]


def stated_start(model: sf.Model, options: Json) -> StatedStart:
    """The first state that a request states by `q0`, `v0` and `parameters`; what it leaves out is the model's own.

    Raises:
        UnknownNameError: A name that the model does not have.
        AssemblyError: The loops can't be closed there.
    """
    par = values_of(model.names.par, options.get("parameters"), model.parameter_values, "parameter")
    q = values_of(model.names.q, options.get("q0"), model.neutral(), "coordinate")
    v = values_of(model.names.v, options.get("v0"), np.zeros(model.nv), "speed")
    stated = [speed_of(str(name), model.names.q) for name in options.get("q0") or {}]
    moved = [speed_of(str(name), model.names.v) for name in options.get("v0") or {}]
    start = closed_start(model, q, v, stated, moved, par=par)
    return StatedStart(start.q, start.v, par, start.notes)


def values_of(names: tuple[str, ...], given: Any, default: Any, what: str) -> Array:
    """Values by name over defaults; a speed may bear its coordinate's d."""
    values = np.array(default, dtype=np.float64)
    for name, number in (given or {}).items():
        plain = speed_of(str(name), names)
        if not plain:
            raise UnknownNameError(
                f"no {what} '{name}'", ", ".join(names[:12]), f"a {what} of the model", did_you_mean(name, names)
            )
        values[names.index(plain)] = number_of(number, name)
    return values


def laws_of(given: Any) -> dict[str, str | float]:
    """Laws of inputs by name: numbers, and formulas of t, coordinates, speeds and parameters; empty ones left out."""
    stated = {str(name): text for name, text in (given or {}).items() if text not in ("", None)}
    return {name: float(text) if isinstance(text, int | float) else str(text) for name, text in stated.items()}


def whole_of(given: Any, low: int, high: int, default: int) -> int:
    """A whole number within bounds; the default where it is none."""
    return max(low, min(high, given)) if type(given) is int else default
