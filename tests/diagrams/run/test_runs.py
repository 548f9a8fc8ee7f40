"""Compiled runs, interpreted runs and what is known of their results."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from symofros import blocks
from symofros.diagrams.run.simulate import run_compiled
from tests.diagrams.parts import Ball, Counter, Lag, Spoken, arm, moving
from tests.models import sampled

MODELS = Path(__file__).parents[3] / "reference_models"
PENDULUM = sf.load(MODELS / "rigid" / "double_pendulum.yaml")


def agree(diagram: sf.Diagram, t_end: float, names: list[str], scale: float = 1.0, **settings: Any) -> sf.DiagramRun:
    """Both ways of running give the same signals to rounding, grown by the motion's own sensitivity `scale`."""
    simulation = sf.Simulation(diagram)
    run = simulation.run(t_end, record=t_end / 50, **settings)
    assert run.outcome.ok, run.outcome
    assert len(repr(run)) < 300 and f"{len(run.t)} records" in repr(run) and "finished" in repr(run)
    for compiled in (True, False):
        other = simulation.interpret(t_end, record=t_end / 50, compiled=compiled, **settings)
        assert np.array_equal(run.t, other.t)
        for name in names:
            size = max(1.0, float(np.abs(run[name]).max()))
            assert np.abs(run[name] - other[name]).max() < 1e-13 * size * scale, (name, compiled)
    return run


@pytest.mark.parametrize("period", sampled((None, 1e-3, 2.5e-3), (None, 2.5e-3)))
def test_a_controlled_arm_is_the_same_compiled_and_interpreted(period: float | None) -> None:
    agree(arm(PENDULUM, period, q1=0.3), 0.05, ["plant.q", "plant.v", "pd.effort", "plant.a"], 100.0)


def test_a_continuous_controller_moves_as_formulas_of_simulate_do() -> None:
    """The same law as formulas of `simulate`'s, by the same method and steps: another path to the same motion."""
    model = sf.compile(PENDULUM)
    names = model.names
    q1, q2 = names.q
    law = {names.u[0]: f"50*(0.5 - {q1}) - 5*d{q1}", names.u[1]: f"30*(-0.2 - {q2}) - 3*d{q2}"}
    want = sf.simulate(model, [0.3, 0.0], t_end=1.0, u=law, dt=1e-3)
    run = sf.Simulation(arm(PENDULUM, None, **{q1: 0.3})).run(1.0, dt=1e-3, record=1e-3)
    assert np.abs(run["plant.q"] - want.q).max() < 1e-13


@pytest.mark.parametrize(
    "name",
    sampled(
        ("rigid/torque_free_body", "rigid/gyroscope", "closed/slider_crank", "flexible/flexible_pendulum"),
        ("rigid/torque_free_body", "closed/slider_crank"),
    ),
)
def test_mechanisms_of_every_kind_match_plain_simulation(name: str) -> None:
    """Quaternions, loops and beams; the plain simulation is the third witness."""
    system = sf.load(MODELS / f"{name}.yaml")
    model = sf.compile(system)
    q, v = model.neutral(), np.full(model.nv, 0.3)
    if model.nc:
        closed = sf.assemble(model, q, v)
        q, v = closed.q, closed.v
    stated = dict(zip(model.names.q, q, strict=True)) | {f"d{n}": x for n, x in zip(model.names.v, v, strict=True)}
    run = agree(moving(system, stated), 0.05, ["plant.q", "plant.v"], 1000.0)
    want = sf.simulate(model, q, v, t_end=0.05, dt=1e-3)
    assert np.abs(run["plant.q"][-1] - want.q[-1]).max() < 1e-12
    assert np.abs(run["plant.a"][-1] - want.a[-1]).max() < 1e-9 * max(1.0, np.abs(want.a[-1]).max())


def test_a_first_order_lag_converges_to_its_closed_form() -> None:
    """s(t) of a lag driven by a sine; errors of rk4 fall by 16 where the step is halved."""
    diagram = sf.Diagram("lag")
    diagram.add(blocks.Sine(name="wave", frequency=7.0 / (2.0 * np.pi)))
    diagram.add(Lag(name="lag", tau=0.1), x="wave.y")
    simulation = sf.Simulation(diagram)
    w, tau, t = 7.0, 0.1, 1.0
    b = w * tau
    want = (np.sin(w * t) - b * np.cos(w * t) + b * np.exp(-t / tau)) / (1.0 + b * b)
    errors = [abs(simulation.run(t, dt=dt, record=0.5)["lag"][-1] - want) for dt in (0.01, 0.005, 0.0025)]
    assert 15.0 < errors[0] / errors[1] < 18.0
    assert 15.0 < errors[1] / errors[2] < 18.0
    fine = simulation.run(t, method="dop853", rtol=1e-12, atol=1e-14, record=0.5)
    assert abs(fine["lag"][-1] - want) < 1e-12


def test_blocks_sample_at_several_rates() -> None:
    """A counter at 0.1 s and holds at 0.2 s, 0.3 s and 0.2 s with an offset of 0.1 s."""
    diagram = sf.Diagram("rates")
    diagram.add(Counter(name="fast", period=0.1))
    for name, period, offset in (("slow", 0.2, 0.0), ("slower", 0.3, 0.0), ("late", 0.2, 0.1)):
        diagram.add(blocks.Hold(name=name, period=period, offset=offset), u="fast.n")
    diagram.add(blocks.Sine(name="wave", frequency=7.0 / (2.0 * np.pi)))
    diagram.add(Lag(name="lag"), x="wave.y")
    run = agree(diagram, 1.25, ["fast", "slow", "slower", "late", "lag"], 10.0, dt=0.01)
    k = np.floor(run.t / 0.1 + 1e-9)
    assert np.array_equal(run["fast"], k)
    assert np.array_equal(run["slow"], 2 * np.floor(run.t / 0.2 + 1e-9))
    assert np.array_equal(run["slower"], 3 * np.floor(run.t / 0.3 + 1e-9))
    late = np.floor((run.t - 0.1) / 0.2 + 1e-9)
    assert np.array_equal(run["late"], np.where(late < 0, 0, 2 * late + 1))


def test_python_blocks_are_called_at_their_samples() -> None:
    heard: list[float] = []
    diagram = arm(PENDULUM, 1e-3, q1=0.3)
    diagram.add(Spoken(name="spoken", period=0.01, heard=heard), x="pd.effort")
    diagram.add(Spoken(name="again", period=0.01, heard=[]), x="spoken")
    diagram.add(blocks.Hold(name="after", period=0.01), u="again")
    simulation = sf.Simulation(diagram)
    run = simulation.run(0.1, record=0.01)
    assert np.allclose(heard, np.arange(11) * 0.01)
    assert np.array_equal(run["after"], 4.0 * run["pd.effort"])
    other = simulation.interpret(0.1, record=0.01)
    assert np.abs(run["after"] - other["after"]).max() < 1e-10


def test_a_ball_bounces_at_the_predicted_times() -> None:
    """Bounce n is at t1 (1 + 2 e + ... + 2 e^(n-1)), t1 = sqrt(2 h / g)."""
    diagram = sf.Diagram("ball")
    diagram.add(Ball(name="ball"))
    diagram.add(Counter(name="ticks", period=0.1))
    run = sf.Simulation(diagram).run(1.1, method="dopri5", rtol=1e-10, atol=1e-12, record=0.01)
    first = np.sqrt(2.0 / 9.81)
    want = [first, first * 2.0, first * 2.5]
    met = [crossing.t for crossing in run.crossings]
    assert len(met) == 3 or want[-1] > 1.1
    assert np.allclose(met, [t for t in want if t < 1.1], atol=1e-9)
    assert run["ball.bounces"][-1] == len(met)
    assert run["ball.height"].min() > -1e-9


def test_separate_parts_give_the_same_bits_on_any_number_of_threads() -> None:
    diagram = sf.Diagram("two")
    for side in ("left", "right"):
        diagram.add_model(side, PENDULUM, start={"q1": 0.3 if side == "left" else -0.4})
        diagram.add(blocks.ForwardDynamics(name=side, model=side), u=f"pd_{side}.effort")
        other = "right" if side == "left" else "left"
        diagram.add(
            blocks.JointPD(name=f"pd_{side}", kp=[50.0, 30.0], kd=[5.0, 3.0], period=0.002),
            q=f"{side}.q",
            v=f"{side}.v",
            q_desired=f"{other}.q",
        )
    simulation = sf.Simulation(diagram)
    assert len(simulation.resolved.layout.parts) == 2
    alone = simulation.run(0.5, record=0.01)
    together = simulation.run(0.5, record=0.01, threads=2)
    assert np.array_equal(alone.q, together.q) and np.array_equal(alone.v, together.v)
    joined = sf.Diagram("one", dict(diagram.models))
    for block in diagram.blocks.values():
        joined.add(block)
    for (name, port), source in diagram.wires.items():
        joined.connect(source, f"{name}.{port}")
    joined.blocks["pd_left"] = blocks.JointPD(name="pd_left", kp=[50.0, 30.0], kd=[5.0, 3.0])
    assert len(sf.Simulation(joined).resolved.layout.parts) == 1


def test_parameters_change_without_compiling() -> None:
    simulation = sf.Simulation(arm(PENDULUM, 1e-3))
    soft = simulation.run(0.5, record=0.01, parameters={"pd.kp": 5.0})
    stiff = simulation.run(0.5, record=0.01, parameters={"pd.kp": [200.0, 200.0], "goal.value": [0.1, 0.1]})
    again = sf.Simulation(arm(PENDULUM, 1e-3)).run(0.5, record=0.01)
    assert np.abs(soft["plant.q"] - again["plant.q"]).max() > 0.01
    pd = 5.0 * (soft["goal"] - soft["plant.q"]) - np.array([5.0, 3.0]) * soft["plant.v"]
    assert np.abs(soft["pd.effort"] - pd).max() < 1e-12
    assert np.array_equal(stiff["goal"][-1], [0.1, 0.1])
    with pytest.raises(sf.UnknownNameError, match="pd.kq"):
        simulation.run(0.1, parameters={"pd.kq": 1.0})
    with pytest.raises(sf.SymofrosError, match="does not fit"):
        simulation.run(0.1, parameters={"pd.kp": [1.0, 2.0, 3.0]})


def test_friction_of_a_diagram_matches_the_model() -> None:
    system = sf.load(MODELS / "flexible" / "planar_robot.yaml")
    model = sf.compile(system)
    diagram = moving(system, start={"dq1": 0.5, "dq3": -0.2})
    run = sf.Simulation(diagram).run(0.01, record=0.01)
    i, j = model.names.v.index("q1"), model.names.v.index("q3")
    friction = run["plant.friction"][0]
    assert -0.49 <= friction[i] <= -0.42 and 0.08 <= friction[j] <= 0.10
    assert friction[model.names.v.index("e1")] == 0.0


def test_a_model_of_a_diagram_can_be_replaced_by_its_rigid_form() -> None:
    """The same diagram, rigid: by changing the initialisation."""
    system = sf.load(MODELS / "flexible" / "flexible_pendulum.yaml")
    flexible, rigid = sf.Diagram("swap"), sf.Diagram("rigid")
    flexible.add_model("plant", system)
    rigid.add_model("plant", system, functions=0)
    flexible.add(blocks.ForwardDynamics(name="plant", model="plant"))
    swapped = flexible.with_model("plant", rigid.models["plant"])
    bending, stiff = (sf.Simulation(item).resolved.layout for item in (flexible, swapped))
    assert len(bending.v0) > len(stiff.v0) > 0


def loop_from(**stated: float) -> sf.Diagram:
    """A four-bar from a stated start."""
    return moving(sf.load(MODELS / "closed" / "four_bar.yaml"), stated)


@pytest.mark.parametrize("how", ["run", "interpret"])
def test_stated_start_coordinates_of_a_loop_are_kept_or_refused(how: str) -> None:
    """It was projected with all else: q1 = 1 and dq1 = 1 became other numbers without a word."""
    run = getattr(sf.Simulation(loop_from(q1=1.0, dq1=1.0)), how)(0.002, dt=1e-3, record=1e-3)
    assert run["plant.q"][0][0] == pytest.approx(1.0, abs=1e-9) and run["plant.v"][0][0] == pytest.approx(1.0, abs=1e-9)
    assert np.abs(run["plant.q"][0] - [1.0, -1.0, 1.0]).max() < 1e-9 and not run.outcome.notes
    with pytest.raises(sf.AssemblyError, match=r"model 'four_bar'.*\n.*q2 = -0\.5 would be -"):
        getattr(sf.Simulation(loop_from(q1=1.0, q2=-0.5, q3=0.3)), how)(0.002, dt=1e-3)
    run = getattr(sf.Simulation(loop_from(q1=1.2, q2=-1.2004, q3=1.2)), how)(0.002, dt=1e-3)
    assert any("model 'plant': start: q2 = -1.2004 was taken as -1.2001" in note for note in run.outcome.notes)


def test_a_stated_zero_coordinate_is_kept_by_projection_of_the_start() -> None:
    """The bob, 0.8 m and 0.6 m from the pivot, is on a rod of 1.1 m: along the rod both coordinates would change."""
    across = sf.Joint("x", "prismatic", position=(0.8, 0.6, 0.0), axis=(1, 0, 0))
    rail = sf.RigidBody("rail", across, sf.Inertia(1.0))
    bob = sf.RigidBody("bob", sf.Joint("y", "prismatic", "rail", axis=(0, 1, 0)), sf.Inertia(1.0))
    rod = sf.Rod("rod", ("world", None), ("bob", None), 1.1)
    system = sf.System("pendulum", (rail, bob), constraints=(rod,))
    diagram = moving(system, start={"x": 0.0})
    run = sf.Simulation(diagram).run(0.002, dt=1e-3, record=1e-3)
    np.testing.assert_allclose(run["plant.q"][0], [0.0, np.sqrt(1.1**2 - 0.8**2) - 0.6], rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_constraint_that_engages_is_a_plastic_impact() -> None:
    """Open, the loop is the tree; as it closes, the energy lost is that of the speeds lost: a projection by M."""
    system = sf.load(MODELS / "closed" / "four_bar.yaml")
    model, tree = sf.compile(system), sf.compile(replace(system, constraints=()))
    rng = np.random.default_rng(3)
    closed = sf.assemble(model, model.neutral() + np.array([0.9, 0.4, -0.5]), rng.normal(size=3))
    stated = dict(zip(model.names.q, closed.q, strict=True))
    stated |= {f"d{name}": x for name, x in zip(model.names.v, closed.v, strict=True)}
    when = 0.004
    diagram = moving(system, start=stated, engaged="after")
    diagram.add(blocks.Step(name="after", time=when, before=[0.0], after=[1.0], period=0.001))
    run = agree(diagram, 0.05, ["plant.q", "plant.v"], 1e4, dt=1e-3)
    simulation = sf.Simulation(diagram)
    run = simulation.run(0.05, dt=1e-3, record=1e-3)
    free = sf.simulate(tree, closed.q, closed.v, 0.003, dt=1e-3)
    assert np.abs(run["plant.q"][3] - free.q[-1]).max() < 1e-13
    open_gap, closed_gap = (np.abs(model.constraint(run["plant.q"][k])).max() for k in (3, 5))
    assert open_gap > 1e-5 and closed_gap < 1e-11
    q, v = run.motion("plant")
    before = sf.simulate(tree, q[3], v[3], 0.001, dt=1e-3)
    lost = v[4] - before.v[-1]
    M = model.mass_matrix(q[4])
    loss = 0.5 * before.v[-1] @ M @ before.v[-1] - 0.5 * v[4] @ M @ v[4]
    assert loss > 0.0
    assert loss == pytest.approx(0.5 * lost @ M @ lost, rel=1e-3)
    assert np.abs(model.constraint_rate(q[4], v[4])).max() < 1e-12


def test_constraints_engage_at_samples_only() -> None:
    system = sf.load(MODELS / "closed" / "four_bar.yaml")
    diagram = moving(system, engaged="after")
    diagram.add(blocks.Step(name="after", time=0.1, before=[0.0], after=[1.0]))
    with pytest.raises(sf.DescriptionError, match="put a hold with a period"):
        sf.Simulation(diagram)


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
@pytest.mark.parametrize("start", [0.0, -0.3])
def test_a_held_sequence_changes_exactly_at_its_instants(method: str, start: float) -> None:
    """A lag behind held samples: each counts from its instant, not in the last stage of the step that ends there."""
    t, values = start + 0.1 * np.arange(6), np.array([1.0, -2.0, 3.0, -1.0, 4.0, 0.0])
    diagram = sf.Diagram("held")
    diagram.add(blocks.Sequence(name="given", t=t, values=values, kind="hold"))
    diagram.add(Lag(name="lag"), x="given")
    h = 0.1  # The lag's own time: a step of rk4 keeps 3/8 of the state, the motion itself exp(-1).
    kept, steps = (0.375, {"dt": h}) if method == "rk4" else (np.exp(-1.0), {"rtol": 1e-11})
    want = 0.0
    for value in values[:-1]:
        want = kept * want + (1.0 - kept) * value
    simulation = sf.Simulation(diagram)
    run = simulation.run(start + 0.5, t0=start, method=method, record=h, **steps)
    assert run["lag"][-1] == pytest.approx(want, abs=1e-12 if method == "rk4" else 1e-8)
    assert np.array_equal(np.ravel(run["given"]), values)
    for compiled in (True, False) if method == "rk4" else ():
        other = simulation.interpret(start + 0.5, t0=start, method=method, record=h, compiled=compiled, **steps)
        assert other["lag"][-1] == pytest.approx(want, abs=1e-12)
        assert np.array_equal(np.ravel(other["given"]), values)


def test_adaptive_steps_do_not_skip_a_short_push() -> None:
    """By adaptive steps, from rest: a lag behind a tent of a fiftieth of the run."""
    diagram = sf.Diagram("pushed")
    diagram.add(blocks.Sequence(name="given", t=[0.0, 4.7, 4.75, 4.8, 10.0], values=[0.0, 0.0, 5.0, 0.0, 0.0]))
    diagram.add(Lag(name="lag"), x="given")
    fine = sf.Simulation(diagram).run(5.0, dt=1e-3)
    run = sf.Simulation(diagram).run(5.0, method="dopri5")
    assert abs(fine["lag"][-1]).max() > 0.05
    assert np.abs(run["lag"][-1] - fine["lag"][-1]).max() < 1e-5


def test_fixed_steps_end_at_samples_of_a_held_sequence() -> None:
    """A pulse of 1000 N for 1.8 ms on 1 kg, between two ends of steps of 10 ms."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0))
    body = sf.RigidBody("b", joint, sf.Inertia(1.0, moments=(1, 1, 1)), loads=(sf.Load(force=("f", 0, 0)),))
    diagram = moving(sf.System("pushed", (body,), inputs=(sf.Input("f"),), gravity=(0, 0, 0)), u="pulse")
    values = [[0.0], [1000.0], [0.0]]
    diagram.add(blocks.Sequence(name="pulse", kind="hold", t=[0.0, 0.5031, 0.5049], values=values))
    run = sf.Simulation(diagram).run(1.0, method="rk4", dt=0.01, record=0.5)
    assert run["plant.v"][-1, 0] == pytest.approx(1.8, rel=1e-9)


def test_a_loop_moves_beside_what_has_no_constraints() -> None:
    """In one part: a mechanism on conditions, one without and a lag, each driven by another; against SciPy."""
    lengths = {"a": 0.5, "b": 0.3}
    hinges = [
        sf.RigidBody(name, sf.Joint(name, "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (0, 0, -length)))
        for name, length in lengths.items()
    ]
    geared = sf.System("geared", hinges, constraints=(sf.Coupling("gear", sf.formula("b - 2*a")),))
    slide = sf.RigidBody("s", sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True), sf.Inertia(2.0))
    d = sf.Diagram("both")
    d.add_model("loop", geared, start={"a": 0.4, "b": 0.8})
    d.add_model("cart", sf.System("cart", [slide], gravity=(0, 0, 0)), start={"x": 0.1})
    d.add(blocks.ForwardDynamics(name="loop", model="loop"))
    d.add(blocks.ForwardDynamics(name="cart", model="cart"), u="force.y")
    d.add(blocks.Pick(name="angle", entries=[0]), u="loop.q")
    d.add(blocks.Pick(name="place", entries=[0]), u="cart.q")
    d.add(Lag(name="lag", tau=0.2), x="place.y")
    d.add(blocks.Formula(name="force", formulas={"y": ["3*a[0] - 0.5*b"]}), a="angle.y", b="lag.y")
    run = sf.Simulation(d).run(0.5, method="dop853", rtol=1e-10, atol=1e-12, record=0.1)

    def slope(_: float, y: np.ndarray) -> list[float]:
        a, da, x, dx, s = y
        pull = -9.81 * (0.5 * np.sin(a) + 2 * 0.3 * np.sin(2 * a)) / (0.25 + 4 * 0.09)
        return [da, pull, dx, (3 * a - 0.5 * s) / 2.0, (x - s) / 0.2]

    exact = solve_ivp(slope, (0.0, 0.5), [0.4, 0.0, 0.1, 0.0, 0.0], t_eval=run.t, rtol=1e-11, atol=1e-13).y.T
    found = np.column_stack([run["loop.q"][:, 0], run["loop.v"][:, 0], run["cart.q"], run["cart.v"], run["lag.y"]])
    np.testing.assert_allclose(found, exact, atol=1e-8)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda made: pickle.loads(pickle.dumps(made))])
def test_runs_and_simulations_are_copied_and_sent_to_other_processes(copied: Callable[[Any], Any]) -> None:
    """By their diagram, with what was given for inlets, as it was when it was run."""
    diagram = sf.Diagram("sent")
    diagram.add(Lag(name="lag", tau=0.1))
    diagram.add_inlet("goal", "lag.x")
    simulation = sf.Simulation(diagram)
    run = simulation.run(0.2, dt=0.01, record=0.01, inputs={"goal": 2.0})
    again = copied(simulation).run(0.2, dt=0.01, record=0.01, inputs={"goal": 2.0})
    diagram.add(blocks.Constant(name="later", value=1.0))
    sent = copied(run)
    for other in (again, sent):
        np.testing.assert_array_equal(other["lag.y"], run["lag.y"])
        assert "later.y" not in other and str(other.outcome) == str(run.outcome)
    for other in (sent, run_compiled(sent.compiled, 0.2, dt=0.01, record=0.01)):
        np.testing.assert_array_equal(other["goal.value"], np.full(21, 2.0))


def test_a_run_says_which_signals_it_has() -> None:
    """As a mapping does: by a name of an output, of an outlet, of a block with one; other names raise nothing."""
    diagram = sf.Diagram("named")
    diagram.add(Counter(name="ticks", period=0.1))
    diagram.outlets = {"shown": "ticks.n"}
    run = sf.Simulation(diagram).run(0.2, dt=0.1, record=0.1)
    assert all(name in run and run.get(name).tolist() == [0, 1, 2] for name in ("ticks.n", "ticks", "shown"))
    assert [values.tolist() for values in run.values()] == [[0, 1, 2]] and list(dict(run)) == ["ticks.n"]
    for name in ("ticks.m", "later.y", "", 3):
        assert name not in run and run.get(name, "none") == "none"  # type: ignore[arg-type]


def test_inputs_of_a_diagram_without_inlets_are_refused() -> None:
    diagram = sf.Diagram("closed")
    diagram.add(Counter(name="ticks", period=0.1))
    simulation = sf.Simulation(diagram)
    for call in (simulation.run, simulation.interpret):
        with pytest.raises(sf.DescriptionError, match="no inlet 'x'"):
            call(0.2, inputs={"x": 1.0}, dt=0.1)
