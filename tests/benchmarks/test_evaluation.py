"""Calls of compiled functions from Python."""

from __future__ import annotations

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from reference_models import MODELS
from tests.models import sampled
from validation.inputs.cases import named

BATCH = 1000


@pytest.mark.parametrize("states", [1, BATCH])
@pytest.mark.parametrize("model", sampled(("double_pendulum", "rx90", "mss"), ("double_pendulum",)))
def test_time_of_dynamics(benchmark: BenchmarkFixture, model: str, states: int) -> None:
    compiled = sf.compile(MODELS[model], sf.Options(functions=("dynamics",)))
    rng = np.random.default_rng(0)
    q, v = (rng.standard_normal((states, n)) for n in (compiled.nq, compiled.nv))
    u = np.zeros((states, compiled.nu))
    M, _, _ = benchmark(compiled.dynamics, q, v, u)
    assert M.shape == (states, compiled.nv, compiled.nv)


def panda() -> sf.Model:
    return sf.compile(named(["panda"])[0].load().system, sf.Options(functions=("mass_matrix",)))


def test_time_of_one_mass_matrix(benchmark: BenchmarkFixture) -> None:
    """The method: arguments of any kind and shape are checked, the result is a new array."""
    model = panda()
    assert benchmark(model.mass_matrix, model.neutral()).shape == (model.nv, model.nv)


@pytest.mark.parametrize("copied", [False, True], ids=["call", "copy_and_call"])
def test_time_of_one_bound_mass_matrix(benchmark: BenchmarkFixture, copied: bool) -> None:
    """On fixed memory; with and without writing a configuration into it."""
    model = panda()
    bound, q = model.bind("mass_matrix"), model.neutral()
    inside = bound.inputs["q"]

    def write_and_call() -> None:
        inside[:] = q
        bound()

    benchmark(write_and_call if copied else bound)
    assert bound.outputs["M"].any()
