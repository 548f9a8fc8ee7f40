"""Rests from far away: where Newton's method stalls, a damped motion leads downhill."""

from __future__ import annotations

import math

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.analysis.rest_search import _downhill, _unit_mass
from tests.models import interpreted, model


def geared(ratio: float) -> sf.Model:
    """Two arms, one of which turns by a ratio of the other; gravity has the longest arms at zero."""
    bodies = [
        sf.RigidBody(
            f"arm{k}",
            sf.Joint(f"q{k}", "revolute", axis=(0.0, 1.0, 0.0)),
            sf.Inertia(mass, (0.3, 0.0, 0.0), (0.01, 0.1 * mass, 0.1 * mass)),
        )
        for k, mass in enumerate((3.0, 1.0))
    ]
    gear = sf.Coupling("gear", f"q1 - {ratio}*q0")
    return sf.compile(sf.System("geared", tuple(bodies), constraints=(gear,)))


def test_a_gear_leaves_the_posture_without_stiffness() -> None:
    """The potential -3 sin q - sin 3 q has a minimum at a quarter of pi."""
    rest = sf.equilibrium(geared(3.0))
    assert rest.q == pytest.approx([np.pi / 4, 3 * np.pi / 4], abs=1e-10)
    assert rest.residual < 1e-11


def test_motions_without_mass_are_damped() -> None:
    """A singular mass matrix ends no search with an error of linear algebra."""
    M = np.diag([0.0, 2.0, 0.0])
    L = np.linalg.inv(_unit_mass(M)).T
    assert np.allclose(L @ L.T, M, atol=1e-8)
    assert np.all(np.isfinite(_unit_mass(np.zeros((2, 2)))))
    assert _unit_mass(np.zeros((0, 0))).shape == (0, 0)


def test_a_freely_falling_body_has_no_equilibrium() -> None:
    ball = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
    with pytest.raises(sf.EquilibriumError, match="after 100 steps"):
        sf.equilibrium(sf.compile(sf.System("ball", (ball,))))


@pytest.mark.parametrize("name", ["double_pendulum", "flexible_pendulum", "heavy_top"])
def test_an_equilibrium_is_found_from_itself(name: str) -> None:
    """Where all forces vanish, rounding is no imbalance."""
    found = model(name)
    rest = sf.equilibrium(found)
    assert sf.equilibrium(found, rest.q).q == pytest.approx(rest.q, abs=1e-9)


def test_a_stiff_joint_excuses_no_push_on_a_free_one() -> None:
    held = sf.Joint("held", "prismatic", axis=(1, 0, 0), effort="-1e14*held")
    free = sf.Joint("free", "prismatic", axis=(1, 0, 0), effort="0.05")
    bodies = tuple(sf.RigidBody(joint.name, joint, sf.Inertia(1.0)) for joint in (held, free))
    with pytest.raises(sf.EquilibriumError, match="imbalance of -0.05 at 'free'"):
        sf.equilibrium(sf.compile(sf.System("two", bodies)))


def test_negative_directions_are_turned_round(rng: np.random.Generator) -> None:
    """In size and direction they stay, and what is skew is left as it is."""
    V, _ = np.linalg.qr(rng.standard_normal((4, 4)))
    skew = rng.standard_normal((4, 4))
    skew -= skew.T
    K = (V * [-3.0, -1.0, 0.5, 2.0]) @ V.T
    turned, stable = _downhill(K + skew)
    assert not stable
    assert np.allclose(turned, (V * [3.0, 1.0, 0.5, 2.0]) @ V.T + skew, atol=1e-13)
    assert _downhill(turned)[1]
    assert _downhill(np.zeros((0, 0)))[1]


@pytest.mark.parametrize("w", [4.0, 6.0])
def test_a_spin_that_stays_makes_a_steady_motion(w: float) -> None:
    """A bob on a shaft that turns hangs at cos q = g/(w^2 L); speeds by name, too."""
    shaft = sf.RigidBody("shaft", sf.Joint("turn", "revolute", axis=(0, 0, 1)), sf.Inertia(1.0, moments=(1, 1, 1)))
    hinge = sf.Joint("q", "revolute", "shaft", axis=(0, 1, 0))
    bob = sf.RigidBody("bob", hinge, sf.Inertia(2.0, (0, 0, -1.0)))
    model = sf.compile(sf.System("governor", (shaft, bob)), sf.Options(backend="interpreter"))
    for v in ([w, 0.0], {"turn": w}):
        steady = sf.equilibrium(model, [0.0, -0.8], v, held=["turn"])  # type: ignore[arg-type]
        assert math.cos(steady.q[1]) == pytest.approx(9.81 / w**2, abs=1e-9)
        assert steady.v.tolist() == [w, 0.0] and steady.efforts["turn"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("force", ["1 - sqrt(x)", "1 - x^(1/3)", "1 + sqrt(x) - 2*x"])
def test_a_guess_of_infinite_stiffness_is_no_rest(force: str) -> None:
    """A force of 1 N is not small beside one that the slope of a root at zero would bring."""
    slider = sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=(force,)), sf.Inertia(1.0))
    made = interpreted(sf.System("root", (slider,), gravity=(0, 0, 0)))
    with pytest.raises(sf.EquilibriumError, match="x"):
        sf.equilibrium(made, [0.0])
    assert sf.equilibrium(made, [0.5]).q == pytest.approx([1.0], abs=1e-9)
