"""Simulation.state_space: by hand, by models' own linearisation, by differences of the diagram's runs, by poles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import symofros as sf
from symofros import blocks
from symofros.diagrams.block import EvaluationContext, Values
from tests.diagrams.parts import Spoken

MODELS = Path(__file__).parents[2] / "reference_models"
PENDULUM = sf.load(MODELS / "rigid" / "double_pendulum.yaml")
FOUR_BAR = sf.load(MODELS / "closed" / "four_bar.yaml")
CRANK: Any = FOUR_BAR.bodies[0]
CRANK = replace(CRANK, joint=replace(CRANK.joint, actuated=True))
FOUR_BAR = replace(FOUR_BAR, bodies=(CRANK, *FOUR_BAR.bodies[1:]))
FREE = sf.load(MODELS / "rigid" / "space_arm.yaml")
KP, KD = np.diag([40.0, 15.0]), np.diag([8.0, 2.0])


def plant(model: sf.System, start: dict[str, float], *outlets: str, u: str | None = None) -> sf.Diagram:
    """A mechanism, with an inlet for its efforts unless something gives them."""
    diagram = sf.Diagram("plant")
    diagram.add_model("plant", model, start=start)
    diagram.add(blocks.ForwardDynamics(name="plant", model="plant"), **({"u": u} if u else {}))
    if u is None:
        diagram.add_inlet("u", "plant.u")
    for name in outlets:
        diagram.outlets[name.replace(".", "_")] = name
    return diagram


def held(period: float | None = None, weight: bool = False) -> sf.Diagram:
    """A double pendulum under joint PD towards an inlet."""
    diagram = plant(PENDULUM, {"q1": 0.3, "q2": -0.2}, "plant.q", u="effort" if weight else "pd.effort")
    diagram.add(blocks.JointPD(name="pd", kp=[40.0, 15.0], kd=[8.0, 2.0], period=period), q="plant.q", v="plant.v")
    diagram.add_inlet("goal", "pd.q_desired", shape=(2,))
    diagram.outlets["effort_"] = "pd.effort"
    if weight:
        diagram.add(blocks.GravityCompensation(name="weight", model="plant"), q="plant.q")
        diagram.add(blocks.Sum(name="effort"), u1="pd.effort", u2="weight.effort")
    return diagram


def transfer(found: sf.DiagramStateSpace | Any, s: complex) -> np.ndarray:
    """C (s I - A)^-1 B + D."""
    return found.C @ np.linalg.solve(s * np.eye(len(found.A)) - found.A, found.B) + found.D


def test_a_plant_and_its_controller_are_closed_as_by_hand() -> None:
    goal, q, v = np.array([0.1, 0.2]), np.array([0.3, -0.2]), np.array([0.5, -1.0])
    found = sf.Simulation(held()).state_space(inputs={"goal": goal}, starts={"plant.v": v})
    A, B = sf.compile(PENDULUM).linearize(q, v, KP @ (goal - q) - KD @ v)
    K = np.hstack([KP, KD])
    assert np.abs(found.A - (A - B @ K)).max() < 1e-10 * np.abs(found.A).max()
    assert np.abs(found.B - B @ KP).max() < 1e-10 * np.abs(found.B).max()
    assert np.abs(found.C - np.vstack([np.eye(2, 4), -K])).max() < 1e-12
    assert np.array_equal(found.D, np.vstack([np.zeros((2, 2)), KP])) and found.period is None
    assert found.states == ("plant.q1", "plant.q2", "plant.dq1", "plant.dq2")
    assert found.inputs == ("goal[0]", "goal[1]") and found.outputs == ("plant_q",) * 2 + ("effort_",) * 2
    assert np.array_equal(found.rates[:2], v) and np.array_equal(found.basis, np.eye(4))


def test_a_floating_mechanism_is_that_of_its_model() -> None:
    model, rng = sf.compile(FREE), np.random.default_rng(5)
    q, v, u = model.neutral(), 0.3 * rng.standard_normal(model.nv), rng.standard_normal(model.nu)
    q = model.integrate(q, 0.5 * rng.standard_normal(model.nv))
    found = sf.Simulation(plant(FREE, {}, "plant.v", "plant.a")).state_space(
        inputs={"u": u}, starts={"plant.q": q, "plant.v": v}
    )
    A, B, C, D = model.linearize(q, v, u, outputs=["v", "a"])
    for ours, of_model in ((found.A, A), (found.B, B), (found.C, C), (found.D, D)):
        assert np.abs(ours - of_model).max() < 1e-10 * max(1.0, np.abs(of_model).max())


def test_a_closed_loop_mechanism_is_that_of_its_model() -> None:
    model = sf.compile(FOUR_BAR)
    start = sf.assemble(model, [0.9, -0.8, 1.0], v=[1.0, -1.0, 1.0])
    u = np.ones(model.nu)
    diagram = plant(FOUR_BAR, {}, "plant.v", "plant.a")
    diagram.add(blocks.Integrator(name="sum", start=np.zeros(model.nv)), u="plant.v")  # Idle coordinates among others.
    diagram.outlets["sum_y"] = "sum.y"
    found = sf.Simulation(diagram).state_space(inputs={"u": u}, starts={"plant.q": start.q, "plant.v": start.v})
    of_model = sf.state_space(model, start.q, start.v, u, outputs=["v", "a"])
    assert len(found.A) == len(of_model.A) + model.nv and len(found.basis) == 3 * model.nv
    for s in (2.0 + 1.0j, -0.3j):
        ours, theirs = transfer(found, s), transfer(of_model, s)
        assert np.abs(ours[: 2 * model.nv] - theirs).max() < 1e-9 * np.abs(theirs).max()
        assert np.abs(ours[2 * model.nv :] - theirs[: model.nv] / s).max() < 1e-9 * np.abs(theirs).max()


@pytest.mark.parametrize("case", ["held arm", "four bar"])
def test_small_motions_of_runs_are_those_of_the_linear_model(case: str) -> None:
    """About an equilibrium a change x0 becomes expm(A T) x0; by central differences of runs."""
    T, step = 0.3, 1e-4
    if case == "held arm":
        simulation, given = sf.Simulation(held(weight=True)), {"goal": np.array([0.3, -0.2])}
        q = np.array([0.3, -0.2])
    else:
        model = sf.compile(FOUR_BAR)
        q = sf.equilibrium(model, [-1.5, 1.5, -1.5]).q
        simulation, given = sf.Simulation(plant(FOUR_BAR, {}, "plant.q")), {"u": np.zeros(model.nu)}
    found = simulation.state_space(inputs=given, starts={"plant.q": q})
    assert np.abs(found.rates).max() < 1e-9
    n = len(q)
    for k in range(len(found.A)):
        ends = []
        for sign in (1.0, -1.0):
            change = sign * step * found.basis[:, k]
            starts = {"plant.q": q + change[:n], "plant.v": change[n:]}
            if case == "four bar":
                on = sf.assemble(model, starts["plant.q"], v=starts["plant.v"])
                starts = {"plant.q": on.q, "plant.v": on.v}
            run = simulation.run(T, inputs=given, starts=starts, output=T)
            ends.append(np.append(run.q[-1], run.v[-1]))
        change = found.basis.T @ (ends[0] - ends[1]) / (2.0 * step)
        expected = expm(found.A * T)[:, k]
        assert np.abs(change - expected).max() < 2e-6 * max(1.0, np.abs(expected).max())


def test_eigenvalues_are_the_poles_by_hand() -> None:
    """A mass under PD behind a lag of the sensor: (s^2 m + s kd/(tau s + 1) ...) has the poles of its polynomial."""
    m, kp, kd, tau = 2.0, 50.0, 8.0, 0.05
    diagram = sf.Diagram("servo")
    diagram.add_inlet("goal", "error.u1", shape=())
    diagram.add(blocks.Sum(name="error", signs="+-"), u2="sensor.y")
    diagram.add(blocks.TransferFunction(name="pd", num=[kd, kp], den=[0.01, 1.0]), u="error.y")
    diagram.add(blocks.Gain(name="inverse", gain=1.0 / m), u="pd.y")
    diagram.add(blocks.Integrator(name="v"), u="inverse.y")
    diagram.add(blocks.Integrator(name="x"), u="v.y")
    diagram.add(blocks.TransferFunction(name="sensor", num=[1.0], den=[tau, 1.0]), u="x.y")
    diagram.outlets["x_"] = "x.y"
    found = sf.Simulation(diagram).state_space()
    # m s^2 (0.01 s + 1) (tau s + 1) + kd s + kp = 0
    polynomial = np.polyadd(np.polymul([m, 0.0, 0.0], np.polymul([0.01, 1.0], [tau, 1.0])), [kd, kp])
    poles, expected = np.linalg.eigvals(found.A), np.roots(polynomial)
    assert len(found.A) == 4
    for pole in expected:
        assert np.abs(poles - pole).min() < 1e-9 * np.abs(pole)
    for s in (1.0j, 3.0 + 1.0j):
        ratio = (kd * s + kp) * (tau * s + 1.0) / np.polyval(polynomial, s)
        assert abs(transfer(found, s)[0, 0] - ratio) < 1e-10 * abs(ratio)


def controller(period: float | None = 0.01) -> sf.Diagram:
    """PI with its output through a sampled state space."""
    diagram = sf.Diagram("controller")
    diagram.add_inlet("e", shape=())
    diagram.add(blocks.Integrator(name="sum", period=0.01), u="e")
    diagram.add(blocks.Gain(name="gain", gain=3.0), u="sum.y")
    diagram.add(blocks.Sum(name="pass", period=period), u1="e", u2="gain.y")
    diagram.outlets["y"] = "pass.y"
    return diagram


def test_sampled_blocks_are_linear_from_sample_to_sample() -> None:
    found = sf.Simulation(controller()).state_space()
    assert found.period == 0.01 and len(found.A) == 1
    assert np.allclose([found.A[0, 0], found.C[0, 0], found.D[0, 0]], [1.0, 3.0, 1.0], rtol=0, atol=1e-15)
    assert abs(found.B[0, 0] - 0.01) < 1e-16 and found.rates[0] == 0.0
    moving = sf.Simulation(controller()).state_space(inputs={"e": 2.0})
    assert abs(moving.rates[0] - 0.02) < 1e-16


def test_samples_follow_the_linear_model() -> None:
    """Where all is linear, the outlets of a run are y[k] of the linear model to rounding."""
    diagram, rng = sf.Diagram("sampled"), np.random.default_rng(2)
    A, B, C = 0.4 * rng.standard_normal((3, 3)), rng.standard_normal((3, 2)), rng.standard_normal((2, 3))
    diagram.add_inlet("u", "plant.u", shape=(2,))
    diagram.add(blocks.StateSpace(name="plant", A=A, B=B, C=C, D=np.eye(2), period=0.02))
    diagram.outlets["y"] = "plant.y"
    simulation = sf.Simulation(diagram)
    found = simulation.state_space()
    assert np.abs(np.sort_complex(np.linalg.eigvals(found.A)) - np.sort_complex(np.linalg.eigvals(A))).max() < 1e-12
    inputs = rng.standard_normal((20, 2))
    run = simulation.run(0.38, inputs={"u": sf.Signal(0.02 * np.arange(20), inputs, "hold")}, output=0.02)
    x = np.zeros(3)
    for k in range(20):
        assert np.abs(run["plant.y"][k] - (found.C @ x + found.D @ inputs[k])).max() < 1e-12
        x = found.A @ x + found.B @ inputs[k]


@pytest.mark.parametrize("late", [False, True])
def test_a_sampled_law_of_a_mass_has_the_poles_by_hand(late: bool) -> None:
    """Forces held: x+ = x + T v + T^2 F/(2 m), v+ = v + T F/m, F = kp (goal - x) - kd v of this sample or the last."""
    T, m, kp, kd = 0.1, 2.0, 30.0, 6.0
    diagram = sf.Diagram("servo")
    diagram.add_inlet("goal", "error.u1", shape=())
    diagram.add(blocks.Sum(name="error", signs="+-", period=T), u2="x.y")
    diagram.add(blocks.Gain(name="kp", gain=kp), u="error.y")
    diagram.add(blocks.Gain(name="kd", gain=kd, period=T), u="v.y")
    diagram.add(blocks.Sum(name="force", signs="+-"), u1="kp.y", u2="kd.y")
    if late:
        diagram.add(blocks.UnitDelay(name="late", period=T), u="force.y")
    diagram.add(blocks.Gain(name="inverse", gain=1.0 / m), u="late.y" if late else "force.y")
    diagram.add(blocks.Integrator(name="v"), u="inverse.y")
    diagram.add(blocks.Integrator(name="x"), u="v.y")
    diagram.outlets["x_"] = "x.y"
    found = sf.Simulation(diagram).state_space(starts={"x.x": 0.7, "v.x": -1.0})  # Linear: any state will do.
    assert found.period == T and found.states == ("v.x", "x.x", *(["late.before"] if late else []))
    free, push, law = np.array([[1.0, 0.0], [T, 1.0]]), np.array([T, 0.5 * T * T]) / m, np.array([-kd, -kp])
    A, B = free + np.outer(push, law), kp * push
    if late:
        A, B = np.block([[free, push[:, None]], [law, 0.0]]), np.array([0.0, 0.0, kp])
    assert np.abs(found.A - A).max() < 1e-13 and np.abs(found.B[:, 0] - B).max() < 1e-13
    assert np.abs(found.rates - (A @ [-1.0, 0.7, 0.0][: len(A)] - [-1.0, 0.7, 0.0][: len(A)])).max() < 1e-13
    # z^2 + (a + b - 2) z + 1 + a - b with a = kp T^2/(2 m), b = kd T/m; late: z (z - 1)^2 + (a + b) z + a - b.
    a, b = 0.5 * kp * T * T / m, kd * T / m
    polynomial = [1.0, -2.0, 1.0 + a + b, a - b] if late else [1.0, a + b - 2.0, 1.0 + a - b]
    assert np.abs(np.poly(found.A) - polynomial).max() < 1e-13


def several_rates() -> tuple[sf.Diagram, dict[str, Any], float]:
    """A cart-pole under a late state feedback, whose goal comes from a slower loop that begins later."""
    diagram = plant(sf.load(MODELS / "rigid" / "cart_pole.yaml"), {}, "plant.q", "plant.v", u="lag.y")
    diagram.add(blocks.Join(name="state", count=3), u1="plant.q", u2="plant.v", u3="outer.y")
    law = blocks.Gain(name="law", gain=[[1.0, 35.0, 2.5, 8.0, -1.0]], period=0.02)
    diagram.add(law, u="state.y")
    diagram.add(blocks.TransportDelay(name="lag", delay=0.03, period=0.02, start=[0.0]), u="law.y")
    diagram.add(blocks.Sum(name="outer", period=0.06, offset=0.01), u1="command.y", u2="sum.y")
    diagram.add(blocks.Integrator(name="sum", period=0.04, start=0.0), u="outer.y")
    diagram.add(blocks.Gain(name="command", gain=2.0))
    diagram.add_inlet("push", "command.u", shape=())
    for name in ("lag", "outer", "sum", "law"):
        diagram.outlets[name + "_y"] = f"{name}.y"
    return diagram, {}, 0.12


def on_constraints() -> tuple[sf.Diagram, dict[str, Any], float]:
    """A four-bar at its equilibrium, its crank under a sampled PD with an integral."""
    q = sf.equilibrium(sf.compile(FOUR_BAR), [-1.5, 1.5, -1.5]).q
    diagram = plant(FOUR_BAR, {}, "plant.q", "plant.v", u="effort.y")
    pd = np.array([[-4.0, 0.0, 0.0, -0.5, 0.0, 0.0]])
    diagram.add(
        blocks.Constant(name="goal", value=q),
    )
    diagram.add(blocks.Sum(name="change", signs="+-"), u1="plant.q", u2="goal.y")
    diagram.add(blocks.Join(name="state"), u1="change.y", u2="plant.v")
    diagram.add(blocks.Gain(name="law", gain=pd, period=0.05), u="state.y")
    diagram.add(blocks.Integrator(name="sum", start=[0.0], period=0.05), u="law.y")
    diagram.add(blocks.Sum(name="effort", signs="+++"), u1="law.y", u2="sum.y")
    diagram.add_inlet("push", "effort.u3", shape=(1,))
    diagram.outlets |= {"law_y": "law.y", "sum_y": "sum.y"}
    return diagram, {"plant.q": q}, 0.05


@pytest.mark.parametrize("case", [several_rates, on_constraints])
def test_sampled_control_of_a_plant_is_that_of_its_runs(case: Any) -> None:
    """Outlets at the beginnings of three cycles, by each continuous state and inlet, by central differences of runs."""
    diagram, at, period = case()
    simulation = sf.Simulation(diagram)
    found = simulation.state_space(starts=at)
    assert found.period == period and np.abs(found.rates).max() < 1e-10
    model = sf.compile(simulation.resolved.diagram.models["plant"].system)
    nq, step, chosen = model.nq, 1e-4, {"method": "dop853", "rtol": 1e-11, "atol": 1e-13}

    def outlets(change: Any, push: float) -> np.ndarray:
        q, v = np.asarray(at.get("plant.q", np.zeros(nq))) + change[:nq], change[nq : 2 * nq]
        if model.nc:
            on = sf.assemble(model, q, v=v)
            q, v = on.q, on.v
        starts = {"plant.q": q, "plant.v": v}
        run = simulation.run(2.0 * period, inputs={"push": push}, starts=starts, output=period, **chosen)
        return np.hstack([run[f"{source[0]}.{source[1]}"].reshape(3, -1) for source in ends])

    ends = [tuple(name.rsplit("_", 1)) if name.endswith("_y") else ("plant", name[-1]) for name in diagram.outlets]
    X, moving = np.eye(len(found.A)), [k for k in range(len(found.A)) if np.any(found.basis[: 2 * nq, k])]
    for k in moving:
        change = step * found.basis[: 2 * nq, k]
        differences = (outlets(change, 0.0) - outlets(-change, 0.0)) / (2.0 * step)
        x = X[k]
        for row in differences:
            assert np.abs(row - found.C @ x).max() < 3e-6 * max(1.0, np.abs(row).max())
            x = found.A @ x
    x, none = np.zeros(len(found.A)), np.zeros(2 * nq)
    for row in (outlets(none, step) - outlets(none, -step)) / (2.0 * step):
        assert np.abs(row - found.C @ x - found.D[:, 0]).max() < 3e-6 * max(1.0, np.abs(row).max())
        x = found.A @ x + found.B[:, 0]


def scalar(block: sf.blocks.Block, start: float = 0.0) -> sf.Diagram:
    """x' = f(x) + w of a block f, and its output."""
    diagram = sf.Diagram("scalar")
    diagram.add_inlet("w", "rate.u1", shape=())
    diagram.add(blocks.Sum(name="rate"), u2="f.y")
    diagram.add(blocks.Integrator(name="x", start=start), u="rate.y")
    diagram.add(block, u="x.y")
    diagram.outlets["y"] = "f.y"
    return diagram


@pytest.mark.parametrize(("at", "slope"), [(0.5, 1.0), (1.5, 0.0), (1.0, None), (-1.0, None)])
def test_a_limit_has_a_slope_on_each_side_and_none_at_its_edge(at: float, slope: float | None) -> None:
    simulation = sf.Simulation(scalar(blocks.Saturation(name="f", low=-1.0, high=1.0)))
    if slope is None:
        with pytest.raises(sf.SymofrosError, match=r"no linear model[\s\S]*block 'f' switches[\s\S]*remedy:"):
            simulation.state_space(starts={"x.x": at})
        return
    found = simulation.state_space(starts={"x.x": at})
    assert found.A[0, 0] == found.C[0, 0] == slope


@pytest.mark.parametrize("of", ["plant.a", "plant.lam"])
def test_a_limit_of_what_constraints_leave_has_none_at_its_edge(of: str) -> None:
    """At rest accelerations are zero, and forces of constraints what they are there."""
    diagram = plant(FOUR_BAR, {}, of)
    q = sf.equilibrium(sf.compile(FOUR_BAR), [-1.5, 1.5, -1.5]).q
    edge = sf.Simulation(diagram).run(1e-3, inputs={"u": 0.0}, starts={"plant.q": q})[of][0]
    diagram.add(blocks.Saturation(name="f", low=edge, high=edge + 9.0), u=of)
    diagram.outlets["y"] = "f.y"
    with pytest.raises(sf.SymofrosError, match=r"no linear model[\s\S]*block 'f' switches"):
        sf.Simulation(diagram).state_space(starts={"plant.q": q})
    found = sf.Simulation(diagram).state_space(starts={"plant.q": q}, inputs={"u": 1e-3}, outputs=[of])
    assert np.isfinite(found.C).all()


def test_a_kink_without_a_jump_of_the_slope_is_smooth() -> None:
    simulation = sf.Simulation(scalar(blocks.Formula(name="f", formulas={"y": "-abs(u)*u"})))
    assert simulation.state_space().A[0, 0] == 0.0


@pytest.mark.parametrize("period", [None, 0.1])
def test_a_jump_between_equal_slopes_is_no_linear_model(period: float | None) -> None:
    diagram = sf.Diagram("relay")
    diagram.add_inlet("e", "f.e", shape=())
    diagram.add(blocks.Formula(name="f", formulas="3*e - 1e-3*sign(e)", period=period))
    diagram.outlets["y"] = "f.y"
    with pytest.raises(sf.SymofrosError, match=r"no linear model[\s\S]*block 'f' switches"):
        sf.Simulation(diagram).state_space()
    assert sf.Simulation(diagram).state_space(inputs={"e": 1e-6}).D[0, 0] == 3.0


@pytest.mark.parametrize("model", [PENDULUM, FOUR_BAR], ids=["tree", "loop"])
def test_dry_friction_at_rest_is_no_linear_model(model: sf.System) -> None:
    size = len(sf.compile(model).names.v)
    diagram, starts = (
        plant(model, {}, "plant.q", u="f.y"),
        {"plant.q": sf.equilibrium(sf.compile(model), [-1.5, 1.5, -1.5][:size]).q},
    )
    diagram.add(
        blocks.Formula(name="f", formulas={"y": ["-0.1*sign(v[0])"] * len(sf.compile(model).names.u)}), v="plant.v"
    )
    with pytest.raises(sf.SymofrosError, match=r"no linear model[\s\S]*block 'f' switches"):
        sf.Simulation(diagram).state_space(starts=starts)


def test_a_limited_integrator_at_its_limit_is_refused() -> None:
    diagram = sf.Diagram("limited")
    diagram.add_inlet("w", "x.u", shape=())
    diagram.add(blocks.Integrator(name="x", start=1.0, low=-1.0, high=1.0))
    diagram.outlets["y"] = "x.y"
    with pytest.raises(sf.SymofrosError, match="block 'x' switches" + r"[\s\S]*rule:[\s\S]*remedy:"):
        sf.Simulation(diagram).state_space()


def test_what_has_no_linear_model_is_refused_with_its_remedy() -> None:
    def refused(diagram: sf.Diagram, words: str) -> None:
        with pytest.raises(sf.SymofrosError, match=r"no linear model[\s\S]*found:[\s\S]*" + words):
            sf.Simulation(diagram).state_space()

    refused(
        held(period=1e-3), r"the state moves while samples hold: 'plant\.dq2' by 0\.488 in 0\.001 s[\s\S]*equilibrium"
    )
    spoken = sf.Diagram("spoken")
    spoken.add_inlet("x", "echo.x", shape=())
    spoken.add(Spoken(name="echo", heard=[], period=1e-3))
    spoken.outlets["y"] = "echo.y"
    refused(spoken, "block 'echo' is no formula")
    rooted = scalar(blocks.Formula(name="f", formulas="sqrt(u)"))
    rooted.add(blocks.Hold(name="late", period=1.0), u="x.y")
    rooted.outlets["late_"] = "late.y"
    refused(rooted, "A is not finite")


def test_samples_that_nothing_depends_on_count_for_nothing() -> None:
    diagram = held()
    diagram.add(blocks.Hold(name="shown", period=0.01), u="plant.q")
    found, alone = (sf.Simulation(one).state_space() for one in (diagram, held()))
    assert np.array_equal(found.A, alone.A) and np.array_equal(found.C, alone.C)


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"inputs": {"gaol": [0.0, 0.0]}}, sf.UnknownNameError, "no inlet 'gaol'[\\s\\S]*did you mean 'goal'"),
        ({"inputs": {"goal": [0.0]}}, sf.ShapeError, "inlet 'goal' does not fit"),
        ({"inputs": {"goal": [0.0, np.nan]}}, sf.SymofrosError, "inlet 'goal': a number is not finite"),
        ({"starts": {"plant.q9": 0.0}}, sf.UnknownNameError, "no state 'plant.q9'"),
        ({"outputs": ["pd.nothing"]}, sf.DescriptionError, "nothing"),
    ],
)
def test_invalid_arguments_are_refused(given: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        sf.Simulation(held()).state_space(**given)


@dataclass(frozen=True, kw_only=True)
class Wrapped(blocks.Gain):
    """An angle, 0 to a whole turn."""

    def compute(self, context: EvaluationContext) -> Values:
        u, turn = context.inputs["u"], context.parameters["gain"]
        return {"y": u - turn * (u / turn).apply("floor")}


@pytest.mark.parametrize("period", [None, 0.1])
def test_what_rounds_has_no_linear_model(period: float | None) -> None:
    """Its derivative is zero everywhere, though its output follows the input."""
    diagram = scalar(blocks.Quantizer(name="f", step=0.01, period=period))
    with pytest.raises(
        sf.SymofrosError, match=r"no linear model[\s\S]*block 'f' rounds what it gives[\s\S]*a gain of 1"
    ):
        sf.Simulation(diagram).state_space(starts={"x.x": 0.333})
    wrapped = sf.Simulation(scalar(Wrapped(name="f", gain=6.0, period=period))).state_space(starts={"x.x": 1.0})
    assert abs(wrapped.C[0, 0] - 1.0) < 1e-12


def test_rounding_that_states_and_inlets_do_not_reach_counts_for_nothing() -> None:
    diagram = scalar(blocks.Gain(name="f", gain=-2.0))
    diagram.add(blocks.Sine(name="wave"))
    diagram.add(blocks.Quantizer(name="steps", step=0.01), u="wave.y")
    diagram.add(blocks.Quantizer(name="shown", step=0.01), u="x.y")  # Nothing reads it.
    diagram.add(blocks.Sum(name="both"), u1="f.y", u2="steps.y")
    diagram.outlets["both_"] = "both.y"
    found = sf.Simulation(diagram).state_space(t=0.3)
    assert found.A[0, 0] == -2.0 and np.array_equal(found.C, [[-2.0], [-2.0]])


def test_modes_and_random_numbers_are_no_states() -> None:
    """Whether a relay is on, and where a generator is, stays as it is; the generator's own factor is no pole."""
    diagram = sf.Diagram("modes")
    diagram.add_inlet("e", "sum.u1", shape=())
    diagram.add(blocks.Noise(name="noise", scale=0.1, period=0.01, seed=3))
    diagram.add(blocks.Sum(name="sum"), u2="noise.y")
    diagram.add(blocks.Integrator(name="x", period=0.01), u="sum.y")
    diagram.add(blocks.Relay(name="relay", lower=-5.0, upper=5.0, period=0.01), u="x.y")
    diagram.add(blocks.Sum(name="out"), u1="relay.y", u2="x.y")
    diagram.outlets["y"] = "out.y"
    found = sf.Simulation(diagram).state_space()
    assert found.states == ("x.x",) and found.A[0, 0] == 1.0 and found.C[0, 0] == 1.0
