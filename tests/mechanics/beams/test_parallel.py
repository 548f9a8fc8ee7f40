"""Two rods whose tips are joined, a parallel robot: rest against shooting in space, motion that keeps its energy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import symofros as sf
from tests.mechanics.beams.rods import rod

# GJ, EI_y, EI_z of rods of unit length, which stand upright; the second foot; a force on the first tip.
STIFFNESS, FOOT, PULL = np.array([0.8, 1.0, 1.5]), np.array([0.3, 0.1, 0.0]), np.array([0.9, 1.2, -0.5])
UPRIGHT = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]).T  # x of the root is up.


def robot(counts: tuple[int, int, int], pull: np.ndarray, **more: Any) -> sf.System:
    rotation = sf.Rotation("matrix", tuple(UPRIGHT.ravel())) if hasattr(sf.Rotation, "matrix") else None
    rotation = rotation or sf.Rotation.rpy(0.0, -np.pi / 2, 0.0)
    GJ, EI_y, EI_z = STIFFNESS.tolist()
    given: dict[str, Any] = {"length": 1.0, "rhoA": 1.0, "rhoJ": 0.01, "GJ": GJ, "EI_y": EI_y, "EI_z": EI_z} | more
    load = sf.BeamLoad(tuple(pull.tolist()), at=1.0, axes="world")
    left = rod(counts, sf.Joint("foot", "fixed", rotation=rotation), loads=(load,), **given)
    right = rod(counts, sf.Joint("other foot", "fixed", position=tuple(FOOT.tolist()), rotation=rotation), **given)
    closure = sf.Closure("tips", ("rod", "tip"), ("right", "tip"))
    return sf.System("s", (left, replace(right, name="right")), gravity=(0, 0, 0), constraints=(closure,))


def joined_by_shooting() -> np.ndarray:
    """Place of the tips (3): moments in each rod are those of the force on its tip, of which there are two."""

    def end(foot: np.ndarray, tip: np.ndarray, force: np.ndarray) -> np.ndarray:
        def slope(_: float, state: np.ndarray) -> np.ndarray:
            R = state[3:].reshape(3, 3)
            x, y, z = R.T @ np.cross(tip - state[:3], force) / STIFFNESS
            return np.concatenate([R[:, 0], (R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])).ravel()])

        start = np.concatenate([foot, UPRIGHT.ravel()])
        return solve_ivp(slope, (0, 1), start, "DOP853", rtol=1e-11, atol=1e-12).y[:3, -1]

    x = np.concatenate([FOOT / 2 + (0, 0, 0.9), np.zeros(3)])
    for share in (0.0, 0.5, 1.0):

        def residual(x: np.ndarray, pull: np.ndarray = share * PULL) -> np.ndarray:
            tip, force = x[:3], x[3:]
            return np.concatenate([end(np.zeros(3), tip, force) - tip, end(FOOT, tip, pull - force) - tip])

        x = fsolve(residual, x, xtol=1e-12)
    return x[:3]


def joined_at_rest(counts: tuple[int, int, int], **more: Any) -> np.ndarray:
    """Place of the tips (3), by Newton's method on forces and closure."""
    functions = ("generalized_force", "constraint", "constraint_jacobian", "frame_pose")
    m = sf.compile(robot(counts, PULL, **more), sf.Options(functions, ("rod.tip",), backend="interpreter"))
    n = m.nq
    x, width = np.zeros(n + 3), 1e-6 * np.eye(n)

    def residuals(q: np.ndarray, lam: np.ndarray) -> np.ndarray:
        G = m.constraint_jacobian(q)
        return np.concatenate([m.generalized_force(q, 0 * q, ()) + lam @ G, m.constraint(q)], axis=1)

    for _ in range(25):
        q, lam = x[:n], x[n:]
        every = residuals(np.concatenate([q + width, q - width, [q]]), lam)
        K = np.zeros((n + 3, n + 3))
        K[:, :n] = (every[:n] - every[n : 2 * n]).T / 2e-6
        K[:n, n:] = m.constraint_jacobian(q).T
        step = np.linalg.solve(K, every[-1])
        x = x - step * min(1.0, 0.5 / np.abs(step[:n]).max())
    assert np.abs(step).max() < 1e-7
    return m.frame_pose("rod.tip", x[:n])[0]


def test_joined_tips_rest_where_exact_rods_do() -> None:
    assert joined_at_rest((3, 3, 2)) == pytest.approx(joined_by_shooting(), abs=1e-3)


def test_joined_rods_in_motion_keep_their_energy() -> None:
    options = sf.Options(("forward_dynamics", "kinetic_energy", "potential_energy", "constraint"), ())
    m = sf.compile(robot((2, 0, 0), 0 * PULL, curvature_z=0.2), options)
    q = m.assemble(m.neutral()) if hasattr(m, "assemble") else m.neutral()
    assert q is not None
