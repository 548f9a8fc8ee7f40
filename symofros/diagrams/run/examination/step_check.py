"""What half the step makes of a diagram's run with fixed steps: of all of it, or of windows of a long one.

docs/theory/diagrams.md, section 7; docs/theory/simulation.md, (17).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.layout import Layout
from symofros.runtime.constrained import STILL
from symofros.runtime.manifold import difference
from symofros.simulation.results.examination.energy_balance import EXPLODED
from symofros.simulation.results.examination.repetition import FRACTIONS, HALVINGS, SETTLED, percent
from symofros.simulation.stepping.resolution import TOLERANCE
from symofros.simulation.stepping.windows import WHOLE, Window, windows

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
# The records of a run that goes on from a record (its number) to a time, by steps that are refined so many times: they
# are half as long each time, or have a hundredth of the tolerances; None where it does not get there.
Repeat = Callable[[int, float, int], States | None]


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
        refinements: Number of times that the steps were refined.
    """

    share: float
    block: str
    t: float
    span: float
    refinements: int = 1


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
    stepping, cure = (f"steps of {h:.4g} s", "a smaller dt") if h else ("the tolerances", "tighter tolerances")
    # All of a run would show nothing of what an external block makes of errors from one call to the next.
    duration, short = float(states[0][-1] - states[0][0]), steps <= WHOLE and not external
    run = _Run(layout, states, repeat, h, (_UNANSWERED if external else 1.0) * TOLERANCE, whole=short)
    worst = _Changed(0.0, "", 0.0, duration)
    for window in windows(states[0], states[2], h or duration / steps, steps if short else max(steps, WHOLE + 1)):
        changed = run.changed(window)
        if not changed.block:
            begin = "" if short else f" from t = {changed.t:.6g} s"
            unlike = f"with {run.finer(changed)} it does not come to this end{begin}"
            return f"{stepping} do not show the motion: {unlike}; {cure}"
        worst = max(worst, changed, key=_size)
    grown = worst.share * (duration / worst.span) ** _GROWTH
    seen = "" if short else f" (seen at t = {worst.t:.4g} s)"
    if not worst.share > run.tolerance and grown > TOLERANCE and not short:
        if external:
            if grown <= _ADDS_UP:
                return ""
            return (
                f"{stepping} are not held against {run.finer(worst)} over all of the run, as '{external}' is not called"
                f" again: {worst.span:.3g} s of the motion of '{worst.block}' change by {100.0 * worst.share:.2g} %"
                f"{seen}, which adds up; compare with {cure}"
            )
        worst, seen = run.once_more(steps), ""
        if not worst.block:
            return f"{stepping} do not show the motion: with {run.finer(worst)} it does not come to this end; {cure}"
    if worst.share <= run.tolerance:
        return ""
    same = ", even where external blocks answer as they did" if external else ""
    return (
        f"{stepping} do not determine the motion of '{worst.block}': {run.finer(worst)} changes it by"
        f" {percent(worst.share)}{seen}{same}; {cure}"
    )


@dataclass(frozen=True)
class _Run:
    """A run, parts of which are held against finer steps.

    Attributes:
        layout: Layout of the diagram's vectors.
        states: Records of the run.
        repeat: Makes a part of the run once more.
        h: Step [s]; 0: it adapts.
        tolerance: Change that is worth a note.
        whole: Whether the part is all of the run.
    """

    layout: Layout
    states: States
    repeat: Repeat
    h: float
    tolerance: float
    whole: bool

    def finer(self, changed: _Changed) -> str:
        """The finest steps that a part was held against, in words."""
        return f"{FRACTIONS[changed.refinements]} of that" if self.h else "a hundredth of them"

    def changed(self, window: Window) -> _Changed:
        """What finer steps change in a window; without a block where they do not come to its end.

        They are refined until that changes no more than a part of what is noted, and twice at least where a speed
        changes by half of the largest from one record to the next: steps over a contact may all err in the same way.
        """
        t, i = self.states[0], window.first
        coarse: States | None
        if window.last is not None:
            coarse = [x[i : window.last + 1] for x in self.states]
        else:
            coarse = self.repeat(i, window.t_end, 0)
        worst = _Changed(0.0, "", float(t[i]), window.t_end - float(t[i]))
        before = 0.0
        for k in range(1, 1 + (HALVINGS if self.h else 1)):
            fine = self.repeat(i, window.t_end, k)
            if coarse is None or fine is None:
                return replace(worst, block="", refinements=k)
            now = replace(_changed(self.layout, None if self.whole else self.states, coarse, fine), refinements=k)
            worst = max(worst, now, key=_size) if worst.block else now
            settled = abs(now.share - before) <= SETTLED * self.tolerance and (k > 1 or not self._jumps(fine))
            if settled or _size(worst) > self.tolerance:
                break
            before = now.share
        return worst

    def _jumps(self, fine: States) -> bool:
        """Whether the speed of a mechanism changes by half of its largest from one record to the next."""
        v = fine[2]
        with np.errstate(all="ignore"):
            return any(
                2.0 * _largest(np.diff(v[:, places.slice], axis=0)) > _largest(v[:, places.slice])
                for places in self.layout.v.values()
            )

    def once_more(self, steps: int) -> _Changed:
        """What finer steps change in all of a run or its first steps; without a block where they do not come there."""
        t = self.states[0]
        end = float(t[-1]) if steps <= _REPEATED else float(t[0] + (t[-1] - t[0]) * _REPEATED / steps)
        last = int(np.searchsorted(t, end, side="right")) - 1
        if t[last] > t[0]:
            end = float(t[last])
        # No record may lie that early.
        coarse = [x[: last + 1] for x in self.states] if t[last] > t[0] else self.repeat(0, end, 0)
        fine = self.repeat(0, end, 1)
        if coarse is None or fine is None:
            return _Changed(0.0, "", float(t[0]), end - float(t[0]))
        return _changed(self.layout, None, coarse, fine, _mean)


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
            # What a motion grows to later is no measure of it, nor of its start where it grows without bounds.
            by_then = max(fastest, norm(run[2][: np.searchsorted(run[0], fine[0][-1], side="right"), at]))
            if fine[0][0] > run[0][0] or largest > EXPLODED * by_then:
                largest = by_then
            wide = norm(difference(layout.segments, np.broadcast_to(run[1][0], run[1].shape), run[1])[:, at])
            # What goes to and fro comes no farther, however long the window is.
            fastest, reach = max(fastest, largest), max(reach, min(largest * span, wide))
        return max(faster / max(fastest, STILL), norm(apart) / max(reach, STILL * span, 1e-300) / _POSITIONS)
