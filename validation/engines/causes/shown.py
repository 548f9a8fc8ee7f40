"""Causes as blocks of a report: what is to be mended first comes first, cells are folded."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any

from ...reporting.numbers import counted
from ...reporting.record import Block, Bullets, Code, Section
from ..verdicts import RED, Cell
from .grouping import Group, by_function

# Verdicts of cells that differ from the truth and are no fault, and where their words say by how much.
_WITHDRAWN = ("precondition", "repairs")
_OFF = re.compile(rf": (?:{'|'.join(RED)}) by ")
# Names of trees that are drawn list all their features after a number, which says enough in a line.
_DRAWN = re.compile(r"(\w+ \d+): .*")
# Names that a line shows before it counts the others.
_FEW = 3


def named(names: Sequence[str], few: int = _FEW, code: bool = False) -> str:
    """The first names, and how many more there are."""
    shown = [f"`{name}`" if code else _DRAWN.sub(r"\1", name) for name in names[:few]]
    return ", ".join(shown) + (f" and {len(names) - few} more" if len(names) > few else "")


def what(group: Group) -> str:
    """What is wrong, in one sentence."""
    if group.cause:
        return group.cause.what
    verdicts = " or ".join(dict.fromkeys(cell.verdict for cell in (*group.cells, *group.hidden)))
    return f"Cause not yet found: {named(group.functions, code=True)} {verdicts} on {named(group.models)}."


def where(group: Group) -> str:
    """What it shows in."""
    return group.cause.shows if group.cause else named(group.models)


def thread(group: Group) -> str:
    """The public thread as a link, or that none is known."""
    known = group.cause.known if group.cause else "not searched"
    address, _, remark = known.partition(" ")
    if not address.startswith("https://"):
        return known
    _, _, _, owner, project, *_, number = address.split("/")
    return f"[{owner}/{project}#{number}]({address}) {remark}".strip()


def anchor(group: Group) -> str:
    """Name for links to a cause."""
    name = group.cause.name if group.cause else "-".join((group.functions[0], group.models[0]))
    return re.sub(r"\W+", "-", f"cause-{group.engine}-{name}")


def fold(group: Group, place: int, groups: Sequence[Group], proofs: Sequence[Mapping[str, Any]]) -> Section:
    """A cause: its sentence, and folded under it what it offends, the shortest script, and the cells.

    Args:
        group: The cause and its cells.
        place: Its place among those of its engine, from 1.
        groups: All causes.
        proofs: Proofs of the report.
    """
    places = _places(group)
    own = [proof for proof in proofs if (proof["engine"], proof["function"], proof["model"]) in places]
    scripts = scripts_of(group, groups, proofs)
    blocks: list[Block] = [Bullets(tuple(_stated(group, groups)))]
    if scripts:
        first = scripts[0]
        title = f"Shortest script: `reports/engines/{first['file']}`"
        blocks.append(Section(title, (Code(first["text"]), Code(first["output"])), page_only=True))
    files = {proof["function"]: proof for proof in own}
    for cells, name in ((group.cells, ""), (group.hidden, " behind another cause")):
        if cells:
            lines = tuple(_of_function(lot, files.get(lot[0].function)) for lot in by_function(cells))
            blocks.append(Section(f"{counted(len(cells), 'cell')}{name}", (Bullets(lines),), page_only=True))
    verdicts = ", ".join(dict.fromkeys(cell.verdict for cell in (*group.cells, *group.hidden)))
    number = counted(len(group.cells), "cell") + (f" and {len(group.hidden)} hidden" if group.hidden else "")
    title = f"{place}. {what(group)} Shows in: {where(group)} ({verdicts}; {number})"
    return Section(title, tuple(blocks), anchor(group))


def _places(group: Group) -> set[tuple[str, str, str]]:
    return {(cell.engine, cell.function, cell.model) for cell in group.cells}


def scripts_of(group: Group, groups: Sequence[Group], proofs: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Proofs of a cause by scripts, the shortest first; what shows another cause, too, comes last."""
    places = _places(group)
    # What shows another cause, too, when this one is taken out, is no plain proof.
    both = {(cell.engine, cell.function, cell.model) for other in groups for cell in other.hidden}
    named_by = itemgetter("engine", "function", "model")
    own = (one for one in proofs if named_by(one) in places and one["proven"] and one["text"])
    return sorted(own, key=lambda one: (named_by(one) in both, len(one["text"])))


def _stated(group: Group, groups: Sequence[Group]) -> Iterator[str]:
    """What is stated of a cause, and what hides it or is hidden by it."""
    yield f"Functions: {named(group.functions, len(group.functions), code=True)}."
    yield f"Public thread: {thread(group)}."
    cause = group.cause
    if cause is None:
        return
    yield f"It offends: {cause.offends}"
    yield f"Documented: {cause.documented or 'no.'}"
    yield f"Releases: {cause.releases}."
    if group.hidden:
        yield f"{counted(len(group.hidden), 'cell')} more of it would be red if the cause that covers them were mended."
    if cause.correction:
        behind = [other for other in groups if other.hidden and other.engine == group.engine]
        counts = [f"{len(other.hidden)} by [{what(other)}](#{anchor(other)})" for other in behind]
        rest = len(group.cells) - sum(len(other.hidden) for other in behind)
        if counts:
            listed = "; ".join(counts)
            yield f"With this one taken out of the answers {counted(rest, 'cell')} are right; still red: {listed}"


def _of_function(cells: Sequence[Cell], proof: Mapping[str, Any] | None) -> str:
    """The trees on which one function is red, and the script that proves it, or why there is none."""
    first = cells[0]
    worst = max(cells, key=lambda cell: cell.error)
    said = f"error up to {worst.error:.1e}, tolerance {worst.tolerance:.1e}" if worst.error else first.words
    script = ""
    if proof:
        script = f"; `{proof['file']}`" if proof["proven"] else f"; not proven: {proof['output'].splitlines()[-1]}"
    return f"`{first.function}` {first.verdict} on {', '.join(cell.model for cell in cells)}: {said}{script}"


def withdrawn(cells: Iterable[Cell]) -> list[str]:
    """Cells that are no fault, though their answers differ from the truth, with the engine's words and their place."""
    lots: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in cells:
        if cell.verdict in _WITHDRAWN:
            # After what the engine says comes how far each cell is off (`matrix`).
            lots.setdefault((cell.engine, cell.verdict, _OFF.split(cell.words)[0]), []).append(cell)
    return [
        f"**{engine}**, {verdict} of {counted(len(own), 'cell')}: {said}. "
        f"{named(list(dict.fromkeys(cell.function for cell in own)), code=True)} on "
        f"{named(list(dict.fromkeys(cell.model for cell in own)))}."
        for (engine, verdict, said), own in lots.items()
    ]
