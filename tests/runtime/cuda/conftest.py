"""A driver whose processor is the host, and a model on it."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from symofros.runtime.cuda import cuda_model
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.cuda.driver import Driver
from tests.cuda_on_host import on_host
from tests.models import model

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def device(tmp_path_factory: pytest.TempPathFactory) -> Driver:
    library = tmp_path_factory.mktemp("driver") / "libcuda.so.1"
    subprocess.run(["gcc", "-shared", "-fPIC", HERE / "driver_on_host.c", "-o", library, "-ldl"], check=True)
    return Driver(ctypes.CDLL(str(library)))


@pytest.fixture(scope="module")
def on_device(device: Driver, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CudaModel]:
    """The double pendulum, its kernels compiled as C++."""
    folder = tmp_path_factory.mktemp("kernels")

    def compiled(text: str, architecture: str, contract: bool) -> bytes:
        assert architecture == "sm_90"
        code = next(code for code in gpu._codes.values() if code.text == text)
        place = folder / code.kernels[0].symbol
        place.mkdir()
        return str(on_host(code, place)).encode() + b"\0"

    patch = pytest.MonkeyPatch()
    patch.setattr(cuda_model, "driver", lambda: device)
    patch.setattr(cuda_model, "compile_cuda", compiled)
    gpu = model("double_pendulum").cuda()
    gpu.evaluate("dynamics", q=np.zeros((1, 2)), v=np.zeros((1, 2)))
    yield gpu
    patch.undo()
