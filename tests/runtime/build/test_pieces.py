"""Long C files in pieces: every chunk in one of them, the library that of the whole file."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest

import symofros as sf
from symofros.runtime.build import build
from symofros.runtime.build.pieces import pieces
from symofros.runtime.build.toolchain import find_toolchain

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
