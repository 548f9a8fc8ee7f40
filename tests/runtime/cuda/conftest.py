"""A driver whose processor is the host, and a model on it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.cuda.driver import Driver
from tests.cuda_on_host import compile_on_host, host_driver
from tests.models import model


@pytest.fixture(scope="module")
def device(tmp_path_factory: pytest.TempPathFactory) -> Driver:
    return host_driver(tmp_path_factory.mktemp("driver"))


@pytest.fixture(scope="module")
def on_device(device: Driver, tmp_path_factory: pytest.TempPathFactory) -> Iterator[CudaModel]:
    """The double pendulum, its kernels compiled as C++."""
    with pytest.MonkeyPatch.context() as patch:
        compile_on_host(patch, device, tmp_path_factory.mktemp("kernels"))
        gpu = model("double_pendulum").cuda()
        gpu.evaluate("dynamics", q=np.zeros((1, 2)), v=np.zeros((1, 2)))
        yield gpu
