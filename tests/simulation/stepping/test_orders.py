"""Each method converges at its order: on quaternion states, and with constraints."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.stepping.methods import METHODS
from tests.models import compiled

# Steps in the first of four runs; each has 1.3 times as many as the one before.
FIRST = {1: 200, 2: 100, 4: 120}
# Where its order shows between the first asymptotic errors and rounding; for order 5 on stewart, not within 0.1.
FIRST_OF = {
    ("heavy_top", "dopri5"): 100,
    ("joint_zoo", "dopri5"): 45,
    ("four_bar", "dopri5"): 20,
    ("four_bar", "rodas4"): 40,
}
SPAN = 0.4
# Free and ball joints carry quaternions; the loop of four bars and the platform of six legs carry constraints.
SCENES = ("heavy_top", "joint_zoo", "four_bar", "stewart")


@cache
def scene(name: str) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    model = compiled(name)
    q, v = model.random_state(np.random.default_rng(3))
    v *= 0.3
    if model.nc:
        assembled = sf.assemble(model, q, v)
        q, v = assembled.q, assembled.v
    return model, q, v


@cache
def reference(name: str, span: float) -> sf.Trajectory:
    return sf.simulate(*scene(name), span, method="dop853", rtol=1e-13, atol=1e-14)


def error(name: str, method: str, span: float, steps: int) -> float:
    model, q, v = scene(name)
    run = sf.simulate(model, q, v, span, method=method, dt=span / steps, adaptive=False)
    assert run.outcome.ok, run.outcome
    exact = reference(name, span)
    return float(np.linalg.norm([*model.difference(exact.q[-1], run.q[-1]), *(run.v[-1] - exact.v[-1])]))


@pytest.mark.parametrize(
    ("name", "method"),
    [
        # Six legs are heavier work than four bars.
        pytest.param(scene, name, marks=[pytest.mark.slow] if scene == "stewart" else [])
        for scene in SCENES
        for name, method in METHODS.items()
        if method.order < 5 or (scene, name) in FIRST_OF
    ],
)
def test_methods_converge_with_their_order(name: str, method: str) -> None:
    if method == "variational" and scene(name)[0].nc:
        with pytest.raises(sf.SymofrosError, match="trees of free motion only"):
            error(name, method, SPAN, 10)
        return
    nominal = METHODS[method].order
    first = FIRST_OF.get((name, method)) or FIRST[nominal]
    steps = np.array([round(first * 1.3**k) for k in range(4)])
    errors = [error(name, method, SPAN, n) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(nominal, abs=0.1)


def test_dop853_has_its_order() -> None:
    """Double precision leaves a factor of 1.6 in the step between its first asymptotic errors and rounding."""
    steps = np.array([85, 106, 132])
    errors = [error("joint_zoo", "dop853", 2.0, n) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(8.0, abs=0.15)


@pytest.mark.parametrize("name", ["heavy_top", "four_bar"])
@pytest.mark.parametrize("method", ["dopri5", "dop853", "rodas4"])
def test_error_follows_the_tolerance(name: str, method: str) -> None:
    model, q, v = scene(name)
    exact = reference(name, SPAN)
    for tolerance in (1e-5, 1e-7, 1e-9):
        run = sf.simulate(model, q, v, SPAN, method=method, rtol=tolerance, atol=tolerance)
        assert run.outcome.ok
        off = np.abs([*model.difference(exact.q[-1], run.q[-1]), *(run.v[-1] - exact.v[-1])]).max()
        assert off < 100 * tolerance * max(1.0, float(np.abs(v).max()))


@pytest.mark.parametrize("method", ["rodas4", "implicit_euler", "generalized_alpha"])
def test_implicit_steps_by_laws_are_those_by_the_forces_that_they_state(method: str) -> None:
    """Coupled and stiff for the step: what inputs depend on is in the Jacobian."""
    forces = {"x": "-400*x + 90*y - 3*dx", "y": "50*x - 300*y + 2*dx - 5*dy"}
    slides = [
        sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True),
        sf.Joint("y", "prismatic", parent="bx", axis=(0, 1, 0), actuated=True),
    ]
    bodies = tuple(sf.RigidBody(f"b{joint.name}", joint, sf.Inertia(1.0)) for joint in slides)
    stated = tuple(sf.VirtualPower(name, {f"d{name}": sf.formula(force)}) for name, force in forces.items())
    runs = [
        sf.simulate(
            sf.compile(sf.System("slides", bodies, gravity=(0, 0, 0), virtual_power=power)),
            [0.2, -0.1],
            [1.0, 2.0],
            1.0,
            u=laws,
            method=method,
            dt=0.1,
            adaptive=False if method == "rodas4" else None,
        )
        for power, laws in ((stated, None), ((), forces))
    ]
    for name in ("q", "v"):
        expected, found = (getattr(run, name) for run in runs)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
