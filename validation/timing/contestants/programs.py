"""Builds the native sides of a race, once for each content: compiler, flags, sources, processor."""

from __future__ import annotations

import hashlib
import itertools
import json
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

from symofros.tools import (
    cache_folder,
    cpu_identity,
    create_cache_folder,
    install,
    is_intact,
    stored_json,
    write_atomically,
)

# Linked with these, a library of gcc's up to 12 makes the whole process flush denormal numbers to zero when it loads.
_LOOSE = ("-ffast-math",)
_NEWEST, _OLDEST = 25, 11
# Where in memory the system keeps a library's code decides how fast a large function is: a humanoid's M + h took
# 1030 ns from most copies of one file, and up to 1570 from others. So it is timed from this many copies.
COPIES = 6
_PRIVATE = tempfile.TemporaryDirectory(prefix="symofros-timing-")
_NUMBERS = itertools.count()


Say = Callable[[str], None]


def silent(text: str) -> None:
    """Progress that is not shown."""


class BuildError(Exception):
    """A native side can't be built; the message is for people."""


class Skipped(Exception):
    """A peer has no side for a model; the message says why, for people."""


@dataclass(frozen=True)
class Compiler:
    """One that runs here.

    Attributes:
        path: Path of the program.
        name: Family and version: "gcc 12.2.0".
        version: First line of its `--version`.
    """

    path: str
    name: str
    version: str


@dataclass(frozen=True)
class Built:
    """A shared library.

    Attributes:
        path: File in the cache.
        seconds: Time of the compilation when it was made [s].
        text: Bytes of machine code.
        constants: Bytes of constants.
    """

    path: Path
    seconds: float
    text: int
    constants: int


def compilers(language: str = "c") -> list[Compiler]:
    """gcc, and the newest clang; "c" or "c++"."""
    gcc, clang = {"c": ("gcc", "clang"), "c++": ("g++", "clang++")}[language]
    newest = [f"{clang}-{version}" for version in range(_NEWEST, _OLDEST - 1, -1)]
    clangs = [compiler for compiler in map(_compiler, (*newest, clang)) if compiler is not None]
    clangs.sort(key=lambda compiler: _number(compiler.name), reverse=True)
    first = _compiler(gcc)
    return [*([first] if first else []), *clangs[:1]]


@cache
def _compiler(name: str) -> Compiler | None:
    path = shutil.which(name)
    if path is None:
        return None
    said = subprocess.run([path, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    number = subprocess.run([path, "-dumpversion"], capture_output=True, text=True, check=True).stdout.strip()
    full = next((word for word in said.split()[::-1] if word.startswith(number + ".")), number)
    family = "clang" if "clang" in name else "gcc"
    return Compiler(path, f"{family} {full}", said)


def _number(name: str) -> tuple[int, ...]:
    return tuple(int(part) for part in name.split()[1].split(".") if part.isdigit())


def source(name: str) -> str:
    """Text of a file of validation/native, or of the header of generated models."""
    if name == "symofros_model.h":
        return (files("symofros") / "native/model/symofros_model.h").read_text(encoding="utf-8")
    return (Path(__file__).parents[2] / "native" / name).read_text(encoding="utf-8")


def declared(name: str) -> str:
    """C declarations of a native file that Python's bindings read."""
    return source(name).partition("/* cdef begin: what Python reads */")[2].partition("/* cdef end */")[0]


def build(
    compiler: Compiler,
    sources: Mapping[str, str],
    flags: Sequence[str],
    link: Sequence[str] = (),
    depends: Sequence[str] = (),
    say: Say = silent,
) -> Built:
    """The shared library of the first of some sources, compiled unless it is in the cache of compiled models.

    Args:
        compiler: Compiler to use.
        sources: File name -> text; the others are what the first includes.
        flags: Flags for compiling.
        link: Flags for linking.
        depends: Further dependencies: versions of packages.
        say: Told that it is being compiled.

    Raises:
        BuildError: The compiler refused, with its complaint.
        CompileError: The cache folder can't be trusted.
    """
    parts = [*sources, *sources.values(), *flags, *link, *depends, compiler.version, cpu_identity()]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    folder = cache_folder()
    library, record = folder / f"timing-{key}.so", folder / f"timing-{key}.json"
    facts = stored_json(record, dict) if is_intact(library) else None
    if facts is None:
        say(f"compiling {next(iter(sources))} by {compiler.name}")
        create_cache_folder(folder)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            built = _compiled(compiler, Path(private), sources, flags, link)
            facts = {name: value for name, value in asdict(built).items() if name != "path"}
            write_atomically(record, json.dumps(facts))
            install(built.path, library)
    return Built(library, **facts)


def copies(library: Path, count: int = COPIES) -> list[Path]:
    """The same library in files of its own; they go with the process."""
    private_copies = []
    for k in range(count):
        private = Path(_PRIVATE.name) / f"{next(_NUMBERS)}-{library.stem}-{k}{library.suffix}"
        shutil.copyfile(library, private)
        private_copies.append(private)
    return private_copies


def _compiled(
    compiler: Compiler, private: Path, sources: Mapping[str, str], flags: Sequence[str], link: Sequence[str]
) -> Built:
    for name, text in sources.items():
        (private / name).write_text(text, encoding="utf-8")
    start = time.perf_counter()
    _call([compiler.path, *flags, "-fPIC", "-fvisibility=hidden", "-c", next(iter(sources)), "-o", "side.o"], private)
    seconds = time.perf_counter() - start
    kept = [flag for flag in flags if flag not in _LOOSE]
    _call([compiler.path, *kept, "-shared", "side.o", "-o", "side.so", *link], private)
    sizes = _sections(private / "side.o")
    code, constants = (
        sum(size for name, size in sizes.items() if name.startswith(prefix)) for prefix in (".text", ".rodata")
    )
    return Built(private / "side.so", seconds, code, constants)


def _call(command: Sequence[str], directory: Path) -> None:
    done = subprocess.run(command, cwd=directory, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        complaint = "\n".join(done.stderr.splitlines()[:20])
        raise BuildError(f"{' '.join(command)}\nfailed with status {done.returncode}:\n{complaint}")


def _sections(path: Path) -> dict[str, int]:
    """Section -> bytes, as `size -A` of the binutils prints them."""
    tool = shutil.which("size")
    if tool is None:
        return {}
    printed = subprocess.run([tool, "-A", str(path)], capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in printed.splitlines()]
    return {row[0]: int(row[1]) for row in rows if len(row) == 3 and row[1].isdigit()}
