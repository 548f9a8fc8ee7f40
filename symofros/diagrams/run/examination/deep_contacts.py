"""Notes where contacts of a diagram's mechanisms got beyond their geometry, whichever way it ran."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.simulation.results.examination.state_notes import deep_contact_notes


def contact_notes(resolved: Resolved, par: Array, t: Array, q: Array, v: Array) -> list[str]:
    """At most one note a mechanism; those with prescribed motions, which are signals here, are not looked at.

    Args:
        resolved: Diagram that ran.
        par: Its run-time parameters (npar); contacts of which events change parameters are not looked at.
        t: Recorded times (n).
        q: States (n, nq).
        v: Speeds (n, nv).
    """
    layout, models = resolved.layout, resolved.wired.models
    notes: list[str] = []
    for name, place in layout.q.items():
        mechanism = resolved.pieces[name].block.mechanism()
        record = models.record(mechanism)
        if not record.contact_names or record.driven or name in layout.kept:
            continue
        model = models.contacts(mechanism)
        moved = (np.ascontiguousarray(x[:, at.slice]) for x, at in ((q, place), (v, layout.v[name])))
        states = (t, *moved, np.zeros((len(t), model.nu)))
        notes += deep_contact_notes(model, states, layout.parameters_of(name, mechanism, par), f"{name}.")
    return notes
