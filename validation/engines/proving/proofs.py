"""A script for each fault of engines; half of the engines with faults in a second process."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from ...reporting.record import Data
from ...worker_process import WorkerProcess
from ..causes.grouping import by_function, causes_of
from ..interface import EnginePlugin
from ..matrix import Judged
from ..verdicts import Cell
from ..workers import Worker, registry
from .scripts import Proof, Prover
from .shrink import TRIES


class Fault(NamedTuple):
    """A red cell that one script stands for, and the names of all trees that show its fault."""

    first: Judged
    models: tuple[str, ...]


Proven = tuple[Proof, tuple[str, ...]]


class Faults(NamedTuple):
    """What red cells are for their proofs.

    Attributes:
        open: Faults that are to be proven.
        proven: Stored proofs of the others, with the names of all trees that show each now.
        unasked: Engines and trees of stored cells that show a fault without a proof, which no answer is here of.
    """

    open: list[Fault]
    proven: list[Data]
    unasked: set[tuple[str, str]]


def faults(cells: Sequence[Judged], others: Iterable[Cell] = (), stored: Iterable[Data] = ()) -> Faults:
    """What one script stands for: red cells of a function of an engine, on the trees that one cause shows it on."""
    judged_cells = {one.cell: one for one in cells}
    proofs = {(one["engine"], one["function"], one["model"]): one for one in stored}
    found = Faults([], [], set())
    groups = causes_of([*judged_cells, *others])
    for lot in (lot for group in groups for lot in by_function(group.cells)):
        models = tuple(cell.model for cell in lot)
        known = (proofs.get((cell.engine, cell.function, cell.model)) for cell in lot)
        if proof := next(filter(None, known), None):
            found.proven.append({**proof, "models": models})
        elif first := next((judged_cells[cell] for cell in lot if cell in judged_cells), None):
            found.open.append(Fault(first, models))
        else:
            found.unasked.add((lot[0].engine, lot[0].model))
    return found


def dealt(found: Sequence[Fault]) -> tuple[list[Fault], list[Fault]]:
    """Faults in two lots about as long; those of one engine stay together, since one is looked for where another is."""
    engines: dict[str, list[Fault]] = {}
    for fault in found:
        engines.setdefault(fault.first.cell.engine, []).append(fault)
    lots: tuple[list[Fault], list[Fault]] = [], []
    for own in sorted(engines.values(), key=len, reverse=True):
        min(lots, key=len).extend(own)
    return lots


def proofs(
    plugins: Mapping[str, EnginePlugin],
    found: Sequence[Fault],
    worker: Worker,
    folder: Path,
    after: Callable[[Proof], object],
    tries: int = TRIES,
    halves: bool = False,
) -> list[Proven]:
    """A proven script for each fault, with the names of all trees that show it.

    Args:
        plugins: Engines.
        found: The faults.
        worker: Process that the engines run in.
        folder: Folder of the scripts.
        after: Told each proof.
        tries: Bounds the shrinking of each.
        halves: Whether a second process proves half of them; it knows the plug-ins of this environment.
    """
    own, others = dealt(found) if halves else (list(found), [])
    made: dict[tuple[str, str, str], Proven] = {}

    def took(proven: Iterator[Proven]) -> None:
        for proof, models in proven:
            made[proof.engine, proof.function, proof.model] = proof, models
            after(proof)

    with WorkerProcess() as process, ThreadPoolExecutor(1) as threads:
        rest = threads.submit(lambda: took(process.call(proofs_of, others, folder, tries))) if others else None
        took(_proven(plugins, own, worker, folder, tries))
        if rest is not None:
            rest.result()
    cells = (fault.first.cell for fault in found)
    return [made[cell.engine, cell.function, cell.model] for cell in cells]


def _proven(
    plugins: Mapping[str, EnginePlugin], found: Sequence[Fault], worker: Worker, folder: Path, tries: int
) -> Iterator[Proven]:
    prover = Prover(worker, folder, tries)
    for first, models in found:
        yield prover.prove(plugins[first.cell.engine], first), models


def proofs_of(found: Sequence[Fault], folder: Path, tries: int) -> Iterator[Proven]:
    """Proofs of faults of this environment's engines, in this process and a worker of its own."""
    with Worker() as worker:
        yield from _proven(registry().plugins, found, worker, folder, tries)
