"""Statements that repeat -> loops: what a function does to one member of a row of equal members, it does to each.

The statements of equal parts of a mechanism follow each other with equal texts, but for what they read and write:
entries of arrays, variables, numbers. A run of them is written once, in a loop over the parts; their order stays, so
every value is computed by the same operations from the same operands (docs/theory/code.md, section 9).
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

from symofros.base import routes
from symofros.generator.codegen.statements import NUMBER, VARIABLE, Leaf, Statement, StatementWriter

# A loop has this many iterations at least, and spares so many variables.
FEWEST, MIN_SPARED = 6, 24
# Statements of a body at most, statements that a repetition is recognised by, places where it is looked for.
_LONGEST, SEED, _PLACES = 400, 4, 16
_MARK = re.compile("@(\\w+)")


@dataclass(frozen=True)
class Loop:
    """A run of statements that repeat.

    Attributes:
        iterations: Statements of each iteration.
        leaves: What the text of each statement mentions, in its order, by iteration.
    """

    iterations: Sequence[Sequence[Statement]]
    leaves: Sequence[Sequence[Sequence[Leaf]]]

    def __len__(self) -> int:
        """Statements of the text."""
        return len(self.iterations[0])

    @cached_property
    def keys(self) -> list[list[int]]:
        """Keys of the variables that each iteration defines."""
        return [[key for statement in body for key in statement.keys] for body in self.iterations]

    @cached_property
    def columns(self) -> list[list[list[Leaf]]]:
        """Leaves, in every iteration, that stand at each mention in each statement."""
        return [
            [list(column) for column in zip(*(body[j] for body in self.leaves), strict=True)] for j in range(len(self))
        ]

    @cached_property
    def _variables(self) -> list[tuple[int, ...]]:
        """The variables that a mention stands for, for each mention of another one than the iteration's own."""
        variables = dict.fromkeys(
            tuple(int(which) for _, which in column)
            for columns in self.columns
            for column in columns
            if column[0][0] == VARIABLE
        )
        return [mentioned for mentioned in variables if not self.is_own(mentioned)]

    def is_own(self, mentioned: Sequence[int]) -> bool:
        """Whether every iteration mentions a variable that it defines itself, in the same statement."""
        place = self._place.get(mentioned[0])
        return place is not None and all(self.keys[i][place] == key for i, key in enumerate(mentioned))

    def is_common(self, mentioned: Sequence[int]) -> bool:
        """Whether all iterations mention one variable, which none of them defines."""
        return _is_same(mentioned) and not any(mentioned[0] in keys for keys in self.keys)

    @cached_property
    def _place(self) -> dict[int, int]:
        """Place of each key of the first iteration among its keys."""
        return {key: place for place, key in enumerate(self.keys[0])}

    @cached_property
    def reads(self) -> list[int]:
        """Keys of variables that are the same in all iterations."""
        return [variables[0] for variables in self._variables if self.is_common(variables)]

    @cached_property
    def fetched(self) -> set[int]:
        """Keys of variables that iterations read from memory."""
        return {key for variables in self._variables if not self.is_common(variables) for key in variables}


Item = Statement | Loop
LinesOf = Callable[[Statement, StatementWriter], list[str]]


def with_loops(writer: StatementWriter, statements: Sequence[Statement]) -> tuple[list[Item], int]:
    """The statements, runs that repeat as loops, and how many of them loops leave out.

    Args:
        writer: Writer of the statements.
        statements: Statements of one function in order.
    """
    weights = [max(1, len(statement.nodes)) for statement in statements]
    if sum(weights) <= routes.MIN_REPEATED:
        return list(statements), 0
    shapes, leaves = _shapes(writer, statements)
    items: list[Item] = []
    spared, at = 0, 0
    for start, period, count in _runs(shapes, weights):
        items += statements[at:start]
        starts = range(start, start + period * count, period)
        items.append(Loop([statements[i : i + period] for i in starts], [leaves[i : i + period] for i in starts]))
        at = start + period * count
        spared += sum(weights[start + period : at])
    return [*items, *statements[at:]], spared


def _shapes(writer: StatementWriter, statements: Sequence[Statement]) -> tuple[list[int], list[list[Leaf]]]:
    """A number for the text of each statement without its leaves, and the leaves; equal texts have equal numbers."""
    known: dict[object, int] = {}
    shapes, leaves = [], []
    marked, mentioned = writer.marked()
    for statement in statements:
        shape: object
        if statement.vector is not None or any(key < 0 for key in statement.reads):
            shape = statement  # Vectors stay out of loops.
        elif statement.angles:
            graph = writer.graph
            sines = [(graph.op[n], statement.angles.index(graph.args[n][0])) for n in statement.nodes]
            shape = (*map(marked.text, statement.angles), *sines)
        else:
            shape = tuple(map(marked.operation, statement.nodes))
        stores = tuple(map(marked.store, statement.stores)) if statement.vector is None else ()
        shapes.append(known.setdefault((shape, stores), len(known)))
        leaves.append(mentioned.copy())
        mentioned.clear()
    return shapes, leaves


def _runs(shapes: Sequence[int], weights: Sequence[int]) -> Iterator[tuple[int, int, int]]:
    """(start, period, count) of runs that repeat, in order, without overlap: at each place the one that spares most.

    Args:
        shapes: Numbers of the texts of statements.
        weights: Variables of each statement, one at least.
    """
    seeds = list(zip(*(shapes[i:] for i in range(SEED)), strict=False))
    sums = list(accumulate(weights, initial=0))
    places: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for i, seed in enumerate(seeds):
        places[seed].append(i)
    rank = {i: number for of_seed in places.values() for number, i in enumerate(of_seed)}
    at = 0
    while at < len(seeds):
        following = places[seeds[at]][rank[at] + 1 : rank[at] + 1 + _PLACES]
        periods = [other - at for other in following if other - at <= _LONGEST]
        runs = [(period, count) for period in periods if (count := _count(shapes, at, period)) >= FEWEST]
        spared = {run: sums[at + run[0] * run[1]] - sums[at + run[0]] for run in runs}
        period, count = max(runs, key=spared.__getitem__, default=(1, 1))
        if spared.get((period, count), 0) >= MIN_SPARED:
            yield at, period, count
            at += period * count
        else:
            at += 1


def _count(shapes: Sequence[int], start: int, period: int) -> int:
    """Number of repetitions of the pattern of `period` statements from `start` on, the first included."""
    at = start
    while at + period < len(shapes) and shapes[at] == shapes[at + period]:
        at += 1
    return 1 + (at - start) // period


def loop_lines(
    loop: Loop,
    writer: StatementWriter,
    slots: Mapping[int, int],
    defining: LinesOf,
    storing: LinesOf,
) -> list[str]:
    """The lines of a loop.

    Args:
        loop: The loop.
        writer: Writer of the function.
        slots: Index in `work` of each variable that is kept there.
        defining: Lines that define the variables of a statement.
        storing: Lines that store its outputs.
    """
    tables, (marked, _) = _Tables(), writer.marked()
    fetched: dict[tuple[int, ...], str] = {}
    body: list[str] = []
    for j, statement in enumerate(loop.iterations[0]):
        texts = []
        for column in loop.columns[j]:
            kind, first = column[0]
            which = tuple(which for _, which in column)
            if kind == NUMBER:
                texts.append(writer.leaf(*column[0]) if _is_same(which) else tables.number(which))
                continue
            entries = tuple(map(int, which))
            if kind != VARIABLE:
                texts.append(f"{kind}[{tables.index(entries)}]")
            elif loop.is_own(entries) or loop.is_common(entries):
                texts.append(writer.name(int(first)))
            else:
                if entries not in fetched:
                    fetched[entries] = f"w{len(fetched)}"
                    place = tables.index([slots[key] for key in entries])
                    body.append(f"const double {fetched[entries]} = work[{place}];")
                texts.append(fetched[entries])
        remaining = iter(texts)
        body += _filled(defining(statement, marked), remaining)
        for key in statement.keys:
            if key in slots:
                own = loop.keys[0].index(key)
                body.append(f"work[{tables.index([slots[keys[own]] for keys in loop.keys])}] = {writer.name(key)};")
        body += _filled(storing(statement, marked), remaining)
    count = len(loop.iterations)
    lines = ["{", *tables.lines(count), "    int i;", f"    for (i = 0; i < {count}; ++i) {{"]
    return [f"    {line}" for line in (*lines, *(f"        {line.strip()}" for line in body), "    }", "}")]


def _filled(lines: Sequence[str], texts: Iterator[str]) -> list[str]:
    """Lines with texts in the places of their marks."""
    return [_MARK.sub(lambda _: next(texts), line) for line in lines]


class _Tables:
    """What changes from iteration to iteration other than by steps of one length."""

    def __init__(self) -> None:
        self._indices: dict[tuple[int, ...], str] = {}
        self._numbers: dict[tuple[float, ...], str] = {}

    def index(self, values: Sequence[int]) -> str:
        """Text of an index that has these values in turn."""
        first, step = values[0], values[1] - values[0]
        if all(value == first + i * step for i, value in enumerate(values)):
            if step == 0:
                return str(first)
            moved = "i" if abs(step) == 1 else f"{abs(step)} * i"
            if step < 0:
                return f"{first} - {moved}"
            return f"{first} + {moved}" if first else moved
        return self._indices.setdefault(tuple(values), f"at[{len(self._indices)}][i]")

    def number(self, values: tuple[float, ...]) -> str:
        """Text of a number that has these values in turn."""
        return self._numbers.setdefault(values, f"number[{len(self._numbers)}][i]")

    def lines(self, count: int) -> list[str]:
        """The lines that define the tables."""
        lines = []
        tables: tuple[tuple[str, str, Sequence[tuple[float, ...]]], ...] = (
            ("at", "int", [*self._indices]),
            ("number", "double", [*self._numbers]),
        )
        for name, kind, rows in tables:
            if rows:
                values = ", ".join(f"{{{', '.join(map(repr, row))}}}" for row in rows)
                lines.append(f"    static const {kind} {name}[{len(rows)}][{count}] = {{{values}}};")
        return lines


def _is_same(values: Sequence[float]) -> bool:
    return all(value == values[0] for value in values)
