"""Units of formulas, by those of the parameters and inputs in them, against those that the entries have.

A stiffness [N m/rad] that is stated as "m*L" of m [kg] and L [m] is no stiffness. Units are optional, so that only what
follows from stated ones is judged: a name without a unit, or a number, which may stand for a quantity (2700*b^2 of a
width b) or convert a unit that is not SI (0.001*L of L in mm), leave a product's unit open. An angle's unit is 1 here,
and a degree pi/180.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from symofros.base.names import TIME, symbol_of
from symofros.base.units import NAMES, parse
from symofros.description.beams.beam import STATION
from symofros.description.system import System
from symofros.errors import DescriptionError, Problem
from symofros.expr.expression import CONSTANTS, Expression
from symofros.mechanics.topology.coordinates import (
    coordinate_symbols,
    joint_units,
    rate_keys,
    rate_symbols,
    speed_keys,
    speed_symbols,
)
from symofros.mechanics.topology.formulas import stated_values

_BASE = ("kg", "m", "s", "A", "K", "mol", "cd")


class Measure(NamedTuple):
    """Powers of kg, m, s, A, K, mol and cd, and how much of that a number of 1 is: 0.001 of a length in mm.

    `numbers` is the product of the numbers among its factors, which leave it open; None where there are none.
    """

    powers: tuple[Fraction, ...]
    scale: float = 1.0
    numbers: float | None = None

    @property
    def unconverted(self) -> Measure | None:
        """The measure itself, without its numbers where those do not convert its scale to SI; None where they may."""
        if self.numbers is None:
            return self
        if self.scale == 1.0 or not math.isfinite(self.numbers) or self.numbers == 0.0:
            return None
        size = math.log(abs(self.numbers))
        return Measure(self.powers, self.scale) if abs(size) < abs(size - math.log(self.scale)) else None


_ONE = Measure((Fraction(0),) * len(_BASE))
_RATIOS = ("sign", "atan2")


class _Clash(Exception):
    """Terms, or an argument, of units that do not go together."""


def unit_problems(system: System) -> Iterator[Problem]:
    """Units that are none, and formulas whose unit is not that of their entry.

    Args:
        system: The description; names that it does not declare are passed over.
    """
    known: dict[str, Measure | None] = {}
    declared = [("parameter", item.name, item.unit) for item in system.parameters]
    declared += [("input", item.name, item.unit) for item in system.inputs]
    for kind, name, unit in declared:
        try:
            known[symbol_of(name)] = _measure(unit) if unit else None
        except DescriptionError as error:
            where, fault = system.origin.get((kind, name), ""), error.problem
            yield Problem(f"{kind} '{name}': no such unit", fault.found, fault.rule, fault.remedy, where)
    known |= {name: _number(value) for name, value in CONSTANTS.items()}
    known |= {TIME: _parsed("s"), STATION: _parsed("m"), "xi": _ONE} | _motion_units(system)
    if not any(known.get(symbol_of(name)) for _, name, _ in declared):
        return
    for stated in stated_values(system):
        if not stated.units or not isinstance(stated.value, Expression) or stated.value.kind == "number":
            continue
        wanted = {_parsed(unit) for unit in stated.units}
        where = system.origin.get(stated.key, "")
        rule = f"its unit is {' or '.join(stated.units)}"
        try:
            actual = _unit_of(stated.value, known)
        except _Clash as clash:
            yield Problem(f"{stated.what}: units do not go together", f"'{stated.value}'", str(clash), _REMEDY, where)
            continue
        actual = _judged(actual, {unit.powers for unit in wanted if unit is not None})
        if actual is not None and None not in wanted and actual not in wanted:
            remedy = _REMEDY
            if Measure(actual.powers) in wanted:
                rule += ", and nothing is converted"
                remedy = f"write {actual.scale:.12g}*({stated.value}), or state values and units in SI"
            yield Problem(f"{stated.what}: unit {shown(actual)}", f"'{stated.value}'", rule, remedy, where)


_REMEDY = "change the formula, or the unit of a parameter in it; a parameter without a unit fits everywhere"


def _motion_units(system: System) -> dict[str, Measure | None]:
    """Units of coordinates, of speeds, and of prescribed rates."""
    known: dict[str, Measure | None] = {}
    rates: dict[str, Measure | None] = {}
    for joint in (body.joint for body in system.bodies if body.joint is not None):
        units = joint_units(joint)
        known |= {name: _parsed(unit) for name, unit in zip(coordinate_symbols(joint), units, strict=True)}
        if joint.traits.quasi_velocities:
            continue
        of_order = [("/s", speed_symbols(joint)), ("/s", speed_keys(joint))]
        of_order += [("/s^2", rate_symbols(joint)), ("/s^2", rate_keys(joint))] if joint.prescribed else []
        for per, names in of_order:
            rates |= {name: _parsed(f"{unit}{per}") for name, unit in zip(names, units, strict=True) if unit}
    return rates | known


def _parsed(text: str) -> Measure | None:
    """The measure of a unit; None where the text is none, as of entries without one."""
    try:
        return _measure(text) if text else None
    except DescriptionError:
        return None


def _measure(text: str) -> Measure:
    """The measure of a unit.

    Raises:
        DescriptionError: The text names no unit.
    """
    unit = parse(text)
    return _scaled(tuple(map(Fraction, unit.powers[: len(_BASE)])), unit.scale)


def _scaled(powers: tuple[Fraction, ...], scale: float, numbers: float | None = None) -> Measure:
    """A measure whose scale is without rounding, so that equal ones compare equal."""
    return Measure(powers, float(f"{scale:.12g}"), numbers)


def shown(measure: Measure) -> str:
    """A unit for people: the name of its dimension where it has one, or else powers of the base units."""
    powers = measure.powers
    if measure.scale != 1.0:
        named = (name for name in NAMES if _parsed(name) == measure)
        return next(named, f"{measure.scale:.6g} {shown(Measure(powers))}".removesuffix(" 1"))
    for name in ("N", "J", "W", "Pa"):
        if tuple(map(Fraction, NAMES[name].powers[: len(_BASE)])) == powers:
            return {"J": "N m", "W": "N m/s", "Pa": "N/m^2"}.get(name, name)

    def text(name: str, power: Fraction) -> str:
        return name if power == 1 else f"{name}^{power}"

    over = [text(name, power) for name, power in zip(_BASE, powers, strict=True) if power > 0]
    under = [text(name, -power) for name, power in zip(_BASE, powers, strict=True) if power < 0]
    # What follows a slash divides.
    return (" ".join(over) or "1") + (f"/{' '.join(under)}" if under else "")


def _unit_of(formula: Expression, known: Mapping[str, Measure | None]) -> Measure | None:
    """The measure of a formula, None where it is open.

    Raises:
        _Clash: Dimensions of terms or of an argument that disagree, as a text.
    """
    kind = formula.kind
    if kind == "number":
        return _number(formula.number)
    if kind == "symbol":
        return known.get(formula.name)
    args = [_unit_of(argument, known) for argument in formula.args]
    if kind in ("neg", "abs"):
        return args[0]
    if kind in ("add", "sub", "min", "max"):
        return _common(formula, args)
    if kind in ("mul", "div"):
        left, right = args
        if left is None or right is None:
            return None
        sign = 1 if kind == "mul" else -1
        powers = tuple(a + sign * b for a, b in zip(left.powers, right.powers, strict=True))
        return _scaled(powers, left.scale * right.scale**sign, _product(left.numbers, right.numbers, sign))
    if kind == "pow" or kind == "sqrt":
        return _power(formula, args[0])
    if kind in _RATIOS:
        _common(formula, args)
        return _ONE
    for argument, unit in zip(formula.args, args, strict=True):
        unit = _judged(unit, {_ONE.powers})
        if unit is not None and unit != _ONE:
            raise _Clash(f"the argument of {kind} is a ratio or an angle; '{argument}' is in {shown(unit)}")
    return _ONE


def _power(formula: Expression, base: Measure | None) -> Measure | None:
    """The measure of a power or square root."""
    exponent = 0.5 if formula.kind == "sqrt" else None
    if formula.kind == "pow" and formula.args[1].kind == "number":
        exponent = formula.args[1].number
    if base is None or (exponent is None and base != _ONE):
        return None
    power = Fraction(exponent or 0.0).limit_denominator(60)
    numbers = None if base.numbers is None else _product(1.0, abs(base.numbers), float(power))
    return _scaled(tuple(power * a for a in base.powers), base.scale ** float(power), numbers)


def _number(value: float) -> Measure:
    return Measure(_ONE.powers, 1.0, value)


def _product(left: float | None, right: float | None, power: float) -> float | None:
    """The numbers of left times right to a power, NaN where they have no product; None where there are none."""
    if left is None and right is None:
        return None
    try:
        return math.prod((1.0 if left is None else left, math.pow(1.0 if right is None else right, power)))
    except (ValueError, OverflowError):
        return math.nan


def _judged(unit: Measure | None, powers: Collection[tuple[Fraction, ...]]) -> Measure | None:
    """What is known of a unit: of an open one, that it is not converted, where it has powers that are looked for."""
    if unit is None or (unit.numbers is not None and unit.powers not in powers):
        return None
    return unit.unconverted


def _common(formula: Expression, units: list[Measure | None]) -> Measure | None:
    closed = {unit.powers for unit in units if unit is not None and unit.numbers is None}
    judged = [_judged(unit, closed) for unit in units]
    stated = {unit for unit in judged if unit is not None}
    if len(stated) > 1:
        pairs = zip(formula.args, judged, strict=True)
        parts = [f"'{argument}' in {shown(unit)}" for argument, unit in pairs if unit is not None]
        raise _Clash(f"terms have one unit: {', '.join(parts)}")
    return stated.pop() if stated else next((unit for unit in units if unit is not None and unit.unconverted), None)
