"""What a graphics processor alone can show: streams of PyTorch and JAX are waited for, graphs captured and replayed."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.runtime.cuda.cuda_model import CudaModel
from tests.late import require
from tests.models import model

STATES = 1 << 16


@pytest.fixture(scope="module")
def gpu() -> CudaModel:
    try:
        ctypes.CDLL("libcuda.so.1")
    except OSError:
        pytest.skip("needs a graphics processor: there is no driver")
    return model("double_pendulum").cuda()


@pytest.fixture(scope="module")
def torch(gpu: CudaModel) -> Any:
    module = require("torch", "torch")
    if not module.cuda.is_available():
        pytest.skip("needs PyTorch for graphics processors")
    return module


def late_values(torch: Any, stream: Any) -> tuple[Any, np.ndarray]:
    """An array that a stream writes after a tenth of a second, and what it will hold."""
    values = np.random.default_rng(1).uniform(-3, 3, (STATES, 2))
    late, x = torch.tensor(values, device="cuda"), torch.zeros((STATES, 2), dtype=torch.float64, device="cuda")
    torch.cuda.synchronize()
    with torch.cuda.stream(stream):
        torch.cuda._sleep(200_000_000)
        x.copy_(late)
    return x, values


@pytest.mark.parametrize("named", [False, True])
def test_inputs_pending_in_another_stream_are_awaited(gpu: CudaModel, torch: Any, named: bool) -> None:
    stream = torch.cuda.Stream()
    for _ in range(3):
        x, values = late_values(torch, stream)
        with torch.cuda.stream(stream):
            M = gpu.evaluate("mass_matrix", q=x, stream=stream if named else None)["M"]
        np.testing.assert_array_equal(M.numpy(), model("double_pendulum").mass_matrix(values))


def test_pending_jax_computations_are_awaited(gpu: CudaModel) -> None:
    jax = require("jax", "jax")
    if jax.default_backend() != "gpu":
        pytest.skip("needs JAX for graphics processors")
    jax.config.update("jax_enable_x64", True)

    @jax.jit
    def slow(a: Any) -> Any:
        return jax.lax.fori_loop(0, 2000, lambda _, x: x + 1e-4 * jax.numpy.sin(x), a)

    values = np.random.default_rng(2).uniform(-3, 3, (STATES, 2))
    for _ in range(6):
        q = slow(values)
        M = gpu.evaluate("mass_matrix", q=q)["M"].numpy()
        np.testing.assert_array_equal(M, model("double_pendulum").mass_matrix(np.asarray(q)))


def test_a_graph_is_captured_and_replayed(gpu: CudaModel, torch: Any) -> None:
    q = torch.zeros((STATES, 2), dtype=torch.float64, device="cuda")
    out = {"M": torch.full((STATES, 2, 2), np.nan, dtype=torch.float64, device="cuda")}
    gpu.evaluate("mass_matrix", q=q, out=out)
    graph = torch.cuda.CUDAGraph()
    with torch.cuda.graph(graph):
        gpu.evaluate("mass_matrix", q=q, out=out, wait=False, stream=torch.cuda.current_stream())
    values = np.random.default_rng(3).uniform(-3, 3, (STATES, 2))
    q.copy_(torch.tensor(values))
    graph.replay()
    torch.cuda.synchronize()
    np.testing.assert_array_equal(out["M"].cpu().numpy(), model("double_pendulum").mass_matrix(values))


def test_a_call_beside_a_capture_is_refused(gpu: CudaModel, torch: Any) -> None:
    q = torch.zeros((4, 2), dtype=torch.float64, device="cuda")
    out = {"M": torch.zeros((4, 2, 2), dtype=torch.float64, device="cuda")}
    gpu.evaluate("mass_matrix", q=q, out=out)
    with torch.cuda.graph(torch.cuda.CUDAGraph()), pytest.raises(sf.SymofrosError, match="captured from another"):
        gpu.evaluate("mass_matrix", q=q, out=out, wait=False)


def test_tensors_that_require_a_gradient_are_refused(gpu: CudaModel, torch: Any) -> None:
    q = torch.zeros((4, 2), dtype=torch.float64, device="cuda", requires_grad=True)
    with pytest.raises(sf.ShapeError, match="detach"):
        gpu.evaluate("mass_matrix", q=q)
