"""Derivatives of a diagram's functions on the graph by states, inlets and time (docs/theory/diagrams.md, 12)."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.program.compiled import Resolved, fuser
from symofros.diagrams.program.layout import Part
from symofros.diagrams.program.lowered_block import MEMORY, PARAMETER, Piece, watched
from symofros.diagrams.program.point import Point, read_slots
from symofros.diagrams.tensor import Tensor
from symofros.diagrams.wiring import Source
from symofros.expr import (
    ZERO,
    Edge,
    Function,
    InstantKind,
    Output,
    Program,
    Slot,
    instant_operands,
    needed_nodes,
    partials,
)
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


def slopes_of_outputs(resolved: Resolved, sources: Mapping[str, Source], inlets: Sequence[int]) -> Slopes:
    """Of signals, by name; those of sampled blocks are held."""
    at, program = _point(resolved)
    return Slopes.of(program, {name: at.signal(source).flat for name, source in sources.items()}, inlets)


def slopes_of_samples(
    resolved: Resolved, due: frozenset[str], memory: Collection[tuple[str, str]], varied: Sequence[int]
) -> Slopes:
    """Of what sampled blocks that are due give, then of what is kept in some of their memory, by block and name."""
    at, program = _point(resolved, due)
    rows = {
        f"{block}.{port} held": at.signal((block, port)).flat for block, port in resolved.layout.held if block in due
    }
    for block, key in memory:
        if block in due:
            rows[f"{block}.{key}"] = at.write(resolved.pieces[block], resolved.pieces[block].updates[key]).flat
    return Slopes.of(program, rows, varied)


def entries_of_samples(resolved: Resolved) -> dict[str, frozenset[int]]:
    """Sampled block -> entries of u that its new outputs and memory depend on, those of others held."""
    at, _ = _point(resolved)
    found = {}
    for block, piece in resolved.pieces.items():
        if piece.is_discrete:
            edges = [
                edge for values in (piece.outputs, piece.updates) for value in values.values() for edge in value.flat
            ]
            slots = read_slots(at.g, at.edges(piece, edges))
            found[block] = frozenset(slot.index for slot in slots if slot.group == "u")
    return found


def is_constant_between_steps(piece: Piece, value: Tensor) -> bool:
    """Whether a value of a block has no slope by what comes in or moves, but steps or none: a mode, or rounded."""
    moving = [piece.g.input(slot.group, slot.index) for slot in piece.g.slot.values() if _moves(slot)]
    if any(edge != ZERO for row in partials(piece.g, value.flat, moving) for edge in row):
        return False
    nodes = needed_nodes(piece.g, value.flat)
    return not nodes or any(piece.g.op[node] in ("floor", "step", "sign") for node in nodes)


def _moves(slot: Slot) -> bool:
    return slot.group != "t" and not slot.group.startswith((MEMORY, PARAMETER))


def rounded(
    resolved: Resolved, sources: Mapping[str, Source], counted: Collection[str], varied: Collection[int]
) -> Iterator[str]:
    """Blocks of which rates, outlets or counted samples read outputs that are rounded states or inlets."""
    at, _ = _point(resolved, frozenset(counted))
    values = [at.signal(source) for source in sources.values()]
    for name, piece in resolved.pieces.items():
        after = (
            piece.updates if name in counted else {} if piece.is_discrete else {**piece.rates, **piece.terms.stated()}
        )
        values += [at.write(piece, value) for value in after.values()]
    ends = [edge for value in values for edge in value.flat]
    read = {*map(abs, ends), *(abs(arg) for node in needed_nodes(at.g, ends) for arg in at.g.args[node])}
    for name, port in resolved.order:
        piece = resolved.pieces[name]
        if piece.is_external or port not in piece.outputs or (piece.is_discrete and name not in counted):
            continue
        within = [piece.g.op[node] for node in needed_nodes(piece.g, piece.outputs[port].flat)]
        if "floor" in within and is_constant_between_steps(piece, piece.outputs[port]):
            edges = at.signal((name, port)).flat
            slots = read_slots(at.g, edges)
            if not read.isdisjoint(map(abs, edges)) and any(
                slot.group in ("q", "v", "a", "lam") or (slot.group == "u" and slot.index in varied) for slot in slots
            ):
                yield name


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


def _point(resolved: Resolved, due: frozenset[str] = frozenset()) -> tuple[Point, Program]:
    """A point of the whole diagram, and a program that is to have its functions."""
    program = fuser(resolved).signals([])
    at = Point(resolved.wired, resolved.pieces, resolved.layout, resolved.order, program.graph, due, after=True)
    return at, program
