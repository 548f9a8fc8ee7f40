"""Remarks on the steps of a run of a diagram, compiled or interpreted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.run.examination.energy_balance import energy_note
from symofros.diagrams.run.examination.examined import Examined, whole_note
from symofros.diagrams.run.examination.loads_left_out import loads_left_out
from symofros.diagrams.run.examination.prescribed import Signals, prescribed_inputs
from symofros.diagrams.run.python_blocks import NotKeptError
from symofros.simulation.results.examination.creep import creep_note_at
from symofros.simulation.results.examination.finer_steps import finer_steps_note
from symofros.simulation.stepping.resolution import Resolution

# Share of a mechanism's largest speed that the absolute tolerance may allow as the error of a step, and displacements
# over it that are a motion: as of `sf.simulate`.
_ALLOWED, _MOTION = 0.1, 100.0


def remarks(run: Examined, modes: Resolution, signal: Signals) -> tuple[str, ...]:
    """Notes on the steps of a run, on finer ones or on energy; on joints that creep at its end, and on orders of beams.

    Args:
        run: Run.
        modes: How well its steps resolve the modes at some states.
        signal: Signals at its records.
    """
    if not len(run.layout.v0) or run.steps < 1 or len(run.states[0]) < 2:
        return ()
    return (*_on_steps(run, modes), *_creeping(run, signal), *loads_left_out(run, signal))


def _on_steps(run: Examined, modes: Resolution) -> tuple[str, ...]:
    """The note on finer steps, or on energy, if there is one."""
    worst = modes.worst
    if worst is not None and worst.amplified:
        return ()
    try:
        # No mode at a few states knows of contacts.
        looked_at = worst is None if run.h else _is_loose(run)
        note = (finer_steps_note(run) if looked_at else "") or energy_note(run)
        note = note or (whole_note(run) if worst is None else "")
        return (note,) if note else ()
    except NotKeptError:  # External blocks were called more often than is kept.
        return ()


def _creeping(run: Examined, signal: Signals) -> Iterator[str]:
    """Notes on creep, at most one a mechanism."""
    resolved, layout, (t, q, v) = run.energies.resolved, run.layout, (x[-1] for x in run.states[:3])
    for name, place in layout.q.items():
        mechanism, at = resolved.pieces[name].block.mechanism(), layout.v[name].slice
        if not resolved.wired.models.record(mechanism).friction_speeds:
            continue
        model, par = resolved.wired.models.dynamics(mechanism), layout.parameters_of(name, mechanism, run.energies.par)
        state = (t, q[place.slice], v[at], prescribed_inputs(resolved, name, len(run.states[0]), signal)[-1])

        def acceleration(at: slice = at) -> Array | None:
            with suppress(NotKeptError):
                return run.accelerations(np.array([len(run.states[0]) - 1]))[0, at]
            return None

        note = creep_note_at(model, state, par, acceleration, f"{name}.")
        if note:
            yield note


def _is_loose(run: Examined) -> bool:
    """Whether the absolute tolerance bounds no error of a mechanism that moves."""
    layout, (_, q, v) = run.layout, run.states[:3]
    for name in layout.v:
        fastest = float(np.abs(v[:, layout.v[name].slice]).max(initial=0.0))
        moved = float(np.abs(q - q[0])[:, layout.q[name].slice].max(initial=0.0))
        if run.bounds[1] > _ALLOWED * fastest > 0.0 and moved > _MOTION * run.bounds[1]:
            return True
    return False
