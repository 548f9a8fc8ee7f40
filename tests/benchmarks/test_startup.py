"""What a user waits for before the first number: importing, reading, generating and compiling, loading what is known.

Each round of the first three is a new interpreter. The machine's C compiler and its disk cache decide most of it.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from validation.inputs.cases import named

# Of a 7-joint arm with its two fingers. "M and h" is one C file; the others are those that a first call makes.
ALONE = "dynamics mass_matrix bias generalized_force forward_dynamics inverse_dynamics"
FUNCTIONS = (
    ("mass_matrix", "bias"),
    *((name,) for name in f"{ALONE} kinetic_energy potential_energy frame_pose frame_jacobian".split()),
)


@pytest.fixture(scope="module")
def panda() -> sf.System:
    return named(["panda"])[0].load().system


@pytest.fixture(scope="module")
def file(panda: sf.System, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("models") / "panda.yaml"
    sf.save(panda, path)
    return path


@pytest.mark.parametrize(
    "code",
    [
        pytest.param("import numpy", id="numpy"),
        pytest.param("import symofros", id="symofros"),
        pytest.param("import symofros; symofros.load", id="to_read"),
        pytest.param("import symofros; symofros.compile", id="to_compile"),
    ],
)
def test_time_of_import(benchmark: BenchmarkFixture, code: str) -> None:
    benchmark.pedantic(subprocess.run, args=([sys.executable, "-c", code],), rounds=5)


@pytest.mark.parametrize("functions", FUNCTIONS, ids="+".join)
def test_time_of_generation_and_compilation(
    benchmark: BenchmarkFixture,
    panda: sf.System,
    functions: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing cached; frame functions of one frame."""
    run = iter(range(10**6))
    last = (panda.bodies[-1].name,)
    options = sf.Options(functions, last if functions[0].startswith("frame") else None)

    def compile_anew() -> sf.Model:
        monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / str(next(run))))
        return sf.compile(panda, options)

    assert benchmark.pedantic(compile_anew, rounds=5).nq == 9


def test_time_of_reading_a_description(benchmark: BenchmarkFixture, file: Path) -> None:
    benchmark.extra_info["bytes"] = file.stat().st_size
    assert len(benchmark(sf.load, file).bodies) > 7


def test_time_of_loading_a_cached_model(benchmark: BenchmarkFixture, panda: sf.System) -> None:
    options = sf.Options(("mass_matrix", "bias"))
    sf.compile(panda, options)
    assert benchmark(sf.compile, panda, options).nq == 9
