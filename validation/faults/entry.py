"""One real fault: what is wrong in which release, and the script that shows it."""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any, Literal

from ruamel.yaml import YAML

FOLDER = Path(__file__).parent / "entries"
FROZEN = Path(__file__).parent / "frozen.txt"
LINES = 25
KINDS = (
    "dynamics",
    "kinematics",
    "step",
    "reaction",
    "sensor",
    "reader",
    "writer",
    "constraint",
    "actuator",
    "passive force",
    "flexible body",
    "mass properties",
)
# Engine, by its name on PyPI -> the packages by which its scripts may import it.
PACKAGES = {
    "PyNiteFEA": {"Pynite"},
    "adam-robotics": {"adam"},
    "bsk": {"Basilisk"},
    "casadi": {"casadi"},
    "dartpy": {"dartpy"},
    "drake": {"pydrake"},
    "exudyn": {"exudyn"},
    "idyntree": {"idyntree"},
    "mink": {"mink", "mujoco"},
    "mujoco": {"mujoco"},
    "mujoco-mjx": {"jax", "mujoco"},
    "mujoco-warp": {"mujoco", "mujoco_warp"},
    "newton": {"newton", "pxr", "warp"},
    "pin": {"pinocchio"},
    "pybullet": {"pybullet", "pybullet_utils"},
    "roboticstoolbox-python": {"roboticstoolbox", "spatialmath"},
    "rocketpy": {"rocketpy"},
    "scikit-robot": {"skrobot"},
    "spatialmath-python": {"spatialmath"},
    "sympy": {"sympy"},
    "trimesh": {"trimesh"},
    "yourdfpy": {"yourdfpy"},
}
Side = Literal["wrong", "right"]


@dataclass(frozen=True)
class Subject:
    """What of an engine is wrong; what its script calls besides is not.

    Attributes:
        functions: The engine's names of the functions whose values are wrong, or the matrix's where the engine has one
            name for several; none where a reader makes a wrong mechanism, which shows in all of them.
        shown_in: Words for trees or files that the fault shows in; none where it shows in all that have the function.
    """

    functions: list[str]
    shown_in: list[str]


@dataclass(frozen=True)
class Fault:
    """A wrong number of a release, as its file states it.

    Attributes:
        name: Name of the file.
        engine: Name on PyPI.
        wrong: A release that has the fault.
        right: The first release tried that is free of it; None: none yet.
        requires: Further requirements of the environment, as pip takes them.
        thread: Issue, pull request, commit or changelog; or "none found".
        kind: What the fault is about, one of `KINDS` (`class` in the file).
        fault: What is wrong, in one sentence.
        subject: What of the engine is wrong.
        expected: The right value.
        follows: How the right value follows.
        tolerance: Largest error that counts as right.
        reproduced: What the script printed with the wrong release.
        corrected: What it printed with the right one; None where there is none.
        script: Imports the engine, and prints the value last.
    """

    name: str
    engine: str
    wrong: str
    right: str | None
    requires: list[str]
    thread: str
    kind: str
    fault: str
    subject: Subject
    expected: float
    follows: str
    tolerance: float
    reproduced: float
    corrected: float | None
    script: str

    def is_right(self, value: float) -> bool:
        """Whether a value is the right one; nan is not."""
        return abs(value - self.expected) <= self.tolerance

    def release(self, side: Side) -> str | None:
        """The release of a side; None where there is none yet."""
        return self.wrong if side == "wrong" else self.right

    def requirements(self, side: Side) -> list[str]:
        """What pip installs to ask the release of a side."""
        return [f"{self.engine}=={self.release(side)}", *self.requires]


@cache
def faults() -> dict[str, Fault]:
    """All faults by name.

    Raises:
        ValueError: A file breaks a rule, with the rule.
    """
    return {path.stem: read(path) for path in sorted(FOLDER.glob("*.yaml"))}


def frozen() -> frozenset[str]:
    """Names of the faults that the harness is judged by, and must not be made with."""
    lines = FROZEN.read_text(encoding="utf-8").splitlines() if FROZEN.is_file() else []
    return frozenset(line for line in lines if line and not line.startswith("#"))


def read(path: Path) -> Fault:
    """The fault that a file states.

    Raises:
        ValueError: The file breaks a rule, with the rule.
    """
    stated: dict[str, Any] = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
    stated = {"name": path.stem, "kind": stated.pop("class", None), **stated}
    names = {field.name for field in fields(Fault)}
    if set(stated) != names:
        raise ValueError(f"{path.name}: entries missing or unknown: {sorted(names ^ set(stated))}")
    fault = Fault(**stated | {"subject": Subject(**stated["subject"])})
    for broken, rule in _rules(fault):
        if broken:
            raise ValueError(f"{path.name}: {rule}")
    return fault


def _rules(fault: Fault) -> list[tuple[bool, str]]:
    """Whether each rule of an entry is broken, and the rule in words."""
    foreign = _imported(fault.script) - PACKAGES.get(fault.engine, set()) - {"numpy"} - set(sys.stdlib_module_names)
    return [
        (fault.engine not in PACKAGES, f"the engine is one of {', '.join(PACKAGES)}"),
        (fault.kind not in KINDS, f"the class is one of {', '.join(KINDS)}"),
        (len(fault.script.splitlines()) > LINES, f"a script has at most {LINES} lines"),
        (not (fault.subject.functions or fault.subject.shown_in), "a subject names functions, or what it is shown in"),
        (bool(foreign), f"a script imports its engine and numpy alone, not {', '.join(sorted(foreign))}"),
        (fault.is_right(fault.reproduced), "the wrong release's value differs from the right one"),
        ((fault.right is None) != (fault.corrected is None), "a right release has a value, and only that"),
        (fault.corrected is not None and not fault.is_right(fault.corrected), "the right release's value is right"),
        (not (fault.thread.startswith("https://") or fault.thread == "none found"), "a thread is an address"),
        (fault.thread == "none found" and fault.right is not None, "what was mended has a thread"),
    ]


def _imported(script: str) -> set[str]:
    """Top-level packages that a script imports."""
    found = set()
    for node in ast.walk(ast.parse(script)):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(str(node.module).partition(".")[0])
    return found
