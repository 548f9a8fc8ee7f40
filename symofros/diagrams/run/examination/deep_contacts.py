"""Notes where contacts of a diagram's mechanisms got beyond their geometry, whichever way it ran."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.run.examination.prescribed import Signals, prescribed_inputs
from symofros.simulation.results.examination.finer_steps import States
from symofros.simulation.results.examination.state_notes import deep_contact_notes


def contact_notes(resolved: Resolved, par: Array, states: States, signal: Signals) -> tuple[str, ...]:
    """Notes on deep contacts, at most one a mechanism.

    Args:
        resolved: Diagram that ran.
        par: Its run-time parameters at the records (n, npar), or of all (npar).
        states: Records: t (n), q (n, nq), v (n, nv).
        signal: Signal at the records (n, *shape) of an output: where motions are prescribed, bodies are there.
    """
    layout, models, (t, q, v) = resolved.layout, resolved.wired.models, states[:3]
    notes: list[str] = []
    for name, place in layout.q.items():
        mechanism = resolved.pieces[name].block.mechanism()
        if not models.record(mechanism).contact_names:
            continue
        model = models.contacts(mechanism)
        moved = (np.ascontiguousarray(x[:, at.slice]) for x, at in ((q, place), (v, layout.v[name])))
        u = prescribed_inputs(resolved, name, len(t), signal)
        own = layout.parameters_of(name, mechanism, par)
        notes += deep_contact_notes(model, (t, *moved, u), own, f"{name}.")
    return tuple(notes)
