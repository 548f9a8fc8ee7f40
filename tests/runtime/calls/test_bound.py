"""Functions bound to their memory: the bits of the plain call in any layout, and no array that C could not hold."""

from __future__ import annotations

import copy
import gc
import pickle
import tracemalloc
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from symofros.runtime.calls.bound import Bound
from symofros.runtime.calls.library import MANY
from symofros.runtime.calls.sharing import LEAST
from tests.models import GUESSES, model

CLOSED = "four_bar"
# Function -> its inputs.
FUNCTIONS = {
    "mass_matrix": "q",
    "bias": "qv",
    "generalized_force": "qvu",
    "dynamics": "qvu",
    "forward_dynamics": "qvu",
    "inverse_dynamics": "qva",
    "kinetic_energy": "qv",
    "frame_pose": "q",
}


@cache
def bindable(case: str) -> tuple[sf.Model, sf.Model]:
    """A model that is bound, and its twin in NumPy."""
    name = "parametrised0" if case == "parametrised" else "double_pendulum"
    twin = model(name)
    if case == "interpreter":
        return twin, twin
    return (sf.compile(MODELS[name], sf.Options(batch="loop")) if case == "loop" else model(name, "c")), twin


def states(m: sf.Model, n: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    q = m.normalized(rng.normal(size=(n, m.nq)))
    return {"q": q, "v": rng.normal(size=(n, m.nv)), "a": rng.normal(size=(n, m.nv)), "u": rng.normal(size=(n, m.nu))}


def written(bound: Bound, given: dict[str, np.ndarray]) -> None:
    for group in bound.inputs.keys() & given.keys():
        bound.inputs[group][...] = given[group]


def check(bound: Bound, plain: object, reference: object) -> None:
    """The bits of the plain call; by NumPy's interpreter the same within rounding."""
    results = [value if isinstance(value, tuple) else (value,) for value in (plain, reference)]
    for output, same, expected in zip(bound.outputs.values(), *results, strict=False):
        assert output.shape == same.shape and np.array_equal(output, same)
        assert output == pytest.approx(expected, rel=1e-9, abs=1e-11)


def in_place(m: sf.Model, n: int) -> dict[str, np.ndarray]:
    """A column of a wider array, every second state in reverse, states side by side: read and written in place."""
    M = np.moveaxis(np.full((m.nv, m.nv, n), np.nan), -1, 0)
    return {"q": np.zeros((n, m.nq + 3))[:, 2 : 2 + m.nq], "v": np.zeros((2 * n, m.nv))[::-2], "M": M}


@settings(max_examples=30)
@given(
    st.sampled_from(["parametrised", "vector", "loop", "interpreter"]),
    st.sampled_from([*FUNCTIONS]),
    st.sampled_from([None, 1, 7, MANY - 1, MANY, MANY + 3]),
    st.sampled_from(["rows", "columns", "in place"]),
    st.sampled_from(["of all", "of each"]),
    st.integers(0, 99),
)
@example("parametrised", "dynamics", MANY + 1, "in place", "of each", 0)
@example("loop", "forward_dynamics", MANY, "columns", "of all", 0)
@example("vector", "kinetic_energy", MANY - 1, "columns", "of each", 0)
@example("vector", "dynamics", 3 * LEAST + 5, "columns", "of all", 0)  # By three threads.
@example("interpreter", "bias", 4, "columns", "of all", 0)
def test_bound_functions_have_the_bits_of_plain_calls(
    case: str, name: str, n: int | None, layout: str, parameters: str, seed: int
) -> None:
    """Of one state and of batches, by rows, by columns and in the caller's memory, for other parameters."""
    m, twin = bindable(case)
    rng, count, frames = np.random.default_rng(seed), n or 1, m.names.frames[-1:] if name == "frame_pose" else ()
    if count > 3 * LEAST:
        m = m.with_threads(3)
    of_each = parameters == "of each" and n is not None
    par = m.parameter_values * rng.uniform(1.0, 1.5, (count, 1) if of_each else 1)
    arrays = in_place(m, count) if layout == "in place" and n is not None else {}
    asked: dict[str, Any] = {} if n is None else {"n": n, "layout": "rows" if arrays else layout}
    bound = m.bind(name, *frames, par=par, **asked)
    arrays = {key: array for key, array in arrays.items() if key in bound.inputs or key in bound.outputs}
    if arrays:
        bound = m.bind(name, *frames, par=par, **asked, **arrays)
        assert all((bound.inputs | bound.outputs)[key] is array for key, array in arrays.items())
    gc.collect(1)  # What C has the addresses of must be held by the Bound.
    for _ in range(2):
        stated = states(m, count, rng)
        if n is None:
            stated = {group: array[0] for group, array in stated.items()}
        written(bound, stated)
        bound()
        inputs = [stated[group] for group in FUNCTIONS[name]]
        check(bound, *(getattr(one, name)(*frames, *inputs, par=par) for one in (m, twin)))


def test_bound_functions_with_solvers_match_plain_calls(rng: np.random.Generator) -> None:
    n = 5
    m = sf.compile(MODELS[CLOSED])
    bound = m.bind("project", n=n, layout="columns")
    given = states(m, n, rng)
    given["q"] = np.array(GUESSES[CLOSED]) + 0.01 * given["q"]
    written(bound, given)
    bound()
    q, v, left = m.project(given["q"], given["v"], u=given["u"])
    check(bound, (q, v), model(CLOSED).project(given["q"], given["v"], u=given["u"])[:2])
    # The posture is another one, and the loop is closed there: two legs of one length between equal pivots.
    assert np.all(left < 1e-9) and np.all(np.abs(q - given["q"]).max(axis=1) > 1e-8)
    assert q[:, 0] + q[:, 1] == pytest.approx(np.zeros(n), abs=1e-9)


def test_bound_functions_take_one_time_per_state(rng: np.random.Generator) -> None:
    joint = sf.Joint("j", "revolute", effort=("sin(t)",))
    driven = sf.compile(sf.System("s", [sf.RigidBody("b", joint, sf.Inertia(1.0))]))
    bound = driven.bind("generalized_force", n=9)
    bound.inputs["t"][:, 0] = t = rng.normal(size=9)
    bound()
    expected = driven.generalized_force(np.zeros((9, 1)), np.zeros((9, 1)), np.zeros((9, driven.nu)), t=t)
    assert np.array_equal(bound.outputs["Q"], expected)
    assert expected[:, 0] == pytest.approx(np.sin(t), rel=1e-14)


@pytest.mark.parametrize("layout", ["rows", "columns"])
def test_bound_calls_allocate_no_memory(layout: Any) -> None:
    bound = sf.compile(MODELS["double_pendulum"]).bind("dynamics", n=4096, layout=layout)
    bound()
    tracemalloc.start()
    for _ in range(3):
        bound()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8192  # M alone is of 131072 bytes.


ONE, BATCH = {}, {"n": 4}


@pytest.mark.parametrize(
    ("asked", "array"),
    [
        (ONE, np.zeros(3)),
        (ONE, np.zeros(4)[::2]),
        (ONE, np.zeros(2, dtype=np.float32)),
        (ONE, [0.0, 0.0]),
        (ONE, np.zeros((1, 2))),
        (ONE, np.broadcast_to(0.0, 2)),  # Read only.
        (BATCH, np.zeros((4, 3))),
        (BATCH, np.zeros((3, 2))),
        (BATCH, np.zeros((4, 2), dtype=np.float32)),
        (BATCH, [[0.0, 0.0]] * 4),
        (BATCH, np.broadcast_to(np.zeros(2), (4, 2))),
        (BATCH, np.zeros((4, 2), dtype=">f8")),
        (BATCH, np.ndarray((4, 2), buffer=bytearray(100), strides=(20, 8))),
    ],
)
def test_other_arrays_are_refused(asked: dict[str, int], array: np.ndarray) -> None:
    shape = r"shape \(4, 2\), or \(2,\) for all states" if asked else r"shape \(2,\)"
    with pytest.raises(sf.ShapeError, match=rf"mass_matrix: 'q' can't be bound(.|\n)*{shape}"):
        model("double_pendulum", "c").bind("mass_matrix", **asked, q=array)


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
def test_arrays_that_cannot_receive_an_output_are_refused(out: dict[str, Any], words: str) -> None:
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


@pytest.mark.parametrize("take", [pickle.dumps, copy.copy, copy.deepcopy])
def test_memory_of_c_is_neither_pickled_nor_copied(take: Callable[[object], object]) -> None:
    """It was a TypeError of cffi's; a shallow copy shared the arrays."""
    with pytest.raises(sf.SymofrosError, match="send the model, and bind the function there"):
        take(model("double_pendulum", "c").bind("mass_matrix"))
