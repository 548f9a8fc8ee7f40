"""A diagram's text -> its meaning: as much of it as can be read, and everything that keeps it from being run."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from symofros.description import System, in_order
from symofros.diagrams.block import Ports
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.reader import read_diagram
from symofros.diagrams.inlets import with_inlets
from symofros.diagrams.order import AlgebraicLoopError, order_of
from symofros.diagrams.program.compiled import lowered
from symofros.diagrams.rates import schedule
from symofros.diagrams.wiring import Draft, Wired, draft, whole
from symofros.errors import DescriptionError, Problem
from symofros.studio.editor.diagrams.drawing import Drawing
from symofros.studio.editor.diagrams.faults import placed
from symofros.studio.editor.diagrams.native_code import native_code
from symofros.studio.editor.document.element_lines import element_lines
from symofros.studio.editor.document.meaning import Analysis, as_json
from symofros.studio.editor.editing.yaml_spans import YamlText

BlockNeeds = Mapping[str, frozenset[str]]

MAX_KNOWN, MAX_LOOPS = 1000, 20
# What was found out of blocks: the same block with the same model, file and inputs needs what it needed before.
_known: dict[str, BlockNeeds | tuple[Problem, ...]] = {}


def analyse_diagram(file: Path, source: YamlText) -> Analysis:
    """Read and check a diagram.

    Args:
        file: Path of the document; models and parts are relative to it.
        source: Text of the document.
    """
    plain = source.data
    read, problems = read_diagram(file, source.text)
    drafted: Draft | None = None
    loops: list[AlgebraicLoopError] = []
    if read is not None:
        unread = {*_names(plain, "blocks"), *_names(plain, "parts")} - read.blocks.keys() - read.parts.keys()
        try:
            read = with_inlets(read)
        except DescriptionError as error:
            problems = [*problems, *error.problems]
        drafted = draft(read, unread)
        problems = [*problems, *drafted.problems]
        more, loops = _whole_diagram_problems(read, drafted) if not problems else ([], _loops_of_a_part(read, drafted))
        problems += [*more, *(error.problem for error in loops)]
    shown = [placed(problem, source, str(file), plain) for problem in in_order(problems)]
    data = as_json(plain)
    wired = None if problems or read is None or drafted is None else whole(read, drafted)
    mechanisms, native = ({}, {}) if wired is None else (_mechanisms(wired), native_code(wired))
    drawing = Drawing(data, read, drafted, [error.path for error in loops], shown)
    shown_diagram = {**drawing.as_json(), "moving": list(mechanisms)}
    lines = element_lines(source, [*shown_diagram["nodes"], *shown_diagram["wires"]])
    return Analysis(
        True, data, problems=shown, diagram=shown_diagram, mechanisms=mechanisms, native=native, lines=lines
    )


def _mechanisms(wired: Wired) -> dict[str, System]:
    """Block -> system that it moves."""
    return {name: wired.models.system(model) for name, model in wired.mechanisms().items()}


def _whole_diagram_problems(diagram: Diagram, drafted: Draft) -> tuple[list[Problem], list[AlgebraicLoopError]]:
    """Problems of a complete diagram, such as incompatible rates, and its algebraic loops."""
    try:
        wired = whole(diagram, drafted)
        needs, problems = _needs(diagram, wired)
        loops = _loops(wired, needs)
        if not problems and not loops:
            rates = [(name, block.period, block.offset) for name, block in wired.blocks.items() if block.period]
            schedule(rates, wired.name)
    except DescriptionError as error:
        return list(error.problems), []
    return problems, loops


def _loops_of_a_part(diagram: Diagram, drafted: Draft) -> list[AlgebraicLoopError]:
    """The algebraic loops among those blocks of a faulty diagram whose ports are known; unknown shapes count as ()."""
    # Only a block that is fed and feeds can be in a loop.
    known = {name for name, _ in drafted.sources} & {name for name, _ in drafted.sources.values()}
    sources = {end: source for end, source in drafted.sources.items() if end[0] in known and source[0] in known}
    blocks = {name: block for name, block in diagram.blocks.items() if name in known}
    ports = {name: _with_shapes(drafted.ports[name]) for name in blocks}
    wired = Wired(diagram.name, blocks, ports, sources, drafted.models, {}, diagram.origin)
    return _loops(wired, _needs(diagram, wired)[0])


def _with_shapes(ports: Ports) -> Ports:
    sides = (ports.inputs, ports.outputs)
    inputs, outputs = (tuple(replace(port, shape=port.shape or ()) for port in side) for side in sides)
    return Ports(inputs, outputs)


def _loops(wired: Wired, needs: Mapping[str, BlockNeeds]) -> list[AlgebraicLoopError]:
    """Algebraic loops, each found with the earlier ones cut at their last wire."""
    loops: list[AlgebraicLoopError] = []
    from_known = {end for end, source in wired.sources.items() if source[0] in needs}
    left = {
        name: {port: frozenset(item for item in inputs if (name, item) in from_known) for port, inputs in of.items()}
        for name, of in needs.items()
    }
    while len(loops) < MAX_LOOPS:
        try:
            order_of(wired, left)
        except AlgebraicLoopError as error:
            loops.append(error)
            source, (name, port) = error.path[-2:]
            left[name][port] = frozenset(item for item in left[name][port] if wired.sources.get((name, item)) != source)
        else:
            break
    return loops


def _needs(diagram: Diagram, wired: Wired) -> tuple[dict[str, BlockNeeds], list[Problem]]:
    """Block -> output -> inputs that it depends on at once, and why fields of blocks do not fit what is connected."""
    needs: dict[str, BlockNeeds] = {}
    problems: list[Problem] = []
    for name in wired.blocks:
        key = _identity(diagram, wired, name)
        where = f"{key} at {diagram.where(name)}"  # Faults are stated with their line.
        if key not in _known and where not in _known:
            if len(_known) >= MAX_KNOWN:
                _known.clear()
            try:
                _known[key] = lowered(wired, name).needs
            except DescriptionError as error:
                _known[where] = tuple(error.problems)
        answer = _known[key] if key in _known else _known[where]
        if isinstance(answer, tuple):
            problems += answer
        else:
            needs[name] = answer
    return needs, problems


def _identity(diagram: Diagram, wired: Wired, name: str) -> str:
    """Everything that a block's formulas depend on."""
    block = wired.blocks[name]
    fed = [(port.name, port.shape, (name, port.name) in wired.sources) for port in wired.ports[name].inputs]
    model: Any = diagram.models.get(getattr(block, "model", ""))
    return repr(
        (block, fed, _version(getattr(block, "file", "")), model and (model.system, model.start, model.parameters))
    )


def _version(file: str) -> tuple[int, int]:
    """When the file of a block was changed last [ns], and its size; zeros where there is none."""
    try:
        known = os.stat(file)
    except OSError:
        return 0, 0
    return known.st_mtime_ns, known.st_size


def _names(plain: Any, section: str) -> list[str]:
    named = plain.get(section) if isinstance(plain, dict) else None
    return list(named) if isinstance(named, dict) else []
