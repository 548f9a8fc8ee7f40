"""The cache: content-keyed, safe under concurrency and killed compilations; fallbacks that say so."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from symofros.runtime.build import build, toolchain
from symofros.runtime.build.build import pieces
from symofros.runtime.build.cache import install
from symofros.runtime.build.toolchain import find_toolchain
from tests.late import SHELL, require

SCRIPT = """
import sys, numpy as np, symofros as sf
from reference_models.rigid.random_tree import random_tree
m = sf.compile(random_tree(31))
print(repr(float(m.mass_matrix(m.neutral()).sum())))
"""


def compiled(system: sf.System, options: sf.Options | None = None) -> sf.Model:
    """A model with one function that is made: the options', or the mass matrix."""
    model = sf.compile(system, options)
    if options is None or options.functions is None:
        model.prepare("mass_matrix")
    return model


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def libraries(cache: Path) -> list[Path]:
    """Libraries of models; the extension for plain calls is built beside them, by whichever process calls first."""
    return sorted(path for path in cache.glob("*.so") if "PyInit_" not in path.with_suffix(".c").read_text())


def test_concurrent_processes_agree(cache: Path) -> None:
    root = Path(__file__).parents[3]
    started = [
        subprocess.Popen([sys.executable, "-c", SCRIPT], cwd=root, stdout=subprocess.PIPE, text=True) for _ in range(4)
    ]
    printed = {process.communicate(timeout=120)[0] for process in started}
    assert len(printed) == 1 and printed != {""}
    assert len(libraries(cache)) == 1


def test_a_killed_compilation_leaves_nothing_broken(cache: Path, tmp_path: Path) -> None:
    slow = tmp_path / "slowcc"
    slow.write_text(SHELL + 'case "$*" in *--version*) echo slow;; *) touch started; sleep 60;; esac\n')
    slow.chmod(0o755)
    root = Path(__file__).parents[3]
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT], cwd=root, env={**os.environ, "CC": str(slow)}, start_new_session=True
    )
    deadline = time.monotonic() + 60
    while not list(cache.glob(".*/started")) and time.monotonic() < deadline:
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    assert list(cache.glob(".*/started")), "the compilation was under way"
    assert not libraries(cache)
    m = compiled(random_tree(31))
    assert np.isfinite(m.mass_matrix(m.neutral())).all()


def test_a_library_that_does_not_load_is_named(cache: Path) -> None:
    compiled(random_tree(31))
    (library,) = libraries(cache)
    library.unlink()
    (cache / "text").write_bytes(b"whole, but not a library")
    install(cache / "text", library)
    # In a new process: this one has the good library mapped under that name.
    root = Path(__file__).parents[3]
    done = subprocess.run([sys.executable, "-c", SCRIPT], cwd=root, capture_output=True, text=True)
    assert "CompileError: the compiled model does not load" in done.stderr
    assert f"remedy: delete {library.name}" in done.stderr


def test_an_unwritable_cache_is_explained(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("SYMOFROS_CACHE", str(blocked / "cache"))
    with pytest.raises(sf.CompileError, match="SYMOFROS_CACHE"):
        compiled(random_tree(31))


@pytest.fixture
def without_compilers(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(toolchain.shutil, "which", lambda name: None)
    find_toolchain.cache_clear()
    return monkeypatch


def test_without_a_compiler_the_interpreter_is_used(
    cache: Path, without_compilers: pytest.MonkeyPatch, rng: np.random.Generator
) -> None:
    without_compilers.setattr(toolchain.importlib.util, "find_spec", lambda name: None)
    try:
        with pytest.warns(sf.CompilerMissingWarning, match="by NumPy"):
            m = compiled(random_tree(31))
        assert np.isfinite(m.mass_matrix(m.random_state(rng)[0])).all()
        assert not cache.exists()
    finally:
        find_toolchain.cache_clear()


@pytest.mark.slow(minutes=2)
def test_the_ziglang_package_is_used_as_compiler(
    cache: Path, without_compilers: pytest.MonkeyPatch, rng: np.random.Generator
) -> None:
    require("ziglang", "zig")
    try:
        with pytest.warns(sf.CompilerMissingWarning, match="ziglang"):
            m = compiled(random_tree(33))
        q = m.random_state(rng)[0]
        twin = compiled(random_tree(33), sf.Options(backend="interpreter"))
        np.testing.assert_allclose(m.mass_matrix(q), twin.mass_matrix(q), atol=1e-13)
    finally:
        find_toolchain.cache_clear()


HEAD = """#define SYM_NOINLINE __attribute__((noinline))
static inline double twice(double x) {
    return 2.0 * x;
}
"""
CHUNK = """static SYM_NOINLINE void part_{0}(const double *restrict q, double *restrict y) {{
    if (q[0] > 0.0) {{
        y[{0}] = twice(q[0]) + {0}.0;
    }}
}}
"""
CALLER = """__attribute__((visibility("default"))) void whole(const double *q, double *y) {{
{calls}
}}
"""


def source(chunks: int, between: str = "") -> str:
    calls = "\n".join(f"    part_{i}(q, y);" for i in range(chunks))
    return HEAD + between.join(CHUNK.format(i) for i in range(chunks)) + CALLER.format(calls=calls)


@pytest.mark.parametrize("count", [2, 3])
def test_each_chunk_is_defined_in_one_piece_and_declared_in_the_first(count: int) -> None:
    parts = pieces(source(13), count)
    assert len(parts) == count
    for i in range(13):
        head = f"SYM_NOINLINE void part_{i}(const double *restrict q, double *restrict y)"
        assert sum(f"{head} {{" in part for part in parts) == 1
        assert f"{head};" in parts[0] or f"static {head} {{" in parts[0]
    assert all(part.startswith(HEAD) for part in parts)
    assert sum("void whole(" in part for part in parts) == 1


@pytest.mark.parametrize("text", [source(7), source(13, "#if 1\n#endif\n"), HEAD])
def test_a_short_file_or_one_with_conditions_between_its_chunks_stays_whole(text: str) -> None:
    assert pieces(text, 8) == [text]


@pytest.mark.parametrize("flags", [("-O1",), ("-O1", "-ffast-math")])
def test_a_library_in_pieces_computes_what_all_chunks_do(
    flags: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    toolchain = find_toolchain()
    assert toolchain is not None
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(build, "usable_processors", lambda: 3)
    library = ctypes.CDLL(str(build.build_library(source(13), "", toolchain, flags)))
    q, y = (ctypes.c_double * 1)(1.5), (ctypes.c_double * 13)()
    library.whole(q, y)
    assert list(y) == [3.0 + i for i in range(13)]


def test_a_piece_that_does_not_compile_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    toolchain = find_toolchain()
    assert toolchain is not None
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(build, "usable_processors", lambda: 3)
    wrong = source(13).replace("y[12] = twice", "y[12] = thrice")
    with pytest.raises(sf.CompileError, match="thrice"):
        build.build_library(wrong, "", toolchain, ("-O1", "-Werror"))
    assert not list((tmp_path / "cache").glob("*.so"))
