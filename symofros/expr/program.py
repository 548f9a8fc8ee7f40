"""Program: the named functions of one model over one graph, with shaped inputs and outputs."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import prod

from symofros.base.routes import Choice
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph, Slot

# Inputs that a part of a mechanism reads, in an order that equal parts share.
Limb = tuple[Slot, ...]


@dataclass(frozen=True)
class Output:
    """A named array of edges, row by row."""

    name: str
    shape: tuple[int, ...]
    edges: tuple[Edge, ...]

    def __post_init__(self) -> None:
        """The count must fit the shape."""
        if len(self.edges) != prod(self.shape):
            raise ValueError(f"output '{self.name}': {len(self.edges)} edges for shape {self.shape}")


@dataclass(frozen=True)
class Solver:
    """A hand-written routine that computes a function's results from its outputs.

    Attributes:
        routine: Name of the routine: native/model/ROUTINE.c.in, and the same in Python in runtime/.
        returns: (name, shape) of each result.
        parts: Further functions that the routine calls.
        tables: Constant tables of integers that the routine takes: what rows and columns of matrices measure.
    """

    routine: str
    returns: tuple[tuple[str, tuple[int, ...]], ...]
    parts: tuple[Function, ...] = ()
    tables: tuple[tuple[int, ...], ...] = ()


@dataclass(frozen=True)
class Function:
    """One function of a model.

    Attributes:
        name: Name, such as "mass_matrix".
        frame: Frame of a function of frames, or "".
        inputs: Input groups, in order; "pre" is added where parameter-only work is hoisted.
        outputs: Outputs of the function.
        solver: Routine that takes the outputs and gives the results, if there is one: forward dynamics under
            constraints computes M, r, G, c and returns a, lam and the rank.
        summary: One line for people; "" for a part of another function.
        choices: Methods by which its outputs are formed, where there are several.
    """

    name: str
    frame: str
    inputs: tuple[str, ...]
    outputs: tuple[Output, ...]
    solver: Solver | None = None
    summary: str = ""
    choices: tuple[Choice, ...] = ()

    @property
    def returns(self) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """Name and shape of each array that a caller gets."""
        if self.solver is not None:
            return self.solver.returns
        return tuple((output.name, output.shape) for output in self.outputs)

    def edges(self) -> list[Edge]:
        """All output edges, those of the solver's parts last."""
        parts = self.solver.parts if self.solver is not None else ()
        own = [edge for output in self.outputs for edge in output.edges]
        return own + [edge for part in parts for edge in part.edges()]


@dataclass(frozen=True)
class Program:
    """All functions of one compilation unit.

    Attributes:
        name: Name of the model.
        graph: Graph of all functions.
        sizes: Length of each input group.
        functions: Functions that the program computes.
        init: Edges of the values that parameters alone determine, computed once per parameter set; after staging.
        pre: Entry of the group "pre" that holds such a value, keyed by node; after staging.
        limbs: Groups of equal limbs, whose equations are much the same.
    """

    name: str
    graph: Graph
    sizes: dict[str, int]
    functions: tuple[Function, ...]
    init: tuple[Edge, ...] = ()
    pre: dict[int, Slot] = field(default_factory=dict)
    limbs: tuple[tuple[Limb, ...], ...] = ()
