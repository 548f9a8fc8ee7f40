"""Blocks of Python's: what runs of one diagram share, and what they must return."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Formula, LivePlot, PythonBlock, Store, UdpReceiver
from symofros.diagrams.block import Block, Environment, Port, Ports
from symofros.diagrams.external_block import ExternalBlock, Running
from tests.blocks.sockets import free_port
from tests.diagrams.parts import Counter, ramp

PERIOD = 0.01


class Inside:
    """A function that runs the diagram it belongs to once more, at a sample of its first run."""

    def __init__(self) -> None:
        self.simulation: sf.Simulation | None = None
        self.inner: sf.DiagramRun | None = None

    def __call__(self, t: float, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        if t > 2.5 * PERIOD and self.simulation is not None:
            again, self.simulation = self.simulation, None
            self.inner = again.run(2 * PERIOD, dt=PERIOD)
        return {"y": 0.0}


def nested(block: Block, **inputs: str) -> tuple[sf.DiagramRun, Inside]:
    """A run, and the other that went on meanwhile."""
    inside = Inside()
    d = sf.Diagram("twice")
    d.add(ramp())
    d.add(block, **inputs)
    d.add(PythonBlock(name="starts", function=inside, outputs={"y": ()}, period=PERIOD))
    inside.simulation = simulation = sf.Simulation(d)
    return simulation.run(6 * PERIOD, dt=PERIOD), inside


def test_nested_runs_keep_their_own_results() -> None:
    run, inside = nested(Store(name="log", signals=("y",), period=PERIOD), y="ramp.y")
    assert inside.inner is not None
    for one, count in ((run, 7), (inside.inner, 3)):
        assert one.outcome.ok, one.outcome
        np.testing.assert_allclose(one.kept["log"]["t"], PERIOD * np.arange(count), rtol=0, atol=1e-12)


def test_a_second_run_does_not_take_the_socket_of_the_first() -> None:
    port = free_port()
    run, _ = nested(UdpReceiver(name="rx", port=port, size=1, period=PERIOD))
    assert run.outcome.kind == "input failed" and "can't listen at" in run.outcome.reason
    # Both have closed what they opened.
    run, _ = nested(UdpReceiver(name="rx", port=port, size=1, period=PERIOD))
    assert "one run of it at a time" in run.outcome.reason


def test_a_page_shows_one_run_at_a_time() -> None:
    live = LivePlot(name="live", signals=("y",), period=PERIOD, open_browser=False)
    try:
        run, _ = nested(live, y="ramp.y")
        assert "block 'live': its page shows another run" in run.outcome.reason
        d = sf.Diagram("after")
        d.add(ramp())
        d.add(live, y="ramp.y")
        assert sf.Simulation(d).run(2 * PERIOD, dt=PERIOD).kept["live"]["sent"] == 3
    finally:
        live.__dict__["_page"].close()


@dataclass(frozen=True, kw_only=True)
class Promising(ExternalBlock):
    """It promises y (2) and returns something else."""

    returned: Any

    def ports(self, environment: Environment) -> Ports:
        return Ports((Port("x", (), "", 0.5),), (Port("y", (2,)),))

    def begin(self, environment: Environment) -> Running:
        return Returning(self.returned)


class Returning(Running):
    def __init__(self, returned: Any) -> None:
        self.returned = returned

    def call(self, t: float, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        return {"y": self.returned} if self.returned is not None else {}


@pytest.mark.parametrize(("returned", "found"), [(1.0, r"\(\)"), ([1.0, 2.0, 3.0], r"\(3,\)"), (None, "nothing")])
def test_outputs_of_wrong_shape_are_refused_compiled_and_interpreted(returned: Any, found: str) -> None:
    d = sf.Diagram("promise")
    d.add(Promising(name="p", returned=returned, period=PERIOD))
    simulation = sf.Simulation(d)
    message = rf"block 'p': output 'y' does not fit\n  found:  {found}"
    with pytest.raises(sf.SymofrosError, match=message):
        simulation.interpret(PERIOD)
    run = simulation.run(PERIOD)
    assert run.outcome.kind == "input failed" and "output 'y' does not fit" in run.outcome.reason


def test_started_blocks_are_stopped_when_another_fails_to_start() -> None:
    heard: list[str] = []

    def fails() -> None:
        raise RuntimeError("no cable")

    d = sf.Diagram("cable")
    for name, begins in (("first", lambda: heard.append("begin")), ("second", fails)):
        d.add(
            PythonBlock(
                name=name,
                function=lambda t, inputs: {"y": 0.0},
                outputs={"y": ()},
                period=PERIOD,
                on_begin=begins,
                on_end=lambda name=name: heard.append(f"end {name}"),
            )
        )
    d.add(Counter(name="ticks", period=PERIOD))
    simulation = sf.Simulation(d)
    for run in (simulation.run, simulation.interpret):
        heard.clear()
        with pytest.raises(RuntimeError, match="no cable"):
            run(PERIOD)
        assert heard == ["begin", "end first"]


def test_a_block_without_feedthrough_closes_no_loop_and_is_called_with_the_inputs_of_the_sample_before() -> None:
    """A filter in Python in a loop through a gain: x_k = x_k-1 / 2 + u_k-1, u = 1 - x / 4; interpreted, too."""

    def filtered(t: float, inputs: Mapping[str, Any]) -> Mapping[str, Any]:
        state["x"] = 0.0 if t == 0.0 else state["x"] / 2 + float(inputs["u"])
        return {"x": state["x"]}

    state = {"x": 0.0}
    d = sf.Diagram("loop")
    ports: dict[str, Any] = {"inputs": {"u": ()}, "outputs": {"x": ()}}
    d.add(PythonBlock(name="filter", function=filtered, period=PERIOD, feedthrough=False, **ports), u="law.y")
    d.add(Formula(name="law", formulas="1 - x/4"), x="filter.x")
    expected = [0.0]
    for _ in range(5):
        expected.append(expected[-1] / 2 + 1.0 - expected[-1] / 4)
    simulation = sf.Simulation(d)
    for run in (simulation.run(5 * PERIOD, dt=PERIOD), simulation.interpret(5 * PERIOD, dt=PERIOD)):
        assert run["filter.x"].tolist() == expected
    d.add(PythonBlock(name="direct", function=filtered, period=PERIOD, **ports), u="loop.y")
    d.add(Formula(name="loop", formulas="1 - x/4"), x="direct.x")
    with pytest.raises(sf.DescriptionError, match="algebraic loop"):
        sf.Simulation(d)
