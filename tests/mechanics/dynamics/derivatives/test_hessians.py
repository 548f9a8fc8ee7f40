"""Hessians of forward and inverse dynamics and of frames against the change of the gradients, by every input."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

import symofros as sf
from tests.models import system

FUNCTIONS = tuple(f"{name}_{kind}" for name in ("forward_dynamics", "inverse_dynamics") for kind in ("hessian", "vjp"))
# A tree, quaternions, a loop, and a beam, each with run-time parameters.
CASES = ("cart_pole", "heavy_top", "four_bar", "soft_pendulum")
STEP = 1e-3
# What differences of sixth order leave: rounding of the gradients over STEP.
TOLERANCE = 1e-8


@pytest.fixture(scope="module", params=CASES)
def m(request: pytest.FixtureRequest) -> sf.Model:
    options = sf.Options((*FUNCTIONS, "frame_position_hessian", "frame_pose_vjp"), backend="interpreter")
    return sf.compile(system(request.param), options)


def arguments(m: sf.Model, rng: np.random.Generator, third: str) -> dict[str, np.ndarray]:
    q, v = m.random_state(rng)
    size = {"u": m.nu, "a": m.nv}[third]
    return {"q": q, "v": v, third: rng.normal(size=size), "par": m.parameter_values}


def differences(m: sf.Model, name: str, frame: str, at: dict[str, np.ndarray], **weights: np.ndarray) -> np.ndarray:
    """Changes of the gradient along each entry of each input, q along its manifold (n x n)."""
    columns = []
    for group, x in at.items():
        sizes = STEP * np.abs(x) if group == "par" else np.full(m.nv if group == "q" else len(x), STEP)
        for k, size in enumerate(sizes):
            move = np.zeros(len(sizes))
            move[k] = size
            column = 0.0
            for step, weight in ((1, 45 / 60), (2, -9 / 60), (3, 1 / 60)):
                for sign in (1, -1):
                    there = m.integrate(x, sign * step * move) if group == "q" else x + sign * step * move
                    gradient = m.vjp(name, frame, **{**at, group: there}, **weights)
                    column = column + sign * weight / size * np.concatenate([gradient[each] for each in at])
            columns.append(column)
    return np.transpose(columns)


def check(H: np.ndarray, reference: np.ndarray) -> None:
    scale = np.maximum(1.0, np.abs(reference).max())
    assert np.abs(reference).max() > 0.1  # There is something to compare.
    np.testing.assert_allclose(H, reference, rtol=0, atol=TOLERANCE * scale)


def test_forward_dynamics_hessian_matches_differences(m: sf.Model, rng: np.random.Generator) -> None:
    at = arguments(m, rng, "u")
    weights = {"a_bar": rng.normal(size=m.nv), "lam_bar": rng.normal(size=m.nc)}
    (H,) = m.evaluate("forward_dynamics_hessian", **at, **weights)
    check(H, differences(m, "forward_dynamics", "", at, **weights))


def test_inverse_dynamics_hessian_matches_differences(m: sf.Model, rng: np.random.Generator) -> None:
    at, weights = arguments(m, rng, "a"), {"tau_bar": rng.normal(size=m.nv)}
    (H,) = m.evaluate("inverse_dynamics_hessian", **at, **weights)
    check(H, differences(m, "inverse_dynamics", "", at, **weights))


def test_frame_hessian_matches_differences(m: sf.Model, rng: np.random.Generator) -> None:
    at = {key: x for key, x in arguments(m, rng, "u").items() if key in ("q", "par")}
    frame, weights = m.names.frames[-1], {"p_WF_bar": rng.normal(size=3)}
    (H,) = m.evaluate("frame_position_hessian", frame, **at, **weights)
    check(H, differences(m, "frame_pose", frame, at, **weights))


@pytest.mark.parametrize("name", ["cart_pole", "four_bar"])
def test_c_hessians_match_the_interpreter(name: str, rng: np.random.Generator) -> None:
    """The routine in C and its twin: both solve by factors of their own."""
    models = [sf.compile(system(name), sf.Options(FUNCTIONS[:1], backend=each)) for each in ("c", "interpreter")]
    at = arguments(models[0], rng, "u") | {"a_bar": rng.normal(size=models[0].nv)}
    at["lam_bar"] = rng.normal(size=models[0].nc)
    ours, theirs = (each.evaluate("forward_dynamics_hessian", **at)[0] for each in models)
    np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-11 * np.abs(theirs).max())


@pytest.mark.parametrize("backend", ["c", "interpreter"])
def test_redundant_constraints_give_nan_hessians(backend: Literal["c", "interpreter"]) -> None:
    """A third crank beside the first one: what its joints hold, the others hold already."""
    m = sf.compile(system("parallelogram"), sf.Options(FUNCTIONS[:1] + ("forward_dynamics",), backend=backend))
    at = {"q": m.neutral(), "v": np.zeros(m.nv), "u": np.zeros(m.nu)}
    *_, rank = m.evaluate("forward_dynamics", **at, gains=np.zeros(2 * m.nc))
    (H,) = m.evaluate("forward_dynamics_hessian", **at, a_bar=np.ones(m.nv), lam_bar=np.zeros(m.nc))
    assert rank < m.nc and np.isnan(H).all()


def test_a_singular_mass_matrix_gives_nan_hessians() -> None:
    """Two hinges at one place, the first of which carries no mass of its own: M is singular."""
    joint = sf.Joint("q1", "revolute", axis=(0, 0, 1))
    twice = sf.Joint("q2", "revolute", "first", axis=(0, 0, 1))
    bodies = [sf.RigidBody("first", joint), sf.RigidBody("second", twice, sf.Inertia("m", (1.0, 0, 0), (0, 0, 0)))]
    singular = sf.System("singular", bodies, parameters=[sf.Parameter("m", 1.0)])
    m = sf.compile(singular, sf.Options(("forward_dynamics_hessian",)))
    (H,) = m.evaluate("forward_dynamics_hessian", q=[0.0, 0.3], v=[0.1, 0.2], u=[], a_bar=[1.0, 1.0], lam_bar=[])
    assert np.isnan(H).all()
