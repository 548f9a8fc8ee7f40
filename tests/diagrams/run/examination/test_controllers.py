"""A sampled controller that drives the motion apart is named, and nothing else is taken for one."""

from __future__ import annotations

from functools import cache

import pytest

import symofros as sf
from symofros import blocks
from tests.diagrams.parts import moving

PERIOD = 1e-3


@cache
def arm(
    gravity: float = 0.0, EI: float = 20.0, hold: bool = False, elements: tuple[sf.Spring | sf.Damper, ...] = ()
) -> sf.Simulation:
    """A flexible arm under a sampled law; with `hold` the law is continuous, and a hold samples it."""
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), actuated=True, elements=elements)
    beam = sf.Beam("boom", joint, length=1.0, rhoA=0.5, EI_z=EI, bend_y=2)
    diagram = moving(sf.System("arm", (beam,), gravity=(0, -gravity, 0)), {"q": 0.1}, u="sampled" if hold else "pd")
    for of in "qv":
        diagram.add(blocks.Pick(name=of, model="plant", of=of, entries="actuated"), u=f"plant.{of}")
    diagram.add(blocks.Constant(name="goal", value=[0.0], unit="rad"))
    pd = blocks.JointPD(name="pd", kp=50.0, kd=1.0, period=None if hold else PERIOD)
    diagram.add(pd, q_desired="goal", q="q", v="v")
    if hold:
        diagram.add(blocks.Hold(name="sampled", period=PERIOD), u="pd")
    return sf.Simulation(diagram)


def gains(kp: float, kd: float) -> dict[str, float]:
    return {"pd.kp": kp, "pd.kd": kd}


@cache
def driven_apart(damping: float) -> sf.Simulation:
    """A joint on a spring that its own damper drives apart, where it is negative, under a law that is sampled."""
    elements = (sf.Spring(1e4), sf.Damper(damping))
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), actuated=True, elements=elements)
    body = sf.RigidBody("a", joint, sf.Inertia(1.0, (0, 0, 0), (1.0, 1.0, 1.0)))
    diagram = moving(sf.System("arm", (body,), gravity=(0, 0, 0)), {"q": 0.1}, u="pd")
    diagram.add(blocks.Constant(name="goal", value=[0.0], unit="rad"))
    pd = blocks.JointPD(name="pd", kp=1.0, kd=1.0, period=0.02)
    diagram.add(pd, q_desired="goal", q="plant.q", v="plant.v")
    return sf.Simulation(diagram)


def flutter(kp: float, kd: float) -> sf.Simulation:
    """Two masses on springs that a circulatory force drives apart; an idle law acts on them."""
    slides = [
        sf.Joint(name, "prismatic", on, axis=axis, actuated=True, elements=(sf.Spring(1e4),))
        for name, on, axis in (("x", "world", (1, 0, 0)), ("y", "carriage", (0, 1, 0)))
    ]
    carriage = sf.RigidBody("carriage", slides[0], sf.Inertia(0.01, (0, 0, 0), (1.0, 1.0, 1.0)))
    load = sf.RigidBody("load", slides[1], sf.Inertia(1.0, (0, 0, 0), (1.0, 1.0, 1.0)))
    diagram = moving(sf.System("pair", (carriage, load), gravity=(0, 0, 0)), {"x": 0.1}, u="all")
    diagram.add(blocks.Gain(name="follower", gain=[[0.0, 4000.0], [-4000.0, 0.0]]), u="plant.q")
    diagram.add(blocks.Constant(name="goal", value=[0.0, 0.0], unit="m"))
    pd = blocks.JointPD(name="pd", kp=kp, kd=kd, period=0.02)
    diagram.add(pd, q_desired="goal", q="plant.q", v="plant.v")
    diagram.add(blocks.Sum(name="all"), u1="follower", u2="pd")
    return sf.Simulation(diagram)


def two_laws(bad: str) -> sf.Simulation:
    """A carriage and an arm on it, each under a law of its own, one with too high a gain."""
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True)
    turn = sf.Joint("y", "revolute", "carriage", axis=(0, 0, 1), actuated=True)
    carriage = sf.RigidBody("carriage", slide, sf.Inertia(1.0, (0, 0, 0), (1.0, 1.0, 1.0)))
    link = sf.RigidBody("link", turn, sf.Inertia(1.0, (0, 0.1, 0), (1.0, 1.0, 1.0)))
    diagram = moving(sf.System("pair", (carriage, link), gravity=(0, 0, 0)), {"dx": 0.1, "dy": 0.1}, u="all")
    for name, row in (("x", [1.0, 0.0]), ("y", [0.0, 1.0])):
        gain = 400.0 if name == bad else 1.0
        diagram.add(blocks.Gain(name=name, gain=[[-gain * value for value in row]]), u="plant.v")
        diagram.add(blocks.Hold(name=f"{name}_law", period=0.02), u=name)
        diagram.add(blocks.Gain(name=f"{name}_force", gain=[[value] for value in row]), u=f"{name}_law")
    diagram.add(blocks.Sum(name="all"), u1="x_force", u2="y_force")
    return sf.Simulation(diagram)


@pytest.mark.parametrize(("hold", "named"), [(False, "pd"), (True, "sampled")])
@pytest.mark.parametrize("kd", [8.0, 100.0, 1000.0])
def test_an_unstable_gain_is_named(kd: float, hold: bool, named: str) -> None:
    outcome = arm(hold=hold).run(1.0, parameters=gains(50.0, kd)).outcome
    assert not outcome.ok
    assert outcome.reason.startswith(f"block '{named}', sampled every 0.001 s, drives the motion apart"), str(outcome)
    assert f"lower the gains of '{named}'" in outcome.advice and "divide it" not in outcome.advice


def test_the_unstable_controller_is_named_at_any_record_interval() -> None:
    outcome = arm().run(1.0, record=0.1, parameters=gains(50.0, 20.0)).outcome
    assert "block 'pd'" in outcome.reason


def test_a_stable_controller_is_not_named() -> None:
    assert arm().run(0.2).outcome.ok


def test_excessive_bending_is_attributed_to_the_beam() -> None:
    """Also where a law holds its root, as well as it can."""
    outcome = arm(gravity=200.0, EI=2.0).run(1.0).outcome
    assert outcome.kind == "beyond theory" and "beam 'plant.boom' bends by" in outcome.reason
    assert "divide it into" in outcome.advice


def test_instability_of_the_step_is_attributed_to_the_step() -> None:
    """The same law is stable with steps that the beam allows."""
    stiff = arm(EI=2e5)
    outcome = stiff.run(0.5, dt=1e-3).outcome
    assert outcome.kind == "diverged" and "past the limit of stability" in outcome.reason, str(outcome)
    assert stiff.run(0.01, dt=2e-6).outcome.ok


@pytest.mark.parametrize(("kp", "kd"), [(5.0, 0.5), (0.0, 0.0)])
def test_divergence_of_a_joint_is_not_attributed_to_a_weak_controller(kp: float, kd: float) -> None:
    """With gains of zero it diverges just the same."""
    outcome = driven_apart(-40.0).run(400.0, parameters=gains(kp, kd)).outcome
    assert outcome.kind == "diverged" and "'pd'" not in str(outcome), str(outcome)


def test_a_controller_that_destabilises_its_joint_is_named() -> None:
    outcome = driven_apart(1.0).run(400.0, parameters=gains(0.0, 2000.0)).outcome
    assert outcome.reason.startswith("block 'pd', sampled every 0.02 s"), str(outcome)


def test_flutter_is_not_attributed_to_an_idle_controller() -> None:
    outcome = flutter(0.1, 0.01).run(400.0).outcome
    assert outcome.kind == "diverged" and "'pd'" not in str(outcome), str(outcome)


@pytest.mark.parametrize(("EI", "k"), [(200.0, 300.0), (1000.0, 10.0)])
def test_divergence_of_a_loaded_beam_is_not_attributed_to_a_weak_controller(EI: float, k: float) -> None:
    weak = arm(gravity=1.0, EI=EI, elements=(sf.Spring(k), sf.Damper(-2.0)))
    outcome = weak.run(2.0, dt=2e-5, parameters=gains(1e-2, 1e-3)).outcome
    assert outcome.kind == "beyond theory" and "'pd'" not in str(outcome), str(outcome)


def test_a_destabilising_python_controller_is_named() -> None:
    """What it gave is replayed: it is the motion that says whether it grows without the law."""
    joint = sf.Joint("q", "revolute", axis=(0, 0, 1), actuated=True)
    body = sf.RigidBody("a", joint, sf.Inertia(1.0, (0, 0, 0), (1.0, 1.0, 1.0)))
    diagram = moving(sf.System("arm", (body,), gravity=(0, 0, 0)), {"dq": 0.1}, u="pd.u")
    law = blocks.PythonBlock(
        name="pd",
        function=lambda t, given: {"u": -230.0 * given["v"]},
        inputs={"v": None},
        outputs={"u": (1,)},
        period=0.02,
    )
    diagram.add(law, v="plant.v")
    outcome = sf.Simulation(diagram).run(100.0).outcome
    assert outcome.reason.startswith("block 'pd', sampled every 0.02 s"), str(outcome)


@pytest.mark.parametrize("bad", ["x", "y"])
def test_the_destabilising_one_of_two_controllers_is_named(bad: str) -> None:
    """Also where the motion reaches the other, whose output grows as well."""
    outcome = two_laws(bad).run(400.0).outcome
    assert outcome.reason.startswith(f"block '{bad}_law', sampled every 0.02 s"), str(outcome)
