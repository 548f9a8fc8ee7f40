"""Imports run one way (DESIGN): who may import whom, read off the source."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

from tests.borders import ROOT, absolute, import_statements, listed, modules_of, names_offered, over_the_waist
from validation.adapters import ROUTES


def table(text: str) -> dict[str, set[str]]:
    """Lines "layer: layers it may import from", continued in lines without a colon; comments begin with #."""
    rows: dict[str, set[str]] = {}
    layer = ""
    for line in text.splitlines():
        if not line.strip().startswith("#"):
            name, colon, others = line.rpartition(":")
            layer = name.strip() if colon else layer
            rows.setdefault(layer, set()).update(others.split())
    return {layer: others for layer, others in rows.items() if layer}


# "errors" stands for errors.py, and so on.
ALLOWED = table("""
    errors:
    # Where the harness is, by name: it is loaded by those who are asked for it, and by nobody else.
    harness: errors
    # Options of reading are those of commands; tests/validation/ci/test_plugin.py tells where that loads more.
    pytest_plugin: errors harness commands
    base: errors
    native:
    expr: base errors
    description: base errors expr
    # What the mechanics of one frame are made of; a theory of beams answers in it.
    mechanics.spatial: base expr description
    mechanics.beams: expr description mechanics.spatial
    mechanics.topology: base errors expr description mechanics.beams
    mechanics.kinematics: base expr description mechanics.spatial mechanics.beams mechanics.topology
    mechanics.dynamics: base errors expr description mechanics.spatial mechanics.beams mechanics.topology
        mechanics.kinematics
    generator.passes: expr
    # Declarations and constants are read from the headers of native.
    runtime: base errors native
    generator.codegen: base native expr generator.passes runtime
    # The stages of the pipeline between mechanics and the model, which the compiler puts together.
    generator.record: base expr description mechanics.beams mechanics.topology mechanics.kinematics
        mechanics.dynamics runtime
    # The beams as numbers, which judge how far results bend them; what the constraints' Jacobian says of those that
    # can't stretch.
    generator.beams: expr description mechanics.beams mechanics.topology runtime
    # When formulas of time bend or jump, which steps end at.
    generator.instants: base expr description mechanics.topology mechanics.kinematics mechanics.dynamics
        generator.codegen runtime
    generator.programs: base errors expr mechanics.topology mechanics.kinematics mechanics.dynamics
        generator.passes generator.codegen
    generator.units: base errors native expr mechanics.topology mechanics.dynamics generator.passes runtime
        generator.codegen generator.record generator.programs
    compiler: base errors expr description mechanics.topology mechanics.dynamics runtime generator.passes
        generator.codegen generator.record generator.beams generator.instants
        generator.programs generator.units
    loading: base errors description mechanics.topology
    # What follows are the wings, which take of these folders what the waist offers; see `WAIST`.
    simulation: base errors native runtime
    # A diagram is one more program over the graph: its blocks are written beside the models' equations.
    diagrams: base errors native expr description generator runtime compiler simulation
    # Formulas of blocks go through the parser of model files; one of them shows its model.
    blocks: base errors expr description runtime simulation diagrams studio.viewer
    diagrams.files: base errors description loading simulation diagrams blocks
    # Packages carry the stepping loop and its methods; the front door, exporting.py, compiles the model.
    # URDF and MJCF hold numbers, which topology's Numbers makes of formulas.
    # A diagram's package is made of its parts' C, written as the diagram is resolved.
    exports: base errors native expr description mechanics.topology generator runtime compiler loading
        simulation diagrams
    # Models in other frameworks, each of them imported by its own module alone.
    interop: base errors native expr description compiler runtime simulation
    # Advice compiles and simulates reduced systems, and counts what they take; rods tell what their sections resist.
    studio.advice: base errors expr description mechanics.beams runtime compiler simulation
    # Files are read, and their bodies are numbers as they are for files without formulas.
    studio.differences: base errors description mechanics.topology loading exports
    # The picture compiles its own frame poses, plays trajectories, and closes loops; beams lend their shape.
    studio.viewer: base errors description mechanics.beams mechanics.topology runtime compiler loading
        simulation diagrams exports
    # The editor checks documents itself, and hands the rest to workers that use the front doors.
    studio.editor: base errors expr description mechanics.beams mechanics.topology
        runtime compiler simulation diagrams diagrams.files exports studio.viewer harness __init__
    # What tools that look inside may use; nothing in the package imports it.
    tools: base description compiler expr generator.passes runtime simulation diagrams
        studio.viewer studio.editor
    __init__: base errors expr description runtime compiler loading simulation diagrams diagrams.files
        exports interop studio.advice studio.differences studio.viewer
""")

# The same of the harness: what a check is made of ...
HARNESS = table("""
    mechanics:
    references:
    program:
    contract:    mechanics
    inputs:      references contract mechanics
    # Processes that do jobs of any of them; the other side imports what a job names.
    worker_loop:
    worker_process: worker_loop
    # Real faults of releases, and the environments that releases are asked in.
    faults:      program reporting
    # Engines in their own conventions, and the truth that they are held to: what a check asks them is turned into ours.
    engines:     program contract reporting worker_process faults
    adapters:    engines contract mechanics
    comparison:  adapters contract mechanics
    procedures:  references comparison contract mechanics
    checking:    references procedures comparison adapters inputs contract mechanics
    worker_pool: checking adapters inputs worker_process
    reporting:   program mechanics
""")
# ... and what builds on it: any of the above, and these others.
STUDIES = table("""
    oracle:
    truth_data:
    recall:
    cross_check:
    ci:          cross_check
    campaigns:
    diagrams:
    accuracy:
    timing:      oracle
    environments: timing
    cuda:        timing
    stability:
    studies:     oracle timing
    pareto:      stability timing
    adversary:   accuracy
    mutation:
    dashboard:   adversary cross_check cuda environments campaigns diagrams accuracy timing stability
                 studies pareto mutation recall
""")
# The oracle answers for itself: of the harness it knows how joints come apart, and the models, nothing else.
MAY_USE = (
    HARNESS
    | {name: others | set(HARNESS) for name, others in STUDIES.items()}
    | {"oracle": {"mechanics", "references"}, "__init__": {"cross_check"}}
)

ENGINES = {route.package for route in ROUTES.values()} - {""}
# Folder of validation/adapters -> the engine that it alone may import.
ADAPTERS = {name: name for name in ENGINES} | {
    route.module.split(".")[2]: route.package for route in ROUTES.values() if route.package
}


@cache
def imported(path: Path) -> tuple[str, ...]:
    modules: list[str] = []
    for node in import_statements(path):
        if isinstance(node, ast.Import):
            modules += (alias.name for alias in node.names)
        else:
            module = absolute(path, node)
            if module in ("validation", "validation.adapters"):  # What is taken from them may be a layer.
                modules += (f"{module}.{alias.name}" for alias in node.names)
            else:
                modules.append(module)
    return tuple(modules)


# Folders whose subfolders are layers of their own.
DIVIDED = {"mechanics", "generator", "studio"}


def layer(module: str) -> str:
    """The layer that a module belongs to: its folder, or its subfolder where the folder is divided."""
    package, *parts = module.split(".")
    if package == "symofros" and (parts[:2] == ["diagrams", "files"] or (parts and parts[0] in DIVIDED)):
        return ".".join(parts[:2])
    return parts[0] if parts else "__init__"


SOURCES = sorted((ROOT / "symofros").rglob("*.py"))
HARNESS_SOURCES = sorted((ROOT / "validation").rglob("*.py"))
REFERENCE_SOURCES = sorted((ROOT / "reference_models").rglob("*.py"))


def check_all(paths: Iterable[Path], faults: Callable[[Path], Iterable[str]]) -> None:
    """Each file against a rule, with all that breaks it in one message."""
    broken = [f"{path.relative_to(ROOT)}: {fault}" for path in paths for fault in faults(path)]
    assert not broken, "\n".join(broken)


def test_imports_run_one_way() -> None:
    def faults(path: Path) -> Iterator[str]:
        own = layer(".".join(path.relative_to(ROOT).with_suffix("").parts))
        # The command line may use all.
        if own in ("__main__", "commands") or path.name == "__init__.py" and path.parent.name in DIVIDED:
            return
        for module in imported(path):
            if module.partition(".")[0] in {"validation", "reference_models"}:
                yield f"imports {module}: the generator knows nothing of its harness"
            if module.startswith("symofros") and layer(module) != own and layer(module) not in ALLOWED[own]:
                yield f"{own} may not import {module}"

    check_all(SOURCES, faults)


def test_wings_import_only_the_waist_from_the_core() -> None:
    waist = listed("The waist")
    taken = {item.module.removeprefix("symofros."): item for item in over_the_waist()}
    beside = sorted(taken[module] for module in taken.keys() - waist.keys())
    assert not beside, "\n".join(f"{user}: '{name}' of {module} is not on the waist" for user, module, name in beside)
    assert waist.keys() <= taken.keys(), "the waist offers what nobody takes"


def test_an_import_beside_the_waist_is_seen(tmp_path: Path) -> None:
    lines = (
        "from symofros.mechanics.topology.tree import Link",
        "from symofros.mechanics import topology",
        "topology.go()",
    )
    for name, text in {"mechanics/topology/tree.py": "", "blocks/lights.py": "\n".join(lines)}.items():
        file = tmp_path / "symofros" / name
        file.parent.mkdir(parents=True)
        for folder in (file.parent, file.parent.parent):
            (folder / "__init__.py").touch()
        file.write_text(text)
    seen = over_the_waist(tmp_path)
    assert [item[1:] for item in seen] == [
        ("symofros.mechanics.topology.tree", "Link"),
        ("symofros.mechanics.topology", "go"),
    ]


def test_folders_of_the_waist_export_only_used_names() -> None:
    """A face is no store: what no wing imports of a folder's `__init__` leaves it."""
    packages = {f"symofros.{name}" for name in listed("The waist")}
    taken = {(item.module, item.name) for item in over_the_waist()}
    unused = [
        f"{module}: {name}"
        for module, path in modules_of(ROOT, "symofros").items()
        if module in packages and path.name == "__init__.py"
        for name in sorted(names_offered(path))
        if (module, name) not in taken
    ]
    assert not unused, "\n".join(unused)


# Names of modules that are installed under another name than that of their folder.
_NAMED = re.compile(r"(symofros\.)?(validation|reference_models)(\.\w+)*")
_BY_NAME = {"import_module", "find_spec", "files", "run_module"}
# The harness's name is stated by one; the other's judges run in a copy of the repository, which is a checkout.
_MAY_NAME = {"symofros/harness.py", "validation/mutation/study.py"}


def test_modules_with_two_names_are_named_in_one_place() -> None:
    """What a wheel installs within `symofros` finds itself by relative imports, and others find it by `harness.py`."""

    def faults(path: Path) -> Iterator[str]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                if "." in node.value and _NAMED.fullmatch(node.value) and not node.value.endswith(".py"):
                    yield f"names {node.value}"
            elif isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in _BY_NAME:
                for value in node.args:
                    if isinstance(value, ast.Constant) and _NAMED.fullmatch(str(value.value)):
                        yield f"finds {value.value} by name"

    sources = (*SOURCES, *HARNESS_SOURCES, *REFERENCE_SOURCES)
    check_all([path for path in sources if path.relative_to(ROOT).as_posix() not in _MAY_NAME], faults)


def test_imports_are_absolute_in_symofros_and_relative_in_the_harness() -> None:
    """The reference models are stated by their name for type checkers alone, who see a checkout."""

    def faults(path: Path) -> Iterator[str]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
                for_types.update(map(id, node.body))
            if isinstance(node, ast.ImportFrom) and node.level and path in SOURCES:
                yield f"line {node.lineno}: a relative import"
            if isinstance(node, ast.Import | ast.ImportFrom) and path not in SOURCES:
                names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
                absolute_ones = isinstance(node, ast.Import) or not node.level
                wrong = {name for name in names if _NAMED.fullmatch(name)} if absolute_ones else set()
                if wrong and not (
                    id(node) in for_types and wrong <= {n for n in wrong if n.startswith("reference_models")}
                ):
                    yield f"line {node.lineno}: {', '.join(wrong)}: not relative"

    for_types: set[int] = set()  # Statements for type checkers; a walk comes to them after the condition.
    check_all((*SOURCES, *HARNESS_SOURCES, *REFERENCE_SOURCES), faults)


def test_an_import_within_a_function_states_its_reason_on_its_line() -> None:
    """A package that may be missing, or seconds that others need not wait; a circle is cured by structure."""

    def faults(path: Path) -> Iterator[str]:
        lines = path.read_text().splitlines()
        kinds = ast.FunctionDef | ast.AsyncFunctionDef
        functions = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, kinds)]
        for node in import_statements(path):
            within = any(f.lineno < node.lineno <= (f.end_lineno or 0) for f in functions)
            if within and "  # " not in lines[node.lineno - 1]:
                yield f"line {node.lineno}: an import within a function, without its reason"

    check_all((*SOURCES, *HARNESS_SOURCES), faults)


def test_sympy_is_at_the_doors_only() -> None:
    """Where its expressions come in, and where people read them."""
    doors = {"symofros/expr/freeze.py", "symofros/exports/equations/formulas.py"}
    others = [path for path in SOURCES if path.relative_to(ROOT).as_posix() not in doors]
    check_all(others, lambda path: [name for name in imported(path) if name.partition(".")[0] == "sympy"])


# What the harness, as any tool beside the package, may import of it: the rest may change without notice.
PUBLIC = set(listed("What others may import"))
PACKAGE_MODULES = {".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for path in SOURCES}


def test_the_harness_imports_public_modules_only() -> None:
    def faults(path: Path) -> Iterator[str]:
        for node in import_statements(path):
            if isinstance(node, ast.Import):
                modules = {alias.name for alias in node.names}
            else:
                module = absolute(path, node)
                packages = {f"{module}.{alias.name}" for alias in node.names} & PACKAGE_MODULES
                modules = packages | ({module} if len(packages) < len(node.names) else set())
            yield from {module for module in modules if module.partition(".")[0] == "symofros"} - PUBLIC

    check_all(HARNESS_SOURCES, faults)


# Adapters that need no engine: all others may use them.
BESIDE = {path.stem for path in (ROOT / "validation/adapters").glob("*.py")}


def test_imports_of_the_harness_run_one_way() -> None:
    def faults(path: Path) -> Iterator[str]:
        own = path.relative_to(ROOT / "validation").parts[0].removesuffix(".py")
        if own in ("__main__", "commands"):  # The command line may use everything.
            return
        for module in imported(path):
            if module.partition(".")[0] == "validation" and layer(module) not in MAY_USE[own] | {own}:
                yield f"{own} may not import {module}"

    check_all(HARNESS_SOURCES, faults)


def test_engines_stay_in_their_adapters() -> None:
    """And adapters of one engine know nothing of another's."""

    def faults(path: Path) -> Iterator[str]:
        folder = path.parent.relative_to(ROOT / "validation").parts
        own = folder[1] if folder[:1] == ("adapters",) and len(folder) > 1 else ""
        for module in imported(path):
            package = module.partition(".")[0]
            if package in ENGINES and package != ADAPTERS.get(own):
                yield f"imports {package} outside its folder"
            if folder[:1] == ("adapters",) and module.startswith("validation.adapters."):
                engine = module.split(".")[2]
                if engine not in (own, *BESIDE):
                    yield f"adapters of '{own}' may not import {module}"

    check_all(HARNESS_SOURCES, faults)


def test_importing_the_package_loads_no_other_package() -> None:
    """Other dependencies of the base install load when they are used; those of extras may be missing altogether."""
    code = "import sys; before = set(sys.modules); import symofros; print(*(set(sys.modules) - before))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    packages = {module.partition(".")[0] for module in loaded} - set(sys.stdlib_module_names)
    assert packages == {"symofros"}


def _imported_modules(path: Path, known: Collection[str]) -> set[str]:
    """The modules of ours that a file imports, for type checkers and within functions, too."""
    names: set[str] = set()
    for node in import_statements(path):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        else:
            module = absolute(path, node)
            names |= {f"{module}.{alias.name}" for alias in node.names} & set(known) or {module}
    return names & set(known)


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Imports for type checkers count: what two modules share belongs into a lower one."""
    modules = modules_of(ROOT, "symofros", "validation", "reference_models")
    order = TopologicalSorter({name: _imported_modules(path, modules) - {name} for name, path in modules.items()})
    order.prepare()
