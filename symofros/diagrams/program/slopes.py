"""Derivatives of a diagram's functions on the graph by states, inlets and time (docs/theory/diagrams.md, 12)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved, fuser
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.lowered_block import Piece, watched
from symofros.diagrams.program.point import Point, read_slots
from symofros.diagrams.wiring import Source
from symofros.expr import Edge, Function, InstantKind, Output, Program, instant_operands, partials
from symofros.generator import InterpretedUnit, run_passes

# What the functions read; "gains" of conditions are zero: what is held exactly needs none.
_AT = ("q", "v", "u", "t", "a", "lam", "gains")


@dataclass(frozen=True)
class Slopes:
    """Rows of values with their derivatives, by NumPy.

    Attributes:
        program: Functions "values" and "slopes".
        names: Names of the values, in order.
        entries: Entries of u that they depend on.
    """

    program: Program
    names: tuple[str, ...]
    entries: frozenset[int]

    @classmethod
    def of(
        cls, program: Program, rows: Mapping[str, Sequence[Edge]], inlets: Sequence[int], others: Sequence[Output] = ()
    ) -> Slopes:
        """Derivatives of rows of edges by q, v, the inlets, t, a and lam.

        Args:
            program: Program of the edges, whose graph receives the derivatives.
            rows: Name -> edges.
            inlets: Entries of u that vary.
            others: Values that are evaluated beside them.
        """
        g = program.graph
        edges = [edge for row in rows.values() for edge in row]
        entries = frozenset(slot.index for slot in read_slots(g, edges) if slot.group == "u")
        columns = {group: [g.input(group, i) for i in range(program.sizes[group])] for group in _AT[:-1]}
        columns["u"] = [columns["u"][i] for i in inlets]
        J = partials(g, edges, [x for group in columns.values() for x in group])
        outputs, first = [Output("values", (len(edges),), tuple(edges)), *others], 0
        for group, xs in columns.items():
            block = tuple(edge for row in J for edge in row[first : first + len(xs)])
            outputs.append(Output(f"by_{group}", (len(edges), len(xs)), block))
            first += len(xs)
        names = tuple(name for name, row in rows.items() for _ in row)
        functions = (Function("slopes", "", _AT, tuple(outputs)),)
        return cls(run_passes(replace(program, functions=functions)), names, entries)

    def at(self, point: Mapping[str, Array], par: Array) -> dict[str, Array]:
        """Values and derivatives, by their names, at a point; groups that it leaves out are zero."""
        kernel = InterpretedUnit(self.program).kernels["slopes", ""]
        sizes = self.program.sizes
        inputs = [np.reshape(point.get(group, np.zeros(sizes[group])), (1, -1)) for group in _AT]
        found = kernel.run(1, kernel.prepare(par.reshape(1, -1)), inputs)
        return {output.name: x[0] for output, x in zip(self.program.functions[0].outputs, found, strict=True)}


def slopes_of_part(resolved: Resolved, part: Part, inlets: Sequence[int]) -> Slopes:
    """Of the accelerations of a part; under constraints of the residuals "motion", "conditions" and "rates" (15)."""
    program = fuser(resolved).motion(part, whole=False)
    functions = {function.name: {one.name: one for one in function.outputs} for function in program.functions}
    forward, g = functions["forward_dynamics"], program.graph
    if not part.nc:
        return Slopes.of(program, {"a": forward["a"].edges}, inlets)
    nv, nc = part.nv, part.nc
    a, lam = ([g.input(group, i) for i in range(size)] for group, size in (("a", nv), ("lam", nc)))
    M, G = (_rows(forward[name]) for name in ("M", "G"))
    motion = [
        g.sub(
            g.sub(g.sum(map(g.mul, M[i], a)), forward["r"].edges[i]), g.sum(g.mul(G[k][i], lam[k]) for k in range(nc))
        )
        for i in range(nv)
    ]
    conditions = [g.sub(g.sum(map(g.mul, G[k], a)), forward["c"].edges[k]) for k in range(nc)]
    rows = {"motion": motion, "conditions": conditions, "rates": functions["project"]["rate"].edges}
    return Slopes.of(program, rows, inlets, [forward["M"], forward["G"], forward["binds"]])


def _rows(matrix: Output) -> list[tuple[Edge, ...]]:
    n = matrix.shape[1]
    return [matrix.edges[i * n : (i + 1) * n] for i in range(matrix.shape[0])]


def slopes_of_outputs(
    resolved: Resolved, sources: Mapping[str, Source], inlets: Sequence[int], due: frozenset[str] = frozenset()
) -> Slopes:
    """Of signals, by name; those of sampled blocks that are due are new ones, those of others are held."""
    at, program = _point(resolved, due)
    return Slopes.of(program, {name: at.signal(source).flat for name, source in sources.items()}, inlets)


def slopes_of_memory(resolved: Resolved, due: frozenset[str], varied: Sequence[int]) -> Slopes:
    """Of what sampled blocks remember after a sample, by block and name."""
    at, program = _point(resolved, due)
    rows = {
        f"{block}.{key}": at.write(piece, value).flat
        for block, piece in resolved.pieces.items()
        if block in due
        for key, value in piece.updates.items()
    }
    return Slopes.of(program, rows, varied)


def slopes_of_switches(resolved: Resolved, inlets: Sequence[int], due: frozenset[str] = frozenset()) -> Slopes:
    """Of operands of kinks and jumps, by block, and of crossings "block.crossing"; of sampled blocks, those due."""
    at, program = _point(resolved, due)
    counted = {name: piece for name, piece in resolved.pieces.items() if not piece.is_discrete or name in due}
    return Slopes.of(program, dict(_switches(resolved, counted, at)), inlets)


def _switches(resolved: Resolved, counted: Mapping[str, Piece], at: Point) -> Iterator[tuple[str, list[Edge]]]:
    """Kinks by the first block that has them: outputs in order, then what follows from them."""
    known = set[Edge]()
    outputs_of = {name: piece.outputs for name, piece in counted.items()}
    values = [(name, [outputs_of[name][port]]) for name, port in resolved.order if port in outputs_of.get(name, ())]
    for name, piece in counted.items():
        after = [*piece.rates.values(), *piece.terms.stated().values()]
        values.append((name, [*after, *(piece.updates.values() if piece.is_discrete else ())]))
    kinks: dict[str, list[Edge]] = {name: [] for name in counted}
    for name, of in values:
        edges = at.edges(counted[name], [edge for value in of for edge in value.flat])
        found = [one.edge for one in instant_operands(at.g, edges, of_states=True) if one.kind == InstantKind.KINK]
        kinks[name] += [edge for edge in found if edge not in known]
        known.update(found)
    yield from kinks.items()
    for block, which in watched(counted):
        yield f"{block}.{which}", at.edges(counted[block], counted[block].crossings[which].value.flat)


def _point(resolved: Resolved, due: frozenset[str]) -> tuple[Point, Program]:
    """A point of the whole diagram, and a program that is to have its functions."""
    program = fuser(resolved).signals([])
    at = Point(resolved.wired, resolved.pieces, resolved.layout, resolved.order, program.graph, due, after=True)
    return at, program
