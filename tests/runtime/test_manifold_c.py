"""The configuration manifold of the stepping loop's C, which is written of NumPy's formulas, against these."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import cffi
import numpy as np
import pytest
from hypothesis import given, settings

from symofros.generator.codegen.manifold import rotations_text
from symofros.native import amalgamated, native_text
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import DEFAULT_FLAGS, find_toolchain
from symofros.runtime.calls.binding import constants
from symofros.runtime.manifold import chart_coordinates, chart_rate, integrate, retract
from tests.runtime.test_manifold import (
    ANGLES,
    NQ,
    NV,
    ROUNDING,
    SEEDS,
    SEGMENTS,
    OnGraph,
    configuration,
    step,
    values,
)

_INTERFACE = """
void retracted(int32_t n, const int32_t *segments, const double *q0, const double *theta, double *q);
void chart_rates(int32_t n, const int32_t *segments, const double *theta, const double *v, double *rate);
void coordinates(int32_t n, const int32_t *segments, const double *q0, const double *q1, double *theta);
void rates(int32_t n, const int32_t *segments, double *q, const double *v, double *rate);
void displacements(int32_t n, const int32_t *segments, double *theta);
"""
_WRAPPER = Path(__file__).with_name("manifold_wrapper.c").read_text()


def test_the_rotation_file_is_current() -> None:
    """Written anew by python -m symofros.generator.codegen.manifold."""
    assert native_text("stepping/state/rotations.c") == rotations_text()


@cache
def native() -> tuple[Any, Any]:
    """The functions of manifold.c as a library of their own."""
    toolchain = find_toolchain()
    if toolchain is None:
        pytest.skip("no C compiler")
    source = _WRAPPER
    for name, text in (
        ("symofros_stepper.h", native_text("stepping/symofros_stepper.h")),
        ("manifold.c", amalgamated("stepping/state/manifold.c")),
    ):
        source = source.replace(f'#include "{name}"', text)
    ffi = cffi.FFI()
    ffi.cdef(_INTERFACE)
    flags = (*DEFAULT_FLAGS, "-Wno-unused-function")
    return ffi, ffi.dlopen(str(build_library(source, native_text("model/symofros_model.h"), toolchain, flags)))


def call(name: str, *arrays: np.ndarray) -> None:
    """Call a function of the library; the last array takes the result."""
    ffi, library = native()
    segments = np.array([(constants()[s.constant], s.q, s.v, s.size) for s in SEGMENTS], dtype=np.int32)
    pointers = [ffi.cast("double *", ffi.from_buffer(array)) for array in arrays]
    getattr(library, name)(len(SEGMENTS), ffi.cast("int32_t *", ffi.from_buffer(segments)), *pointers)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=80)
def test_the_loop_retracts_as_numpy_does(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    q0, theta, q = configuration(rng), step(rng, (first, second)), np.empty(NQ)
    call("retracted", q0, theta, q)
    np.testing.assert_allclose(q, retract(SEGMENTS, q0, theta), atol=ROUNDING, rtol=0)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=80)
def test_the_loop_has_the_rates_of_charts_that_numpy_has(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    theta, v, rate = step(rng, (first, second)), rng.uniform(-1.0, 1.0, NV), np.empty(NV)
    call("chart_rates", theta, v, rate)
    np.testing.assert_allclose(rate, chart_rate(SEGMENTS, theta, v), atol=3 * ROUNDING, rtol=0)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=80)
def test_the_loop_has_the_coordinates_of_charts_that_numpy_has(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    q0, theta = configuration(rng), np.empty(NV)
    q1 = retract(SEGMENTS, q0, step(rng, (first, second)))
    call("coordinates", q0, q1, theta)
    np.testing.assert_allclose(theta, chart_coordinates(SEGMENTS, q0, q1), atol=ROUNDING, rtol=1e-15)


@given(SEEDS)
@settings(max_examples=40)
def test_coordinate_rates_match_the_graph(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, v, rate = configuration(rng), rng.uniform(-1.0, 1.0, NV), np.empty(NQ)
    call("rates", q, v, rate)
    graph = OnGraph()
    expected = values(graph.g, graph.rates(graph.q0), q=q, v=v)
    np.testing.assert_allclose(rate, expected, atol=ROUNDING, rtol=0)


@given(SEEDS, ANGLES, ANGLES)
@settings(max_examples=80)
def test_constant_twists_lead_the_loop_where_they_lead_numpy(seed: int, first: float, second: float) -> None:
    rng = np.random.default_rng(seed)
    q0, theta, q = configuration(rng), step(rng, (first, second)), np.empty(NQ)
    expected = integrate(SEGMENTS, q0, theta)
    call("displacements", theta)
    call("retracted", q0, theta, q)
    np.testing.assert_allclose(q, expected, atol=ROUNDING, rtol=0)
