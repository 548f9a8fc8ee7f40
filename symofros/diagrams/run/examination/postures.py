"""Singular postures that the mechanisms of an interpreted run came close to; a compiled one counts ranks on its way."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.run.examination.examined import Examined
from symofros.diagrams.run.examination.prescribed import Signals, prescribed_inputs
from symofros.simulation.analysis.kinematics.postures import nearest_to_singular, regular_rank
from symofros.simulation.results.examination.constraint_faults import near_singular_notes
from symofros.simulation.results.examination.finer_steps import States

# Records, about, at which the rank is looked for.
_SOME = 16


def posture_notes(run: Examined, signal: Signals) -> list[str]:
    """Notes on postures, at most one a mechanism.

    Where constraints engage or release, their rank changes at any posture: such diagrams are not looked at. Of
    mechanisms with prescribed motions, which are signals here, the records alone are.
    """
    layout, (t, q, v) = run.layout, run.states[:3]
    models, pieces = run.energies.resolved.wired.models, run.energies.resolved.pieces
    notes: list[str] = []
    for name, place in layout.q.items() if not layout.lock_inputs else ():
        mechanism, at = pieces[name].block.mechanism(), layout.v[name].slice
        record = models.record(mechanism)
        if not record.nc or name in layout.kept:
            continue
        model, par = models.constraints(mechanism), layout.parameters_of(name, mechanism, run.energies.par)
        u = prescribed_inputs(run.energies.resolved, name, len(t), signal)

        def states(of: States, place: slice = place.slice, at: slice = at, u: Array = u) -> States:
            return [of[0], of[1][:, place], of[2][:, at], u if of[0] is t else np.zeros((len(of[0]), u.shape[1]))]

        def between(first: int, last: int, driven: bool = record.driven > 0) -> States | None:
            along = None if driven else run.repeat(first, float(t[last]), 0)
            return None if along is None else states(along)

        moved = states((t, q, v))
        some = [x[:: max(1, len(t) // _SOME)] for x in moved]
        (G,) = model.evaluate("constraint_jacobian", q=some[1], u=some[3], par=par, t=some[0])
        notes += near_singular_notes(nearest_to_singular(model, moved, par, regular_rank(G), between))
    return notes
