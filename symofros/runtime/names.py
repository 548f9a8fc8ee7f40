"""The names of a model's numbers, and values that are given by them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import real_array
from symofros.base.names import coordinate_of, speed_of
from symofros.errors import ShapeError, UnknownNameError, did_you_mean
from symofros.runtime.calls.kernel import Array
from symofros.runtime.record import ModelRecord


@dataclass(frozen=True)
class Names:
    """Names of coordinates, speeds, inputs, parameters, frames, constraints, ..., contacts, states of forces (z)."""

    q: tuple[str, ...]
    v: tuple[str, ...]
    u: tuple[str, ...]
    par: tuple[str, ...]
    frames: tuple[str, ...]
    constraints: tuple[str, ...]
    joints: tuple[str, ...]
    sections: tuple[tuple[str, float], ...]
    prescribed: tuple[str, ...]
    contacts: tuple[str, ...]
    z: tuple[str, ...] = ()

    @classmethod
    def of(cls, record: ModelRecord) -> Names:
        """Names of a compiled model."""
        return cls(
            record.q_names,
            record.v_names,
            record.u_names,
            record.par_names,
            record.frame_names,
            record.constraint_names,
            record.joint_names,
            record.section_names,
            record.prescribed_names,
            record.contact_names,
            record.state_names,
        )


# Argument of functions -> the numbers that it consists of, as people call them.
_GROUPS = {
    "coordinates": ("q", "q0", "q1"),
    "speeds": ("v", "v0", "a", "dq"),
    "inputs": ("u",),
    "run-time parameters": ("par",),
    "constraints": ("lam",),
    "states of forces": ("z", "z0"),
}


def stacked(record: ModelRecord, par: Array, argument: str, values: Mapping[str, Any]) -> Array:
    """Values by name as an array (..., size); what is not named keeps its default.

    Defaults are the neutral configuration, rest, the default inputs, the model's parameters, and multipliers of zero.
    A speed that shares its coordinate's name may bear a d, as in trajectories.

    Args:
        record: Names and defaults.
        par: Values of the run-time parameters (npar).
        argument: Name of the argument that the values are given for.
        values: Name -> number, or array (...); arrays broadcast.

    Raises:
        UnknownNameError: There is no such name.
        ShapeError: A value is not a number or an array of numbers, or the arrays do not broadcast; or the argument has
            no names.
    """
    what = f"model '{record.name}': {argument}"
    kind = next((kind for kind, arguments in _GROUPS.items() if argument in arguments), "")
    names, defaults = {
        "coordinates": (record.q_names, record.q_neutral),
        "speeds": (record.v_names, (0.0,) * len(record.v_names)),
        "inputs": (record.u_names, record.u_default),
        "run-time parameters": (record.par_names, tuple(par.tolist())),
        "constraints": (record.constraint_names, (0.0,) * record.nc),
        "states of forces": (record.state_names, (0.0,) * len(record.state_names)),
        "": ((), ()),
    }[kind]
    if not kind:
        raise ShapeError(f"{what} has no names", repr(values)[:80], f"{argument} is an array", "give an array")
    columns: list[Any] = list(defaults)
    given: set[str] = set()
    for stated, value in values.items():
        name = (speed_of if kind == "speeds" else coordinate_of)(str(stated), names)
        if not name:
            listed = ", ".join(names[:12]) + (", …" if len(names) > 12 else "") or f"no {kind}"
            remedy = did_you_mean(str(stated)[:80], names) or f"name {kind} of the model"
            raise UnknownNameError(f"{what}: no '{str(stated)[:80]}'", listed, f"names are of {kind}", remedy)
        if name in given:
            rule = f"each of the {kind} is named once"
            raise ShapeError(f"{what}: '{name}' is named twice", ", ".join(map(str, values)), rule, "keep one")
        array = real_array(value)
        if array is None:
            actual = f"{type(value).__name__} {value!r:.60}"
            rule = "a value is a number, or an array of numbers"
            raise ShapeError(f"{what}: '{stated}' is not a number", actual, rule, "convert it before")
        given.add(name)
        columns[names.index(name)] = array
    try:
        return np.stack(np.broadcast_arrays(*columns), axis=-1).astype(np.float64) if columns else np.zeros(0)
    except ValueError:
        shapes = ", ".join(f"{name} {np.shape(value)}" for name, value in values.items())
        rule, remedy = "the values of a batch have shapes that broadcast together", "give each the same shape"
        raise ShapeError(f"{what}: values do not broadcast", shapes, rule, remedy) from None
