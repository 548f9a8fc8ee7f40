"""What half the step makes of a diagram's run with fixed steps: of all of it, or of windows of a long one.

docs/theory/diagrams.md, section 7; docs/theory/simulation.md, (17).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from symofros.diagrams.program.layout import Layout
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import STILL
from symofros.runtime.manifold import difference
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.windows import WHOLE, windows

# Differences of displacements count by this share: coordinates may be larger than how they change.
_POSITIONS = 3.0
# Share of the tolerance that is allowed where external blocks do not answer to the change.
_UNANSWERED = 0.08
# Power of time with which the change in a window may grow over the run: errors of amplitudes turn into those of phases.
_GROWTH = 2.0
# What it may grow to where external blocks answer to the motion, so that the run is not made once more.
_ADDS_UP = 0.3
# Longest part of a run, in steps, that is made once more where the change in a window may grow to a note.
_REPEATED = 20_000

# Records: t (n), q (n, nq), v (n, nv), and what else a run keeps.
States = Sequence[Array]
# The records of a run that goes on from a record (its number) to a time, by the same steps (False) or by finer ones
# (True), which are half as long, or have a hundredth of the tolerances; None where it does not get there.
Repeat = Callable[[int, float, bool], States | None]


# Records (n, m) of a vector -> its size.
Norm = Callable[[Array], float]


def _largest(rows: Array) -> float:
    """Largest norm of a row."""
    return float(np.sqrt(np.square(rows).sum(axis=1)).max(initial=0.0))


def _mean(rows: Array) -> float:
    """Root mean square of the rows: where speeds jump, an instant earlier or later is no other motion."""
    return float(np.sqrt(np.square(rows).sum(axis=1).mean()))


@dataclass(frozen=True)
class _Changed:
    """What finer steps change most of a part of a run.

    Attributes:
        share: Change, relative to the largest speed or displacement.
        block: Block of the mechanism.
        t: Time at which the part begins [s].
        span: Length of the part [s].
    """

    share: float
    block: str
    t: float
    span: float


def step_note(layout: Layout, states: States, repeat: Repeat, h: float, steps: int, *, external: str = "") -> str:
    """Which mechanism moves otherwise by finer steps, in words; nothing where all move nearly the same.

    Each mechanism is judged by itself, in its own speeds: those of others may be of another size.

    Args:
        layout: Layout of the diagram's vectors.
        states: Records of the run.
        repeat: Makes a part of the run once more.
        h: Step [s]; 0: it adapts.
        steps: Number of steps.
        external: An external block that answers to the motion, if there is one: in what is repeated it answers as it
            did, so that a smaller change counts.
    """
    stepping = f"steps of {h:.4g} s" if h else "the tolerances"
    finer, cure = ("half of that", "a smaller dt") if h else ("a hundredth of them", "tighter tolerances")
    # All of a run would show nothing of what an external block makes of errors from one call to the next.
    duration, short = float(states[0][-1] - states[0][0]), steps <= WHOLE and not external
    chosen = windows(states[0], states[2], h or duration / steps, steps if short else max(steps, WHOLE + 1))
    worst = _Changed(0.0, "", 0.0, duration)
    for window in chosen:
        rows = slice(window.first, window.last + 1) if window.last is not None else None
        coarse = [x[rows] for x in states] if rows else repeat(window.first, window.t_end, False)
        fine = repeat(window.first, window.t_end, True)
        if coarse is None or fine is None:
            begin = "" if short else f" from t = {float(states[0][window.first]):.6g} s"
            return f"{stepping} do not show the motion: with {finer} it does not come to this end{begin}; {cure}"
        worst = max(worst, _changed(layout, None if short else states, coarse, fine), key=_size)
    grown = worst.share * (duration / worst.span) ** _GROWTH
    seen = "" if short else f" (seen at t = {worst.t:.4g} s)"
    if not worst.share > (_UNANSWERED if external else 1.0) * TOLERANCE and grown > TOLERANCE and not short:
        if external:
            if grown <= _ADDS_UP:
                return ""
            return (
                f"{stepping} are not held against {finer} over all of the run, as '{external}' is not called again:"
                f" {worst.span:.3g} s of the motion of '{worst.block}' change by {100.0 * worst.share:.2g} %{seen},"
                f" which adds up; compare with {cure}"
            )
        coarse, fine = _once_more(states, repeat, steps)
        if coarse is None or fine is None:
            return f"{stepping} do not show the motion: with {finer} it does not come to this end; {cure}"
        worst, seen = _changed(layout, None, coarse, fine, _mean), ""
    if worst.share <= (_UNANSWERED if external else 1.0) * TOLERANCE:
        return ""
    by = f"{100.0 * worst.share:.2g} %" if worst.share < 1.0 else "more than 100 %"
    same = ", even where external blocks answer as they did" if external else ""
    return f"{stepping} do not determine the motion of '{worst.block}': {finer} changes it by {by}{seen}{same}; {cure}"


def _once_more(states: States, repeat: Repeat, steps: int) -> tuple[States | None, States | None]:
    """All of a run or its first steps, as it was and by finer steps."""
    t = states[0]
    end = float(t[-1]) if steps <= _REPEATED else float(t[0] + (t[-1] - t[0]) * _REPEATED / steps)
    last = int(np.searchsorted(t, end, side="right")) - 1
    if t[last] > t[0]:
        return [x[: last + 1] for x in states], repeat(0, float(t[last]), True)
    return repeat(0, end, False), repeat(0, end, True)  # No record lies that early.


def _size(changed: _Changed) -> float:
    """The change, one that is not a number above all."""
    return changed.share if changed.share >= 0.0 else np.inf


def _changed(layout: Layout, run: States | None, coarse: States, fine: States, norm: Norm = _largest) -> _Changed:
    """The mechanism that finer steps change most in a part of a run; arguments as those of `_change`."""
    t, span = float(fine[0][0]), float(fine[0][-1] - fine[0][0])
    shares = {name: _change(layout, name, run, coarse, fine, norm) for name in layout.v}
    return max((_Changed(share, name, t, span) for name, share in shares.items()), key=_size)


def _change(layout: Layout, block: str, run: States | None, coarse: States, fine: States, norm: Norm) -> float:
    """Difference of a mechanism's speeds and displacements, relative to the size of each.

    Args:
        layout: Layout of the diagram's vectors.
        block: Block of the mechanism.
        run: Records of the whole run, where these are of a window: its largest speed counts, and what that makes of
            the window's time, up to its largest displacement.
        coarse: Records by the step.
        fine: Records by half of it.
        norm: What counts of the records.
    """
    at = layout.v[block].slice
    with np.errstate(all="ignore"):  # What has exploded overflows.
        _, i, j = np.intersect1d(coarse[0], fine[0], return_indices=True)  # Crossings are met at times of their own.
        q, v, q_half, v_half = coarse[1][i], coarse[2][i], fine[1][j], fine[2][j]
        moved = difference(layout.segments, np.broadcast_to(q_half[0], q_half.shape), q_half)[:, at]
        apart = difference(layout.segments, q_half, q)[:, at]
        fastest, faster = norm(v_half[:, at]), norm((v - v_half)[:, at])
        span = float(fine[0][-1] - fine[0][0])
        reach = norm(moved)
        if run is not None:
            largest = norm(run[2][:, at])
            wide = norm(difference(layout.segments, np.broadcast_to(run[1][0], run[1].shape), run[1])[:, at])
            # What goes to and fro comes no farther, however long the window is.
            fastest, reach = max(fastest, largest), max(reach, min(largest * span, wide))
        return max(faster / max(fastest, STILL), norm(apart) / max(reach, STILL * span, 1e-300) / _POSITIONS)
