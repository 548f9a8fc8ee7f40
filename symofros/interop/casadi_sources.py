"""Arrays of functions for CasADi: derivatives by coordinates, and which entries may differ from zero."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from symofros.expr import ZERO, Function
from symofros.runtime.record import Segment

Pattern = npt.NDArray[np.bool_]
Kind = Literal["plain", "rows", "gradient", "hessian", "hessians"]


@dataclass(frozen=True, eq=False)
class Source:
    """An array (row by row) that outputs of external functions take entries of.

    Attributes:
        function: Name of the model's function.
        frame: Its frame, or "".
        array: Index of the array among what it returns.
        kind: What becomes of it: enum in native/interop/symofros_casadi.c.
        nonzero: Which entries of the array may differ from zero (rows, columns).
        gradient: Of second derivatives by quaternions: the function whose first array is the gradient by q.
        weights: Of many Hessians: the input of the weights.
        n_weights: Their number, one matrix each.
    """

    function: str
    frame: str
    array: int
    kind: Kind
    nonzero: Pattern
    gradient: str = ""
    weights: str = ""
    n_weights: int = 0

    @property
    def text(self) -> str:
        """Initialiser of a sym_casadi_source."""
        names = [f'"{name}"' if name else "NULL" for name in (self.function, self.frame, self.gradient, self.weights)]
        kind = f"SYM_CASADI_{self.kind.upper()}"
        return f"{{{names[0]}, {names[1]}, {self.array}, {kind}, {names[2]}, {names[3]}, {self.n_weights}}}"


class Sources:
    """The arrays of a model.

    Args:
        functions: Functions by name and frame.
        segments: The configuration manifold.
    """

    def __init__(self, functions: Mapping[tuple[str, str], Function], segments: Sequence[Segment]) -> None:
        self._functions, self._segments = functions, tuple(segments)
        self._curved = [segment for segment in self._segments if segment.kind != "linear"]
        self._by_q = self._coordinates_of_speeds()
        self._known: dict[tuple[str, ...], Source] = {}

    @property
    def segments_text(self) -> str:
        """The manifold as C: SYM_CASADI_SEGMENTS entries of sym_casadi_segments."""
        rows = [f"{{{s.q}, {s.v}, {s.translations}, {int(s.kind != 'linear')}}}" for s in self._segments]
        table = ", ".join(rows) or "{0, 0, 0, 0}"
        return (
            f"#define SYM_CASADI_SEGMENTS {len(rows)}\n"
            f"static const sym_casadi_segment sym_casadi_segments[] = {{{table}}};"
        )

    def value(self, function: str, frame: str, array: str) -> Source:
        """An array as the function gives it."""
        return self._of(function, frame, array, "plain")

    def slopes(self, function: str, frame: str, array: str, by: str) -> Source:
        """Derivatives (rows, size) by an input, by q those by its coordinates."""
        return self._of(function, frame, array, "rows" if by == "q" and self._curved else "plain")

    def gradient(self, function: str, frame: str, by: str) -> Source:
        """The gradient by an input, a column; by q that by its coordinates."""
        return self._of(function, frame, f"by_{by}", "gradient" if by == "q" and self._curved else "plain")

    def hessian(self, function: str, frame: str, gradient: str) -> Source:
        """Second derivatives by all inputs, q first and by its coordinates."""
        if not self._curved:
            return self._of(function, frame, "H", "plain")
        return self._of(function, frame, "H", "hessian", gradient)

    def hessians(self, function: str, frame: str, gradient: str, weights: str, count: int) -> Source:
        """Hessian for each unit vector of weights, one below the other."""
        return self._of(function, frame, "H", "hessians", gradient if self._curved else "", weights, count)

    def _of(
        self, name: str, frame: str, array: str, kind: Kind, gradient: str = "", weights: str = "", n: int = 0
    ) -> Source:
        key = name, frame, array, kind
        if key not in self._known:
            function = self._functions[name, frame]
            index = [each for each, _ in function.returns].index(array)
            shape = function.returns[index][1]
            given = np.array(_nonzero(function, index)).reshape(shape[0], shape[1] if len(shape) > 1 else 1)
            nonzero = self._by_coordinates(given, kind)
            nonzero = np.tile(nonzero, (n, 1)) if kind == "hessians" else nonzero
            self._known[key] = Source(name, frame, index, kind, nonzero, gradient, weights, n)
        return self._known[key]

    def _by_coordinates(self, nonzero: Pattern, kind: Kind) -> Pattern:
        """Pattern of derivatives by coordinates, of one by speeds."""
        if kind == "rows":
            return nonzero @ self._by_q
        if kind == "gradient":
            return self._by_q.T @ nonzero
        if kind == "plain" or not self._curved:
            return nonzero
        (nv, nq), n = self._by_q.shape, len(nonzero)
        wide = np.zeros((n, n - nv + nq), dtype=bool)
        wide[:nv, :nq], wide[nv:, nq:] = self._by_q, np.eye(n - nv, dtype=bool)
        pattern = wide.T @ nonzero @ wide
        for segment in self._curved:  # Of second derivatives by a quaternion the gradient is a part: linear.md, (27).
            own = slice(segment.q + segment.translations, segment.q + segment.size)
            pattern[own, own] = True
        return np.asarray(pattern | pattern.T, dtype=np.bool_)

    def _coordinates_of_speeds(self) -> Pattern:
        """Coordinates (nq) that receive a derivative by the motion of each speed (nv)."""
        last = self._segments[-1] if self._segments else None
        pattern = np.zeros((last.v + last.speeds, last.q + last.size) if last else (0, 0), dtype=bool)
        for segment in self._segments:
            middle_v, middle_q = segment.v + segment.translations, segment.q + segment.translations
            places = np.ones((3, 3)) if segment.kind == "pose" else np.eye(segment.translations)
            pattern[segment.v : middle_v, segment.q : middle_q] = places
            pattern[middle_v : segment.v + segment.speeds, middle_q : segment.q + segment.size] = True
        return pattern


def _nonzero(function: Function, index: int) -> list[bool]:
    """Whether each entry of an array may differ from zero; for outputs of solvers, from those of their operands."""
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
