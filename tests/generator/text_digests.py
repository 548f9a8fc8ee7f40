"""Digests of generated texts, printed for a parent process that compares them: python -m tests.generator.text_digests.

Argument: "few", one system of each kind that has constants of its own, "all" reference models and beam cases, or
"diagrams", the programs of diagrams with controllers, the order of their signals, and one system beside them.
"""

from __future__ import annotations

import hashlib
import json
import sys
import tempfile
from pathlib import Path

import reference_models
import symofros as sf
from reference_models.diagrams.square import square
from reference_models.diagrams.two_arms import working
from symofros.base.options import Options
from symofros.compiler import Compilation
from symofros.diagrams.program.compiled import resolve
from tests.mechanics.beams.cases import CASES
from validation.truth_data.catalogue import models as truth_models

FEW_FUNCTIONS = ("dynamics", "potential_energy")
ALL_FUNCTIONS = (*FEW_FUNCTIONS, "forward_dynamics", "kinetic_energy", "frame_pose")
# Every family of shape functions, tapered sections, rotations stated in every way, inertias made of random numbers.
FEW_CASES = ("tapered", "user's own", *(name for name in CASES if name.startswith("planar")))
FEW_MODELS = ("random_tree4", "chain7")


def formulas() -> sf.System:
    """Rotations stated in every way, and numbers by functions: glibc's cos(1.31) depends on the processor."""
    first = sf.Joint("a", "revolute", axis=(0.1, 0.2, 0.9), rotation=sf.Rotation.rpy(0.3, -0.7, 1.2))
    turned = sf.Rotation.axis_angle((1, 2, 2), "atan(0.4)")
    second = sf.Joint("b", "revolute", "arm", position=("sinh(0.2)", "cos(1.31)", "2^0.3"), rotation=turned)
    hand = sf.Frame("hand", rotation=sf.Rotation.quaternion(0.1, -0.3, 0.2, "cos(0.3)"))
    bodies = [
        sf.RigidBody("arm", first, sf.Inertia("exp(0.3)", ("sin(0.2)", 0, "tanh(0.7)"), ("cosh(0.3)", 1.3, "log(3)"))),
        sf.RigidBody("tool", second, sf.Inertia("pi/3", (0.1, 0, 0), (1, 1, 1)), (hand,)),
    ]
    return sf.System("formulas", bodies)


def systems(choice: str) -> dict[str, sf.System]:
    """Systems by name."""
    if choice == "all":
        cases, models = tuple(CASES), tuple(reference_models.MODELS)
    else:
        cases, models = FEW_CASES, FEW_MODELS
    beams = {name: CASES[name].system for name in cases}
    return {"formulas": formulas()} | beams | {name: reference_models.MODELS[name] for name in models}


def digest(system: sf.System, functions: tuple[str, ...]) -> str:
    """The digest of a system's description, record and C text."""
    compilation = Compilation(system, Options(functions))
    return hashlib.sha256(f"{system!r}{compilation.record!r}{compilation.source()}".encode()).hexdigest()


def diagram_digest(diagram: sf.Diagram) -> str:
    """The digest of the files of a diagram's program, and of the order of its signals."""
    with tempfile.TemporaryDirectory() as folder:
        sf.export(diagram, "c", folder)
        files = {file.name: file.read_text() for file in sorted(Path(folder).iterdir()) if file.is_file()}
    return hashlib.sha256(f"{files}{resolve(diagram).order}".encode()).hexdigest()


def digests(choice: str) -> dict[str, str]:
    """Digests by name of the system."""
    if choice == "diagrams":
        texts = {"square": diagram_digest(square(0)), "two_arms": diagram_digest(working())}
        return texts | {"formulas": digest(formulas(), FEW_FUNCTIONS)}
    functions = ALL_FUNCTIONS if choice == "all" else FEW_FUNCTIONS
    texts = {name: digest(system, functions) for name, system in systems(choice).items()}
    return texts | {f"truth: {m.name}": hashlib.sha256(repr(m.tree).encode()).hexdigest() for m in truth_models()}


if __name__ == "__main__":
    json.dump(digests(sys.argv[1]), sys.stdout)
