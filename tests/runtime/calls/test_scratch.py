"""No function writes beyond the scratch that it asks for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.runtime.calls.library import CompiledKernel
from tests.models import sampled

# Functions that routines in C complete, whose scratch the generated parts share.
SOLVED = ("forward_dynamics", "project", "forward_dynamics_derivatives", "forward_dynamics_vjp")
# Doubles behind the scratch, and what they hold.
GUARD, UNTOUCHED = 4096, 4.25e-17


@pytest.mark.parametrize("constraints", ["multipliers", "null_space"])
@pytest.mark.parametrize("name", sampled(("four_bar", "bricard", "stewart", "slider_crank"), ("four_bar", "bricard")))
def test_kernels_do_not_write_beyond_their_scratch_memory(
    name: str, constraints: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    arrays = []

    def guarded(kernel: CompiledKernel) -> Any:
        array = np.full(max(1, kernel.work) + GUARD, UNTOUCHED)
        arrays.append((kernel, array))
        return kernel._unit.ffi.from_buffer("double[]", array)

    monkeypatch.setattr(CompiledKernel, "_work", guarded)
    model = sf.compile(MODELS[name], sf.Options(constraints=constraints))
    rng = np.random.default_rng(0)
    for function in SOLVED:
        kernel = model.kernel(function)
        stated = {"q": model.random_state(rng)[0][None], "t": np.zeros((1, 1))}
        inputs = [stated.get(name, rng.uniform(-1, 1, (1, size))) for name, size in kernel.signature.inputs]
        kernel.run(1, kernel.prepare(model.parameter_values[None]), inputs)
    assert arrays
    for kernel, array in arrays:
        assert np.all(array[kernel.work :] == UNTOUCHED), kernel
