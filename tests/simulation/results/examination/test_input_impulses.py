"""Fixed steps say where they misjudge the impulse of an input, and are silent where they meet it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.simulation.results.examination.input_impulses import _MOST, _held, _misjudged, _sharpest, nodes
from symofros.simulation.stepping.methods import METHODS
from tests.simulation.mechanisms import slide

CART = slide(mass=2.0, actuated=True)
FIXED: dict[str, dict[str, Any]] = {
    "euler": {},
    "semi_implicit_euler": {},
    "rk4": {},
    "implicit_euler": {},
    "generalized_alpha": {},
    "variational": {},
    "rodas4": {"adaptive": False},
    "dopri5": {"adaptive": False},
    "dop853": {"adaptive": False},
}
STEP, SPAN = 0.01, 20.0  # So many steps that a run is not made again as a whole.


def noted(outcome: Any) -> bool:
    return any(
        " misjudge the input '" in note and "a smaller dt or an adaptive method" in note for note in outcome.notes
    )


def push(kind: str, begin: float, length: float) -> Any:
    """A push with an impulse of 2 N s, which gives the cart 1 m/s."""
    top, middle = 4.0 / length, begin + 0.5 * length
    if kind == "formula":
        return f"{top}*max(0, 1 - abs(t - {middle})/{0.5 * length})"
    if kind == "held":
        return sf.Signal([0.0, begin, begin + length], [0.0, 0.5 * top, 0.0], "hold")
    return sf.Signal([0.0, begin, middle, begin + length], [0.0, 0.0, top, 0.0])


@pytest.mark.parametrize("method", FIXED)
@pytest.mark.parametrize("kind", ["lines", "held", "formula"])
def test_a_push_shorter_than_a_step_is_met_or_noted(method: str, kind: str) -> None:
    cart, rng = sf.compile(CART), np.random.default_rng(len(method))
    heard = 0
    for _ in range(4):
        begin, length = rng.uniform(1.0, 19.0), STEP * 10 ** rng.uniform(-2.0, -0.1)
        run = sf.simulate(cart, t_end=SPAN, u={"x": push(kind, begin, length)}, method=method, dt=STEP, **FIXED[method])
        off, said = abs(run.v[-1, 0] - 1.0), noted(run.outcome)
        assert said or off < 0.11, (begin, length, off, str(run.outcome))
        assert not said or off > 0.09, (begin, length, off, str(run.outcome))
        heard += said
    assert heard or method == "dop853"


@pytest.mark.parametrize("method", FIXED)
@pytest.mark.parametrize("kind", ["lines", "held", "formula", "sine", "recorded", "biased"])
def test_inputs_that_steps_resolve_get_no_note(method: str, kind: str) -> None:
    t = np.arange(0.0, SPAN + 1e-9, 0.0037)
    law: Any = {
        "sine": sf.Signal(t, np.sin(2.0 * np.pi * t)),
        "recorded": sf.Signal(t, 3.0 + np.cos(t) + 0.01 * np.random.default_rng(1).standard_normal(len(t))),
        "biased": "1 + 2*exp(-((t - 6.3)/0.5)^2)",
    }.get(kind)
    law = push(kind, 3.0037, 40.0 * STEP) if law is None else law
    run = sf.simulate(sf.compile(CART), t_end=SPAN, u={"x": law}, method=method, dt=STEP, **FIXED[method])
    fine = sf.simulate(sf.compile(CART), t_end=SPAN, u={"x": law}, method="dop853", rtol=1e-10, atol=1e-12)
    assert abs(run.v[-1, 0] - fine.v[-1, 0]) < 0.05 * np.abs(fine.v).max()
    assert run.outcome.ok and not run.outcome.notes, run.outcome.notes


@pytest.mark.parametrize("name", ["rk4", "euler", "dopri5"])
def test_pushes_to_both_sides_are_misjudged_by_as_much(name: str) -> None:
    """By samples of an input as by their negatives."""
    rng = np.random.default_rng(4)
    for _ in range(20):
        t = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 1.0, 5))])
        values = rng.standard_normal(6)
        pair = [_misjudged(_held(0, t, sign * values), METHODS[name], 0.0, 1.0, 0.1) for sign in (1.0, -1.0)]
        one, other = ((0.0, 0.0, 0.0) if x is None else (x.t, x.missed, x.whole) for x in pair)
        assert one == pytest.approx(other, rel=1e-12)


@given(
    seed=st.integers(0, 10**6), t0=st.sampled_from([-7.0, 3.0, 1e3]), name=st.sampled_from(["rk4", "euler", "dopri5"])
)
def test_impulses_are_misjudged_by_as_much_at_another_time(seed: int, t0: float, name: str) -> None:
    """Nor by more or less beside a constant part, which any step meets."""
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 1.0, 5))])
    values = rng.standard_normal(6)
    moved = [
        _misjudged(_held(0, begin + t, bias + values), METHODS[name], begin, begin + 1.0, 0.1)
        for begin, bias in ((0.0, 0.0), (t0, 0.0), (t0, 30.0))
    ]
    first, *others = ((0.0, 0.0) if x is None else (x.missed, x.whole) for x in moved)
    for other in others:
        assert other == pytest.approx(first, abs=1e-9)


def test_missed_impulses_of_small_effect_are_not_noted() -> None:
    """A push that is missed, beside a motion in which it makes no difference; and one that depends on the state."""
    cart = sf.compile(CART)
    law = push("lines", 3.0013, 0.003)
    assert noted(sf.simulate(cart, [0.0], [0.0], SPAN, u={"x": law}, method="rk4", dt=STEP).outcome)
    fast = sf.simulate(cart, [0.0], [1e3], SPAN, u={"x": law}, method="rk4", dt=STEP)
    assert not noted(fast.outcome)
    by_state = sf.simulate(cart, [0.0], [1.0], SPAN, u={"x": "-abs(t - 3.0013)*x"}, method="rk4", dt=STEP)
    assert not noted(by_state.outcome)


@pytest.mark.parametrize("start", [-3.0, -1.0, 0.5, 1.0, 3.0])
def test_a_formula_of_the_speed_is_no_formula_of_time_at_any_start(start: float) -> None:
    """Nor one of the coordinate: what a step makes of it is no matter of its impulse."""
    cart = sf.compile(CART)
    for state in ("dx", "x"):
        law = f"{state}*({push('formula', 3.0013, 0.003)})/{start}"
        run = sf.simulate(cart, [start - 3.0 * start], [start], 4.0, u={"x": law}, method="rk4", dt=STEP)
        assert not noted(run.outcome), (state, run.outcome)


@pytest.mark.parametrize(("begin", "said"), [(0.5013, True), (15.0013, False)])
def test_an_effect_is_judged_where_the_impulse_is_missed(begin: float, said: bool) -> None:
    """A push that acts less the farther the cart has come: e^-x of it."""
    cart = sf.compile(slide(mass=2.0, effort=("push*exp(-x)",), inputs=(sf.Input("push"),)))
    run = sf.simulate(cart, [0.0], [1.0], SPAN, u={"push": push("lines", begin, 0.003)}, method="rk4", dt=STEP)
    assert noted(run.outcome) == said


def test_each_run_of_a_batch_has_its_own_note() -> None:
    t = [0.0, 3.0013, 3.0025, 3.0037]
    values = np.array([[0.0, 0.0, 1e3, 0.0], [0.0, 0.0, 0.0, 0.0]])[..., np.newaxis]
    runs = sf.simulate_batch(sf.compile(CART), np.zeros((2, 1)), None, SPAN, u={"x": sf.Signal(t, values)}, dt=STEP)
    assert runs.v_last[0, 0] == 0.0
    assert [noted(runs.outcome(i)) for i in range(2)] == [True, False]


def test_a_push_within_an_interval_of_samples_does_work() -> None:
    """Adaptive steps that meet it: samples of a batch show no power, and energy comes by the push all the same."""
    law = push("lines", 3.0, 0.003)
    runs = sf.simulate_batch(
        sf.compile(CART), np.zeros((1, 1)), None, 10.0, u={"x": law}, method="dopri5", output=np.linspace(0, 10, 101)
    )
    assert abs(runs.v_last[0, 0] - 1.0) < 1e-9 and not runs.outcome(0).notes, runs.outcome(0)


@pytest.mark.parametrize("name", [name for name in METHODS if not METHODS[name].family.multistep])
def test_quadrature_nodes_integrate_as_steps_of_the_method_do(name: str) -> None:
    """A resolved force that varies is integrated by a step as by its nodes; generalised alpha by its mean."""
    c, weights, of_rate = nodes(METHODS[name])
    assert abs(weights.sum() - 1.0) < 1e-13
    h, cart = 0.5, sf.compile(CART)
    options: dict[str, Any] = {"adaptive": False} if METHODS[name].adaptive else {}
    run = sf.simulate(cart, t_end=h, u={"x": "2*cos(3*t)"}, method=name, dt=h, **options)
    by_nodes = h * float(weights @ np.cos(3.0 * h * c))  # The cosine has no rate at the start.
    if name != "generalized_alpha":
        assert abs(run.v[-1, 0] - by_nodes) < 1e-12
    run = sf.simulate(cart, t_end=h, u={"x": "2*sin(3*t)"}, method=name, dt=h, **options)
    by_nodes = h * float(weights @ np.sin(3.0 * h * c)) + 3.0 * of_rate * h**2
    if name != "generalized_alpha":
        assert abs(run.v[-1, 0] - by_nodes) < 1e-12


def test_the_sharpest_samples_are_examined() -> None:
    """Of more than can be looked at, those that change most, in the order of time; none that goes on as before."""
    rng = np.random.default_rng(0)
    t, changes = np.arange(5.0 * _MOST), rng.standard_normal(5 * _MOST)
    found = _sharpest(t, changes)
    assert len(found) == _MOST and np.all(np.diff(found) > 0.0)
    left = np.setdiff1d(t, found)
    assert np.abs(changes[found.astype(int)]).min() >= np.abs(changes[left.astype(int)]).max()
    np.testing.assert_array_equal(_sharpest(t[:4], np.array([1.0, 0.0, -1e-16, 2.0])), [0.0, 3.0])
