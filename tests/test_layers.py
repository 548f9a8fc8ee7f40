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
    "functions": set(),
    "native": set(),
    "rotations": set(),
    "expr": {"errors"},
    "description": {"expr", "errors", "atomic", "rotations"},
    "mechanics.topology": {"mechanics.beams", "description", "expr", "errors", "rotations"},
    "mechanics.beams": {"description", "expr", "errors"},
    "mechanics.kinematics": {"mechanics.beams", "mechanics.topology", "description", "expr", "errors"},
    "mechanics.dynamics": {
        "mechanics.kinematics",
        "mechanics.beams",
        "mechanics.topology",
        "description",
        "expr",
        "errors",
        "functions",
    },
    "generator.passes": {"expr", "options"},
    "runtime": {"errors", "functions", "options", "atomic", "rotations"},
    "generator.codegen": {"native", "expr", "generator.passes", "options", "runtime"},
    # The stages of the pipeline between mechanics and the model, which the compiler puts together.
    "generator.record": {
        "description",
        "expr",
        "mechanics.beams",
        "mechanics.dynamics",
        "mechanics.kinematics",
        "mechanics.topology",
        "options",
        "runtime",
    },
    "generator.programs": {
        "errors",
        "expr",
        "functions",
        "generator.codegen",
        "generator.passes",
        "mechanics.dynamics",
        "mechanics.topology",
        "options",
    },
    "generator.units": {
        "description",
        "errors",
        "expr",
        "generator.codegen",
        "generator.passes",
        "generator.programs",
        "generator.record",
        "mechanics.dynamics",
        "native",
        "options",
        "runtime",
    },
    "compiler": {
        "description",
        "errors",
        "expr",
        "generator.codegen",
        "generator.programs",
        "generator.record",
        "generator.units",
        "mechanics.dynamics",
        "mechanics.topology",
        "options",
        "runtime",
    },
    "simulation": {"native", "runtime", "errors", "atomic", "generator.codegen"},
    # Packages carry the stepping loop and its methods; the front door, exporting.py, compiles the model.
    # URDF and MJCF hold numbers, which topology's Numbers makes of formulas.
    # A diagram's package is made of its parts' C, written as the diagram is resolved.
    "exports": {
        "generator.codegen",
        "runtime",
        "rotations",
        "description",
        "mechanics.topology",
        "expr",
        "simulation",
        "errors",
        "options",
        "atomic",
        "diagrams",
        "functions",
        "generator.passes",
        "compiler",
        "loading",
        "native",
    },
    # Advice compiles and simulates reduced systems, and counts what they take.
    "studio.advice": {
        "compiler",
        "description",
        "expr",
        "generator.passes",
        "runtime",
        "simulation",
        "errors",
        "options",
        "atomic",
    },
    # A diagram is one more program over the graph: its blocks are written beside the models' equations.
    "diagrams": {
        "native",
        "compiler",
        "description",
        "mechanics.topology",
        "mechanics.kinematics",
        "mechanics.dynamics",
        "expr",
        "functions",
        "generator.passes",
        "generator.codegen",
        "generator.programs",
        "generator.record",
        "runtime",
        "simulation",
        "errors",
        "options",
    },
    # Formulas of blocks go through the parser of model files; one of them shows its model.
    "blocks": {"diagrams", "runtime", "simulation", "description", "expr", "studio.viewer", "errors"},
    "diagrams.files": {"blocks", "diagrams", "description", "loading", "simulation", "atomic", "errors"},
    # The editor checks documents itself, and hands the rest to workers that use the front doors.
    "studio.editor": {
        "__init__",
        "atomic",
        "mechanics.beams",
        "compiler",
        "description",
        "errors",
        "exports",
        "expr",
        "functions",
        "generator.passes",
        "simulation",
        "mechanics.topology",
        "studio.viewer",
    },
    "loading": {"errors", "atomic", "description", "mechanics.topology"},
    # The picture compiles its own frame poses, plays trajectories, and closes loops; beams lend their shape.
    "studio.viewer": {
        "mechanics.beams",
        "compiler",
        "description",
        "diagrams",
        "loading",
        "runtime",
        "simulation",
        "mechanics.topology",
        "errors",
        "options",
        "atomic",
        "__init__",
    },
    "__init__": {
        "errors",
        "options",
        "expr",
        "description",
        "compiler",
        "loading",
        "exports",
        "runtime",
        "simulation",
        "studio.advice",
        "diagrams",
        "diagrams.files",
        "studio.viewer",
    },
}

# The same of the harness: what a check is made of ...
HARNESS: dict[str, set[str]] = {
    "mechanics": set(),
    "contract": {"mechanics"},
    "inputs": {"contract", "mechanics"},
    "adapters": {"contract", "mechanics"},
    "comparison": {"adapters", "contract", "mechanics"},
    "check": {"comparison", "adapters", "inputs", "contract", "mechanics"},
    "worker_pool": {"check", "adapters", "inputs"},
    "evidence": {"mechanics"},
    "reporting": {"evidence", "worker_pool", "check", "comparison", "adapters", "contract"},
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


# Folders whose subfolders are layers of their own.
DIVIDED = {"mechanics", "generator", "studio"}


def room(module: str) -> str:
    """The layer that a module belongs to: its folder, or its subfolder where the folder is divided."""
    package, *parts = module.split(".")
    if package == "symofros" and (parts[:2] == ["diagrams", "files"] or (parts and parts[0] in DIVIDED)):
        return ".".join(parts[:2])
    return parts[0] if parts else "__init__"


SOURCES = sorted((ROOT / "symofros").rglob("*.py"))


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_run_one_way(path: Path) -> None:
    own = room(".".join(path.relative_to(ROOT).with_suffix("").parts))
    if (
        own in ("__main__", "commands") or path.name == "__init__.py" and own in DIVIDED
    ):  # The command line may use all.
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
