"""Cells of the matrix: engines, trees and functions, each answer judged by the truth."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Overflow

import numpy as np

from ..contract.raised import Raised, words
from .functions import FUNCTIONS, suits
from .interface import DOUBLE, EnginePlugin, Tree, Unsupported, vector
from .proving.pieces import Pieces, taken
from .states import AGAIN, visits
from .verdicts import RED, Cell, Expected, Verdict, expected, judge, placed
from .workers import Answer, Crashed, Job, Worker, answered

SEED = 20
Ask = Callable[[Job], Iterable[Answer]]
# From what says nothing of an engine to what weighs most: of several states, the worst counts.
_RANK: tuple[Verdict, ...] = (
    *("not offered", "right", "repairs", "precondition", "refuses", "plug-in"),
    *("imprecise", "raises", "wrong", "crashes"),
)
# What speeds have no part in has one truth at all speeds: their derivatives, by many differences, take longest.
_OF_NO_SPEED = re.compile(
    "integrate|difference|interpolate|impact|impulse|delassus|kkt|mass_matrix|gravity|potential_en"
)
# One draw of roundings may fall short of what others do: where digits alone are lost, so many times as many are drawn.
_MORE = 4
_AFTER_ONE = ", after another state on the same model: right by itself"
_AFTER_ALL = ", after other states on the same model: right by itself"
_AFTER = ", after {} at another state on the same model: right by itself"
_NO_MORE = ", in one of many calls: not again"


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
        before: Functions and states that the same model was asked first, where it is red after these alone.
    """

    cell: Cell
    answer: Answer
    want: Expected | None
    tree: Tree
    form: str = ""
    text: str = ""
    before: tuple[tuple[str, Pieces], ...] = ()


class Truths:
    """Truths that were worked out already: engines with the same layout share them.

    Args:
        perturbations: See `verdicts.expected`.
    """

    def __init__(self, perturbations: int = 1) -> None:
        self.perturbations = perturbations
        self._known: dict[tuple[object, ...], Expected] = {}

    def of(self, function: str, tree: Tree, answer: Answer, plugin: EnginePlugin, perturbations: int) -> Expected:
        """The truth that an answer is judged by."""
        assert answer.layout is not None and answer.state is not None
        slack = plugin.slacks.get(function, 0.0)
        more = slack, perturbations, getattr(plugin, "roundoff", DOUBLE)
        name = function.partition(":")[0]
        # Many files state the same tree.
        tree = replace(tree, name="")
        state = replace(answer.state, v=0.0 * answer.state.v) if _OF_NO_SPEED.match(name) else answer.state
        key = (name, tree, answer.layout, placed(state), *more)
        if key not in self._known:
            self._known[key] = expected(name, tree, answer.layout, state, *more)
        return self._known[key]


def names(plugins: Mapping[str, EnginePlugin]) -> list[str]:
    """Names of all functions, with the second ways of engines after each."""
    ways = dict.fromkeys(way for plugin in plugins.values() for way in plugin.functions if way not in FUNCTIONS)
    return [name for first in FUNCTIONS for name in (first, *(way for way in ways if way.partition(":")[0] == first))]


def suited(tree: Tree, plugin: EnginePlugin) -> Tree:
    """The tree with the gravity that an engine knows."""
    return replace(tree, gravity=vector(np.array(plugin.gravity))) if plugin.gravity else tree


def asked(plugin: EnginePlugin, tree: Tree) -> tuple[str, ...]:
    """The functions of an engine that a tree is for; none where it does not know what the tree demands."""
    if tree.demands - set(getattr(plugin, "demands", ())):
        return ()
    return tuple(name for name in plugin.functions if suits(name, tree))


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
    ask = worker.ask if worker else answered
    found = [_worst(plugin, job, answer, truths) for answer in ask(offered)]
    for worst, before in found:  # The worker is free again.
        own = replace(job, functions=(worst.cell.function,), further=False)
        if isinstance(worst.answer.value, Crashed) and job.further:
            worst = _crashed(plugin, own, worst, ask)
        elif before and worst.cell.verdict in RED:
            worst = _alone(plugin, own, worst, before, truths, ask, offered.functions)
        yield _stated(plugin, worst)


def _worst(plugin: EnginePlugin, job: Job, answer: Answer, truths: Truths) -> tuple[Judged, tuple[Answer, ...]]:
    """The worst of the answers at all states, and those before it."""
    first = worst = _judged(plugin, job, answer, truths)
    before: tuple[Answer, ...] = ()
    # Nothing that is answered is worse than wrong.
    for place, one in enumerate(() if first.cell.verdict == "wrong" else answer.further):
        found = _judged(plugin, job, one, truths)
        if one.at == AGAIN:
            found = _again(first, found)
        if _RANK.index(found.cell.verdict) > _RANK.index(worst.cell.verdict):
            worst, before = found, (answer, *answer.further[:place])
    return worst, before


def _again(first: Judged, again: Judged) -> Judged:
    """A second answer at the first state: the same bits, unless the engine says that it is off by something."""
    one, other = first.answer.value, again.answer.value
    if not isinstance(one, np.ndarray) or not isinstance(other, np.ndarray) or first.want is None:
        return again
    is_same = one.tobytes() == other.tobytes() or first.want.approximate
    if is_same or first.cell.verdict != "right":
        return again
    apart = float(np.max(np.abs(one - other), initial=0.0)) if one.shape == other.shape else np.inf
    cell = replace(
        again.cell, verdict="wrong", error=apart / first.want.scale, words="another answer at the same state"
    )
    return replace(again, cell=cell)


def _alone(
    plugin: EnginePlugin,
    job: Job,
    red: Judged,
    before: Sequence[Answer],
    truths: Truths,
    ask: Ask,
    others: Sequence[str],
) -> Judged:
    """A red answer of a further state, asked anew: by itself, or if that is not it, after what was asked before it."""
    answer = red.answer
    assert answer.layout is not None and answer.state is not None
    alone = replace(job, pieces=taken(answer.layout, answer.state))
    earlier = tuple((answer.function, taken(answer.layout, one.state)) for one in before if one.state is not None)
    asked_first = others[: others.index(answer.function)]
    after_others = ((((name, earlier[0][1]),), _AFTER.format(name)) for name in asked_first)
    for calls, how in (((), ""), (earlier[-1:], _AFTER_ONE), (earlier, _AFTER_ALL), *after_others):
        asked = replace(alone, before=calls)
        found = [replace(_judged(plugin, asked, one, truths), before=calls) for one in ask(asked)]
        if found and found[0].cell.verdict in RED:
            return _said(found[0], answer.at + how)
    return _said(replace(red, before=earlier), answer.at + _NO_MORE)


def _crashed(plugin: EnginePlugin, job: Job, red: Judged, ask: Ask) -> Judged:
    """A crash, at the state that it comes at."""
    (first,) = ask(job)
    if first.layout is None or first.state is None:
        return red
    for visit in visits(job.tree, first.layout, first.state, job.seed, 1):
        (answer,) = ask(replace(job, pieces=taken(first.layout, visit.state)))
        if isinstance(answer.value, Crashed):
            return _said(replace(red, answer=replace(answer, layout=first.layout, state=visit.state)), visit.name)
    return _said(red, "among further states")


def _said(one: Judged, more: str) -> Judged:
    """A judged answer with further words."""
    return replace(one, cell=replace(one.cell, words=": ".join(filter(None, (one.cell.words, more)))))


def _stated(plugin: EnginePlugin, one: Judged) -> Judged:
    """What the engine says of itself explains answers that are off the truth; one that is right stays right."""
    cell = one.cell
    for statement in getattr(plugin, "statements", ()) if cell.verdict in ("wrong", "imprecise") else ():
        is_about = re.fullmatch(statement.functions, cell.function) and statement.holds(one.tree, one.text)
        if is_about and any(re.search(statement.warned, said) for said in one.answer.warned or ("",)):
            said = f"{statement.words} ({statement.source}): {cell.verdict} by {cell.error:.1e}"
            return _said(replace(one, cell=replace(cell, verdict=statement.verdict, words=said)), cell.words)
    return one


def _judged(plugin: EnginePlugin, job: Job, answer: Answer, truths: Truths) -> Judged:
    cell, want = _judge(plugin, job.tree, answer, truths)
    return Judged(cell, answer, want, job.tree, job.form, job.text)


def _judge(plugin: EnginePlugin, tree: Tree, answer: Answer, truths: Truths) -> tuple[Cell, Expected | None]:
    value, plain = answer.value, Cell(plugin.name, tree.name, answer.function, "not offered")
    if isinstance(value, Crashed):
        return replace(plain, verdict="crashes", words=value.reason), None
    if isinstance(value, Unsupported):
        return replace(plain, verdict="refuses" if value.offered else "not offered", words=value.reason), None
    if isinstance(value, Raised):
        return replace(plain, verdict=value.kind, words=value.words), None
    for perturbations in dict.fromkeys((0, truths.perturbations, _MORE * truths.perturbations)):
        try:
            want = truths.of(answer.function, tree, answer, plugin, perturbations)
        except ZeroDivisionError:
            return replace(plain, words="the truth is singular"), None
        except Overflow:
            return replace(plain, words="the truth is beyond all numbers"), None
        except Exception as error:  # Of a layout that can't be: a fault of the plug-in's, or of ours.
            return replace(plain, verdict="plug-in", words=f"the truth in its layout: {words(error)}"), None
        cell = judge(plugin.name, tree, answer.function, value, want)
        # It is right without asking how far roundings go, or wrong however far they do.
        if cell.verdict == "right" or (perturbations and cell.verdict == "wrong"):
            break
    return cell, want


def cells(plugin: EnginePlugin, tree: Tree, functions: Sequence[str] = ()) -> Iterator[Cell]:
    """Cells of one engine on one tree, in this process: of the given functions, or of all that it offers."""
    chosen = tuple(functions) or asked(plugin, tree)
    job = Job(plugin.name, suited(tree, plugin), chosen, SEED, further=True)
    for one in judged(plugin, job, Truths()):
        yield one.cell
