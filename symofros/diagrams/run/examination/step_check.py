"""What half the step makes of a diagram's run with fixed steps: of all of a short one, of windows of a long one.

docs/theory/diagrams.md, section 7; docs/theory/simulation.md, (17).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

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

# Records: t (n), q (n, nq), v (n, nv), and what else a run keeps.
States = Sequence[Array]
# The records of a run that goes on from a record (its number) to a time, by the same steps (False) or by finer ones
# (True), which are half as long, or have a hundredth of the tolerances; None where it does not get there.
Repeat = Callable[[int, float, bool], States | None]


def step_note(
    layout: Layout, states: States, repeat: Repeat, h: float, steps: int, *, answers_are_kept: bool = False
) -> str:
    """Which mechanism moves otherwise by finer steps, in words; nothing where all move nearly the same.

    Each mechanism is judged by itself, in its own speeds: those of others may be of another size.

    Args:
        layout: Layout of the diagram's vectors.
        states: Records of the run.
        repeat: Makes a part of the run once more.
        h: Step [s]; 0: it adapts.
        steps: Number of steps.
        answers_are_kept: Whether external blocks answer as they did: what they make of a change is not seen then, so
            that a smaller one counts.
    """
    worst, block, t, mean = 0.0, "", 0.0, h or float(states[0][-1] - states[0][0]) / steps
    stepping = f"steps of {h:.4g} s do" if h else "the tolerances do"
    finer, cure = ("half of that", "a smaller dt") if h else ("a hundredth of them", "tighter tolerances")
    for window in windows(states[0], states[2], mean, steps):
        rows = slice(window.first, window.last + 1) if window.last is not None else None
        coarse = [x[rows] for x in states] if rows else repeat(window.first, window.t_end, False)
        fine = repeat(window.first, window.t_end, True)
        if coarse is None or fine is None:
            begin = "" if steps <= WHOLE else f" from t = {float(states[0][window.first]):.6g} s"
            return f"{stepping} not show the motion: with {finer} it does not come to this end{begin}; {cure}"
        for name in layout.v:
            change = _change(layout, name, None if steps <= WHOLE else states, coarse, fine)
            if change > worst or not change >= 0.0:
                worst, block, t = change, name, float(states[0][window.first])
    if worst <= (_UNANSWERED if answers_are_kept else 1.0) * TOLERANCE:
        return ""
    by = f"{100.0 * worst:.2g} %" if worst < 1.0 else "more than 100 %"
    same = ", even where external blocks answer as they did" if answers_are_kept else ""
    seen = "" if steps <= WHOLE else f" (seen at t = {t:.4g} s)"
    return f"{stepping} not determine the motion of '{block}': {finer} changes it by {by}{seen}{same}; {cure}"


def _change(layout: Layout, block: str, run: States | None, coarse: States, fine: States) -> float:
    """Largest difference of a mechanism's speeds and displacements, relative to the largest of each.

    Args:
        layout: Layout of the diagram's vectors.
        block: Block of the mechanism.
        run: Records of the whole run, where these are of a window: its largest speed counts, and what that makes of
            the window's time.
        coarse: Records by the step.
        fine: Records by half of it.
    """
    at = layout.v[block].slice
    with np.errstate(all="ignore"):  # What has exploded overflows.
        _, i, j = np.intersect1d(coarse[0], fine[0], return_indices=True)  # Crossings are met at times of their own.
        q, v, q_half, v_half = coarse[1][i], coarse[2][i], fine[1][j], fine[2][j]
        moved = difference(layout.segments, np.broadcast_to(q_half[0], q_half.shape), q_half)[:, at]
        apart = difference(layout.segments, q_half, q)[:, at]
        fastest, faster = _largest(v_half[:, at]), _largest((v - v_half)[:, at])
        span = float(fine[0][-1] - fine[0][0])
        reach = _largest(moved)
        if run is not None:
            largest = _largest(run[2][:, at])
            fastest, reach = max(fastest, largest), max(reach, largest * span)
        return max(faster / max(fastest, STILL), _largest(apart) / max(reach, STILL * span, 1e-300) / _POSITIONS)


def _largest(rows: Array) -> float:
    """Largest norm of a row."""
    return float(np.sqrt(np.square(rows).sum(axis=1)).max(initial=0.0))
