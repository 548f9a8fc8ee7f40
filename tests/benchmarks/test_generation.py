"""How long a model takes from description to C text, to a library; how many operations it has."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import symofros as sf
from reference_models import MODELS
from reference_models.rigid.chain import chain
from symofros.compiler import Compilation
from symofros.generator.passes.count import count_program
from tests.models import sampled

FUNCTIONS = ("mass_matrix", "bias")


@pytest.mark.parametrize("links", sampled((7, 22, 52), [7]))
def test_time_from_description_to_c_text(benchmark: BenchmarkFixture, links: int) -> None:
    benchmark.extra_info["bytes"] = len(benchmark(_text, chain(links)))


@pytest.mark.parametrize("model", sampled(("mss", "flexible_arm", "flexible_mss"), ["mss"]))
def test_time_from_reference_model_to_c_text(benchmark: BenchmarkFixture, model: str) -> None:
    benchmark.extra_info["bytes"] = len(benchmark.pedantic(_text, args=(MODELS[model],), rounds=3))


def _text(system: sf.System) -> str:
    return Compilation(system, sf.Options(functions=FUNCTIONS)).source()


@pytest.mark.parametrize("model", sampled(("chain7", "chain22", "mss", "flexible_arm"), ["chain7"]))
def test_time_of_generation_and_compilation_without_cache(
    benchmark: BenchmarkFixture, model: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From description to loaded library, nothing cached."""
    system, run = MODELS[model], iter(range(10**6))

    def compile_anew() -> sf.Model:
        monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / str(next(run))))
        return sf.compile(system, sf.Options(functions=FUNCTIONS))

    benchmark.pedantic(compile_anew, rounds=3)


@pytest.mark.parametrize(
    "model",
    sampled(
        ("rx90", "chain7", "chain22", "chain52", "mss", "planar_robot", "flexible_arm", "flexible_mss"),
        ("rx90", "planar_robot"),
    ),
)
def test_counts_of_operations(benchmark: BenchmarkFixture, model: str) -> None:
    system = chain(52) if model == "chain52" else MODELS[model]
    functions = ("mass_matrix", "bias", "inverse_dynamics", "forward_dynamics")
    program = benchmark.pedantic(sf.program_of, args=(system, functions), rounds=1)
    for (name, _), count in count_program(program).items():
        benchmark.extra_info[name] = str(count)
        print(f"{model:<12} {name:<17} {count}")


@pytest.mark.parametrize("functions", [pytest.param(4, marks=pytest.mark.slow), 1])
def test_time_to_first_modes_of_beams_with_many_functions(
    benchmark: BenchmarkFixture, functions: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three beams in series that keep every term: description, rest, modes, nothing cached; 36 elastic coordinates."""
    counts = {"bend_y": functions, "bend_z": functions, "twist": functions}
    stiffness = {"EI_z": 3e3, "EI_y": 5e3, "GJ": 2e3, "rhoJ": 0.04}
    beams = [
        sf.Beam(
            f"b{k}",
            sf.Joint(f"q{k}", "revolute", *((f"b{k - 1}", "tip") if k else ("world", None)), axis=(0, 1, 0)),
            1.0,
            2.0,
            retain="all",
            **stiffness,
            **counts,
        )
        for k in range(3)
    ]
    system, run = sf.System("chain", tuple(beams)), iter(range(10**6))

    def made_anew() -> None:
        monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / str(next(run))))
        started, model = time.process_time(), sf.compile(system)
        compiled, q = time.process_time(), sf.equilibrium(model, {"q0": 1.5}).q
        rested = time.process_time()
        sf.modes(model, q)
        seconds = (compiled - started, rested - compiled, time.process_time() - rested)
        print("processor time of Python: compile {:.2f}, equilibrium {:.2f}, modes {:.2f} s".format(*seconds))

    benchmark.pedantic(made_anew, rounds=1)
