"""What a functional mock-up unit states of itself, read in a process of its own; and its variables at ports."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from typing import Any

from symofros.base.units import parse as parse_unit
from symofros.blocks.checks import refuse
from symofros.blocks.fmu import fmu_worker
from symofros.description.workers import answer_of
from symofros.diagrams.block import Port
from symofros.errors import DescriptionError, did_you_mean

_TIMEOUT = 60.0  # [s]
_WORD = re.compile(r"\W+", re.ASCII)
# Powers are written without a sign between name and number: "kg.m2".
_BETWEEN = re.compile(r"\s*\.\s*")


@dataclass(frozen=True)
class Variable:
    """A variable of a unit.

    Attributes:
        name: Name.
        causality: "input", "output", "parameter", "local" and the standard's others.
        variability: "continuous", "discrete", "tunable", "fixed", "constant".
        initial: "exact", "approx", "calculated", or None where it is not stated.
        type: "Real", "Float64" and the like.
        unit: As the unit writes it.
        shape: Shape; () of a scalar.
        start: Entries of the start value, where there is one.
    """

    name: str
    causality: str
    variability: str
    initial: str | None
    type: str
    unit: str
    shape: tuple[int, ...]
    start: tuple[float, ...] | None

    @property
    def size(self) -> int:
        """Number of entries."""
        return math.prod(self.shape)


@dataclass(frozen=True)
class UnitDescription:
    """A unit.

    Attributes:
        name: Name of its model.
        author: Who made it, as it states; "" where it states none.
        tool: Program that wrote it, as it states.
        kinds: "co_simulation" and "model_exchange", as far as it offers them.
        variables: Numeric variables by name.
        feeds_through: Whether an output depends on an input at the same instant.
    """

    name: str
    author: str
    tool: str
    kinds: tuple[str, ...]
    variables: Mapping[str, Variable]
    feeds_through: bool


def unit_description(block: str, file: str) -> UnitDescription:
    """What the unit in a file states of itself; none of its code runs.

    Raises:
        DescriptionError: There is no such unit, it can't be read, or FMPy is missing.
    """
    if find_spec("fmpy") is None:
        raise DescriptionError.of_extra(
            f"block '{block}' needs FMPy", "no package fmpy", "units are read and run by FMPy", "fmi"
        )
    try:
        known = os.stat(file)
    except OSError as error:
        raise refuse(block, "no unit to read", f"{file}: {error.strerror}", "file is an FMU", "name its path") from None
    return _read(block, os.path.realpath(file), known.st_mtime_ns, known.st_size)


@lru_cache(64)
def _read(block: str, file: str, _changed: int, _size: int) -> UnitDescription:
    bounds = f"more than {fmu_worker.MEMORY >> 30} GiB"
    answer = answer_of(fmu_worker.__file__, {"describe": file}, _TIMEOUT, bounds)
    if "fault" in answer:
        rule = "file is a functional mock-up unit of FMI 2 or 3"
        raise refuse(block, f"the unit '{os.path.basename(file):.60}' can't be read", answer["fault"], rule, "mend it")
    variables = (_variable(stated) for stated in answer["variables"])
    return UnitDescription(
        str(answer["name"]),
        str(answer["author"]),
        str(answer["tool"]),
        tuple(answer["kinds"]),
        {variable.name: variable for variable in variables},
        bool(answer["feeds_through"]),
    )


def _variable(stated: Mapping[str, Any]) -> Variable:
    start = stated["start"]
    return Variable(
        **{key: stated[key] for key in ("name", "causality", "variability", "initial", "type", "unit")},
        shape=tuple(stated["shape"]),
        start=None if start is None else tuple(start),
    )


@dataclass(frozen=True)
class UnitPort:
    """A port, and the variables that are its entries.

    Attributes:
        port: The port.
        variables: One variable, or scalars one after the other.
    """

    port: Port
    variables: tuple[Variable, ...]


def unit_ports(
    block: str, unit: UnitDescription, direction: str, stated: Mapping[str, str | Sequence[str]] | None
) -> list[UnitPort]:
    """Ports of one direction.

    Args:
        block: Name of the block, for messages.
        unit: The unit.
        direction: "input" or "output".
        stated: Port -> variable, or scalar variables of its entries; None: a port for each variable of that causality.

    Raises:
        DescriptionError: A variable is missing, or can't be at that port; two ports have the same name.
    """
    if stated is None:
        names = [name for name, variable in unit.variables.items() if variable.causality == direction]
        stated = {}
        for name in names:
            port = _WORD.sub("_", name).strip("_") or "_"
            if port in stated:
                both = f"'{stated[port]}' and '{name}'"
                remedy = f"state {direction}s: a port -> its variable"
                raise refuse(block, f"two {direction}s would be port '{port:.40}'", both, "ports differ", remedy)
            stated[port] = name
    return [_port(block, unit, direction, name, given) for name, given in stated.items()]


def _port(block: str, unit: UnitDescription, direction: str, name: str, given: str | Sequence[str]) -> UnitPort:
    variables = tuple(
        known(block, unit, one, f"{direction} '{name:.40}'") for one in ([given] if isinstance(given, str) else given)
    )
    scalars = not isinstance(given, str)
    for variable in variables:
        _check(block, variable, direction, scalars)
    units = tuple(_unit_of(variable) for variable in variables)
    shape = (len(variables),) if scalars else variables[0].shape
    starts = [variable.start or (0.0,) * variable.size for variable in variables]
    default = [x for start in starts for x in start] if direction == "input" else None
    if default is not None and not shape:
        default = default[0]  # type: ignore[assignment]
    same = len(set(units)) == 1
    return UnitPort(Port(name, shape, units[0] if same else "", default, () if same else units), variables)


def _check(block: str, variable: Variable, direction: str, scalar: bool) -> None:
    if scalar and variable.shape:
        rule = "entries of a port are scalars; an array is a port by itself"
        raise refuse(block, f"variable '{variable.name:.60}'", f"shape {variable.shape}", rule, "write its name alone")
    settable = variable.causality == "input" or variable.variability == "tunable"
    if direction == "input" and not settable:
        found = f"causality {variable.causality}, variability {variable.variability}"
        rule = "an input is a variable of that causality, or a tunable parameter"
        raise refuse(block, f"variable '{variable.name:.60}' can't be set", found, rule, "give its value by start")


def known(block: str, unit: UnitDescription, name: str, what: str) -> Variable:
    """A variable of the unit.

    Raises:
        DescriptionError: It has none of that name.
    """
    if name not in unit.variables:
        rule = f"numeric variables of '{unit.name:.60}'"
        remedy = did_you_mean(name, unit.variables) or f"see {', '.join(list(unit.variables)[:8])}"
        raise refuse(block, f"{what}: no variable '{name:.60}'", f"'{name:.60}'", rule, remedy)
    return unit.variables[name]


def _unit_of(variable: Variable) -> str:
    """The unit of a variable as ports write it; "" where it has none that we know."""
    text = _BETWEEN.sub(" ", variable.unit)
    try:
        parse_unit(text)
    except DescriptionError:
        return ""
    return text
