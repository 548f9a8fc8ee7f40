"""Energy that changes without work is noted; what works between the states that are kept is work all the same."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf

SLIDE = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
CART = sf.System("cart", (sf.RigidBody("b", SLIDE, sf.Inertia(1.0)),), gravity=(0, 0, 0))
METHODS = ("rk4", "semi_implicit_euler", "dopri5", "dop853", "rodas4")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("begins", "lasts"), [(5.0, 0.004), (0.0, 0.01), (9.9, 0.1), (3.0, 5.0)])
def test_a_push_between_kept_states_is_work(method: str, begins: float, lasts: float) -> None:
    """2 N s on 1 kg at rest."""
    values = [0.0] * (begins > 0.0) + [2.0 / lasts, 0.0, 0.0]
    push = sf.Signal(sorted({0.0, begins, begins + lasts, 11.0}), values, "hold")
    run = sf.simulate(sf.compile(CART), t_end=10.0, method=method, u={"x": push})
    assert run.v[-1, 0] == pytest.approx(2.0, rel=1e-6) and not run.outcome.notes, run.outcome


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("force", ["2*sin(t)", "2*t"])
def test_a_force_that_depends_on_time_is_work(method: str, force: str) -> None:
    """Without an input, from rest, and zero at first."""
    body = sf.RigidBody(
        "b", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0), loads=(sf.Load((force, 0, 0)),)
    )
    run = sf.simulate(sf.compile(sf.System("timed", (body,), gravity=(0, 0, 0))), t_end=2.0, method=method)
    exact = 2.0 * (1.0 - np.cos(2.0)) if "sin" in force else 4.0
    assert run.v[-1, 0] == pytest.approx(exact, rel=1e-5) and not run.outcome.notes, run.outcome


@pytest.mark.parametrize("step", [0.2, 0.5])
def test_energy_that_steps_make_is_noted(step: float) -> None:
    """A free oscillator of 1 rad/s by Euler's explicit method gains a share of h^2 a step."""
    spring = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(1.0),))
    model = sf.compile(sf.System("oscillator", (sf.RigidBody("b", spring, sf.Inertia(1.0)),)))
    run = sf.simulate(model, [1.0], t_end=20.0, method="euler", dt=step)
    assert run.outcome.notes and run.energy[-1] > 2.0 * run.energy[0]


def on_a_slide(mass: float, *elements: sf.Spring | sf.Damper) -> sf.Model:
    """A mass that slides."""
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements)
    return sf.compile(sf.System("slide", (sf.RigidBody("b", slide, sf.Inertia(mass)),), gravity=(0, 0, 0)))


@pytest.mark.parametrize("method", [*METHODS, "generalized_alpha"])
def test_speeds_that_a_force_drives_grow_without_a_note(method: str) -> None:
    """A damper of -2 N s/m, which feeds the motion, on 1 kg: its speed is exp(2 t)."""
    run = sf.simulate(on_a_slide(1.0, sf.Damper(-2.0)), v0=[1.0], t_end=10.0, method=method)
    right = pytest.approx(np.exp(20.0), rel=0.03 if method == "semi_implicit_euler" else 1e-3)
    assert run.v[-1, 0] == right and not run.outcome.notes, run.outcome


@pytest.mark.parametrize(("atol", "said"), [(1e9, True), (1e-9, False)])
@pytest.mark.parametrize("method", ["dopri5", "dop853"])
def test_speeds_that_steps_make_grow_are_noted(method: str, atol: float, said: bool) -> None:
    """A spring that hardens keeps its energy; a tolerance that bounds nothing lets the steps explode."""
    spring = on_a_slide(1.0, sf.Spring(1.0, 0.0, 1.0))
    run = sf.simulate(spring, [1.0], t_end=50.0, method=method, atol=atol, max_steps=500)
    assert bool([note for note in run.outcome.notes if "although no input acts" in note]) == said, run.outcome


@pytest.mark.parametrize(("mass", "said"), [(1e250, True), (1.0, False)])
def test_energy_beyond_all_numbers_is_said_not_to_be_judged(mass: float, said: bool) -> None:
    run = sf.simulate(on_a_slide(mass), v0=[1e40], t_end=1.0, method="rk4", dt=0.1)
    assert run.q[-1, 0] == pytest.approx(1e40)
    notes = [note.startswith("energy overflows, although the states do not") for note in run.outcome.notes]
    assert notes == [True] * said
