"""Equilibria and steady motions: configurations in which the speeds stay as they are (docs/theory/linear.md)."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from symofros.base.arguments import checked
from symofros.base.arrays import Array, vector
from symofros.errors import ActuationError, BeamTheoryError, EquilibriumError, Problem, UnknownNameError
from symofros.runtime.beams import BEAM_LIMIT, BeamBending, bending_notes, largest_bending
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.actuator_efforts import actuator_efforts
from symofros.simulation.analysis.beam_theory import (
    bendings_at_rest,
    bendings_in_motion,
    beyond_critical_load,
    refuse_beyond,
    with_left_out,
)
from symofros.simulation.analysis.force_states import rest_with_states
from symofros.simulation.analysis.friction import friction_curve
from symofros.simulation.analysis.kinematics.assembly import free_speeds
from symofros.simulation.analysis.kinematics.consistency import Refusal, consistent_jacobian
from symofros.simulation.analysis.mass_matrix import mass_matrix
from symofros.simulation.analysis.reach import reach_of
from symofros.simulation.analysis.rest_linearisation import growing
from symofros.simulation.analysis.rest_search import Balance, Search, leaving
from symofros.simulation.analysis.states import check_search, given_configuration, given_inputs

# Estimated error of a beam's theory from which it is what a search without success is blamed on.
_BLAMED = 0.05
# Changes of speed over which friction is looked at [rad/s or m/s]; joints shown that would creep.
_FRICTION_SPEEDS = np.concatenate([[0.0], np.geomspace(1e-9, 1e3, 193)])
_SHOWN = 6
_STEADY = Refusal(
    EquilibriumError,
    "a motion with these speeds",
    "in a steady motion phi = 0, G v = b and 0 = gamma: the constraints need no acceleration of these speeds",
    "speeds that sf.assemble gives, q and t at which inputs stand still, or coordinates of which v stays the same",
)


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
        notes: Remarks: a rest that is unstable, where forces have a potential; beams whose theory errs by more than a
            per cent, or that are loaded beyond their critical load.
        efforts: Effort on each held coordinate by the name of its speed [N m or N].
        inputs: Inputs by name under which the state stays by itself, no coordinate held, those that are no prescribed
            motions of least norm; None where no inputs do. With nothing held, those that were given.
        z: States of forces (nz).
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
    z: Array = field(default_factory=lambda: np.zeros(0))


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
    z: ArrayLike | None = None,
) -> Equilibrium:
    """Solve M 0 + h - Q - G^T lam = 0, phi = 0 for the configuration, by Newton's method with exact derivatives.

    Where that stalls, a relaxation from the same guess leads towards a stable rest, from where Newton's method goes on.
    States of forces are solved for with it: z' = 0. Where they rest whatever they are, as bristles do, the equilibrium
    is one of many, that of the least change of the guess; a note says so.
    Its matrices are decomposed by NumPy's LAPACK, whose last digits depend on the processor: so do those of the result,
    other than those of runs and of the functions of models.

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
        iterations: Most steps of Newton's method, and of the relaxation.
        beam_limit: Estimated error of the beams' second-order theory, relative to the deflection, beyond which there is
            no result (docs/theory/beams.md, section 6); `math.inf` for no limit.
        z: Guess of the states of forces (nz); the neutral ones, zeros, if not given.

    Raises:
        AssemblyError: A closure is closed the wrong way round.
        BeamTheoryError: A beam is bent beyond the limit, or its theory has no equilibrium here.
        EquilibriumError: None was found; names the coordinate with the largest imbalance. Or the speeds are not those
            of a steady motion on the constraints.
        UnknownNameError: `held` names something that is not a speed.
        SymofrosError: tolerance or iterations is out of range.
    """
    model.record.refuse_rigid_contacts("equilibrium")
    check_search("equilibrium", tolerance, iterations, below=1.0)
    model = model.with_precision("double")
    free = free_speeds(model, held)
    q = model.neutral() if q is None else given_configuration(model, q)
    v = np.zeros(model.nv) if v is None else vector("v", model.by_name("v", v), model.nv)
    u = vector("u", given_inputs(model, u), model.nu)
    moving = model.carried
    q, v = (np.asarray(x) for x in model.carry(q, v, np.zeros(model.nz) if z is None else z))
    at: Any = {"u": u, "par": par, "t": t}
    G = moving.constraint_jacobian(q, **at) if moving.nc else np.zeros((0, moving.nv))
    reach = reach_of(moving, G, mass_matrix(moving, q, v, **at), par)
    balance = Balance(moving, free, np.arange(model.nv, moving.nv), v, u, par, t, reach)
    balance, end, remarks = rest_with_states(balance, q, tolerance, iterations)
    q, v, lam = end.q, end.v, end.lam
    bendings, unstable = _bendings(balance, end)
    left = balance.size(end.R, end.sizes)
    if not left <= max(tolerance, 1e-9):
        _refuse_without_rest(model, bendings, end.count)
        raise EquilibriumError(_no_balance(balance, end, tolerance, remarks))
    moves = np.any(v) or model.record.timed or model.record.prescribed_names
    consistent_jacobian(moving, (q, v, np.zeros(moving.nv) if moves else None, u), par, t, _STEADY)
    refuse_beyond(model, bendings, beam_limit, "the equilibrium")
    effort = np.zeros(model.nv)
    held_rows = np.setdiff1d(np.arange(model.nv), free)
    effort[held_rows] = end.R[held_rows]
    efforts = {model.names.v[i]: float(effort[i]) for i in held_rows}
    q, v, z = q[: model.nq], v[: model.nv], model.states_of(v)
    inputs = _holding_inputs(model, (q, v, u, lam, z), effort, par, t)
    notes = (unstable or _unstable_notes(balance, end)) + bending_notes(bendings) + remarks
    return Equilibrium(q, v, u, lam, effort, left, end.count, bendings, notes, efforts, inputs, z)


def _no_balance(balance: Balance, end: Search, tolerance: float, remarks: tuple[str, ...]) -> Problem:
    """The problem of a failed search for equilibrium: the largest imbalance, and what friction would have to hold."""
    model = balance.model
    worst = int(balance.rows[np.argmax(np.abs(end.R[balance.rows]))])
    names = (*model.names.v, *model.names.constraints)
    found = f"after {end.count} steps an imbalance of {end.R[worst]:.3g} at '{names[worst]}'"
    rule = f"the imbalance is below {tolerance:g} of the largest force"
    remedy = (
        "start nearer, give the inputs that hold it, allow more iterations, or hold coordinates that have no place of"
        " rest"
    )
    found = "; ".join((found, *remarks))
    creeping = _creeping(balance, end, tolerance)
    if creeping:
        loads = "; ".join(
            f"friction of '{name}' carries {load:.3g} in motion only, up to {most:.3g}" for name, load, most in creeping
        )
        found = f"{found}; {loads}"
        rule = f"{rule}; friction is smooth through zero speed and holds nothing at rest: under a load, joints creep"
        remedy = f"hold what friction is to hold, held={[name for name, _, _ in creeping]}; or {remedy}"
    return Problem(f"model '{model.record.name}': no equilibrium was found from this guess", found, rule, remedy)


def _creeping(balance: Balance, end: Search, tolerance: float) -> list[tuple[str, float, float]]:
    """Joints out of balance by less than their friction reaches: name of the speed, imbalance, what is reached."""
    model, creeping = balance.model, list[tuple[str, float, float]]()
    rubbing = [*model.record.friction_speeds, *(one.v for one in model.record.sticking)]
    for i in np.intersect1d(balance.free, rubbing).tolist():
        load = abs(float(end.R[i]))
        if not np.isfinite(load) or load <= tolerance * end.sizes[i] or len(creeping) == _SHOWN:
            continue
        state = (end.q, end.v, np.asarray(balance.u))
        driven = end.v[i] - np.sign(end.R[i]) * _FRICTION_SPEEDS  # As the imbalance accelerates it.
        curve = friction_curve(model, i, driven, state, balance.par, balance.t)
        if curve is not None and load < curve.reached:
            creeping.append((model.names.v[i], load, curve.reached))
    return creeping


def _holding_inputs(
    model: Model, state: tuple[Array, Array, Array, Array, Array], effort: Array, par: ArrayLike | None, t: float
) -> dict[str, float] | None:
    """Inputs by name that replace the effort on held coordinates; None where none do, or forces are not linear in them.

    As efforts of chosen actuators (docs/theory/constraints.md, (25)): B u = B u_given + effort + G^T mu.
    """
    q, v, u, lam, z = state
    if np.any(effort):
        given = {"z": z} if model.nz else {}
        try:
            u = actuator_efforts(model, q, v, np.zeros(model.nv), u=u, par=par, t=t, beam_limit=math.inf, **given).u
        except (ActuationError, UnknownNameError):
            return None
    return dict(zip(model.names.u, u.tolist(), strict=True))


def _bendings(balance: Balance, end: Search) -> tuple[tuple[BeamBending, ...], tuple[str, ...]]:
    """Bending of each beam, and notes on those beyond their critical load."""
    beams, q = balance.model.beams(balance.par), end.q
    if not beams or not np.all(np.isfinite(q)):
        return (), ()
    if np.any(end.v[: balance.n]):  # Motion stiffens and softens; stability is then no matter of stiffness alone.
        moving = bendings_in_motion(balance.model, q, end.v, balance.u, balance.par, balance.t)
        return _with_left_out(balance, end, moving), ()
    K = balance.stiffness(q, end.v, end.lam)
    notes = tuple(
        f"beam '{name}' is loaded past its critical load: this rest is unstable"
        for name in beyond_critical_load(beams, q, K)
    )
    return _with_left_out(balance, end, bendings_at_rest(balance.model, q, K, balance.par)), notes


def _with_left_out(balance: Balance, end: Search, bendings: tuple[BeamBending, ...]) -> tuple[BeamBending, ...]:
    """With what orders leave out while nothing accelerates: held coordinates stay, too."""
    states = np.array([balance.t]), end.q[None], end.v[None], np.asarray(balance.u)[None]
    response = np.zeros((1, balance.model.nv)), end.lam[None]
    return with_left_out(balance.model, bendings, states, balance.par, response)


def _unstable_notes(balance: Balance, end: Search) -> tuple[str, ...]:
    """A note on a rest, or a motion, that does not stay: an upright pendulum's, not a hanging one's."""
    found = growing(balance, end) if balance.moves else leaving(balance, end)
    if found is None:
        return ()
    name = balance.model.names.v[found[0]]
    what, how = ("motion", "") if balance.moves else ("rest", " without damping")
    return (
        f"this {what} is unstable: moved by a little, '{name}' leaves it at {found[1]:.3g} 1/s{how}; guess nearer"
        f" to the {what} that is meant, or hold it",
    )


def _refuse_without_rest(model: Model, bendings: tuple[BeamBending, ...], count: int) -> None:
    """Name the theory of the beams where the search has come to its end.

    Raises:
        BeamTheoryError: A beam is so bent, or has so little stiffness left, that its theory may have none.
    """
    worst = largest_bending(bendings)
    if worst is not None and worst.error > _BLAMED:
        raise BeamTheoryError(
            f"model '{model.record.name}': no equilibrium was found, and the theory of its beams may have none",
            f"after {count} steps, where the search has come to: {worst}",
            "strain energy to second order bounds small deflections only; large loads have no equilibrium in it",
            f"smaller loads have one; {worst.remedy}",
        )
