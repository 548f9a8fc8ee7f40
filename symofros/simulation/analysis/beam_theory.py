"""Whether configurations lie within the theory of the beams (docs/theory/beams.md, section 6)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.errors import BeamTheoryError, SymofrosError
from symofros.runtime.beams import BeamBending, ElasticBeam, amplification_of, largest_bending
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.mass_matrix import mass_matrix

# Error of the slope alone below which no axial load of a motion is looked for: to amplify it to a note, a load would
# have to be within 0.03 % of the critical one.
UNAMPLIFIED = 1e-5
# States of a motion whose axial loads are looked at.
_STATES = 16


def bendings_at(model: Model, q: Array, par: ArrayLike | None = None) -> tuple[BeamBending, ...]:
    """Bending of each beam in a configuration q (nq)."""
    return tuple(beam.bending(q[beam.in_q], math.nan) for beam in model.beams(par))


def bendings_in_motion(
    model: Model,
    q: Array,
    v: Array,
    u: Array,
    par: ArrayLike | None = None,
    t: float = 0.0,
    slopes: Array | None = None,
) -> tuple[BeamBending, ...]:
    """Bending of each beam in a state of motion, amplified by its axial loads.

    Args:
        model: Model.
        q: Configuration (nq).
        v: Speeds (nv).
        u: Inputs (nu).
        par: Run-time parameters.
        t: Time.
        slopes: Derivative of the accelerations by q there (nv, nv), where known; of models without constraints.
    """
    bent = with_left_out(model, bendings_at(model, q, par), (np.array([t]), q[None], v[None], u[None]), par)
    if max((bending.error for bending in bent), default=0.0) < UNAMPLIFIED:
        return bent
    if slopes is None:
        factors = amplifications(model, (np.array([t]), q[np.newaxis], v[np.newaxis], u[np.newaxis]), par)
    else:
        factors = _linearised_amplifications(model, q, v, u, slopes, par, t)
    return tuple(
        replace(beam.bending(q[beam.in_q], amplification=factor), left_out=bending.left_out)
        for beam, factor, bending in zip(model.beams(par), factors, bent, strict=True)
    )


class Motion(NamedTuple):
    """States of a motion whose accelerations, inputs and multipliers are given, with their parameters, row by row."""

    q: Array
    v: Array
    a: Array
    u: Array
    lam: Array
    par: Array


def bendings_under_efforts(model: Model, motion: Motion, t: Array) -> tuple[BeamBending, ...]:
    """Bending of each beam in the state of a given motion where its theory errs most, amplified by its axial loads.

    Args:
        model: Model.
        motion: States (n, ...).
        t: Times (n).
    """
    q, v, a, u, lam, par = motion
    worst = list[BeamBending]()
    for b, beam in enumerate(model.beams()):
        bent = [model.beams(values)[b].bending(row[beam.in_q]) for row, values in zip(q, par, strict=True)]
        if max((bending.error for bending in bent), default=0.0) >= UNAMPLIFIED:
            x, step = q[:, beam.in_q], beam.difference_step(q[:, beam.in_q])
            forces = []
            for factor in (step, -step):
                moved = q.copy()
                moved[:, beam.in_q] += factor[:, np.newaxis] * x
                M, h, Q = model.dynamics(moved, v, u, par=par, t=t)
                force = np.einsum("nij,nj->ni", M, a) + h - Q
                if model.nc:
                    G = model.evaluate("constraint_jacobian", q=moved, v=v, u=u, t=t, par=par)[0]
                    force -= np.einsum("nji,nj->ni", G, lam)
                forces.append(np.einsum("ni,ni->n", x, force[:, beam.in_v]))
            loaded = np.divide(forces[0] - forces[1], 2.0 * step, out=np.zeros(len(q)), where=step > 0.0)
            stiffness = (model.beams(values)[b].elastic_stiffness() for values in par)
            works = (row @ K @ row for row, K in zip(x, stiffness, strict=True))
            factors = (amplification_of(np.array([w]), np.array([k])) for w, k in zip(works, loaded, strict=True))
            bent = [bending.amplified(factor) for bending, factor in zip(bent, factors, strict=True)]
        worst.append(max(bent, key=lambda bending: bending.error))
    return with_left_out(model, tuple(worst), (t, q, v, u), par[0], (a, lam)) if len(t) else tuple(worst)


def with_left_out(
    model: Model,
    bendings: tuple[BeamBending, ...],
    states: Sequence[Array],
    par: ArrayLike | None,
    response: tuple[Array, Array] | None = None,
) -> tuple[BeamBending, ...]:
    """Bending of each beam, with the stiffness that its order leaves out in a motion, in the mean over its states.

    Args:
        model: Model.
        bendings: Bending of each beam.
        states: States of the motion, as of `amplifications`.
        par: Run-time parameters.
        response: Accelerations (n, nv) and multipliers (n, nc), if they are not those of free motion.
    """
    beams = model.beams(par)
    if all(beam.omitted is None for beam in beams):
        return bendings
    rows = amplifying(*states[1:3])
    if not len(rows):
        return bendings
    t, q, v, u = (array[rows] for array in states)
    if any(beam.omitted is not None and beam.omitted.of_forces for beam in beams):
        try:
            if response is None:
                a, lam = model.forward_dynamics(q, v, u, par=par, t=t, multipliers=True)
            else:
                a, lam = (array[rows] for array in response)
            loaded = [section_forces_of(model, beam.name, (q, v, a, u), lam, t, par) for beam in beams]
        except SymofrosError:  # Options.functions left out what this takes.
            loaded = [_UNKNOWN] * len(beams)
    else:
        loaded = [_UNKNOWN] * len(beams)
    free = _constrained_directions(model, (t[-1], q[-1], v[-1], u[-1]), par) if model.nc else None
    return tuple(
        replace(
            bending,
            left_out=beam.left_out(
                q[:, beam.in_q].mean(axis=0),
                *known,
                free=None if free is None else free[beam.in_v],
                turning=turning_of(model, beam, (q, v, u), par),
            ),
        )
        for beam, bending, known in zip(beams, bendings, loaded, strict=True)
    )


def _constrained_directions(model: Model, state: Sequence[Any], par: ArrayLike | None) -> Array | None:
    """Changes of the speeds that the constraints leave in a state t, q, v, u (nv, k); None where that is not known."""
    t, q, v, u = state
    try:
        (G,) = model.evaluate("constraint_jacobian", q=q, v=v, u=u, t=t, par=par)
    except SymofrosError:  # Options.functions left it out.
        return None
    _, sizes, rows = np.linalg.svd(np.asarray(G))
    return np.asarray(rows[int((sizes > _RANK * sizes.max(initial=0.0)).sum()) :].T)


# Share of the largest singular value of G up to which a condition repeats others.
_RANK = 1e-9
# Stations and section forces that are not known.
_UNKNOWN = np.zeros(0), np.zeros((0, 6))


def section_forces_of(
    model: Model,
    beam: str,
    states: tuple[Array, Array, Array, Array],
    lam: Array | None,
    t: Array,
    par: ArrayLike | None,
) -> tuple[Array, Array]:
    """Stations x/L of a beam (s), and the mean of its section forces over states q, v, v', u of a motion (s, 6)."""
    sections = model.names.sections
    at = [k for k, (name, _) in enumerate(sections) if name == beam]
    if not at:
        return _UNKNOWN
    forces = model.section_forces(*states, lam if model.nc else None, par=par, t=t)[:, at].mean(axis=0)
    return np.array([sections[k][1] for k in at]), forces


def turning_of(
    model: Model, beam: ElasticBeam, states: tuple[Array, Array, Array], par: ArrayLike | None
) -> tuple[Array, Array] | None:
    """Rates of a beam's root in states q, v, u of a motion (n, 3), in its axes, and M of its elastic coordinates.

    None where its equations have all that rotation does, or where it is not known.
    """
    if beam.omitted is None or not beam.omitted.turning:
        return None
    q, v, u = states
    try:
        turned = model.frame_velocity(beam.name, q, v, u=u, par=par)[:, 3:]
        R = model.frame_pose(beam.name, q, u=u, par=par)[1]
        M = mass_matrix(model, q[-1], v[-1], u[-1], par, 0.0)
    except SymofrosError:  # Options.functions or frames left out what this takes.
        return None
    return np.einsum("nij,ni->nj", R, turned), M[beam.in_v, beam.in_v]


def _linearised_amplifications(
    model: Model, q: Array, v: Array, u: Array, slopes: Array, par: ArrayLike | None, t: float
) -> tuple[float, ...]:
    """Amplifications in a state whose accelerations are linearised already (26a)."""
    beams = model.beams(par)
    try:
        tangent = -mass_matrix(model, q, v, u, par, t) @ slopes
    except SymofrosError:  # Options.functions left it out.
        return (1.0,) * len(beams)
    factors = []
    for beam in beams:
        x = q[beam.in_q]
        works = (np.array([x @ K @ x]) for K in (beam.elastic_stiffness(), tangent[beam.in_v, beam.in_v]))
        factors.append(amplification_of(*works))
    return tuple(factors)


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


def amplifications(
    model: Model, states: Sequence[Array], par: ArrayLike | None = None, inertia: str = "dynamics"
) -> tuple[float, ...]:
    """Amplification of each beam's error by the axial loads of a motion, inertia among them (26a).

    Args:
        model: Model.
        states: Times (n), configurations (n, nq), speeds (n, nv) and inputs (n, nu) of the motion.
        par: Run-time parameters.
        inertia: Function whose first output is the mass matrix.
    """
    beams = model.beams(par)
    t, q, v, u = (array[amplifying(*states[1:3])] for array in states)
    if not len(t):
        return (1.0,) * len(beams)
    try:
        M = model.evaluate(inertia, q=q, v=v, u=u, t=t, par=par)[0]
        G = model.evaluate("constraint_jacobian", q=q, v=v, u=u, t=t, par=par)[0] if model.nc else None
        return tuple(_amplification(model, beam, (t, q, v, u), M, G, par) for beam in beams)
    except SymofrosError:  # Options.functions left out what this takes.
        return (1.0,) * len(beams)


def amplified_in_motion(
    bendings: tuple[BeamBending, ...],
    amplify: Callable[[Sequence[float]], tuple[BeamBending, ...]],
    model: Model,
    states: Sequence[Array],
    par: ArrayLike | None,
    inertia: str = "dynamics",
) -> tuple[BeamBending, ...]:
    """Bending of each beam with what its order leaves out, its error amplified by axial loads from UNAMPLIFIED on.

    Args:
        bendings: Bending of each beam, axial loads apart.
        amplify: Gives the same amplified by as many factors.
        model: Model.
        states: States of the motion, as of `amplifications`; so are `par` and `inertia`.
        par: Run-time parameters.
        inertia: Function whose first output is the mass matrix.
    """
    if max((bending.error for bending in bendings), default=0.0) >= UNAMPLIFIED and len(states[0]):
        bendings = amplify(amplifications(model, states, par, inertia))
    return with_left_out(model, bendings, states, par)


def amplifying(q: Array, v: Array) -> npt.NDArray[np.intp]:
    """Which states (n) of a motion, from configurations and speeds, its axial loads are looked at in."""
    good = np.flatnonzero(np.isfinite(q).all(axis=1) & np.isfinite(v).all(axis=1))
    return good[:: -(-len(good) // _STATES) or 1]


def _amplification(
    model: Model, beam: ElasticBeam, states: tuple[Array, ...], M: Array, G: Array | None, par: ArrayLike | None
) -> float:
    """Elastic work over that of the tangent stiffness in a motion, both summed over its states (26a)."""
    t, q, v, u = states
    x = q[:, beam.in_q]
    step = beam.difference_step(x)
    moved = np.repeat(q[:, np.newaxis], 2, axis=1)
    moved[:, :, beam.in_q] += np.stack([step, -step], axis=1)[..., np.newaxis] * x[:, np.newaxis]
    given = moved, v[:, np.newaxis], u[:, np.newaxis]
    a, lam = model.forward_dynamics(*given, par=par, t=t[:, np.newaxis], multipliers=True)
    changes = (a[:, 0] - a[:, 1], lam[:, 0] - lam[:, 1])
    forces = np.einsum("ni,nij,nj->n", x, M[:, beam.in_v], changes[0])
    if G is not None:
        forces = forces - np.einsum("ni,nji,nj->n", x, G[..., beam.in_v], changes[1])
    work = np.einsum("ni,ij,nj->n", x, beam.elastic_stiffness(), x)
    return amplification_of(work, np.divide(-forces, 2.0 * step, out=np.zeros(len(t)), where=step > 0.0))


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
            f"model '{model.record.name}': {result} lies beyond the theory of its beams",
            str(worst),
            f"the estimated error is at most beam_limit = {100.0 * limit:g} %",
            f"{worst.remedy}; or raise beam_limit to see what second-order theory says",
        )
