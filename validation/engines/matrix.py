"""Cells of the matrix: engines, trees and functions, each answer judged by the truth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..contract.raised import Raised, words
from .functions import CONSTRAINED, FUNCTIONS
from .interface import EnginePlugin, State, Steps, Tree, Unsupported, vector
from .verdicts import Cell, Expected, Verdict, expected, judge
from .workers import Answer, Crashed, Job, Worker, answered

SEED = 20
# What is asked of a tree with constraints besides, for identities.
_BESIDES = ("mass_matrix", "bias")


@dataclass(frozen=True)
class Judged:
    """A cell and what it rests on.

    Attributes:
        cell: The cell.
        answer: What the engine answered.
        want: The truth; None where there was no answer.
        tree: The tree, with the engine's gravity.
        form: Format of the file that the engine read; "" where it was built by its API.
        text: The file.
    """

    cell: Cell
    answer: Answer
    want: Expected | None
    tree: Tree
    form: str = ""
    text: str = ""


class Truths:
    """Truths that were worked out already: engines with the same layout share them.

    Args:
        perturbations: See `verdicts.expected`.
    """

    def __init__(self, perturbations: int = 1) -> None:
        self._perturbations = perturbations
        self._known: dict[tuple[object, ...], Expected] = {}

    def of(self, function: str, tree: Tree, answer: Answer, slack: float | Steps) -> Expected:
        """The truth that an answer is judged by."""
        assert answer.layout is not None and answer.state is not None
        name = function.partition(":")[0]
        tree = replace(tree, name="")
        key = (name, tree, answer.layout, _bytes(answer.state), slack)
        if key not in self._known:
            self._known[key] = expected(name, tree, answer.layout, answer.state, slack, self._perturbations)
        return self._known[key]


def _bytes(state: State) -> bytes:
    return b"|".join(np.asarray(part).tobytes() for part in vars(state).values())


def names(plugins: Mapping[str, EnginePlugin]) -> list[str]:
    """Names of all functions, with the second ways of engines after each."""
    ways = dict.fromkeys(way for plugin in plugins.values() for way in plugin.functions if way not in FUNCTIONS)
    return [name for first in FUNCTIONS for name in (first, *(way for way in ways if way.partition(":")[0] == first))]


def suited(tree: Tree, plugin: EnginePlugin) -> Tree:
    """The tree with the gravity that an engine knows."""
    return replace(tree, gravity=vector(np.array(plugin.gravity))) if plugin.gravity else tree


def asked(plugin: EnginePlugin, tree: Tree) -> tuple[str, ...]:
    """The functions of an engine that a tree is for: those of constraints where it has any."""
    if tree.transformations - set(getattr(plugin, "transformations", ())):
        return ()
    if tree.constraints:
        return tuple(name for name in plugin.functions if name in _BESIDES or name.partition(":")[0] in CONSTRAINED)
    return tuple(name for name in plugin.functions if name.partition(":")[0] not in CONSTRAINED)


def judged(
    plugin: EnginePlugin,
    job: Job,
    truths: Truths,
    worker: Worker | None = None,
) -> Iterator[Judged]:
    """The functions of a job, those that the engine does not offer left out.

    Args:
        plugin: The engine.
        job: What is asked; the tree is to suit the engine.
        truths: Truths that are known.
        worker: Process that the engine runs in; None for this one.
    """
    offered = replace(job, functions=tuple(name for name in job.functions if name in plugin.functions))
    for answer in worker.ask(offered) if worker else answered(offered):
        cell, want = _judge(plugin, job.tree, answer, truths)
        yield Judged(cell, answer, want, job.tree, job.form, job.text)


def _judge(plugin: EnginePlugin, tree: Tree, answer: Answer, truths: Truths) -> tuple[Cell, Expected | None]:
    value = answer.value
    if isinstance(value, Crashed):
        return Cell(plugin.name, tree.name, answer.function, "crashes", words=value.reason), None
    if isinstance(value, Unsupported):
        verdict: Verdict = "refuses" if value.offered else "not offered"
        return Cell(plugin.name, tree.name, answer.function, verdict, words=value.reason), None
    if isinstance(value, Raised):
        return Cell(plugin.name, tree.name, answer.function, "raises", words=value.words), None
    try:
        want = truths.of(answer.function, tree, answer, plugin.slacks.get(answer.function, 0.0))
    except ZeroDivisionError:
        return Cell(plugin.name, tree.name, answer.function, "not offered", words="the truth is singular"), None
    except Exception as error:  # Of a layout that can't be: a fault of the plug-in's, or of ours.
        said = f"the truth in its layout: {words(error)}"
        return Cell(plugin.name, tree.name, answer.function, "raises", words=said), None
    return judge(plugin.name, tree, answer.function, value, want), want


def cells(plugin: EnginePlugin, tree: Tree, functions: Sequence[str] = ()) -> Iterator[Cell]:
    """Cells of one engine on one tree, in this process: of the given functions, or of all that it offers."""
    chosen = tuple(functions) or asked(plugin, tree)
    job = Job(plugin.name, suited(tree, plugin), chosen, SEED)
    for one in judged(plugin, job, Truths()):
        yield one.cell
