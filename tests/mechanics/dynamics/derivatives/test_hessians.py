"""Hessians of forward and inverse dynamics and of frames against the change of the gradients, by every input."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

import symofros as sf
from tests.models import system
from tests.validation.subjects import assert_agrees
from validation.procedures.equations import identities

FUNCTIONS = tuple(f"{name}_{kind}" for name in ("forward_dynamics", "inverse_dynamics") for kind in ("hessian", "vjp"))
# A tree, quaternions, a loop, and a beam, each with run-time parameters.
CASES = ("cart_pole", "heavy_top", "four_bar", "soft_pendulum")


@pytest.mark.parametrize("name", CASES)
def test_hessians_match_differences(name: str) -> None:
    assert_agrees(identities.weighted_curvature, system(name))


@pytest.mark.parametrize("name", ["cart_pole", "four_bar"])
def test_c_hessians_match_the_interpreter(name: str, rng: np.random.Generator) -> None:
    """The routine in C and its twin: both solve by factors of their own."""
    models = [sf.compile(system(name), sf.Options(FUNCTIONS[:1], backend=each)) for each in ("c", "interpreter")]
    q, v = models[0].random_state(rng)
    sizes = {"u": models[0].nu, "a_bar": models[0].nv, "lam_bar": models[0].nc}
    at = {"q": q, "v": v} | {group: rng.normal(size=size) for group, size in sizes.items()}
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
