"""Which files faults are planted in, and which of all possible faults are drawn."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

from .c_faults import c_faults
from .fault import SourceFault
from .fresh import Fresh
from .python_faults import python_faults

# What forms equations, programs, C and motions; files that only speak, draw or store are left out.
SCOPE = (
    "symofros/description/values.py",
    "symofros/description/parser.py",
    "symofros/description/joints/joint.py",
    "symofros/description/joints/joint_kinds.py",
    "symofros/description/beams/beam.py",
    "symofros/description/beams/shapes.py",
    "symofros/description/beams/elastic.py",
    "symofros/description/forces.py",
    "symofros/description/constraints.py",
    "symofros/description/urdf/reader.py",
    "symofros/description/urdf/values.py",
    "symofros/description/mjcf/joints.py",
    "symofros/description/imported/geometry.py",
    "symofros/description/mjcf/model.py",
    "symofros/expr/**/*.py",
    "symofros/mechanics/**/*.py",
    "symofros/generator/*.py",
    "symofros/generator/codegen/*.py",
    "symofros/generator/passes/*.py",
    "symofros/simulation/*.py",
    "symofros/simulation/analysis/*.py",
    "symofros/simulation/stepping/*.py",
    "symofros/simulation/results/*.py",
    "symofros/native/model/*",
    "symofros/native/stepping/**/*",
    "symofros/native/diagrams/*",
)
# Of new code also what leaves the tool, and what runs and reads models.
WIDER = (
    *SCOPE,
    "symofros/base/*.py",
    "symofros/description/**/*.py",
    "symofros/runtime/**/*.py",
    "symofros/simulation/**/*.py",
    "symofros/generator/**/*.py",
    "symofros/exports/**/*.py",
    "symofros/interop/**/*.py",
    "symofros/diagrams/**/*.py",
    "symofros/blocks/**/*.py",
    "symofros/native/**/*.c",
    "symofros/native/**/*.in",
)
_LEFT_OUT = {
    "progress.py",
    "plots.py",
    "saving.py",
    "interpreted.py",
    "effort.py",
    "routes.py",
    "names.py",
}
_C = {".c", ".in"}
FEWEST = 3  # A file with fewer possible faults is a table of names or a line of includes.


def modules(root: Path, scope: tuple[str, ...] | None = None) -> list[str]:
    """The files of the study, by their paths from the repository's folder.

    Args:
        root: Folder of the repository.
        scope: Patterns of files; those of SCOPE if not given.
    """
    files = {path for pattern in scope or SCOPE for path in root.glob(pattern) if path.suffix in {".py", *_C}}
    kept = {path for path in files if path.name not in _LEFT_OUT and path.name != "__init__.py"}
    return sorted(path.relative_to(root).as_posix() for path in kept)


def faults_in(root: Path, module: str) -> list[SourceFault]:
    """Every fault that can be planted in a file."""
    text = (root / module).read_text(encoding="utf-8")
    return python_faults(module, text) if module.endswith(".py") else c_faults(module, text)


def drawn(root: Path, seed: int, fresh: Fresh | None = None) -> Iterator[SourceFault]:
    """All possible faults in an order of which every beginning is spread over the files.

    A file's share grows with the root of the number of its possible faults; each is drawn among the kinds in turn.

    Args:
        root: Folder of the repository.
        seed: Seed of the draw.
        fresh: New code, which alone is drawn from, in more files; all code if not given.
    """
    queue: list[tuple[float, SourceFault]] = []
    for module in modules(root, WIDER if fresh is not None else None):
        rng = random.Random(f"{seed}:{module}")
        possible = faults_in(root, module)
        if len(possible) < FEWEST:
            continue
        if fresh is not None:
            text = (root / module).read_text(encoding="utf-8")
            possible = [fault for fault in possible if fresh.has(fault, text)]
            if not possible:
                continue
        rng.shuffle(possible)
        offset, weight = rng.random(), len(possible) ** 0.5
        queue += [((k + offset) / weight, fault) for k, fault in enumerate(_alternate_kinds(possible))]
    yield from (fault for _, fault in sorted(queue, key=lambda item: (item[0], item[1].id)))


def _alternate_kinds(faults: list[SourceFault]) -> Iterator[SourceFault]:
    """A file's faults with the kinds taking turns, so that the frequent ones don't crowd out the others."""
    kinds: dict[str, list[SourceFault]] = {}
    for fault in faults:
        kinds.setdefault(fault.kind, []).append(fault)
    while kinds:
        for kind in list(kinds):
            yield kinds[kind].pop()
            if not kinds[kind]:
                del kinds[kind]
