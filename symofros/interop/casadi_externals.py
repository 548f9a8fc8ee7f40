"""C text of CasADi's interface of external functions: names, sparsities, and the entries of a model's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from symofros.expr.edges import ZERO
from symofros.expr.program import Function


class Input(NamedTuple):
    """An input of an external function, a column.

    Attributes:
        label: Name for CasADi.
        size: Number of entries.
        group: Input group of the model that it is; "" where it is not read.
    """

    label: str
    size: int
    group: str = ""


class Output(NamedTuple):
    """An output of an external function: entries of an array that a function of the model returns.

    Attributes:
        label: Name for CasADi.
        shape: Rows and columns that CasADi sees.
        function: Name of the model's function.
        frame: Its frame, or "".
        array: Index of the array among what it returns.
        cells: Row and column of each nonzero, column by column, and its index in the array, which is row by row.
    """

    label: str
    shape: tuple[int, int]
    function: str = ""
    frame: str = ""
    array: int = 0
    cells: tuple[tuple[int, int, int], ...] = ()

    @property
    def gather(self) -> list[int]:
        """Index of each nonzero in the array."""
        return [at for _, _, at in self.cells]

    @property
    def sparsity(self) -> list[int]:
        """Rows, columns, first nonzero of each column, row of each nonzero."""
        starts = [sum(column < k for _, column, _ in self.cells) for k in range(self.shape[1] + 1)]
        return [*self.shape, *starts, *(row for row, _, _ in self.cells)]


def gathered(
    label: str,
    function: Function,
    array: str,
    shape: tuple[int, int],
    first: tuple[int, int] = (0, 0),
    transposed: bool = False,
    dense: bool = False,
) -> Output:
    """A block of an array, without the entries that are zero in every state.

    Args:
        label: Name for CasADi.
        function: Function of the model.
        array: Name of the array that it returns.
        shape: Shape that CasADi sees.
        first: Row and column of the array where the block begins.
        transposed: Whether CasADi sees the block's transpose.
        dense: Whether entries that are zero in every state stay.
    """
    index = [name for name, _ in function.returns].index(array)
    dimensions = function.returns[index][1]
    width, nonzero = (dimensions[1] if len(dimensions) > 1 else 1), _nonzero(function, index)
    cells = []
    for column in range(shape[1]):
        for row in range(shape[0]):
            i, k = (column, row) if transposed else (row, column)
            at = (first[0] + i) * width + first[1] + k
            if dense or nonzero[at]:
                cells.append((row, column, at))
    return Output(label, shape, function.name, function.frame, index, tuple(cells))


def _nonzero(function: Function, index: int) -> list[bool]:
    """Which entries of an array may differ from zero; of what a solver finishes, by what it is made of."""
    solver = function.solver
    if solver is None:
        return [edge != ZERO for edge in function.outputs[index].edges]
    if solver.routine == "transpose":
        return [edge != ZERO for edge in solver.parts[0].outputs[index].edges]
    if solver.routine == "differentiate":
        slopes = solver.parts[0].outputs[index]
        return _columns(slopes.edges, slopes.shape[1]) * slopes.shape[0]
    if solver.routine == "hessian":
        # docs/theory/linear.md, eq. 23.
        slopes, (by_x, mixed) = solver.parts[0].outputs[0], solver.parts[1].outputs
        n = slopes.shape[1]
        moves, couples = _columns(slopes.edges, n), _columns(mixed.edges, n)
        return [
            by_x.edges[i * n + k] != ZERO or (couples[i] and moves[k]) or (couples[k] and moves[i])
            for i in range(n)
            for k in range(n)
        ]
    (shape,) = (shape for _, shape in function.returns[index : index + 1])
    return [True] * (shape[0] if len(shape) == 1 else shape[0] * shape[1])


def _columns(edges: Sequence[int], width: int) -> list[bool]:
    """Whether a column of a matrix has entries."""
    return [any(edge != ZERO for edge in edges[k::width]) for k in range(width)]


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
            lines.append(f"static const casadi_int {own}_in_{i}[] = {{{given.size}, 1, 1}};")
        for i, output in enumerate(self.outputs):
            lines.append(f"static const casadi_int {own}_out_{i}[] = {{{_numbers(output.sparsity)}}};")
            lines.append(f"static const casadi_int {own}_gather_{i}[] = {{{_numbers(output.gather)}}};")
        plans = ", ".join(self._plan(i) for i in range(n_out))
        groups = ", ".join(f'"{given.group}"' for given in self.inputs)
        lines += [
            f"static const char *const {own}_groups[] = {{{groups}}};",
            f"static const sym_casadi_output {own}_outputs[] = {{{plans}}};",
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
            f"    if (w != NULL) *w = (casadi_int)sym_casadi_work({c_name}_model());",
            "    return 0;",
            "}",
            f"SYM_EXPORT int {own}(const double **arg, double **res, casadi_int *iw, double *w, int mem) {{",
            f"    const sym_model *model = {c_name}_model();",
            "    (void)iw, (void)mem;",
            f"    return sym_casadi_call(model, {own}_groups, {n_in}, {own}_outputs, {n_out}, arg, res, w);",
            "}",
            "",
        ]
        return "\n".join(lines)

    def _plan(self, index: int) -> str:
        """Initialiser of a sym_casadi_output."""
        output = self.outputs[index]
        frame = f'"{output.frame}"' if output.frame else "NULL"
        return f'{{"{output.function}", {frame}, {output.array}, {len(output.cells)}, {self.name}_gather_{index}}}'


def _table(declared: str, entries: Sequence[str]) -> list[str]:
    """A C function of an index."""
    cases = " ".join(f"case {i}: return {entry};" for i, entry in enumerate(entries))
    return [f"SYM_EXPORT {declared}(casadi_int i) {{", f"    switch (i) {{ {cases} default: return NULL; }}", "}"]


def _numbers(values: Sequence[int]) -> str:
    return ", ".join(map(str, values)) or "0"
