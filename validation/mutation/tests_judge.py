"""The tests as a judge of faults: those of the module, the likeliest first, until one fails.

Which tests belong to a module is read off the tests: the file that mirrors it, files whose path has the words of its
name, files that import it, files of the folder that mirrors its own.
"""

from __future__ import annotations

import ast
import os
import signal
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

# Folders of tests, and files, of what the study plants faults in.
FOLDERS = (
    "description expr mechanics generator identities runtime simulation native diagrams blocks reference exports"
    " interop base test_derived_once.py test_end_to_end.py test_public_arguments.py test_public_nonsense.py"
).split()
LIMIT = 300  # Of one test [s]: one that takes longer with a fault than this hangs.
HUNG = 77
MOST = 8  # Files of tests a module: all of them are imported before the first one runs.
_CONTACTS = (
    "tests/native/test_contact_problems.py",
    "tests/simulation/contacts/test_rigid_contacts.py",
    "tests/simulation/contacts/test_rigid_contacts_implicit.py",
    "tests/simulation/contacts/test_rigid_contacts_in_batches.py",
    "tests/simulation/contacts/test_landing.py",
    "tests/simulation/contacts/test_contact_scenes.py",
    "tests/simulation/contacts/test_rigid_heaps.py",
)
_BEAM_LIMITS = (
    "tests/simulation/beams/test_beam_limit.py",
    "tests/simulation/beams/test_stated_error.py",
    "tests/simulation/analysis/test_beam_theory.py",
)
# The tests of C lie with what calls it: folders of tests of a folder, files of tests of a file.
_MIRRORS = {
    "symofros/native/model": (
        "tests/mechanics/dynamics/constraints",
        "tests/native/test_solver_routines.py",
        "tests/generator/codegen",
        "tests/native",
        "tests/mechanics/dynamics/forward",
    ),
    "symofros/native/stepping": ("tests/simulation/stepping", "tests/simulation", "tests/native"),
    "symofros/native/stepping/methods/input_moments.c": (
        "tests/simulation/stepping",
        "tests/simulation/events/test_within_steps.py",
    ),
    # What packages and frameworks alone call.
    "symofros/native/stepping/instances/instance.c": (
        "tests/exports/c/test_c_package.py",
        "tests/exports/fmi/test_fmu_calls.py",
    ),
    "symofros/native/stepping/instances/linearize.c": (
        "tests/exports/fmi/test_fmu_calls.py",
        "tests/exports/c/test_c_package.py",
    ),
    # Steps by hand, signals, and what is written of formulas.
    "symofros/native/stepping/batches/by_hand.c": (
        "tests/simulation/steppers/test_stepper.py",
        "tests/simulation/steppers/test_steppers.py",
    ),
    "symofros/native/stepping/state/system.c": (
        "tests/simulation/stepping",
        "tests/simulation/events/test_held_samples.py",
        "tests/simulation/results/examination/test_input_impulses.py",
    ),
    "symofros/native/stepping/state/rotations.c": ("tests/simulation/stepping", "tests/runtime/test_manifold_c.py"),
    "symofros/native/stepping/batches": (
        "tests/simulation/stepping",
        "tests/simulation/test_simulate_batch.py",
        "tests/simulation/steppers/test_steppers.py",
    ),
    "symofros/native/stepping/contacts": ("tests/simulation", *_CONTACTS),
    "symofros/native/stepping/contacts/sticking.c": ("tests/simulation", "tests/simulation/contacts/test_sticking.py"),
    "symofros/native/stepping/events": (
        "tests/simulation/stepping",
        "tests/simulation/events/test_actions.py",
        "tests/simulation/steppers/test_actions_by_hand.py",
        "tests/simulation/events/test_within_steps.py",
        "tests/simulation/contacts/test_landing.py",
    ),
    "symofros/native/stepping/events/formula_instants.c": (
        "tests/expr/test_instants.py",
        "tests/simulation/events/test_within_steps.py",
    ),
    "symofros/native/stepping/instances": (
        "tests/exports/c/test_events.py",
        "tests/exports/fmi/test_fmu_states.py",
        "tests/exports/c/test_rigid_contacts.py",
    ),
    "symofros/native/stepping/posture": ("tests/simulation/analysis/kinematics",),
    "symofros/native/tape": ("tests/generator/codegen/test_tape.py",),
    "symofros/native/interop": ("tests/interop", "tests/interop/test_casadi.py"),
    # What judges the bending of beams, by tables of the generator.
    "symofros/native/stepping/beams/beams.c": _BEAM_LIMITS,
    "symofros/native/stepping/beams/axial_loads.c": _BEAM_LIMITS,
    "symofros/generator/beams.py": (*_BEAM_LIMITS, "tests/mechanics/beams/test_rod_services.py"),
    "symofros/native/diagrams": (
        "tests/diagrams/run",
        "tests/diagrams/run/test_runs.py",
        "tests/diagrams/run/test_crossings.py",
        "tests/blocks/generic",
        "tests/diagrams/program",
    ),
    "symofros/diagrams": ("tests/diagrams", "tests/diagrams/run/test_runs.py", "tests/diagrams/files/test_reading.py"),
    # Tests of what a user asks for, which have the names of the answers.
    "symofros/description/yaml": ("tests/description", "tests/description/test_files.py"),
    "symofros/description/urdf": (
        "tests/description",
        "tests/description/urdf/test_kinds.py",
        "tests/description/test_packages.py",
    ),
    "symofros/diagrams/run/simulate.py": (
        "tests/diagrams/run",
        "tests/diagrams/run/test_runs.py",
        "tests/diagrams/run/examination/test_controllers.py",
    ),
    "symofros/mechanics/beams/second_order": (
        "tests/mechanics/beams",
        "tests/mechanics/beams/test_lagrangian.py",
        "tests/mechanics/dynamics/bodies/test_beams.py",
    ),
    "symofros/mechanics/beams/strain": (
        "tests/mechanics/beams",
        "tests/mechanics/beams/test_rod.py",
        "tests/mechanics/beams/test_rod_outputs.py",
    ),
    "symofros/mechanics/dynamics/formulas.py": (
        "tests/mechanics/dynamics",
        "tests/simulation/events/test_conditions_by_forces.py",
    ),
    "symofros/mechanics/topology/sticking.py": (
        "tests/mechanics/topology",
        "tests/simulation/contacts/test_sticking.py",
    ),
    "symofros/mechanics/topology/beams.py": (
        "tests/mechanics/topology",
        "tests/mechanics/topology/test_beams.py",
        "tests/mechanics/beams/test_coupled_sections.py",
    ),
    "symofros/runtime/manifold.py": ("tests/runtime", "tests/simulation/analysis/test_rollout.py"),
    "symofros/runtime/methods/identification.py": ("tests/runtime", "tests/simulation/analysis/test_regressor.py"),
    "symofros/simulation/analysis/sliding.py": ("tests/simulation/analysis", *_CONTACTS[1:]),
    "symofros/simulation/stepping/batch_by_hand.py": (
        "tests/simulation/stepping",
        "tests/simulation/steppers/test_steppers.py",
        "tests/simulation/steppers/test_actions_by_hand.py",
    ),
    "symofros/generator/codegen/manifold.py": ("tests/generator/codegen", "tests/runtime/test_manifold_c.py"),
    "symofros/base": ("tests/base", "tests/test_public_arguments.py", "tests/test_public_nonsense.py"),
    "symofros/simulation/simulate_batch.py": (
        "tests/simulation",
        "tests/simulation/constraints/test_prescribed_motions.py",
    ),
}
# What watches the whole of the mechanics, of motions.
_GENERAL = {
    "symofros/blocks": ("tests/blocks/test_units.py", "tests/blocks/test_models.py"),
    "symofros/mechanics": ("tests/identities/test_dynamics.py", "tests/validation/procedures/test_catalogue.py"),
    "symofros/expr": ("tests/identities/test_dynamics.py", "tests/generator/codegen/test_c_equals_interpreter.py"),
    "symofros/generator": ("tests/generator/codegen/test_c_equals_interpreter.py",),
    "symofros/simulation": ("tests/simulation/test_simulate.py", "tests/simulation/stepping/test_orders.py"),
    "symofros/native": ("tests/simulation/test_simulate.py", "tests/runtime/test_project.py"),
    "symofros/description": ("tests/description/golden/test_golden.py", "tests/description/joints/test_joint_kinds.py"),
}


class _Listener:
    """Pytest plugin that records failures, exits at a test that hangs, and stops once the budget is spent."""

    def __init__(self) -> None:
        self.failed: list[str] = []
        self.budget = float("inf")

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        signal.signal(signal.SIGALRM, lambda *_: os._exit(HUNG))
        signal.alarm(LIMIT)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            self.failed.append(report.nodeid)

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed:
            self.failed.append(report.nodeid)

    def pytest_runtest_teardown(self, item: Any) -> None:
        if _spent() > self.budget:
            item.session.shouldstop = "out of time"


def _run(files: list[str], options: list[str], listener: _Listener) -> int:
    stated = [
        "-q",
        "-n0",
        "-p",
        "no:cacheprovider",
        "-o",
        "addopts=",
        "--benchmark-disable",
        "--tb=short",
        "--draw=faults",
    ]
    # In a process of its own, and part of the extra `test`: the harness starts without it.
    pytest: Any = import_module("pytest")
    return int(pytest.main([*stated, *options, *files], plugins=[listener]))


def _spent() -> float:
    """CPU time of this process and the children that it has waited for [s]; other processes do not count."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def judge(files: list[str], deselected: list[str], budget: float) -> dict[str, Any]:
    """Run tests until the first one fails.

    Args:
        files: Files of tests, in the order in which they run.
        deselected: Tests that fail without a fault, in a copy of the tree.
        budget: CPU time after which no further test begins [s].
    """
    listener = _Listener()
    listener.budget = budget
    options = ["-x", *(f"--deselect={name}" for name in deselected)]
    code = _run(files, options, listener)
    if listener.failed:
        return {"status": "failed", "test": listener.failed[0]}
    if code in (0, 5) or _spent() > budget:
        return {"status": "passed", "files": len(files), "whole": _spent() <= budget}
    return {"status": "failed", "test": f"pytest ends with code {code}"}


@cache
def _imports(file: Path) -> frozenset[str]:
    """Paths of modules and names that a test file imports, such as `symofros/mechanics/beams/fields`."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return frozenset(name.replace(".", "/") for name in names)


def test_files(root: Path) -> list[str]:
    """The files of tests that are asked, by their paths from the repository's folder."""
    places = [root / "tests" / name for name in FOLDERS]
    files = {path for place in places for path in ([place] if place.suffix else place.rglob("test_*.py"))}
    return sorted(path.relative_to(root).as_posix() for path in files)


def _words(path: Path) -> frozenset[str]:
    """Words of a path's folders and name, in the singular."""
    return frozenset(word.removesuffix("s") for part in path.with_suffix("").parts for word in part.split("_"))


def chosen(root: Path, module: str) -> list[str]:
    """The tests of a module, the likeliest to see a fault first."""
    path = Path(module)
    folder_of_tests = Path("tests", *path.parts[1:-1])
    mirror = (folder_of_tests if (root / folder_of_tests).is_dir() else folder_of_tests.parent).as_posix()
    places = (path, path.parent) if (root / folder_of_tests).is_dir() else (path, *path.parents)
    mirrors = next((_MIRRORS[place.as_posix()] for place in places if place.as_posix() in _MIRRORS), (mirror,))
    general = _GENERAL.get("/".join(path.parts[:2]), ())
    name = _words(Path(path.name.partition(".")[0]))
    ranked = []
    for file in test_files(root):
        folder, beside = file.rpartition("/")[0], file.split("/")[1] == mirrors[0].split("/")[1]
        if file in (f"{mirror}/test_{path.stem}.py", f"{mirror}/test_{path.parent.name}.py", *mirrors):
            rank = 0
        elif beside and name <= _words(Path(file)):
            rank = 1
        elif module.removesuffix(".py") in _imports(root / file):
            rank = 2 if beside else 9
        elif folder in mirrors:
            rank = 3 if name & _words(Path(file).relative_to(folder)) else 4 + mirrors.index(folder)
        elif file in general:
            rank = 10
        elif any(file.startswith(f"{place}/") for place in mirrors):
            rank = 11
        else:
            continue
        ranked.append((rank, (root / file).stat().st_size, file))
    return [file for *_, file in sorted(ranked)][:MOST]
