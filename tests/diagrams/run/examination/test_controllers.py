"""A sampled controller that drives the motion apart is named, and nothing else is taken for one."""

from __future__ import annotations

import pytest

import symofros as sf
from symofros import blocks

PERIOD = 1e-3


def arm(kd: float, gravity: float = 0.0, EI: float = 20.0, kp: float = 50.0, hold: bool = False) -> sf.Simulation:
    """A flexible arm under a law that is sampled; with `hold` the law is continuous, and a hold samples it."""
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), actuated=True)
    beam = sf.Beam("boom", joint, length=1.0, rhoA=0.5, EI_z=EI, bend_y=2)
    diagram = sf.Diagram("law")
    diagram.add_model("arm", sf.System("arm", (beam,), gravity=(0, -gravity, 0)), start={"q": 0.1})
    diagram.add(blocks.ForwardDynamics(name="plant", model="arm"), u="sampled" if hold else "pd")
    for of in "qv":
        diagram.add(blocks.Pick(name=of, model="arm", of=of, entries="actuated"), u=f"plant.{of}")
    diagram.add(blocks.Constant(name="goal", value=[0.0], unit="rad"))
    pd = blocks.JointPD(name="pd", kp=kp, kd=kd, period=None if hold else PERIOD)
    diagram.add(pd, q_desired="goal", q="q", v="v")
    if hold:
        diagram.add(blocks.Hold(name="sampled", period=PERIOD), u="pd")
    return sf.Simulation(diagram)


@pytest.mark.parametrize(("hold", "named"), [(False, "pd"), (True, "sampled")])
@pytest.mark.parametrize("kd", [8.0, 20.0, 100.0, 1000.0])
def test_an_unstable_gain_is_named(kd: float, hold: bool, named: str) -> None:
    outcome = arm(kd, hold=hold).run(1.0).outcome
    assert not outcome.ok
    assert outcome.reason.startswith(f"block '{named}', sampled every 0.001 s, drives the motion apart"), str(outcome)
    assert f"lower the gains of '{named}'" in outcome.advice and "divide it" not in outcome.advice


def test_it_is_named_whatever_the_records() -> None:
    outcome = arm(20.0).run(1.0, record=0.1).outcome
    assert "block 'pd'" in outcome.reason


def test_a_law_that_is_stable_is_not() -> None:
    assert arm(1.0).run(0.2).outcome.ok


def test_a_load_that_bends_a_beam_beyond_its_theory_is_said_of_the_beam() -> None:
    """Also where a law holds its root, as well as it can."""
    outcome = arm(1.0, gravity=200.0, EI=2.0).run(1.0).outcome
    assert outcome.kind == "beyond theory" and "beam 'plant.boom' bends by" in outcome.reason
    assert "divide it into" in outcome.advice


def test_a_step_past_the_limit_of_stability_is_said_of_the_step() -> None:
    """The same law is stable with steps that the beam allows."""
    stiff = arm(1.0, EI=2e5)
    outcome = stiff.run(0.5, dt=1e-3).outcome
    assert outcome.kind == "diverged" and "past the limit of stability" in outcome.reason, str(outcome)
    assert stiff.run(0.01, dt=2e-6).outcome.ok
