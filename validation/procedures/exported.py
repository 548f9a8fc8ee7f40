"""Exports where their tools are: a package of C built by the system's compiler, and FMUs run by FMPy."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterator
from importlib import import_module, util
from pathlib import Path
from typing import Literal

import numpy as np

import symofros as sf
from symofros.tools import find_toolchain

from ..mechanics.geometry import Array
from .scene import Cell, Scene, off

T_END, STEP = 0.1, 1e-3
# The same steps in the same order; compiled with other flags, products are rounded otherwise.
SAME = 1e-10
# CVODE at 1e-9, through a few hundred steps.
CHOSEN = 1e-6


def packages(scene: Scene) -> Iterator[Cell]:
    """What an exported model ends at is what a run of ours does."""
    model = scene.model
    start = dict(zip(model.names.q, map(float, scene.q), strict=True))
    start |= {f"d{name}": float(x) for name, x in zip(model.names.v, scene.v, strict=True)}
    run = sf.simulate(model, scene.q, scene.v, T_END, method="rk4", dt=STEP)
    wanted = np.r_[run.q[-1], run.v[-1]]
    with tempfile.TemporaryDirectory() as folder:
        sf.export(scene.system, "c", folder, start=start, method="rk4", dt=STEP)
        yield Cell("a package of C", off(_by_c(Path(folder)), wanted), SAME)
    targets: tuple[Literal["fmu2", "fmu3"], ...] = ("fmu2", "fmu3")
    for target in targets:
        for kind, tolerance in (("CoSimulation", SAME), ("ModelExchange", CHOSEN)):
            name = f"{target}, {kind}"
            if util.find_spec("fmpy") is None:
                yield Cell(name, 0.0, tolerance, absent="FMPy runs FMUs; pip install 'symofros[validation]' fmpy")
                continue
            with tempfile.TemporaryDirectory() as folder:
                unit = sf.export(scene.system, target, folder, start=start, method="rk4", dt=STEP).files[0]
                yield Cell(name, off(_by_fmpy(str(unit), kind, model), wanted), tolerance)


def _by_c(folder: Path) -> Array:
    """The last state (nq + nv) that the example of a package prints."""
    files = sorted(path.name for path in folder.glob("*.c"))
    compiler = find_toolchain()
    assert compiler is not None  # The model was compiled by it.
    command = [*compiler.command, "-O1", "-std=c99", "-I.", *files, "-lm", "-o", "example"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    asked = ["./example", str(T_END), str(STEP), "--fast"]
    said = subprocess.run(asked, cwd=folder, check=True, capture_output=True, text=True).stdout
    lines = {words[0]: words[1:] for line in said.splitlines() if (words := line.split())}
    return np.array([float(x) for key in ("q", "v") for x in lines[key]])


def _by_fmpy(unit: str, kind: str, model: sf.Model) -> Array:
    """The last state (nq + nv) of a unit's run."""
    given = {"relative_tolerance": 1e-9} if kind == "ModelExchange" else {}
    simulate = import_module("fmpy").simulate_fmu
    found = simulate(unit, fmi_type=kind, stop_time=T_END, output_interval=0.01, **given)
    names = [name for group in ("q.", "v.") for name in found.dtype.names if name.startswith(group)]
    assert len(names) == model.nq + model.nv
    return np.array([float(found[name][-1]) for name in names])
