"""Imports run one way (DESIGN): who may import whom, read off the source."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent

# Room -> rooms it may import from. "errors" stands for errors.py, and so on.
ALLOWED: dict[str, set[str]] = {
    "errors": set(),
    "atomic": set(),
    "options": set(),
    "expr": {"errors"},
    "description": {"expr", "errors", "atomic"},
    "topology": {"beams", "description", "expr", "errors"},
    "beams": {"description", "expr", "errors"},
    "kinematics": {"beams", "topology", "description", "expr", "errors"},
    "dynamics": {"kinematics", "beams", "topology", "description", "expr", "errors"},
    "passes": {"expr", "options"},
    "runtime": {"errors", "options", "atomic"},
    "codegen": {"expr", "passes", "options", "runtime"},
    "compiler": {
        "errors", "options", "expr", "description", "beams", "topology", "kinematics", "dynamics", "passes", "codegen",
        "runtime",
    },
    "simulation": {"runtime", "errors", "atomic", "codegen"},
    # Packages carry the stepping loop and its methods; who compiles the model is the front door, exporting.py.
    # URDF and MJCF hold numbers, which topology's Numbers makes of formulas.
    # A diagram's package is made of its parts' C, written as the diagram is resolved.
    "exports": {
        "codegen", "runtime", "description", "topology", "expr", "simulation", "errors", "options", "atomic",
        "diagrams", "passes",
    },
    "exporting": {
        "exports", "compiler", "loading", "codegen", "description", "runtime", "simulation", "errors", "options",
        "diagrams",
    },
    # Advice compiles and simulates reduced systems, and counts what they take.
    "advice": {
        "compiler", "description", "expr", "passes", "runtime", "simulation", "errors", "options", "atomic",
    },
    # A diagram is one more program over the graph: its blocks are written beside the models' equations.
    "diagrams": {
        "compiler", "description", "topology", "kinematics", "dynamics", "expr", "passes", "codegen", "runtime",
        "simulation", "errors", "options",
    },
    # Formulas of blocks go through the parser of model files; one of them shows its model.
    "blocks": {"diagrams", "runtime", "simulation", "description", "expr", "viewing", "errors"},
    "diagram_files": {"blocks", "diagrams", "description", "loading", "simulation", "atomic", "errors"},
    # The editor checks documents itself, and hands the rest to workers that use the front doors.
    "gui": {
        "__init__", "atomic", "beams", "compiler", "description", "errors", "exporting", "expr", "passes", "simulation",
        "topology", "viewing",
    },
    "loading": {"errors", "atomic", "description", "topology"},
    # The picture compiles its own frame poses, plays trajectories, and closes loops; beams lend their shape.
    "viewing": {
        "beams", "compiler", "description", "diagrams", "loading", "runtime", "simulation", "topology", "errors",
        "options", "atomic", "__init__",
    },
    # What the command line shows of a run, as it goes or afterwards.
    "watching": {"blocks", "description", "diagrams", "simulation", "viewing"},
    "__init__": {
        "errors", "options", "expr", "description", "compiler", "loading", "exporting", "runtime", "simulation",
        "advice", "diagrams", "diagram_files", "viewing",
    },
}  # fmt: skip
ENGINES = {"pinocchio", "mujoco", "exudyn", "casadi"}


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            yield node.module or ""


def room(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


SOURCES = sorted((ROOT / "symofros").rglob("*.py"))


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_run_one_way(path: Path) -> None:
    own = path.relative_to(ROOT / "symofros").parts[0].removesuffix(".py")
    if own in ("__main__", "commands"):  # The command line may use everything.
        return
    for module in imported(path):
        if module.partition(".")[0] in {"validation", "reference_models"}:
            pytest.fail(f"{path.name} imports {module}: the generator knows nothing of its harness")
        if module.startswith("symofros") and room(module) != own:
            assert room(module) in ALLOWED[own], f"{own} may not import {module}"


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_only_freeze_looks_inside_sympy(path: Path) -> None:
    if path.name != "freeze.py":
        assert not any(module.partition(".")[0] == "sympy" for module in imported(path))


@pytest.mark.parametrize("path", sorted((ROOT / "validation").rglob("*.py")), ids=lambda p: str(p.relative_to(ROOT)))
def test_engines_stay_in_their_adapters(path: Path) -> None:
    if path.parent.name != "adapters":
        found = ENGINES & {module.partition(".")[0] for module in imported(path)}
        assert not found, f"{path.name} imports {found} outside its adapter"


def test_importing_the_package_is_light() -> None:
    """SymPy, pydantic, YAML, cffi and the command line's libraries load only when used."""
    import subprocess
    import sys

    code = "import sys, symofros; print(*sorted({m.partition('.')[0] for m in sys.modules}))"
    loaded = set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split())
    assert not loaded & {"sympy", "pydantic", "ruamel", "cffi", "typer", "rich", "jinja2", "viser", *ENGINES}
