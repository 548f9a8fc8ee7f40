"""Which block of a diagram made a signal that is no finite number."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.conditional import unconditional
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.lowered_block import Piece
from symofros.diagrams.run.block_functions import Blocks
from symofros.diagrams.run.recording import Records
from symofros.diagrams.wiring import Source
from symofros.expr import needed_nodes
from symofros.simulation.results.outcome import Outcome

# Size of a state that makes what is computed of it overflow.
_EXPLODED = 1e100
# Inputs that a message lists, and entries of each.
_LISTED = 3
# Operations of finite numbers whose results may be none, beside quotients.
_LEAVES = frozenset(("pow", "sqrt", "exp", "log", "tan", "asin", "acos", "sinh", "cosh"))
# Records that are looked at together.
_ROWS = 4096


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


def signals_of(records: Records) -> Callable[[slice], Iterator[tuple[Source, Array]]]:
    """Rows -> outputs of a compiled run, and their signals there: those that may leave the numbers where no state does.

    These are outputs of samples, which are recorded, and those of operations that may leave their domain, by NumPy.
    """
    compiled, held = records.compiled, records.compiled.resolved.layout.held
    pieces, order = compiled.resolved.pieces, compiled.resolved.order
    computed = [one for one in order if one not in held and _may_leave(pieces[one[0]], one[1])]

    def values(rows: slice) -> Iterator[tuple[Source, Array]]:
        found = records.evaluated(computed, compiled.signals(computed, by_numpy=True), rows) if computed else {}
        for source in order:
            if source in held:
                yield source, records.u[rows, held[source].slice]
            elif source in found:
                yield source, found[source]

    return values


def _may_leave(piece: Piece, port: str) -> bool:
    """Whether an operation that may leave its domain gives an output; functions of models are left out."""
    if port not in piece.outputs or hasattr(unconditional(piece.block), "model"):
        return False
    g = piece.g
    nodes = needed_nodes(g, piece.outputs[port].flat)
    return any(g.op[node] in _LEAVES or (g.op[node] == "div" and g.number(g.args[node][1]) is None) for node in nodes)


def signal_notes(t: Array, values: Callable[[slice], Iterable[tuple[Source, Array]]]) -> tuple[str, ...]:
    """The note on a signal that is not finite at a record of a run which went on; at most one.

    A state shows it where it reads the signal; limits, tables and comparisons take it for a number.

    Args:
        t: Times of the records (n) [s].
        values: Rows -> outputs in order, and their signals there.
    """
    for first in range(0, len(t), _ROWS):
        for (name, port), signal in values(slice(first, first + _ROWS)):
            bad = np.flatnonzero(~np.isfinite(signal.reshape(len(signal), -1)).all(axis=1))
            if len(bad):
                value, at = _not_finite(signal[bad[0]]), float(t[first + bad[0]])
                return (f"block '{name}': output '{port}' is {value} at t = {at:.6g} s, and the run goes on",)
    return ()


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
