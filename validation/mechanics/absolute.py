"""Bodies of a tree one by one: poses and velocities from joints, and joints' accelerations from those of bodies.

For engines that give every body coordinates of its own. World axes throughout.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .assembly import BASE, Assembly, Mover
from .geometry import Array, Placement, about_axis, quaternion_matrix


@dataclass(frozen=True)
class Moving:
    """One body: its frame, and how it moves.

    Attributes:
        X: Placement in the world.
        v: Velocity of its origin (3,).
        w: Angular velocity (3,).
    """

    X: Placement
    v: Array
    w: Array


GROUND = Moving(Placement.identity(), np.zeros(3), np.zeros(3))


def bodies(assembly: Assembly, q: Array, v: Array) -> list[Moving]:
    """Every moving body at one state, q (nq,) and v (nv,)."""
    moving: list[Moving] = []
    for mover in assembly.movers:
        parent = GROUND if mover.parent == BASE else moving[mover.parent]
        P = parent.X @ mover.X_AP
        X = P @ _across(mover, q[mover.q])
        rate = v[mover.v]
        speed, turning = np.zeros(3), np.zeros(3)
        if mover.kind == "revolute":
            turning = P.R @ mover.axis * rate[0]
        elif mover.kind == "prismatic":
            speed = P.R @ mover.axis * rate[0]
        else:
            turning = X.R @ rate[-3:]
            speed = X.R @ rate[:3] if mover.kind == "free" else speed
        carried = parent.v + np.cross(parent.w, X.p - parent.X.p)
        moving.append(Moving(X, carried + speed, parent.w + turning))
    return moving


def _across(mover: Mover, q: Array) -> Placement:
    if mover.kind == "revolute":
        return Placement(about_axis(mover.axis, float(q[0])), np.zeros(3))
    if mover.kind == "prismatic":
        return Placement(np.eye(3), mover.axis * q[0])
    return Placement(quaternion_matrix(q[-4:]), q[:3] if mover.kind == "free" else np.zeros(3))


def joint_accelerations(assembly: Assembly, moving: list[Moving], a: Array, alpha: Array) -> Array:
    """The v' (nv,) of joints whose bodies have accelerations a of their origins and alpha (bodies, 3).

    Where bodies keep their joints, the parts that a joint does not allow are zero, and are not looked at.
    """
    rates = np.zeros(assembly.nv)
    for i, mover in enumerate(assembly.movers):
        body = moving[i]
        parent, a_A, alpha_A = GROUND, np.zeros(3), np.zeros(3)
        if mover.parent != BASE:
            parent, a_A, alpha_A = moving[mover.parent], a[mover.parent], alpha[mover.parent]
        axis = parent.X.R @ mover.X_AP.R @ mover.axis
        r = body.X.p - parent.X.p
        carried = a_A + np.cross(alpha_A, r) + np.cross(parent.w, np.cross(parent.w, r))
        # Seen from the parent, and then differentiated in the body's own axes.
        w = body.w - parent.w
        v = body.v - parent.v - np.cross(parent.w, r)
        if mover.kind == "revolute":
            rates[mover.v] = axis @ (alpha[i] - alpha_A)
        elif mover.kind == "prismatic":
            rates[mover.v] = axis @ (a[i] - carried)
        else:
            turned = body.X.R.T @ (alpha[i] - alpha_A - np.cross(body.w, w))
            if mover.kind == "free":
                moved = a[i] - carried - np.cross(parent.w, v)
                turned = np.concatenate([body.X.R.T @ (moved - np.cross(body.w, v)), turned])
            rates[mover.v] = turned
    return rates


def work_rows(assembly: Assembly, moving: list[Moving]) -> Array:
    """Rows (nv, 6 bodies) that give v from the velocities (linear; angular) of the bodies, for simple joints.

    Their transpose turns joint forces into forces and torques on the bodies.
    """
    rows = np.zeros((assembly.nv, 6 * len(moving)))
    for i, mover in enumerate(assembly.movers):
        body, parent = moving[i], GROUND if mover.parent == BASE else moving[mover.parent]
        own = slice(6 * i, 6 * i + 6)
        R_PW = (parent.X.R @ mover.X_AP.R).T
        if mover.kind == "revolute":
            linear, angular = np.zeros((1, 3)), (mover.axis @ R_PW)[None]
        elif mover.kind == "prismatic":
            linear, angular = (mover.axis @ R_PW)[None], np.zeros((1, 3))
        else:
            R_BW = body.X.R.T
            linear, angular = np.zeros((3, 3)), R_BW
            if mover.kind == "free":
                linear, angular = np.vstack([R_BW, np.zeros((3, 3))]), np.vstack([np.zeros((3, 3)), R_BW])
        rows[mover.v, own] = np.hstack([linear, angular])
        if mover.parent != BASE:
            r = body.X.p - parent.X.p
            # v_A + w_A x r, and w_A, are taken off.
            under = slice(6 * mover.parent, 6 * mover.parent + 6)
            rows[mover.v, under] = -np.hstack([linear, angular + np.cross(r, linear)])
    return rows
