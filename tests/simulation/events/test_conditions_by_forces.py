"""Events whose conditions are multipliers, wrenches of constraints, or what joints transmit (constraints.md, 13)."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import build, sources
from tests.exports.cases import run as run_program

_G, _MASS, _RATE = 9.81, 2.0, 10.0


@cache
def held_arm(joint_name: str = "turn") -> sf.Model:
    """A carriage on a vertical rail with an arm that a latch holds level, and an input that pulls at the carriage."""
    carriage = sf.RigidBody("carriage", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(1.0))
    tip = sf.Frame("tip", (1.0, 0.0, 0.0))
    joint = sf.Joint(joint_name, "revolute", "carriage", axis=(0, 1, 0))
    arm = sf.RigidBody("arm", joint, sf.Inertia(_MASS, (0.5, 0, 0), (0.01, 0.1, 0.1)), (tip,))
    post = sf.RigidBody("world", None, frames=(sf.Frame("catch", (1.0, 0.0, 0.0)),))
    return sf.compile(
        sf.System(
            "held_arm",
            (post, carriage, arm),
            (sf.Parameter("shut", 1.0), sf.Parameter("strength", 40.0)),
            (sf.Input("pull"),),
            constraints=(
                sf.Closure("latch", ("world", "catch"), ("arm", "tip"), ("z",)),
                sf.Coupling("level", joint_name),
            ),
            switches=(sf.Switch("latch", "shut"),),
            virtual_power=(sf.VirtualPower("pull", {"dz": "pull"}),),
        )
    )


def pulled(condition: str, **options: Any) -> sf.Trajectory:
    """The latch carries the weight of 3 kg and a pull of 10 t downwards until the condition comes true."""
    event = sf.Event(condition, "rising", action={"shut": 0.0})
    return sf.simulate(held_arm(), t_end=2.0, u={"pull": f"-{_RATE}*t"}, events={"breaks": event}, **options)


_AT = (40.0 - 3.0 * _G) / _RATE


@pytest.mark.parametrize("options", [{"method": "dopri5"}, {"method": "rk4", "dt": 0.013}, {"method": "rodas4"}])
@pytest.mark.parametrize("force", ["lam.latch.z", "wrench.latch.fz", "sqrt(wrench.latch.fx^2 + wrench.latch.fz^2)"])
def test_a_latch_breaks_at_its_strength(force: str, options: dict[str, Any]) -> None:
    """At the instant of the closed form; then the carriage falls by its weight and by what pulls."""
    run = pulled(f"{force} - strength", **options)
    found = run.events[0]
    assert len(run.events) == 1 and found.t == pytest.approx(_AT, abs=1e-12), run.outcome
    assert np.abs(found.q).max() < 1e-12 and np.abs(found.v_after).max() < 1e-12
    first, rest = run.changes[0][0], run.t[-1] - found.t
    assert run.lam[first - 1, 0] == pytest.approx(40.0, abs=1e-9) and not run.lam[first:, 0].any()
    fallen = -(40.0 * rest**2 / 2 + _RATE * rest**3 / 6) / 3.0
    assert run.q[-1, 0] == pytest.approx(fallen, abs=1e-5)


@pytest.mark.parametrize("joint_name", ["turn", "left.turn"])
def test_conditions_are_the_forces_that_the_model_states(joint_name: str) -> None:
    """What a joint transmits, in a motion with inertia forces: the zero is where the trajectory has that value."""
    model = held_arm(joint_name)
    par, pull = {"shut": 0.0}, {"pull": "20*t*sin(3*t)"}
    events = {
        "loaded": sf.Event(f"reaction.{joint_name}.fz - 5", "rising"),
        "turned": sf.Event(f"reaction.{joint_name}.my - 2", "rising"),
    }
    run = sf.simulate(model, {"z": 0.1}, t_end=2.0, par=par, u=pull, events=events, method="dop853", rtol=1e-10)
    assert {found.name for found in run.events} == {"loaded", "turned"}, run.events
    for found in run.events:
        u = np.array([20.0 * found.t * np.sin(3.0 * found.t)])
        a, lam, _ = model.constrained_dynamics(found.q, found.v, u, par=run.par, t=found.t)
        wrench = model.joint_wrenches(found.q, found.v, a, u, lam, par=run.par, t=found.t)[1]
        value = wrench[2] - 5.0 if found.name == "loaded" else wrench[4] - 2.0
        assert abs(value) < 1e-9


def test_an_input_that_jumps_breaks_the_latch_at_once() -> None:
    """The multiplier passes the strength in no time, at the instant of the sample."""
    samples = sf.Signal(np.array([0.0, 0.5]), np.array([[0.0], [-50.0]]), kind="hold")
    event = sf.Event("lam.latch.z - strength", "rising", action={"shut": 0.0})
    run = sf.simulate(held_arm(), t_end=1.0, u=samples, events={"breaks": event}, dt=0.01)
    assert [found.t for found in run.events] == pytest.approx([0.5], abs=1e-12)
    assert run.v[-1, 0] == pytest.approx(-(3.0 * _G + 50.0) / 3.0 * 0.5, abs=1e-9)


def test_laws_and_actions_may_not_ask_for_forces() -> None:
    """A law, an action; and names that are not there are said to be unknown."""
    model, event = held_arm(), sf.Event("t - 0.5", action={"strength": "lam.latch.z"})
    with pytest.raises(sf.UnknownNameError, match="'lam.latch.z' may not be used here"):
        sf.simulate(model, u={"pull": "-lam.latch.z"})
    with pytest.raises(sf.UnknownNameError, match="'lam.latch.z' may not be used here"):
        sf.simulate(model, events={"set": event})
    with pytest.raises(sf.UnknownNameError, match="unknown symbol 'wrench.level.fx'"):
        sf.simulate(model, events={"none": sf.Event("wrench.level.fx - 1")})


def pulled_by_time() -> sf.System:
    """A weight on a latch, pulled at by 10 t."""
    weight = sf.RigidBody("weight", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(_MASS))
    return sf.System(
        "pulled_by_time",
        (weight,),
        (sf.Parameter("shut", 1.0), sf.Parameter("strength", 40.0)),
        constraints=(sf.Coupling("latch", "z"),),
        switches=(sf.Switch("latch", "shut"),),
        virtual_power=(sf.VirtualPower("pull", {"dz": f"-{_RATE}*t"}),),
    )


_BREAKS = {"breaks": sf.Event("lam.latch - strength", "rising", action={"shut": 0.0})}


def test_batches_and_packages_ask_for_forces_as_runs_do(tmp_path: Any) -> None:
    """Each motion of a batch at its own strength; a package of C at the instant of the run."""
    model, strengths = sf.compile(pulled_by_time()), np.array([30.0, 35.0, 40.0, 45.0])
    par = np.stack([np.ones(4), strengths], axis=-1)
    many = sf.simulate_batch(model, np.zeros((4, 1)), t_end=3.0, par=par, events=_BREAKS, dt=1e-2)
    at = (strengths - _MASS * _G) / _RATE
    for i in range(4):
        assert [found.t for found in many.events(i)] == pytest.approx([at[i]], abs=1e-12)
    sf.export(pulled_by_time(), "c", tmp_path / "c", name="plan", events=_BREAKS, dt=1e-2)
    (tmp_path / "c" / "main.c").write_text(Path("tests/exports/c/events.c").read_text())
    program = build(tmp_path / "c", "../plan", *sources(tmp_path / "c"))
    met, status, state = run_program(program, "0.1", "3.0", cwd=tmp_path).splitlines()
    assert met.split()[0] == "breaks" and float(met.split()[1]) == pytest.approx(at[2], abs=1e-12)
    run = sf.simulate(model, t_end=3.0, events=_BREAKS, dt=1e-2)
    assert status == "status 1" and float(state.split()[1]) == pytest.approx(run.q[-1, 0], abs=1e-12)
