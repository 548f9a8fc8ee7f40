"""What half the step makes of a diagram's short run with fixed steps (docs/theory/simulation.md, (17))."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symofros.diagrams.program.layout import Layout
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import STILL
from symofros.runtime.manifold import difference
from symofros.simulation.stepping.resolution import TOLERANCE

# Steps of a run that is repeated as a whole: as of `sf.simulate`.
STEPS = 256
# Differences of displacements count by this share: coordinates may be larger than how they change.
_POSITIONS = 3.0


def halved_steps_note(layout: Layout, states: Sequence[Array], half: Sequence[Array] | None, h: float) -> str:
    """Which mechanism moves otherwise by half the step, in words; nothing where all move nearly the same.

    Each mechanism is judged by itself, in its own speeds: those of others may be of another size.

    Args:
        layout: Layout of the diagram's vectors.
        states: Records of the run: t (n), q, v.
        half: Records of the run by half the step, at the same times; None where it did not come to its end.
        h: Step [s].
    """
    if half is None or len(half[0]) != len(states[0]):
        return (
            f"steps of {h:.4g} s do not show the motion: with half of that it does not come to this end; a smaller dt"
        )
    worst, block = max(((_change(layout, name, states, half), name) for name in layout.v), default=(0.0, ""))
    if not worst > TOLERANCE:
        return ""
    by = f"{100.0 * worst:.2g} %" if worst < 1.0 else "more than 100 %"
    return f"steps of {h:.4g} s do not determine the motion of '{block}': half of that changes it by {by}; a smaller dt"


def _change(layout: Layout, block: str, states: Sequence[Array], half: Sequence[Array]) -> float:
    """Largest difference of a mechanism's speeds and displacements, relative to the largest of each."""
    at, (_, q, v), (_, q_half, v_half) = layout.v[block].slice, states[:3], half[:3]
    with np.errstate(all="ignore"):  # What has exploded overflows.
        moved = difference(layout.segments, np.broadcast_to(q_half[0], q_half.shape), q_half)[:, at]
        apart = difference(layout.segments, q_half, q)[:, at]
        fastest, faster = _largest(v_half[:, at]), _largest((v - v_half)[:, at])
        span = STILL * float(states[0][-1] - states[0][0])
        return max(faster / max(fastest, STILL), _largest(apart) / max(_largest(moved), span, 1e-300) / _POSITIONS)


def _largest(rows: Array) -> float:
    """Largest norm of a row."""
    return float(np.sqrt(np.square(rows).sum(axis=1)).max(initial=0.0))
