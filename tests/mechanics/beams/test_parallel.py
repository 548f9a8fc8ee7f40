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


def robot(counts: tuple[int, int, int], foot: np.ndarray, pull: np.ndarray, **more: Any) -> sf.System:
    rotation = sf.Rotation.rpy(0.0, -np.pi / 2, 0.0)
    GJ, EI_y, EI_z = STIFFNESS.tolist()
    given: dict[str, Any] = {"length": 1.0, "rhoA": 1.0, "rhoJ": 0.01, "GJ": GJ, "EI_y": EI_y, "EI_z": EI_z} | more
    load = sf.BeamLoad(tuple(pull.tolist()), at=1.0, axes="world")
    left = rod(counts, sf.Joint("foot", "fixed", rotation=rotation), loads=(load,), **given)
    right = rod(counts, sf.Joint("other foot", "fixed", position=tuple(foot.tolist()), rotation=rotation), **given)
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
        return solve_ivp(slope, (0, 1), start, "DOP853", rtol=1e-10, atol=1e-12).y[:3, -1]

    x = np.concatenate([FOOT / 2 + (0, 0, 0.9), np.zeros(3)])
    for share in (0.5, 1.0):

        def residual(x: np.ndarray, pull: np.ndarray = share * PULL) -> np.ndarray:
            tip, force = x[:3], x[3:]
            return np.concatenate([end(np.zeros(3), tip, force) - tip, end(FOOT, tip, pull - force) - tip])

        x = fsolve(residual, x, xtol=1e-10)
    return x[:3]


def joined_at_rest(counts: tuple[int, int, int], **more: Any) -> np.ndarray:
    """Place of the tips (3), by Newton's method on forces and closure."""
    functions = ("generalized_force", "constraint", "constraint_jacobian", "frame_pose")
    m = sf.compile(robot(counts, FOOT, PULL, **more), sf.Options(functions, ("rod.tip",), backend="interpreter"))
    n = m.nq
    x, width = np.zeros(n + 3), 1e-6 * np.eye(n)

    def residuals(q: np.ndarray, lam: np.ndarray) -> np.ndarray:
        G = m.constraint_jacobian(q)
        return np.concatenate([m.generalized_force(q, 0 * q, ()) + lam @ G, m.constraint(q)], axis=1)

    for _ in range(10):
        q, lam = x[:n], x[n:]
        every = residuals(np.concatenate([q + width, q - width, [q]]), lam)
        K = np.zeros((n + 3, n + 3))
        K[:, :n] = (every[:n] - every[n : 2 * n]).T / 2e-6
        K[:n, n:] = m.constraint_jacobian(q).T
        step = np.linalg.solve(K, every[-1])
        x = x - step * min(1.0, 1.0 / np.abs(step[:n]).max())
    assert np.abs(step).max() < 1e-7
    return m.frame_pose("rod.tip", x[:n])[0]


@pytest.mark.parametrize(
    ("counts", "error"),
    [
        ((2, 2, 1), 2e-3),
        pytest.param((3, 3, 2), 5e-5, marks=pytest.mark.slow),
        pytest.param((6, 6, 5), 1e-8, marks=pytest.mark.slow),
    ],
)
def test_joined_tips_rest_where_exact_rods_do(counts: tuple[int, int, int], error: float) -> None:
    assert joined_at_rest(counts) == pytest.approx(joined_by_shooting(), abs=error)


def test_joined_rods_in_motion_keep_their_energy() -> None:
    """Bent rods in a plane, let go of at rest."""
    m = sf.compile(robot((3, 0, 0), np.array([0.0, 0.3, 0.0]), 0 * PULL, rhoJ=0.0))
    start = sf.assemble(m, np.array([1.2, -0.5, 0.2, 1.0, 0.3, 0.0]))
    run = sf.simulate(m, q0=start.q, t_end=1.0, method="dopri5", rtol=1e-10, atol=1e-11, output=0.1)
    stored, moving = m.potential_energy(run.q), m.kinetic_energy(run.q, run.v)
    assert np.ptp(stored) > 0.2 * stored[0]
    assert np.ptp(stored + moving) < 1e-8 * stored[0]
    assert np.abs(m.constraint(run.q)).max() < 1e-10
