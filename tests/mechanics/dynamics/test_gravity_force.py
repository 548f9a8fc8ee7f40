"""Forces of the weight alone: the bias at rest, and the slope of the potential energy."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS

NAMES = ("gravity_force", "bias", "potential_energy", "frame_pose")
CASES = ("double_pendulum", "heavy_top", "slider_crank", "planar_robot", "friction_arm", "space_arm", "gyroscope")


@pytest.mark.parametrize(("name", "backend"), [("slider_crank", "c"), *((name, "interpreter") for name in CASES)])
def test_gravity_force_is_the_bias_at_rest(name: str, backend: str, rng: np.random.Generator) -> None:
    model = sf.compile(MODELS[name], sf.Options(NAMES[:2], backend=backend))  # type: ignore[arg-type]
    states = [model.random_state(rng) for _ in range(3)]
    q = np.array([q for q, _ in states])
    h = model.bias(q, np.zeros((3, model.nv)))
    np.testing.assert_allclose(model.gravity_force(q), h, rtol=0, atol=1e-12 * max(1.0, np.abs(h).max()))
    np.testing.assert_allclose(model.gravity_force(q[0]), h[0], rtol=0, atol=1e-12 * max(1.0, np.abs(h).max()))


def test_gravity_force_is_the_potential_gradient_and_cheaper_than_the_bias(rng: np.random.Generator) -> None:
    from symofros.compiler import program_of
    from symofros.generator.passes.count import count_program

    model = sf.compile(MODELS["puma560"], sf.Options(NAMES[:3], backend="interpreter"))
    q, step = rng.normal(size=model.nq), 1e-5
    slopes = [
        (model.potential_energy(q + d) - model.potential_energy(q - d)) / (2 * step) for d in step * np.eye(model.nv)
    ]
    np.testing.assert_allclose(model.gravity_force(q), slopes, rtol=0, atol=1e-8 * np.abs(slopes).max())
    counts = count_program(program_of(MODELS["puma560"], NAMES[:2]))
    assert counts["gravity_force", ""].total < 0.5 * counts["bias", ""].total
