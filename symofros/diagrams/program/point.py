"""Signals of a diagram at one instant, written into a graph."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from itertools import islice

from symofros.diagrams.block import Values
from symofros.diagrams.program.layout import Layout, Part, Place
from symofros.diagrams.program.lowered_block import INPUT, MEMORY, PARAMETER, STATE, Piece
from symofros.diagrams.program.model_environment import parameter_group
from symofros.diagrams.tensor import Tensor
from symofros.diagrams.wiring import Source, Wired
from symofros.errors import DescriptionError
from symofros.expr import Edge, Graph, Slot, copy_into, needed_nodes

AT = ("q", "v", "u", "t")
# What is known once the accelerations of an instant are.
AFTER = (*AT, "a", "lam")


def read_slots(graph: Graph, edges: Sequence[Edge], given: Collection[int] = ()) -> set[Slot]:
    """The inputs that the computation of edges reads.

    Args:
        graph: The graph.
        edges: Edges that are computed.
        given: Nodes whose values are available.
    """
    nodes = needed_nodes(graph, edges, given)
    read = {*map(abs, edges), *(abs(arg) for node in nodes for arg in graph.args[node])}
    return {slot for node, slot in graph.slot.items() if node in read}


def reads(graph: Graph, edges: Sequence[Edge], groups: Collection[str], given: Collection[int] = ()) -> bool:
    """Whether the computation of edges reads inputs of some groups; `given` as of `read_slots`."""
    return any(slot.group in groups for slot in read_slots(graph, edges, given))


class Point:
    """Signals at one instant, written into a graph.

    Args:
        wired: The diagram.
        pieces: Blocks, lowered to expressions.
        layout: Layout of states and signals in memory.
        order: All outputs, each after what it depends on.
        g: Graph that receives the operations.
        due: Sampled blocks whose new outputs count; those of the others are held.
        part: Part whose vectors q, v and lam are read; None: those of the whole diagram.
        after: Whether accelerations and multipliers of constrained mechanisms are known.
    """

    def __init__(
        self,
        wired: Wired,
        pieces: Mapping[str, Piece],
        layout: Layout,
        order: Sequence[Source],
        g: Graph,
        due: frozenset[str] = frozenset(),
        part: Part | None = None,
        after: bool = False,
    ) -> None:
        self.g = g
        self._wired, self._pieces, self._layout = wired, pieces, layout
        self._rank = {source: i for i, source in enumerate(order)}
        self._due, self._after, self._part = due, after, part
        read = part or layout.whole
        self._q, self._v, self._lam, self._nc = read.q.start, read.v.start, read.conditions.start, read.nc
        self._models = {parameter_group(model): model for model in wired.models.names}
        self._values: dict[Source, Tensor] = {}

    def input(self, group: str, place: Place, shift: int = 0) -> Tensor:
        """Entries of an input vector."""
        return Tensor.inputs(self.g, group, place.shape, place.start - shift)

    def signal(self, source: Source) -> Tensor:
        """The value of an output."""
        wanted, stack = set[Source](), [source]
        while stack:
            one = stack.pop()
            if one in self._values or one in wanted:
                continue
            wanted.add(one)
            if self._place(one) is None:
                stack += self._behind(one)
        for one in sorted(wanted, key=self._rank.__getitem__):
            place = self._place(one)
            piece = self._pieces[one[0]]
            self._values[one] = self.write(piece, piece.outputs[one[1]]) if place is None else self.input("u", place)
        return self._values[source]

    def _place(self, source: Source) -> Place | None:
        """Place of a stored output in u; None for one that is computed."""
        layout, piece = self._layout, self._pieces[source[0]]
        if source in layout.samples:
            return layout.samples[source]
        return layout.held.get(source) if piece.is_external or source[0] not in self._due else None

    def _behind(self, source: Source) -> list[Source]:
        name, port = source
        return self._wired.behind(name, self._pieces[name].needs[port])

    def write(self, piece: Piece, value: Tensor) -> Tensor:
        """A value of a block's own graph, at this point."""
        return Tensor.of(self.g, self.edges(piece, value.flat), value.shape)

    def write_all(self, piece: Piece, values: Values) -> dict[str, Tensor]:
        """Several values at once, by name."""
        edges = iter(self.edges(piece, [edge for value in values.values() for edge in value.flat]))
        return {key: Tensor.of(self.g, islice(edges, value.size), value.shape) for key, value in values.items()}

    def edges(self, piece: Piece, edges: Sequence[Edge]) -> list[Edge]:
        """The same for edges."""
        groups = piece.groups(edges)
        for group in groups:
            if group.startswith(INPUT):
                self.signal(self._wired.sources[piece.name, group.removeprefix(INPUT)])
        known = {group: self._group(piece, group) for group in groups}
        replacement = {
            node: known[slot.group][slot.index] for node, slot in piece.g.slot.items() if slot.group in known
        }
        return copy_into(self.g, piece.g, edges, replacement)

    def _group(self, piece: Piece, group: str) -> list[Edge]:
        """Edges that replace an input group of a block's own graph."""
        name, layout = piece.name, self._layout
        if group == "t":
            return [self.g.input("t", 0)]
        if group in ("q", "v", "a", "lam"):
            return self._of_motion(name, group)
        if group == "gains":
            first = layout.lam[name].start - self._lam
            rows = [first + i for i in range(piece.nc)]
            return [self.g.input("gains", i) for i in (*rows, *(self._nc + i for i in rows))]
        if group.startswith(INPUT):
            return self._values[self._wired.sources[name, group.removeprefix(INPUT)]].flat
        if group.startswith(STATE):
            return self.input("v", layout.states[name, group.removeprefix(STATE)], self._v).flat
        if group.startswith(MEMORY):
            return self.input("u", layout.memory[name, group.removeprefix(MEMORY)]).flat
        if group.startswith(PARAMETER):
            return self.input("par", layout.parameters[name, group.removeprefix(PARAMETER)]).flat
        return self._of_model(name, group)

    def _of_motion(self, name: str, group: str) -> list[Edge]:
        """Edges of a mechanism's motion; accelerations and multipliers are there once they are solved for."""
        layout = self._layout
        if group in ("a", "lam") and not self._after:
            raise DescriptionError(
                f"block '{name}': accelerations or constraint forces are needed between samples",
                f"'{group}'",
                "under constraints they are known once the equations of the instant are solved",
                "take them through a sampled block (a hold with a period)",
            )
        places = {"q": (layout.q, self._q), "v": (layout.v, self._v), "a": (layout.v, self._v)}
        of, first = places.get(group, (layout.lam, self._lam))
        return self.input(group, of[name], first).flat

    def _of_model(self, name: str, group: str) -> list[Edge]:
        """Edges of a model's parameters, as the block has them."""
        layout = self._layout
        own = self.input("par", layout.parameters["", self._models[group]]).flat
        kept = layout.kept.get(name)
        if (
            kept is not None and self._models[group] == self._pieces[name].block.mechanism()
        ):  # A part has those of its own, which actions change; between parts they are memory.
            now = self.input("u", kept.memory) if self._part is None else self.input("par", kept.par)
            for i, edge in zip(kept.numbers, now.flat, strict=True):
                own[i] = edge
        return own
