"""Which of several builds of the same functions is the fastest on this machine: measured once, remembered.

Straight code is erratic: builds that do the same differ by up to 40 %, and no rule tells beforehand which wins.
"""

from __future__ import annotations

import hashlib
import math
import os
import re
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import thread_time_ns

import numpy as np

from symofros.base.options import Options
from symofros.base.stored import keep, stored_text
from symofros.runtime.build.toolchain import Toolchain, find_toolchain
from symofros.runtime.calls.library import CompiledKernel, CompiledUnit

_STATES, _ROUNDS = 64, 15
# A clock's reading costs less than a thousandth of this [ns].
_LEAST = 200_000
_CALLED = re.compile(r"^\S*(cc|clang)(-\d+)?\s")
# clang contracts across statements only by option, gcc by default.
_CONTRACTED = "-ffp-contract=fast"


@dataclass(frozen=True)
class Build:
    """One way to make a library.

    Attributes:
        toolchain: The compiler.
        flags: Flags; None for the default ones.
        packs: Whether packs share vectors, as in Options.
    """

    toolchain: Toolchain
    flags: tuple[str, ...] | None
    packs: bool


def builds(options: Options, toolchain: Toolchain, in_lanes: bool = False) -> list[Build]:
    """What is worth trying: compilers that are there, two levels of optimisation, packs or not.

    A compiler, flags, or `packs=False` that the options state are kept; code for several states at once has no packs.
    """
    toolchains = [toolchain]
    if options.compiler is None:
        toolchains += [other for name in _compilers() if (other := find_toolchain(name))]
    by_version = {_version(tool): tool for tool in reversed(toolchains)}
    packs = (True, False) if options.packs and not in_lanes else (options.packs,)
    return [
        Build(tool, flags, packed)
        for tool in reversed(by_version.values())
        for flags in ([options.flags] if options.flags is not None else _flags(tool))
        for packed in packs
    ]


def _version(toolchain: Toolchain) -> str:
    """What a compiler says of itself, but for the name that it was called by: cc and gcc are one."""
    return _CALLED.sub("", toolchain.identity.partition(" ")[2])


def _compilers() -> list[str]:
    """Names on the path: gcc and clang, and the newest of those that have their version in the name (clang-19)."""
    compilers = []
    for kind in ("gcc", "clang"):
        versions = {
            int(path.name.rpartition("-")[2])
            for folder in os.get_exec_path()
            for path in Path(folder).glob(f"{kind}-*")
            if path.name.rpartition("-")[2].isdecimal() and path.name.count("-") == 1
        }
        newest = [f"{kind}-{max(versions)}"] if versions else []
        compilers += [name for name in (kind, *newest) if shutil.which(name)]
    return compilers


def _flags(toolchain: Toolchain) -> list[tuple[str, ...] | None]:
    if "clang" in toolchain.identity:
        return [(*toolchain.default_flags, _CONTRACTED)]
    return [None, tuple("-O3" if flag == "-O2" else flag for flag in toolchain.default_flags)]


def fastest(libraries: Sequence[Path], load: Callable[[Path], CompiledUnit]) -> Path:
    """The library whose functions take the least time, one state each.

    Args:
        libraries: Libraries of the same functions, in one folder, where the choice is kept.
        load: Opens one.

    """
    folder = libraries[0].parent
    names = sorted({path.name for path in libraries})
    known = folder / f"{hashlib.sha256(' '.join(names).encode()).hexdigest()[:32]}.fastest"
    stated = stored_text(known, str)
    chosen = next((path for path in libraries if path.name == stated), None)
    if chosen is not None:
        return chosen
    chosen = _measured(dict.fromkeys(libraries), load)
    keep(known, chosen.name)
    return chosen


def _measured(libraries: dict[Path, None], load: Callable[[Path], CompiledUnit]) -> Path:
    """By turns, each function of each library; the sum of medians decides."""
    units = {path: load(path) for path in libraries}
    total = dict.fromkeys(libraries, 0.0)
    for key in next(iter(units.values())).kernels:
        calls = {path: _call(unit, key) for path, unit in units.items()}
        rounds = max(1, math.ceil(_LEAST / max(1, min(map(_nanoseconds, calls.values())))))
        times: dict[Path, list[float]] = {path: [] for path in calls}
        for _ in range(_ROUNDS):
            for path, call in calls.items():
                times[path].append(_nanoseconds(call, rounds) / rounds)
        for path, taken in times.items():
            total[path] += median(taken)
    return min(total, key=total.__getitem__)


def _call(unit: CompiledUnit, key: tuple[str, str]) -> Callable[[], None]:
    """A function over a few random states."""
    kernel = unit.kernels[key]
    assert isinstance(kernel, CompiledKernel)
    rng = np.random.default_rng(0)
    pre = unit.prepare(np.array([[unit.model.par_default[i] for i in range(unit.model.npar)]]))
    inputs = [rng.uniform(-1.0, 1.0, (_STATES, size)) for _, size in kernel.signature.inputs]
    outputs = [np.empty((_STATES, *shape)) for _, shape in kernel.signature.outputs]
    call = kernel.bind_batch(_STATES, pre, inputs, outputs)

    def keeping(_arrays: object = (pre, inputs, outputs)) -> None:  # They live as long as what is called.
        call()

    return keeping


def _nanoseconds(call: Callable[[], None], rounds: int = 1) -> int:
    """Of this thread on the processor: when others have it, no time passes."""
    start = thread_time_ns()
    for _ in range(rounds):
        call()
    return thread_time_ns() - start
