"""What acts for a short time only, within a step or between two: pulses of any place, length and shape."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.simulation.inputs import _straight_until
from tests.models import compiled
from tests.simulation.mechanisms import slide

END = 10.0
RTOL, ATOL = 1e-6, 1e-9
# Times the bound of a step's error that a run of some hundred steps may be off by; BDF's leave most.
ADDED_UP = 200.0
OWN = ["dopri5", "dop853", "rodas4"]
SUNDIALS = ["cvode", "cvode_adams", "ida"]


@pytest.fixture(scope="module")
def cart() -> sf.Model:
    """One kilogram on a line: its speed is the impulse."""
    return sf.compile(slide(actuated=True))


def held(F: float, t: float, w: float) -> tuple[sf.Signal, float]:
    return sf.Signal([0.0, t, t + w], [0.0, F, 0.0], "hold"), F * w


def lines(F: float, t: float, w: float) -> tuple[sf.Signal, float]:
    return sf.Signal([0.0, t, t + w / 2, t + w, END], [0.0, 0.0, F, 0.0, 0.0]), F * w / 2


def sampled(F: float, t: float, w: float) -> tuple[sf.Signal, float]:
    """A signal sampled at 100 Hz, mostly quiet."""
    times = np.linspace(0.0, END, 1001)
    values = np.where((times > t) & (times < t + w), F * np.sin((times - t) / w * np.pi), 0.0)
    return sf.Signal(times, values), float(np.trapezoid(values, times))


def push_and_pull(F: float, t: float, w: float) -> tuple[sf.Signal, float]:
    """No impulse, but a way."""
    corners = [0.0, t, t + w / 6, t + w / 3, t + 2 * w / 3, t + 5 * w / 6, t + w]
    return sf.Signal(corners, [0.0, 0.0, F, 0.0, 0.0, -F, 0.0]), 0.0


# Formulas of a force; their impulses over F w; how much of the way to the nearer end the width may be at most.
FORMULAS = {
    "tent": ("{F}*max(0, 1 - abs(t - {t})/{w})", 1.0, 1.0),
    "parabola": ("{F}*max(0, 1 - (t - {t})^2/{w}^2)", 4 / 3, 1.0),
    "rectangle": ("{F}*(sign(t - {t}) - sign(t - {t} - {w}))/2", 1.0, 1.0),
    "bell": ("{F}*exp(-((t - {t})/{w})^2)", float(np.sqrt(np.pi)), 1 / 8),
    "hump": ("{F}*(1 - tanh((t - {t})/{w})^2)", 2.0, 1 / 16),
}


def by_formula(name: str, F: float, t: float, w: float) -> tuple[str, float]:
    text, share, part = FORMULAS[name]
    w = min(w, part * t, part * (END - t))
    return text.format(F=F, t=t, w=w), F * w * share


Shape = Callable[[float, float, float], tuple[object, float]]
SIGNALS: dict[str, Shape] = {shape.__name__: shape for shape in (held, lines, sampled, push_and_pull)}
SHAPES: dict[str, Shape] = SIGNALS | {name: partial(by_formula, name) for name in FORMULAS}


def pulses(shape: str, count: int) -> list[tuple[object, float, float, float]]:
    """Inputs, their impulses, first speeds, lengths of time; seeded by the shape."""
    rng, drawn = np.random.default_rng(list(SHAPES).index(shape)), []
    for _ in range(count):
        w, t = 10 ** rng.uniform(-4, 0), rng.uniform(1.1, 8.5)
        F = rng.choice([1.0, -1.0]) * 10 ** rng.uniform(-1, 2)
        drawn.append((*SHAPES[shape](F, t, w), rng.choice([0.0, 1.0]), w))
    return drawn


@pytest.mark.parametrize("method", [*OWN, *SUNDIALS, "batch"])
@pytest.mark.parametrize("shape", SHAPES)
def test_a_pulse_gives_its_impulse(cart: sf.Model, shape: str, method: str) -> None:
    if method in SUNDIALS:
        pytest.importorskip("sksundae")
    for u, impulse, v0, w in pulses(shape, 2):
        if method == "batch":
            run = sf.simulate_batch(cart, [[0.0], [0.1]], [v0], END, method="dopri5", u={"x": u})
            end = run.v.ravel()[0]
        else:
            end = sf.simulate(cart, None, [v0], END, method=method, u={"x": u}).v[-1, 0]
        fastest = abs(impulse) or 10.0  # A push and its pull.
        bound = ADDED_UP * (ATOL + RTOL * max(abs(v0), fastest))
        assert abs(end - v0 - impulse) < bound, (u, impulse, v0, w, end)


@pytest.mark.parametrize("method", [*OWN, *SUNDIALS])
def test_a_push_and_a_pull_leave_the_right_displacement(cart: sf.Model, method: str) -> None:
    """Their impulses cancel; the moment about the end of the step does not."""
    if method in SUNDIALS:
        pytest.importorskip("sksundae")
    u, _ = push_and_pull(60.0, 5.0, 0.6)
    run = sf.simulate(cart, t_end=END, method=method, u={"x": u})
    impulse, apart = 60.0 * 0.1, 0.4
    assert run.q[-1, 0] == pytest.approx(impulse * apart, rel=1e-3)


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize(("share", "begin"), [(0.05, 6.1), (0.3, 2.3)])
def test_short_forces_of_state_or_python_functions_are_not_stepped_over(
    cart: sf.Model, method: str, share: float, begin: float
) -> None:
    """A force on part of the way, and one by a function of the caller's: of one twentieth of the run, or more."""
    w = share * END
    law = f"2*max(0, 1 - abs(x - {begin + w / 2})/{w / 2})"
    want = sf.simulate(cart, None, [1.0], END, method="rk4", dt=1e-3, u={"x": law})
    run = sf.simulate(cart, None, [1.0], END, method=method, u={"x": law})
    np.testing.assert_allclose(run.v[-1], want.v[-1], rtol=2e-4)
    batch = sf.simulate_batch(cart, [[0.0], [0.0]], [1.0], END, method=method, u={"x": law})
    np.testing.assert_allclose(batch.v[0].ravel(), want.v[-1], rtol=2e-4)

    def push(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        return [2.0 * max(0.0, 1.0 - abs(t - begin - w / 2) / (w / 2))]

    run = sf.simulate(cart, t_end=END, method=method, u=push)
    assert run.v[-1, 0] == pytest.approx(w, rel=1e-3)


@pytest.mark.parametrize("method", OWN)
@pytest.mark.parametrize("name", ["cart_pole", "gyroscope"])
def test_smooth_inputs_cost_no_extra_steps(name: str, method: str) -> None:
    """Neither corners that no step can tell from a curve, nor looks within steps, nor kinks of formulas."""
    model = compiled(name)
    q, v = model.random_state(np.random.default_rng(3))
    t = np.linspace(0.0, 2.0, 20001)
    x = model.names.u[0]

    def steps(u: object) -> int:
        return int(sf.simulate(model, q, v, 2.0, u={x: u}, method=method).statistics.steps)

    smooth = steps("sin(3*t)")
    assert steps(sf.Signal(t, np.sin(3 * t))) <= 1.1 * smooth + 2
    assert steps(sf.Signal(t, np.zeros(len(t)))) <= steps(0.0)


def test_a_formula_that_jumps_counts_from_its_instant_on(cart: sf.Model) -> None:
    """Also at the start and at a step's end, where the formula itself says half."""
    run = sf.simulate(cart, t_end=1.0, method="dopri5", u={"x": "sign(t - 0.25)*sign(t)"})
    assert run.v[-1, 0] == pytest.approx(0.5, abs=1e-12)
    assert run.statistics.rejected == 0


@pytest.mark.parametrize("pull", ["max(0, 1 - abs(t - 5)/0.01)", "exp(-((t - 5)/0.01)^2)"])
def test_a_model_s_own_formula_of_time_is_not_stepped_over(pull: str) -> None:
    model = sf.compile(slide(virtual_power=(sf.VirtualPower("pull", {"dx": f"100*({pull})"}),)))
    want = 1.0 if "max" in pull else float(np.sqrt(np.pi))
    for method in OWN:
        run = sf.simulate(model, t_end=END, method=method)
        assert run.v[-1, 0] == pytest.approx(want, rel=1e-4)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.02, 0.1, 1.0]))
def test_lines_count_as_straight_until_they_leave_their_chord(seed: int, noise: float) -> None:
    """By a tenth of what they change by: up to the returned corner they do not, up to the next one they do."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.1, 1.0, 12))
    values = rng.normal() * times + noise * rng.normal(size=12)
    t, end = np.sort(rng.uniform(times[0], times[-1], 2))

    def departure(until: float) -> float:
        inner = times[(times > t) & (times < until)]
        ends, lines = np.interp([t, until], times, values), np.interp(inner, times, values)
        if not len(inner):
            return 0.0
        return float(np.abs(lines - np.interp(inner, [t, until], ends)).max() / np.ptp([*ends, *lines]))

    until = _straight_until(times, values, t, end)
    assert departure(until) <= 0.1 + 1e-12
    if until < end:
        assert departure(min(end, float(times[np.searchsorted(times, until, side="right")]))) > 0.1 - 1e-12
