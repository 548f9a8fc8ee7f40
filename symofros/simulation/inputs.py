"""What a user gives as inputs of a simulation, sorted by how it is evaluated."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, wraps
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import CheckedCalls, check_fields
from symofros.base.arrays import Array, numeric, rounding_of
from symofros.base.names import coordinate_of
from symofros.errors import ArgumentError, ShapeError, UnknownNameError, did_you_mean
from symofros.runtime.model import Model, Rate
from symofros.simulation.user_functions import check_called_with, named_function

Indices = npt.NDArray[np.intp]

# Times below this share of a period, or of the shortest time between samples, are zero but for rounding; as in
# native/stepping/state/system.c.
ROUNDED_ZERO = 1e-12


@dataclass(frozen=True)
class Signal(metaclass=CheckedCalls):
    """Samples of an input over time; beyond its ends the first and last value hold.

    Attributes:
        t: Times (n), increasing [s].
        values: (n), or (n, nu) where one signal gives every input; (..., n, nu) for the trajectories of a batch.
        kind: "linear" between samples, or "hold" each until the next.
    """

    t: Any
    values: Any
    kind: Literal["linear", "hold"] = "linear"

    def __post_init__(self) -> None:
        """Samples must be numbers in the order of time."""
        check_fields(self)
        t, values = numeric("signal: t", self.t), numeric("signal: values", self.values)
        if t.ndim == 1 and len(t) > 1:  # Instants are the same within a share of themselves, which zero has none of.
            t = np.where(np.abs(t) < ROUNDED_ZERO * np.abs(np.diff(t)).min(), 0.0, t)
        object.__setattr__(self, "t", np.ascontiguousarray(t))
        object.__setattr__(self, "values", np.ascontiguousarray(values))
        times = values.shape[0 if values.ndim == 1 else -2] if values.ndim else 0
        if t.ndim != 1 or not len(t) or times != len(t):
            found, remedy = f"t {t.shape}, values {values.shape}", "give one row of values for each time"
        elif not np.all(np.isfinite(t)) or not np.all(np.isfinite(values)):
            name, bad = ("values", values) if np.all(np.isfinite(t)) else ("t", t)
            at = tuple(map(int, np.argwhere(~np.isfinite(bad))[0]))
            found, remedy = f"{bad[at]} in {name} at {at}", "mend the samples, or leave them out"
        elif not np.all(np.diff(t) > 0):
            i = int(np.argmin(np.diff(t) > 0))
            found, remedy = f"t[{i}] = {t[i]:.12g}, then {t[i + 1]:.12g}", "sort the samples, drop repeated times"
        else:
            return
        rule = "t (n) increases, values are (n), (n, nu) or (..., n, nu), all finite"
        raise ShapeError("signal: not samples over time", found, rule, remedy)


def held_samples(times: Array, t: Array, end: Array | float = math.inf) -> Indices:
    """Numbers of the samples that count at times t where samples are held (docs/theory/simulation.md, section 1).

    Args:
        times: Instants at which samples begin (n), increasing [s].
        t: Times (...) [s].
        end: Where the steps under way end [s]: samples that begin there, or later, do not count yet.
    """
    bound = np.minimum(t + rounding_of(t), end - np.where(np.isfinite(end), rounding_of(end), 0.0))
    return np.maximum(np.searchsorted(times, bound, side="right") - 1, 0)


def held_sample(times: Array, t: float, end: float = math.inf) -> int:
    """Number of the sample that counts at a time t: as `held_samples`."""
    return int(held_samples(times, np.asarray(t), end))


Callback = Callable[[float, Array, Array], Any]
Inputs = Mapping[str, Any] | Signal | Callback | Any


@dataclass(frozen=True)
class InputPlan:
    """Inputs by how they are evaluated: constants, samples, compiled formulas, or a Python function for all.

    Attributes:
        constant: (nu); what nothing else gives.
        signals: (index, times, values, whether linear).
        formulas: Index of the input -> formula.
        callback: (t, q, v) -> u (nu); nothing else counts then.
    """

    constant: Array
    signals: list[tuple[int, Array, Array, bool]] = field(default_factory=list)
    formulas: dict[int, Any] = field(default_factory=dict)
    callback: Callback | None = None

    @cached_property
    def jumps(self) -> Array:
        """Instants at which a held signal changes, in order [s]."""
        held = [t[1:][np.diff(values) != 0] for _, t, values, linear in self.signals if not linear]
        return np.unique(np.concatenate(held)) if held else np.zeros(0)

    def next_corner(self, t: float, end: float) -> float:
        """Time up to which linear signals stay near their chords in a step from t: a corner, or `end` [s].

        For solvers that evaluate at the ends of steps only: between two of them no input leaves the chord by more than
        a share of what it changes by (docs/theory/simulation.md, section 1, rule 4).
        """
        for _, times, values, linear in self.signals:
            if linear:
                end = _straight_until(times, values, t, end)
        return end


# Departure from a chord, as a share of what the signal changes by along it, up to which its lines count as straight.
_STRAIGHT = 0.1


def _straight_until(times: Array, values: Array, t: float, end: float) -> float:
    """The last corner of a signal's lines (n) up to which they stay near their chord from t on, or `end` [s]."""
    first = int(np.searchsorted(times, t + rounding_of(t), side="right"))
    after = int(np.searchsorted(times, end, side="left"))
    start, last = float(np.interp(t, times, values)), float(np.interp(end, times, values))

    def is_straight(k: int) -> bool:
        """Whether corners before number k, or before `end`, lie near the chord that leads there."""
        until, value = (end, last) if k == after else (float(times[k]), float(values[k]))
        between = values[first:k]
        chord = start + (value - start) * (times[first:k] - t) / (until - t)
        lowest, highest = min(start, value, between.min()), max(start, value, between.max())
        return bool(np.abs(between - chord).max() <= _STRAIGHT * (highest - lowest))

    if first >= after or is_straight(after):
        return end
    straight, bent = first, after  # The line up to the first corner is straight.
    while bent - straight > 1:
        middle = (straight + bent) // 2
        straight, bent = (middle, bent) if is_straight(middle) else (straight, middle)
    return float(times[straight])


def plan_inputs(model: Model, u: Inputs | None) -> InputPlan:
    """Sort a user's inputs.

    Args:
        model: Names them.
        u: None (zeros), an array (nu), a Signal of all, a function (t, q, v) -> (nu), or a mapping from names to
            numbers, formula texts and Signals.

    Raises:
        ShapeError: An array does not fit.
        UnknownNameError: No such input.
        ArgumentError: A function takes other arguments.
    """
    names = model.names.u
    constant = np.array(model.record.u_default, dtype=np.float64)
    if u is None:
        return InputPlan(constant)
    if isinstance(u, Signal):
        return _signal_of_all(model, u, constant)
    if isinstance(u, Mapping):
        return _by_name(model, u, constant)
    if callable(u):
        check_called_with(f"model '{model.record.name}': the function of inputs", u, "t", "q", "v")
        return InputPlan(constant, callback=u if model.carried is model else _of_stated(u, model.nq, model.nv))
    array = numeric("u", u)
    if array.shape == (len(names),):
        for name, value in zip(names, array, strict=True):
            _refuse_infinite(name, float(value))
    else:
        raise ShapeError(
            f"model '{model.record.name}': u has the wrong shape",
            str(array.shape),
            f"constant inputs have shape ({len(names)},)",
            "give a Signal or a function for inputs that vary: " + (", ".join(names[:8]) or "there are none"),
        )
    return InputPlan(array)


def _of_stated(u: Callback, nq: int, nv: int) -> Callback:
    """A function of the coordinates and speeds alone, where states of forces are carried behind them."""
    return wraps(u)(lambda t, q, v: u(t, q[:nq], v[:nv]))  # Messages name the user's.


def _signal_of_all(model: Model, signal: Signal, constant: Array) -> InputPlan:
    values = signal.values if signal.values.ndim > 1 else signal.values[:, np.newaxis]
    if values.shape[1:] != constant.shape:
        raise ShapeError(
            f"model '{model.record.name}': a signal of all inputs has the wrong shape",
            str(signal.values.shape),
            f"values are (n, {len(constant)})",
            "give u={'name': Signal(...)} for single inputs",
        )
    columns = [np.ascontiguousarray(values[:, i]) for i in range(values.shape[1])]
    linear = signal.kind == "linear"
    return InputPlan(constant, [(i, signal.t, column, linear) for i, column in enumerate(columns)])


def _by_name(model: Model, given: Mapping[str, Any], constant: Array) -> InputPlan:
    plan = InputPlan(constant)
    names = model.names.u
    given = {coordinate_of(str(stated), names) or stated: value for stated, value in given.items()}
    for name, value in given.items():
        if name not in names:
            raise UnknownNameError(
                f"model '{model.record.name}': no input '{name}'",
                ", ".join(names[:12]) or "none",
                "inputs are listed in model.names.u",
                did_you_mean(name, names) or "declare it in the description",
            )
        i = names.index(name)
        if isinstance(value, Signal):
            if value.values.ndim != 1:
                raise ShapeError(
                    f"input '{name}': a signal of several inputs",
                    str(value.values.shape),
                    "one input takes values (n)",
                    "pick a column",
                )
            plan.signals.append((i, value.t, value.values, value.kind == "linear"))
        elif isinstance(value, (int, float, np.floating)):
            _refuse_infinite(name, float(value))
            plan.constant[i] = value
        elif callable(value):
            rule = "a function gives all inputs at once; one input takes a number, a formula text or a Signal"
            remedy = f"u=lambda t, q, v: [...], of {', '.join(names[:8])}"
            raise ArgumentError(f"input '{name}' is a function", named_function(value), rule, remedy)
        else:
            plan.formulas[i] = value
    _complete_motions(model, given, plan)
    return plan


def _refuse_infinite(name: str, value: float) -> None:
    if not np.isfinite(value):
        raise ShapeError(
            f"input '{name}' is not a finite number", str(value), "constant inputs are finite", "mend its value"
        )


def _complete_motions(model: Model, given: Mapping[str, Any], plan: InputPlan) -> None:
    """The rates of prescribed motions: of numbers zero, of formulas of t their derivatives; of samples, asked for.

    A motion whose speeds did not belong to its places would be silently wrong.
    """
    names = model.names.u
    driven = names[len(names) - model.record.driven :]
    for name in driven:
        if name not in given or f"d{name}" not in driven or f"d{name}" in given:
            continue
        value = given[name]
        if isinstance(value, (int, float, np.floating)):
            continue
        if isinstance(value, Signal):
            raise UnknownNameError(
                f"model '{model.record.name}': input '{name}' prescribes a motion without its speeds",
                "a Signal",
                f"samples of '{name}' say nothing of 'd{name}' between them",
                f"give 'd{name}' as well, or a formula",
            )
        plan.formulas[names.index(f"d{name}")] = Rate(value, 1)
        if f"dd{name}" in driven and f"dd{name}" not in given:
            plan.formulas[names.index(f"dd{name}")] = Rate(value, 2)
