"""What is kept of crossings that one call of C meets."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.diagrams.run import loop


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
