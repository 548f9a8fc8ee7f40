"""Arguments of a run of a diagram: options, run-time parameters, interval of records."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array, real_array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Place
from symofros.errors import DescriptionError, ParameterError, Problem, SymofrosError, UnknownNameError, did_you_mean
from symofros.runtime.model import Model
from symofros.simulation.options import DIAGRAM_CALL, USUAL, SimulationOptions
from symofros.simulation.settings import Settings, check_pace

# Recorded by default at about so many times.
_RECORDS = 2000


def diagram_options(options: SimulationOptions | None, changes: Mapping[str, Any]) -> SimulationOptions:
    """Options of a run of a diagram, with changes that are given by name.

    Raises:
        UnknownNameError: A name is not that of an option.
        SymofrosError: An option is one of runs of single models, or no pace against the clock.
    """
    chosen = (options or USUAL).changed(changes, DIAGRAM_CALL)
    check_pace(chosen.realtime)
    rule = "a run of a diagram records at an interval, and ends at t_end"
    chosen.refuse(("every", "max_steps"), "diagram: an option of runs of a single model", rule)
    return chosen


def part_settings(options: SimulationOptions, model: Model, t_end: float) -> Settings:
    """Settings of the stepping of one part, whose records and pace are the diagram's.

    Raises:
        SymofrosError: The options contradict each other.
    """
    return Settings.of(model, replace(options, output=None, realtime=False), t_end)


def parameter_values(resolved: Resolved, given: Mapping[str, Any]) -> Array:
    """The run-time parameters, some of them given by name.

    Raises:
        UnknownNameError: There is no such parameter.
        SymofrosError: A value does not fit.
        ParameterError: A block, or the description of a model, refuses its parameters.
    """
    layout = resolved.layout
    par = np.array(layout.par, dtype=np.float64)
    for name, value in given.items():
        array, place = real_array(value), parameter_place(resolved, name)
        if array is None or array.shape not in (place.shape, ()) or not np.all(np.isfinite(array)):
            raise SymofrosError(
                f"diagram: parameter '{name}' does not fit",
                f"{value!r:.80}",
                f"finite, of shape {place.shape}",
                "give it that shape",
            )
        par[place.slice] = np.broadcast_to(array, place.shape).reshape(-1)
    _refuse_values(resolved, {key: place for key, place in layout.parameters.items() if ".".join(key) in given}, par)
    for model in resolved.wired.models.names if given else ():
        resolved.wired.models.check_parameters(model, par[layout.parameters["", model].slice])
    return par


def parameter_place(resolved: Resolved, name: str) -> Place:
    """Where a run-time parameter lies among all, by its name: all of it, or one entry.

    Raises:
        UnknownNameError: There is no such parameter.
    """
    layout = resolved.layout
    settable = layout.par_names[: layout.settable]
    fields = {f"{block}.{key}": place for (block, key), place in layout.parameters.items() if block}
    if name in fields:
        return fields[name]
    if name in settable:
        return Place(settable.index(name), ())
    known = list(dict.fromkeys([*fields, *settable]))
    what, rule = f"diagram: no run-time parameter '{name}'", f"known: {', '.join(known[:12])}"
    raise UnknownNameError(what, f"'{name}'", rule, did_you_mean(name, known))


def _refuse_values(resolved: Resolved, given: Mapping[tuple[str, str], Place], par: Array) -> None:
    """Refuse values that blocks refuse as they are made with them.

    Raises:
        ParameterError: With what blocks say.
    """
    problems: list[Problem] = []
    for name in dict.fromkeys(name for name, _ in given):
        values = {
            key: par[place.slice].reshape(place.shape) if place.shape else float(par[place.start])
            for (of, key), place in given.items()
            if of == name
        }
        try:
            resolved.wired.blocks[name].with_parameters(values)
        except DescriptionError as error:
            problems += error.problems
    if problems:
        raise ParameterError(problems)


def record_interval(record: Any, t0: float, t_end: float, dt: float | None) -> float:
    """Interval of records [s]: the stated one, or a multiple of dt (1 ms without one) for about _RECORDS of them.

    Raises:
        SymofrosError: It is no positive number, or there is no span of time.
    """
    if not (math.isfinite(t0) and math.isfinite(t_end) and t_end > t0):
        raise SymofrosError("diagram: no span of time", f"from {t0} to {t_end}", "t_end after t0", "set t_end")
    if record is None:
        step = dt or 1e-3
        return step * max(1, math.ceil((t_end - t0) / step / _RECORDS))
    if np.ndim(record) or not (math.isfinite(record) and record > 0.0):
        raise SymofrosError("diagram: no interval of recording", f"{record}", "above zero [s]", "leave it out")
    return float(record)
