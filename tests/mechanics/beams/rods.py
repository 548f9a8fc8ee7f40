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
# Against stretch and shear, which rods have.
STIFF = {"EA": 40.0, "GA_y": 25.0, "GA_z": 20.0}
GRAVITY = (1.0, -2.0, -9.5)
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


BODY = sf.Inertia(0.7, (0.1, -0.05, 0.08), (0.02, 0.03, 0.025))
HUB = sf.Joint("hub", "revolute", axis=(1, 1, 0), position=(0.1, 0.2, 0.0))
ALL: dict[str, Any] = {"rotary_inertia": True, "curvature_y": 0.3, "twist_rate": "0.2*x", "damping": 0.03}
STATIONS = (sf.Frame("tip"), sf.Frame("middle", at=0.5), sf.Frame("quarter", at=0.25))
# Rods with the frames that carry a body.
FOLLOWING = (
    sf.BeamLoad((-0.4, 0.3, 0.2), (0.1, 0.2, -0.1), at=0.7, axes="section"),
    sf.BeamLoad(("0.2*x", 0.3, 0.0), axes="section"),
)
# Sections whose centres are three points that wander along the rod, and whose axes are not principal ones.
OFF_AXIS: dict[str, Any] = {
    "tension_center": (0.06, "0.02*x"),
    "shear_center": ("0.04 - 0.03*x", -0.05),
    "mass_center": ("0.03 + 0.02*x", 0.07),
    "EI_yz": 1.2,
    "rhoI_yz": -0.011,
}
# A section that couples every strain with every other.
_SIZES = np.sqrt([40.0, 25.0, 20.0, 1.5, 5.0, 3.0])
_SHARES = np.eye(6) + 0.12 * np.array([[(-1.0) ** (i * j // 2) * (i != j) for j in range(6)] for i in range(6)])
MATRIX = tuple(map(tuple, (_SIZES[:, None] * _SHARES * _SIZES).tolist()))
COUPLED: dict[str, Any] = {"stiffness": MATRIX, "EI_y": 0.0, "EI_z": 0.0, "GJ": 0.0}
CASES: dict[str, tuple[sf.Beam, tuple[str, ...]]] = {
    "clamped, in a plane": (rod((3, 0, 0)), ()),
    "in the other plane, at a hub, with a body": (rod((0, 2, 0), HUB, rhoA="2 + x"), ("tip",)),
    "free in space, curved and twisted without stress": (rod((1, 1, 1), sf.Joint("base", "free"), **ALL), ()),
    "in space, with a body": (rod((2, 1, 1), HUB), ("tip",)),
    "under loads that follow its sections": (rod((2, 0, 1), loads=FOLLOWING, damping=0.03), ()),
    "a shaft": (rod((0, 0, 2), HUB), ("tip",)),
    "stretched and sheared in a plane": (rod((2, 0, 0), HUB, stretch=1, shear_y=2, **STIFF), ("tip",)),
    "stretched and sheared in space": (rod((1, 1, 1), HUB, stretch=1, shear_y=1, shear_z=1, **ALL, **STIFF), ("tip",)),
    "off the centres of its sections": (rod((2, 1, 1), HUB, **OFF_AXIS, rotary_inertia=True, damping=0.03), ("tip",)),
    "off the centres, stretched and sheared along y": (
        rod((1, 1, 1), HUB, stretch=1, shear_y=1, **ALL, **OFF_AXIS, **STIFF, rhoA="2 + x"),
        ("tip",),
    ),
    "off the centres, in a plane": (rod((2, 0, 0), HUB, tension_center=(0.1, 0.0), mass_center=(0.05, 0.0)), ("tip",)),
    "with every strain coupled": (rod((1, 1, 1), HUB, stretch=1, **COUPLED), ("tip",)),
    "in a plane, with bodies along it": (rod((2, 0, 0), HUB, frames=STATIONS), ("middle", "tip", "quarter")),
}


def rod_system(name: str) -> sf.System:
    """A case, with a body on each frame that carries one."""
    stated, loaded = CASES[name]
    bodies = (
        sf.RigidBody(f"on {frame}", sf.Joint(f"joint {frame}", "revolute", "rod", frame, axis=(0, 1, 0)), BODY)
        for frame in loaded
    )
    return sf.System("s", (stated, *bodies), gravity=GRAVITY)
