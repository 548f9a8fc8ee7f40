"""All cells of the matrix, and proofs of the red ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..reporting.command import Run, known
from ..reporting.record import Data
from . import parts
from .causes.grouping import by_function, causes_of, without_their_causes
from .functions import FUNCTIONS
from .identities import held
from .interface import EnginePlugin, Tree
from .matrix import SEED, Judged, Truths, asked, judged, names, suited
from .models import hostile, kinds, loops, transformed
from .models.formats import formats
from .models.readers import Reading
from .plugins import OWN
from .proving.scripts import Proof, Prover
from .proving.shrink import TRIES
from .verdicts import Cell, refusals
from .workers import Job, Worker, registry


def gathered(
    plugins: Mapping[str, EnginePlugin], trees: Iterable[Tree], worker: Worker, after: Callable[[str], object]
) -> list[Judged]:
    """The cells of engines on trees.

    Args:
        plugins: Engines.
        trees: Trees.
        worker: Process that the engines run in.
        after: Told the name of each tree when it is done.
    """
    cells: list[Judged] = []
    for tree in trees:
        # Engines with the same layout of a tree share its truths; other trees have none in common with it.
        truths = Truths()
        for plugin in plugins.values():
            job = Job(plugin.name, suited(tree, plugin), asked(plugin, tree), SEED, further=True)
            cells += judged(plugin, job, truths, worker)
        after(tree.name)
    return cells


def read(
    plugins: Mapping[str, EnginePlugin], files: Mapping[str, Reading], worker: Worker, after: Callable[[str], object]
) -> list[Judged]:
    """The cells of engines on files that they read themselves; the arguments are those of `gathered`."""
    cells: list[Judged] = []
    # Many files state the same tree.
    truths = Truths()
    for name, reading in files.items():
        for plugin in plugins.values():
            if reading.form in plugin.formats:
                asked, tree = reading.functions(plugin.functions), suited(reading.tree, plugin)
                # What a reader makes of a file shows at one state.
                job = Job(plugin.name, tree, asked, SEED, form=reading.form, text=reading.text)
                cells += judged(plugin, job, truths, worker)
        after(name)
    return cells


def fault_groups(cells: Sequence[Judged]) -> list[list[Judged]]:
    """Red cells that one script stands for: a function of an engine, on the trees that one cause shows it on.

    Returns:
        Groups of red cells, the first of which stands for the others.
    """
    judged_cells = {one.cell: one for one in cells}
    groups = (lot for group in causes_of(judged_cells) for lot in by_function(group.cells))
    return [[judged_cells[cell] for cell in lot] for lot in groups]


def proofs(
    plugins: Mapping[str, EnginePlugin],
    cells: Sequence[Judged],
    worker: Worker,
    folder: Path,
    after: Callable[[Proof], object],
    tries: int = TRIES,
) -> list[tuple[Proof, tuple[str, ...]]]:
    """A proven script for each fault, with the names of all trees that show it; `tries` bounds the shrinking."""
    results, prover = [], Prover(worker, folder, tries)
    for group in fault_groups(cells):
        first = group[0]
        proof = prover.prove(plugins[first.cell.engine], first)
        results.append((proof, tuple(one.cell.model for one in group)))
        after(proof)
    return results


def trees() -> dict[str, Tree]:
    """All trees: one for each kind of joint, the hostile set, loops, transformed models."""
    return {name: kinds.tree_of(name) for name in kinds.KINDS} | hostile.trees() | loops.trees() | transformed.trees()


def measure(
    run: Run,
    engines: Annotated[list[str] | None, typer.Option("--engine", help="Only this engine.")] = None,
    models: Annotated[list[str] | None, typer.Option("--kinds", help="Only this kind of joint, or tree.")] = None,
    prove: Annotated[bool, typer.Option(help="Shrink red cells, write their scripts and run them.")] = True,
    tries: Annotated[int, typer.Option(min=0, help="Cases tried to shrink each fault.")] = TRIES,
    part: Annotated[
        list[Path] | None, typer.Option(help="Take over the engines of a stored engines.json; repeatable.")
    ] = None,
) -> Data:
    """Hold engines against thirty digits of truth: every kind of joint, every function that they offer.

    A run may be made in parts: --engine for some engines, into a folder of their own; then once more with --part for
    each folder's engines.json, which measures the engines that no part has, and writes one report of all.
    """
    try:
        stored = parts.load(part or ())
    except parts.PartsDisagree as error:
        raise typer.BadParameter(str(error), param_hint="--part") from None
    plugins = registry().plugins
    present = {name: plugin for name, plugin in plugins.items() if plugin.version()}
    left = [name for name in present if name not in parts.engines_of(stored)]
    for name in engines or ():
        if name in parts.engines_of(stored):
            raise typer.BadParameter(f"engine '{name}' is in a stored part, too", param_hint="--engine")
    chosen = {name: present[name] for name in known(engines, present, "--engine", "engine present")}
    chosen = {name: plugin for name, plugin in chosen.items() if name in left}
    all_trees, files = trees(), formats()
    names_wanted = known(models, [*all_trees, *files], "--kinds", "kind")
    wanted = [all_trees[name] for name in names_wanted if name in all_trees]
    run.expect(len(names_wanted), "asking engines")
    with Worker() as worker:
        cells = gathered(chosen, wanted, worker, run.advance)
        cells += read(chosen, {name: files[name] for name in names_wanted if name in files}, worker, run.advance)
        proven = (
            proofs(chosen, cells, worker, run.folder / "engines", lambda one: run.advance(one.file), tries)
            if prove
            else []
        )
    own: Data = {
        "question": parts.question(),
        "engines": [_engine(plugin, [one.cell for one in cells]) for plugin in chosen.values()],
        "absent": {name: plugin.extra for name, plugin in plugins.items() if name not in present} | registry().failures,
        "models": names_wanted,
        "functions": {name: FUNCTIONS[name.partition(":")[0]].text for name in names(chosen)},
        # Exceptions inside plug-ins that come with this package are faults of ours.
        "ours": [name for name in chosen if plugins[name] is OWN.get(name)],
        # What an engine does not offer is what is left: a third of all.
        "cells": parts.nested((asdict(one.cell) for one in cells if one.cell.verdict != "not offered"), parts.CELLS),
        "corrected": parts.nested(map(asdict, without_their_causes(cells)), parts.CELLS),
        "identities": parts.nested(map(asdict, held(cells)), parts.IDENTITIES),
        "proofs": [asdict(proof) | {"models": models} for proof, models in proven],
    }
    try:
        whole = parts.merged(own, stored)
    except parts.PartsDisagree as error:
        raise typer.BadParameter(str(error), param_hint="--part") from None
    for one in stored:
        parts.write_scripts(one["proofs"], run.folder / "engines")
    return whole


def _engine(plugin: EnginePlugin, cells: Sequence[Cell]) -> Data:
    own = [cell for cell in cells if cell.engine == plugin.name and cell.verdict != "not offered"]
    return {
        "refusals": refusals(own),
        "name": plugin.name,
        "version": plugin.version(),
        "conventions": [list(row) for row in plugin.conventions],
        "functions": dict(plugin.functions),
    }
