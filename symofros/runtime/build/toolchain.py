"""Find a C compiler: the system's, then the `ziglang` package's."""

from __future__ import annotations

import importlib.util
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from symofros.errors import CompileError, Problem

# -fno-math-errno lets sqrt and sincos be instructions and single calls; -ffast-math was measured and gains nothing.
# Packs (generator/codegen/packs.py) share vectors already: the compiler's own search for more costs up to a quarter.
DEFAULT_FLAGS = ("-O2", "-march=native", "-fno-math-errno", "-fno-tree-slp-vectorize")
# Kinds of x86 processors, the best first: name, what it must have, its flags.
KINDS: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...] = (
    (
        "avx512",
        ("avx512f", "avx512dq", "avx512vl", "avx2", "fma"),
        (
            "-mavx512f",
            "-mavx512dq",
            "-mavx512vl",
            "-mavx2",
            "-mfma",
        ),
    ),
    ("avx2", ("avx2", "fma"), ("-mavx2", "-mfma")),
    ("baseline", (), ()),
)
SHARED_FLAGS = ("-shared", "-fPIC", "-fvisibility=hidden", "-std=gnu99")
_SHOWN_LINES = 12

# What is said where C is needed and nothing can compile it.
NO_COMPILER = Problem(
    "no C compiler was found",
    "none of $CC, cc, gcc, clang, nor the package ziglang",
    "generated C is compiled on this machine",
    "install gcc or clang, or `pip install ziglang`",
)


@dataclass(frozen=True)
class Toolchain:
    """A compiler that can be called.

    Attributes:
        command: Program and leading arguments.
        identity: Version as the compiler states it; part of the cache key.
        is_fallback: Whether it is the ziglang package's rather than the system's.
    """

    command: tuple[str, ...]
    identity: str
    is_fallback: bool = False


@cache
def find_toolchain(compiler: str | None = None) -> Toolchain | None:
    """The compiler to use.

    Args:
        compiler: A path or name; None tries $CC, cc, gcc, clang, then the ziglang package.

    Returns:
        None if there is none.

    Raises:
        CompileError: The compiler that was named does not run.
    """
    wanted = compiler or os.environ.get("CC")
    if wanted:
        command = tuple(shlex.split(wanted))
        if shutil.which(command[0]) is None:
            source = "Options(compiler=…)" if compiler else "$CC"
            raise CompileError(
                Problem(
                    f"compiler '{wanted}' ({source}) was not found",
                    command[0],
                    "it is a program on the path",
                    "install it, or leave the choice to us",
                )
            )
        return Toolchain(command, _version(command))
    for name in ("cc", "gcc", "clang"):
        path = shutil.which(name)
        if path is not None:
            return Toolchain((path,), _version((path,)))
    if importlib.util.find_spec("ziglang") is not None:
        command = (sys.executable, "-m", "ziglang", "cc")
        return Toolchain(command, _version(command), is_fallback=True)
    return None


def call_compiler(command: Sequence[str], folder: Path, remedy: str) -> None:
    """Run a compiler in a folder.

    Args:
        command: Command with its arguments.
        folder: Working folder.
        remedy: Remedy to state if it fails.

    Raises:
        CompileError: It refused: with its command and words.
    """
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = "\n".join(f"    {line}" for line in done.stderr.splitlines()[:_SHOWN_LINES])
        what = f"the C compiler failed with status {done.returncode}"
        rule = "the command ends with status 0"
        raise CompileError(Problem(what, f"{' '.join(command)}\n{said}", rule, remedy))


def _version(command: tuple[str, ...]) -> str:
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return f"{' '.join(command)} {done.stdout.splitlines()[0] if done.stdout else ''}"


def kinds() -> tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...]:
    """The kinds of processors that code for any machine of this family is compiled for, the best first."""
    return KINDS if platform.machine().lower() in ("x86_64", "amd64") else KINDS[-1:]


@cache
def cpu_identity() -> str:
    """The processor's name and abilities: code for one machine's -march=native may not run on another's."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    wanted = ("model name", "flags", "Features", "CPU part")
    features = {line.split(":")[0].strip(): line for line in lines if line.startswith(wanted)}
    return "|".join([platform.machine(), platform.system(), *sorted(features.values())])
