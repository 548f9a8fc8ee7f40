"""Lagrange's top: steady precession, on a ball joint and by Euler angles."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.reference.motion import Array, reference

# Sums of a few terms of at most a thousand rad/s^2.
ROUNDING = 1e-10


def by_euler_angles() -> sf.Model:
    """The same top on the user's own joint: z-x-z angles phi (precession), theta (nutation), psi (spin)."""
    c, s = {x: f"cos({x})" for x in ("phi", "theta", "psi")}, {x: f"sin({x})" for x in ("phi", "theta", "psi")}
    # Rz(phi) Rx(theta) Rz(psi), multiplied out.
    matrix = [
        [
            f"{c['phi']}*{c['psi']} - {s['phi']}*{c['theta']}*{s['psi']}",
            f"-{c['phi']}*{s['psi']} - {s['phi']}*{c['theta']}*{c['psi']}",
            f"{s['phi']}*{s['theta']}",
        ],
        [
            f"{s['phi']}*{c['psi']} + {c['phi']}*{c['theta']}*{s['psi']}",
            f"-{s['phi']}*{s['psi']} + {c['phi']}*{c['theta']}*{c['psi']}",
            f"-{c['phi']}*{s['theta']}",
        ],
        [f"{s['theta']}*{s['psi']}", f"{s['theta']}*{c['psi']}", c["theta"]],
    ]
    joint = sf.Joint("tip", "general", coordinates=("phi", "theta", "psi"), moving_rotation=sf.Rotation.matrix(matrix))
    stated = MODELS["heavy_top"]
    top = stated.body("top")
    assert isinstance(top, sf.RigidBody)
    return sf.compile(
        stated.with_bodies(sf.RigidBody("top", joint, top.inertia, top.frames)), sf.Options(backend="interpreter")
    )


def body_rates(angles: Array, rates: Array) -> Array:
    """w in the body from z-x-z angles and their rates."""
    (_, theta, psi), (dphi, dtheta, dpsi) = angles, rates
    return np.array(
        [
            dphi * np.sin(theta) * np.sin(psi) + dtheta * np.cos(psi),
            dphi * np.sin(theta) * np.cos(psi) - dtheta * np.sin(psi),
            dphi * np.cos(theta) + dpsi,
        ]
    )


def quaternion(angles: Array) -> Array:
    """Rz(phi) Rx(theta) Rz(psi) as x, y, z, w."""
    phi, theta, psi = angles
    plus, minus = (phi + psi) / 2, (phi - psi) / 2
    c, s = np.cos(theta / 2), np.sin(theta / 2)
    return np.array([s * np.cos(minus), s * np.sin(minus), c * np.sin(plus), c * np.cos(plus)])


@pytest.mark.parametrize("theta", [0.4, 1.2, 2.0])
@pytest.mark.parametrize("which", [0, 1], ids=["slow", "fast"])
def test_steady_precession_is_kept(theta: float, which: int) -> None:
    """A cos(theta) p^2 - C w_z p + m g l = 0 has two roots p; with either, theta, p and the spin stay."""
    top, by_angles = reference("heavy_top"), by_euler_angles()
    A, C, m, g, length = (top.parameters[name] for name in ("A", "C", "m", "g", "l"))
    spin = 150.0
    precession = sorted(np.roots([A * np.cos(theta), -C * spin, m * g * length]), key=abs)[which]
    angles = np.array([0.3, theta, 0.8])
    rates = np.array([precession, 0.0, spin - precession * np.cos(theta)])
    scale = np.abs(rates).max() ** 2
    np.testing.assert_allclose(by_angles.forward_dynamics(angles, rates, []), 0.0, atol=ROUNDING * scale)

    # On the ball joint, w turns back in the body with psi', so w' = (psi' w_y, -psi' w_x, 0).
    w = body_rates(angles, rates)
    expected = rates[2] * np.array([w[1], -w[0], 0.0])
    a = top.forward_dynamics(quaternion(angles), w, [])
    np.testing.assert_allclose(a, expected, atol=ROUNDING * scale)
