"""The fastest build is found once and remembered; what the options state is kept; results agree within rounding."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.compiler import Compilation
from symofros.runtime.build import tuning
from symofros.runtime.build.toolchain import find_toolchain
from symofros.runtime.build.tuning import builds

FUNCTIONS = ("mass_matrix", "forward_dynamics")


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))


def test_results_are_those_of_any_build(rng: np.random.Generator) -> None:
    plain, tuned = (sf.compile(MODELS["rx90"], sf.Options(functions=FUNCTIONS, tune=tune)) for tune in (False, True))
    q, v, u = (rng.uniform(-1.0, 1.0, (7, n)) for n in (plain.nq, plain.nv, plain.nu))
    np.testing.assert_allclose(tuned.mass_matrix(q), plain.mass_matrix(q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(tuned.forward_dynamics(q, v, u), plain.forward_dynamics(q, v, u), rtol=1e-10, atol=1e-10)


def test_the_choice_is_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    options = sf.Options(functions=("mass_matrix",), batch="loop", tune=True)
    chosen = sf.compile_library(MODELS["double_pendulum"], options)

    def measured_again(*_: object) -> Path:
        raise AssertionError("measured again")

    monkeypatch.setattr(tuning, "_measured", measured_again)
    assert sf.compile_library(MODELS["double_pendulum"], options) == chosen


def test_the_fastest_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock by which only the last build takes less time than the others."""
    made: list[Path] = []

    def measured(libraries: dict[Path, None], load: object) -> Path:
        made.extend(libraries)
        return made[-1]

    monkeypatch.setattr(tuning, "_measured", measured)
    path, _ = sf.compile_library(MODELS["rx90"], sf.Options(functions=("mass_matrix",), batch="loop", tune=True))
    assert len(made) >= 2
    assert path == made[-1]


def test_what_is_stated_is_kept() -> None:
    toolchain = find_toolchain()
    assert toolchain is not None
    flags = ("-O1",)
    stated = builds(sf.Options(flags=flags, compiler=toolchain.command[0], packs=False, tune=True), toolchain)
    assert [(build.toolchain, build.flags, build.packs) for build in stated] == [(toolchain, flags, False)]
    free = builds(sf.Options(tune=True), toolchain)
    assert free[0] == tuning.Build(toolchain, None, True)
    assert {build.packs for build in free} == {True, False}


def test_each_compiler_is_tried_once() -> None:
    """cc, gcc and gcc-12 are one compiler; of those with a version in the name the newest counts."""
    toolchain = find_toolchain()
    assert toolchain is not None
    tried = [
        (build.toolchain.identity.split()[-1], build.flags, build.packs)
        for build in builds(sf.Options(tune=True), toolchain)
    ]
    assert len(tried) == len(set(tried))


def test_newest_of_several_versions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("clang", "clang-9", "clang-14", "clang-scan-3", "gcc-12", "clang-tidy"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert tuning._compilers() == ["gcc-12", "clang", "clang-14"]


def test_slower_builds_lose() -> None:
    """Without optimisation, everything takes several times as long."""
    system, stated = MODELS["spdm"], {}
    for flags in (("-O0",), ("-O2",)):
        options = sf.Options(functions=("dynamics",), batch="loop", flags=flags)
        path, symbol = sf.compile_library(system, options)
        stated[path] = symbol, Compilation(system, options).record.hash

    def load(path: Path) -> tuning.CompiledUnit:
        symbol, of = stated[path]
        return tuning.CompiledUnit(path, symbol, of)

    slow, fast = stated
    assert tuning.fastest([slow, fast], load) == fast
