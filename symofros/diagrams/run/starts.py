"""The state that a run of a diagram begins with: mechanisms on their constraints, what is stated of them kept."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Part
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
    """

    t: float
    q: Array
    v: Array
    u: Array
    met: Sequence[Met] = ()

    @classmethod
    def of(cls, resolved: Resolved, t0: float, par: Array) -> Start:
        """The first state of a diagram at run-time parameters (npar)."""
        layout = resolved.layout
        q, v = (np.array(values, dtype=np.float64) for values in (layout.q0, layout.v0))
        return cls(t0, q, v, layout.begun(par))


def stated_entries(resolved: Resolved, part: Part) -> tuple[list[int], list[int]]:
    """Indices of the coordinates and of the speeds that the diagram states, in the q and v of all parts."""
    layout, models = resolved.layout, resolved.wired.models
    q: list[int] = []
    v: list[int] = []
    for block, model, _ in _looped(resolved, part):
        record = models.carried(model)
        coordinates, speeds = stated_names(record.q_names, record.v_names, models.setup(model).start)
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
        stated = stated_names(model.names.q, model.names.v, models.setup(name).start)
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
        stated = stated_names(record.q_names, record.v_names, models.setup(name).start)
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
