"""Linear systems, integrators, derivatives: against SciPy and closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import (
    Constant,
    Derivative,
    Gain,
    Integrator,
    KalmanFilter,
    Notch,
    Pulse,
    Ramp,
    Sequence,
    Sine,
    StateSpace,
    Step,
    TransferFunction,
    TransportDelay,
)
from tests.blocks.support import STEP, run, run_each
from tests.late import late

signal = late("scipy.signal")

A, B, C, D = [[0.0, 1.0], [-4.0, -0.6]], [[0.0, 0.3], [1.0, 0.0]], [[1.0, 0.5]], [[0.2, 0.0]]
# Runge-Kutta's error with steps of 0.01 s at 2 rad/s.
STEPPING = 1e-7


def test_state_space_follows_scipy() -> None:
    t = STEP * np.arange(300)
    u = np.stack([np.sin(t), t], axis=1)
    found = run(StateSpace(name="s", A=A, B=B, C=C, D=D, start=[1.0, -1.0]), {"u": u}, kind="linear")
    _, y, _ = signal.lsim((A, B, C, D), u, t, X0=[1.0, -1.0])
    np.testing.assert_allclose(found["y"][:, 0], y, atol=STEPPING)


def test_sampled_state_space_follows_its_recursion(rng: np.random.Generator) -> None:
    u = rng.normal(size=(40, 2))
    F = 0.3 * np.array(A)
    found = run(StateSpace(name="s", A=F, B=B, C=C, period=STEP), {"u": u})["y"]
    _, y, _ = signal.dlsim((F, B, C, np.zeros((1, 2)), STEP), u)
    np.testing.assert_allclose(found, y, atol=1e-13)


FRACTIONS = (([1.0], [1.0, 0.6, 4.0]), ([2.0, 0.0, 1.0], [2.0, 1.0, 8.0]), ([3.0], [2.0]), ([1.0, 2.0], [1.0, 1.0]))


def test_transfer_functions_and_derivatives_follow_scipy() -> None:
    t = STEP * np.arange(300)
    u, slow = np.sin(3 * t), np.sin(t)
    fed = [(TransferFunction(name=f"f{i}", num=num, den=den), {"u": u}) for i, (num, den) in enumerate(FRACTIONS)]
    *fractions, rate = run_each([*fed, (Derivative(name="d", tau=0.05), {"u": slow})], kind="linear")
    for (num, den), outputs in zip(FRACTIONS, fractions, strict=True):
        y = signal.lsim((num, den), u, t)[1] if len(den) > 1 else u * num[0] / den[0]
        np.testing.assert_allclose(outputs["y"], y, atol=1e-6, err_msg=f"{num} {den}")
    np.testing.assert_allclose(rate["y"], signal.lsim(([1.0, 0.0], [0.05, 1.0]), slow, t)[1], atol=1e-5)


def test_sampled_transfer_functions_and_derivatives_follow_scipys_filter() -> None:
    u = np.sin(3 * STEP * np.arange(300))
    stable = [(num, [8.0 * den[0], *den[1:]]) for num, den in FRACTIONS]
    blocks = [TransferFunction(name=f"f{i}", num=num, den=den, period=STEP) for i, (num, den) in enumerate(stable)]
    a = math.exp(-STEP / 0.05)
    filters = [([0.0] * (len(den) - len(num)) + num, den) for num, den in stable]
    filters += [([(1 - a) / STEP, (a - 1) / STEP], [1, -a]), ([1 / STEP, -1 / STEP], [1.0])]
    rates = [Derivative(name=f"d{i}", tau=tau, period=STEP) for i, tau in enumerate((0.05, 0.0))]
    fed = [(block, {"u": u}) for block in (*blocks, *rates)]
    for (block, _), (num, den), outputs in zip(fed, filters, run_each(fed), strict=True):
        close = 1e-11 if block in rates else 1e-12
        np.testing.assert_allclose(outputs["y"], signal.lfilter(num, den, u), atol=close, err_msg=f"{num} {den}")


def test_an_integrator_stops_at_its_limits_and_leaves_them_immediately() -> None:
    diagram = sf.Diagram("limits")
    diagram.add(Sine(name="u", frequency=1.0, amplitude=2 * math.pi))
    diagram.add(Integrator(name="x", high=1.0, low=-0.5), u="u.y")
    simulation = sf.Simulation(diagram)
    found = simulation.run(2.0, dt=1e-3, record=1e-3)
    y = found["x.y"]
    # 1 - cos reaches 1 at 1/4 s, stays until the sine turns at 1/2 s, and falls from there.
    t = found.t
    assert y[(t > 0.26) & (t < 0.5)] == pytest.approx(1.0, abs=1e-12)
    assert y[np.argmin(abs(t - 0.6))] == pytest.approx(1.0 - (1 + math.cos(2 * math.pi * 0.6)), abs=1e-9)
    assert y.min() == -0.5
    other = simulation.interpret(2.0, dt=1e-3, record=1e-3)["x.y"]
    np.testing.assert_allclose(other, y, atol=1e-12)


@pytest.mark.parametrize("method", ["euler", "rk4", "dopri5"])
def test_limits_are_located_entry_by_entry(method: str) -> None:
    """Of rates 1, 2 and -1 up to 1 s, turned round after: no step passes a limit by, however long it is."""
    diagram = sf.Diagram("limits")
    rates = np.array([1.0, 2.0, -1.0])
    diagram.add(Step(name="u", time=1.0, before=rates, after=-rates))
    diagram.add(Integrator(name="x", high=0.73, low=-0.37), u="u.y")
    simulation = sf.Simulation(diagram)
    run = simulation.run(1.5, dt=0.25, method=method, record=0.25)
    assert run["x.y"][-1] == pytest.approx([0.23, -0.27, 0.13], abs=1e-9)
    assert [one.t for one in run.crossings] == pytest.approx([0.365, 0.37, 0.73, 1.0, 1.0, 1.0], abs=1e-9)
    if method != "dopri5":
        other = simulation.interpret(1.5, dt=0.25, method=method)
        assert other["x.y"][-1] == pytest.approx([0.23, -0.27, 0.13], abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_limits_hold_whatever_the_rates(seed: int) -> None:
    """Rates that are held: up, down, none, to and fro; starts at a limit too. y is each step's line, clipped."""
    rng = np.random.default_rng(seed)
    rates = rng.choice([-2.0, -0.3, -1e-11, 0.0, 0.0, 1e-11, 0.3, 2.0], (30, 2))
    start = rng.choice([-0.05, 0.0, 0.1], 2)
    diagram = sf.Diagram("limits")
    diagram.add(Sequence(name="u", t=0.1 * np.arange(30), values=rates, kind="hold"))
    diagram.add(Integrator(name="x", start=start, high=0.1, low=-0.05), u="u.y")
    known = [start]
    for rate in rates:
        known.append(np.clip(known[-1] + 0.1 * rate, -0.05, 0.1))
    simulation = sf.Simulation(diagram)
    for found in (simulation.run(3.0, dt=0.1, record=0.1), simulation.interpret(3.0, dt=0.1, record=0.1)):
        at = np.searchsorted(found.t, 0.1 * np.arange(31) - 1e-9)
        assert found["x.y"][at] == pytest.approx(np.array(known), abs=3e-10)


@pytest.mark.parametrize("dt", [0.01, 0.053, 0.1])
def test_a_limit_is_left_once_where_the_input_ceases_to_push_within_a_step(dt: float) -> None:
    """The input is a state: a step over its zero errs by more than how far from a limit the integral has left it."""
    diagram = sf.Diagram("limits")
    diagram.add(Sine(name="s", frequency=1.0))
    diagram.add(Integrator(name="a", start=-1.0 / (2.0 * math.pi)), u="s.y")
    diagram.add(Integrator(name="u", start=-0.02), u="a.y")
    diagram.add(Integrator(name="x", low=-1e-3, high=1e-3), u="u.y")
    simulation = sf.Simulation(diagram)
    run = simulation.run(3.0, dt=dt, method="rk4", record=1.0)
    assert len(run.crossings) == 7 and run.cost.steps < 3.0 / dt + 20 and not run.outcome.notes
    assert simulation.interpret(3.0, dt=dt)["x.y"][-1] == pytest.approx(run["x.y"][-1], abs=1e-9)


def test_a_reset_is_located_in_time() -> None:
    diagram = sf.Diagram("reset")
    diagram.add(Ramp(name="when", slope=1.0, start=-0.4321))
    diagram.add(Constant(name="one", value=[1.0, 2.0]))
    diagram.add(Integrator(name="x", start=0.5, reset="rising"), u="one.y", reset="when.y")
    found = sf.Simulation(diagram).run(1.0, dt=0.1)
    assert found.crossings[0].t == pytest.approx(0.4321, abs=1e-9)
    assert found["x.y"][-1] == pytest.approx([0.5 + 0.5679, 0.5 + 2 * 0.5679], abs=1e-9)


@pytest.mark.parametrize(("reset", "resets"), [("rising", [0.3]), ("falling", [0.7]), ("both", [0.3, 0.7])])
@pytest.mark.parametrize("period", [None, 0.1])
def test_a_logical_signal_resets(reset: str, resets: list[float], period: float | None) -> None:
    """From 0 to 1 is rising, back is falling, of a source of time and of a sampled one."""
    diagram = sf.Diagram("reset")
    diagram.add(Pulse(name="when", time=0.3, width=0.4, every=1.0, period=period))
    diagram.add(Constant(name="one", value=1.0))
    diagram.add(Integrator(name="x", reset=reset), u="one.y", reset="when.y")
    simulation = sf.Simulation(diagram)
    for found in (simulation.run(1.0, dt=0.05), simulation.interpret(1.0, dt=0.05)):
        assert [one.t for one in found.crossings] == pytest.approx(resets, abs=1e-9)
        assert found["x.y"][-1] == pytest.approx(1.0 - resets[-1], abs=1e-9)


@pytest.mark.parametrize(("start", "end"), [(0.5, 0.65), (0.8, 0.8)])
def test_a_reset_leads_away_from_a_limit_or_to_it(start: float, end: float) -> None:
    diagram = sf.Diagram("reset")
    diagram.add(Ramp(name="when", slope=1.0, start=-0.6))
    diagram.add(Step(name="u", time=0.2, before=-1.0, after=1.0))
    diagram.add(Integrator(name="x", start=start, high=0.8, reset="rising"), u="u.y", reset="when.y")
    simulation = sf.Simulation(diagram)
    for found in (simulation.run(0.75, dt=0.1), simulation.interpret(0.75, dt=0.1)):
        assert found["x.y"][-1] == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize(
    ("reset", "expected"), [("rising", [0, 1, 0, 1, 2]), ("falling", [0, 1, 2, 3, 0]), ("both", [0, 1, 0, 1, 0])]
)
def test_a_sampled_integrator_resets_at_samples(reset: str, expected: list[int]) -> None:
    for start in (0.0, 7.0):
        integrator = Integrator(name="x", start=start, reset=reset, period=STEP)
        found = run(integrator, {"u": np.full(5, 100.0), "reset": [-1, -1, 1, 1, -1]})["y"]
        assert found == pytest.approx(np.add(expected, start), abs=1e-12)
        # A logical signal, 0 or 1, counts as one of -1 and 1 does; from below zero to it is no change to above zero.
        for signal, of in (([0, 0, 1, 1, 0], expected), ([-1, 0, 0, 0, -1], [0, 1, 2, 3, 4])):
            found = run(integrator, {"u": np.full(5, 100.0), "reset": signal})["y"]
            assert found == pytest.approx(np.add(of, start), abs=1e-12)
    limited = run(Integrator(name="x", high=1.5, period=STEP), {"u": [100.0] * 3 + [-100.0] * 2})["y"]
    assert limited == pytest.approx([0, 1, 1.5, 1.5, 0.5])


def test_a_notch_takes_its_frequency_out_and_leaves_the_rest() -> None:
    """Gains of the steady state: depth at the frequency, that of the formula beside it, one far off; sampled alike."""
    t, h = np.arange(4001) * 1e-3, 1e-3
    for frequency, depth in ((5.0, 0.0), (5.0, 0.25), (2.0, 0.0)):
        u = np.sin(2.0 * np.pi * frequency * t)
        s = 1j * 2.0 * np.pi * frequency
        w = 2.0 * np.pi * 5.0
        gain = abs((s * s + 2 * depth * 0.4 * w * s + w * w) / (s * s + 2 * 0.4 * w * s + w * w))
        smooth, sampled = run_each(
            [
                (Notch(name="c", frequency=5.0, damping=0.4, depth=depth), {"u": u}),
                (Notch(name="d", frequency=5.0, damping=0.4, depth=depth, period=h), {"u": u}),
            ],
            dt=h,
            kind="linear",
            compare=0.0,
        )
        last = slice(-1000, None)
        assert np.abs(sampled["y"][last]).max() == pytest.approx(gain, abs=2e-3)
        assert np.abs(smooth["y"][last]).max() == pytest.approx(gain, abs=2e-3)


def _settled(A: np.ndarray, C: np.ndarray, Q: np.ndarray, R: np.ndarray) -> np.ndarray:
    """The gain of the filter by its recursion from a large first covariance."""
    P = 10.0 * np.eye(len(A))
    for _ in range(2000):
        L = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
        P = A @ (P - L @ C @ P) @ A.T + Q
    return P @ C.T @ np.linalg.inv(C @ P @ C.T + R)


def test_a_sampled_kalman_filter_is_the_recursion_that_has_settled() -> None:
    rng = np.random.default_rng(4)
    A, B, C = np.array([[1.0, 0.01], [-0.05, 0.98]]), np.array([[0.0], [0.01]]), np.array([[1.0, 0.0]])
    Q, R = np.array([[1e-6, 0.0], [0.0, 1e-3]]), np.array([[1e-2]])
    u, y = rng.standard_normal((60, 1)), rng.standard_normal((60, 1))
    block = KalmanFilter(name="k", A=A, B=B, C=C, Q=Q, R=R, start=[0.5, -1.0], period=0.01)
    found = run_each([(block, {"u": u, "y": y})], dt=0.01)[0]["x"]
    L, x, expected = _settled(A, C, Q, R), np.array([0.5, -1.0]), []
    for k in range(len(u)):
        x = x + L @ (y[k] - C @ x)
        expected.append(x)
        x = A @ x + B @ u[k]
    np.testing.assert_allclose(found[: len(u)], expected, rtol=1e-9, atol=1e-12)


def test_a_continuous_kalman_filter_finds_a_state_and_weighs_noise() -> None:
    """Of x' = w, y = x + e the gain is sqrt(Q/R); without noise an estimate comes to the state that it does not see."""
    assert KalmanFilter(name="k", A=[[0.0]], B=[[0.0]], C=[[1.0]], Q=4.0, R=0.25)._gain()[0, 0] == pytest.approx(4.0)
    A, C = [[0.0, 1.0], [-9.0, 0.0]], [[1.0, 0.0]]
    diagram = sf.Diagram("seen")
    diagram.add(Constant(name="none", value=[0.0]))
    diagram.add(StateSpace(name="plant", A=A, B=[[0.0], [0.0]], C=C, start=[1.0, 0.0]), u="none.y")
    diagram.add(KalmanFilter(name="k", A=A, B=[[0.0], [0.0]], C=C, Q=[0.0, 1e5], R=0.1), u="none.y", y="plant.y")
    found = sf.Simulation(diagram).run(4.0, dt=1e-3)
    np.testing.assert_allclose(found["k.x"][-1], [np.cos(12.0), -3.0 * np.sin(12.0)], atol=1e-6)


def test_a_transport_delay_is_late_by_its_time() -> None:
    """By whole samples exactly, between them by straight lines; it breaks a loop where it is a period or more."""
    u = np.random.default_rng(5).standard_normal((30, 2))
    before = np.vstack([np.full((4, 2), 0.5), u])
    cases = {0.02: 2.0, 0.025: 2.5, 0.004: 0.4, 0.01: 1.0}
    fed: list[Any] = [
        (TransportDelay(name=f"d{i}", delay=delay, start=0.5, period=0.01), {"u": u}) for i, delay in enumerate(cases)
    ]
    for found, samples in zip(run_each(fed, dt=0.01), cases.values(), strict=True):
        whole, share = int(samples), samples - int(samples)
        rows = np.arange(len(u)) + 4 - whole
        np.testing.assert_allclose(
            found["y"][: len(u)], (1 - share) * before[rows] + share * before[rows - 1], atol=1e-13
        )
    ring = sf.Diagram("ring")
    ring.add(TransportDelay(name="d", delay=0.03, start=[1.0], period=0.01), u="half.y")
    ring.add(Gain(name="half", gain=0.5), u="d.y")
    found = sf.Simulation(ring).run(0.07, dt=0.01, record=0.01)["d.y"]
    assert found[:, 0].tolist() == [1, 1, 1, 0.5, 0.5, 0.5, 0.25, 0.25]
