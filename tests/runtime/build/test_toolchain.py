"""Compilers that are none, write nothing, or never end: each is reported in four parts."""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import symofros as sf
from symofros.base.threads import ending_together, submit
from symofros.errors import Problem
from symofros.runtime.build import toolchain
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import GCC_FLAGS, call_compiler, find_toolchain
from tests.late import SHELL


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    find_toolchain.cache_clear()
    yield tmp_path / "cache"
    find_toolchain.cache_clear()


def script(folder: Path, text: str) -> Path:
    path = folder / "compiler"
    path.write_text(text)
    path.chmod(0o755)
    return path


def refused() -> Problem:
    """What is said of the compiler of the environment when a library is built."""
    with pytest.raises(sf.CompileError) as caught:
        named = find_toolchain()
        assert named is not None
        build_library("int x;\n", "", named)
    problem = caught.value.problem
    assert problem.what and problem.found and problem.rule and problem.remedy
    return problem


@pytest.mark.parametrize(
    ("stated", "what"),
    [
        ("   ", "names no compiler"),
        ("''", "names no compiler"),
        ("gcc '", "can't be read: No closing quotation"),
        ("/bin/true", "wrote nothing"),
        ("/bin/false", "failed with status 1"),
        ("nosuchcc -m64", "was not found"),
    ],
)
def test_a_compiler_that_does_not_work_is_reported(
    monkeypatch: pytest.MonkeyPatch, stated: str, what: str, cache: Path
) -> None:
    monkeypatch.setenv("CC", stated)
    assert what in refused().what
    assert not list(cache.glob("*.so"))


def test_flags_of_the_environment_follow_the_default_ones(monkeypatch: pytest.MonkeyPatch, cache: Path) -> None:
    monkeypatch.delenv("SYMOFROS_CFLAGS", raising=False)  # What a plain run of the tests states.
    named = find_toolchain()
    assert named is not None
    text = """
        #ifndef __OPTIMIZE__
        #define __OPTIMIZE__ 0
        #endif
        #ifndef VALUE
        #define VALUE 0
        #endif
        __attribute__((visibility("default"))) int compiled(void) { return 2 * (VALUE) + __OPTIMIZE__; }
    """

    def value(flags: tuple[str, ...] | None = None) -> int:
        result: int = ctypes.CDLL(str(build_library(text, "", named, flags))).compiled()
        return result

    assert value() == 1
    monkeypatch.setenv("SYMOFROS_CFLAGS", "-O0 '-DVALUE=1 + 1'")
    assert value() == 4
    assert value(("-O2",)) == 1  # Flags that are stated for a model are all that it is compiled with.
    monkeypatch.setenv("SYMOFROS_CFLAGS", "-O0 '")
    problem = refused()
    assert problem.what.startswith("$SYMOFROS_CFLAGS can't be read") and problem.found == '"-O0 \'"'


@pytest.mark.parametrize(
    ("says", "gcc", "flags"),
    [
        ("cc (Debian 12.2.0-14) 12.2.0\nCopyright (C) 2022 Free Software Foundation, Inc.", 12, GCC_FLAGS),
        ("gcc (GCC) 8.5.0 20210514 (Red Hat 8.5.0-4)\nCopyright (C) 2018 Free Software Foundation", 8, GCC_FLAGS),
        ("gcc (Ubuntu 7.5.0-3ubuntu1) 7.5.0\nCopyright (C) 2017 Free Software Foundation, Inc.", 7, ()),
        ("Debian clang version 19.1.7\nTarget: x86_64-pc-linux-gnu", 0, ()),
        ("clang version 20.1.2 (https://github.com/ziglang/zig-bootstrap)", 0, ()),
    ],
)
def test_flags_of_gcc_are_given_to_gcc_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, cache: Path, says: str, gcc: int, flags: tuple[str, ...]
) -> None:
    """A compiler that writes down its arguments."""
    reported = tmp_path / "reported"
    answers = (
        f'case "$*" in *--version*) echo "{says}";; *) echo "$*" >> {reported}; for x; do :; done; echo > "$x";; esac'
    )
    monkeypatch.setenv("CC", str(script(tmp_path, SHELL + f"{answers}\n")))
    monkeypatch.delenv("SYMOFROS_CFLAGS", raising=False)
    named = find_toolchain()
    assert named is not None and named.gcc == gcc
    build_library("int x;\n", "", named)
    build_library("int z;\n", "", named, flags=("-O1",))
    calls = [set(GCC_FLAGS) & set(line.split()) for line in reported.read_text().splitlines()]
    assert calls == [set(flags), set()]  # The default flags, and those that a model states.


# The child of the script keeps its output open, as cc1 does of gcc.
@pytest.mark.parametrize("hangs", ["sleep 20", 'case "$*" in *--version*) echo slow;; *) sleep 20;; esac'])
def test_a_hanging_compiler_is_reported(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, hangs: str) -> None:
    monkeypatch.setattr(toolchain, "VERSION_LIMIT", 0.3)
    monkeypatch.setattr(toolchain, "COMPILATION_LIMIT", 0.3)
    monkeypatch.setenv("CC", str(script(tmp_path, SHELL + f"{hangs}\n")))
    assert "did not end within 0.3 s" in refused().what


def test_a_compiler_does_not_wait_for_input(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(
        "CC",
        str(script(tmp_path, SHELL + 'case "$*" in *--version*) ;; *) exec cat;; esac\n')),
    )
    assert "wrote nothing" in refused().what


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_children_of_a_stopped_compiler_are_stopped(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """As a driver's own compiler, which would go on computing."""
    monkeypatch.setattr(toolchain, "COMPILATION_LIMIT", 0.5)
    started = tmp_path / "started"
    driver = script(tmp_path, SHELL + f"sleep 60 & echo $! > {started}\nwait\n")
    with pytest.raises(sf.CompileError, match="did not end within"):
        toolchain.call_compiler([str(driver)], "out", tmp_path, "another compiler")
    child = int(started.read_text())
    for _ in range(100):
        state = Path(f"/proc/{child}/stat")
        if not state.exists() or state.read_text().split()[2] == "Z":
            return
        time.sleep(0.02)
    pytest.fail("it runs on")


def test_compilers_in_other_threads_end_with_an_interrupt(tmp_path: Path) -> None:
    """Ctrl-C in the first run on a machine waited for the compiler of the integrator."""
    compiler = [sys.executable, "-c", f"import time; open({str(tmp_path / 'began')!r}, 'w'); time.sleep(100)"]
    start = time.perf_counter()
    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt), ending_together():
        called = submit(pool, call_compiler, compiler, "none", tmp_path, "")
        while not (tmp_path / "began").exists():
            time.sleep(0.01)
        raise KeyboardInterrupt
    assert time.perf_counter() - start < 50.0 and isinstance(called.exception(), sf.CompileError)
