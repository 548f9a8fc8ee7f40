"""The loop in C from Python's side: what looks at other states leaves the run where it was."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.stepper import Stepper
from tests.models import GUESSES, compiled


def test_states_that_are_only_looked_at_leave_inputs_and_accelerations_of_the_run() -> None:
    four_bar = compiled("four_bar")
    start = sf.assemble(four_bar, GUESSES["four_bar"], [1.0, 0.0, 0.0])
    settings = Settings.of(four_bar, SimulationOptions("generalized_alpha", dt=0.01), 1.0)
    push = {name: lambda t, q, v: 1.0 + t + q[0] for name in four_bar.names.u}
    inputs = plan_inputs(four_bar, push)
    stepper = Stepper(four_bar, settings.method, inputs, (), four_bar.parameter_values)
    settings.apply(stepper)
    assert stepper.start(start.q, start.v, 4) >= 0

    def held() -> np.ndarray:
        system, memory = stepper.system, stepper.memory
        sizes = ((system.u, four_bar.nu), (system.a, four_bar.nv), (system.lam, four_bar.nc), (system.rank, 1))
        return np.concatenate([memory.view(pointer, size).copy() for pointer, size in sizes])

    before = held()
    rate = np.zeros(four_bar.nq + four_bar.nv)
    with stepper.preserved():
        other = np.concatenate([start.q + 0.1, 2.0 * start.v])
        stepper.place(0.5, other)
        stepper.slope(0.5, other, rate)
        assert not np.array_equal(held(), before)
    np.testing.assert_array_equal(held(), before)


@pytest.mark.parametrize("steps", [40, 700, 10000])
def test_a_run_in_many_pieces_keeps_the_states_of_a_run_in_one_for_its_diagnosis(steps: int) -> None:
    # Each piece ends with a last state; twice as many steps between two states after 128 of them would overflow.
    pendulum = compiled("pendulum")
    kept = []
    for pieces in (1, steps):
        settings = Settings.of(pendulum, SimulationOptions("rk4", dt=2.0**-10), 1.0)
        stepper = Stepper(pendulum, settings.method, plan_inputs(pendulum, None), (), pendulum.parameter_values)
        settings.apply(stepper)
        assert stepper.start(np.array([0.3]), np.zeros(1), steps + 1) >= 0
        for piece in range(1, pieces + 1):
            stepper.run.t_end = steps / pieces * piece * 2.0**-10
            assert stepper.advance(steps) >= 0
        kept.append(stepper.diagnostic_states())
    for one, many in zip(*kept, strict=True):
        np.testing.assert_array_equal(many, one)
    t, *_ = kept[0]
    assert len(t) > min(steps, 100) and np.ptp(np.diff(t)[:-1]) == 0.0 and t[-1] == steps * 2.0**-10


@pytest.mark.parametrize("length", [0.8, 1.25])
def test_quaternion_rates_at_any_length_match_the_rotation(length: float) -> None:
    """Integrators of others let lengths drift: accelerations are those of the unit one, its rate scales (section 7)."""
    top = compiled("heavy_top")
    q, v = top.random_state(np.random.default_rng(2))
    settings = Settings.of(top, SimulationOptions("rk4", dt=0.01), 1.0)
    stepper = Stepper(top, settings.method, plan_inputs(top, None), (), top.parameter_values)
    settings.apply(stepper)
    (quaternion,) = (slice(segment.q, segment.q + segment.size) for segment in top.record.segments)
    rates = []
    for size in (1.0, length):
        y, rate = np.concatenate([q, v]), np.zeros(top.nq + top.nv)
        y[quaternion] *= size
        assert stepper.slope(0.0, y, rate) >= 0
        rate[quaternion] /= size
        rates.append(rate)
    np.testing.assert_allclose(rates[1], rates[0], rtol=1e-13, atol=1e-13)
