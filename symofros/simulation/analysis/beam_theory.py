"""Whether configurations lie within the theory of the beams (docs/theory/beams.md, section 6)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from symofros.errors import BeamTheoryError, Problem, SymofrosError
from symofros.runtime.beams import BeamBending, ElasticBeam, largest_bending
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import ArrayLike, Model

# Error of the slope alone below which no axial load of a motion is looked for: to amplify it to a note, a load would
# have to be within 0.03 % of the critical one.
UNAMPLIFIED = 1e-5
# States of a motion whose axial loads are looked at; angle [rad] by which sections are turned for differences of
# forces; least share of the elastic work that the tangent stiffness counts with.
_STATES, _ANGLE, _LEAST = 16, 1e-4, 1e-9


def bendings_at(model: Model, q: Array, par: ArrayLike | None = None, t: float = math.nan) -> tuple[BeamBending, ...]:
    """Bending of each beam in a configuration q (nq)."""
    return tuple(beam.bending(q[beam.in_q], t) for beam in model.beams(par))


def bendings_in_motion(
    model: Model, q: Array, v: Array, u: Array, par: ArrayLike | None = None, t: float = 0.0
) -> tuple[BeamBending, ...]:
    """Bending of each beam in a state of motion, amplified by its axial loads."""
    bent = bendings_at(model, q, par)
    if max((bending.error for bending in bent), default=0.0) < UNAMPLIFIED:
        return bent
    factors = amplifications(model, (np.array([t]), q[np.newaxis], v[np.newaxis], u[np.newaxis]), par)
    return tuple(
        beam.bending(q[beam.in_q], amplification=factor) for beam, factor in zip(model.beams(par), factors, strict=True)
    )


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


def amplifications(model: Model, states: Sequence[Array], par: ArrayLike | None = None) -> tuple[float, ...]:
    """Amplification of each beam's error by the axial loads of a motion, inertia among them (26a).

    Args:
        model: Model.
        states: Times (n), configurations (n, nq), speeds (n, nv) and inputs (n, nu) of the motion.
        par: Run-time parameters.
    """
    beams = model.beams(par)
    good = np.flatnonzero(np.isfinite(states[1]).all(axis=1) & np.isfinite(states[2]).all(axis=1))
    t, q, v, u = (array[good[:: -(-len(good) // _STATES) or 1]] for array in states)
    if not len(t):
        return (1.0,) * len(beams)
    try:
        a, lam = model.forward_dynamics(q, v, u, par=par, t=t, multipliers=True)
        return tuple(_amplification(model, beam, (t, q, v, u, a, lam), par) for beam in beams)
    except SymofrosError:  # Options.functions left out what this takes.
        return (1.0,) * len(beams)


def _amplification(
    model: Model,
    beam: ElasticBeam,
    motion: tuple[Array, ...],
    par: ArrayLike | None,
) -> float:
    """Elastic work over that of the tangent stiffness in a motion, both summed over its states (26a)."""
    t, q, v, u, a, lam = motion
    step = _ANGLE / np.where(beam.reach > 0.0, beam.reach, 1.0)
    moved = np.repeat(q[:, np.newaxis], 2 * beam.size, axis=1)
    moved[:, :, beam.in_q] += np.concatenate([np.diag(step), -np.diag(step)])
    inputs, times = u[:, np.newaxis], t[:, np.newaxis]
    M, h, Q = model.dynamics(moved, v[:, np.newaxis], inputs, par=par, t=times)
    residual = np.einsum("...ij,...j->...i", M, a[:, np.newaxis]) + h - Q
    if model.nc:
        G = model.constraint_jacobian(moved, u=inputs, par=par, t=times)
        residual = residual - np.einsum("...ji,...j->...i", G, lam[:, np.newaxis])
    residual = residual[:, :, beam.in_v]
    columns = (residual[:, : beam.size] - residual[:, beam.size :]) / (2.0 * step[:, np.newaxis])
    elastic, x = beam.elastic_stiffness(), q[:, beam.in_q]
    work, total = float(np.einsum("ni,ij,nj->", x, elastic, x)), float(np.einsum("ni,nji,nj->", x, columns, x))
    if not (work > 0.0 and math.isfinite(total)):
        return 1.0
    return work / max(abs(total), _LEAST * work)


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
