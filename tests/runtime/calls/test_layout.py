"""Batches in every layout: the same bits, results laid out as inputs are, nothing copied that C can read in place."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.runtime.build.toolchain import DEFAULT_FLAGS
from symofros.runtime.calls import library
from symofros.runtime.calls.layout import Strided, states

N = library.MANY + 5
EXACT = (*DEFAULT_FLAGS, "-ffp-contract=off")
Layout = Callable[[np.ndarray], np.ndarray]


def spaced(x: np.ndarray) -> np.ndarray:
    """Every second entry of every third row of something larger."""
    larger = np.zeros((3 * len(x), 2 * x.shape[1]))
    larger[::3, ::2] = x
    return larger[::3, ::2]


LAYOUTS: dict[str, Layout] = {
    "rows": np.ascontiguousarray,
    "columns": np.asfortranarray,
    "transposed": lambda x: np.ascontiguousarray(x.T).T,
    "part of wider rows": lambda x: np.hstack([x, np.ones((len(x), 3))])[:, : x.shape[1]],
    "part of longer columns": lambda x: np.asfortranarray(np.vstack([x, x]))[: len(x)],
    "spaced": spaced,
    "backwards": lambda x: np.ascontiguousarray(x[::-1, ::-1])[::-1, ::-1],
    "of another type": lambda x: x.astype(np.longdouble),
}


@cache
def model(name: str = "chain7") -> sf.Model:
    return sf.compile(MODELS[name], sf.Options(flags=EXACT))


@cache
def given(name: str, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m, rng = model(name), np.random.default_rng(n)
    return tuple(rng.uniform(-2.0, 2.0, (n, size)) for size in (m.nq, m.nv, m.nu))  # type: ignore[return-value]


def is_columns(x: np.ndarray) -> bool:
    return x.strides[0] == x.itemsize


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", ["chain7", "friction_arm", "pendulum"])
def test_every_layout_gives_the_same_bits(name: str, layout: str) -> None:
    q, v, u = given(name, N)
    m, laid = model(name), LAYOUTS[layout]
    for found, expected in zip(m.dynamics(laid(q), laid(v), laid(u)), m.dynamics(q, v, u), strict=True):
        assert np.array_equal(found, expected)


@pytest.mark.parametrize("n", [2, 9, library.MANY - 1, N])
@pytest.mark.parametrize("function", ["mass_matrix", "forward_dynamics_derivatives"])
def test_results_have_the_memory_layout_of_their_inputs(function: str, n: int) -> None:
    """By vectors, in a loop, and where a solver finishes the function."""
    q, v, u = given("friction_arm", n)
    arguments = (q,) if function == "mass_matrix" else (q, v, u)
    by_rows, in_columns = (
        getattr(model("friction_arm"), function)(*(laid(x) for x in arguments))
        for laid in (np.ascontiguousarray, np.asfortranarray)
    )
    for rows, found in zip(np.atleast_1d(by_rows), np.atleast_1d(in_columns), strict=True):
        assert np.array_equal(rows, found)
    first = in_columns[0] if isinstance(in_columns, tuple) else in_columns
    assert is_columns(first) and first.ctypes.data % 64 == 0


def test_batches_may_have_several_dimensions() -> None:
    q, v, _ = given("chain7", 600)
    expected = model().bias(q, v).reshape(20, 30, 7)
    shaped = [np.asfortranarray(x).reshape(20, 30, 7) for x in (q, v)]
    as_rows = [x.reshape(20, 30, 7) for x in (q, v)]
    # In Fortran's order of dimensions neighbours in memory are not those in the batch: a copy.
    as_fortran = [np.asfortranarray(x) for x in as_rows]
    for arguments in (shaped, as_rows, as_fortran):
        assert np.array_equal(model().bias(*arguments), expected)
    in_columns = [np.moveaxis(np.ascontiguousarray(np.moveaxis(x, -1, 0)), 0, -1) for x in as_rows]
    found = model().bias(*in_columns)
    assert np.array_equal(found, expected) and found.strides[1] == 8
    assert np.array_equal(
        model().bias(as_rows[0], as_rows[1][:, :1]), model().bias(q, np.repeat(v[::30], 30, 0)).reshape(20, 30, 7)
    )


@pytest.mark.parametrize(
    "layout", ["rows", "columns", "part of wider rows", "part of longer columns", "spaced", "backwards"]
)
def test_arrays_of_supported_layouts_are_not_copied(layout: str) -> None:
    x = LAYOUTS[layout](given("chain7", N)[0])
    seen = Strided.of(states(x, (N,)), np.float64)
    assert np.shares_memory(seen.array, x)
    k, i = 3, N - 5
    assert seen.address + 8 * (k * seen.step + i * seen.stride) == x[i : i + 1, k].ctypes.data


def test_unsupported_layouts_are_copied() -> None:
    x = given("chain7", N)[0]
    record = np.zeros(N, dtype=np.dtype([("flag", "i1"), ("q", "f8", (7,))]))
    record["q"] = x
    for odd in (x.astype(np.float32), record["q"]):
        seen = Strided.of(states(odd, (N,)), np.float64)
        assert not np.shares_memory(seen.array, odd) and (seen.step, seen.stride) == (1, 7)
        assert np.array_equal(model().mass_matrix(odd), model().mass_matrix(np.array(odd, dtype=np.float64)))


def test_parameters_of_each_state_in_columns() -> None:
    m = model("friction_arm")
    q, v, u = given("friction_arm", N)
    par = m.parameter_values * np.random.default_rng(0).uniform(0.5, 1.5, (N, m.npar))
    rows, found = (
        m.dynamics(q, v, u, par=par),
        m.dynamics(*map(np.asfortranarray, (q, v, u)), par=np.asfortranarray(par)),
    )
    assert all(np.array_equal(x, y) and is_columns(x) for x, y in zip(found, rows, strict=True))


def test_entries_that_are_always_zero_are_written() -> None:
    """Over memory that held other numbers."""
    m, n = model("cart_pole"), library.MANY
    q = np.asfortranarray(np.random.default_rng(0).uniform(-1.0, 1.0, (n, m.nq)))
    frame = m.names.frames[-1]
    expected = m.frame_jacobian(frame, np.ascontiguousarray(q))
    for _ in range(3):
        junk = np.full((n, 6, m.nv), 7.0)
        del junk
        assert np.array_equal(m.frame_jacobian(frame, q), expected) and np.any(expected[0] == 0.0)
