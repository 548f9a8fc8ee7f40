"""Limits, dead zones, steps, switches, tables, relays, rates."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from symofros.blocks import DeadZone, LookupTable, LookupTable2D, Quantizer, RateLimit, Relay, Saturation, Switch
from tests.blocks.support import STEP, run
from tests.late import late

interpolate = late("scipy.interpolate")

U = np.linspace(-3, 3, 25)
X, Y = [-1.0, 0.5, 2.0], [3.0, -1.0, 0.0]


@pytest.mark.parametrize(
    ("block", "expected"),
    [
        (Saturation(name="b", low=-1.5, high=0.5), np.clip(U, -1.5, 0.5)),
        (DeadZone(name="b", low=-1.0, high=2.0), np.where(U > 2, U - 2, np.where(U < -1, U + 1, 0))),
        (Quantizer(name="b", step=0.4), 0.4 * np.floor(U / 0.4 + 0.5)),
        (
            LookupTable(name="b", x=X, y=np.array([Y, X]).T),
            np.stack([np.interp(U, X, Y), np.clip(U, -1, 2)], axis=1),
        ),
        (
            LookupTable(name="b", x=X, y=Y, outside="extend"),
            np.select([U < -1, U > 2], [3 - (U + 1) * 4 / 1.5, (U - 2) / 1.5], np.interp(U, X, Y)),
        ),
    ],
)
def test_static_nonlinearities_match_their_formulas(block: sf.blocks.Saturation, expected: np.ndarray) -> None:
    np.testing.assert_allclose(run(block, {"u": U})["y"], expected, atol=1e-14)


def test_a_switch_selects_its_first_input_at_and_above_the_threshold() -> None:
    u = {"u1": np.ones((3, 2)), "u2": np.zeros((3, 2)), "by": [0.4, 0.5, 0.6]}
    assert run(Switch(name="s", threshold=0.5), u)["y"][:, 0].tolist() == [0, 1, 1]


def test_a_sampled_relay_keeps_its_state() -> None:
    u = [0.5, 1.0, 0.5, 0.1, 0.0, 0.5, 2.0, -1.0]
    relay = Relay(name="r", lower=0.0, upper=1.0, on=5.0, off=-5.0, period=STEP)
    assert run(relay, {"u": u})["y"].tolist() == [-5, 5, 5, 5, -5, -5, 5, -5]


def test_rates_are_limited_in_both_directions() -> None:
    u = np.array([[1.0, 0.0], [3.0, 0.0], [3.0, -9.0], [3.0, -9.0], [0.0, 5.0]])
    found = run(RateLimit(name="r", rising=[100.0, 50.0], falling=[50.0, 200.0], period=STEP), {"u": u})["y"]
    np.testing.assert_allclose(found, [[1, 0], [2, 0], [3, -2], [3, -4], [2.5, -3.5]], atol=1e-12)


@pytest.mark.parametrize("outside", ["hold", "extend"])
def test_a_table_of_two_is_linear_in_each_input(outside: str) -> None:
    """By SciPy within the grid; beyond it the edge, or the cell there."""
    rng = np.random.default_rng(6)
    x1, x2 = np.array([-1.0, 0.5, 2.0]), np.array([0.0, 1.0, 1.5, 4.0])
    y, u = rng.standard_normal((3, 4)), rng.uniform(-2.0, 5.0, (60, 2))
    table = LookupTable2D(name="b", x1=x1, x2=x2, y=y, outside=outside)
    found = run(table, {"u1": u[:, 0], "u2": u[:, 1]})["y"]
    at = np.clip(u, [-1.0, 0.0], [2.0, 4.0]) if outside == "hold" else u
    wanted = interpolate.RegularGridInterpolator((x1, x2), y, bounds_error=False, fill_value=None)(at)
    np.testing.assert_allclose(found, wanted, atol=1e-12)


@pytest.mark.parametrize("outside", ["hold", "extend"])
def test_tables_over_many_decades_keep_the_digits_of_each_value(outside: str) -> None:
    """As of a resistance: beside a value of 1e16 / 3 the others once kept no digits, in two dimensions 1e-16 of it."""
    x, y, u = [0.0, 0.3, 49.0, 98.0], np.array([1e16, 1e6, 1.0, 1e-6]) / 3.0, np.linspace(0.0, 98.0, 197)
    wanted = np.interp(u, x, y)
    found = run(LookupTable(name="b", x=x, y=np.stack([y, y[::-1]], axis=1), outside=outside), {"u": u})["y"]
    np.testing.assert_allclose(found[:, 0], wanted, rtol=1e-14)
    np.testing.assert_allclose(found[:, 1], np.interp(u, x, y[::-1]), rtol=1e-14)
    table = LookupTable2D(name="b", x1=x, x2=x, y=np.outer(y, y), outside=outside)
    np.testing.assert_allclose(run(table, {"u1": u, "u2": u})["y"], wanted * wanted, rtol=1e-13)
