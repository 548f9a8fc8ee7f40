"""A description's numbers in other units of length, mass and time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, cast

import numpy as np

import symofros as sf
from symofros.tools import units_of

from ..mechanics.assembly import assemble
from ..mechanics.geometry import Array

# What a unit is made of, as powers of metre, kilogram and second.
_BASE: Mapping[str, tuple[int, int, int]] = {
    "": (0, 0, 0),
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "m": (1, 0, 0),
    "kg": (0, 1, 0),
    "s": (0, 0, 1),
    "N": (1, 1, -2),
}
# Classes whose entries are of a coordinate, by its number.
_OF_A_COORDINATE = (sf.Spring, sf.Damper, sf.Stop, sf.Friction)
BY_FORMULA = "a formula of coordinates, speeds, inputs or t, whose numbers have units of their own"


@dataclass(frozen=True)
class Units:
    """How many times larger the numbers of another system of units are.

    Attributes:
        length: Factor of lengths; mass: of masses; time: of times.
    """

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    def factor(self, unit: str) -> float:
        """Factor of a number in a unit such as "N m s/rad"."""
        above, _, below = unit.partition("/")
        return self._product(above) / self._product(below)

    def _product(self, text: str) -> float:
        result = 1.0
        for part in text.split():
            name, _, power = part.partition("^")
            L, M, T = _BASE[name]
            result *= (self.length**L * self.mass**M * self.time**T) ** int(power or 1)
        return result


class Rescaled:
    """A description's numbers in other units.

    Args:
        stated: Description.
        units: Units.
    """

    def __init__(self, stated: sf.System, units: Units) -> None:
        self.stated, self.units = stated, units
        self._parameters = stated.parameter_values()
        self._shifts: dict[str, list[bool]] = {}
        for mover in assemble(stated).movers:
            self._shifts.setdefault(mover.joint.name, []).extend(_translations(mover.kind, mover.part.speeds))

    def system(self) -> sf.System:
        """The description; parameters are left out.

        Raises:
            ValueError: It has numbers whose units are not known; the message says which.
        """
        given = {
            name: self.of(getattr(self.stated, name), name)
            for name in ("bodies", "connections", "constraints", "switches")
        }
        return replace(
            self.stated, parameters=(), gravity=self._entry(sf.System, "gravity", self.stated.gravity, []), **given
        )

    def of(self, item: Any, name: str, shifts: list[bool] | None = None) -> Any:
        """A part of the description."""
        if isinstance(item, tuple):
            return tuple(self.of(one, name, shifts) for one in item)
        if isinstance(item, sf.Joint):
            shifts = self._shifts.get(item.name, [])
        if isinstance(item, _OF_A_COORDINATE):
            shifts = (shifts or [])[item.coordinate :][:1]
        if not is_dataclass(item) or isinstance(item, type) or name in ("rotation", "moving_rotation", "limits"):
            return item
        changed = {
            one.name: self._entry(type(item), one.name, getattr(item, one.name), shifts or []) for one in fields(item)
        }
        if isinstance(item, sf.Contact):
            changed["stiffness"] = (
                self._number(item.stiffness) * self.units.factor("N") / self.units.length**item.exponent
            )
        return replace(cast(Any, item), **changed)

    def _entry(self, noun: type, name: str, value: Any, shifts: list[bool]) -> Any:
        units = units_of(noun, name)
        if not units or isinstance(value, bool):
            if isinstance(value, sf.Joint | sf.Inertia) or (isinstance(value, tuple) and any(map(is_dataclass, value))):
                return self.of(value, name, shifts)
            return self._plain(value)
        if len(units) == 1 or not _any(value):
            return self._scaled(value, self.units.factor(units[0]))
        if name == "effort":
            each = zip(value, shifts, strict=True)
            return tuple(self._number(one) * self.units.factor(units[shift]) for one, shift in each)
        if len(set(shifts)) != 1:
            raise ValueError(f"entry '{name}' of a joint that turns and shifts")
        return self._scaled(value, self.units.factor(units[shifts[0]]))

    def _scaled(self, value: Any, factor: float) -> Any:
        if isinstance(value, tuple):
            return tuple(self._scaled(one, factor) for one in value)
        return value if value is None else self._number(value) * factor

    def _plain(self, value: Any) -> Any:
        """An entry without a unit: formulas of parameters as numbers."""
        if isinstance(value, sf.Rotation):
            return sf.Rotation(value.kind, tuple(map(self._number, value.values)))
        if isinstance(value, tuple) and value and not any(isinstance(one, str | tuple) or one is None for one in value):
            return tuple(map(self._number, value))
        return (
            value
            if isinstance(value, str | tuple | bool | int)
            or value is None
            or is_dataclass(value)
            and not hasattr(value, "symbols")
            else self._number(value)
        )

    def _number(self, value: Any) -> float:
        numbers = numbers_of((value,), self._parameters)
        if numbers is None:
            raise ValueError(f"{value}: {BY_FORMULA}")
        return float(numbers[0])


def _translations(kind: str, speeds: int) -> list[bool]:
    """Which speeds of a simple joint are of translations."""
    return [True] * 3 + [False] * 3 if kind == "free" else [kind == "prismatic"] * speeds


def _any(value: Any) -> bool:
    """Whether an entry states anything but zeros."""
    return any(map(_any, value)) if isinstance(value, tuple) else value is not None and value != 0.0


def numbers_of(values: Any, parameters: Mapping[str, float]) -> Array | None:
    """Values at the parameters' (n); None where one is a formula of anything else."""
    if any(x.symbols() - parameters.keys() for x in values if not isinstance(x, int | float)):
        return None
    return np.array([sf.evaluate(x, parameters) for x in values], dtype=float)
