"""What is kept of crossings that one call of C meets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.run import loop

MODELS = Path(__file__).parents[3] / "reference_models"


def test_events_beyond_the_capacity_of_one_call_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Six at a time, so that there is room for more states than for crossings."""
    diagram = sf.Diagram("relays")
    diagram.add(blocks.Sine(name="u", frequency=10.0))
    for i in range(6):
        diagram.add(blocks.Relay(name=f"r{i}", lower=-0.5, upper=0.5), u="u.y")
    diagram.add(blocks.Integrator(name="x"), u="r0.y")
    simulation = sf.Simulation(diagram)
    runs = [simulation.run(1.0, dt=1e-3, record=0.5)]
    monkeypatch.setattr(loop, "_ROWS", 24)
    runs.append(simulation.run(1.0, dt=1e-3, record=0.5))
    assert [len(run.crossings) for run in runs] == [6 * 20, 6 * 20]
    assert runs[0].crossings == runs[1].crossings
    assert np.array_equal(runs[0].t, runs[1].t) and np.array_equal(runs[0]["x.y"], runs[1]["x.y"])


def relays(**fed: str) -> sf.Diagram:
    """Relays with levels at a quarter and three quarters, and what may feed them; nothing moves."""
    diagram = sf.Diagram("relays")
    diagram.add(blocks.Sine(name="wave", frequency=1.0))
    diagram.add(blocks.Constant(name="one", value=1.0))
    diagram.add(blocks.Hold(name="held", period=0.5), u="half.y")
    diagram.add(blocks.Constant(name="half", value=0.5))
    for name, source in fed.items():
        on = name == "kept"
        diagram.add(blocks.Relay(name=name, lower=0.25, upper=0.75, starts_on=on), u=source)
    return diagram


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_relays_switch_where_nothing_moves(method: str) -> None:
    """The instants of a sine are those of its formula; a relay that the first one feeds switches with it."""
    run = sf.Simulation(relays(first="wave.y", second="first.y")).run(2.0, method=method, record=0.125)
    up, down = (np.arcsin(0.75) / (2 * np.pi), 0.5 - np.arcsin(0.25) / (2 * np.pi))
    wanted = [
        (name, which, t + k) for k in (0, 1) for which, t in (("on", up), ("off", down)) for name in ("first", "second")
    ]
    assert [(met.block, met.crossing) for met in run.crossings] == [row[:2] for row in wanted]
    np.testing.assert_allclose([met.t for met in run.crossings], [row[2] for row in wanted], atol=1e-12)
    between = run.t * 8.0 % 1.0 == 0.0  # Both sides of each crossing are recorded, too.
    assert between.sum() == 17 and np.array_equal(run["first.y"][between], run["second.y"][between])


def test_relays_begin_as_their_inputs_are() -> None:
    """Beyond a level they have switched before the start, without a crossing; between levels they stay."""
    run = sf.Simulation(relays(on="one.y", kept="held.y", off="half.y")).run(1.0, dt=0.1, record=0.1)
    assert run.crossings == ()
    assert [run[f"{name}.y"].tolist() for name in ("on", "kept", "off")] == [[x] * 11 for x in (1.0, 1.0, 0.0)]


def test_endless_crossings_end_a_run() -> None:
    """A ring of two relays, one of which turns the other round."""
    diagram = relays(a="turned.y", b="a.y")
    diagram.add(blocks.Formula(name="turned", formulas={"y": "1 - b"}), b="b.y")
    run = sf.Simulation(diagram).run(1.0)
    assert run.outcome.kind == "interrupted" and run.outcome.t == 0.0
    assert all(name in run.outcome.reason for name in ("without end", "a.on", "a.off", "b.on", "b.off"))


def test_a_crossing_is_not_met_by_its_own_change() -> None:
    """The reset takes the signal, which rounding leaves above zero, back through it; either direction counts."""
    diagram = sf.Diagram("saw")
    diagram.add(blocks.Constant(name="one", value=1.0))
    diagram.add(blocks.Integrator(name="x", reset="both"), u="one", reset="left.y")
    diagram.add(blocks.Formula(name="left", formulas={"y": "(x + 1000)^2 - 1000500"}), x="x.y")
    run = sf.Simulation(diagram).run(1.1, dt=0.01, record=0.1)
    assert run.outcome.ok
    np.testing.assert_allclose(
        [met.t for met in run.crossings], (np.sqrt(1000500.0) - 1000.0) * np.arange(1, 5), atol=1e-11
    )


def test_memory_of_the_start_is_not_begun_anew_where_a_part_of_a_run_is_made_once_more() -> None:
    """A machine that has changed its state drives a pendulum, whose steps are examined in windows later on."""
    diagram = sf.Diagram("driven")
    diagram.add_model("arm", sf.load(MODELS / "rigid" / "double_pendulum.yaml"))
    diagram.add(blocks.ForwardDynamics(name="arm", model="arm"), u="efforts.y")
    states = {
        "rest": blocks.MachineState(during={"u": "0-20"}),
        "push": blocks.MachineState(during={"u": "0.1 - v[0]"}),
    }
    diagram.add(
        blocks.StateMachine(
            name="m",
            machine_states=states,
            transitions=(blocks.Transition("rest", "push", "0.0005 - abs(t - 0.001)"),),
            outputs={"u": 0.0},
        ),
        v="arm.v",
    )
    diagram.add(blocks.Join(name="efforts"), u1="m.u", u2="m.u")
    run = sf.Simulation(diagram).run(2.0, dt=1e-3, record=0.02)
    assert run.outcome.ok and run.outcome.notes == (), run.outcome


def test_parts_of_a_run_go_on_from_what_a_crossing_changed() -> None:
    """Both sides of a crossing are recorded; from the first one the force of the machine would stay what it was."""
    diagram = sf.Diagram("modes")
    diagram.add_model("arm", sf.load(MODELS / "rigid" / "double_pendulum.yaml"))
    diagram.add(blocks.ForwardDynamics(name="arm", model="arm"), u="efforts.y")
    states = {
        "push": blocks.MachineState(during={"tau": "20"}),
        "brake": blocks.MachineState(during={"tau": "0 - 8*v[0]"}),
    }
    ways = (blocks.Transition("push", "brake", "q[0] - 0.5"), blocks.Transition("brake", "push", "elapsed - 0.2"))
    machine = blocks.StateMachine(name="m", machine_states=states, transitions=ways, outputs={"tau": 0.0})
    diagram.add(machine, q="arm.q", v="arm.v")
    diagram.add(blocks.Constant(name="none", value=0.0))
    diagram.add(blocks.Join(name="efforts", unit="N m"), u1="m.tau", u2="none.y")
    run = sf.Simulation(diagram).run(1.0, method="dopri5", record=0.01)
    assert run.outcome.ok and len(run.crossings) == 9 and run.outcome.notes == (), run.outcome
