"""Streams that kernels go into and wait for, and graphs, with a driver that tells what it was asked."""

from __future__ import annotations

import ctypes
import sys
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.errors import SymofrosError
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.cuda.driver import Driver
from tests.runtime.cuda.foreign_arrays import STATES, Exchanged, OnDevice, states


class Stream:
    """PyTorch's stream."""

    def __init__(self, handle: int) -> None:
        self.cuda_stream = handle


class Protocol:
    def __cuda_stream__(self) -> tuple[int, int]:
        return 0, 0x30


@pytest.fixture
def said(device: Driver) -> Any:
    """What the driver was asked of streams since the last call."""
    device._library.sym_said.restype = ctypes.c_char_p
    device._library.sym_forget()

    def read() -> list[str]:
        text = device._library.sym_said().decode()
        device._library.sym_forget()
        return [part.strip() for part in text.split(";") if part]

    yield read
    device._library.sym_capture(0)


def test_producers_with_both_interfaces_are_awaited_by_dlpack(on_device: CudaModel) -> None:
    """PyTorch and JAX give an interface without a stream, and DLPack with one."""

    class Both(Exchanged, OnDevice):
        def __init__(self, array: np.ndarray) -> None:
            Exchanged.__init__(self, array)
            OnDevice.__init__(self, array)

    q, v = (Both(x) for x in states(3))
    on_device.evaluate("dynamics", q=q, v=v)
    assert (q.asked, v.asked) == (1, 1)
    on_device.evaluate("dynamics", q=q, v=v, stream=Stream(0x30))
    assert (q.asked, v.asked) == (0x30, 0x30)
    M = Both(np.zeros((3, 2, 2)))
    on_device.evaluate("dynamics", q=q, v=v, out={"M": M}, stream=0x30)
    assert M.asked == 0x30  # What still reads it is waited for, too.


@pytest.mark.parametrize(
    ("stream", "handle"), [(None, "1"), (0, "1"), (1, "1"), (0x30, "30"), (Stream(0x30), "30"), (Protocol(), "30")]
)
def test_kernels_go_into_the_stream_and_wait_for_the_producers(
    on_device: CudaModel, said: Any, stream: Any, handle: str
) -> None:
    q, v = (OnDevice(x) for x in states(3))
    q.__cuda_array_interface__ |= {"stream": 0x40}
    out = {"M": OnDevice(np.zeros((3, 2, 2)))}
    on_device.evaluate("mass_matrix", q=q, out=out, stream=stream)
    said()
    on_device.evaluate("mass_matrix", q=q, out=out, stream=stream)
    asked = said()
    assert asked[:2] == [f"order 40 {handle}", f"launch {handle} 0"]
    assert asked[2:] == ([] if handle == "1" else ["wait 30 0"])


def test_results_name_their_stream(on_device: CudaModel, said: Any, device: Driver) -> None:
    q, v = states(3)
    ready = on_device.evaluate("dynamics", q=q, v=v, stream=0x30)["h"]
    begun = on_device.evaluate("dynamics", q=q, v=v, stream=0x30, wait=False)["h"]
    assert (ready.stream, begun.stream) == (None, 0x30)
    assert begun.__cuda_array_interface__["stream"] == 0x30 and ready.__cuda_array_interface__["stream"] == 1
    said()
    on_device.evaluate("forward_dynamics", q=q, v=v, u=begun)
    assert "order 30 1" in said()
    np.testing.assert_array_equal(begun.numpy(), ready.numpy())
    assert "wait 30 0" in said() and not device._library.sym_events()


@pytest.mark.parametrize("stream", ["x", 2.5, True, -1, object()])
def test_invalid_streams_are_refused(on_device: CudaModel, stream: Any) -> None:
    with pytest.raises(sf.ArgumentError, match="stream is no stream"):
        on_device.evaluate("mass_matrix", q=np.zeros((3, 2)), stream=stream)


def captured(on_device: CudaModel, device: Driver, **changes: Any) -> dict[str, Any]:
    """A call while a graph is captured from stream 0x20."""
    arguments: dict[str, Any] = {
        "q": OnDevice(np.zeros((3, 2))),
        "out": {"M": OnDevice(np.zeros((3, 2, 2)))},
        "wait": False,
        "stream": 0x20,
    }
    on_device.evaluate("mass_matrix", **arguments)
    device._library.sym_capture(1)
    return on_device.evaluate("mass_matrix", **{**arguments, **changes})


def test_graphs_capture_calls_in_their_stream(on_device: CudaModel, device: Driver, said: Any) -> None:
    captured(on_device, device)
    assert said()[-1] == "launch 20 0"


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"wait": True}, "wait=True"),
        ({"out": None}, "out without M"),
        ({"q": np.zeros((3, 2))}, "q lies on the host"),
    ],
)
def test_calls_that_cannot_be_captured_are_refused(
    on_device: CudaModel, device: Driver, said: Any, changes: dict[str, Any], says: str
) -> None:
    with pytest.raises(SymofrosError, match=f"mass_matrix can't be captured in a graph(.|\n)*{says}"):
        captured(on_device, device, **changes)
    assert [entry for entry in said() if entry.startswith("launch")] == ["launch 20 0"]  # That before the capture.


def test_first_calls_and_rollouts_are_not_captured(on_device: CudaModel, device: Driver, said: Any) -> None:
    with pytest.raises(SymofrosError, match="a rollout can't be captured"):
        captured(on_device, device)
        on_device.rollout(**STATES, dt=0.1, steps=2, stream=0x20)
    with pytest.raises(SymofrosError, match="call it once before the capture"):
        on_device.evaluate("kinetic_energy", q=OnDevice(np.zeros((3, 2))), stream=0x20, wait=False)


@pytest.mark.parametrize("stream", [None, 0x30])
def test_a_graph_on_another_stream_is_reported(
    on_device: CudaModel, monkeypatch: pytest.MonkeyPatch, said: Any, stream: Any
) -> None:
    """`with torch.cuda.graph(...)`: the current stream captures, the call went into another one and ran at once."""

    class Torch:
        class cuda:
            is_initialized = is_current_stream_capturing = staticmethod(lambda: True)
            current_stream = staticmethod(lambda: Stream(0x20))

    monkeypatch.setitem(sys.modules, "torch", Torch)
    with pytest.raises(SymofrosError, match=r"captured from another stream(.|\n)*stream=torch.cuda.current_stream\(\)"):
        on_device.evaluate("mass_matrix", q=OnDevice(np.zeros((3, 2))), stream=stream)
    assert not any(entry.startswith("launch") for entry in said())
