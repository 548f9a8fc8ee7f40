"""A run is observed while it goes on: observers get what is recorded, and stops fall on instants."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import symofros as sf
from symofros.blocks import Gain, Integrator, Sine
from symofros.runtime.calls.kernel import Array


def lag() -> sf.Diagram:
    """The integral of a sine, doubled at samples every 0.07 s."""
    diagram = sf.Diagram("lag")
    diagram.add(Sine(name="u", frequency=0.5))
    diagram.add(Integrator(name="x"), u="u.y")
    diagram.add(Gain(name="held", gain=2.0, period=0.07), u="x.y")
    return diagram


class Stops:
    """Keeps what it gets, and stops at some times; at the last one it ends the run."""

    signals = ("x.y",)

    def __init__(self, times: list[float], ends: bool = False) -> None:
        self.times, self.ends = list(times), ends
        self.stopped: list[float] = []
        self.reported: list[tuple[Array, Array]] = []

    def stop(self) -> float:
        return self.times[0] if self.times else math.inf

    def see(self, t: float, times: Array, values: Mapping[str, Array]) -> None:
        self.reported.append((times, values["x.y"]))
        if self.times and t >= self.times[0] - 1e-9:
            self.stopped.append(t)
            del self.times[0]
            if self.ends and not self.times:
                raise KeyboardInterrupt


def both(watch: Stops, compiled: bool) -> Mapping[str, Array]:
    simulation = sf.Simulation(lag())
    if compiled:
        return simulation.run(1.0, dt=1e-2, record=0.05, observer=watch)
    return simulation.interpret(1.0, dt=1e-2, record=0.05, compiled=False, observer=watch)  # type: ignore[return-value]


@pytest.mark.parametrize("compiled", [True, False])
def test_observers_see_the_recorded_values_and_change_no_bit(compiled: bool) -> None:
    watch, ending = Stops([0.3, 0.32, 0.9]), Stops([0.5], ends=True)
    run, ended, alone = both(watch, compiled), both(ending, compiled), both(Stops([]), compiled)
    assert_array_equal(run["x.y"], alone["x.y"])
    # Stops fall on the first instant that is not before them: multiples of 0.05 and of 0.07 s.
    assert_allclose(watch.stopped, [0.3, 0.35, 0.9], rtol=1e-12)
    # A run that is ended at a stop keeps what it has.
    assert_allclose(ended.t[-1], 0.5, rtol=1e-12)  # type: ignore[attr-defined]
    assert_array_equal(ended["x.y"], alone["x.y"][: len(ended["x.y"])])
    for reported, record in ((watch.reported, run), (ending.reported, ended)):
        assert_array_equal(np.concatenate([t for t, _ in reported]), record.t)  # type: ignore[attr-defined]
        assert_array_equal(np.concatenate([x for _, x in reported]), record["x.y"])
