"""Stiffness under axial forces and moments that beams of a diagram's mechanisms leave out (docs/theory/beams.md, 6)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from symofros.diagrams.run.examination.examined import Examined
from symofros.diagrams.run.examination.prescribed import Signals, prescribed_inputs
from symofros.diagrams.run.python_blocks import NotKeptError
from symofros.runtime.beams import bending_notes
from symofros.simulation.analysis.beam_theory import amplifying, section_forces_of, turning_of


def loads_left_out(run: Examined, signal: Signals) -> Iterator[str]:
    """Notes on what section forces do in mechanisms without constraints; couplings follow from bending alone."""
    resolved, layout, (t, q, v) = run.energies.resolved, run.layout, run.states[:3]
    models = resolved.wired.models
    for name, place in layout.q.items():
        mechanism = resolved.pieces[name].block.mechanism()
        par = layout.parameters_of(name, mechanism, run.energies.par)
        beams = models.compilation(mechanism).beams(par)
        if models.record(mechanism).nc or not any(beam.omitted and beam.omitted.of_forces for beam in beams):
            continue
        model, rows = models.sections(mechanism), amplifying(q, v)
        with suppress(NotKeptError):
            a = run.accelerations(rows)[:, layout.v[name].slice]
            u = prescribed_inputs(resolved, name, len(t), signal)[rows]
            states = q[rows][:, place.slice], v[rows][:, layout.v[name].slice], a, u
            for beam in beams:
                straight, known = np.zeros(beam.size), section_forces_of(model, beam.name, states, None, t[rows], par)
                bent = states[0][:, beam.in_q]
                largest = beam.bending(bent[np.abs(bent).sum(axis=1).argmax()] if len(bent) else straight)
                # Of the error of the theory there is a note already.
                judged = replace(largest, beam=f"{name}.{beam.name}", error=0.0)
                turning = turning_of(model, beam, (*states[:2], u), par)
                yield from bending_notes([replace(judged, left_out=beam.left_out(straight, *known, turning=turning))])
