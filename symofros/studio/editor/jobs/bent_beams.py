"""How far beams are bent, and what their theory errs there, as the page shows it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from symofros.runtime.beams import BEAM_LIMIT, NOTED_ERROR, BeamBending

Json = dict[str, Any]


def bent_beams(bendings: Sequence[BeamBending], limit: float = BEAM_LIMIT) -> list[Json]:
    """The judgement of each beam.

    Args:
        bendings: Bending of each beam, of a run where its theory errs most.
        limit: Estimated error beyond which results fail.

    Returns:
        By beam: `beam`, its name; `slope` [rad]; `station` [m]; `t` [s], None of a pose; `error`, relative to the
        deflection, of a rod to its length, None where there is no finite one; `exact`, whether it is a geometrically
        exact rod; `grade`: "fine", "noted" or "beyond"; `text`, a sentence; `remedy`, a model that would do.
    """
    return [
        {
            "beam": bending.beam,
            "slope": _finite(bending.slope),
            "station": bending.station,
            "t": _finite(bending.t),
            "error": _finite(bending.error),
            "exact": bending.sections > 0,
            "grade": _grade(bending.error, limit),
            "text": str(bending),
            "remedy": bending.remedy,
        }
        for bending in bendings
    ]


def _grade(error: float, limit: float) -> str:
    if not error <= limit:
        return "beyond"
    return "noted" if error > NOTED_ERROR else "fine"


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None
