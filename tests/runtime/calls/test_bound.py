"""Functions bound to their memory: the same numbers, without checks, and no array that C could not hold."""

from __future__ import annotations

import gc
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.models import model

FUNCTIONS = {
    "mass_matrix": ("q",),
    "bias": ("q", "v"),
    "generalized_force": ("q", "v", "u"),
    "inverse_dynamics": ("q", "v", "a"),
    "kinetic_energy": ("q", "v"),
}


@pytest.fixture(params=["c", "interpreter"])
def m(request: pytest.FixtureRequest) -> sf.Model:
    return model("parametrised0", request.param)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_same_as_the_method(m: sf.Model, name: str, rng: np.random.Generator) -> None:
    bound = m.bind(name)
    (result,) = bound.outputs.values()
    gc.collect(1)  # What C has the addresses of must be held by the Bound.
    for _ in range(3):
        given = dict(zip("qv", m.random_state(rng), strict=True)) | {"a": rng.normal(size=m.nv), "u": np.ones(m.nu)}
        for group in FUNCTIONS[name]:
            bound.inputs[group][:] = given[group]
        bound()
        assert np.array_equal(result, getattr(m, name)(*(given[group] for group in FUNCTIONS[name])))


def test_memory_of_the_caller_is_used(m: sf.Model, rng: np.random.Generator) -> None:
    q, M = m.random_state(rng)[0], np.full((m.nv, m.nv), np.nan)
    bound = m.bind("mass_matrix", q=q, M=M)
    assert bound.inputs["q"] is q and bound.outputs["M"] is M
    bound()
    q[:] = m.random_state(rng)[0]
    bound()
    assert np.array_equal(M, m.mass_matrix(q))


@pytest.mark.parametrize(
    "array",
    [
        np.zeros(3),
        np.zeros(4)[::2],
        np.zeros(2, dtype=np.float32),
        [0.0, 0.0],
        np.zeros((1, 2)),
        np.broadcast_to(0.0, 2),  # Read only.
    ],
)
def test_other_arrays_are_refused(array: np.ndarray) -> None:
    m = sf.compile(MODELS["double_pendulum"])
    with pytest.raises(sf.ShapeError, match=r"mass_matrix: 'q' can't be bound(.|\n)*shape \(2,\)"):
        m.bind("mass_matrix", q=array)


@pytest.mark.parametrize(
    ("name", "frame", "arrays", "message"),
    [
        ("mass_matrx", "", {}, "no function 'mass_matrx'(.|\n)*mass_matrix"),
        ("frame_pose", "", {}, "bound with their frame"),
        ("frame_pose", "tp", {}, "no frame 'tp'"),
        ("mass_matrix", "", {"v": np.zeros(2)}, "mass_matrix: neither input nor output 'v'"),
    ],
)
def test_unknown_names_are_refused(name: str, frame: str, arrays: dict[str, np.ndarray], message: str) -> None:
    with pytest.raises(sf.UnknownNameError, match=message):
        sf.compile(MODELS["double_pendulum"]).bind(name, frame, **arrays)


@pytest.mark.parametrize("n", [3, 600], ids=["state by state", "by vectors"])
@pytest.mark.parametrize("order", ["C", "F"], ids=["rows", "columns"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_batches_are_computed_in_the_arrays_of_the_caller_and_beside_inputs_that_overlap_them(
    n: int, order: Any, precision: Any, rng: np.random.Generator
) -> None:
    m = model("double_pendulum").with_precision(precision)
    dtype = np.float32 if precision == "single" else np.float64
    q, v, u = (np.asarray(rng.normal(size=(n, m.nv)), dtype, order) for _ in range(3))
    expected = m.dynamics(q, v, u)
    M, h = np.full((n, m.nv, m.nv), np.nan, dtype), np.full((n, m.nv), np.nan, dtype)
    results = m.evaluate("dynamics", q=q, v=v, u=u, out={"M": M, "h": h})
    assert results[0] is M and results[1] is h
    for result, value in zip(results, expected, strict=True):
        np.testing.assert_array_equal(result, value)
    over = np.array(v, order="C")
    m.evaluate("dynamics", q=q, v=over, u=u, out={"h": over})
    np.testing.assert_array_equal(over, expected[1])


@pytest.mark.parametrize(
    ("out", "words"),
    [
        ({"M": np.empty((2, 3))}, r"a writeable C-contiguous float64 array of shape \(2, 2\)"),
        ({"M": np.empty((2, 2), np.float32)}, "float32 array"),
        ({"M": np.empty((4, 2))[::2]}, "not contiguous or not writeable"),
        ({"M": np.broadcast_to(0.0, (2, 2))}, "not contiguous or not writeable"),
        ({"M": [[0.0, 0.0], [0.0, 0.0]]}, "list"),
        ({"m": np.empty((2, 2))}, "no output 'm'"),
    ],
)
def test_arrays_that_can_not_receive_an_output_are_refused_in_words(out: dict[str, Any], words: str) -> None:
    m = model("double_pendulum")
    with pytest.raises((sf.ShapeError, sf.UnknownNameError), match=words):
        m.evaluate("mass_matrix", q=m.neutral(), out=out)


def test_outputs_that_share_memory_are_refused(rng: np.random.Generator) -> None:
    """With one another, and where C reads what a call has written: with inputs."""
    m = model("double_pendulum", "c")
    q = rng.normal(size=2)
    shared = np.zeros(6)
    overlapping = {"M": shared[:4].reshape(2, 2), "h": shared[3:5]}
    with pytest.raises(sf.ShapeError, match="memory of '(M|h)'"):
        m.evaluate("dynamics", q=q, v=q, out=overlapping)
    for arrays in (overlapping, {"v": shared[:2], "h": shared[1:3]}):
        with pytest.raises(sf.ShapeError, match="shares no memory with another array"):
            m.bind("dynamics", **arrays)
    rows = np.zeros((9, 2))
    with pytest.raises(sf.ShapeError, match="shares no memory with another array"):
        m.bind("bias", n=8, v=rows[:8], h=rows[1:])
