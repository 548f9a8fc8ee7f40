"""Notes on fixed steps of motions with states of forces and blocks, which have other units than speeds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks


def warmed(stiffness: float, **fields: Any) -> sf.System:
    """A vibrating mass that loses energy and is driven, beside what else a test states."""
    elements = (sf.Spring(stiffness), sf.Damper(0.5))
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements, actuated=True)
    return sf.System("warmed", (sf.RigidBody("body", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0), **fields)


WARMTH = sf.ForceState("T", "-0.01*(T - 300)")


@pytest.mark.parametrize(
    ("method", "warm"),
    [("rk4", 290.0), ("implicit_euler", 290.0), ("generalized_alpha", 290.0), ("implicit_euler", 1e15)],
)
def test_a_state_in_other_units_hides_no_error_of_the_motion(method: str, warm: float) -> None:
    """A temperature of 290 K is no speed of 290 m/s, beside which a vibration that the steps damp away is nothing.

    Nor is its integral a place, beside which a vibration is rounding.
    """
    fields: dict[str, Any] = {"t_end": 0.5, "method": method, "dt": 1e-3, "u": {"x": "sin(900*t)"}}
    notes = []
    for system, z0 in ((warmed(2.25e6), None), (warmed(2.25e6, states=(WARMTH,)), [warm])):
        run = sf.simulate(sf.compile(system), [0.0], [0.1], z0=z0, **fields)
        notes.append(run.outcome.notes)
    assert "1500 rad/s" in notes[0][0] and notes[1][0] == notes[0][0]


@pytest.mark.parametrize("how", ["run", "interpret"])
def test_nor_does_it_in_a_diagram(how: str) -> None:
    """States of forces and of blocks: of an integrator that drives the mechanism, and stands at 1000."""
    d = sf.Diagram("warmed")
    d.add_model("body", warmed(2.25e6, states=(WARMTH,)), start={"dx": 0.1, "T": 290.0})
    d.add(blocks.Integrator(name="sum", start=[1000.0]), u="rate.y")
    d.add(blocks.Formula(name="rate", formulas={"y": ["v[0]"]}), v="plant.v")
    d.add(blocks.Gain(name="force", gain=1e-6), u="sum.y")
    d.add(blocks.ForwardDynamics(name="plant", model="body"), u="force.y")
    simulation = sf.Simulation(d)
    for dt, noted in ((1e-3, True), (1e-4, False)):
        run = getattr(simulation, how)(0.05, dt=dt, record=0.01)
        assert any("1500 rad/s" in note for note in run.outcome.notes) == noted


def test_modes_of_a_state_are_judged_by_changes_of_its_size() -> None:
    """A spring that slips is bent by 2 mm at most: bent by a metre, as far as a speed changes, it would seem stiff."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Hysteresis(1e3, 2.0),), actuated=True)
    model = sf.compile(sf.System("slips", (sf.RigidBody("body", joint, sf.Inertia(1.0)),), gravity=(0, 0, 0)))
    fields: dict[str, Any] = {"t_end": 3.0, "u": {"x": "4*sin(2*t)"}}
    run = sf.simulate(model, dt=1e-3, **fields)
    exact = sf.simulate(model, method="dop853", rtol=1e-10, atol=1e-12, **fields)
    np.testing.assert_allclose(run.q[-1], exact.q[-1], rtol=1e-4)
    assert not run.outcome.notes


def test_a_state_is_judged_by_how_far_it_goes_itself() -> None:
    """The mass is slow and resolved; the state is not, whose error is small beside its 300, not beside its way."""
    lags = sf.ForceState("T", "-50*(T - 300 - 5*sin(400*t))")
    model = sf.compile(warmed(4.0, states=(lags,)))
    runs = [
        sf.simulate(model, [0.0], [0.1], z0=[300.0], t_end=0.2, method="euler", dt=dt, u=[0.0]) for dt in (4e-3, 5e-5)
    ]
    coarse, fine = runs
    exact = sf.simulate(
        model, [0.0], [0.1], z0=[300.0], t_end=0.2, method="dop853", rtol=1e-12, output=coarse.t, u=[0.0]
    )
    assert np.abs(coarse.z - exact.z).mean() > 0.05 * np.ptp(exact.z)
    assert "do not determine the motion" in coarse.outcome.notes[0] and not fine.outcome.notes
