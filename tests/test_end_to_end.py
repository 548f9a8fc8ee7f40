"""What the README promises, run as written."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent


def test_readme_example_runs() -> None:
    readme = (ROOT / "README.md").read_text()
    first, *more = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    assert len(first.strip().splitlines()) <= 25
    done = subprocess.run([sys.executable, "-c", first + "".join(more)], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert "(1000, 2, 2) (6, 2)" in done.stdout


# Commands that serve pages, wait for the browser, or take minutes and have tests of their own.
LEFT_OUT = (
    "view ",
    "edit ",
    "advise ",
    "check ",
    "export robot.urdf --target fmu3",
    "--target mex",
    "square.yaml",
    "--view",
)


def shell_commands() -> list[str]:
    """The lines of the README that call symofros, and the copies that they need, without comments."""
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    lines = [line.partition("  #")[0].strip() for block in blocks for line in block.splitlines()]
    return [line for line in lines if line.startswith(("symofros ", "cp "))]


def test_shell_commands_of_the_readme_run(tmp_path: Path) -> None:
    for folder in ("validation", "reference_models"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    program = tmp_path / "bin/symofros"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -m symofros "$@"\n')
    program.chmod(0o755)
    paths = {"PATH": f"{program.parent}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    commands = [line for line in shell_commands() if not any(part in line for part in LEFT_OUT)]
    assert len(commands) >= 6
    for command in commands:
        asked = {"shell": True, "capture_output": True, "text": True, "cwd": tmp_path, "timeout": 120}
        done = subprocess.run(command, env=os.environ | paths, **asked)
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"


def test_readme_links_exist() -> None:
    for name in ("README.md", "CONTRIBUTING.md"):
        for target in re.findall(r"\]\(([^)#]+)\)", (ROOT / name).read_text()):
            assert target.startswith("http") or (ROOT / target).exists(), f"{name} links to {target}"


def test_info_lists_tree_and_operations(tmp_path: Path) -> None:
    import json

    model = tmp_path / "arm.yaml"
    model.write_text(
        "symofros: 1\nsystem: {name: arm}\nbodies:\n"
        "  link: {joint: {name: q1, kind: revolute}, inertia: {mass: 1, center_of_mass: [0.5, 0, 0]}}\n"
    )
    command = [sys.executable, "-m", "symofros", "info", str(model)]
    text = subprocess.run(command, capture_output=True, text=True).stdout
    assert "link" in text and "revolute q1" in text and "mass_matrix" in text
    data = json.loads(subprocess.run([*command, "--json"], capture_output=True, text=True).stdout)
    assert data["nq"] == 1 and data["operations"]["bias"]["call"] >= 0


def test_command_line_reports_every_fault_and_fails(tmp_path: Path) -> None:
    model = tmp_path / "arm.yaml"
    model.write_text(
        "symofros: 1\nsystem: {name: arm}\nbodies:\n"
        "  link: {joint: {name: q1, kind: revolut}, inertia: {mass: -1}}\n  hand: {joint: {name: q2, parent: lnk}}\n"
    )
    done = subprocess.run([sys.executable, "-m", "symofros", "info", str(model)], capture_output=True, text=True)
    assert done.returncode == 2
    assert "arm.yaml:4" in done.stderr and "revolute" in done.stderr and "arm.yaml:5" in done.stderr


def test_compile_writes_the_source(tmp_path: Path) -> None:
    model = tmp_path / "arm.yaml"
    model.write_text(
        "symofros: 1\nsystem: {name: arm}\nbodies:\n"
        "  link: {joint: {name: q1, kind: revolute}, inertia: {mass: 1, center_of_mass: [0.5, 0, 0]}}\n"
    )
    command = [sys.executable, "-m", "symofros", "compile", str(model), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "arm.c").exists() and (tmp_path / "out" / "symofros_model.h").exists()


def test_the_example_of_the_file_format_is_a_model(tmp_path: Path) -> None:
    import symofros as sf

    text, *_ = re.findall(r"```yaml\n(.*?)```", (ROOT / "docs" / "yaml.md").read_text(), re.DOTALL)
    (tmp_path / "crane.yaml").write_text(text)
    model = sf.compile(sf.load(tmp_path / "crane.yaml"), sf.Options(backend="interpreter"))
    assert model.names.q == ("slew", "hoist") and model.names.u == ("winch", "slew")
