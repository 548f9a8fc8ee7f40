"""Equilibria and steady motions: configurations in which the speeds stay as they are (docs/theory/linear.md)."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import numeric
from symofros.errors import ActuationError, BeamTheoryError, EquilibriumError, Problem, UnknownNameError
from symofros.runtime.beams import BEAM_LIMIT, BeamBending, bending_notes, largest_bending
from symofros.runtime.calls.kernel import Array
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.actuator_efforts import actuator_efforts
from symofros.simulation.analysis.beam_theory import (
    bendings_at_rest,
    bendings_in_motion,
    beyond_critical_load,
    refuse_beyond,
)
from symofros.simulation.analysis.input_rotations import given_inputs
from symofros.simulation.analysis.kinematics.assembly import free_speeds

# Largest step of a coordinate at once; of a beam's displacements over its length.
LARGEST_STEP = 0.5
# Estimated error of a beam's theory from which it is what a search without success is blamed on.
_BLAMED = 0.05


@dataclass(frozen=True)
class Equilibrium:
    """A state whose speeds do not change.

    Attributes:
        q: Configuration (nq).
        v: Speeds (nv).
        u: Inputs that were given (nu).
        lam: Multipliers (nc).
        effort: Effort that holds the held coordinates (nv); zero for the others [N m or N].
        residual: Largest imbalance, relative to the largest force.
        iterations: Steps taken.
        bendings: Bending of each beam, with the error of its theory.
        notes: Remarks: beams whose theory errs by more than a per cent, or that are loaded beyond their critical load.
        efforts: Effort on each held coordinate by the name of its speed [N m or N].
        inputs: Inputs by name under which the state stays by itself, no coordinate held, those that are no prescribed
            motions of least norm; None where no inputs do. With nothing held, those that were given.
    """

    q: Array
    v: Array
    u: Array
    lam: Array
    effort: Array
    residual: float
    iterations: int
    bendings: tuple[BeamBending, ...] = ()
    notes: tuple[str, ...] = ()
    efforts: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, float] | None = None


@checked
def equilibrium(
    model: Model,
    q: ArrayLike | None = None,
    v: ArrayLike | None = None,
    u: ArrayLike | None = None,
    *,
    held: Collection[str] = (),
    par: ArrayLike | None = None,
    t: float = 0.0,
    tolerance: float = 1e-11,
    iterations: int = 100,
    beam_limit: float = BEAM_LIMIT,
) -> Equilibrium:
    """Solve M 0 + h - Q - G^T lam = 0, phi = 0 for the configuration, by Newton's method with exact derivatives.

    Args:
        model: Model, with or without constraints.
        q: Guess (nq); the neutral configuration if not given.
        v: Speeds that stay (nv), zero if not given: a spin makes it a steady motion.
        u: Inputs (nu).
        held: Names of speeds whose coordinates stay; what they need is returned as their effort, and as inputs where
            these can give it.
        par: Run-time parameters.
        t: Time.
        tolerance: Bound of the imbalance, relative to the largest force.
        iterations: Most steps.
        beam_limit: Estimated error of the beams' second-order theory, relative to the deflection, beyond which there is
            no result (docs/theory/beams.md, section 6); `math.inf` for no limit.

    Raises:
        BeamTheoryError: A beam is bent beyond the limit, or its theory has no equilibrium here.
        EquilibriumError: None was found; names the coordinate with the largest imbalance.
        UnknownNameError: `held` names something that is not a speed.
    """
    model = model.with_precision("double")
    free = free_speeds(model, held)
    nv, nc = model.nv, model.nc
    q = model.neutral() if q is None else numeric("q", model.by_name("q", q))
    v = np.zeros(nv) if v is None else numeric("v", model.by_name("v", v))
    u = given_inputs(model, u)
    lam = np.zeros(nc)

    def residual(at: Array, lam: Array) -> tuple[Array, float]:
        _, h, Q = model.dynamics(at, v, u, par=par, t=t)
        balance, scale = h - Q, max(float(np.abs(h).max(initial=0.0)), float(np.abs(Q).max(initial=0.0)))
        if nc:
            reaction = model.constraint_jacobian(at, u=u, par=par, t=t).T @ lam
            balance, scale = balance - reaction, max(scale, float(np.abs(reaction).max(initial=0.0)))
            return np.concatenate([balance, model.constraint(at, u=u, par=par, t=t)]), scale or 1.0
        return balance, scale or 1.0

    reach = _reach(model, par)
    rows = np.concatenate([free, np.arange(nv, nv + nc)])
    R, scale = residual(q, lam)
    count = 0
    while _size(R[rows], scale, nc) > tolerance and count < iterations:
        by_q = _stiffness(model, q, v, u, lam, par, t)
        G = model.constraint_jacobian(q, u=u, par=par, t=t) if nc else np.zeros((0, nv))
        K = np.zeros((nv + nc, nv + nc))
        K[:nv, :nv], K[:nv, nv:], K[nv:, :nv] = by_q, -G.T, G
        columns = rows
        step = np.zeros(nv + nc)
        step[columns] = -np.linalg.lstsq(K[np.ix_(rows, columns)], R[rows], rcond=1e-13)[0]
        step[:nv] *= min(1.0, LARGEST_STEP / max(float(np.abs(step[:nv] / reach).max(initial=0.0)), 1e-300))
        for _ in range(20):
            tried, lam_tried = model.integrate(q, step[:nv]), lam + step[nv:]
            R_tried, scale_tried = residual(tried, lam_tried)
            if np.linalg.norm(R_tried[rows]) < np.linalg.norm(R[rows]) or count == 0:
                break
            step *= 0.5
        # Forces may vanish one and all at rest: the largest on the way there is what small is measured by.
        q, lam, R, scale, count = tried, lam_tried, R_tried, max(scale, scale_tried), count + 1
    bendings, unstable = _bendings(model, q, v, u, lam, par, t)
    left = _size(R[rows], scale, nc)
    if not left <= max(tolerance, 1e-9):
        _refuse_without_rest(model, bendings, count)
        worst = int(rows[np.argmax(np.abs(R[rows]))])
        names = (*model.names.v, *model.names.constraints)
        raise EquilibriumError(
            Problem(
                f"model '{model.record.name}': no equilibrium was found from this guess",
                f"after {count} steps an imbalance of {R[worst]:.3g} at '{names[worst]}'",
                f"the imbalance is below {tolerance:g} of the largest force",
                "start nearer, give the inputs that hold it, or hold coordinates that have no place of rest",
            )
        )
    refuse_beyond(model, bendings, beam_limit, "the equilibrium")
    effort = np.zeros(nv)
    held_rows = np.setdiff1d(np.arange(nv), free)
    effort[held_rows] = R[held_rows]
    efforts = {model.names.v[i]: float(effort[i]) for i in held_rows}
    inputs = _holding_inputs(model, (q, v, u, lam), effort, par, t)
    notes = unstable + bending_notes(bendings)
    return Equilibrium(q, v, u, lam, effort, left, count, bendings, notes, efforts, inputs)


def _holding_inputs(
    model: Model, state: tuple[Array, Array, Array, Array], effort: Array, par: ArrayLike | None, t: float
) -> dict[str, float] | None:
    """Inputs by name that replace the effort on held coordinates; None where none do, or forces are not linear in them.

    As efforts of chosen actuators (docs/theory/constraints.md, (25)): B u = B u_given + effort + G^T mu.
    """
    q, v, u, lam = state
    if np.any(effort):
        try:
            u = actuator_efforts(model, q, v, np.zeros(model.nv), u=u, par=par, t=t, beam_limit=math.inf).u
        except (ActuationError, UnknownNameError):
            return None
    return dict(zip(model.names.u, u.tolist(), strict=True))


def _size(R: Array, scale: float, nc: int) -> float:
    """The largest imbalance relative to the largest force; residuals of constraints as they are."""
    forces, bound = R[: len(R) - nc], R[len(R) - nc :]
    return max(float(np.abs(forces).max(initial=0.0)) / scale, float(np.abs(bound).max(initial=0.0)))


def _reach(model: Model, par: ArrayLike | None) -> Array:
    """Size of each speed's coordinate for the bound of a step (nv): the length of a beam for displacements along it."""
    reach = np.ones(model.nv)
    for beam in model.beams(par):
        reach[beam.in_v] = 1.0 / beam.scale
    return reach


def _bendings(
    model: Model, q: Array, v: Array, u: Array, lam: Array, par: ArrayLike | None, t: float
) -> tuple[tuple[BeamBending, ...], tuple[str, ...]]:
    """Bending of each beam, and notes on those beyond their critical load."""
    beams = model.beams(par)
    if not beams or not np.all(np.isfinite(q)):
        return (), ()
    if np.any(v):  # Motion stiffens and softens; stability is then no matter of stiffness alone.
        return bendings_in_motion(model, q, v, u, par, t), ()
    K = _stiffness(model, q, v, u, lam, par, t)
    notes = tuple(
        f"beam '{name}' is loaded past its critical load: this rest is unstable"
        for name in beyond_critical_load(beams, q, K)
    )
    return bendings_at_rest(model, q, K, par), notes


def _stiffness(model: Model, q: Array, v: Array, u: Array, lam: Array, par: ArrayLike | None, t: float) -> Array:
    """Derivative of h - Q - G^T lam by q at v' = 0 (nv, nv); at rest by a function that knows no speeds."""
    if np.any(v):
        return model.residual_derivatives(q, v, np.zeros(model.nv), u, lam, par=par, t=t)[0][: model.nv]
    (K,) = model.evaluate("rest_stiffness", q=q, u=u, lam=lam, par=par, t=t)
    return np.asarray(K)


def _refuse_without_rest(model: Model, bendings: tuple[BeamBending, ...], count: int) -> None:
    """Name the theory of the beams where the search has come to its end.

    Raises:
        BeamTheoryError: A beam is so bent, or has so little stiffness left, that its theory may have none.
    """
    worst = largest_bending(bendings)
    if worst is not None and worst.error > _BLAMED:
        raise BeamTheoryError(
            Problem(
                f"model '{model.record.name}': no equilibrium was found, and the theory of its beams may have none",
                f"after {count} steps, where the search has come to: {worst}",
                "strain energy to second order bounds small deflections only; large loads have no equilibrium in it",
                f"smaller loads have one; {worst.remedy}",
            )
        )
