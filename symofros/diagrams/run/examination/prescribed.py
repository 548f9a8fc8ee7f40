"""Whether what wires prescribe to mechanisms are rotations, and motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.wiring import Source
from symofros.simulation.prescribed_motions import recorded_notes
from symofros.simulation.results.outcome import Outcome
from symofros.simulation.settings import UNIT_TOLERANCE

# Signal at the records (n, *shape) of an output.
Signals = Callable[[Source], Array]


def prescribed_inputs(resolved: Resolved, block: str, n: int, signal: Signals) -> Array:
    """Inputs (n, nu) of a block's mechanism at n records: what wires prescribe; without such motions zeros.

    Efforts, which are no inputs of a mechanism's constraints and contacts, are not asked for.
    """
    wired = resolved.wired
    record, source = wired.models.record(resolved.pieces[block].block.mechanism()), wired.sources.get((block, "u"))
    if record.driven and source is not None:
        return np.ascontiguousarray(signal(source))
    return np.zeros((n, len(record.vectors["u"])))


def judge_prescribed(outcome: Outcome, resolved: Resolved, t: Array, signal: Signals) -> Outcome:
    """The outcome of a run, "input failed" where a wire prescribes a quaternion that is no rotation.

    Positions and speeds that are no one motion are noted (docs/theory/simulation.md, (3e)).

    Args:
        outcome: Outcome of the run.
        resolved: Diagram that ran.
        t: Times of its records (n) [s].
        signal: Signal at the records (n, *shape) of an output.
    """
    if not outcome.ok:
        return outcome
    wired = resolved.wired
    for name, piece in resolved.pieces.items():
        mechanism, source = piece.block.mechanism(), wired.sources.get((name, "u"))
        if not mechanism or source is None:
            continue
        for first in wired.models.record(mechanism).quaternion_inputs:
            lengths = np.linalg.norm(signal(source)[:, first : first + 4], axis=1)
            wrong = np.flatnonzero(~(np.abs(lengths - 1.0) <= UNIT_TOLERANCE))
            if len(wrong):
                row = int(wrong[0])
                return replace(
                    outcome,
                    kind="input failed",
                    t=float(t[row]),
                    reason=f"block '{source[0]}': output '{source[1]}' prescribes to '{name}' a quaternion of length"
                    f" {lengths[row]:.6g} from t = {t[row]:.6g} s on, which is no rotation",
                    advice="divide the quaternion by its length",
                )
        notes = recorded_notes(wired.models.record(mechanism), t, signal(source))
        outcome = replace(outcome, notes=(*outcome.notes, *(f"block '{name}': {note}" for note in notes)))
    return outcome
