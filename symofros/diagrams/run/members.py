"""What each run of a batch of a diagram is given: run-time parameters, first states, and inputs of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array, numeric
from symofros.diagrams.block import Shape
from symofros.diagrams.inlets import VALUE, Inlet
from symofros.diagrams.program.compiled import CompiledDiagram
from symofros.diagrams.run.starts import Start
from symofros.diagrams.run.values import parameter_place, parameter_values
from symofros.errors import ParameterError, ShapeError, SymofrosError
from symofros.simulation.inputs import Signal


def representative(inputs: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """What is given for inlets, each as of one run: no code depends on which."""
    if inputs is None:
        return None
    one: dict[str, Any] = {}
    for name, value in inputs.items():
        text = isinstance(value, str) or (isinstance(value, (list, tuple)) and any(isinstance(v, str) for v in value))
        if isinstance(value, Signal):
            several = value.values.ndim > 2
            one[name] = replace(value, values=np.zeros(value.values.shape[-2:])) if several else value
        else:
            one[name] = value if text or value is None else 0.0
    return one


@dataclass(frozen=True)
class Varied:
    """Values of one thing in all runs.

    Attributes:
        values: (..., *shape).
        own: Shape of the thing.
    """

    values: Array
    own: Shape

    @classmethod
    def of(cls, what: str, value: Any, own: Shape) -> Varied:
        """Values whose last dimensions are the thing's; a number alone is one for all entries.

        Raises:
            ShapeError: They are not.
        """
        array = numeric(what, value)
        if array.ndim == 0:
            return cls(np.broadcast_to(array, own), own)
        if array.ndim >= len(own) and array.shape[array.ndim - len(own) :] == own:
            return cls(array, own)
        if np.prod(own) == 1:
            return cls(array.reshape((*array.shape, *own)), own)
        shape, remedy = ", ".join(("...", *map(str, own))), "give a value a run, or one for all"
        raise ShapeError(f"run_batch: {what} does not fit", str(array.shape), f"of shape ({shape})", remedy)

    @property
    def batch(self) -> Shape:
        """Batch dimensions."""
        return self.values.shape[: self.values.ndim - len(self.own)]

    def rows(self, shape: Shape) -> Array:
        """Values of each run of a batch of that shape (n, *shape)."""
        return np.broadcast_to(self.values, (*shape, *self.own)).reshape((-1, *self.own))


@dataclass(frozen=True)
class Members:
    """The runs of a batch.

    Attributes:
        compiled: Diagram, with what the first run is given for its inlets.
        t0: Start time [s].
        parameters: Run-time parameter -> its values.
        starts: State -> its first values.
        signals: Inlet -> the signal, and its values (..., n, size).
    """

    compiled: CompiledDiagram
    t0: float
    parameters: Mapping[str, Varied]
    starts: Mapping[str, Varied]
    signals: Mapping[str, tuple[Signal, Varied]]

    @classmethod
    def of(
        cls,
        compiled: CompiledDiagram,
        t0: float,
        parameters: Mapping[str, Any] | None,
        starts: Mapping[str, Any] | None,
        inputs: Mapping[str, Any] | None,
    ) -> Members:
        """Sort what is given.

        Raises:
            UnknownNameError: There is no such parameter or state.
            ShapeError: A value does not fit.
        """
        resolved = compiled.resolved
        layout, varied = resolved.layout, dict[str, tuple[Signal, Varied]]()
        for name, value in (inputs or {}).items():
            inlet = resolved.wired.blocks[name]
            assert isinstance(inlet, Inlet)
            place, what = layout.samples.get((name, VALUE)), f"inlet '{name}'"
            if inlet.formulas or place is None:
                continue
            if isinstance(value, Signal):
                flat = value.values if value.values.ndim > 1 else value.values[:, np.newaxis]
                own = (len(value.t), place.size)
                one_for_all = np.broadcast_to(flat, (*flat.shape[:-1], place.size)) if flat.shape[-1] == 1 else flat
                varied[name] = (value, Varied.of(what, one_for_all, own))
            else:
                of = Varied.of(what, value, place.shape)
                rows = Varied(of.values.reshape((*of.batch, 1, place.size)), (1, place.size))
                varied[name] = (Signal([0.0], np.zeros((1, place.size)), "hold"), rows)
        return cls(
            compiled,
            t0,
            {
                name: Varied.of(f"parameter '{name}'", value, parameter_place(resolved, name).shape)
                for name, value in (parameters or {}).items()
            },
            {
                name: Varied.of(f"start '{name}'", value, layout.start_place(name)[1].shape)
                for name, value in (starts or {}).items()
            },
            varied,
        )

    @cached_property
    def shape(self) -> Shape:
        """Batch dimensions.

        Raises:
            ShapeError: They do not broadcast.
        """
        given = {**self.parameters, **self.starts, **{name: values for name, (_, values) in self.signals.items()}}
        try:
            return np.broadcast_shapes(*(values.batch for values in given.values()))
        except ValueError:
            raise ShapeError(
                "run_batch: batch dimensions do not broadcast",
                ", ".join(f"{name} {values.batch}" for name, values in given.items() if values.batch),
                "all dimensions before those of a value itself broadcast together",
                "give each the same leading dimensions, or none",
            ) from None

    @cached_property
    def par(self) -> Array:
        """Run-time parameters of each run (n, npar).

        Raises:
            ParameterError: A block or a description refuses those of a run.
        """
        rows = {name: values.rows(self.shape) for name, values in self.parameters.items()}
        n = int(np.prod(self.shape))
        if not rows:
            return np.tile(parameter_values(self.compiled.resolved, {}), (n, 1))
        return np.array([self._par(i, {name: values[i] for name, values in rows.items()}) for i in range(n)])

    def _par(self, number: int, given: Mapping[str, Any]) -> Array:
        try:
            return parameter_values(self.compiled.resolved, given)
        except ParameterError as error:
            raise self.naming(number, error) from None

    def naming(self, number: int, error: SymofrosError) -> SymofrosError:
        """An error that says of which run it is, where there are several."""
        if not self.shape:
            return error
        index = list(map(int, np.unravel_index(number, self.shape)))
        return type(error)([replace(one, what=f"run {index}: {one.what}") for one in error.problems])

    @cached_property
    def _starts(self) -> dict[str, Array]:
        return {name: values.rows(self.shape) for name, values in self.starts.items()}

    @cached_property
    def _samples(self) -> dict[str, Array]:
        return {name: values.rows(self.shape) for name, (_, values) in self.signals.items()}

    def begin(self, number: int, compiled: CompiledDiagram) -> Start:
        """The first state of a run of the diagram as `given` has it.

        Raises:
            ShapeError: A quaternion is not of unit length.
        """
        starts = {name: values[number] for name, values in self._starts.items()}
        return Start.of(compiled.resolved, self.t0, self.par[number], starts)

    def given(self, number: int) -> CompiledDiagram:
        """The diagram with what a run is given for its inlets: the same code, other samples."""
        if not self._samples:
            return self.compiled
        resolved = self.compiled.resolved
        signals = {name: replace(self.signals[name][0], values=rows[number]) for name, rows in self._samples.items()}
        blocks: dict[str, Any] = {}
        samples, u0 = {row[0]: row for row in resolved.layout.signals}, list(resolved.layout.u0)
        for name, signal in signals.items():
            place, inlet = resolved.layout.samples[name, VALUE], resolved.wired.blocks[name]
            assert isinstance(inlet, Inlet)
            blocks[name] = replace(inlet, given=signal)
            for k, index in enumerate(place.range):
                column = np.ascontiguousarray(signal.values[:, k])
                samples[index], u0[index] = (index, signal.t, column, signal.kind == "linear"), float(column[0])
        layout = replace(resolved.layout, signals=list(samples.values()), u0=u0)
        wired = replace(resolved.wired, blocks={**resolved.wired.blocks, **blocks})
        pieces = {
            **resolved.pieces,
            **{name: replace(resolved.pieces[name], block=one) for name, one in blocks.items()},
        }
        inputs = {**(resolved.inputs or {}), **signals}
        own = replace(resolved, wired=wired, pieces=pieces, layout=layout, inputs=inputs)
        return replace(self.compiled, resolved=own)
