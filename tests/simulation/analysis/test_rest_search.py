"""Rests from far away: where Newton's method stalls, a damped motion leads downhill."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
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


def test_a_guess_without_finite_constraints_is_refused_in_words() -> None:
    """A disc that lies flat touches the ground everywhere: no LinAlgError of a decomposition."""
    disc = sf.compile(MODELS["rolling_disc"])
    with pytest.raises(sf.EquilibriumError, match="no equilibrium was found"):
        sf.equilibrium(disc, disc.neutral())


LEAVES = r"this rest is unstable: moved by a little, '{}' leaves it at ([\d.]+) 1/s without damping; guess nearer to"


def rate_of(rest: object, name: str) -> float:
    """The rate that the note on an unstable rest states, of a speed by its name."""
    (note,) = rest.notes  # type: ignore[attr-defined]
    found = re.match(LEAVES.format(name), note)
    assert found, note
    return float(found[1])


def test_an_upright_rest_is_distinguished_from_a_hanging_one() -> None:
    """At sqrt(m g L / J); what is held does not leave."""
    rod = sf.Inertia(1.5, (0.4, 0.0, 0.0), (0.0, 0.02, 0.02))
    arm = sf.RigidBody("arm", sf.Joint("q", "revolute", axis=(0, 1, 0)), rod)
    made = interpreted(sf.System("arm", (arm,)))
    upright = sf.equilibrium(made, [-1.5])
    assert rate_of(upright, "q") == pytest.approx(math.sqrt(1.5 * 9.81 * 0.4 / (0.02 + 1.5 * 0.16)), rel=5e-3)
    assert sf.equilibrium(made, [1.5]).notes == sf.equilibrium(made, [-1.5], held=["q"]).notes == ()


@pytest.mark.parametrize("above", [1.5, 40.0])
def test_a_small_body_is_found_far_from_its_guess(above: float) -> None:
    """A millimetre in size, on a spring of a metre: no step is bounded by how far its own rotations move it."""
    body = sf.RigidBody(
        "bob", sf.Joint("f", "free"), sf.Inertia(1.0, moments=(1e-6,) * 3), (sf.Frame("top", (0, 0, 1e-3)),)
    )
    spring = sf.Connection("spring", ("world", None), ("bob", "top"), 50.0, 1.0)
    rest = sf.equilibrium(
        interpreted(sf.System("hung", (body,), connections=(spring,))), [0.1, 0.2, -above, 0, 0, 0, 1]
    )
    assert rest.q[:3] == pytest.approx([0.0, 0.0, -1.0 - 9.81 / 50.0 - 1e-3], abs=1e-9)


@pytest.mark.parametrize("length", [0.1, 100.0])
def test_the_fastest_unstable_speed_is_found_relative_to_its_reach(length: float) -> None:
    """A rod falls on its sledge, of 1 kg each: a long one pushes it by more metres than it turns by radians."""
    sledge = sf.RigidBody("sledge", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0))
    inertia = sf.Inertia(1.0, (length, 0, 0), (0, 0.1 * length**2, 0.1 * length**2))
    rod = sf.RigidBody("rod", sf.Joint("q", "revolute", "sledge", axis=(0, 1, 0)), inertia)
    rest = sf.equilibrium(interpreted(sf.System("sledge", (sledge, rod))), [0.0, -1.5])
    assert rate_of(rest, "q") == pytest.approx(math.sqrt(9.81 / length / (0.1 + 1.0 - 0.5)), rel=5e-3)


@pytest.mark.parametrize(("stiffness", "length", "bound"), [(1e3, 1.0, 5e-3), (1e9, 1.0, 5e-3), (3e8, 100.0, 5e-2)])
def test_a_stiff_beam_does_not_hide_that_it_falls(stiffness: float, length: float, bound: float) -> None:
    """Its stiffness is up to 1e12 times that of gravity; or it is long, and bends. A rod: sqrt(3 g / (2 L))."""
    beam = sf.Beam("b", sf.Joint("q", "revolute", axis=(0, 1, 0)), length, 1.0, EI_y=stiffness, bend_z=2)
    made = interpreted(sf.System("beam", (beam,)))
    rate = math.sqrt(1.5 * 9.81 / length)
    assert rate_of(sf.equilibrium(made, [-1.57, 0, 0]), "q") == pytest.approx(rate, rel=bound)
    assert sf.equilibrium(made, [1.57, 0, 0]).notes == ()


def test_a_loop_is_left_along_its_closures() -> None:
    """A gear's arms between minima, by the potential -3 sin q - sin 3 q and masses 1, of 9 the second's part."""
    made = geared(3.0)
    assert sf.equilibrium(made).notes == ()
    rest = sf.equilibrium(made, [np.pi / 2 - 0.02, 3 * np.pi / 2 - 0.06])
    assert rest.q[0] == pytest.approx(np.pi / 2, abs=1e-9)
    inertia = [float(np.diag(made.mass_matrix(rest.q))[k]) for k in (0, 1)]
    # V'' = (m0 sin q + 9 m1 sin 3 q) 0.3 g = (3 - 9) 0.3 g
    rate = math.sqrt(6.0 * 0.3 * 9.81 / (inertia[0] + 9.0 * inertia[1]))
    assert rate_of(rest, "q1") == pytest.approx(rate, rel=5e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0, 2.0])
def test_neutral_rests_and_forces_without_a_potential_bear_no_note(angle: float) -> None:
    """A seesaw in balance stays wherever it is; a force that follows its body is not judged."""
    seesaw = sf.RigidBody("see", sf.Joint("q", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (0.7, 0, 0), (0.1,) * 3))
    far = sf.RigidBody("far", sf.Joint("f", "fixed", "see", position=(-0.35, 0, 0)), sf.Inertia(2.0))
    assert sf.equilibrium(interpreted(sf.System("seesaw", (seesaw, far))), [angle]).notes == ()
    pair = [sf.RigidBody(n, sf.Joint(n, "prismatic", axis=(1, 0, 0), effort=f), sf.Inertia(1.0)) for n, f in FOLLOWING]
    assert sf.equilibrium(interpreted(sf.System("pair", tuple(pair), gravity=(0, 0, 0))), [angle, 0.0]).notes == ()


FOLLOWING = (("x", "3*y - x"), ("y", "2*x - y"))


def test_a_top_that_spins_is_not_judged_by_stiffness_alone() -> None:
    """Its spin held, it leaves by the centrifugal force, too: at sqrt(g/L + Omega^2)."""
    shaft = sf.RigidBody("shaft", sf.Joint("turn", "revolute", axis=(0, 0, 1)), sf.Inertia(1.0, moments=(1, 1, 1)))
    bob = sf.RigidBody("bob", sf.Joint("q", "revolute", "shaft", axis=(0, 1, 0)), sf.Inertia(2.0, (0, 0, 1.0)))
    made = interpreted(sf.System("upright", (shaft, bob)))
    assert rate_of(sf.equilibrium(made, [0.0, 0.1]), "q") == pytest.approx(math.sqrt(9.81), rel=5e-3)
    (note,) = sf.equilibrium(made, [0.0, 0.0], [1.0, 0.0], held=["turn"]).notes
    assert note.startswith(f"this motion is unstable: moved by a little, 'q' leaves it at {math.sqrt(10.81):.3g} 1/s;")


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e3, 1e9])
def test_masses_on_soft_springs_come_to_rest_however_far_below(size: float) -> None:
    """Steps of at most half a metre ended 50 m below the guess; forces that are linear in shifts widen them."""
    spring = sf.Spring(9.81 / size)
    above = sf.RigidBody("above", sf.Joint("z1", "prismatic", axis=(0, 0, 1), elements=(spring,)), sf.Inertia(1.0))
    joint = sf.Joint("z2", "prismatic", "above", axis=(0, 0, 1), elements=(spring,))
    model = sf.compile(sf.System("chain", (above, sf.RigidBody("below", joint, sf.Inertia(1.0)))))
    assert sf.equilibrium(model, [0.0, 0.0]).q == pytest.approx([-2.0 * size, -size], rel=1e-9)
