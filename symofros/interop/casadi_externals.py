"""C text of CasADi's interface of external functions: names, sparsities, and the entries of a model's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from symofros.interop.casadi_sources import Source


class Input(NamedTuple):
    """An input of an external function, a column or a matrix with the pattern of an output.

    Attributes:
        label: Name for CasADi.
        size: Number of entries of a column.
        group: Input group of the model that it is; "" where it is not read.
        like: Output that it has the pattern of.
    """

    label: str
    size: int = 0
    group: str = ""
    like: Output | None = None

    @property
    def sparsity(self) -> list[int]:
        """Sparsity in CasADi's compressed-column format: (size, 1, 1) for a dense column."""
        return [self.size, 1, 1] if self.like is None else self.like.sparsity


class Output(NamedTuple):
    """An output of an external function: entries of an array that a source gives.

    Attributes:
        label: Name for CasADi.
        shape: Rows and columns that CasADi sees.
        source: What gives the array; None where all entries are zero.
        cells: Row and column of each nonzero, column by column, and its index in the array, which is row by row.
    """

    label: str
    shape: tuple[int, int]
    source: Source | None = None
    cells: tuple[tuple[int, int, int], ...] = ()

    @property
    def gather(self) -> list[int]:
        """Index of each nonzero in the array."""
        return [at for _, _, at in self.cells]

    @property
    def sparsity(self) -> list[int]:
        """Rows, columns, first nonzero of each column, row of each nonzero."""
        counts = np.bincount([column for _, column, _ in self.cells], minlength=self.shape[1])
        return [*self.shape, 0, *np.cumsum(counts).tolist(), *(row for row, _, _ in self.cells)]


def gathered(
    label: str,
    source: Source,
    shape: tuple[int, int],
    first: tuple[int, int] = (0, 0),
    transposed: bool = False,
    dense: bool = False,
) -> Output:
    """A block of an array, without the entries that are zero in every state.

    Args:
        label: Name for CasADi.
        source: What gives the array.
        shape: Shape that CasADi sees.
        first: Row and column of the array where the block begins.
        transposed: Whether CasADi sees the block's transpose.
        dense: Whether entries that are zero in every state stay.
    """
    width = source.nonzero.shape[1]
    cells = []
    for column in range(shape[1]):
        for row in range(shape[0]):
            i, k = (column, row) if transposed else (row, column)
            if dense or source.nonzero[first[0] + i, first[1] + k]:
                cells.append((row, column, (first[0] + i) * width + first[1] + k))
    return Output(label, shape, source, tuple(cells))


def slopes_of(label: str, source: Source, of: Output, first: tuple[int, int], size: int) -> Output:
    """The derivatives of a Jacobian (m, c), its entries column by column, from a matrix for each row of it.

    Args:
        label: Name for CasADi.
        source: What gives the matrices, one below the other.
        of: The Jacobian, whose entries that are zero in every state have no derivative.
        first: Row and column of each matrix where the block begins.
        size: Number of entries of what it is differentiated by.
    """
    (m, columns), width = of.shape, source.nonzero.shape[1]
    cells = []
    for k in range(size):
        for i, j, _ in of.cells:
            row, column = i * width + first[0] + j, first[1] + k
            if source.nonzero[row, column]:
                cells.append((i + m * j, k, row * width + column))
    return Output(label, (m * columns, size), source, tuple(cells))


@dataclass(frozen=True)
class External:
    """One external function.

    Attributes:
        name: Name of the C function; those that describe it begin with the same.
        inputs: What it takes.
        outputs: What it gives; those of one function of the model stand together.
    """

    name: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]

    def text(self, c_name: str) -> str:
        """C text of the function, for the model of that C name."""
        own, n_in, n_out = self.name, len(self.inputs), len(self.outputs)
        lines = []
        for i, given in enumerate(self.inputs):
            lines.append(f"static const casadi_int {own}_in_{i}[] = {{{_numbers(given.sparsity)}}};")
        for i, output in enumerate(self.outputs):
            lines.append(f"static const casadi_int {own}_out_{i}[] = {{{_numbers(output.sparsity)}}};")
            lines.append(f"static const casadi_int {own}_gather_{i}[] = {{{_numbers(output.gather)}}};")
        sources = list(dict.fromkeys(output.source for output in self.outputs if output.source is not None))
        plans = ", ".join(self._plan(i, sources) for i in range(n_out))
        made = ", ".join(source.text for source in sources)
        groups = ", ".join(f'"{given.group}"' for given in self.inputs)
        lines += [
            f"static const char *const {own}_groups[] = {{{groups}}};",
            f"static const sym_casadi_output {own}_outputs[] = {{{plans}}};",
            f"static const sym_casadi_source {own}_sources[] = {{{made}}};",
            f"static const sym_casadi_plan {own}_plan = {{{n_in}, {n_out}, {len(sources)}, SYM_CASADI_SEGMENTS,",
            f"    {own}_groups, {own}_outputs, {own}_sources, sym_casadi_segments}};",
            f"SYM_EXPORT casadi_int {own}_n_in(void) {{ return {n_in}; }}",
            f"SYM_EXPORT casadi_int {own}_n_out(void) {{ return {n_out}; }}",
            *_table(f"const char *{own}_name_in", [f'"{given.label}"' for given in self.inputs]),
            *_table(f"const char *{own}_name_out", [f'"{output.label}"' for output in self.outputs]),
            *_table(f"const casadi_int *{own}_sparsity_in", [f"{own}_in_{i}" for i in range(n_in)]),
            *_table(f"const casadi_int *{own}_sparsity_out", [f"{own}_out_{i}" for i in range(n_out)]),
            f"SYM_EXPORT int {own}_work(casadi_int *arg, casadi_int *res, casadi_int *iw, casadi_int *w) {{",
            f"    if (arg != NULL) *arg = {n_in};",
            f"    if (res != NULL) *res = {n_out};",
            "    if (iw != NULL) *iw = 0;",
            f"    if (w != NULL) *w = (casadi_int)sym_casadi_work({c_name}_model(), &{own}_plan);",
            "    return 0;",
            "}",
            f"SYM_EXPORT int {own}(const double **arg, double **res, casadi_int *iw, double *w, int mem) {{",
            "    (void)iw, (void)mem;",
            f"    return sym_casadi_run({c_name}_model(), &{own}_plan, arg, res, w);",
            "}",
            "",
        ]
        return "\n".join(lines)

    def _plan(self, index: int, sources: Sequence[Source]) -> str:
        """Initialiser of a sym_casadi_output."""
        output = self.outputs[index]
        source = -1 if output.source is None else sources.index(output.source)
        return f"{{{source}, {len(output.cells)}, {self.name}_gather_{index}}}"


def _table(declared: str, entries: Sequence[str]) -> list[str]:
    """A C function of an index."""
    cases = " ".join(f"case {i}: return {entry};" for i, entry in enumerate(entries))
    return [f"SYM_EXPORT {declared}(casadi_int i) {{", f"    switch (i) {{ {cases} default: return NULL; }}", "}"]


def _numbers(values: Sequence[int]) -> str:
    return ", ".join(map(str, values)) or "0"
