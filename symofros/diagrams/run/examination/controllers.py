"""Runs that a sampled controller drives apart: its output grows from sample to sample, and changes sign as it does."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.wiring import Wired
from symofros.runtime.calls.kernel import Array
from symofros.simulation.results.outcome import Outcome

# Samples before the end that are looked at, and how often the steps are refined there: with steps so fine, what grows
# is not what the method makes of a stiff mode.
WINDOW, FINER = 24, 256
# Growth of the output over half the window from which the loop counts as unstable, and the share of samples at which it
# changes sign: a load that bends a beam, or a law against it, pushes one way.
GROWTH, CHANGES = 10.0, 6

# Repeats the end of the run: (from a time, to a time, period of records, step) -> t (n), q, v, u of its records.
Again = Callable[[float, float, float, float], Sequence[Array] | None]


def blamed(outcome: Outcome, resolved: Resolved, again: Again) -> Outcome:
    """An outcome that names the sampled controller where one drives the motion apart.

    Args:
        outcome: Outcome as of the motion alone.
        resolved: The diagram.
        again: Repeats the end of the run.
    """
    if outcome.kind not in ("diverged", "beyond theory"):
        return outcome
    for name in _controllers(resolved.wired):
        block = resolved.wired.blocks[name]
        period = block.period or 0.0
        states = again(outcome.t - WINDOW * period, outcome.t, period, period / FINER)
        if states is None:
            continue
        grown = max((_growth(values) for values in _outputs(resolved, name, states[3])), default=0.0)
        if grown >= GROWTH:
            reason = (
                f"block '{name}', sampled every {period:g} s, drives the motion apart: within {len(states[0])} samples"
                f" its output grows {grown:.2g} times, back and forth"
            )
            advice = f"lower the gains of '{name}', or sample it more often"
            return replace(outcome, reason=reason, advice=advice, notes=(f"seen as: {outcome.reason}",))
    return outcome


def _controllers(wired: Wired) -> Iterator[str]:
    """Sampled blocks in a loop with a mechanism, those nearest to what it is driven by first."""
    seen: set[str] = set()
    nearest = [source[0] for name in wired.mechanisms() for source in wired.behind(name, ["u"])]
    while nearest:
        name = nearest.pop(0)
        if name in seen or name in wired.mechanisms():
            continue
        seen.add(name)
        if wired.blocks[name].period is not None and _reads_motion(wired, name):
            yield name
        nearest += [source[0] for source in wired.behind(name, (port.name for port in wired.ports[name].inputs))]


def _reads_motion(wired: Wired, name: str) -> bool:
    """Whether the motion of a mechanism gets to a block."""
    seen, open_blocks = set(), [name]
    while open_blocks:
        block = open_blocks.pop()
        if block in wired.mechanisms():
            return True
        if block not in seen:
            seen.add(block)
            inputs = (port.name for port in wired.ports[block].inputs)
            open_blocks += [source[0] for source in wired.behind(block, inputs)]
    return False


def _outputs(resolved: Resolved, name: str, u: Array) -> Iterator[Array]:
    """Each entry of what a block holds between samples, at the records (n)."""
    for (block, _), place in resolved.layout.held.items():
        if block == name:
            yield from u[:, place.slice].T


def _growth(values: Array) -> float:
    """Growth of the amplitude of a signal (n) from half to half; 0 where it does not go back and forth."""
    finite = values[np.isfinite(values)]
    if len(finite) < 3:
        return 0.0
    changes = int(np.count_nonzero(finite[1:] * finite[:-1] < 0.0))
    first, second = (float(np.abs(half).max()) for half in np.split(finite, [len(finite) // 2]))
    if first == 0.0 or changes < max(2, len(finite) // CHANGES):
        return 0.0
    return second / first
