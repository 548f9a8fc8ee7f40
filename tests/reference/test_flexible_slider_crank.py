"""A slider-crank with a flexible rod against an exact inextensible rod: foreshortening in a closed loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from reference_models import MODELS
from symofros.mechanics.beams.shape_functions import shapes
from validation.accuracy.reference import data

DATA = data("flexible_slider_crank")
RATE = 150.0  # Of the crank [rad/s].
LARGEST = 1.865e-3  # Deflection at mid-span [m].
FUNCTIONS = (
    "forward_dynamics",
    "constraint",
    "constraint_jacobian",
    "constraint_rate",
    "constraint_bias",
    "frame_pose",
)


def deflection(modes: int, **changed: object) -> tuple[np.ndarray, np.ndarray]:
    """Errors of the deflection at mid-span, across the chord, and of the slider's place, over a third of a turn."""
    system = MODELS["flexible_slider_crank"]
    slider = replace(system.body("slider"), inertia=sf.Inertia("m3", (0, 0, 0), (1e-5,) * 3))
    system = system.with_bodies(replace(system.body("rod"), bend_y=modes, **changed), slider)  # type: ignore[arg-type]
    m = sf.compile(system, sf.Options(functions=FUNCTIONS))

    def crank(t: float) -> np.ndarray:
        return np.array([RATE * t, RATE, 0.0])

    straight = [0.0] * (modes + 1) + [0.45]
    start = sf.assemble(m, straight, [-1.5 * RATE] + [0.0] * (modes + 1), u=crank(0.0), held=m.names.v[1:-1])

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([y[m.nq :], m.forward_dynamics(y[: m.nq], y[m.nq :], crank(t), gains=(300.0, 300.0))])

    t = np.array(DATA["t"])
    found = solve_ivp(
        rate, (0.0, t[-1]), np.concatenate([start.q, start.v]), method="DOP853", t_eval=t, rtol=1e-8, atol=1e-10
    )
    phi = np.array([float(shape.phi(0.5)) for shape in shapes("legendre", "bend_y", modes)])
    across, along = [], []
    for k in range(len(t)):
        q = found.y[: m.nq, k]
        assert np.abs(m.constraint(q, u=crank(t[k]))).max() < 1e-10
        (root, R), (pin, _) = (m.frame_pose(frame, q, u=crank(t[k])) for frame in ("rod", "tip"))
        chord = (pin - root) / np.linalg.norm(pin - root)
        mid = R @ [0.15, phi @ q[1 : 1 + modes], 0.0]
        across.append(chord[0] * mid[1] - chord[1] * mid[0])
        along.append(pin[0])
    return np.array(across) - DATA["mid"], np.array(along) - DATA["x_slider"]


@pytest.mark.parametrize(
    ("retain", "bound"), [("first_order", 0.02), pytest.param("all", 0.02, marks=pytest.mark.slow)]
)
def test_deflections_with_foreshortening_match_the_reference(retain: str, bound: float) -> None:
    """Three functions on the clamped root frame; the reference's own rod of four elements errs by 0.7 %."""
    across, along = deflection(3, retain=retain)
    assert np.abs(across).max() < 0.02 * LARGEST and np.abs(along).max() < 2e-6


def test_deflections_without_foreshortening_are_too_large() -> None:
    """The rod is then too soft under the slider's push: the error is several times that of any other choice."""
    across, _ = deflection(3, retain="all", foreshortening=False)
    assert np.abs(across).max() > 0.1 * LARGEST
