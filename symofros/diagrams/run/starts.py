"""The state that a run of a diagram begins with: mechanisms on their constraints, what is stated of them kept."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array, numeric
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Part
from symofros.errors import ShapeError
from symofros.runtime.manifold import at_unit_length
from symofros.simulation.analysis.kinematics.starts import changes, closed_start, stated_names
from symofros.simulation.stepping.met import Met


@dataclass(frozen=True)
class Start:
    """The state that a run begins with, or goes on from.

    Attributes:
        t: Time [s].
        q: Configuration (nq).
        v: Speeds and continuous states (nv).
        u: Inputs, with all that is held between samples (nu).
        met: Events that were met before, of a run that goes on.
        given: Names of the entries that this run states, such as "arm.q1".
    """

    t: float
    q: Array
    v: Array
    u: Array
    met: Sequence[Met] = ()
    given: Collection[str] = ()

    @classmethod
    def of(cls, resolved: Resolved, t0: float, par: Array, starts: Mapping[str, Any] | None = None) -> Start:
        """The first state of a diagram at run-time parameters (npar).

        Args:
            resolved: The diagram.
            t0: Time [s].
            par: Run-time parameters (npar).
            starts: Values by name, in place of the diagram's: as `Layout.start_place` has the names.

        Raises:
            UnknownNameError: There is no such state.
            ShapeError: A value does not fit, or a quaternion is not of unit length.
        """
        layout, given = resolved.layout, list[str]()
        q, v = (np.array(values, dtype=np.float64) for values in (layout.q0, layout.v0))
        vectors = {"q": q, "v": v, "u": layout.begun(par)}
        for name, value in (starts or {}).items():
            group, place = layout.start_place(name)
            array = numeric(f"start '{name}'", value)
            if array.shape not in (place.shape, ()):
                what, found = f"diagram: start '{name}' does not fit", str(array.shape)
                raise ShapeError(what, found, f"of shape {place.shape}", "give it that shape")
            vectors[group][place.slice] = array.reshape(-1)
            given += (
                layout.q_names[place.slice] if group == "q" else layout.v_names[place.slice] if group == "v" else ()
            )
        for block in layout.q if given else ():
            record = resolved.wired.models.carried(resolved.pieces[block].block.mechanism())
            at = layout.q[block].slice
            q[at] = at_unit_length(record, "q", q[at], f"start of '{block}'")
        return cls(t0, q, v, vectors["u"], given=given)

    def labels(self, resolved: Resolved, block: str, model: str) -> list[str]:
        """Names, as its model has them, of the coordinates and speeds of a mechanism that are stated."""
        own = [name.removeprefix(f"{block}.") for name in self.given if name.startswith(f"{block}.")]
        return [*resolved.wired.models.setup(model).start, *own]


def stated_entries(resolved: Resolved, part: Part, begin: Start) -> tuple[list[int], list[int]]:
    """Indices of the coordinates and of the speeds that are stated of a start, in the q and v of all parts."""
    layout, models = resolved.layout, resolved.wired.models
    q: list[int] = []
    v: list[int] = []
    for block, model, _ in _looped(resolved, part):
        record = models.carried(model)
        coordinates, speeds = stated_names(record.q_names, record.v_names, begin.labels(resolved, block, model))
        q += [layout.q[block].start + record.q_names.index(name) for name in coordinates]
        v += [layout.v[block].start + record.v_names.index(name) for name in speeds]
    return q, v


def close_loops(resolved: Resolved, part: Part, begin: Start, par: Array) -> tuple[str, ...]:
    """Move the mechanisms of a part onto their constraints, in place, with their stated starts preserved.

    Those with prescribed motions, or with constraints that engage, stay as they are: their inputs say where they are.

    Returns:
        Notes on stated values that changed in their last digits.

    Raises:
        AssemblyError: No state on the constraints keeps what is stated.
    """
    layout, models, notes = resolved.layout, resolved.wired.models, []
    for block, name, is_driven in _looped(resolved, part):
        if is_driven:
            continue
        model = models.constraints(name)
        q, v = layout.q[block].slice, layout.v[block].slice
        stated = stated_names(model.names.q, model.names.v, begin.labels(resolved, block, name))
        own = layout.parameters_of(block, name, par)
        start = closed_start(model, begin.q[q], begin.v[v], *stated, par=own, t=begin.t)
        begin.q[q], begin.v[v] = start.q, start.v
        notes += [f"model '{name}': {note}" for note in start.notes]
    return tuple(notes)


def changes_of_driven(resolved: Resolved, part: Part, asked: Start, found: Start) -> tuple[str, ...]:
    """Notes on stated starts of mechanisms with prescribed motions that changed in their last digits.

    Raises:
        AssemblyError: More than those changed.
    """
    layout, models, notes = resolved.layout, resolved.wired.models, []
    for block, name, is_driven in _looped(resolved, part):
        if not is_driven:
            continue
        q, v, record = layout.q[block].slice, layout.v[block].slice, models.carried(name)
        stated = stated_names(record.q_names, record.v_names, asked.labels(resolved, block, name))
        ends = (asked.q[q], asked.v[v]), (found.q[q], found.v[v])
        said = changes(name, (record.q_names, record.v_names), stated, *ends)
        notes += [f"model '{name}': {note}" for note in said]
    return tuple(notes)


def _looped(resolved: Resolved, part: Part) -> Iterator[tuple[str, str, bool]]:
    """Blocks of a part whose constraints always hold: name, model, whether motions are prescribed."""
    for name in part.blocks:
        block = resolved.pieces[name].block
        model = block.mechanism()
        record = resolved.wired.models.record(model) if model else None
        if record is not None and record.nc and not block.lock_inputs():
            yield name, model, record.driven > 0
