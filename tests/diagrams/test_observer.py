"""A run is looked at while it goes on: what is told is what is recorded, and stops fall on instants."""

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
    """Keeps what it is told, and stops at some times; at the last one it ends the run."""

    signals = ("x.y",)

    def __init__(self, times: list[float], ends: bool = False) -> None:
        self.times, self.ends = list(times), ends
        self.stopped: list[float] = []
        self.told: list[tuple[Array, Array]] = []

    def stop(self) -> float:
        return self.times[0] if self.times else math.inf

    def see(self, t: float, times: Array, values: Mapping[str, Array]) -> None:
        self.told.append((times, values["x.y"]))
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
def test_what_is_told_is_what_is_recorded_and_looking_changes_no_bit(compiled: bool) -> None:
    watch = Stops([0.3, 0.32, 0.9])
    run = both(watch, compiled)
    assert_array_equal(np.concatenate([t for t, _ in watch.told]), run.t)  # type: ignore[attr-defined]
    assert_array_equal(np.concatenate([x for _, x in watch.told]), run["x.y"])
    assert_array_equal(run["x.y"], both(Stops([]), compiled)["x.y"])


@pytest.mark.parametrize("compiled", [True, False])
def test_a_stop_falls_on_the_first_instant_that_is_not_before_it(compiled: bool) -> None:
    watch = Stops([0.3, 0.32, 0.9])
    both(watch, compiled)
    # Instants: multiples of 0.05 and of 0.07 s.
    assert_allclose(watch.stopped, [0.3, 0.35, 0.9], rtol=1e-12)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_run_that_is_ended_at_a_stop_keeps_what_it_has(compiled: bool) -> None:
    watch = Stops([0.5], ends=True)
    run = both(watch, compiled)
    assert_array_equal(np.concatenate([t for t, _ in watch.told]), run.t)  # type: ignore[attr-defined]
    whole = both(Stops([]), compiled)
    n = len(run.t)  # type: ignore[attr-defined]
    assert_allclose(run.t[-1], 0.5, rtol=1e-12)  # type: ignore[attr-defined]
    assert_array_equal(run["x.y"], whole["x.y"][:n])
