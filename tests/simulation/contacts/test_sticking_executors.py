"""Friction that sticks in steppers, batches, packages and functions, and beside MuJoCo."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import build, sources
from tests.exports.cases import run as run_program
from tests.simulation.contacts.test_sticking import _G, incline, names_of, on_slide


def test_a_stepper_holds_as_a_run_does(tmp_path: Any) -> None:
    """Bit by bit, from a saved state too; what chooses no modes refuses friction that sticks, in words."""
    model = on_slide(
        sf.Spring(40.0),
        sf.Friction(3.0, 5.0, sticks=True),
        inputs=(sf.Input("pull"),),
        virtual_power=(sf.VirtualPower("pull", {"ds": "pull"}),),
    )
    pull = "9*sin(3*t)"
    run = sf.simulate(model, [0.3], t_end=4.0, u={"pull": pull}, dt=0.01)
    stepper = sf.Stepper(model, u={"pull": pull}, dt=0.01)
    stepper.reset([0.3])
    stepper.step(steps=150)
    state, mode = stepper.save(), float(stepper.par[0])
    stepper.step(steps=250)
    assert np.array_equal(stepper.q, run.q[-1]) and stepper.par[0] == run.par_over_time[-1, 0]
    assert [found.name for found in stepper.events] == names_of(run) and len(run.events) > 4
    stepper.restore(state)
    assert stepper.par[0] == mode
    stepper.step(steps=250)
    assert np.array_equal(stepper.q, run.q[-1])
    system = sf.System(
        "held",
        (sf.RigidBody("b", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Brake(1.0),)), sf.Inertia(1.0)),),
    )
    held = sf.compile(system)
    refused = (
        lambda: sf.simulate(held, t_end=1.0, method="cvode", stabilisation="baumgarte"),
        lambda: sf.export(system, "sfunction", tmp_path),
    )
    for attempt in refused:
        with pytest.raises(sf.SymofrosError, match="friction of 'x' sticks(?s:.)*sticks=False"):
            attempt()
    ball = sf.RigidBody("ball", sf.Joint("b", "ball", elements=(sf.Brake(1.0),)), sf.Inertia(1.0, moments=(1, 1, 1)))
    with pytest.raises(sf.DescriptionError, match="friction that sticks on a ball joint"):
        sf.compile(sf.System("ball", (ball,)))


def test_beside_mujoco() -> None:
    """Its `frictionloss` is a soft constraint: it slides alike, and creeps where friction holds."""
    mujoco = pytest.importorskip("mujoco")
    slope, moved, ours = 0.3, {}, {}
    weight = 2.0 * _G * math.sin(slope)
    for share in (0.5, 1.001):
        axis = f"{math.cos(slope)} 0 {-math.sin(slope)}"
        joint = f'<joint type="slide" axis="{axis}" frictionloss="{share * weight}"/>'
        joint += '<inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>'
        option = f'<option timestep="1e-3" gravity="0 0 -{_G}" integrator="RK4"/>'
        scene = mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody><body>{joint}</body></worldbody></mujoco>")
        data = mujoco.MjData(scene)
        for _ in range(2000):
            mujoco.mj_step(scene, data)
        moved[share] = float(data.qpos[0])
        ours[share] = float(sf.simulate(incline(share), t_end=2.0, dt=1e-3).q[-1, 0])
    assert ours[0.5] == pytest.approx(moved[0.5], rel=1e-2) and ours[1.001] == 0.0
    assert 1e-4 < moved[1.001] < 0.1 * moved[0.5], moved


@pytest.mark.parametrize("options", [{"dt": 0.01}, {"method": "dopri5", "rtol": 1e-10}])
def test_batches_hold_as_single_runs_do(options: dict[str, Any]) -> None:
    """More motions than slots, each with modes of its own, some held from the start; and steppers of many."""
    parameters = (sf.Parameter("level", 3.0),)
    model = on_slide(sf.Spring(40.0), sf.Friction("level", sticks=True), parameters=parameters)
    rng, n = np.random.default_rng(2), 70
    starts = rng.uniform(-0.6, 0.6, (n, 1))
    par = np.stack([rng.uniform(1.0, 9.0, n), np.zeros(n)], axis=-1)
    many = sf.simulate_batch(model, starts, t_end=3.0, par=par, **options)
    singles = [sf.simulate(model, starts[i], t_end=3.0, par=par[i], **options) for i in range(n)]
    assert all(many.outcome(i).kind == "finished" for i in range(n))
    for i, run in enumerate(singles):
        assert [found.name for found in many.events(i)] == names_of(run)
        assert many.q[i, -1] == pytest.approx(run.q[-1], abs=1e-9) and (many.v[i, -1] == 0.0) == (run.v[-1] == 0.0)
    assert 10 < sum(run.events == () for run in singles) < 60
    if "dt" in options:
        steppers = sf.Steppers(model, n, par=par, dt=0.01)
        steppers.reset(starts)
        steppers.step(steps=300)
        assert steppers.q == pytest.approx(many.q[:, -1], abs=1e-12)


def test_a_package_holds_as_a_run_does(tmp_path: Any) -> None:
    """The same modes at the same instants in C, in calls of any length, and again after a reset."""
    joint = sf.Joint("s", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(40.0), sf.Friction(3.0, 5.0, sticks=True)))
    pull = sf.VirtualPower("pull", {"ds": "9*sin(3*t)"})
    system = sf.System("pulled", (sf.RigidBody("b", joint, sf.Inertia(2.0)),), gravity=(0, 0, 0), virtual_power=(pull,))
    sf.export(system, "c", tmp_path / "c", name="plan", start={"s": 0.3}, dt=1e-3)
    (tmp_path / "c" / "main.c").write_text(Path("tests/exports/c/events.c").read_text())
    program = build(tmp_path / "c", "../plan", *sources(tmp_path / "c"))
    run = sf.simulate(sf.compile(system), [0.3], t_end=4.0, dt=1e-3)
    for span in ("0.01", "4.0"):
        *met, status, state = run_program(program, span, "4.0", cwd=tmp_path).splitlines()
        instants = [float(line.split()[1]) for line in met]
        assert status == "status 1" and instants == pytest.approx([found.t for found in run.events], abs=1e-10)
        assert [float(x) for x in state.split()[1:]] == pytest.approx([run.q[-1, 0], run.v[-1, 0]], abs=1e-10)
    assert len(run.events) > 4


def test_functions_say_what_they_take_for_friction_that_sticks() -> None:
    """Modes of a joint at rest are those of the smooth law: noted, with the way to those of a joint that is held."""
    model = on_slide(sf.Friction(6.0, sticks=True), sf.Spring(100.0), slope=0.1)
    (note,) = sf.modes(model, [-0.02 * _G * math.sin(0.1) * -1.0]).notes
    assert note.startswith("friction of 's' sticks in runs and is smooth here") and "par={'s.mode': 2}" in note
    assert not sf.modes(model, [0.0], par={"s.mode": 2}).notes
    rest: Any = ([0.0], [0.0], [])
    for function in (model.forward_dynamics, model.constrained_dynamics, model.linearize):
        with pytest.warns(sf.InconsistentModelWarning, match="friction of 's' sticks in runs(.|\n)*par={'s.mode': 2}"):
            function(*rest)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            function(*rest, par={"s.mode": 2})
            function([0.0], [0.1], [])
    assert model.forward_dynamics(*rest, par={"s.mode": 2}) == pytest.approx([0.0], abs=1e-15)
    with pytest.raises(sf.SymofrosError, match="friction of 's' carries 1.96 in motion only, up to 6(.|\n)*held="):
        sf.equilibrium(on_slide(sf.Friction(6.0, sticks=True), slope=0.1))
    with pytest.raises(sf.SymofrosError, match="rollout: friction that sticks"):
        sf.rollout(model, [0.0], [0.0], np.zeros((10, 0)), dt=1e-3)
