"""Models that every target is tried with, where they start, and the tools of the system."""

from __future__ import annotations

import atexit
import hashlib
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.late import needs_program, with_utilities
from tests.models import sampled
from validation.inputs.cases import named

# The planar robot has a mode of 1e4/s: a Runge-Kutta step of 1e-3 s would enlarge rounding.
STARTS: dict[str, dict[str, float]] = {
    "planar_robot": {"q1": 0.3, "dq2": 1.0},
    "panda": {"panda_joint2": 0.5, "panda_joint4": -1.0, "dpanda_joint1": 0.4},
    "four_bar": {"q1": 1.2, "dq1": 0.5},
    "spatial_rod": {"hinge": 0.3, "whip.bend_y[0]": 0.4, "dwhip.twist[0]": -0.5},
}
STEP = {"planar_robot": 1e-4, "panda": 1e-3, "four_bar": 1e-3, "spatial_rod": 1e-4}
MODELS = tuple(STARTS)
# In every run beams with inputs and a loop; an arm of nine joints, which compiles as long as both, and a geometrically
# exact rod with --slow.
SAMPLED = sampled(MODELS, ("planar_robot", "four_bar"))
# A beam that a motor turns in the plane, the least that has elastic coordinates and an input.
PLANAR = sf.System(
    "planar",
    (
        sf.Beam(
            "link",
            sf.Joint("q1", "revolute", axis=(0, 0, 1), actuated=True),
            1.0,
            1.0,
            EI_z=100.0,
            bend_y=1,
            frames=(sf.Frame("tool"),),
        ),
    ),
    gravity=(0, -9.81, 0),
)
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wsign-conversion", "-Werror")
# What an export compiles by itself has `compiling.FLAGS`; what the optimiser warns of shows under valgrind (--tools).
BUILD = (*STRICT, "-O0")


def system_of(name: str) -> sf.System:
    return named([name])[0].load().system


def first_state(model: sf.Model, name: str) -> tuple[np.ndarray, np.ndarray]:
    q, v = model.neutral(), np.zeros(model.nv)
    for label, value in STARTS[name].items():
        if label in model.names.q:
            q[model.names.q.index(label)] = value
        else:
            v[[f"d{x}" for x in model.names.v].index(label)] = value
    if not model.nc:
        return q, v
    held = [x for x in model.names.v if x in STARTS[name]]
    closed = sf.assemble(model, q, v, held=held)
    return closed.q, closed.v


def trajectory(name: str, t_end: float) -> sf.Trajectory:
    """Python's own run."""
    model = sf.compile(system_of(name))
    q, v = first_state(model, name)
    return sf.simulate(model, q, v, t_end, dt=STEP[name])


def relative(found: object, wanted: np.ndarray) -> float:
    return float(np.abs(np.asarray(found) - wanted).max() / np.abs(wanted).max())


def need(*programs: str) -> None:
    """Tests of tools fail where .ci/run did not install them: a skip would hide that nothing was tested."""
    for program in programs:
        if shutil.which(program) is None:
            pytest.fail(f"{program} is not installed; .ci/run installs it")


@cache
def sanitizers(compiler: str, wanted: str) -> tuple[str, ...]:
    """Flags of those sanitizers, separated by commas, whose programs run on this machine.

    Address and thread sanitizers of these compilers end at once where addresses are randomised over more than 28 bits
    (vm.mmap_rnd_bits), where the virtual memory of a process is limited, or on an emulated kernel; the leak checker
    where no process may trace another. None of that is a fault of ours.
    """
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "empty.c"
        source.write_text("int main(void) { return 0; }\n")
        works = []
        for name in wanted.split(","):
            built = subprocess.run([compiler, f"-fsanitize={name}", "-o", "empty", source], cwd=folder)
            assert built.returncode == 0, f"{compiler} has no {name} sanitizer; .ci/run installs it"
            if all(subprocess.run(["./empty"], cwd=folder, capture_output=True).returncode == 0 for _ in range(5)):
                works.append(name)
    if not works:
        pytest.skip(f"programs with {compiler} -fsanitize={wanted} do not run on this machine, not even an empty one")
    return f"-fsanitize={','.join(works)}", "-fno-sanitize-recover=all"


def run(*command: str | Path, cwd: Path) -> str:
    words = [str(word) for word in command]
    if "/" not in words[0]:
        needs_program(words[0])
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, env=with_utilities())
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout


@cache
def _objects() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="symofros-objects-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def build(folder: Path, program: str, *files: str, include: Path | None = None) -> Path:
    """A program of C sources in a folder, strictly compiled; those that other tests have compiled are not again.

    Args:
        folder: Where sources and headers lie.
        program: Path of the program, from there.
        files: Names of the sources; all by default.
        include: Folder of further headers.
    """
    headers = [*folder.glob("*.h"), *(include.glob("*.h") if include else ())]
    objects = []
    for name in files or sources(folder):
        # Sources that come with every export know no header of a model.
        seen = [header for header in headers if header.name.startswith("symofros_") or not name.startswith("symofros_")]
        text = b"\0".join(path.read_bytes() for path in (folder / name, *sorted(seen)))
        kept = _objects() / f"{hashlib.sha256(text).hexdigest()}.o"
        if not kept.exists():
            run("gcc", *BUILD, "-I.", *([f"-I{include}"] if include else []), "-c", name, "-o", kept, cwd=folder)
        objects.append(kept)
    run("gcc", *objects, "-lm", "-o", program, cwd=folder)
    return folder / program


def driven(diagram: sf.Diagram, folder: Path, rows: np.ndarray, *words: str, **options: Any) -> np.ndarray:
    """What the program of a diagram gives, line by line: of times, and of the values of inlets beside them."""
    name = sf.export(diagram, "c", folder, **options).name
    text = Path(__file__).with_name("drive.c").read_text().replace("PROGRAM(", f"{name}_program(")
    (folder / "main.c").write_text(text)
    shutil.rmtree(folder / "build", ignore_errors=True)
    given = "\n".join(" ".join(map(float.hex, row)) for row in rows.tolist())
    done = subprocess.run([build(folder, "driven"), *words], input=given, capture_output=True, text=True)
    assert done.returncode == 0, done.returncode
    return np.array([[float.fromhex(word) for word in line.split()] for line in done.stdout.splitlines()])


def packaged(of: sf.System | sf.Diagram, folder: Path, main: str, **options: Any) -> Path:
    """The program of the C package of a system or a diagram with a `main` of its own, in the folder around it."""
    sf.export(of, "c", folder, **options)
    (folder / "main.c").write_text(main)
    return build(folder, "../program", *sources(folder))


def sources(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.c"))
