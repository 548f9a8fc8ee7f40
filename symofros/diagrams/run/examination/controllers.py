"""Runs that a sampled controller drives apart: its output grows from sample to sample, and changes sign as it does.

Feedback of any motion that grows does that, too. So the end of the run is made once more with the output held: only
where the growth then is gone, or half as fast at most, is it the controller's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.program.layout import Place
from symofros.diagrams.wiring import Wired
from symofros.simulation.results.outcome import Outcome

# Samples before the end that are looked at, and how often the steps are refined there: with steps so fine, what grows
# is not what the method makes of a stiff mode.
WINDOW, FINER = 24, 256
# Growth of the output, and of the motion, over half the window from which the loop counts as unstable, and the share
# of samples at which the output changes sign: a load that bends a beam, or a law against it, pushes one way.
GROWTH, CHANGES = 10.0, 6


@dataclass(frozen=True)
class RerunSpan:
    """Span of a run that is to be repeated, with the interval of its records and its step.

    Attributes:
        start: Time of its start; it begins with the record before [s].
        stop: Time of its end [s].
        interval: Period of the records [s].
        dt: Step [s].
        hold: Entries of u that keep the values they begin with.
    """

    start: float
    stop: float
    interval: float
    dt: float
    hold: tuple[Place, ...] = ()


# Repeats a span of the run -> t (n), q, v, u of its records.
Rerun = Callable[[RerunSpan], Sequence[Array] | None]


def blamed(outcome: Outcome, resolved: Resolved, again: Rerun) -> Outcome:
    """An outcome that names the sampled controller where one drives the motion apart."""
    if outcome.kind not in ("diverged", "beyond theory"):
        return outcome
    for name in _controllers(resolved.wired):
        block = resolved.wired.blocks[name]
        period = block.period or 0.0
        span = RerunSpan(outcome.t - WINDOW * period, outcome.t, period, period / FINER)
        states = again(span)
        if states is None:
            continue
        grown = max((_growth(values) for values in _outputs(resolved, name, states[3])), default=0.0)
        if grown >= GROWTH and _is_its_own(resolved, states, again(_held(resolved, name, span))):
            reason = (
                f"block '{name}', sampled every {period:g} s, drives the motion apart: within {len(states[0])} samples"
                f" its output grows {grown:.2g} times, back and forth"
            )
            advice = f"lower the gains of '{name}', or sample it more often"
            return replace(outcome, reason=reason, advice=advice, notes=(f"seen as: {outcome.reason}",))
    return outcome


def _controllers(wired: Wired) -> Iterator[str]:
    """Sampled blocks in a loop with a mechanism, those nearest to its inputs first."""
    seen: set[str] = set()
    nearest = [source[0] for name in wired.mechanisms() for source in wired.behind(name, ["u"])]
    while nearest:
        name = nearest.pop(0)
        if name in seen or name in wired.mechanisms():
            continue
        seen.add(name)
        if wired.blocks[name].period is not None and _reads_motion(wired, name):
            yield name
        nearest += [source[0] for source in wired.behind(name)]


def _reads_motion(wired: Wired, name: str) -> bool:
    """Whether the motion of a mechanism gets to a block."""
    return not _behind(wired, name).isdisjoint(wired.mechanisms())


def _behind(wired: Wired, name: str) -> set[str]:
    """The blocks that a block depends on, up to the mechanisms."""
    seen: set[str] = set()
    open_blocks = [name]
    while open_blocks:
        new = {source[0] for source in wired.behind(open_blocks.pop())} - seen
        seen |= new
        open_blocks += new - set(wired.mechanisms())
    return seen


def _held(resolved: Resolved, name: str, span: RerunSpan) -> RerunSpan:
    """A span with the outputs of a block held, and those of the sampled blocks that depend on it."""
    wired = resolved.wired
    held = {block for block, _ in resolved.layout.held if block == name or name in _behind(wired, block)}
    return replace(span, hold=tuple(place for (block, _), place in resolved.layout.held.items() if block in held))


def _is_its_own(resolved: Resolved, states: Sequence[Array], held: Sequence[Array] | None) -> bool:
    """Whether the motion grows, and by at most half of the exponent where the output of a block is held."""
    if held is None or len(held[0]) < len(states[0]):
        return False  # It ends sooner without the block.
    _, grown = _jolts(resolved, states[2])
    first, left = _jolts(resolved, held[2][: len(states[0])])
    return bool(grown >= GROWTH * first and left <= np.sqrt(first) * np.sqrt(grown))


def _jolts(resolved: Resolved, v: Array) -> tuple[float, float]:
    """The largest change of a mechanism's speed (n, nv) between two records, in each half of them."""
    places = [resolved.layout.v[name] for name in resolved.wired.mechanisms()]
    finite = np.concatenate([v[:, place.slice] for place in places], axis=1)
    finite = finite[np.isfinite(finite).all(axis=1)]
    with np.errstate(over="ignore"):  # What has exploded overflows.
        changes = np.abs(np.diff(finite, axis=0))
    first, second = (float(half.max(initial=0.0)) for half in np.split(changes, [len(changes) // 2]))
    return first, second


def _outputs(resolved: Resolved, name: str, u: Array) -> Iterator[Array]:
    """Each entry of the outputs that a block holds between samples, at the records (n)."""
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
