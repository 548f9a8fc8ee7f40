"""The command line as a program of its own, from a model's file to what it prints and writes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import symofros as sf
from symofros.__main__ import app
from symofros.commands import compile as compiling
from symofros.generator.programs import ProgramBuilder

ARM = """symofros: 1
system: {name: arm}
bodies:
  link: {joint: {name: q1, kind: revolute}, inertia: {mass: 1, center_of_mass: [0.5, 0, 0]}}
"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    (tmp_path / "arm.yaml").write_text(ARM)
    return tmp_path / "arm.yaml"


@pytest.mark.slow
def test_info_lists_tree_and_operations(model: Path) -> None:
    command = [sys.executable, "-m", "symofros", "info", str(model), "--operations"]
    text = subprocess.run(command, capture_output=True, text=True).stdout
    assert "link" in text and "revolute q1" in text and "mass_matrix" in text
    data = json.loads(subprocess.run([*command, "--json"], capture_output=True, text=True).stdout)
    assert data["nq"] == 1 and data["operations"]["bias"]["call"] >= 0


def test_command_line_reports_every_fault_and_fails(model: Path) -> None:
    faulty = ARM.replace("revolute", "revolut").replace("mass: 1", "mass: -1")
    model.write_text(f"{faulty}  hand: {{joint: {{name: q2, parent: lnk}}}}\n")
    done = subprocess.run([sys.executable, "-m", "symofros", "info", str(model)], capture_output=True, text=True)
    assert done.returncode == 2
    assert "arm.yaml:4" in done.stderr and "revolute" in done.stderr and "arm.yaml:5" in done.stderr


def test_compile_writes_the_source(model: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "symofros", "compile", str(model), "-o", str(tmp_path / "out")]
    command += ["--functions", "mass_matrix"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "arm_mass_matrix" in (tmp_path / "out" / "arm.c").read_text()
    assert (tmp_path / "out" / "symofros_model.h").exists()


def test_compile_prepares_the_functions_that_models_call(
    model: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever Python then calls is in the cache, and so is all that a second `compile` asks for."""
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    of_three_dozen = ("mass_matrix", "inverse_dynamics_derivatives")
    monkeypatch.setattr(compiling, "DEFAULT_FUNCTIONS", of_three_dozen)
    command = ["compile", str(model), "--json"]
    first = CliRunner().invoke(app, command)
    assert first.exit_code == 0 and "mass_matrix" in json.loads(first.output)["functions"], first.output
    monkeypatch.setattr(ProgramBuilder, "program", None)  # Nothing is generated again.
    again = CliRunner().invoke(app, command)
    assert again.exit_code == 0, again.output
    made = sf.compile(sf.load(model))
    assert made.mass_matrix([0.3])[0, 0] == pytest.approx(0.25)
    assert made.inverse_dynamics_derivatives([0.3], [0.0], [0.0])[0].shape == (1, 1)
