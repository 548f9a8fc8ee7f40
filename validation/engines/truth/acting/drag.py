"""The drag of a medium at links, in many digits (`interface.Medium`)."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ...interface import End, Link, Medium
from ..arithmetic import Exact, arc, exact, root, zeros
from ..kinematics import Kinematics


def drag(kinematics: Kinematics, medium: Medium, q: Exact, v: Exact) -> Exact:
    """What it does along the speeds (nv)."""
    total, pi = zeros(kinematics.nv), arc(Decimal(-1), Decimal(0))
    density, viscosity = exact((medium.density, medium.viscosity))
    for link in kinematics.tree.links:
        frame, half = kinematics.held(q, End(link.name, p=link.com)), _halves(link)
        u = frame.R.T @ (frame.J[:3] @ v - exact(medium.wind))
        w = frame.R.T @ (frame.J[3:] @ v)
        sides = [(half[(k + 1) % 3], half[(k + 2) % 3]) for k in range(3)]
        areas = np.array([4 * y * z for y, z in sides], dtype=object)
        turning = np.array([r * (y**4 + z**4) for r, (y, z) in zip(half, sides, strict=True)], dtype=object)
        mean = sum(half) / 3
        force = -density * areas * abs(u) * u / 2 - 6 * pi * viscosity * mean * u
        moment = -density * turning * abs(w) * w / 2 - 8 * pi * viscosity * mean**3 * w
        total = total + np.concatenate([frame.R @ force, frame.R @ moment]) @ frame.J
    return total


def _halves(link: Link) -> list[Decimal]:
    """Half sizes (3) of the box that has a link's mass and moments."""
    moments, mass = exact(np.diag(link.inertia)), exact(link.mass)[()]
    return [root((sum(moments) - 2 * one) * 3 / (2 * mass)) for one in moments]
