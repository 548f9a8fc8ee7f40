"""Remarks on the steps of a run of a diagram, compiled or interpreted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.run.examination.energy_balance import Accelerations, Energies, energy_note
from symofros.diagrams.run.examination.step_check import Repeat, States, step_note
from symofros.diagrams.run.python_blocks import NotKeptError
from symofros.simulation.stepping.resolution import Resolution

# Share of a mechanism's largest speed that the absolute tolerance may allow as the error of a step, and displacements
# over it that are a motion: as of `sf.simulate`.
_ALLOWED, _MOTION = 0.1, 100.0


@dataclass(frozen=True)
class Examined:
    """A run that has come to its end.

    Attributes:
        energies: Energies of its mechanisms.
        states: Records of the run: t (n), q (n, nq), v (n, nv), u (n, nu).
        h: Step [s]; 0: it adapts.
        atol: Absolute bound of the local error of adaptive steps.
        steps: Number of steps.
        repeat: Makes a part of the run once more, from a record to a time, as it was or with finer steps.
        accelerations: Accelerations at records.
    """

    energies: Energies
    states: States
    h: float
    atol: float
    steps: int
    repeat: Repeat
    accelerations: Accelerations


def remarks(run: Examined, modes: Resolution) -> tuple[str, ...]:
    """Notes on the steps of a run: on finer ones, or on energy.

    Args:
        run: Run.
        modes: How well its steps resolve the modes at some states.
    """
    layout, states, worst = run.energies.resolved.layout, run.states, modes.worst
    if not layout.v or run.steps < 1 or len(states[0]) < 2 or (worst is not None and worst.amplified):
        return ()
    try:
        note = ""
        # No mode at a few states knows of contacts.
        if worst is None if run.h > 0.0 else _is_loose(run):
            external = _answers(run.energies.resolved)
            note = step_note(layout, states, run.repeat, run.h, run.steps, external=external)
        adaptive = run.h == 0.0
        note = note or energy_note(run.energies, states, run.steps, run.accelerations, run.repeat, adaptive=adaptive)
        return (note,) if note else ()
    except NotKeptError:  # External blocks were called more often than is kept.
        return ()


def _answers(resolved: Resolved) -> str:
    """The first external block that answers to the motion: one with inputs and outputs; "" where there is none."""
    wired = resolved.wired
    listening = {block for block, _ in wired.sources}
    external = (name for name, piece in resolved.pieces.items() if piece.is_external and wired.ports[name].outputs)
    return next((name for name in external if name in listening), "")


def _is_loose(run: Examined) -> bool:
    """Whether the absolute tolerance bounds no error of a mechanism that moves."""
    layout, (_, q, v) = run.energies.resolved.layout, run.states[:3]
    for name in layout.v:
        fastest = float(np.abs(v[:, layout.v[name].slice]).max(initial=0.0))
        moved = float(np.abs(q - q[0])[:, layout.q[name].slice].max(initial=0.0))
        if run.atol > _ALLOWED * fastest > 0.0 and moved > _MOTION * run.atol:
            return True
    return False
