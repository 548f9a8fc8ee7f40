"""Buses: what goes in under names comes out by them, with its shape and unit, through what passes a signal on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros import blocks


def bus(selected: list[str], **more: Any) -> sf.Diagram:
    """A bus in a bus, sampled on its way to what selects."""
    diagram = sf.Diagram("bus")
    diagram.add(blocks.Sine(name="q", amplitude=[1.0, 2.0], unit="rad"))
    diagram.add(blocks.Sine(name="height", frequency=2.0, unit="m"))
    diagram.add(blocks.Constant(name="table", value=[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
    diagram.add(blocks.BusCreator(name="arm", signals=["q", "dq", "z"]), q="q.y", dq="q.rate", z="height.y")
    diagram.add(blocks.BusCreator(name="all", signals=["table", "arm", "z"]), table="table", arm="arm", z="height.rate")
    diagram.add(blocks.Hold(name="hold", period=0.01), u="all")
    diagram.add(blocks.BusSelector(name="some", signals=selected, **more), bus="hold")
    return diagram


def test_signals_come_out_by_their_names() -> None:
    diagram = bus(["arm.dq", "z", "table", "arm", "arm.z"])
    diagram.add(blocks.BusSelector(name="inner", signals=["q"]), bus="some.arm")
    simulation = sf.Simulation(diagram)
    run = simulation.run(0.2, dt=0.01, record=0.01)
    other = simulation.interpret(0.2, dt=0.01, record=0.01, compiled=False)
    wanted = {
        "some.arm_dq": ("q.rate", "rad/s"),
        "some.z": ("height.rate", "m/s"),
        "some.table": ("table.y", ""),
        "some.arm_z": ("height.y", "m"),
        "inner.q": ("q.y", "rad"),
    }
    for name, (source, unit) in wanted.items():
        assert np.array_equal(run[name], run[source]) and np.array_equal(run[name], other[name]), name
        assert run.unit(name) == unit, name
    assert run["some.arm"].shape == (21, 5)


def test_units_within_a_bus_are_checked() -> None:
    diagram = bus(["arm.dq"])
    diagram.add(blocks.JointPD(name="pd", kp=1.0, kd=1.0), q="some.arm_dq", v="some.arm_dq", q_desired="q.y")
    with pytest.raises(sf.DescriptionError, match=r"some\.arm_dq -> pd\.q: units"):
        sf.Simulation(diagram)


def test_files_state_buses(tmp_path: Path) -> None:
    diagram = bus(["arm.dq", "z"])
    sf.save_diagram(diagram, tmp_path / "d.yaml")
    assert sf.load_diagram(tmp_path / "d.yaml").blocks["some"] == diagram.blocks["some"].__class__(
        name="some", signals=("arm.dq", "z")
    )


@pytest.mark.parametrize(
    ("signals", "words"),
    [
        (
            ["arm.dqq"],
            ["no signal 'arm.dqq' in the bus", "table, arm, arm.q, arm.dq, arm.z, z", "did you mean 'arm.dq'"],
        ),
        (["dq"], ["no signal 'dq'"]),
        (["arm.q", "arm_q"], ["two signals have one output"]),
        (["z", "z"], ["each once"]),
        (["arm."], ["signal 'arm.'"]),
        ([], ["0 of them"]),
    ],
)
def test_unknown_signals_of_a_bus_are_refused_by_name(signals: list[str], words: list[str]) -> None:
    with pytest.raises(sf.DescriptionError) as caught:
        sf.Simulation(bus(signals))
    for word in words:
        assert word in str(caught.value), str(caught.value)


def test_inputs_that_are_no_bus_are_refused() -> None:
    diagram = bus(["z"])
    diagram.wires["some", "bus"] = "q.y"
    with pytest.raises(sf.DescriptionError, match="its input is no bus"):
        sf.Simulation(diagram)
    for names in (["bus"], ["a b"], [f"s{i}" for i in range(101)]):
        with pytest.raises(sf.DescriptionError, match="block 'b'"):
            blocks.BusCreator(name="b", signals=names)
