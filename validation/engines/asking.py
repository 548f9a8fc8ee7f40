"""All questions to engines, and what asks them."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from itertools import zip_longest

from . import releases
from .interface import EnginePlugin, Tree
from .matrix import SEED, Judged, Truths, asked, judged, suited
from .models import (
    acting,
    flexible,
    hostile,
    kinds,
    loops,
    sensed,
    single,
    soft,
    spacecraft,
    stated,
    transformed,
)
from .models.covering import chains, scenes
from .models.covering.edits import BETWEEN
from .models.files.formats import formats
from .models.files.readers import Reading
from .workers import Job, Worker, registry

# Seconds for each engine of the smoke tier, so that what is begun then ends within a minute.
SMOKE = 50.0
# Questions of a lot of scenes, which each ask of many features, and of a lot of files with one feature: these take a
# hundredth of what trees take, which all functions are asked about.
_SCENES, _FILES = 25, 12
Questions = Mapping[str, Tree | Reading]
# Name of a question -> names of the engines that it is put to.
Asked = Mapping[str, Collection[str]]


def lots() -> list[Questions]:
    """All questions by name: trees of each kind of joint, hostile, with loops, forces, sensors, transformed; files."""
    own: list[Questions] = [{name: kinds.tree_of(name) for name in kinds.KINDS}]
    trees = (
        family.trees() for family in (hostile, loops, transformed, stated, sensed, flexible, single, soft, spacecraft)
    )
    forms: dict[tuple[str, bool], dict[str, Reading]] = {}
    for name, one in formats().items():
        forms.setdefault((one.form, BETWEEN in name), {})[name] = one
    files = (lot for (_, is_pair), form in forms.items() for lot in ([form] if is_pair else _cut(form, _FILES)))
    return [*_cut(scenes.trees(), _SCENES), chains.trees(), *own, acting.driven(), acting.passive(), *trees, *files]


def _cut(every: Questions, most: int) -> list[Questions]:
    """Lots of so many questions at most: one of each in turn gives all in the order in which they stand."""
    names, lots = list(every), -(-len(every) // most)
    return [{name: every[name] for name in names[first::lots]} for first in range(lots)]


def questions() -> dict[str, Tree | Reading]:
    """All questions by name."""
    return {name: question for lot in lots() for name, question in lot.items()}


def in_turn() -> Iterator[str]:
    """The names of all questions, one of each lot after the other: who stops early has asked of everything.

    Files of one feature are through early; those of two are one lot for each format.
    """
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
    ask = asker(plugins, worker, further)
    for name, question in questions.items():
        if goes_on():
            cells += ask(question, plugins)
            after(name)
        else:
            left.append(name)
    return cells, left


def asker(
    plugins: Mapping[str, EnginePlugin], worker: Worker, further: bool = True
) -> Callable[[Tree | Reading, Collection[str]], list[Judged]]:
    """Question, names of engines -> their cells on it."""
    of_files = Truths()  # Many files state the same tree.

    def ask(question: Tree | Reading, engines: Collection[str]) -> list[Judged]:
        # Engines with the same layout of a tree share its truths; other trees have none in common with it.
        truths = of_files if isinstance(question, Reading) else Truths()
        jobs = ((plugin, job_of(plugin, question, further)) for name, plugin in plugins.items() if name in engines)
        return [one for plugin, job in jobs if job is not None for one in judged(plugin, job, truths, worker)]

    return ask


def part_of(asked: Asked) -> Iterator[tuple[str, list[Judged]]]:
    """Some questions with the cells of engines on each, asked in this process and a worker of its own."""
    every = questions()
    with Worker() as worker:
        ask = asker(registry().plugins, worker)
        for name, engines in asked.items():
            yield name, ask(every[name], engines)


def job_of(plugin: EnginePlugin, question: Tree | Reading, further: bool = True) -> Job | None:
    """What an engine is asked about a tree, or about a file; None where it has no reader of such files."""
    if not isinstance(question, Reading):
        return Job(plugin.name, suited(question, plugin), asked(plugin, question), SEED, further=further)
    if question.form not in plugin.formats:
        return None
    # What a reader makes of a file shows at one state.
    functions, tree = question.functions(plugin.functions), suited(question.tree, plugin)
    return Job(plugin.name, tree, functions, SEED, form=question.form, text=question.text)


def within_a_minute(reach: releases.Opened, wanted: Questions) -> list[Judged]:
    """What fits into a minute for each engine: one state of each tree, so that there are many."""
    cells: list[Judged] = []
    some = {name: wanted[name] for name in in_turn() if name in wanted}
    for name, plugin in reach.plugins.items():
        goes_on = partial(_is_before, time.monotonic() + SMOKE)
        cells += about({name: plugin}, some, reach.worker, str, goes_on, further=False)[0]
    return cells


def _is_before(end: float) -> bool:
    return time.monotonic() < end
