"""Generated C against MuJoCo's C, as its wheel ships it: loops in C on both sides, one process, interleaved."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from importlib.metadata import version
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from statistics import median

import numpy as np

import symofros as sf
from validation.adapters import mujoco
from validation.assembly import assemble
from validation.geometry import Array
from validation.interface import Subject, Unsupported
from validation.sampling import sample
from validation.studies.native_build import BuildError, cache, pin_to_one_cpu

STATES = 1000
FUNCTIONS = {"mass_matrix": "M", "mass_matrix_and_bias": "M + h", "forward_dynamics": "forward dynamics"}
_FLAGS = ("-O3", "-march=native", "-Wall", "-Wextra")


@dataclass(frozen=True)
class MujocoTiming:
    """One function of one model.

    Attributes:
        model: Its label.
        nv: Degrees of freedom.
        function: What was timed.
        ours: Minimum and median, nanoseconds a state, state by state; likewise theirs.
        ratio: Median over the repeats of theirs / ours.
        batch: Ours, all states in one call.
        batch_ratio: Median over the repeats of theirs / batch.
    """

    model: str
    nv: int
    function: str
    ours: tuple[float, float]
    theirs: tuple[float, float]
    ratio: float
    batch: tuple[float, float]
    batch_ratio: float


def time_mujoco(label: str, system: sf.System, repeats: int) -> list[MujocoTiming]:
    """Time one model.

    Raises:
        BuildError: MuJoCo can't represent it, or the program can't be built or fails.
    """
    engine = mujoco.build(Subject(label, system))
    if isinstance(engine, Unsupported):
        raise BuildError(f"{label}: MuJoCo: {engine.reason}")
    assert isinstance(engine, mujoco.MujocoEngine)
    assembly = assemble(system)
    states = sample(assembly, 0, STATES)
    library, symbol = sf.compile_library(system, sf.Options(functions=("mass_matrix", "dynamics", "forward_dynamics")))
    program = _program()
    with tempfile.TemporaryDirectory() as folder:
        model, rows = Path(folder) / "model.mjb", Path(folder) / "states.txt"
        engine.write(model)
        rows.write_text(_text(np.hstack([states.q, states.v, *engine.states(states.q, states.v)])), encoding="ascii")
        command = [str(program), str(model), str(rows), str(library), symbol, str(repeats)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, preexec_fn=pin_to_one_cpu)
    if done.returncode != 0:
        raise BuildError(f"{label}: the timing program failed with status {done.returncode}: {done.stderr.strip()}")
    times: dict[tuple[str, str], list[float]] = {}
    for line in done.stdout.splitlines():
        _, function, side, _, value = line.split()
        times.setdefault((function, side), []).append(float(value))
    found = []
    for function, name in FUNCTIONS.items():
        ours, batch, theirs = (times[function, side] for side in ("symofros", "batch", "mujoco"))
        found.append(MujocoTiming(label, assembly.nv, name, _summary(ours), _summary(theirs), _ratio(ours, theirs),
                                  _summary(batch), _ratio(batch, theirs)))  # fmt: skip
    return found


def _summary(times: list[float]) -> tuple[float, float]:
    return min(times), median(times)


def _ratio(ours: list[float], theirs: list[float]) -> float:
    return median(b / a for a, b in zip(ours, theirs, strict=True))


def _text(rows: Array) -> str:
    return "\n".join([str(len(rows)), *(" ".join(map(repr, row)) for row in rows.tolist())]) + "\n"


def _program() -> Path:
    """The timing program, compiled unless it is in the cache."""
    spec = find_spec("mujoco")
    compiler = shutil.which("gcc") or shutil.which("clang") or shutil.which("cc")
    if spec is None or spec.origin is None or compiler is None:
        raise BuildError("the package mujoco, or a C compiler, is not installed")
    package = Path(spec.origin).parent
    libraries = sorted(package.glob("libmujoco.so*"))
    if not libraries:
        raise BuildError(f"MuJoCo's wheel has no libmujoco.so in {package}")
    sources = {
        "mujoco_timing.c": (files("validation") / "native/mujoco_timing.c").read_text(encoding="utf-8"),
        "symofros_model.h": (files("symofros") / "codegen/templates/symofros_model.h").read_text(encoding="utf-8"),
    }
    parts = [*sources.values(), *_FLAGS, compiler, str(package), version("mujoco")]
    program = cache() / f"mujoco-{hashlib.sha256(chr(0).join(parts).encode()).hexdigest()[:24]}"
    if program.exists():
        return program
    program.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".mujoco-", dir=program.parent) as private:
        for name, text in sources.items():
            (Path(private) / name).write_text(text, encoding="utf-8")
        command = [compiler, *_FLAGS, f"-isystem{package / 'include'}", "mujoco_timing.c", "-o", "timing",
                   str(libraries[-1]), f"-Wl,-rpath,{package}", "-ldl"]  # fmt: skip
        done = subprocess.run(command, cwd=private, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise BuildError(f"{' '.join(command)}\nfailed:\n" + "\n".join(done.stderr.splitlines()[:20]))
        os.replace(Path(private) / "timing", program)
    return program
