"""Spacecraft in many digits: trees on a free hub, their accelerations, energy, angular momentum, and a step."""

from __future__ import annotations

import numpy as np

from .. import derived, steps
from ..arithmetic import Exact
from ..derived import TruthOf
from ..dynamics import Point, Truth


def _energy(t: Truth, s: Point) -> Exact:
    return np.array([t.T(s.q, s.v) + t.own.stored(s.q)])


def _after_step(t: Truth, s: Point) -> Exact:
    end = steps.runge_kutta(steps.CLASSICAL, on_manifold=True)(t, s._replace(v=s.v2))
    return t.kinematics.flat_poses(end[: len(s.q)])


SPACECRAFT: dict[str, tuple[str, TruthOf]] = {
    "craft_accelerations": ("M^-1 (tau + Q - h) (nv)", lambda t, s: t.FD(s.q, s.v, s.tau)),
    "craft_accelerations_coasting": ("M^-1 (Q - h) (nv)", lambda t, s: t.FD(s.q, s.v, 0 * s.tau)),
    "craft_energy": ("kinetic energy and what springs store (1)", _energy),
    "craft_angular_momentum": ("about the mass centre (3)", lambda t, s: (derived.centroidal_matrix(t, s.q) @ s.v)[3:]),
    "craft_logs_against_states": (
        "1 + what poses that are logged after that step are off those of the states then (L, 12)",
        lambda t, s: 0 * t.kinematics.flat_poses(s.q) + 1,
    ),
    "craft_poses_after_step": ("link_poses after a step of `interface.STEP` from the speeds v2 (L, 12)", _after_step),
}
