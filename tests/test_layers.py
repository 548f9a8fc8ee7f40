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

# The same of the harness: what a check is made of ...
HARNESS: dict[str, set[str]] = {
    "mechanics": set(),
    "contract": {"mechanics"},
    "inputs": {"contract", "mechanics"},
    "adapters": {"contract", "mechanics"},
    "comparison": {"adapters", "contract", "mechanics"},
    "check": {"comparison", "adapters", "inputs", "contract", "mechanics"},
    "crew": {"check", "adapters", "inputs"},
    "evidence": {"mechanics"},
    "reporting": {"evidence", "crew", "check", "comparison", "adapters", "contract"},
}
# ... and what builds on it: any of the above, and these others.
STUDIES: dict[str, set[str]] = {
    "oracle": set(),
    "questions": set(),
    "campaigns": set(),
    "diagrams": {"questions"},
    "accuracy": {"questions"},
    "timing": {"oracle"},
    "passes": {"timing"},
    "stability": {"accuracy"},
    "studies": {"accuracy", "oracle", "stability", "timing"},
    "pareto": {"stability", "studies", "timing"},
    "dashboard": {"passes"},
}
# The oracle answers for itself: of the harness it knows how joints come apart, nothing else.
MAY_USE = HARNESS | {name: others | set(HARNESS) for name, others in STUDIES.items()} | {"oracle": {"mechanics"}}

ENGINES = {"pinocchio", "mujoco", "exudyn", "casadi"}
# Room of validation/adapters -> the engine that it alone may import; Lagrange's equations are differentiated by CasADi.
ADAPTERS = {name: name for name in ENGINES} | {"lagrangian": "casadi"}


def imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            module = node.module or ""
            if module in ("validation", "validation.adapters"):  # What is taken from them may be a room.
                yield from (f"{module}.{alias.name}" for alias in node.names)
            else:
                yield module


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


HARNESS_SOURCES = sorted((ROOT / "validation").rglob("*.py"))
# Adapters that need no engine: all others may use them.
BESIDE = {path.stem for path in (ROOT / "validation/adapters").glob("*.py")}


@pytest.mark.parametrize("path", HARNESS_SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_of_the_harness_run_one_way(path: Path) -> None:
    own = path.relative_to(ROOT / "validation").parts[0].removesuffix(".py")
    if own == "__main__":  # The command line may use everything.
        return
    for module in imported(path):
        if module.partition(".")[0] == "validation" and room(module) != own:
            assert room(module) in MAY_USE[own], f"{own} may not import {module}"


@pytest.mark.parametrize("path", HARNESS_SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_engines_stay_in_their_adapters(path: Path) -> None:
    """And adapters of one engine know nothing of another's."""
    folder = path.parent.relative_to(ROOT / "validation").parts
    own = folder[1] if folder[:1] == ("adapters",) and len(folder) > 1 else ""
    for module in imported(path):
        package = module.partition(".")[0]
        assert package not in ENGINES or package == ADAPTERS.get(own), f"{path.name} imports {package} outside its room"
        if folder[:1] == ("adapters",) and module.startswith("validation.adapters."):
            engine = module.split(".")[2]
            assert engine in (own, *BESIDE), f"adapters of '{own}' may not import {module}"


def test_importing_the_package_is_light() -> None:
    """SymPy, pydantic, YAML, cffi and the command line's libraries load only when used."""
    import subprocess
    import sys

    code = "import sys, symofros; print(*sorted({m.partition('.')[0] for m in sys.modules}))"
    loaded = set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split())
    assert not loaded & {"sympy", "pydantic", "ruamel", "cffi", "typer", "rich", "jinja2", "viser", *ENGINES}
