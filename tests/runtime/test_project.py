"""Projection: drifted states come back to the constraints by the least change, in C as in NumPy."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import GUESSES, sampled

# In the plane and in space, conditions that repeat each other, conditions on speeds.
SMALL = ("four_bar", "slider_crank", "parallelogram", "delta", "rolling_disc", "sleigh")

SOLID = sf.Inertia(1.5, (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))


@cache
def model(name: str, backend: str = "c") -> sf.Model:
    return sf.compile(MODELS[name], sf.Options(backend=backend))


def drifted(name: str, size: float, count: int = 5) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """A state on the constraints, and some near it."""
    m, rng = model(name), np.random.default_rng(1)
    at = sf.assemble(m, GUESSES[name], rng.normal(size=m.nv))
    q = m.integrate(at.q, size * rng.normal(size=(count, m.nv)))
    return at.q, at.v, q, at.v + size * rng.normal(size=(count, m.nv))


@pytest.mark.parametrize("size", [1e-9, 1e-5])
@pytest.mark.parametrize("name", sampled(tuple(GUESSES), SMALL))
def test_projection_removes_drift(name: str, size: float) -> None:
    m = model(name)
    _, _, q, v = drifted(name, size)
    on_q, on_v, left = m.project(q, v)
    assert left.max() < 1e-12 and np.abs(m.constraint(on_q)).max() < 1e-12
    assert np.abs(m.constraint_rate(on_q, on_v)).max() < 1e-12
    assert np.abs(m.difference(q, on_q)).max() < 100 * size and np.abs(on_v - v).max() < 100 * size


@pytest.mark.parametrize("backend", ["c", "interpreter"])
@pytest.mark.parametrize("name", ["delta", "rolling_disc"])
def test_quaternions_are_of_unit_length_after_large_changes(name: str, backend: str) -> None:
    """q + N dq is longer than q by the square of the turn, which a few hundredths of drift make visible."""
    q, v = drifted(name, 0.05, 2)[2:]
    on_q = model(name, backend).project(q, v)[0]
    assert np.abs(on_q - q).max() > 1e-3
    for segment in model(name).record.segments:
        if segment.kind != "linear":
            quaternion = on_q[:, segment.q + segment.translations : segment.q + segment.translations + 4]
            assert np.abs(np.linalg.norm(quaternion, axis=1) - 1).max() < 1e-12


@pytest.mark.parametrize("name", sampled(tuple(GUESSES), SMALL))
def test_c_projection_matches_the_interpreter(name: str) -> None:
    _, _, q, v = drifted(name, 1e-6, 3)
    for ours, twin in zip(model(name).project(q, v), model(name, "interpreter").project(q, v), strict=True):
        assert np.abs(ours - twin).max() < 1e-11


def test_prescribed_motion_is_followed() -> None:
    slide = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0)), SOLID)
    turn = sf.RigidBody("arm", sf.Joint("turn", "revolute", prescribed=True), SOLID, (sf.Frame("e", (0.5, 0, 0)),))
    closure = sf.Closure("k", ("cart", None), ("arm", "e"), ("x",))
    m = sf.compile(sf.System("s", (slide, turn), constraints=(closure,)))
    q, v, _ = m.project([0.1], [0.4], u=[0.3, 2.0, -1.0])
    assert q == pytest.approx([0.5 * np.cos(0.3)]) and v == pytest.approx([-0.5 * np.sin(0.3) * 2.0])


@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_projection_handles_a_massless_body(backend: str) -> None:
    bars = (
        sf.RigidBody("a", sf.Joint("q1", "revolute"), SOLID, (sf.Frame("e", (1, 0, 0)),)),
        sf.RigidBody("b", sf.Joint("q2", "revolute", "a", "e"), None, (sf.Frame("e", (1, 0, 0)),), ("massless_tip",)),
    )
    rail = sf.Closure("rail", ("world", None), ("b", "e"), ("y",))
    m = sf.compile(sf.System("s", bars, constraints=(rail,)), sf.Options(backend=backend))  # type: ignore[arg-type]
    q, v, left = m.project([0.6, -1.2], [1.0, 0.0])
    assert left < 1e-12 and np.abs(m.constraint_rate(q, v)).max() < 1e-12
    # Only the massless bar moves: that costs no energy.
    assert q[0] == pytest.approx(0.6, abs=1e-12) and v[0] == pytest.approx(1.0, abs=1e-12)


def test_projection_returns_the_residual_of_a_loop_that_cannot_close() -> None:
    system = MODELS["four_bar"]
    other = sf.Rod("too_long", ("crank", "end"), ("rocker", "end"), 1.5)
    m = sf.compile(replace(system, constraints=(*system.constraints, other)))
    q, _, left = m.project([1.2, -1.0, 1.3], np.zeros(3))
    assert left > 1e-2 and np.isfinite(q).all()
