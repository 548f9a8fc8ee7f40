"""Inputs whose samples are held: each counts from its instant until the next one, in every stage of every step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import compiled

PERIOD = 0.05
VALUES = np.array([1.0, -2.0, 3.0, -1.0, 4.0, -3.0, 2.0, 5.0, -4.0])
END = PERIOD * (len(VALUES) - 1)
# Instants as products, as sums and as a division give them: they differ by rounding.
INSTANTS = {
    "products": PERIOD * np.arange(len(VALUES)),
    "sums": np.cumsum([0.0] + [PERIOD] * (len(VALUES) - 1)),
    "divided": np.linspace(0.0, END, len(VALUES)),
}


@pytest.fixture(scope="module")
def cart() -> sf.Model:
    return compiled("cart_pole")


def in_pieces(model: sf.Model, **options: object) -> sf.Trajectory:
    """The motion under the same inputs, each a constant of a run of its own: no step of it sees a jump."""
    state: tuple[np.ndarray, ...] = ()
    for value in VALUES[:-1]:
        piece = sf.simulate(model, *state, t_end=PERIOD, u={model.names.u[0]: value}, **options)
        state = piece.q[-1], piece.v[-1]
    return piece


def held(model: sf.Model, t: np.ndarray, **options: object) -> sf.Trajectory:
    return sf.simulate(model, t_end=END, u={model.names.u[0]: sf.Signal(t, VALUES, "hold")}, **options)


def test_steps_that_samples_fall_within_are_held_against_half_of_that(cart: sf.Model) -> None:
    t = 1.37 * INSTANTS["products"]
    coarse = sf.simulate(
        cart, t_end=END, u={cart.names.u[0]: sf.Signal(t, 10 * VALUES, "hold")}, dt=PERIOD, method="rk4"
    )
    assert any("half of that changes it" in note for note in coarse.outcome.notes)
    along = sf.simulate(cart, t_end=END, u={cart.names.u[0]: sf.Signal(t, VALUES, "linear")}, dt=1e-3, method="rk4")
    assert not along.outcome.notes


@pytest.mark.parametrize("method", ["rk4", "dopri5", "cvode"])
@pytest.mark.parametrize("before", [1, 3])
@pytest.mark.parametrize("instants", INSTANTS)
def test_a_sample_that_begins_at_zero_counts_from_there(
    cart: sf.Model, instants: str, before: int, method: str
) -> None:
    """Zero, which rounding is no share of, as exactly as other instants, and where sums miss it by rounding."""
    if method == "cvode":
        pytest.importorskip("sksundae")
    options: dict[str, object] = {"method": method} | ({"dt": PERIOD} if method == "rk4" else {"rtol": 1e-9})
    start = -PERIOD * before
    t = {"products": PERIOD * np.arange(-before, len(VALUES) - before), "sums": start + INSTANTS["sums"]}.get(
        instants, np.linspace(start, start + END, len(VALUES))
    )
    signal = {cart.names.u[0]: sf.Signal(t, VALUES, "hold")}
    run = sf.simulate(cart, t0=start, t_end=start + END, u=signal, **options)
    pieces = in_pieces(cart, **options)
    np.testing.assert_allclose(run.v[-1], pieces.v[-1], rtol=0, atol=1e-12 if method == "rk4" else 2e-5)
    if method == "rk4":
        np.testing.assert_array_equal(run[cart.names.u[0]], VALUES)


@pytest.mark.parametrize(
    ("t", "values", "said"),
    [
        ([0.0, 1.0], [[1.0, 2.0]], r"values \(1, 2\).*\n.*\n.*one row of values for each time"),
        ([0.0, 1.0], [[1.0, 2.0], [np.nan, 2.0]], r"nan in values at \(1, 0\).*\n.*\n.*mend the samples"),
        ([0.0, np.inf], [1.0, 2.0], r"inf in t at \(1,\)"),
        ([0.0, 2.0, 1.0], [1.0, 2.0, 3.0], r"t\[1\] = 2, then 1.*\n.*\n.*sort the samples"),
    ],
)
def test_faults_of_samples_are_named(t: list[float], values: list[Any], said: str) -> None:
    with pytest.raises(sf.ShapeError, match=said):
        sf.Signal(t, values)


@pytest.mark.parametrize("given", ["samples", "function"])
def test_jumps_within_fixed_steps_are_noted_where_they_matter(given: str) -> None:
    """A motion that was off by less than a tenth bore no note; where the same force is a formula it did."""
    joint = sf.Joint("z", "prismatic", axis=(1, 0, 0), actuated=True, elements=(sf.Spring(3.0), sf.Damper(0.2)))
    model = sf.compile(sf.System("pushed", (sf.RigidBody("b", joint, sf.Inertia(2.0)),), gravity=(0, 0, 0)))
    signal = sf.Signal([0.0, 0.3, 0.5], [1.0, -4.0, 2.0], "hold")
    u: Any = {"z": signal} if given == "samples" else lambda t, q, v: [1.0 if t < 0.3 else -4.0 if t < 0.5 else 2.0]
    at: dict[str, Any] = {"t_end": 0.6, "output": 0.01}
    right = sf.simulate(model, u={"z": signal}, method="dop853", rtol=1e-11, atol=1e-13, **at)
    for dt, wrong in ((0.013, True), (0.003, False)):
        run = sf.simulate(model, u=u, dt=dt, **at)
        off = np.abs(run.q - right.q).max() / np.abs(right.q).max()
        assert (off > 0.05) == wrong == bool(run.outcome.notes), (off, run.outcome)
