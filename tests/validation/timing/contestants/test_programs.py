"""Compilers are found, told apart, and asked once for each program."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from validation.timing.contestants import engines
from validation.timing.contestants.programs import BuildError, Built, Compiler, build, compilers


def test_a_compiler_that_fails_is_told_and_the_other_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def only_clang(compiler: Compiler, *rest: object) -> Built:
        if compiler.name.startswith("gcc"):
            raise BuildError("out of memory")
        return Built(Path("side.so"), 1.0, 1, 1)

    both = [Compiler("g++", "gcc 12", ""), Compiler("clang++", "clang 19", "")]
    monkeypatch.setattr(engines, "compilers", lambda language: both)
    monkeypatch.setattr(engines, "build", only_clang)
    monkeypatch.setattr(engines, "_includes", list)  # The headers are an extra.
    builds, failures = engines.pinocchio_builds()
    assert [compiler.name for compiler, _ in builds] == ["clang 19"]
    assert failures == ["Pinocchio by gcc 12: out of memory"]


def test_a_program_is_compiled_once_for_its_content_and_anew_where_it_was_damaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    compiler, text = compilers()[0], '__attribute__((visibility("default"))) double f(double x) { return 3.5 * x; }\n'
    told: list[str] = []
    first, again = (build(compiler, {"f.c": text}, ("-O2",), say=told.append) for _ in range(2))
    assert told == [f"compiling f.c by {compiler.name}"]
    first.path.write_bytes(first.path.read_bytes()[:-1])
    build(compiler, {"f.c": text}, ("-O2",), say=told.append)
    assert len(told) == 2
    other = build(compiler, {"f.c": text}, ("-O3",))
    assert first == again and other.path != first.path
    assert first.seconds > 0
    if shutil.which("size"):  # Which tells sizes, where it is.
        assert first.text > 0 and first.constants >= 8
