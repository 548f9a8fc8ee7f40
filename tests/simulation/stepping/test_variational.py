"""The variational midpoint rule on bodies whose momentum turns with their axes."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf

# The mass centre lies beside the joint's origin, so that the linear momentum is not along the velocity.
SOLID = sf.Inertia(1.5, (0.3, -0.4, 0.2), (0.3, 0.4, 0.5))


@pytest.mark.parametrize("kind, nv", [("free", 6), ("ball", 3)])
def test_variational_matches_other_methods_with_an_offset_mass_centre(kind: str, nv: int) -> None:
    """The force on the momentum in body axes, v x f + w x n, has two parts; both methods agree to second order."""
    model = sf.compile(sf.System("s", (sf.RigidBody("b", sf.Joint("j", kind), SOLID),)))  # type: ignore[arg-type]
    v = np.array([0.7, -0.4, 1.1, 2.0, -1.5, 0.8])[-nv:]

    def end(method: str, dt: float) -> np.ndarray:
        return sf.simulate(model, model.neutral(), v, t_end=0.5, method=method, dt=dt).v[-1]

    exact = end("rk4", 1e-3)
    errors = [np.abs(end("variational", dt) - exact).max() for dt in (0.01, 0.005)]
    assert errors[0] < 1e-2 and 3.5 < errors[0] / errors[1] < 4.5


def test_angular_momentum_about_a_mass_centre_that_translates_drifts_as_the_square_of_the_step() -> None:
    """That about the world's origin is kept, and so is linear momentum."""
    inertia = sf.Inertia(2.0, (0.1, 0.2, -0.1), (0.3, 0.5, 0.7, 0.01, 0.02, 0.03))
    model = sf.compile(sf.System("body", (sf.RigidBody("b", sf.Joint("j", "free"), inertia),), gravity=(0, 0, 0)))
    drifts = []
    for dt in (0.02, 0.01):
        run = sf.simulate(model, model.neutral(), [1.0, -0.5, 0.3, 0.8, 1.0, -0.6], 4.0, method="variational", dt=dt)
        momentum, center = model.centroidal_momentum(run.q, run.v), model.center_of_mass(run.q)
        P, L = momentum[:, :3], momentum[:, 3:]
        for kept in (P, L + np.cross(center, P)):
            assert np.abs(kept - kept[0]).max() < 1e-12
        drifts.append(float(np.abs(L[-1] - L[0]).max()))
    assert 3.5 < drifts[0] / drifts[1] < 4.5
