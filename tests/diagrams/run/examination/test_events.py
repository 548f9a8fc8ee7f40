"""Runs of diagrams in which events act are examined as those are in which none does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Formula, ForwardDynamics
from symofros.diagrams.run.examination import remarks
from symofros.diagrams.run.examination.examined import Examined, at_equal_times, before_jump
from tests.models import GUESSES, compiled
from tests.simulation.mechanisms import slide
from tests.simulation.oscillator import oscillator_system
from validation.references import MODELS


def acted(
    events: Mapping[str, Any],
    law: str = "0*x[0]",
    system: sf.System | None = None,
    sampled: str = "0*t",
    period: float = 0.1,
    **start: float,
) -> sf.Simulation:
    """A mass of 1 kg under a continuous force and a sampled one, on which events act."""
    diagram = sf.Diagram("acted")
    diagram.add_model("plant", system or oscillator_system(k=1e-6), start=start)
    diagram.add(ForwardDynamics(name="plant", model="plant", events=events), u="all.force")
    diagram.add(Formula(name="sampled", formulas={"force": [sampled]}, period=period))
    force = {"force": [f"{law} + u[0] + 0*v[0]"]}
    diagram.add(Formula(name="all", formulas=force), x="plant.q", v="plant.v", u="sampled.force")
    return sf.Simulation(diagram)


@pytest.mark.parametrize(("before", "after"), [(1e6, 100.0), (100.0, 1e6), (100.0, 400.0)])
def test_modes_are_those_of_the_parameters_at_each_time(before: float, after: float) -> None:
    """Steps of 3 ms amplify a mode of 1000 rad/s, be it before the event or after it."""
    stiffer = {"change": sf.Event("t - 0.0305", action={"k": after})}
    run = acted(stiffer, system=oscillator_system(k=before), period=3e-3, x=1e-4).run(0.06, dt=3e-3, record=3e-3)
    said = ["past the limit of stability" in note and "1000 rad/s" in note for note in run.outcome.notes]
    assert said == [True] * (max(before, after) == 1e6), run.outcome


@pytest.mark.parametrize("t_end", [5.0, 40.0])
def test_long_steps_are_noted_and_short_ones_are_not(t_end: float) -> None:
    """A part that is made once more knows which events are over: what acts once does not act again."""
    events = {
        "kick": sf.Event("x - 0.1", "rising", action={"dx": "1.5*dx"}, once=True),
        "turn": sf.Event("t - 1.234", action={"dx": "-dx"}),
    }
    simulation = acted(events, "-2000*x[0]^3", dx=2.0)
    coarse, fine = (simulation.run(t_end, dt=dt, record=0.05) for dt in (0.05, 1e-3))
    assert len(fine.events["plant"]) == 2 and not fine.outcome.notes, fine.outcome
    (note,) = coarse.outcome.notes
    assert "do not determine the motion of 'plant'" in note


def test_a_run_that_an_event_ends_is_examined() -> None:
    ends = {"ends": sf.Event("t - 4.95", terminal=True, action={"dx": "0"})}
    simulation = acted(ends, "-2000*x[0]^3", dx=2.0)
    coarse, fine = (simulation.run(10.0, dt=dt, record=0.05).outcome for dt in (0.05, 1e-3))
    assert coarse.kind == fine.kind == "event" and not fine.notes, fine
    assert ["do not determine the motion" in note for note in coarse.notes] == [True]


@pytest.fixture
def examined(monkeypatch: pytest.MonkeyPatch) -> Examined:
    """A run with a spring that becomes stiffer, a kick just before a sample, and an event that counts once."""
    runs: list[Examined] = []
    monkeypatch.setattr(remarks, "energy_note", lambda run: runs.append(run) or "")
    events = {
        "stiffer": sf.Event("x", "falling", action={"k": "9*k"}, once=True),
        "kick": sf.Event("t - 1.79", action={"dx": "dx + 1"}),
    }
    oscillator = acted(events, system=oscillator_system(k=1.0), sampled="-0.2*t", x=1.0)
    assert oscillator.run(4.0, dt=1e-3, record=0.05).outcome.ok
    return runs[0]


def test_parts_are_made_once_more_with_what_events_have_set(examined: Examined) -> None:
    """From any record on: what acts once is over, due samples are taken, the spring is that of the time."""
    t = examined.states[0]
    assert examined.acted == pytest.approx([1.4, 1.79], abs=0.1)
    for i in (0, int(np.searchsorted(t, 1.5)), *map(int, examined.sides[1]), int(np.searchsorted(t, 2.5))):
        again = examined.repeat(i, 4.0, 0)
        assert again is not None
        one, other = at_equal_times([x[i:] for x in examined.states], again, 1e-6)
        assert len(one[0]) > 25
        np.testing.assert_allclose(other[1], one[1], atol=1e-9)
        np.testing.assert_allclose(other[2], one[2], atol=1e-9)


def test_energies_and_accelerations_are_those_of_each_time(examined: Examined) -> None:
    t, q, v, u = examined.states
    stiffness = np.where(np.arange(len(t)) > examined.sides[0][0], 9.0, 1.0)
    kinetic, energy = examined.energies.of("plant", examined.states)
    np.testing.assert_allclose(kinetic, 0.5 * v[:, 0] ** 2, rtol=1e-12)
    np.testing.assert_allclose(energy, kinetic + 0.5 * stiffness * q[:, 0] ** 2, rtol=1e-12)
    a = examined.accelerations(np.arange(len(t)))
    force = u[:, 0]  # What is held from sample to sample.
    np.testing.assert_allclose(a[:, 0], force - stiffness * q[:, 0], atol=1e-12)
    np.testing.assert_allclose(examined.energies.powers("plant", examined.states, a), force * v[:, 0], atol=1e-5)


KICKS = {f"kick{i}": sf.Event(f"t - {1.1 + i}", action={"dx": f"{(-1) ** i * 60 + 10}"}) for i in range(6)}


@pytest.mark.parametrize(("dt", "said"), [(1e-2, True), (2e-4, False)])
@pytest.mark.parametrize("record", [0.01, 0.25])
def test_energy_of_events_has_a_cause_and_that_of_steps_has_none(
    dt: float, said: bool, record: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Six kicks change more energy than the contacts that the long steps skip; the energies alone are looked at."""
    monkeypatch.setattr(remarks, "finer_steps_note", lambda _: "")
    run = acted(KICKS, "-9.81 + max(0, -1e5*x[0])", x=1.0).run(8.0, dt=dt, record=record)
    assert ["beside the work done on it" in note for note in run.outcome.notes] == [True] * said, run.outcome


@pytest.mark.parametrize(("load", "creeps"), [(0.5, True), (3.0, False)])
def test_a_joint_creeps_under_the_load_that_an_event_has_set(load: float, creeps: bool) -> None:
    pull, parameters = sf.VirtualPower("pull", {"dx": "load"}), (sf.Parameter("load", 2.0),)
    system = slide(sf.Friction(1.0, minimum_velocity=1e-2), actuated=True, parameters=parameters, virtual_power=(pull,))
    events = {"change": sf.Event("t - 0.2", action={"load": load, "dx": 0})}
    notes = acted(events, system=system).run(0.5, dt=1e-3, record=0.01).outcome.notes
    assert ["so that the joint creeps" in note for note in notes] == [True] * creeps, notes


@pytest.mark.parametrize("record", [0.01, 0.1])
@pytest.mark.parametrize(("t_end", "near"), [(1.1, True), (0.55, False)])
def test_postures_are_examined_between_changes_of_constraints(record: float, t_end: float, near: bool) -> None:
    """A parallelogram is held for 0.5 s; let go at its speed, it passes its singular posture."""
    stated = MODELS["parallelogram"]
    locked = sf.System(
        "held",
        stated.bodies,
        (*stated.parameters, sf.Parameter("shut", 0.0)),
        stated.inputs,
        gravity=stated.gravity,
        constraints=(*stated.constraints, sf.Coupling("lock", "q1")),
        switches=(sf.Switch("lock", "shut", "moment"),),
    )
    events = {
        "hold": sf.Event("t - 0.01", action={"shut": 1}),
        "go": sf.Event("t - 0.5", action={"shut": 0, "dq1": 3, "dq2": 3, "dq3": 3}),
    }
    first = sf.assemble(compiled("parallelogram"), GUESSES["parallelogram"])
    diagram = sf.Diagram("held")
    diagram.add_model("plant", locked, start=dict(zip(compiled("parallelogram").names.q, first.q, strict=True)))
    diagram.add(ForwardDynamics(name="plant", model="plant", events=events))
    run = sf.Simulation(diagram).run(t_end, dt=1e-3, record=record)
    assert run.outcome.ok and len(run.events["plant"]) == 2
    assert ["singular posture" in note for note in run.outcome.notes] == [True] * near, run.outcome


@pytest.mark.parametrize("g", [8.1, 7.7, 9.3])
def test_an_impact_at_the_instant_of_a_record_is_no_change_by_finer_steps(g: float) -> None:
    """By rounding some runs record the speed before it, some that after it."""
    strike = {"strike": sf.Event("x", "falling", action={"dx": "-dx"})}
    run = acted(strike, f"-{g} + 0*x[0]", system=oscillator_system(k=0.0), x=g / 8.0).run(5.0, dt=0.1, record=0.1)
    assert len(run.events["plant"]) == 5 and not run.outcome.notes, run.outcome


def _jumping(t: list[float], v: list[float]) -> list[np.ndarray]:
    return [np.array(t), np.zeros((len(t), 1)), np.array(v)[:, np.newaxis]]


def test_records_beside_a_jump_are_not_compared() -> None:
    """One run strikes just before its record at 1 s, the other just after it."""
    coarse = _jumping([0.0, 1.0 - 1e-9, 1.0 - 1e-9, 1.0, 2.0], [1.0, 1.0, -1.0, -1.0, -1.0])
    fine = _jumping([0.0, 1.0, 1.0 + 1e-9, 1.0 + 1e-9, 2.0], [1.0, 1.0, 1.0, -1.0, -1.0])
    one, other = at_equal_times(coarse, fine, 1e-6)
    assert one[0].tolist() == other[0].tolist() == [0.0, 2.0]
    np.testing.assert_array_equal(one[2], other[2])
    assert at_equal_times(coarse, fine, 1e-12)[0][0].tolist() == [0.0, 1.0, 2.0]


def test_the_state_before_a_jump_is_found() -> None:
    assert before_jump(_jumping([0.0, 0.5, 1.0, 1.0], [1.0, 1.0, 1.0, -1.0])) == 2
    assert before_jump(_jumping([0.0, 0.0, 1.0], [1.0, -1.0, -1.0])) == 2  # It begins with what has jumped.
    assert before_jump(_jumping([0.0, 0.5, 0.5], [1.0, 1.0, 1.0])) == 2  # Nothing does.
