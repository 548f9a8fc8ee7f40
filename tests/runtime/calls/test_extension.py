"""The extension that makes plain calls: what it takes, what it refuses, what it keeps, and models without it."""

from __future__ import annotations

import gc
import sys
import sysconfig
import time
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.base.functions import FUNCTIONS
from symofros.native import native_number
from symofros.runtime.calls import extension
from symofros.runtime.calls.binding import callable_from_c
from symofros.runtime.calls.single import SingleCall, single_call
from tests.models import model


@pytest.fixture(scope="module")
def call_type() -> Any:
    loaded = extension.load()
    if loaded is None:
        pytest.skip("needs the headers of Python")
    return loaded


@pytest.fixture
def m() -> sf.Model:
    return model("parametrised0", "c").with_parameters()


@pytest.fixture
def forward(m: sf.Model, call_type: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[SingleCall]:
    """M, h and Q of one state by the extension."""
    monkeypatch.setattr("symofros.runtime.calls.single.call_type", lambda _: call_type)
    call = single_call(
        m.kernel("dynamics"), m.parameter_values, np.zeros(m.nu), m.record.quaternions, m._forget_single_calls
    )
    assert type(call) is call_type
    return call


def state(m: sf.Model) -> dict[str, Any]:
    q, v = m.random_state(np.random.default_rng(3))
    return {"q": q, "v": v, "u": None, "t": 0.0}


def test_plain_calls_use_the_extension_automatically(m: sf.Model, call_type: Any) -> None:
    q = state(m)["q"]
    before = m.mass_matrix(q)
    end = time.monotonic() + 60.0
    while type(m._single_calls.prepared.get("mass_matrix")) is not call_type:
        assert time.monotonic() < end
        time.sleep(0.01)
        m.mass_matrix(q)
    assert np.array_equal(before, m.mass_matrix(q))


def test_inputs_and_dictionaries_are_released(forward: SingleCall, m: sf.Model) -> None:
    given = state(m)
    counted = (given["q"], given["v"], given)
    for inputs in (given, given | {"v": np.zeros(m.nv + 1)}, given | {"u": "no array"}):
        before = [sys.getrefcount(x) for x in counted]
        for _ in range(100):
            forward(inputs)
        assert [sys.getrefcount(x) for x in counted] == before
    del inputs
    before = [sys.getrefcount(x) for x in counted]
    with pytest.raises(KeyError, match="v"):
        forward({"q": given["q"]})
    assert [sys.getrefcount(x) for x in counted] == before


def test_calls_and_objects_leave_no_memory_behind(forward: SingleCall, m: sf.Model, call_type: Any) -> None:
    given, kernel = state(m), callable_from_c(m.kernel("mass_matrix"))
    pre = kernel.prepare(m.parameter_values[None])

    def work() -> None:
        for _ in range(200):
            forward(given)
            inputs = (("q", m.nq, None, m.record.quaternions["q"]),)
            made = call_type(kernel.address, kernel.work + 1, inputs, ((m.nv, m.nv),), pre, kernel)
            made({"q": given["q"]})

    work()
    tracemalloc.start()
    try:
        work()
        gc.collect()
        first = tracemalloc.get_traced_memory()[0]
        work()
        gc.collect()
        assert tracemalloc.get_traced_memory()[0] - first < 2000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("group", "value"),
    [
        ("q", None),
        ("q", [0.0]),
        ("q", np.zeros(1)),
        ("q", np.zeros((1, 1))),
        ("v", np.float64(1.0)),
        ("t", 0),
        ("t", np.zeros(2)),
        ("u", np.zeros(0, np.float32)),
        *(("q", kind) for kind in (">f8", np.float32, object, np.int64)),
    ],
)
def test_unusual_calls_fall_back_to_python(forward: SingleCall, m: sf.Model, group: str, value: Any) -> None:
    given = state(m)
    is_kind = isinstance(value, str | type)  # The right numbers, of another kind.
    assert forward(given | {group: given[group].astype(value) if is_kind else value}) is None


def test_inputs_may_have_any_strides(forward: SingleCall, m: sf.Model) -> None:
    given = state(m)
    expected = forward(given)
    assert expected is not None
    bytes_off = np.zeros(8 * m.nq + 3, np.uint8)[3:].view(np.float64)  # Not aligned.
    bytes_off[:] = given["q"]
    for q in (
        np.repeat(given["q"], 3)[::3],
        given["q"][::-1].copy()[::-1],
        bytes_off,
        np.array([given["q"]] * 2).T[:, 0],
    ):
        found = forward(given | {"q": q})
        assert found is not None
        assert all(np.array_equal(x, y) for x, y in zip(found, expected, strict=True))


def test_arguments_of_the_extension_are_checked(call_type: Any, m: sf.Model) -> None:
    kernel = callable_from_c(m.kernel("mass_matrix"))
    pre = kernel.prepare(m.parameter_values[None])
    inputs = (("q", m.nq, None, m.record.quaternions["q"]),)
    for wrong in (
        (kernel.address, 0, inputs, ((m.nv, m.nv),), pre, kernel),
        (kernel.address, 8, inputs * 17, ((m.nv, m.nv),), pre, kernel),
        (kernel.address, 8, inputs, ((1, 1, 1),), pre, kernel),
        (kernel.address, 8, (("q", m.nq, None),), ((m.nv, m.nv),), pre, kernel),
        (kernel.address, 8, (("q", m.nq, None, (m.nq - 3,)),), ((m.nv, m.nv),), pre, kernel),
        (kernel.address, 8, (("q", m.nq, None, (-1,)),), ((m.nv, m.nv),), pre, kernel),
        (kernel.address, 8, (("q", m.nq, None, ("first",)),), ((m.nv, m.nv),), pre, kernel),
        (kernel.address, 8, inputs, (("one",),), pre, kernel),
        ("address", 8, inputs, ((m.nv, m.nv),), pre, kernel),
    ):
        with pytest.raises((TypeError, ValueError)):
            call_type(*wrong)
    call = call_type(kernel.address, kernel.work + 1, inputs, ((m.nv, m.nv),), pre, kernel)
    for arguments in ((), ({}, {}), ([],)):
        with pytest.raises(TypeError, match="one dict of inputs"):
            call(*arguments)
    with pytest.raises(TypeError, match="one dict of inputs"):
        call(q=np.zeros(m.nq))


def test_no_function_has_more_inputs_than_it_holds() -> None:
    most = max(len(function.inputs) for function in FUNCTIONS.values())
    assert most <= native_number("interop/symofros_call.c", "SYM_MOST_INPUTS")


def test_calls_work_without_python_headers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sysconfig, "get_paths", lambda: {"include": str(tmp_path)})
    assert extension.module.__wrapped__() is None


def test_an_extension_that_does_not_compile_is_reported_and_skipped(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "Python.h").write_text("#error other headers\n")
    monkeypatch.setattr(sysconfig, "get_paths", lambda: {"include": str(tmp_path)})
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    with caplog.at_level("INFO", "symofros"):
        assert extension.module.__wrapped__() is None
    assert "plain calls go through NumPy" in caplog.text and "other headers" in caplog.text
