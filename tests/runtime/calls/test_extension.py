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
from symofros.runtime.calls.library import MANY
from symofros.runtime.calls.plain import PlainCall, plain_call
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
def forward(m: sf.Model, call_type: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[PlainCall]:
    """M, h and Q by the extension."""
    monkeypatch.setattr("symofros.runtime.calls.plain.call_type", lambda _: call_type)
    call = plain_call(
        m.kernel("dynamics"), m.parameter_values, np.zeros(m.nu), m.record.quaternions, m._forget_plain_calls
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
    while type(m._plain_calls.prepared.get("mass_matrix")) is not call_type:
        assert time.monotonic() < end
        time.sleep(0.01)
        m.mass_matrix(q)
    assert np.array_equal(before, m.mass_matrix(q))


def test_inputs_and_dictionaries_are_released(forward: PlainCall, m: sf.Model) -> None:
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


def arguments(m: sf.Model, **changed: Any) -> tuple[Any, ...]:
    """What the type is called with to make the plain call of M."""
    kernel = callable_from_c(m.kernel("mass_matrix"))
    stated = {
        "functions": (kernel.address, kernel.batch_address, kernel.work + 1, kernel.for_many, 1 << 40),
        "inputs": (("q", m.nq, None, m.record.quaternions["q"]),),
        "outputs": (("M", (m.nv, m.nv)),),
        "pre": kernel.prepare(m.parameter_values[None]),
        "kept": kernel,
    }
    return tuple((stated | changed).values())


def test_calls_and_objects_leave_no_memory_behind(forward: PlainCall, m: sf.Model, call_type: Any) -> None:
    given = state(m)
    many = {group: x if group in ("u", "t") else np.tile(x, (MANY, 1)) for group, x in given.items()}
    out = {"M": np.zeros((MANY, m.nv, m.nv))}

    def work() -> None:
        for _ in range(200):
            forward(given)
            forward(many, out)
            forward(many, {"M": given["q"]})
            made = call_type(*arguments(m))
            made({"q": given["q"]})
            made({"q": many["q"]}, out)

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
        ("v", np.zeros((0, 99))),
        ("v", np.float64(1.0)),
        ("t", 0),
        ("t", np.zeros(0)),
        ("t", np.zeros((2, 1))),
        ("u", np.zeros(0, np.float32)),
        *(("q", kind) for kind in (">f8", np.float32, object, np.int64)),
    ],
)
def test_unusual_calls_fall_back_to_python(forward: PlainCall, m: sf.Model, group: str, value: Any) -> None:
    given = state(m)
    is_kind = isinstance(value, str | type)  # The right numbers, of another kind.
    assert forward(given | {group: given[group].astype(value) if is_kind else value}) is None


def test_inputs_may_have_any_strides(forward: PlainCall, m: sf.Model) -> None:
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


@pytest.mark.parametrize("n", [1, 2, MANY - 1, MANY, MANY + 3])
def test_batches_have_the_bits_of_the_general_way(forward: PlainCall, m: sf.Model, n: int, rng: Any) -> None:
    """Each input of one state, of a batch of one, or of n; results fresh, or where they are wanted."""
    q, v = (np.array(x) for x in zip(*(m.random_state(rng) for _ in range(n)), strict=True))
    u = rng.normal(size=(n, m.nu))
    given = {"q": q, "v": v, "u": u, "t": rng.normal(size=n)}
    for pattern in range(16):
        same = {group for k, group in enumerate(given) if pattern >> k & 1}
        inputs = {group: (x[0].item() if group == "t" else x[:1]) if group in same else x for group, x in given.items()}
        expected = m._call_batch("dynamics", "", inputs, m.parameter_values)
        found = forward(inputs)
        assert found is not None
        out = {"h": np.full(found[1].shape, np.nan)}
        again = forward(inputs, out)
        assert again is not None and again[1] is out["h"]
        for x, y, z in zip(found, again, expected, strict=True):
            assert x.shape == y.shape == z.shape and x.tobytes() == y.tobytes() == z.tobytes()


def test_receivers_that_do_not_fit_or_overlap_fall_back_to_python(forward: PlainCall, m: sf.Model) -> None:
    given = state(m) | {"u": np.zeros(m.nu)}
    room = np.zeros(m.nv * (m.nv + 2))
    fitting = room[: m.nv]
    read_only = fitting.view()
    read_only.flags.writeable = False
    assert forward(given, {"h": fitting, "Q": room[m.nv : 2 * m.nv]}) is not None
    for out in (
        {"M": given["v"]},
        {"h": given["v"]},
        {"h": fitting, "Q": fitting},
        {"h": fitting, "M": room[1 : 1 + m.nv**2].reshape(m.nv, m.nv)},
        {"h": fitting, "acceleration": fitting},
        {"h": read_only},
        {"h": np.zeros((1, m.nv))},
        {"h": np.zeros(m.nv, np.float32)},
        {"h": np.zeros(2 * m.nv)[::2]},
        {"h": [0.0] * m.nv},
        [fitting],
    ):
        assert forward(given, out) is None, out
    tall = np.zeros((3, m.nv))
    batch = given | {"v": tall}
    assert forward(batch, {"h": tall}) is None and forward(batch, {"h": np.zeros((3, m.nv))}) is not None


def test_batches_that_threads_share_or_that_do_not_broadcast_fall_back_to_python(call_type: Any, m: sf.Model) -> None:
    functions = (*arguments(m)[0][:4], 7)
    call = call_type(*arguments(m, functions=functions))
    q = np.tile(state(m)["q"], (8, 1))
    assert call({"q": q}) is None and call({"q": q[:7]}) is not None
    assert call({"q": np.asfortranarray(q[:7])}) is None and call({"q": q[None, :7]}) is None
    forward = m._plain("dynamics", "")
    assert forward({"q": q[:3], "v": np.zeros((2, m.nv)), "u": None, "t": 0.0}) is None


def test_a_call_within_a_call_changes_nothing(
    call_type: Any, m: sf.Model, monkeypatch: pytest.MonkeyPatch, rng: np.random.Generator
) -> None:
    """While the code by vectors is compiled, a handler of a signal may call the same function."""
    kernel: Any = m.kernel("dynamics")
    within = list[Any]()
    of_many = type(kernel).for_many

    def for_many(of: Any) -> Any:
        within.append(call({group: x if group == "t" else x[7:14] for group, x in given.items()}))
        return of_many(of)

    monkeypatch.setattr("symofros.runtime.calls.plain.call_type", lambda _: call_type)
    monkeypatch.setattr(type(kernel), "for_many", for_many)
    call = plain_call(kernel, m.parameter_values, np.zeros(m.nu), m.record.quaternions, m._forget_plain_calls)
    q, _ = m.random_state(rng)
    v, u = rng.uniform(-1.0, 1.0, (MANY, m.nv)), rng.uniform(-1.0, 1.0, (MANY, m.nu))
    given: dict[str, Any] = {"q": np.tile(q, (MANY, 1)), "v": v, "u": u, "t": 0.0}
    results = call(given)
    assert within == [None] and results is not None
    for result, again in zip(results, call(given) or (), strict=True):
        np.testing.assert_array_equal(result, again)
    assert len(within) == 1


def test_quaternions_of_batches_are_judged_in_each_state(forward: PlainCall, m: sf.Model) -> None:
    (first,) = m.record.quaternions["q"][:1]
    given = state(m) | {"q": np.tile(state(m)["q"], (5, 1))}
    assert forward(given) is not None
    for k in range(5):
        turned = given["q"].copy()
        turned[k, first] += 0.1
        assert forward(given | {"q": turned}) is None


def test_arguments_of_the_extension_are_checked(call_type: Any, m: sf.Model) -> None:
    functions, inputs, outputs, *_ = arguments(m)
    for wrong in (
        {"functions": (*functions[:2], 0, *functions[3:])},
        {"functions": ("address", *functions[1:])},
        {"functions": functions[:4]},
        {"inputs": inputs * 17},
        {"inputs": (("q", m.nq, None),)},
        *({"inputs": (("q", m.nq, None, (first,)),)} for first in (m.nq - 3, -1, "first")),
        *({"outputs": (("M", shape),)} for shape in ((1, 1, 1), ("one",), 1)),
        {"outputs": ((1, (1,)),)},
    ):
        with pytest.raises((TypeError, ValueError)):
            call_type(*arguments(m, **wrong))
    call = call_type(*arguments(m))
    for given in ((), ([],), ({}, {}, {})):
        with pytest.raises(TypeError, match="one dict of inputs"):
            call(*given)
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
