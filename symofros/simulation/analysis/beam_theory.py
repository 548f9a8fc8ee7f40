"""Whether configurations lie within the theory of the beams (docs/theory/beams.md, section 6)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from symofros.errors import BeamTheoryError, Problem
from symofros.runtime.beams import BeamBending, ElasticBeam, largest_bending
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import ArrayLike, Model


def bendings_at(model: Model, q: Array, par: ArrayLike | None = None, t: float = math.nan) -> tuple[BeamBending, ...]:
    """Bending of each beam in a configuration q (nq)."""
    return tuple(beam.bending(q[beam.in_q], t) for beam in model.beams(par))


def bendings_at_rest(model: Model, q: Array, K: Array, par: ArrayLike | None) -> tuple[BeamBending, ...]:
    """Bending of each beam at rest under its loads, whose axial parts amplify the error (26).

    Args:
        model: Model.
        q: Configuration (nq).
        K: Derivative of h - Q by q there (nv, nv).
        par: Run-time parameters.
    """
    return tuple(
        beam.bending(q[beam.in_q], amplification=beam.amplification(q[beam.in_q], K[beam.in_v, beam.in_v]))
        for beam in model.beams(par)
    )


def beyond_critical_load(beams: Sequence[ElasticBeam], q: Array, K: Array) -> tuple[str, ...]:
    """Names of the beams that loads have left without stiffness in some direction."""
    return tuple(beam.name for beam in beams if beam.amplification(q[beam.in_q], K[beam.in_v, beam.in_v]) <= 0.0)


def refuse_beyond(model: Model, bendings: Sequence[BeamBending], limit: float, result: str) -> None:
    """Refuse a result whose beams are bent beyond the limit.

    Raises:
        BeamTheoryError: With the beam, the place and the estimated error.
    """
    worst = largest_bending(bendings)
    if worst is not None and worst.error > limit:
        raise BeamTheoryError(
            Problem(
                f"model '{model.record.name}': {result} lies beyond the theory of its beams",
                str(worst),
                f"the estimated error is at most beam_limit = {100.0 * limit:g} %",
                f"{worst.remedy}; or raise beam_limit to see what second-order theory says",
            )
        )
