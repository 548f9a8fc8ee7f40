"""Builds the native timing program from the headers in Pinocchio's wheel, once for each content."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from importlib import metadata
from importlib.resources import files
from pathlib import Path

FLAGS = (
    "-std=c++17", "-O3", "-march=native", "-DNDEBUG",
    # Pinocchio's variant of joints needs longer lists than Boost's headers hold by default.
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)  # fmt: skip
_SOURCES = ("timing.cpp", "tree_file.h")


class BuildError(Exception):
    """The native program can't be built; the message is for people."""


@dataclass(frozen=True)
class NativeProgram:
    """A compiled timing program.

    Attributes:
        path: Of the program.
        compiler: What its version line says.
    """

    path: Path
    compiler: str


def compilers() -> list[str]:
    """The C++ compilers of this machine: gcc, and clang if it is installed."""
    names = ("g++", "clang++", *(f"clang++-{version}" for version in range(21, 13, -1)))
    found = [path for path in map(shutil.which, names) if path]
    return found[:2]


def build(compiler: str) -> NativeProgram:
    """Compile the program, or take it from the cache.

    Args:
        compiler: Path of a C++ compiler.

    Raises:
        BuildError: Headers are missing, or the compiler refused; with its words.
    """
    folder = files("validation") / "native"
    sources = {name: (folder / name).read_text(encoding="utf-8") for name in _SOURCES}
    sources["symofros_model.h"] = (files("symofros") / "codegen/templates/symofros_model.h").read_text(encoding="utf-8")
    version = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    includes = _includes()
    pinocchio = metadata.version("pin")
    key = hashlib.sha256("\0".join([*sources.values(), *FLAGS, version, pinocchio]).encode()).hexdigest()[:24]
    folder_of_programs = cache()
    program = folder_of_programs / f"timing-{key}"
    if not program.exists():
        folder_of_programs.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".timing-", dir=folder_of_programs) as private:
            _compile(compiler, Path(private), sources, includes)
            os.replace(Path(private) / "timing", program)
    return NativeProgram(program, version)


def _compile(compiler: str, private: Path, sources: dict[str, str], includes: list[Path]) -> None:
    for name, text in sources.items():
        (private / name).write_text(text, encoding="utf-8")
    # System headers: warnings of other people's code are not ours to show.
    command = [compiler, *FLAGS, *(f"-isystem{path}" for path in includes), "timing.cpp", "-o", "timing", "-ldl"]
    done = subprocess.run(command, cwd=private, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        words = "\n".join(done.stderr.splitlines()[:20])
        raise BuildError(f"{' '.join(command)}\nfailed with status {done.returncode}:\n{words}")


def _includes() -> list[Path]:
    """Where the wheels keep the headers of Pinocchio, Boost and Eigen."""
    found = []
    for package, header in (("libpinocchio", "pinocchio/algorithm/crba.hpp"), ("cmeel-eigen", "Eigen/Core")):
        try:
            listed = metadata.files(package) or []
        except metadata.PackageNotFoundError:
            raise BuildError(f"the package {package} is not installed: pip install 'symofros[timing]'") from None
        match = next((Path(str(f.locate())) for f in listed if str(f).endswith(header)), None)
        if match is None:
            raise BuildError(f"the package {package} has no {header}")
        found.append(match.parents[header.count("/")])
    return list(dict.fromkeys(found))


def cache() -> Path:
    """Where compiled programs are kept."""
    stated = os.environ.get("SYMOFROS_CACHE")
    if stated:
        return Path(stated)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "symofros"


def pin_to_one_cpu() -> None:
    """Keep this process on one processor, where the system can."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
