"""All cells of the matrix and proofs of the red ones: what stored reports have is taken over, the rest is asked."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field

from ..reporting.command import Run
from ..reporting.record import Data
from ..worker_process import WorkerProcess
from . import digests, parts, releases
from .asking import Asked, Questions, asker, job_of, part_of
from .causes.grouping import without_their_causes
from .functions import FUNCTIONS
from .identities import held
from .interface import EnginePlugin
from .matrix import Judged, names
from .plugins import OWN
from .proving.proofs import faults, proofs
from .verdicts import refusals
from .workers import registry


@dataclass
class Found:
    """What a run has found.

    Attributes:
        reach: The engines that were asked.
        questions: What was asked.
        cells: Cells that were asked now.
        kept: What is taken over from stored reports.
        digests: What the cells of engines on trees are answers to.
        proofs: Proofs of the red cells of both.
    """

    reach: releases.Opened
    questions: Questions
    cells: list[Judged]
    kept: list[Data] = field(default_factory=list)
    digests: parts.Digests = field(default_factory=dict)
    proofs: list[Data] = field(default_factory=list)


def measured(
    run: Run,
    reach: releases.Opened,
    wanted: Questions,
    stored: Sequence[Data],
    anew: Collection[str],
    tries: int | None,
) -> Found:
    """The cells of engines on all questions, as far as nothing stored has them, and proofs of the red ones.

    Args:
        run: The run.
        reach: Engines.
        wanted: The questions.
        stored: Stored reports.
        anew: Engines of which nothing is taken over.
        tries: Bounds the shrinking of each fault; None to prove none.
    """
    asked = digests_of(reach, wanted, parts.engines_of(stored))
    kept = parts.taken_over(stored, {place: one for place, one in asked.items() if place[0] not in anew})
    left = asked.keys() - {place for part in kept for place in parts.places(part)}
    if stored:
        run.say(f"{len(asked) - len(left)} of {len(asked)} pairs of an engine and a tree are taken over")
    here, others = [name for name in reach.plugins if name not in reach.release], list(reach.release)
    engines = {name: [*(engine for engine in here if (engine, name) in left), *others] for name in wanted}
    finished = parts.Finished(not others)
    cells = all_cells(run, reach, wanted, {name: own for name, own in engines.items() if own}, asked, finished)
    found = Found(reach, wanted, cells, kept, asked)
    _prove(run, found, tries)
    finished.forget()
    return found


def digests_of(reach: releases.Opened, wanted: Questions, stored: Mapping[str, str]) -> dict[tuple[str, str], str]:
    """What the cells of engines on trees are answers to, of those of this environment and of stored reports.

    Args:
        reach: The engines that can be asked; of other releases than those of this environment nothing is taken over.
        wanted: The questions.
        stored: Engines of stored reports, with their releases: what is not here was asked where it is.
    """
    here = {name: (plugin, "") for name, plugin in reach.plugins.items() if name not in reach.release}
    others = {name: registry().plugins[name] for name in stored if name in registry().plugins}
    away = {name: (plugin, stored[name]) for name, plugin in others.items() if name not in reach.plugins}
    return {
        (engine, name): digests.asked(plugin, job, version)
        for name, question in wanted.items()
        for engine, (plugin, version) in (here | away).items()
        if (job := job_of(plugin, question)) is not None and job.functions
    }


def report_of(found: Found, absent: Mapping[str, str]) -> Data:
    """The data of the report of all that was found and is taken over."""
    chosen, cells = found.reach.plugins, found.cells
    kept = {place for part in found.kept for place in parts.places(part)}
    own = [place for place in found.digests if place not in kept and place[0] in chosen]
    left = Counter(engine for engine, model in found.digests if (engine, model) not in kept and engine not in chosen)
    asked = ({"engine": place[0], "model": place[1], "digest": found.digests[place], "origin": ""} for place in own)
    whole = parts.merged(
        {
            "engines": [{**_engine(plugin), **found.reach.stated(name)} for name, plugin in chosen.items()],
            "absent": absent,
            "left": dict(left),
            "models": list(found.questions),
            "functions": {name: FUNCTIONS[name.partition(":")[0]].text for name in names(chosen)},
            # Exceptions inside plug-ins that come with this package are faults of ours, with whatever release.
            "ours": [name for name, one in chosen.items() if one is OWN.get(name) or name in found.reach.release],
            # What an engine does not offer is what is left: a third of all.
            "cells": parts.nested(
                (asdict(one.cell) for one in cells if one.cell.verdict != "not offered"), parts.CELLS
            ),
            "corrected": parts.nested(map(asdict, without_their_causes(cells)), parts.CELLS),
            "identities": parts.nested(map(asdict, held(cells)), parts.IDENTITIES),
            "asked": parts.nested(asked, parts.ASKED),
            "proofs": found.proofs,
        },
        found.kept,
    )
    offered = parts.cells(whole)
    for engine in whole["engines"]:
        engine["refusals"] = refusals([cell for cell in offered if cell.engine == engine["name"]])
    return whole


def all_cells(
    run: Run,
    reach: releases.Opened,
    every: Questions,
    asked: Asked,
    digests: parts.Digests,
    finished: parts.Finished,
) -> list[Judged]:
    """The cells of all engines; of those of this environment, half of the questions in a second process.

    What an interrupted run has finished that asked the same is taken over.
    """
    stated = {name: {one: digests.get((one, name), "") for one in engines} for name, engines in asked.items()}
    found = {name: finished.of(name, stated[name]) for name in asked}
    left = {name: [one for one in engines if one not in found[name]] for name, engines in asked.items()}
    left = {name: engines for name, engines in left.items() if engines}
    run.expect(len(asked), "asking engines")
    if any(found.values()):
        run.say(f"{len(asked) - len(left)} of {len(asked)} questions are as an interrupted run left them")
        run.advance(steps=len(asked) - len(left))
    cells = {name: [cell for own in found[name].values() for cell in own] for name in asked}

    def after(name: str, new: list[Judged]) -> None:
        cells[name] += new
        finished.keep(name, stated[name], cells[name])
        run.advance(name)

    _ask_all(reach, every, left, after)
    return [cell for own in cells.values() for cell in own]


def _ask_all(
    reach: releases.Opened, every: Questions, asked: Asked, after: Callable[[str, list[Judged]], None]
) -> None:
    """Ask questions; each is given to `after` with its cells as it is done, from two threads."""
    ask = asker(reach.plugins, reach.worker)
    lots = [dict(list(asked.items())[k::2]) for k in range(2)] if _halves(reach) else [asked, {}]

    def elsewhere() -> None:
        for name, cells in process.call(part_of, lots[1]):
            after(name, cells)

    with WorkerProcess() as process, ThreadPoolExecutor(1) as threads:
        rest = threads.submit(elsewhere) if lots[1] else None
        for name, engines in lots[0].items():
            after(name, ask(every[name], engines))
        if rest is not None:
            rest.result()


def _prove(run: Run, found: Found, tries: int | None) -> None:
    """Proofs of all red cells: those that are stored, and new ones; the latter none without `tries`."""
    reach = found.reach
    ask = asker(reach.plugins, reach.worker)
    while True:
        others = [cell for part in found.kept for cell in parts.cells(part)]
        sorted_out = faults(found.cells, others, (proof for part in found.kept for proof in part["proofs"]))
        found.proofs = sorted_out.proven
        if tries is None:
            return
        unasked = {place for place in sorted_out.unasked if place[0] in reach.plugins}
        if not unasked:
            break
        for engine, name in sorted(unasked):
            found.cells += ask(found.questions[name], (engine,))
        found.kept = [parts.only(part, set(parts.places(part)) - unasked) for part in found.kept]
    folder, halves = run.folder / "engines", _halves(reach)
    run.expect(len(sorted_out.open), "proving faults")
    advance = lambda one: run.advance(one.file)  # noqa: E731
    new = proofs(reach.plugins, sorted_out.open, reach.worker, folder, advance, tries, halves)
    found.proofs = [*found.proofs, *(asdict(proof) | {"models": models} for proof, models in new)]


def _halves(reach: releases.Opened) -> bool:
    """Whether a second process does half: of the engines of this environment, where there are two processors."""
    return not reach.release and (os.cpu_count() or 1) > 1


def _engine(plugin: EnginePlugin) -> Data:
    return {
        "name": plugin.name,
        "version": plugin.version(),
        "conventions": [list(row) for row in plugin.conventions],
        "functions": dict(plugin.functions),
    }
