"""Energies of states, and sizes of speeds in their norm, in which metres and radians a second have one unit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import SymofrosError
from symofros.simulation.stepping.stepper import Stepper


def metrics(stepper: Stepper, q: Array, u: Array) -> Array:
    """Mass matrices (n, nv, nv) at configurations (n, nq); units where the model has no mass matrix."""
    model = stepper.model
    try:  # What every model is compiled with, but for Options.functions.
        M: Array = model.dynamics(q, np.zeros(model.nv), u, par=stepper.par)[0]
    except SymofrosError:
        M = np.broadcast_to(np.eye(model.nv), (len(q), model.nv, model.nv))
    return M


def energy_norms(stepper: Stepper, q: Array, u: Array, v: Array) -> Array:
    """The root of v^T M v for each row of speeds (n, nv), without overflow."""
    return norms_in(metrics(stepper, q, u), v)


def norms_in(metric: Array, v: Array) -> Array:
    """The root of v^T M v for each row of speeds (n, nv) in metrics M (n, nv, nv), without overflow."""
    sizes = np.abs(v).max(axis=1, initial=0.0)
    unit = v / np.where(sizes > 0.0, sizes, 1.0)[:, np.newaxis]
    squares = np.einsum("ni,nij,nj->n", unit, metric, unit)
    norms: Array = sizes * np.sqrt(np.maximum(squares, 0.0))
    return norms


def energies_of(stepper: Stepper, states: Sequence[Array]) -> tuple[Array, Array] | None:
    """Kinetic and total energy (n) of records; None where motions are prescribed or the model has no energies."""
    model, (t, q, v, u) = stepper.model, states
    if model.record.driven or not (np.isfinite(q).all() and np.isfinite(v).all()):
        return None
    try:
        kinetic = model.kinetic_energy(q, v, u=u, par=stepper.par)
        return kinetic, kinetic + model.potential_energy(q, u=u, par=stepper.par, t=t)
    except SymofrosError:  # Options.functions left them out.
        return None
