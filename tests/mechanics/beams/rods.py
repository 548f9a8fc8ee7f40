"""Geometrically exact rods for tests, and their sections by an integration that shares nothing with the generator."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import symofros as sf

SECTION: dict[str, Any] = {
    "rhoA": 2.0,
    "EI_z": 3.0,
    "EI_y": 5.0,
    "GJ": 1.5,
    "rhoJ": 0.04,
    "rhoI_y": 0.03,
    "rhoI_z": 0.02,
}
TURNS = ((2, 1.0), (1, -1.0), (0, 1.0))


def rod(counts: tuple[int, int, int], joint: sf.Joint | None = None, length: float = 1.3, **more: Any) -> sf.Beam:
    """A rod of Legendre strains."""
    given: dict[str, Any] = {"family": "legendre", "theory": "strain"} | SECTION | more
    bend_y, bend_z, twist = counts
    root = joint or sf.Joint("root", "fixed")
    return sf.Beam("rod", root, length, bend_y=bend_y, bend_z=bend_z, twist=twist, **given)


def strains(counts: tuple[int, int, int], q: np.ndarray, xi: float) -> np.ndarray:
    """Strains times the length at a station, of Legendre functions."""
    k, start = np.zeros(3), 0
    for count, (axis, sign) in zip(counts, TURNS, strict=True):
        k[axis] += sign * np.polynomial.legendre.legval(2 * xi - 1, q[start : start + count]) if count else 0.0
        start += count
    return k


def integrated(counts: tuple[int, int, int], q: np.ndarray, stations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions over the length (s, 3) and rotations (s, 3, 3), by an adaptive method on the nine entries of R."""

    def slope(xi: float, state: np.ndarray) -> np.ndarray:
        R = state[3:].reshape(3, 3)
        x, y, z = strains(counts, q, xi)
        return np.concatenate([R[:, 0], (R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])).ravel()])

    start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
    run = solve_ivp(slope, (0, 1), start, method="DOP853", t_eval=stations, rtol=1e-12, atol=1e-13)
    return run.y[:3].T, run.y[3:].T.reshape(-1, 3, 3)
