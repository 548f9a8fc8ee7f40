"""Calling the C compiler on what an export consists of."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from symofros.errors import CompileError
from symofros.runtime.build import NO_COMPILER, call_compiler, find_toolchain

# No -march=native: what is exported runs on other machines of the kind.
FLAGS = ("-O2", "-fno-math-errno", "-std=c99", "-fPIC", "-shared", "-fvisibility=hidden")


def shared_library(
    files: Mapping[str, str], main: Sequence[str], include: Sequence[Path], flags: Sequence[str] = ()
) -> bytes:
    """The library of C files, which may include the others.

    Args:
        files: File name -> text.
        main: Names of the source files to compile.
        include: Folders of further headers.
        flags: Further flags.

    Raises:
        CompileError: There is no compiler, or it failed; with its command and messages.
    """
    toolchain = find_toolchain(None)
    if toolchain is None:
        raise CompileError(NO_COMPILER)
    with tempfile.TemporaryDirectory(prefix="symofros-export-") as private:
        for name, text in files.items():
            (Path(private) / name).write_text(text, encoding="utf-8")
        folders = [f"-I{folder}" for folder in include]
        command = [*toolchain.command, *FLAGS, *flags, *folders, *main, "-lm"]
        call_compiler(command, "library", Path(private), "check $CC and the compiler")
        return (Path(private) / "library").read_bytes()
