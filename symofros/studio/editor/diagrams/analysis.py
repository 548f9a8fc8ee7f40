"""A diagram's text -> its meaning: as much of it as can be read, and everything that keeps it from being run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from symofros.description.reading import in_order
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.reader import read_diagram
from symofros.diagrams.order import AlgebraicLoopError, order_of
from symofros.diagrams.program.compiled import lowered
from symofros.diagrams.rates import schedule
from symofros.diagrams.wiring import Draft, Source, Wired, draft, whole
from symofros.errors import DescriptionError, Problem
from symofros.studio.editor.diagrams.drawing import Drawing
from symofros.studio.editor.diagrams.faults import placed
from symofros.studio.editor.document.meaning import Analysis, as_json
from symofros.studio.editor.editing.yaml_spans import YamlText

Needs = Mapping[str, frozenset[str]]

MAX_KNOWN = 1000
# What was found out of blocks: the same block with the same model and the same inputs needs what it needed before.
_known: dict[str, Needs | tuple[Problem, ...]] = {}


def analyse_diagram(file: Path, source: YamlText) -> Analysis:
    """Read and check a diagram.

    Args:
        file: Path of the document; models and parts are relative to it.
        source: Text of the document.
    """
    plain = source.root.plain()
    read, problems = read_diagram(file, source.text)
    drafted: Draft | None = None
    loop: tuple[Source, ...] = ()
    if read is not None:
        unread = {*_names(plain, "blocks"), *_names(plain, "parts")} - read.blocks.keys() - read.parts.keys()
        drafted = draft(read, unread)
        problems = [*problems, *drafted.problems]
        if not problems:
            problems, loop = _as_a_whole(read, drafted)
    shown = [placed(problem, source, str(file), plain) for problem in in_order(problems)]
    data = as_json(plain)
    return Analysis(True, data, problems=shown, diagram=Drawing(data, read, drafted, loop, shown).as_json())


def _as_a_whole(diagram: Diagram, drafted: Draft) -> tuple[list[Problem], tuple[Source, ...]]:
    """What is wrong with a diagram whose wires fit, and the signals of an algebraic loop, if it has one."""
    try:
        wired = whole(diagram, drafted)
        needs = _needs(diagram, wired)
        order_of(wired, needs)
        rates = [(name, block.period, block.offset) for name, block in wired.blocks.items() if block.period]
        schedule(rates, wired.name)
    except AlgebraicLoopError as error:
        return list(error.problems), error.path
    except DescriptionError as error:
        return list(error.problems), ()
    return [], ()


def _needs(diagram: Diagram, wired: Wired) -> dict[str, Needs]:
    """Block -> output -> inputs that it depends on at once.

    Raises:
        DescriptionError: Fields of blocks do not fit what is connected.
    """
    needs: dict[str, Needs] = {}
    problems: list[Problem] = []
    for name in wired.blocks:
        key = _identity(diagram, wired, name)
        if key not in _known:
            if len(_known) >= MAX_KNOWN:
                _known.clear()
            try:
                _known[key] = lowered(wired, name).needs
            except DescriptionError as error:
                _known[key] = tuple(error.problems)
        answer = _known[key]
        if isinstance(answer, tuple):
            problems += answer
        else:
            needs[name] = answer
    if problems:
        raise DescriptionError(problems)
    return needs


def _identity(diagram: Diagram, wired: Wired, name: str) -> str:
    """Everything that a block's formulas depend on, and the line that its faults are stated at."""
    block = wired.blocks[name]
    fed = [(port.name, port.shape, (name, port.name) in wired.sources) for port in wired.ports[name].inputs]
    model: Any = diagram.models.get(getattr(block, "model", ""))
    return repr((block, fed, model and (model.system, model.start, model.parameters), diagram.where(name)))


def _names(plain: Any, section: str) -> list[str]:
    named = plain.get(section) if isinstance(plain, dict) else None
    return list(named) if isinstance(named, dict) else []
