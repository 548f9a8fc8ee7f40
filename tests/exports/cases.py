"""Models that every target is tried with, where they start, and the tools of the system."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from validation.cases import named

# The planar robot has a mode of 1e4/s: a Runge-Kutta step of 1e-3 s would enlarge rounding.
STARTS: dict[str, dict[str, float]] = {
    "planar_robot": {"q1": 0.3, "dq2": 1.0},
    "panda": {"panda_joint2": 0.5, "panda_joint4": -1.0, "dpanda_joint1": 0.4},
    "four_bar": {"q1": 1.2, "dq1": 0.5},
}
STEP = {"planar_robot": 1e-4, "panda": 1e-3, "four_bar": 1e-3}
MODELS = tuple(STARTS)
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror")


def system_of(name: str) -> sf.System:
    return named([name], False)[0].load().system


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


def run(*command: str | Path, cwd: Path) -> str:
    done = subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout


def sources(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.c"))
