"""Test signals against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import Chirp, Pulse, Ramp, Sine, Step
from tests.blocks.support import run
from tests.late import late

signal = late("scipy.signal")

T = 0.01 * np.arange(201)


def test_step_and_ramp_match_their_formulas() -> None:
    found = run(Step(name="s", time=[0.5, 1.0], before=-1.0, after=[2.0, 3.0], unit="N"), t_end=2.0)["y"]
    np.testing.assert_array_equal(found, np.where(T[:, None] >= [0.5, 1.0], [2.0, 3.0], -1.0))
    ramp = run(Ramp(name="r", time=0.5, slope=4.0, start=1.0, duration=1.0), t_end=2.0)
    np.testing.assert_allclose(ramp["y"], 1 + 4 * np.clip(T - 0.5, 0, 1), atol=1e-14)
    np.testing.assert_array_equal(ramp["rate"], 4.0 * ((T >= 0.5) & (T < 1.5)))


def test_pulses_start_at_their_intervals() -> None:
    found = run(Pulse(name="p", time=0.205, every=0.5, width=0.25, high=3.0, low=1.0), t_end=2.0)["y"]
    place = (T - 0.205) % 0.5
    np.testing.assert_array_equal(found, np.where((T >= 0.205) & (place < 0.125), 3.0, 1.0))


@pytest.mark.parametrize("period", [None, 0.01])
def test_flanks_that_fall_on_a_sample_are_seen_by_it(period: float | None) -> None:
    """Whole numbers say which are: of 100 pulses of 0.1 s, some flanks were a sample late by rounding alone."""
    k = np.arange(1001)
    found = run(Pulse(name="p", time=0.05, every=0.1, width=0.3, period=period), t_end=10.0)["y"]
    np.testing.assert_array_equal(found, (k >= 5) & ((k - 5) % 10 < 3))
    found = run(Step(name="s", time=[3 * 0.1, 7 * 0.1], period=period), t_end=1.0)["y"]
    np.testing.assert_array_equal(found, k[:101, None] >= [30, 70])
    found = run(Ramp(name="r", time=3 * 0.1, duration=0.4 + 1e-16, period=period), t_end=1.0)["rate"]
    np.testing.assert_array_equal(found, (k[:101] >= 30) & (k[:101] < 70))


def test_samples_that_begin_late_see_flanks_at_their_instants() -> None:
    times = [round(0.05 + 0.1 * k, 2) for k in range(1, 30)]
    diagram = sf.Diagram("late")
    diagram.add(Step(name="s", time=times, period=0.1))
    found = sf.Simulation(diagram).run(3.0, t0=0.05, dt=0.05, record=0.05)["s.y"]
    np.testing.assert_array_equal(np.argmax(found > 0.5, axis=0), 2 * np.arange(1, 30))


def test_a_sine_outputs_its_derivatives() -> None:
    found = run(Sine(name="s", amplitude=[1.0, 2.0], frequency=1.5, phase=[0.0, 1.0], mean=0.5, unit="rad"), t_end=2.0)
    angle = 3 * np.pi * T[:, None] + [0.0, 1.0]
    np.testing.assert_allclose(found["y"], 0.5 + [1.0, 2.0] * np.sin(angle), atol=1e-13)
    np.testing.assert_allclose(found["rate"], 3 * np.pi * np.array([1.0, 2.0]) * np.cos(angle), atol=1e-12)
    np.testing.assert_allclose(
        found["acceleration"], -((3 * np.pi) ** 2) * np.array([1.0, 2.0]) * np.sin(angle), atol=1e-11
    )


@pytest.mark.parametrize(("sweep", "method"), [("linear", "linear"), ("exponential", "logarithmic")])
def test_chirps_match_scipy(sweep: str, method: str) -> None:
    found = run(Chirp(name="c", amplitude=2.0, first=0.5, last=4.0, duration=1.5, sweep=sweep), t_end=2.0)
    during = T <= 1.5
    expected = 2 * signal.chirp(T, 0.5, 1.5, 4.0, method=method, phi=-90)
    np.testing.assert_allclose(found["y"][during], expected[during], atol=1e-12)
    # Afterwards the frequency stays, and the phase goes on.
    assert found["frequency"][-1] == pytest.approx(4.0)
    # A sine of 4 Hz, sampled each 10 ms: y[k+1] + y[k-1] = 2 cos(w T) y[k].
    y = found["y"][-20:]
    np.testing.assert_allclose(y[2:] + y[:-2], 2 * np.cos(2 * np.pi * 4 * 0.01) * y[1:-1], atol=1e-11)
