"""Runs of diagrams say how far they bend their beams (docs/theory/beams.md, section 6)."""

from __future__ import annotations

import math

import pytest

import symofros as sf
from symofros import blocks


def simulation(g: float) -> sf.Simulation:
    """Two cantilevers under their weight."""
    beam = sf.Beam("blade", sf.Joint("root", "fixed"), "L", 1.0, EI_z=1.0, bend_y=2)
    system = sf.System("cantilever", (beam,), gravity=(0, -g, 0), parameters=(sf.Parameter("L", 1.0),))
    diagram = sf.Diagram("bench")
    diagram.add_model("plant", system)
    diagram.add(blocks.ForwardDynamics(name="first", model="plant"))
    diagram.add(blocks.ForwardDynamics(name="second", model="plant"))
    return sf.Simulation(diagram)


def test_a_diagram_ends_where_a_beam_bends_beyond_its_theory() -> None:
    limp = simulation(60.0)
    outcome = limp.run(1.0).outcome
    assert outcome.kind == "beyond theory" and not outcome.ok
    assert "'first.blade' bends by" in outcome.reason and outcome.t == pytest.approx(0.14, abs=0.01)
    assert limp.run(0.2, beam_limit=math.inf).outcome.kind == "finished"


def test_a_diagram_notes_the_largest_bending_at_its_parameters() -> None:
    stiff = simulation(0.5)
    first, second = (note for note in stiff.run(2.0).outcome.notes if "second-order theory" in note)
    assert "'first.blade'" in first and "'second.blade'" in second and "x = 0.875 m" in first
    assert not stiff.run(1.0, parameters={"plant.L": 0.5}).outcome.notes


def test_interpreted_runs_give_the_same_notes_on_beams() -> None:
    stiff, limp = simulation(0.5), simulation(60.0)
    compiled, run = stiff.run(1.0, dt=0.01, record=0.1), stiff.interpret(1.0, dt=0.01, record=0.1)
    notes = [note for note in compiled.outcome.notes if "second-order theory" in note]
    assert len([note for note in run.outcome.notes if "second-order theory" in note]) == len(notes) == 2
    # Interpreted runs evaluate every step; compiled ones leave out what the slack of (26d) allows.
    errors = [bending.error for bending in compiled.bendings]
    assert [bending.error for bending in run.bendings] == pytest.approx(errors, rel=0.1)  # The slack of a run, (26d).
    assert [bending.beam for bending in run.bendings] == ["first.blade", "second.blade"]
    outcome = limp.interpret(1.0, dt=0.01).outcome
    assert outcome.kind == "beyond theory" and "'first.blade' bends by" in outcome.reason
    assert outcome.t == pytest.approx(limp.run(1.0, dt=0.01, record=0.01).outcome.t, abs=0.01)
    assert limp.interpret(0.2, dt=0.01, beam_limit=math.inf).outcome.kind == "finished"
