"""What a run of a diagram has met: crossings of its blocks, events of its mechanisms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import CompiledDiagram
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.lowered_block import watched
from symofros.diagrams.run.recording import Crossed, Records
from symofros.simulation.results.acted import found_event
from symofros.simulation.results.trajectory import Found
from symofros.simulation.stepping.met import Done, Met


def crossings_of(compiled: CompiledDiagram, met: Sequence[Met]) -> tuple[Crossed, ...]:
    """The crossings of blocks among what was met, in the order of time."""
    looked_for = watched(compiled.resolved.pieces)
    return tuple(Crossed(*looked_for[one.which], one.t) for one in met if one.which < len(looked_for))


def events_of(compiled: CompiledDiagram, met: Sequence[Met], par: Array) -> Mapping[str, tuple[Found, ...]]:
    """Block -> the events of its mechanism among what was met, as `sf.simulate` tells them; of each that has some.

    Args:
        compiled: The diagram.
        met: What its parts met.
        par: Run-time parameters of the run (npar).
    """
    found: dict[str, list[Found]] = {}
    for part in compiled.resolved.layout.parts:
        switching = compiled.resolved.switching(part)
        if switching is None:
            continue
        found |= {name: [] for name in part.blocks if compiled.resolved.pieces[name].switching is not None}
        for one in met:
            owner = switching.owner(one.which)
            if owner is not None:
                found[owner.block].append(_found(compiled, part, owner.block, owner.number, one, par))
    return {name: tuple(events) for name, events in found.items()}


def acted_at(met: Sequence[Met]) -> Array:
    """Instants at which events have changed how mechanisms move (k) [s], in order."""
    return np.unique([one.t for one in met if one.acted])


def _found(compiled: CompiledDiagram, part: Part, block: str, number: int, met: Met, par: Array) -> Found:
    """An event of a mechanism, in the mechanism's own numbers."""
    resolved = compiled.resolved
    layout, switching, model = (
        resolved.layout,
        resolved.pieces[block].switching,
        resolved.wired.blocks[block].mechanism(),
    )
    assert switching is not None
    q, v = (
        slice(at.start - of.start, at.start - of.start + at.size)
        for at, of in ((layout.q[block], part.q), (layout.v[block], part.v))
    )
    own = Met(number, met.t, met.q[q], met.v[v])
    if met.done is not None:
        done = met.done
        before, after = (layout.parameters_of(block, model, values) for values in (done.par, done.par_set))
        u = _inputs(compiled, block, met, par)
        speeds, q_after = (done.v_set[v], done.v_after[v]), done.q_after[q]
        kept = Done(done.status, done.gap, done.in_sequence, u, *speeds, q_after, before, after)
        own = own._replace(done=kept)
    return found_event(switching.events[number], compiled.impacts(model), own)


def _inputs(compiled: CompiledDiagram, block: str, met: Met, par: Array) -> Array:
    """The inputs of a block's mechanism at an event (nu)."""
    wired = compiled.resolved.wired
    source = wired.sources.get((block, "u"))
    if source is None or met.done is None:
        return np.array(wired.models.record(wired.blocks[block].mechanism()).u_default)
    t, q, v, u = (array[np.newaxis] for array in (np.array(met.t), met.q, met.v, met.done.u))
    return np.array(Records(compiled, t, q, v, u, par)[".".join(source)][0]).reshape(-1)
