"""Calls of compiled functions from Python."""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from reference_models import MODELS

BATCH = 1000


@pytest.mark.parametrize("states", [1, BATCH])
@pytest.mark.parametrize("model", ["double_pendulum", "rx90", "mss"])
def test_dynamics(benchmark: BenchmarkFixture, model: str, states: int) -> None:
    compiled = sf.compile(MODELS[model], sf.Options(functions=("dynamics",)))
    rng = np.random.default_rng(0)
    q, v = (rng.standard_normal((states, n)) for n in (compiled.nq, compiled.nv))
    u = np.zeros((states, compiled.nu))
    M, _, _ = benchmark(compiled.dynamics, q, v, u)
    assert M.shape == (states, compiled.nv, compiled.nv)
