"""Inverse dynamics with chosen actuators: trees and closed mechanisms (docs/theory/constraints.md, section 11)."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arguments import checked
from symofros.base.arrays import Array, numeric, vector
from symofros.errors import ActuationError, ShapeError, UnknownNameError, did_you_mean
from symofros.runtime.beams import BEAM_LIMIT, BeamBending, bending_notes
from symofros.runtime.constrained import Eliminated, eliminate, free_motions, natural_sizes, pseudo_inverse
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.beam_theory import Motion, bendings_under_efforts, refuse_beyond
from symofros.simulation.analysis.kinematics.consistency import consistent_jacobian, place_in_batch
from symofros.simulation.analysis.states import given_inputs

# Share of the terms of a sum below which it is their rounding.
ROUNDING = 1e-12
# Smallest singular value of Z^T B that counts, rows and columns brought to one size.
RANK = 1e-10
# Imbalance relative to the sum of the sizes of its terms: what accelerations of forward dynamics leave where the
# condition of M is 1e7.
BALANCE = 1e-8


@dataclass(frozen=True)
class ActuatorEfforts:
    """Efforts that produce a motion, and the forces of the constraints in it.

    Attributes:
        actuators: Names of the actuators.
        efforts: Effort of each actuator (..., actuators) [N m or N].
        lam: Multipliers (..., nc), of least norm where conditions repeat each other.
        u: Inputs, with the efforts of those actuators that are inputs (..., nu).
        redundancy: Number of independent combinations of efforts that move nothing (...,); zero where they are unique.
        bendings: Largest bending of each beam, with the error of its theory.
        notes: Remarks: beams whose theory errs by more than a per cent.
    """

    actuators: tuple[str, ...]
    efforts: Array
    lam: Array
    u: Array
    redundancy: Array
    bendings: tuple[BeamBending, ...] = ()
    notes: tuple[str, ...] = ()


class _State(NamedTuple):
    """Terms of one state: M a + h = Q + B tau + G^T lam, without the efforts in Q; G has no rows for trees."""

    a: Array
    M: Array
    h: Array
    Q: Array
    B: Array
    G: Array


@checked
def actuator_efforts(
    model: Model,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    actuators: Collection[str] | None = None,
    *,
    u: ArrayLike | None = None,
    sizes: npt.ArrayLike | None = None,
    par: ArrayLike | None = None,
    t: ArrayLike = 0.0,
    beam_limit: float = BEAM_LIMIT,
    z: ArrayLike | None = None,
) -> ActuatorEfforts:
    """The efforts of chosen actuators that make a mechanism move as given, loops closed.

    Unique where there are as many actuators as the motion has freedoms; of least norm where there are more. The motion
    must meet the constraints: phi = 0, G v = b, G a = gamma. The efforts of prescribed motions follow from the result:
    `model.prescribed_efforts(q, v, a, result.u, result.lam)`.

    Args:
        model: Model, with or without constraints.
        q: Configuration (..., nq), on the constraints.
        v: Speeds (..., nv).
        a: Rates of the speeds (..., nv).
        actuators: Names of inputs, on which the forces depend linearly, and of speeds, on whose joints an effort acts
            then; all inputs but prescribed motions, if not given.
        u: Other inputs and prescribed motions (..., nu); what it states of the actuators does not count.
        sizes: Size of the effort of each actuator (actuators): the norm is that of efforts over sizes; ones if not
            given, which weigh 1 N as 1 N m.
        par: Run-time parameters (..., npar).
        t: Time (...,).
        beam_limit: Estimated error of the beams' second-order theory, relative to the deflection, beyond which there is
            no result (docs/theory/beams.md, section 6); `math.inf` for no limit.
        z: States of forces (..., nz); the neutral ones, zeros, if not given.

    Raises:
        BeamTheoryError: A beam is bent beyond the limit.
        UnknownNameError: An actuator is neither an input nor a speed.
        ShapeError: An array does not fit.
        SymofrosError: A quaternion among the inputs is no rotation.
        ActuationError: An actuator is named twice, the motion violates the constraints, or these actuators can't
            produce it; says where, and by how much.
    """
    model = model.with_precision("double")
    names = _names(model, actuators)
    accelerations = _vector("a", model.by_name("a", a), model.nv)
    weights = np.ones(len(names)) if sizes is None else vector("sizes", sizes, len(names))
    stated = [model.names.u.index(name) for name in names if name in model.names.u]
    others = np.array(_vector("u", given_inputs(model, u), model.nu))
    others[..., stated] = 0.0
    given: dict[str, Any] = {"par": par, "t": t} | ({} if z is None else {"z": z})
    M, h, Q = model.dynamics(q, v, others, **given)
    B = _columns(model, names, (q, v, others), Q, given)
    G = consistent_jacobian(model, (q, v, accelerations, others), par, t)
    batch = np.broadcast_shapes(h.shape[:-1], accelerations.shape[:-1])
    terms = _State(
        *(
            np.broadcast_to(x, batch + x.shape[-n:])
            for x, n in zip((accelerations, M, h, Q, B, G), (1, 2, 1, 1, 2, 2), strict=True)
        )
    )
    efforts, lam = np.empty((*batch, len(names))), np.empty((*batch, model.nc))
    redundancy = np.empty(batch, dtype=int)
    for index in np.ndindex(batch):
        state = _State(*(array[index] for array in terms))
        efforts[index], lam[index], redundancy[index] = _solve(model, names, state, weights, index)
    inputs = np.array(np.broadcast_to(others, (*batch, model.nu)))
    for k, name in enumerate(names):
        if name in model.names.u:
            inputs[..., model.names.u.index(name)] = efforts[..., k]
    _check_linear(model, terms, efforts, model.generalized_force(q, v, inputs, **given), names)
    bendings: tuple[BeamBending, ...] = ()
    if model.beams():
        values = model.parameter_values if par is None else model.by_name("par", par)
        moving = model.carried  # Rates of states of forces have no part in the balance of forces.
        rates = np.zeros((*accelerations.shape[:-1], model.nz))
        states = np.zeros(model.nz) if z is None else z
        carried = [np.asarray(x) for x in model.carry(model.by_name("q", q), v, states)]
        motion = [*carried, np.concatenate([accelerations, rates], axis=-1), inputs, lam, values]
        widths = moving.nq, moving.nv, moving.nv, model.nu, model.nc, model.npar
        rows = [np.array(np.broadcast_to(x, (*batch, n))) for x, n in zip(motion, widths, strict=True)]
        flat = Motion(*(x.reshape(math.prod(batch), n) for x, n in zip(rows, widths, strict=True)))
        bendings = bendings_under_efforts(moving, flat, np.broadcast_to(np.asarray(t, dtype=np.float64), batch).ravel())
    refuse_beyond(model, bendings, beam_limit, "the motion")
    return ActuatorEfforts(names, efforts, lam, inputs, redundancy, bendings, bending_notes(bendings))


def _names(model: Model, actuators: Collection[str] | None) -> tuple[str, ...]:
    """Names of the actuators, each an input that prescribes no motion, or a speed."""
    inputs = model.names.u[: model.nu - model.record.driven]
    if actuators is None:
        return inputs
    known = (*inputs, *(name for name in model.names.v if name not in inputs))
    for name in actuators:
        if name not in known:
            raise UnknownNameError(
                f"model '{model.record.name}': no actuator '{name}'",
                ", ".join(known[:12]) or "neither inputs nor speeds",
                "an actuator is an input that prescribes no motion, or a speed",
                did_you_mean(name, known) or "name one of these",
            )
    twice = [name for name, times in Counter(actuators).items() if times > 1]
    if twice:
        raise ActuationError(
            f"model '{model.record.name}': an actuator is named more than once",
            ", ".join(f"'{name}'" for name in twice),
            "each actuator has one effort, in the order of their names",
            "name each once",
        )
    return tuple(actuators)


def _vector(name: str, values: npt.ArrayLike, size: int) -> Array:
    array = numeric(name, values)
    if array.ndim == 0 or array.shape[-1] != size:
        raise ShapeError(f"{name} has the wrong shape", str(array.shape), f"{name} has shape (..., {size})", "mend it")
    return array


def _columns(
    model: Model,
    names: tuple[str, ...],
    state: tuple[ArrayLike, ArrayLike, Array],
    Q: Array,
    given: Mapping[str, Any],
) -> Array:
    """B (..., nv, actuators), dQ/du of forces linear in u: a difference, at inputs large enough to cancel no digits."""
    q, v, others = state
    large = np.maximum(1.0, np.abs(Q).max(axis=-1, initial=0.0))[..., None]
    columns = [np.zeros_like(Q) for _ in names]
    for column, name in zip(columns, names, strict=True):
        if name in model.names.u:
            unit = np.eye(model.nu)[model.names.u.index(name)]
            column[...] = (model.generalized_force(q, v, others + large * unit, **given) - Q) / large
        else:
            column[..., model.names.v.index(name)] = 1.0
    return np.stack(columns, axis=-1) if columns else np.zeros((*Q.shape, 0))


def _solve(
    model: Model, names: tuple[str, ...], state: _State, sizes: Array, index: tuple[int, ...]
) -> tuple[Array, Array, int]:
    """Efforts, multipliers and the redundancy of one state (eqs. 25-27); NaN where a term is not finite."""
    a, M, h, Q, B, G = state
    if not all(np.all(np.isfinite(term)) for term in state):
        return np.full(len(names), np.nan), np.full(model.nc, np.nan), 0
    measures = model.record.measures
    Z, free, natural = np.eye(model.nv), np.arange(model.nv), np.zeros((model.nv, model.nv))
    if model.nc:
        eliminated = eliminate(G, measures, np.diag(M))
        Z, free = free_motions(eliminated, model.nv)
        natural = _sizes_of_motions(eliminated, natural_sizes(G, measures), free)
    r = M @ a + h - Q
    A, noise = Z.T @ B * sizes, (np.abs(Z) + natural).T @ np.abs(B) * sizes
    A[np.abs(A) <= ROUNDING * noise] = 0.0
    tau, rank = _least_norm(A, Z.T @ r)
    tau = sizes * tau
    terms = np.abs(Z.T) @ (np.abs(M) @ np.abs(a) + np.abs(h) + np.abs(Q) + np.abs(B) @ np.abs(tau))
    left = Z.T @ (r - B @ tau)
    excess = np.abs(left) - BALANCE * terms
    if excess.max(initial=0.0) > 0.0:
        worst = int(np.argmax(excess))
        raise ActuationError(
            f"model '{model.record.name}': {_listed(names)} can't produce the motion{place_in_batch(index)}",
            f"{rank} independent efforts for {len(free)} freedoms; {left[worst]:.3g} is left at speed"
            f" '{model.names.v[free[worst]]}'",
            "the efforts of the actuators produce every motion, or this one happens to need no others",
            "name more actuators, or give the accelerations that forward_dynamics finds",
        )
    return tau, pseudo_inverse(G, measures).T @ (r - B @ tau), len(names) - rank


def _sizes_of_motions(eliminated: Eliminated, sizes: Array, free: npt.NDArray[np.intp]) -> Array:
    """Natural size of each entry of Z (nv, free), by which what is left at a dead centre counts as rounding."""
    natural = np.zeros((sizes.shape[1], len(free)))
    for row, column in zip(eliminated.rows, eliminated.columns, strict=True):
        natural[column] = sizes[row, free] / sizes[row, column]
    return natural


def _least_norm(A: Array, b: Array) -> tuple[Array, int]:
    """The x of least norm with A x = b, in the sense of least squares if there is none, and the rank of A."""
    if not A.size:
        return np.zeros(A.shape[1]), 0
    largest = np.abs(A).max(axis=1)
    by_row = 1.0 / np.where(largest > 0.0, largest, 1.0)
    even = by_row[:, None] * A
    columns = np.abs(even).max(axis=0)
    values = np.linalg.svd(even / np.where(columns > 0.0, columns, 1.0), compute_uv=False)
    rank = int(np.sum(values > RANK * values.max(initial=0.0)))
    U, s, Vt = np.linalg.svd(even, full_matrices=False)
    return Vt[:rank].T @ ((U[:, :rank].T @ (by_row * b)) / s[:rank]), rank


def _check_linear(model: Model, terms: _State, efforts: Array, force: Array, names: tuple[str, ...]) -> None:
    """Refuse inputs on which the forces do not depend linearly: Q at the inputs found must be Q + B tau."""
    stated = [k for k, name in enumerate(names) if name in model.names.u]
    made = terms.Q + (terms.B[..., stated] @ efforts[..., stated, None])[..., 0]
    size = np.abs(terms.Q) + (np.abs(terms.B[..., stated]) @ np.abs(efforts[..., stated, None]))[..., 0]
    excess = np.abs(force - made) - BALANCE * size
    if excess.max(initial=0.0) > 0.0:
        *index, k = (int(i) for i in np.unravel_index(int(np.argmax(excess)), excess.shape))
        raise ActuationError(
            f"model '{model.record.name}': forces not linear in {_listed(names)}{place_in_batch(tuple(index))}",
            f"at speed '{model.names.v[k]}' the efforts found give {force[(*index, k)]:.6g}, a linear law"
            f" {made[(*index, k)]:.6g}",
            "an actuator's force is proportional to its input",
            "name the speeds of the joints that the actuators drive instead",
        )


def _listed(names: tuple[str, ...]) -> str:
    shown = ", ".join(f"'{name}'" for name in names[:6]) + (", ..." if len(names) > 6 else "")
    return f"actuators {shown}" if names else "no actuators"
