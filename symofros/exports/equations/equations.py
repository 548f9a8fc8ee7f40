"""sf.equations: M v' + h = Q + G^T lam as people write it, with the user's names."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from symofros.base.arguments import checked
from symofros.base.names import TIME, identifier
from symofros.base.options import Options
from symofros.compiler import GENERATOR, Compilation
from symofros.description import Parameter, System, Value, as_vector
from symofros.errors import ExportError
from symofros.exports.equations import formulas
from symofros.exports.equations.harmonics import TooManyTermsError
from symofros.exports.equations.reading import Reader
from symofros.exports.equations.recursion import recursion_text
from symofros.expr import Expression, Slot
from symofros.generator import count_operations
from symofros.mechanics.topology import SpanningTree, build_tree

# Operations of M, h, Q and G in the recursive form: beyond these, no grouping makes the entries readable.
LIMIT = 300
# Products of terms that one product of two sums may take: what is beyond has thousands of terms.
_PRODUCTS = 4000
_G = "g"
_TAKEN = {"M", "h", "Q", "G", "q", "v", "u", "par", "t", "np"}
_REMEDY = "read `recursion()`, the equations body by body, or evaluate the model: sf.compile(system)"


@dataclass(frozen=True)
class ReadableEquations:
    """The equations of motion M v' + h = Q + G^T lam of a system, as SymPy, LaTeX and NumPy source.

    M, h, Q and G are those of the compiled model, to rounding; sines and cosines of sums of coordinates are combined.
    Coordinates, speeds and run-time parameters bear the user's names, constant ones are numbers.

    Attributes:
        system: System as the user stated it.
    """

    system: System

    def __repr__(self) -> str:
        """System and size; the equations are in the attributes."""
        return f"<ReadableEquations of '{self.system.name}': {self.operations} operations>"

    @cached_property
    def gravity(self) -> float | None:
        """Value of the symbol g [m/s^2], where gravity is a number along one axis and nothing else is called g."""
        return _gravity(self.system)

    @property
    def operations(self) -> int:
        """Operations that M, h, Q and G take in the recursive form; beyond 300, only `recursion` is written."""
        return self._operations[0]

    @property
    def is_small(self) -> bool:
        """Whether M, h, Q and G can be written out."""
        try:
            return bool(self._entries)
        except ExportError:
            return False

    @property
    def M(self) -> Any:
        """Mass matrix (nv, nv), an immutable matrix of SymPy.

        Raises:
            ExportError: The model is too large to be written out.
        """
        return self._entries["M"]

    @property
    def h(self) -> Any:
        """Coriolis, centrifugal and gravity terms (nv, 1); ExportError as for `M`."""
        return self._entries["h"]

    @property
    def Q(self) -> Any:
        """Generalized forces (nv, 1); ExportError as for `M`."""
        return self._entries["Q"]

    @property
    def G(self) -> Any:
        """Constraint Jacobian (nc, nv); ExportError as for `M`."""
        return self._entries["G"]

    @cached_property
    def symbols(self) -> dict[str, tuple[Any, ...]]:
        """Symbols of q, v, u, par and t, in the order of the model's arrays; of "gravity" g, where it is a symbol."""
        coordinates = self._tree.coordinates
        names = {slot: name for name, slot in coordinates.symbols.items()}
        # A coordinate door has the name of the rate of one called oor, which is d`oor` then.
        names |= {slot: name for name, slot in coordinates.keys.items() if slot not in names}
        names |= {Slot("u", i): f"tau_{name}" for i, name in enumerate(coordinates.u) if Slot("u", i) not in names}
        sizes = {"q": len(coordinates.q), "v": len(coordinates.v), "u": len(coordinates.u)}
        sizes |= {"par": len(coordinates.par), "t": 1}
        symbols = {
            group: tuple(formulas.symbol(names[Slot(group, i)]) for i in range(size)) for group, size in sizes.items()
        }
        if self.gravity is not None:
            *par, g = symbols["par"]
            symbols |= {"par": tuple(par), "gravity": (g,)}
        return symbols

    def text(self) -> str:
        """The entries that are not zero, one line each; of M, the upper triangle.

        Raises:
            ExportError: The model is too large to be written out.
        """
        lines = [f"{label}[{','.join(map(str, index))}] = {formulas.text(x)}" for label, index, x in self._nonzero()]
        return "\n".join(lines) + "\n"

    def latex(self) -> str:
        """The same as LaTeX: an `aligned` environment.

        Raises:
            ExportError: The model is too large to be written out.
        """
        lines = [
            f"{label}_{{{','.join(map(str, index))}}} &= {formulas.latex(x, self._latex_names)}"
            for label, index, x in self._nonzero()
        ]
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}\n"

    def _nonzero(self) -> Iterator[tuple[str, tuple[int, ...], Any]]:
        """Label, indices from one on and expression of each entry."""
        for label, matrix in self._entries.items():
            for i in range(matrix.rows):
                for j in range(i if label == "M" else 0, matrix.cols):
                    if matrix[i, j] != 0:
                        yield label, (i + 1,) if label in "hQ" else (i + 1, j + 1), matrix[i, j]

    def numpy_source(self) -> str:
        """Source of a Python function of q (nq), v (nv), u (nu), par (npar), t [s] that returns M, h, Q, G.

        Raises:
            ExportError: The model is too large to be written out.
        """
        names = self._python_names
        par = self._tree.coordinates.par_default[: len(self.symbols["par"])]
        defaults = ", ".join(map(repr, par)) + "," * (len(par) == 1)
        lines = [
            f"def {identifier(self.system.name)}(q, v, u, par=({defaults}), t=0.0):",
            f'    """M, h, Q, G of M v\' + h = Q + G^T lam; written by {GENERATOR}."""',
        ]
        for group, symbols in self.symbols.items():
            if group == "gravity":
                lines.append(f"    {names[symbols[0]]} = {self.gravity!r}")
            elif symbols and group != "t":
                unpacked = ", ".join(names[symbol] for symbol in symbols)
                lines.append(f"    {unpacked}{',' if len(symbols) == 1 else ''} = {group}")
        for label, matrix in self._entries.items():
            rows = [[formulas.numpy_text(matrix[i, j], names) for j in range(matrix.cols)] for i in range(matrix.rows)]
            lines += _array(label, rows, label in "hQ", matrix.cols)
        lines.append("    return M, h, Q, G")
        return "import numpy as np\n\n\n" + "\n".join(lines) + "\n"

    def recursion(self) -> str:
        """LaTeX of the recursive form for models of any size: definitions of joints and bodies, then the formulas."""
        symbols = {symbol.name: symbol for group in self.symbols.values() for symbol in group}
        constants = {name: formulas.symbol(name) for name in self._tree.coordinates.constants}
        return recursion_text(self._tree, symbols | constants, self._latex_names)

    @cached_property
    def _tree(self) -> SpanningTree:
        return self._compilation.tree

    @cached_property
    def _compilation(self) -> Compilation:
        functions = ["mass_matrix", "bias", "generalized_force"]
        functions += ["constraint_jacobian"] if self.system.constraints else []
        system = self.system
        if self.gravity is not None:
            symbol = Expression("symbol", name=_G)
            vector = as_vector([_directed(value, symbol) for value in system.gravity], "gravity")
            par = (*system.parameters, Parameter(_G, self.gravity, "m/s^2"))
            system = replace(system, gravity=vector, parameters=par)
        return Compilation(system, Options(tuple(functions)))

    @cached_property
    def _operations(self) -> tuple[int, dict[str, tuple[int, ...]]]:
        program = self._compilation.program
        outputs = {output.name: output.edges for function in program.functions for output in function.outputs}
        edges = [edge for each in outputs.values() for edge in each]
        return count_operations(program.graph, edges).total, outputs

    @cached_property
    def _entries(self) -> dict[str, Any]:
        total, outputs = self._operations
        what = f"the equations of '{self.system.name}' are not written out"
        if total > LIMIT:
            rule = f"at most {LIMIT} operations: larger ones fill pages that nobody reads"
            raise ExportError(what, f"{total} operations", rule, _REMEDY)
        reader = Reader(self._compilation.program.graph, _PRODUCTS)
        try:
            sums = {name: reader.sums(edges) for name, edges in outputs.items()}
        except TooManyTermsError:
            rule = f"products of two sums take at most {_PRODUCTS} products of terms"
            raise ExportError(what, f"{total} operations, whose sums expand further", rule, _REMEDY) from None
        grouped = self.symbols | {"par": self.symbols["par"] + self.symbols.get("gravity", ())}
        slots = {Slot(group, i): symbol for group, each in grouped.items() for i, symbol in enumerate(each)}
        writer = formulas.Writer(reader.atoms, slots)
        nv = len(self._tree.coordinates.v)
        columns = {"M": nv, "h": 1, "Q": 1, "G": nv}
        entries = {}
        for name, n in columns.items():
            flat = [writer.expression(each) for each in sums.get(name, [])]
            entries[name] = formulas.matrix([flat[i : i + n] for i in range(0, len(flat), n)], n)
        return entries

    @cached_property
    def _latex_names(self) -> dict[Any, str]:
        names = {symbol: formulas.latex_of_name(symbol.name) for group in self.symbols.values() for symbol in group}
        coordinates = self._tree.coordinates
        symbols = dict(zip(coordinates.q, self.symbols["q"], strict=True))
        for name, symbol in zip(coordinates.v, self.symbols["v"], strict=True):
            if name in symbols:
                base, sign, index = names[symbols[name]].partition("_")
                plain = "{" not in base  # Otherwise the name is a text, which an underscore does not part.
                names[symbol] = f"\\dot{{{base}}}{sign}{index}" if plain else f"\\dot{{{names[symbols[name]]}}}"
        for symbol in self.symbols["u"]:
            if symbol.name.startswith("tau_"):
                names[symbol] = f"\\tau_{{{formulas.latex_of_name(symbol.name.removeprefix('tau_'))}}}"
        return names

    @cached_property
    def _python_names(self) -> dict[Any, str]:
        names: dict[Any, str] = {}
        for group in self.symbols.values():
            for symbol in group:
                plain = re.sub(r"\W", "_", symbol.name, flags=re.ASCII)
                plain = plain if plain[:1].isalpha() or plain[:1] == "_" else f"_{plain}"
                name = f"{plain}_" if keyword.iskeyword(plain) else plain
                if symbol.name != TIME:
                    while name in _TAKEN or name in names.values():
                        name += "_"
                names[symbol] = name
        return names


def _number(value: Value) -> float | None:
    return None if isinstance(value, Expression) else value


def _gravity(system: System) -> float | None:
    """Size of gravity where it is a number along one axis, and its symbol is free."""
    numbers = [_number(value) for value in system.gravity]
    along = [abs(value) for value in numbers if value]
    coordinates = build_tree(system).coordinates
    taken = {*coordinates.symbols, *coordinates.constants, *coordinates.u}
    return along[0] if None not in numbers and len(along) == 1 and _G not in taken else None


def _directed(component: Value, size: Expression) -> Value:
    """A component of gravity by its size."""
    number = _number(component) or 0.0
    return 0.0 if not number else size if number > 0 else Expression("neg", (size,))


def _array(label: str, rows: Sequence[Sequence[str]], flat: bool, columns: int) -> list[str]:
    """Lines that form one array."""
    if not rows:
        return [f"    {label} = np.zeros((0, {columns}))"]
    if flat:
        return [f"    {label} = np.array([", *(f"        {row[0]}," for row in rows), "    ], dtype=float)"]
    return [f"    {label} = np.array([", *(f"        [{', '.join(row)}]," for row in rows), "    ], dtype=float)"]


@checked
def equations(system: System) -> ReadableEquations:
    """The equations of motion for people: SymPy, LaTeX and NumPy source, with the user's names.

    Args:
        system: System as the user stated it.

    Raises:
        DescriptionError: The system can't be a mechanism.
    """
    readable = ReadableEquations(system)
    assert readable.symbols["t"]  # Faults of the description are raised here, not at the first use.
    return readable
