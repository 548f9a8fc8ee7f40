"""All cells of the matrix, and proofs of the red ones."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Annotated

import typer

from ..faults.environment import NotAskedError
from ..reporting.command import Exit, Run, known, present
from ..reporting.record import Data
from ..worker_process import WorkerProcess
from . import changes, parts, releases
from .bisection import history
from .causes.grouping import without_their_causes
from .causes.history import histories, named
from .functions import FUNCTIONS
from .identities import held
from .interface import EnginePlugin, Tree
from .matrix import SEED, Judged, Truths, asked, judged, names, suited
from .models import acting, flexible, hostile, kinds, loops, sensed, single, stated, transformed
from .models.formats import formats
from .models.readers import Reading
from .plugins import OWN
from .proving.proofs import Proven, faults, proofs
from .proving.shrink import TRIES
from .verdicts import Cell, refusals
from .workers import Job, Worker, registry

# Seconds for each engine of the smoke tier, so that what is begun then ends within a minute.
SMOKE = 50.0
Questions = Mapping[str, Tree | Reading]


def lots() -> list[Questions]:
    """All questions by name: trees of each kind of joint, hostile, with loops, forces, sensors, transformed; files."""
    own: list[Questions] = [{name: kinds.tree_of(name) for name in kinds.KINDS}]
    trees = (family.trees() for family in (hostile, loops, transformed, stated, acting, sensed, flexible, single))
    return [*own, *trees, formats()]


def questions() -> dict[str, Tree | Reading]:
    """All questions by name."""
    return {name: question for lot in lots() for name, question in lot.items()}


def in_turn() -> Iterator[str]:
    """The names of all questions, one of each lot after the other: who stops early has asked of everything."""
    return (name for names in zip_longest(*lots()) for name in names if name is not None)


def about(
    plugins: Mapping[str, EnginePlugin],
    questions: Questions,
    worker: Worker,
    after: Callable[[str], object],
    goes_on: Callable[[], bool] = lambda: True,
    further: bool = True,
) -> tuple[list[Judged], list[str]]:
    """The cells of engines on trees and files, and the names of those that are left when it goes on no more.

    Args:
        plugins: Engines.
        questions: The questions.
        worker: Process that the engines run in.
        after: Told the name of each when it is done.
        goes_on: Asked before each.
        further: Whether functions of trees are asked at further states.
    """
    cells: list[Judged] = []
    left: list[str] = []
    ask = _asker(plugins, worker, further)
    for name, question in questions.items():
        if goes_on():
            cells += ask(question)
            after(name)
        else:
            left.append(name)
    return cells, left


def _asker(
    plugins: Mapping[str, EnginePlugin], worker: Worker, further: bool = True
) -> Callable[[Tree | Reading], list[Judged]]:
    """Question -> the cells of engines on it."""
    of_files = Truths()  # Many files state the same tree.

    def ask(question: Tree | Reading) -> list[Judged]:
        # Engines with the same layout of a tree share its truths; other trees have none in common with it.
        truths = of_files if isinstance(question, Reading) else Truths()
        jobs = ((plugin, _job(plugin, question, further)) for plugin in plugins.values())
        return [one for plugin, job in jobs if job is not None for one in judged(plugin, job, truths, worker)]

    return ask


def part_of(engines: Sequence[str], names: Sequence[str]) -> Iterator[tuple[str, list[Judged]]]:
    """Some questions with the cells of engines on each, asked in this process and a worker of its own."""
    every, plugins = questions(), {name: registry().plugins[name] for name in engines}
    with Worker() as worker:
        ask = _asker(plugins, worker)
        for name in names:
            yield name, ask(every[name])


def _job(plugin: EnginePlugin, question: Tree | Reading, further: bool = True) -> Job | None:
    """What an engine is asked about a tree, or about a file; None where it has no reader of such files."""
    if not isinstance(question, Reading):
        return Job(plugin.name, suited(question, plugin), asked(plugin, question), SEED, further=further)
    if question.form not in plugin.formats:
        return None
    # What a reader makes of a file shows at one state.
    functions, tree = question.functions(plugin.functions), suited(question.tree, plugin)
    return Job(plugin.name, tree, functions, SEED, form=question.form, text=question.text)


def measure(
    run: Run,
    engines: Annotated[list[str] | None, typer.Option("--engine", help="Only this engine.")] = None,
    models: Annotated[list[str] | None, typer.Option("--kinds", help="Only this kind of joint, or tree.")] = None,
    prove: Annotated[bool, typer.Option(help="Shrink red cells, write their scripts and run them.")] = True,
    tries: Annotated[int, typer.Option(min=0, help="Cases tried to shrink each fault.")] = TRIES,
    part: Annotated[
        list[Path] | None, typer.Option(help="Take over the engines of a stored engines.json; repeatable.")
    ] = None,
    update: Annotated[
        bool, typer.Option("--update", help="Ask --engine anew; take the others over from the report that is there.")
    ] = False,
    at: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME==VERSION", help="This release, in an environment of its own; NAME: the newest."),
    ] = None,
    newest: Annotated[
        bool, typer.Option("--newest", help="The newest release of every engine, each likewise.")
    ] = False,
    requires: Annotated[
        list[str] | None, typer.Option("--with", metavar="REQUIREMENT", help="Install this beside the release, too.")
    ] = None,
    environments: Annotated[Path | None, typer.Option(help="Folder of releases' environments.")] = None,
    smoke: Annotated[
        bool, typer.Option("--smoke", help="What fits into a minute for each engine; no scripts.")
    ] = False,
    baseline: Annotated[
        Path | None, typer.Option(help="Say which cells changed against a stored engines.json.")
    ] = None,
    bisect: Annotated[
        str | None,
        typer.Option(metavar="ENGINE/TREE/FUNCTION[=VERDICT]", help="First bad and first good release of this cell."),
    ] = None,
    since: Annotated[
        list[str] | None,
        typer.Option(
            "--releases", metavar="ENGINE[/CAUSE]", help="First and last release of a cause, by its script; stored."
        ),
    ] = None,
) -> Data:
    """Hold engines against thirty digits of truth: every kind of joint, every function that they offer.

    A run may be made in parts: --engine for some engines, into a folder of their own; then once more with --part for
    each folder's engines.json, which measures the engines that no part has, and writes one report of all. --update
    writes the engines that are named into the report that is there, if that was asked the same questions of the same
    versions. Files are written for all questions to all engines, or into a folder that is named.
    """
    at = releases.newest() if newest else at or []
    if bisect:
        raise typer.Exit(_bisected(bisect, at, requires or (), environments))
    if since:
        raise typer.Exit(_dated(since, run.folder / "engines.json", requires or (), environments))
    plugins = registry().plugins
    present = {name: plugin for name, plugin in plugins.items() if plugin.version()}
    try:
        stored, before = parts.load(part or ()), changes.load(baseline)
        if update:
            versions = {name: plugin.version() for name, plugin in present.items()}
            stored.append(parts.others(run.folder / "engines.json", engines or (), versions))
        pairs = [pair for text in at for pair in releases.stated(text, requires or ())]
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    chosen = _chosen(engines, present, parts.engines_of(stored))
    every = questions()
    wanted = known(models, every, "--kinds", "kind")
    # A part of the questions or of the engines, or other releases than those of this environment, leave the whole
    # report as it is.
    asks_all = set(chosen) | parts.engines_of(stored) >= set(present) and set(wanted) == set(every)
    run.writes = run.asked or (asks_all and not (at or smoke))
    with releases.in_reach(chosen, pairs, environments) as reach:
        for why in reach.failures.values():
            run.say(why, bad=True)
        if pairs and not reach.plugins:
            raise typer.Exit(Exit.MISSED)
        run.expect(len(wanted), "asking engines")
        finished = parts.Finished("" if smoke else _key(run, reach))
        cells = _within_a_minute(reach, every, wanted) if smoke else _all(run, reach, every, wanted, finished)
        proven = _proofs(run, reach, cells, tries) if prove and run.writes and not smoke else []
    finished.forget()
    chosen, plain = reach.plugins, [one.cell for one in cells]
    absent = {name: plugin.extra for name, plugin in plugins.items() if name not in present} | registry().failures
    own: Data = {
        "question": parts.question(),
        "engines": [{**_engine(plugin, plain), **reach.stated(name)} for name, plugin in chosen.items()],
        "absent": {str(release): why for release, why in reach.failures.items()} if at else absent,
        "models": [name for name in wanted if not smoke or name in {one.cell.model for one in cells}],
        "functions": {name: FUNCTIONS[name.partition(":")[0]].text for name in names(chosen)},
        # Exceptions inside plug-ins that come with this package are faults of ours, with whatever release.
        "ours": [name for name, plugin in chosen.items() if plugin is OWN.get(name) or name in reach.release],
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
    return dict(whole) | ({"changed": changes.between(before, whole)} if before else {})


def _bisected(cell: str, at: Sequence[str], requires: Sequence[str], environments: Path | None) -> Exit:
    """Print the history of a cell; the exit code."""
    engine, _, rest = cell.partition("/")
    (tree,) = known([rest.rpartition("/")[0]], questions(), "--bisect", "tree")
    question, version = {tree: questions()[tree]}, at[0].partition("==")[2] if at else ""

    def ask(reach: releases.Opened) -> list[Cell]:
        return [one.cell for one in about(reach.plugins, question, reach.worker, str)[0]]

    try:
        (pair,) = releases.stated(f"{engine}=={version}", requires)
        for line in history(cell, pair, requires, environments, ask):
            typer.echo(line)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--bisect") from None
    except NotAskedError as error:
        typer.echo(str(error))
        return Exit.MISSED
    return Exit.GOOD


def _dated(names: Sequence[str], report: Path, requires: Sequence[str], environments: Path | None) -> Exit:
    """Print which releases have causes, by the scripts of a stored report; the exit code."""
    try:
        chosen, data = named(names), changes.load(report)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--releases") from None
    for line in histories(chosen, data or {}, requires, environments):
        typer.echo(line)
    return Exit.GOOD


def _chosen(
    engines: list[str] | None, present: Mapping[str, EnginePlugin], stored: set[str]
) -> dict[str, EnginePlugin]:
    """The engines to ask: those that are named, or all; what stored parts have is not asked again."""
    for name in engines or ():
        if name in stored:
            raise typer.BadParameter(f"engine '{name}' is in a stored part, too", param_hint="--engine")
    named = known(engines, present, "--engine", "engine present")
    return {name: present[name] for name in named if name not in stored}


def _all(
    run: Run, reach: releases.Opened, every: Questions, wanted: Sequence[str], finished: parts.Finished
) -> list[Judged]:
    """The cells of all engines; of those of this environment, half of the questions in a second process.

    What an interrupted run of the same sources and packages has finished is taken over.
    """
    found = {name: cells for name in wanted if (cells := finished.of(name)) is not None}
    if found:
        run.say(f"{len(found)} of {len(wanted)} questions are as an interrupted run left them")
        run.advance(steps=len(found))

    def after(name: str, cells: list[Judged]) -> None:
        found[name] = cells
        finished.keep(name, cells)
        run.advance(name)

    _ask_all(reach, every, [name for name in wanted if name not in found], after)
    return [cell for name in wanted for cell in found[name]]


def _ask_all(
    reach: releases.Opened,
    every: Questions,
    wanted: Sequence[str],
    after: Callable[[str, list[Judged]], None],
) -> None:
    """Ask questions; each is given to `after` with its cells as it is done, from two threads."""
    ask = _asker(reach.plugins, reach.worker)
    if not _halves(reach):
        for name in wanted:
            after(name, ask(every[name]))
        return

    def elsewhere() -> None:
        for name, cells in process.call(part_of, list(reach.plugins), list(wanted[1::2])):
            after(name, cells)

    with WorkerProcess() as process, ThreadPoolExecutor(1) as threads:
        rest = threads.submit(elsewhere)
        for name in wanted[::2]:
            after(name, ask(every[name]))
        rest.result()


def _key(run: Run, reach: releases.Opened) -> str:
    """What answers depend on; "" of other releases, and of a plug-in of another package: its sources are not known."""
    if reach.release or any(plugin is not OWN.get(name) for name, plugin in reach.plugins.items()):
        return ""
    return parts.finished_key(reach.plugins, present(run.topic))


def _proofs(run: Run, reach: releases.Opened, cells: Sequence[Judged], tries: int) -> list[Proven]:
    """A proven script for each fault."""
    found, folder = faults(cells), run.folder / "engines"
    run.expect(len(found), "proving faults")
    halves = _halves(reach)
    return proofs(reach.plugins, found, reach.worker, folder, lambda one: run.advance(one.file), tries, halves)


def _halves(reach: releases.Opened) -> bool:
    """Whether a second process does half: of the engines of this environment, where there are two processors."""
    return not reach.release and (os.cpu_count() or 1) > 1


def _within_a_minute(reach: releases.Opened, every: Questions, wanted: Sequence[str]) -> list[Judged]:
    """What fits into a minute for each engine: one state of each tree, so that there are many."""
    cells: list[Judged] = []
    some = {name: every[name] for name in in_turn() if name in wanted}
    for name, plugin in reach.plugins.items():
        goes_on = partial(_is_before, time.monotonic() + SMOKE)
        cells += about({name: plugin}, some, reach.worker, str, goes_on, further=False)[0]
    return cells


def _is_before(end: float) -> bool:
    return time.monotonic() < end


def _engine(plugin: EnginePlugin, cells: Sequence[Cell]) -> Data:
    own = [cell for cell in cells if cell.engine == plugin.name and cell.verdict != "not offered"]
    return {
        "refusals": refusals(own),
        "name": plugin.name,
        "version": plugin.version(),
        "conventions": [list(row) for row in plugin.conventions],
        "functions": dict(plugin.functions),
    }
