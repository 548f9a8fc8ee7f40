"""Signals put together and taken apart."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import Constant, Gain, Hold, Join, Pick, Reshape, Sum, UnitDelay
from tests.blocks.support import refused, run

MATRIX = [[1.0, -2.0, 3.0], [0.5, 0.0, -1.0]]


def test_a_constant_is_a_run_time_parameter() -> None:
    diagram = sf.Diagram("one")
    diagram.add(Constant(name="c", value=[1.0, 2.0], unit="m"))
    simulation = sf.Simulation(diagram)
    assert simulation.run(0.1, dt=0.1)["c.y"][-1] == pytest.approx([1.0, 2.0])
    assert simulation.run(0.1, dt=0.1, parameters={"c.value": [3.0, 4.0]})["c.y"][-1] == pytest.approx([3.0, 4.0])


@pytest.mark.parametrize("gain", [2.0, [1.0, -2.0, 3.0], MATRIX])
def test_a_gain_is_a_scalar_a_vector_or_a_matrix(gain: object, rng: np.random.Generator) -> None:
    u = rng.normal(size=(6, 3))
    expected = u @ np.array(MATRIX).T if gain is MATRIX else u * np.asarray(gain)
    np.testing.assert_allclose(run(Gain(name="g", gain=gain), {"u": u})["y"], expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("unit_in", "unit_out", "factor"),
    [
        ("deg", "rad", np.pi / 180),
        ("mm", "m", 1e-3),
        ("m", "N", 1.0),
        ("rev/min", "rad/s", np.pi / 30),
    ],
)
def test_only_units_of_one_quantity_are_converted(unit_in: str, unit_out: str, factor: float) -> None:
    found = run(Gain(name="g", gain=3.0, unit_in=unit_in, unit_out=unit_out), {"u": [2.0, 5.0]})["y"]
    assert found == pytest.approx([6.0 * factor, 15.0 * factor], rel=1e-14)


def test_pick_join_and_reshape_rearrange_entries(rng: np.random.Generator) -> None:
    u = rng.normal(size=(4, 6))
    np.testing.assert_array_equal(run(Pick(name="p", entries=[4, 0]), {"u": u})["y"], u[:, [4, 0]])
    np.testing.assert_array_equal(run(Reshape(name="r", shape=(2, 3)), {"u": u})["y"], u.reshape(4, 2, 3))
    joined = run(Join(name="j", count=3), {"u1": u[:, :2], "u2": u[:, 2], "u3": u[:, 3:]})["y"]
    np.testing.assert_array_equal(joined, u)


@pytest.mark.parametrize(
    ("entries", "of", "expected"),
    [
        ("actuated", "q", [0, 5, 9]),
        (["e1", "link2.bend_y[1]"], "q", [1, 7]),
        ("q3", "u", [2]),
        ([0, "q3"], "v", [0, 9]),
    ],
)
def test_entries_are_picked_by_names_of_a_model(entries: object, of: str, expected: list[int]) -> None:
    size = 3 if of == "u" else 10
    found = run(
        Pick(name="p", entries=entries, model="m", of=of),
        {"u": [np.arange(size)]},
        t_end=0.01,
        models={"m": (MODELS["planar_robot"], {})},
    )
    assert found["y"][0].tolist() == expected


def test_delay_and_hold_update_at_their_samples() -> None:
    u = np.arange(12.0)
    late = run(UnitDelay(name="d", period=0.03, start=-1.0), {"u": u})["y"]
    assert late.tolist() == [-1, -1, -1, 0, 0, 0, 3, 3, 3, 6, 6, 6]
    held = run(Hold(name="h", period=0.03, offset=0.01), {"u": u})["y"]
    assert held.tolist() == [0, 1, 1, 1, 4, 4, 4, 7, 7, 7, 10, 10]


def test_a_delay_breaks_a_loop() -> None:
    diagram = sf.Diagram("counter")
    diagram.add(Constant(name="one", value=[1.0]))
    diagram.add(Sum(name="next"), u1="one.y", u2="count.y")
    diagram.add(UnitDelay(name="count", period=0.1, start=[5.0]), u="next.y")
    assert sf.Simulation(diagram).run(0.3, dt=0.1, record=0.1)["count.y"][:, 0].tolist() == [5, 6, 7, 8]


def make_pick(**fields: object) -> None:
    diagram = sf.Diagram("one")
    diagram.add_model("m", MODELS["planar_robot"])
    diagram.add_model("free", MODELS["four_bar"])
    diagram.add(Constant(name="c", value=np.zeros(10)))
    diagram.add(Pick(name="p", **fields), u="c.y")
    sf.Simulation(diagram)


@pytest.mark.parametrize(
    ("make", "found", "remedy"),
    [
        (lambda: make_pick(entries=["q4"], model="m"), "'q4'", "did you mean"),
        (lambda: make_pick(entries=["q1"]), "['q1']", "name the model"),
        (lambda: make_pick(entries=[10]), "entry 10", "smaller numbers"),
        (lambda: make_pick(entries="actuated", model="free"), "none", "name the entries"),
    ],
)
def test_invalid_fields_of_signal_blocks_are_refused(make: Callable[[], object], found: str, remedy: str) -> None:
    refused(make, found, remedy)
