"""Find a C compiler: the system's, then the `ziglang` package's."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import platform
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import Event, Timer

from symofros.base.threads import ended_by, try_to_start
from symofros.errors import CompileError, Problem

# -fno-math-errno lets sqrt and sincos be instructions and single calls; -ffast-math was measured and gains nothing.
# Packs (generator/codegen/packs.py) share vectors already: the compiler's own search for more costs up to a quarter.
DEFAULT_FLAGS = ("-O2", "-march=native", "-fno-math-errno", "-fno-tree-slp-vectorize")
# What takes gcc time and finds nothing in straight code, whose expressions the generator has merged: searches for
# repeated expressions and dead stores, for what was stored far back, for longer combinations of instructions. The code
# is as fast, its bits are the same (docs/theory/code.md, section 8). Other compilers and older versions refuse these,
# and gcc promises none of its parameters to later ones.
GCC_FLAGS = (
    "-fno-gcse",
    "-fno-rerun-cse-after-loop",
    "-fno-tree-dse",
    "-fno-dse",
    "-fno-lra-remat",
    "--param=max-cselib-memory-locations=20",
    "--param=sccvn-max-alias-queries-per-access=10",
    "--param=max-combine-insns=2",
)
_GCC_VERSIONS = range(8, 16)
_GCC = re.compile(r"^.*\) (\d+)\..*$(?s:.*)Free Software Foundation", re.MULTILINE)
SHARED_FLAGS = ("-shared", "-fPIC", "-fvisibility=hidden", "-std=gnu99")
_SHOWN_LINES = 12
# For one call [s]. The largest models of the suite take a minute; a compiler that waits for something never ends.
COMPILATION_LIMIT = 3600.0
VERSION_LIMIT = 60.0

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
        gcc: Major version where it is GNU's, by whatever name it is called; 0 for others.
    """

    command: tuple[str, ...]
    identity: str
    is_fallback: bool = False
    gcc: int = 0

    @property
    def default_flags(self) -> tuple[str, ...]:
        """Flags of models whose options state none."""
        return (*DEFAULT_FLAGS, *(GCC_FLAGS if self.gcc in _GCC_VERSIONS else ()))


@cache
def find_toolchain(compiler: str | None = None) -> Toolchain | None:
    """The compiler to use.

    Args:
        compiler: A path or name; None tries $CC, cc, gcc, clang, then the ziglang package.

    Returns:
        None if there is none.

    Raises:
        CompileError: The compiler that was named is none, does not run, or does not end.
    """
    wanted = compiler or os.environ.get("CC")
    if wanted:
        command = _command(wanted, "Options(compiler=…)" if compiler else "$CC")
        return _toolchain(command)
    for name in ("cc", "gcc", "clang"):
        path = shutil.which(name)
        if path is not None:
            return _toolchain((path,))
    if importlib.util.find_spec("ziglang") is not None:
        return _toolchain((sys.executable, "-m", "ziglang", "cc"), is_fallback=True)
    return None


def stated_flags() -> tuple[str, ...]:
    """Flags of $SYMOFROS_CFLAGS, which follow the default ones: -O0 compiles generated code in half the time.

    Raises:
        CompileError: The text can't be split into words.
    """
    wanted = os.environ.get("SYMOFROS_CFLAGS", "")
    return _words(wanted, "$SYMOFROS_CFLAGS", "state flags of the C compiler, as in '-O0 -g', or none")


def _words(wanted: str, source: str, remedy: str) -> tuple[str, ...]:
    """A text split as a shell does.

    Raises:
        CompileError: A quotation does not end.
    """
    try:
        return tuple(shlex.split(wanted))
    except ValueError as error:
        rule = "its words are separated as in a shell"
        raise CompileError(f"{source} can't be read: {error}", repr(wanted), rule, remedy) from error


def _command(wanted: str, source: str) -> tuple[str, ...]:
    """Program and leading arguments of a compiler that was named.

    Raises:
        CompileError: The text is no command, or its program is not there.
    """
    remedy = "name a C compiler, as in 'gcc' or 'clang -m64', or leave the choice to us"
    command = _words(wanted, source, remedy)
    if not command or not command[0]:
        raise CompileError(f"{source} names no compiler", repr(wanted), "it begins with a program", remedy)
    if shutil.which(command[0]) is None:
        what = f"compiler '{wanted}' ({source}) was not found"
        raise CompileError(what, command[0], "it is a program on the path", "install it, or leave the choice to us")
    return command


def call_compiler(command: Sequence[str], output: str, folder: Path, remedy: str) -> None:
    """Run a compiler in a folder.

    Args:
        command: Command with its arguments, but for the output.
        output: Name of the file that it is to write there.
        folder: Working folder.
        remedy: Remedy to state if it fails.

    Raises:
        CompileError: It failed, with its command and messages; or it wrote nothing, or did not end.
    """
    stated = [*command, "-o", output]
    status, said = _run(stated, COMPILATION_LIMIT, folder, subprocess.STDOUT)
    shown = "\n".join([" ".join(stated), *(f"    {line}" for line in said.splitlines()[:_SHOWN_LINES])])
    if status != 0:
        what = f"the C compiler failed with status {status}"
        raise CompileError(what, shown, "the command ends with status 0", remedy)
    if not (folder / output).is_file():
        what = "the C compiler ended well, but wrote nothing"
        raise CompileError(what, shown, f"the command writes the file '{output}'", remedy)


def _toolchain(command: tuple[str, ...], is_fallback: bool = False) -> Toolchain:
    """A command as what it says of itself: the first line is its version, and gcc names its owner below."""
    said = _run([*command, "--version"], VERSION_LIMIT, None, subprocess.DEVNULL)[1]
    identity = f"{' '.join(command)} {said.splitlines()[0] if said else ''}"
    gcc = _GCC.match(said)
    return Toolchain(command, identity, is_fallback, int(gcc[1]) if gcc else 0)


def _run(command: Sequence[str], limit: float, folder: Path | None, errors: int) -> tuple[int, str]:
    """Exit status and output of a command.

    What it says goes to a file: of a pipe, the end would be waited for until all its children have ended, too.

    Raises:
        CompileError: It can't be started, or does not end within the limit [s].
    """
    with tempfile.TemporaryFile() as said:
        try:
            process = subprocess.Popen(
                command,
                cwd=folder,
                # What a compiler that is killed leaves goes with the folder.
                env=None if folder is None else {**os.environ, "TMPDIR": os.path.abspath(folder)},
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=errors,
                start_new_session=True,  # The driver starts others, which are ended with it.
            )
        except OSError as error:
            rule, remedy = "a compiler is a program that this machine can run", "name another compiler, or install one"
            raise CompileError(f"compiler '{command[0]}' can't be started", str(error), rule, remedy) from error
        # Waiting with a time limit of its own would ask twenty times a second.
        too_late = Event()

        def end() -> None:
            too_late.set()
            _end_group(process)

        watch = Timer(limit, end)
        watch.daemon = True
        try:
            # A process that ends starts no thread; it builds what its successors find in the cache.
            with ended_by(lambda: _end_group(process)):
                status = process.wait() if try_to_start(watch) else _wait(process, limit, end)
        except BaseException:  # As of a user who interrupts.
            _end_group(process)
            process.wait()
            raise
        finally:
            watch.cancel()
        if too_late.is_set():
            raise CompileError(
                f"the C compiler did not end within {limit:g} s",
                " ".join(command),
                "a compiler answers within its time limit",
                "name another compiler, or generate fewer functions: Options(functions=…)",
            )
        said.seek(0)
        return status, said.read().decode(errors="replace")


def _wait(process: subprocess.Popen[bytes], limit: float, end: Callable[[], None]) -> int:
    """The status of a process, which is ended after a time limit [s]."""
    try:
        return process.wait(limit)
    except subprocess.TimeoutExpired:
        end()
        return process.wait()


def _end_group(process: subprocess.Popen[bytes]) -> None:
    """End a process and what it has started."""
    if sys.platform == "win32":
        process.kill()
        return
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


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
