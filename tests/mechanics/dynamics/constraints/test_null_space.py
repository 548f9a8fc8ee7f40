"""Forward dynamics in what the constraints leave free: the same motion and forces as by multipliers, of any rank."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import GUESSES, sampled, state_of

# Off their constraints, at random: the equations hold there as well.
LOOSE = ("grasp", "flexible_slider_crank")


@cache
def model(name: str, form: str, backend: str) -> sf.Model:
    return sf.compile(MODELS[name], sf.Options(constraints=form, backend=backend))  # type: ignore[arg-type]


def state(name: str, backend: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return state_of(model(name, "multipliers", backend), GUESSES.get(name))


@pytest.mark.parametrize("name", [*GUESSES, *LOOSE])
def test_null_space_and_multipliers_give_the_same_motion(name: str) -> None:
    assert_the_same_motion(name, "interpreter")


@pytest.mark.parametrize("name", sampled((*GUESSES, *LOOSE), ("four_bar", "slider_crank", "rolling_disc")))
def test_null_space_and_multipliers_give_the_same_motion_in_c(name: str) -> None:
    assert_the_same_motion(name, "c")


def assert_the_same_motion(name: str, backend: str) -> None:
    q, v, u = state(name, backend)
    by_multipliers = model(name, "multipliers", backend)
    gains = np.random.default_rng(1).uniform(0, 5, 2 * by_multipliers.nc)
    a, lam, rank = by_multipliers.constrained_dynamics(q, v, u, gains=gains)
    b, mu, same = model(name, "null_space", backend).constrained_dynamics(q, v, u, gains=gains)
    # Light bodies and beams: rounding grows with the condition of M, 1e7 at the grasp.
    assert rank == same and np.abs(a - b).max() < 1e-10 * np.abs(a).max()
    assert np.abs(lam - mu).max() < 1e-10 * max(1.0, np.abs(lam).max())


def nested(inertia: float) -> sf.System:
    """A light wheel that carries a heavy one on its axle, geared 3 to 1: M is nearly singular, the motion is not."""
    wheel = sf.Inertia(1e-30, (0, 0, 0), (inertia, inertia, inertia)) if inertia else None
    bodies = (
        sf.RigidBody("a", sf.Joint("q1", "revolute", actuated=True), wheel, (), () if inertia else ("massless_tip",)),
        sf.RigidBody("b", sf.Joint("q2", "revolute", "a", actuated=True), sf.Inertia(1.5, (0, 0, 0), (0.3, 0.4, 0.5))),
    )
    return sf.System("s", bodies, constraints=(sf.Nonholonomic("gear", {"dq1": 1.0, "dq2": -3.0}),))


@pytest.mark.parametrize("form", ["multipliers", "null_space"])
@pytest.mark.parametrize(
    ("inertia", "backend"),
    [*((inertia, "interpreter") for inertia in (1e-2, 1e-6, 1e-10, 1e-13, 0.0)), (1e-10, "c"), (0.0, "c")],
)
def test_a_light_body_does_not_reduce_accuracy(inertia: float, form: str, backend: str) -> None:
    """Closed form: (9 J + 16 I) v2' = 3 u1 + u2, v1' = 3 v2'; by M alone, six digits are left at 1e-10."""
    m = sf.compile(nested(inertia), sf.Options(constraints=form, backend=backend))  # type: ignore[arg-type]
    a = m.forward_dynamics([0.3, -0.4], [1.5, 0.5], [0.7, -0.2])
    second = (3 * 0.7 - 0.2) / (9 * inertia + 16 * 0.5)
    assert a == pytest.approx([3 * second, second], rel=1e-12)


@pytest.mark.parametrize("form", ["multipliers", "null_space"])
def test_a_mechanism_with_no_freedom_left_does_not_accelerate(form: str) -> None:
    """A body that the constraints hold in every direction: the forces alone are to be found."""
    slide = sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(0, 0, 1)), sf.Inertia(2.0))
    rest = sf.Closure("rest", ("world", None), ("b", None), ("z",))
    m = sf.compile(sf.System("s", [slide], constraints=[rest]), sf.Options(constraints=form))  # type: ignore[arg-type]
    a, lam = m.forward_dynamics([0.0], [0.0], [], multipliers=True)
    assert a == pytest.approx([0.0], abs=1e-15) and lam == pytest.approx([2 * 9.81])
