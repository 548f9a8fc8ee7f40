"""Which block of a diagram made a signal that is no finite number."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.run.block_functions import Blocks
from symofros.simulation.results.outcome import Outcome

# Size of a state that makes what is computed of it overflow.
_EXPLODED = 1e100
# Inputs that a message lists, and entries of each.
_LISTED = 3


def fault_at(resolved: Resolved, par: Array, point: tuple[float, Array, Array], held: Array) -> str:
    """The first signal that is not finite at a point of a compiled run, in words; "" where there is none.

    Args:
        resolved: The diagram.
        par: Run-time parameters (npar).
        point: Time, q, v at which functions were evaluated last.
        held: Inputs held between samples (nu).
    """
    blocks = Blocks(resolved, par, (0.0, 0.0), None)
    blocks.t[0], blocks.q[:], blocks.v[:] = point
    for source, place in resolved.layout.held.items():
        blocks.out[source].reshape(-1)[:] = held[place.slice]
    return first_fault(blocks)


def first_fault(blocks: Blocks) -> str:
    """The first signal in order, or rate of a state, that is not finite at the present point; "" where there is none.

    A state that has exploded explains all that is computed of it, so that no block is blamed then.
    """
    if not np.abs(np.concatenate([blocks.q, blocks.v])).max(initial=0.0) < _EXPLODED:
        return ""
    resolved, t = blocks.resolved, float(blocks.t[0])
    with np.errstate(all="ignore"):
        blocks.signals()
        for name, port in resolved.order:
            value = _not_finite(blocks.out[name, port])
            if value is not None:
                held = resolved.pieces[name].is_discrete or resolved.pieces[name].is_external
                when = f"before t = {t:.6g} s" if held else f"at t = {t:.6g} s"
                return f"block '{name}': output '{port}' is {value} {when}{'' if held else _inputs(blocks, name)}"
        for name, key in resolved.layout.states:
            if (name, "rates") in blocks.calls:
                call, outputs = blocks.calls[name, "rates"]
                call()
                value = _not_finite(outputs.get(f"d_{key}", np.zeros(0)))
                if value is not None:
                    return f"block '{name}': the rate of its state '{key}' is {value} at t = {t:.6g} s"
    return ""


def _not_finite(values: Array) -> float | None:
    """The first entry that is not finite."""
    bad = values[~np.isfinite(values)]
    return float(bad.flat[0]) if bad.size else None


def _inputs(blocks: Blocks, name: str) -> str:
    """The inputs of a block, in words: ", with x = -0.3"."""
    said = []
    for (block, port), source in blocks.resolved.wired.sources.items():
        if block == name:
            entries = [f"{entry:.4g}" for entry in blocks.out[source].reshape(-1)]
            shown = ", ".join(entries[:_LISTED]) + (", ..." if len(entries) > _LISTED else "")
            said.append(f"{port} = {shown}" if blocks.out[source].ndim == 0 else f"{port} = ({shown})")
    return f", with {'; '.join(said[:_LISTED])}" if said else ""


def without_end(t: float, names: Iterable[str], notes: tuple[str, ...]) -> Outcome:
    """The outcome of a run in which crossings of these names bring each other about at one instant."""
    said = ", ".join(dict.fromkeys(names)) or "events"
    reason = f"crossings bring each other about at the same instant without end: {said}"
    advice = "part the levels at which they switch, or sample one of these blocks, so that time passes between"
    return Outcome("interrupted", t, reason, advice, notes)
