"""Accelerations and multipliers where balls of rigid contacts slide (docs/theory/constraints.md, (41))."""

from __future__ import annotations

from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.native import native_number
from symofros.runtime.model import Model
from symofros.runtime.record import SLIDES, RigidContactRecord

_STILL = native_number("stepping/contacts/sticking.c", "SYM_RESTS_AT")
_PASSED_REST = native_number("stepping/contacts/sliding_contacts.c", "SYM_PASSED_REST")


def contact_dynamics(
    model: Model, states: tuple[Array, Array, Array, Array], par: Array, **given: Any
) -> tuple[Array, Array]:
    """Accelerations (n, nv) and multipliers (n, nc) by the modes of rigid contacts, friction of sliding balls included.

    Where a contact would pull, and the next state is the same but for its modes, those of the next are given: there
    the force has jumped past zero, and the modes that follow hold at that instant (docs/theory/constraints.md, (40)).

    Args:
        model: The model.
        states: t (n), q (n, nq), v (n, nv), u (n, nu), in the order of time.
        par: Run-time parameters (npar) or (n, npar).
        given: States of forces, as z.
    """
    a, lam = _dynamics_by_modes(model, states, par, **given)
    normals = [ball.rows[2] for ball in model.record.rigid_contacts]
    pulling = (lam[:-1, normals] < 0).any(axis=1)
    for first in reversed(np.flatnonzero(pulling)):
        if all(np.allclose(x[first], x[first + 1], rtol=1e-9, atol=1e-9) for x in states[:3]):
            a[first], lam[first] = a[first + 1], lam[first + 1]
    return a, lam


def _dynamics_by_modes(
    model: Model, states: tuple[Array, Array, Array, Array], par: Array, **given: Any
) -> tuple[Array, Array]:
    """As `contact_dynamics`, each state by its own modes."""
    t, q, v, u = states
    a, lam, _ = model.constrained_dynamics(q, v, u, par=par, t=t, **given)
    balls, rows = model.record.rigid_contacts, np.broadcast_to(par, (len(t), model.npar))
    sliding = np.stack([rows[:, ball.mode] == SLIDES for ball in balls], axis=1) if balls else np.zeros((0, 0))
    if not sliding.any():
        return a, lam
    n, normal = len(balls), [ball.rows[2] for ball in balls]
    change_a, change_lam = np.zeros((len(t), n, model.nv)), np.zeros((len(t), n, model.nc))
    drags, of_balls = np.zeros((len(t), n, 2)), _states_of_balls(model, states, rows, given.get("z"))
    for j, ball in enumerate(balls):
        friction = sliding[:, j] * of_balls[:, j, 4]
        drags[:, j] = -friction[:, np.newaxis] * _direction(ball, of_balls[:, j, 1:3], rows)
        pushed = rows.copy()
        pushed[:, list(ball.pushes[:2])] = drags[:, j]
        a_j, lam_j, _ = model.constrained_dynamics(q, v, u, par=pushed, t=t, **given)
        change_a[:, j], change_lam[:, j] = a_j - a, lam_j - lam
    matrix = np.eye(n) - np.swapaxes(change_lam[:, :, normal], 1, 2)
    force = np.linalg.solve(matrix, lam[:, normal][..., np.newaxis])[..., 0]
    a, lam = (x + np.einsum("nj,njk->nk", force, change) for x, change in ((a, change_a), (lam, change_lam)))
    for j, ball in enumerate(balls):
        lam[:, list(ball.rows[:2])] += drags[:, j] * force[:, j, np.newaxis]
    return a, lam


def _states_of_balls(model: Model, states: tuple[Array, Array, Array, Array], rows: Array, z: Array | None) -> Array:
    """State of each ball (n, number of balls, entries), as of `Model.contact_state`."""
    t, q, v, u = states
    kernel = model.carried.contact_state()
    given: dict[str, Any] = {**dict(zip("qv", model.carry(q, v, z), strict=True)), "t": t[:, np.newaxis], "u": u}
    inputs = [given[group] for group, _ in kernel.signature.inputs]
    found: Array = np.asarray(kernel.run(len(rows), kernel.prepare(rows), inputs)[0])
    return found.reshape(len(rows), len(model.record.rigid_contacts), -1)


def _direction(ball: RigidContactRecord, slip: Array, rows: Array) -> Array:
    """Direction in which a ball slides (n, 2): that of its slip or, without one, that in which it began."""
    way = rows[:, list(ball.way[:2])]
    size = np.linalg.norm(slip, axis=1, keepdims=True)
    along = np.where((slip * way).sum(axis=1, keepdims=True) < _PASSED_REST * size, -1.0, 1.0)
    direction: Array = np.where(size > _STILL, along * slip / np.maximum(size, _STILL), way)
    return direction
