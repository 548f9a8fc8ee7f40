"""Which spans of a run are made once more by finer steps, of a mechanism or a diagram.

docs/theory/simulation.md, section 8; docs/theory/diagrams.md, section 7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.constrained import STILL

# Steps of a run that is repeated as a whole; a call takes as long as some hundred steps of a small model.
WHOLE = 256
# Windows of a longer one: two, and one more for so many steps, four at most; their steps together, a share of the run,
# but no fewer than show a change of speeds.
_STEPS_A_WINDOW, _FEW, _MANY, _SHARE, _FEWEST, _MOST = 50_000, 2, 4, 0.01, 8, 256
# A window ends at a record, unless these are more than so many windows and so many steps apart: then it is made twice.
_SPARSE, _INTERVAL = 4.0, 128


@dataclass(frozen=True)
class Window:
    """A span of a run that is made once more.

    Attributes:
        first: Number of the record that it begins with.
        last: Number of the record that it ends with; None where it ends between two.
        t_end: End time [s].
    """

    first: int
    last: int | None
    t_end: float


def windows(t: Array, v: Array, h: float, steps: int) -> list[Window]:
    """The whole of a short run; of a longer one its start, and where its speeds change most in each part of it.

    Args:
        t: Times of the records (n) [s].
        v: Speeds there (n, nv).
        h: Step, or the mean of adaptive ones [s].
        steps: Number of steps.
    """
    if steps <= WHOLE:
        return [Window(0, len(t) - 1, float(t[-1]))]
    count = min(_FEW + steps // _STEPS_A_WINDOW, _MANY)
    span = h * min(_MOST, max(_FEWEST, int(_SHARE * steps / count)))
    n = max(1, int(np.searchsorted(t, t[-1] - span, side="right")))
    spans, sizes = np.diff(t[: n + 1]), np.maximum(np.abs(v).max(axis=0, initial=0.0), STILL)
    with np.errstate(all="ignore"):  # What has exploded overflows.
        changes = np.abs(np.diff(v[: n + 1], axis=0) / sizes).sum(axis=1) / np.where(spans > 0.0, spans, np.inf)
    parts = [part for part in np.array_split(np.arange(len(changes)), count - 1) if len(part)]
    chosen = []
    for i in sorted({0, *(int(part[np.argmax(changes[part])]) for part in parts)}):
        last = min(int(np.searchsorted(t, t[i] + span)), len(t) - 1)
        sparse = t[last] - t[i] > max(_SPARSE * span, _INTERVAL * h)
        chosen.append(Window(i, None, float(t[i]) + span) if sparse else Window(i, last, float(t[last])))
    return chosen
