"""Signals that are no finite numbers, of runs that go on."""

from __future__ import annotations

import pytest

import symofros as sf
from symofros import blocks


def rooted(period: float | None, *readers: tuple[blocks.Block, str]) -> sf.Simulation:
    """A root that leaves its domain at 0.5 s, and blocks that read it or each other."""
    diagram = sf.Diagram("rooted")
    diagram.add(blocks.Formula(name="root", formulas={"y": "sqrt(0.5 - t)"}, period=period))
    diagram.add(blocks.Ramp(name="ramp", slope=1.0))
    diagram.add(blocks.Integrator(name="area"), u="ramp.y")
    for block, source in readers:
        diagram.add(block, u=source)
    return sf.Simulation(diagram)


@pytest.mark.parametrize("period", [None, 0.1])
@pytest.mark.parametrize("compiled", [True, False])
def test_signals_that_no_state_shows_are_noted(period: float | None, compiled: bool) -> None:
    """Not read at all, or read by a limit or a table, which take what is no number for their lower end."""
    unread, of_finite = rooted(period), rooted(period, (blocks.Gain(name="twice", gain=2.0), "ramp.y"))
    limited = rooted(
        period,
        (blocks.Saturation(name="limit", period=period), "root.y"),
        (blocks.LookupTable(name="table", x=[0, 1], y=[1, 2], period=period), "root.y"),
        (blocks.Integrator(name="sum"), "limit.y"),
        (blocks.Integrator(name="other"), "table.y"),
    )
    said = "block 'root': output 'y' is nan at t = 0.6 s, and the run goes on"
    for simulation in (unread, of_finite, limited):
        run = simulation.run if compiled else simulation.interpret
        outcome = run(1.0, dt=0.05, record=0.1).outcome
        assert outcome.ok and [note for note in outcome.notes if "root" in note] == [said]
        assert not run(0.5, dt=0.05, record=0.1).outcome.notes


@pytest.mark.parametrize("compiled", [True, False])
def test_inlets_that_no_state_shows_are_noted(compiled: bool) -> None:
    diagram = sf.Diagram("fed")
    diagram.add(blocks.Saturation(name="limit"))
    diagram.add_inlet("u", "limit.u", shape=())
    diagram.add(blocks.Integrator(name="sum"), u="limit.y")
    simulation = sf.Simulation(diagram)
    run = simulation.run if compiled else simulation.interpret
    assert not run(1.0, dt=0.1, inputs={"u": "1/(1 + t)"}).outcome.notes
    (note,) = run(1.0, dt=0.1, inputs={"u": "1/t"}).outcome.notes
    assert note == "block 'u': output 'value' is inf at t = 0 s, and the run goes on"


def test_many_records_are_searched_in_portions() -> None:
    """The first that is not finite lies in a later portion of them."""
    (note,) = rooted(None).run(1.0, dt=1e-2, record=1e-4).outcome.notes
    assert note == "block 'root': output 'y' is nan at t = 0.5001 s, and the run goes on"
