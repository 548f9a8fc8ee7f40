"""Red cells by what is behind them: a stated cause, or one that is not yet found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..matrix import Judged
from ..verdicts import RED, Cell, judge
from .cause import Cause, stated
from .corrections import CORRECTIONS

_GRAVITY = {"wrong": 2, "crashes": 2, "raises": 1}
# What names of files begin with.
FORMATS = frozenset(("urdf", "mjcf", "sdf", "usd"))
# Part of the functions that are red on either of two trees that must be red on both.
_SIMILAR = 0.5


@dataclass(frozen=True)
class Group:
    """Red cells of an engine that are taken for the consequence of one cause.

    Attributes:
        engine: Name of the engine.
        cause: The cause as it is stated; None where it is not yet found.
        cells: The cells.
        hidden: Cells that another cause covers, as they are when that one is taken out.
    """

    engine: str
    cause: Cause | None
    cells: tuple[Cell, ...]
    hidden: tuple[Cell, ...] = ()

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions, the hidden ones last."""
        return tuple(dict.fromkeys(cell.function for cell in (*self.cells, *self.hidden)))

    @property
    def families(self) -> tuple[str, ...]:
        """Names of the functions, second ways of an engine under the name of the first."""
        return tuple(dict.fromkeys(name.partition(":")[0] for name in self.functions))

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the trees, the hidden ones last."""
        return tuple(dict.fromkeys(cell.model for cell in (*self.cells, *self.hidden)))

    @property
    def gravity(self) -> int:
        """2 where numbers are wrong or the process ends, 1 for exceptions, 0 for lost digits."""
        return max(_GRAVITY.get(cell.verdict, 0) for cell in (*self.cells, *self.hidden))

    @property
    def weight(self) -> tuple[int, int, int]:
        """What is mended first is largest: the gravest, then what most kinds of trees show, then most cells."""
        return self.gravity, len(self.models), len(self.cells) + len(self.hidden)


def causes_of(
    cells: Iterable[Cell], known: Sequence[Cause] | None = None, corrected: Iterable[Cell] = ()
) -> list[Group]:
    """What the red cells among `cells` come from, the heaviest first.

    Args:
        cells: Cells of any verdict, of one engine or more.
        known: Causes to look among; None: all that are stated; (): each is to be found from the cells alone.
        corrected: Cells of `without_their_causes`.
    """
    known = stated() if known is None else known
    shown: dict[Cause | None, list[Cell]] = {None: []}
    hidden: dict[Cause | None, list[Cell]] = {None: []}
    for place, chosen, possible in (
        (shown, cells, known),
        (hidden, corrected, [cause for cause in known if not cause.correction]),
    ):
        for cell in chosen:
            if cell.verdict in RED:
                place.setdefault(_first(cell, possible), []).append(cell)
    groups = [
        Group(cause.engine, cause, tuple(shown.get(cause, ())), tuple(hidden.get(cause, ())))
        for cause in known
        if cause in shown or cause in hidden
    ]
    groups += [Group(lot[0].engine, None, tuple(lot)) for lot in _alike(shown[None])]
    groups += [Group(lot[0].engine, None, (), tuple(lot)) for lot in _alike(hidden[None])]
    return sorted(groups, key=lambda group: group.weight, reverse=True)


def cause_of(cell: Cell) -> Cause | None:
    """The cause of a red cell, None where none is stated."""
    return _first(cell, stated())


def _first(cell: Cell, known: Iterable[Cause]) -> Cause | None:
    return next((cause for cause in known if cause.explains(cell)), None)


def stale(groups: Iterable[Group], engines: Iterable[str]) -> list[Cause]:
    """Causes of some engines that explain no cell of any group, although no release is known to be without them."""
    live, asked = {group.cause for group in groups}, set(engines)
    return [cause for cause in stated() if cause.engine in asked and cause not in live and not cause.last]


def without_their_causes(red: Iterable[Judged]) -> list[Cell]:
    """Red cells whose cause has a correction, judged again with the cause taken out of the answer."""
    cells = []
    for one in red:
        cause = cause_of(one.cell) if one.cell.verdict in RED else None
        if cause and cause.correction and isinstance(one.answer.value, np.ndarray) and one.want is not None:
            answer = CORRECTIONS[cause.correction](one.answer.value)
            cells.append(judge(one.cell.engine, one.tree, one.cell.function, answer, one.want))
    return cells


def by_function(cells: Iterable[Cell]) -> list[list[Cell]]:
    """Cells by engine, function and verdict."""
    lots: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in cells:
        lots.setdefault((cell.engine, cell.function, cell.verdict), []).append(cell)
    return list(lots.values())


def _by_other_readers(one: Cell, other: Cell) -> bool:
    """Whether both are of files, and these of two formats: each has a reader of its own."""
    forms = {cell.model.split()[0].rstrip(":") for cell in (one, other)}
    return len(forms & FORMATS) == 2


def _alike(cells: Sequence[Cell]) -> list[list[Cell]]:
    """Cells that are taken for one fault: of functions that are red on the same trees, and they on trees alike."""
    functions: dict[tuple[str, str], set[str]] = {}
    for cell in cells:
        functions.setdefault((cell.engine, cell.model), set()).add(cell.function)
    lots: list[list[Cell]] = []
    for named in by_function(cells):
        own: list[list[Cell]] = []
        for cell in named:
            mine = functions[cell.engine, cell.model]
            for lot in own:
                others = functions[cell.engine, lot[0].model]
                if _by_other_readers(cell, lot[0]):
                    continue
                if len(mine & others) >= _SIMILAR * len(mine | others):
                    lot.append(cell)
                    break
            else:
                own.append([cell])
        lots += own
    groups: dict[tuple[str, frozenset[str]], list[Cell]] = {}
    for lot in lots:
        key = lot[0].engine, frozenset(cell.model for cell in lot)
        groups.setdefault(key, []).extend(lot)
    return list(groups.values())
