"""Patterns of the equations of many loops: M, G and G M^-1 G^T with their zeros left out.

Found symbolically, from the entries that are zero in the graph; the routine that uses them is
native/model/sparse_system.c.in (docs/theory/constraints.md, section 12).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate, chain

from symofros.base.routes import Choice, choose, table_pays
from symofros.expr.edges import ZERO, Edge
from symofros.expr.program import Output


@dataclass(frozen=True)
class Pattern:
    """Entries of a symmetric matrix below its diagonal, and of its Cholesky factor.

    Attributes:
        columns: Rows of the entries of each column, ascending.
    """

    columns: tuple[tuple[int, ...], ...]

    @staticmethod
    def filled(columns: Sequence[Iterable[int]]) -> Pattern:
        """Pattern of the Cholesky factor, fill-in included, of a matrix with these entries below its diagonal."""
        left = [set(column) for column in columns]
        for column in left:
            if column:
                parent = min(column)
                left[parent] |= column - {parent}
        return Pattern(tuple(tuple(sorted(column)) for column in left))

    @property
    def starts(self) -> list[int]:
        """First entry of each column, and the number of entries."""
        return [0, *accumulate(map(len, self.columns))]

    @property
    def rows(self) -> list[int]:
        """Row of each entry."""
        return list(chain.from_iterable(self.columns))

    @property
    def targets(self) -> list[int]:
        """Entries in the rows of each pair of entries of a column: column by column, row by row."""
        starts = self.starts
        at = [{row: starts[k] + i for i, row in enumerate(column)} for k, column in enumerate(self.columns)]
        return [
            at[first][second] for column in self.columns for i, first in enumerate(column) for second in column[i + 1 :]
        ]

    @property
    def updates(self) -> int:
        """Number of products that a factorisation takes."""
        return sum(len(column) * (len(column) + 1) // 2 for column in self.columns)

    def reached(self, rows: Iterable[int]) -> tuple[int, ...]:
        """Entries of C^-1 b that may differ from zero where those of b do: the ways up the elimination tree."""
        reached: set[int] = set()
        for row in rows:
            while row not in reached:
                reached.add(row)
                if not self.columns[row]:
                    break
                row = self.columns[row][0]
        return tuple(sorted(reached))


@dataclass(frozen=True)
class SparseSystem:
    """Patterns of M a = r + G^T lam, G a = c.

    Attributes:
        mass: Of M, column k for speed n - 1 - k.
        schur: Of S = G M^-1 G^T.
        conditions: Row of G of each column of S.
        speeds: Columns of `mass` of the entries of G, for each column of S.
        reach: The same of C^-1 G^T, for the factor C of M.
    """

    mass: Pattern
    schur: Pattern
    conditions: tuple[int, ...]
    speeds: tuple[tuple[int, ...], ...]
    reach: tuple[tuple[int, ...], ...]

    @staticmethod
    def of(M: Output, G: Output) -> tuple[SparseSystem | None, Choice]:
        """The patterns of these matrices, None where full ones are as fast; and that choice.

        Args:
            M: (n, n).
            G: (m, n).
        """
        full = 3 * G.shape[0] ** 2 * G.shape[1]
        system, products = SparseSystem._sparse_if_cheaper(M, G, full)
        route = choose("constrained system", {"table_products": products, "full_products": full})
        return system if route.method == "sparse" else None, route

    @staticmethod
    def _sparse_if_cheaper(M: Output, G: Output, full: int) -> tuple[SparseSystem | None, int]:
        """The patterns with the products of a solution; without them, a part of the products that is too much."""
        m, n = G.shape
        mass = Pattern.filled(
            [[row for row in range(k + 1, n) if _entry(M, n - 1 - row, n - 1 - k) != ZERO] for k in range(n)]
        )
        speeds = [tuple(k for k in range(n) if _entry(G, i, n - 1 - k) != ZERO) for i in range(m)]
        reach = [mass.reached(row) for row in speeds]
        products = mass.updates + sum(len(mass.columns[k]) for row in reach for k in row)
        if not table_pays(products, full):
            return None, products
        neighbours = _neighbours(reach, n)
        products = sum(map(len, neighbours))
        if not table_pays(products, full):
            return None, products
        order = _minimum_degree_order(neighbours)
        place = {condition: j for j, condition in enumerate(order)}
        schur = Pattern.filled([{place[i] for i in neighbours[c] if place[i] > place[c]} for c in order])
        system = SparseSystem(
            mass, schur, tuple(order), tuple(speeds[c] for c in order), tuple(reach[c] for c in order)
        )
        return system, system.operations

    @property
    def operations(self) -> int:
        """Products that a solution takes, about."""
        reach = sum(len(self.mass.columns[k]) + 1 for row in self.reach for k in row)
        dots = sum(len(self.reach[i]) for column in self.schur.columns for i in column)
        return self.mass.updates + self.schur.updates + dots + 5 * reach + 4 * len(self.schur.rows)

    @property
    def entries(self) -> int:
        """Numbers of M and of S below the diagonal and of C^-1 G^T."""
        return len(self.mass.rows) + len(self.schur.rows) + sum(map(len, self.reach))

    def packed(self, outputs: Sequence[Output]) -> tuple[Output, ...]:
        """A function's outputs, with M and G packed as the routine takes them."""
        pack = {"M": self._packed_mass, "G": self._packed_rows}
        return tuple(pack[output.name](output) if output.name in pack else output for output in outputs)

    def _packed_mass(self, M: Output) -> Output:
        n = len(self.mass.columns)
        entries = [(k, k) for k in range(n)] + [(row, k) for k, rows in enumerate(self.mass.columns) for row in rows]
        edges = tuple(_entry(M, n - 1 - row, n - 1 - k) for row, k in entries)
        return Output(M.name, (len(edges),), edges)

    def _packed_rows(self, G: Output) -> Output:
        n = len(self.mass.columns)
        rows = zip(self.conditions, self.speeds, strict=True)
        edges = tuple(_entry(G, condition, n - 1 - k) for condition, row in rows for k in row)
        return Output(G.name, (len(edges),), edges)

    def tables(self) -> list[str]:
        """The patterns as the constant `sparse` of a C function."""
        of_speeds = [0, *accumulate(map(len, self.speeds))]
        of_reach = [0, *accumulate(map(len, self.reach))]
        named = {
            "condition": self.conditions,
            "start": of_speeds,
            "speed_of": list(chain.from_iterable(self.speeds)),
            "reach_start": of_reach,
            "reach": list(chain.from_iterable(self.reach)),
        }
        for name, pattern in (("mass", self.mass), ("schur", self.schur)):
            named |= {f"{name}_start": pattern.starts, f"{name}_row": pattern.rows, f"{name}_target": pattern.targets}
        # C has no empty arrays.
        lines = [
            f"    static const int {name}[] = {{{', '.join(map(str, row or (0,)))}}};" for name, row in named.items()
        ]
        patterns = [
            f"{{{len(pattern.columns)}, {name}_start, {name}_row, {name}_target}}"
            for name, pattern in (("mass", self.mass), ("schur", self.schur))
        ]
        return [
            *lines,
            "    static const struct sym_sparse sparse = {",
            f"        {', '.join(patterns)},",
            "        condition, start, speed_of, reach_start, reach};",
        ]


def _entry(matrix: Output, row: int, column: int) -> Edge:
    return matrix.edges[row * matrix.shape[1] + column]


def _neighbours(reach: Sequence[Sequence[int]], n: int) -> list[set[int]]:
    """The conditions that share a speed with each one."""
    of_speed: list[list[int]] = [[] for _ in range(n)]
    for i, row in enumerate(reach):
        for k in row:
            of_speed[k].append(i)
    neighbours: list[set[int]] = [set() for _ in reach]
    for group in of_speed:
        for i in group:
            neighbours[i].update(group)
    for i, others in enumerate(neighbours):
        others.discard(i)
    return neighbours


def _minimum_degree_order(neighbours: Sequence[set[int]]) -> list[int]:
    """An order of elimination in which little fills in: at each turn a node of least degree."""
    left = {i: set(others) for i, others in enumerate(neighbours)}
    order = []
    while left:
        node = min(left, key=lambda i: len(left[i]))
        others = left.pop(node)
        for i in others:
            left[i] |= others
            left[i] -= {i, node}
        order.append(node)
    return order
