"""Inputs of many trajectories: those of one, and what differs from one to the next."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from symofros.base.arrays import Array, numeric
from symofros.errors import ShapeError, SymofrosError
from symofros.runtime.model import Model
from symofros.simulation.inputs import InputPlan, Inputs, Signal, plan_inputs

Shape = tuple[int, ...]


@dataclass(frozen=True)
class BatchInputs:
    """Inputs of a batch.

    Attributes:
        plan: Inputs of the first trajectory; samples that differ hold those of all, one trajectory after the other.
        constant: (n or 1, nu).
        strides: For each signal, the numbers between the samples of one trajectory and those of the next; 0: one for
            all.
    """

    plan: InputPlan
    constant: Array
    strides: tuple[int, ...]


@dataclass(frozen=True)
class GivenInputs:
    """Inputs as a user gave them, sorted by whether all trajectories share them.

    Attributes:
        first: Inputs of the first trajectory, as `simulate` takes them.
        constants: Index of an input -> its values (...); or, at -1, all inputs (..., nu).
        samples: Index of the signal in a plan -> its values (..., n), one number a time.
    """

    first: Inputs | None
    constants: dict[int, Array]
    samples: dict[int, Array]

    @property
    def shapes(self) -> list[Shape]:
        """Batch dimensions of all that varies."""
        whole = [values.shape[:-1] if i < 0 else values.shape for i, values in self.constants.items()]
        return [*whole, *(values.shape[:-1] for values in self.samples.values())]

    def spread(self, model: Model, shape: Shape) -> BatchInputs:
        """Expand the inputs to a batch of that shape.

        Raises:
            ShapeError: An array does not fit.
            UnknownNameError: No such input.
        """
        plan, n = plan_inputs(model, self.first), int(np.prod(shape))
        constant = np.tile(plan.constant, (n if self.constants else 1, 1))
        for i, values in self.constants.items():
            if i < 0:
                constant[:] = np.broadcast_to(values, (*shape, model.nu)).reshape(n, model.nu)
            else:
                constant[:, i] = np.broadcast_to(values, shape).reshape(n)
        signals, strides = list(plan.signals), [0] * len(plan.signals)
        for k, values in self.samples.items():
            index, t, _, linear = signals[k]
            flat = np.ascontiguousarray(np.broadcast_to(values, (*shape, len(t))).reshape(n, len(t)))
            signals[k], strides[k] = (index, t, flat, linear), len(t)
        return BatchInputs(replace(plan, signals=signals), constant, tuple(strides))


def sort_inputs(model: Model, u: Inputs | None) -> GivenInputs:
    """Sort inputs by whether they vary over a batch.

    Raises:
        ShapeError: An array does not fit.
        SymofrosError: A Python function.
    """
    if isinstance(u, Signal):
        return _whole_signal(u)
    if isinstance(u, Mapping):
        return _by_name(model, u)
    if callable(u):
        raise SymofrosError(
            "simulate_batch: inputs by a Python function",
            repr(u)[:80],
            "a batch steps in C alone",
            "give formulas or Signals, or run sf.simulate for each",
        )
    if u is None:
        return GivenInputs(None, {}, {})
    values = numeric("u", u)
    if values.ndim == 0 or values.shape[-1] != model.nu:
        raise ShapeError(
            f"model '{model.record.name}': u has the wrong shape",
            str(values.shape),
            f"constant inputs have shape (..., {model.nu})",
            "one row a trajectory, or one for all",
        )
    # What is not finite ends its own trajectory, not the batch.
    return GivenInputs(np.nan_to_num(values.reshape(-1, model.nu)[0]) if values.size else None, {-1: values}, {})


def _whole_signal(signal: Signal) -> GivenInputs:
    """A signal of all inputs: (n), (n, nu), or (..., n, nu)."""
    if signal.values.ndim < 3:
        return GivenInputs(signal, {}, {})
    columns = {i: signal.values[..., i] for i in range(signal.values.shape[-1])}
    return GivenInputs(_first(signal), {}, columns)


def _by_name(model: Model, given: Mapping[str, Any]) -> GivenInputs:
    first: dict[str, Any] = {}
    constants: dict[int, Array] = {}
    samples: dict[int, Array] = {}
    n_signals = 0
    for name, value in given.items():
        first[name] = value
        if isinstance(value, Signal):
            if value.values.ndim > 2 and value.values.shape[-1] == 1:
                one = _first(value)
                first[name] = replace(one, values=one.values[:, 0])
                samples[n_signals] = value.values[..., 0]
            n_signals += 1
        elif isinstance(value, np.ndarray) and value.ndim > 0 and value.size and name in model.names.u:
            constants[model.names.u.index(name)] = numeric(f"input '{name}'", value)
            first[name] = float(np.nan_to_num(value.flat[0]))
    return GivenInputs(first, constants, samples)


def _first(signal: Signal) -> Signal:
    """The samples of the first trajectory."""
    return replace(signal, values=signal.values[(0,) * (signal.values.ndim - 2)])
