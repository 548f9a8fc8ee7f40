"""One block, its formulas written out by itself: what its outputs, rates and memory are made of."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from symofros.base.arrays import Array
from symofros.diagrams.block import Block, Crossing, Environment, EvaluationContext, Port, Terms, Values
from symofros.diagrams.external_block import ExternalBlock
from symofros.diagrams.program.switching import Switching, switching_of
from symofros.diagrams.tensor import Tensor
from symofros.diagrams.wiring import Wired, surroundings
from symofros.errors import DescriptionError
from symofros.expr import Edge, Graph, needed_nodes

# Groups of inputs of a piece that belong to one port, state, memory or parameter begin with these.
INPUT, STATE, MEMORY, PARAMETER = "in_", "x_", "z_", "p_"


@dataclass(frozen=True)
class Piece:
    """A block's formulas.

    Attributes:
        block: The block.
        g: Their graph, in which every signal and state is an input.
        outputs: Output port -> value.
        rates: Continuous state -> rate.
        updates: Memory -> next value.
        terms: Terms of the equations of motion of its mechanism.
        crossings: Name -> what is watched.
        jumps: Name of a crossing -> what it changes.
        states: Continuous state -> first value.
        memory: Memory -> first value.
        parameters: Run-time parameter -> value.
        q: First configuration of its mechanism.
        v: First speeds.
        switching: Events of its mechanism; None where there are none.
        begins: Memory -> its value at the start, where signals say it.
        needs: Output port -> inputs that it depends on at once.
    """

    block: Block
    g: Graph
    outputs: dict[str, Tensor]
    rates: dict[str, Tensor]
    updates: dict[str, Tensor]
    terms: Terms
    crossings: dict[str, Crossing]
    jumps: dict[str, dict[str, Tensor]]
    states: dict[str, Array]
    memory: dict[str, Array]
    parameters: dict[str, Array]
    q: Array
    v: Array
    switching: Switching | None = None
    begins: dict[str, Tensor] = field(default_factory=dict)
    needs: dict[str, frozenset[str]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the block."""
        return self.block.name

    @property
    def is_external(self) -> bool:
        """Whether it is a function of Python's."""
        return isinstance(self.block, ExternalBlock)

    @property
    def is_discrete(self) -> bool:
        """Whether its outputs change at samples only."""
        return self.block.period is not None

    @property
    def nc(self) -> int:
        """Conditions on its mechanism."""
        return 0 if self.terms.G is None else self.terms.G.shape[0]

    def motion_edges(self) -> list[Edge]:
        """All that its mechanism's terms are."""
        return [edge for part in self.terms.stated().values() for edge in part.flat]

    def groups(self, edges: Iterable[Edge]) -> tuple[str, ...]:
        """Groups of inputs that some edges depend on, by the alphabet: their order reaches the text."""
        wanted = list(edges)
        nodes = {abs(arg) for node in needed_nodes(self.g, wanted) for arg in self.g.args[node]} | set(map(abs, wanted))
        return tuple(sorted({self.g.slot[node].group for node in nodes if node in self.g.slot}))

    def inputs_of(self, edges: Iterable[Edge]) -> frozenset[str]:
        """Input ports that some edges depend on."""
        return frozenset(group.removeprefix(INPUT) for group in self.groups(edges) if group.startswith(INPUT))


def watched(pieces: Mapping[str, Piece]) -> list[tuple[str, str]]:
    """(block, crossing) of all values whose zeros are located, in order."""
    return [(name, which) for name, piece in pieces.items() for which in piece.crossings]


def piece_of(wired: Wired, name: str) -> Piece:
    """Write out one block.

    Raises:
        DescriptionError: Its formulas don't fit its ports.
    """
    block, known = wired.blocks[name], surroundings(wired, name)
    parameters = block.parameters()
    _refuse_missing(name, block, parameters)
    g = Graph()
    states, memory = _arrays(block.states(known)), _arrays(block.memory(known))
    mechanism = block.mechanism()
    q0, v0 = wired.models.start(mechanism) if mechanism else (np.zeros(0), np.zeros(0))
    at = _context(g, wired, name, known, (states, memory, parameters))
    terms = block.motion(at)
    if terms.a is not None:  # Else they are known after the constraints' equations are solved.
        at = replace(at, a=terms.a)
    outputs = {} if isinstance(block, ExternalBlock) else dict(block.compute(at))
    crossings = dict(block.crossings(at))
    piece = Piece(
        block,
        g,
        outputs,
        dict(block.rates(at)),
        dict(block.update(at)),
        terms,
        crossings,
        {which: dict(block.crossed(at, which)) for which in crossings},
        states,
        memory,
        parameters,
        q0,
        v0,
        switching_of(wired.models, block, at),
        dict(block.memory_at_start(at)),
    )
    _fit(wired, piece)
    if isinstance(block, ExternalBlock):
        at_once = frozenset(p.name for p in wired.ports[name].inputs if block.feeds_through())
        needs = {port.name: at_once for port in wired.ports[name].outputs}
    else:
        needs = {port: piece.inputs_of(value.flat) for port, value in outputs.items()}
    return replace(piece, needs=needs | {port: frozenset() for port in block.samples()})


def _refuse_missing(name: str, block: Block, parameters: Mapping[str, Array]) -> None:
    """Refuse parameters that are no numbers.

    Raises:
        DescriptionError: One is none.
    """
    for key, value in parameters.items():
        if np.any(np.isnan(value)):  # Of None, too.
            raise DescriptionError(
                f"block '{name}': {key} is not a number",
                f"{getattr(block, key)}"[:80],
                "a parameter is one number or an array of them",
                "state it",
            )


def _context(
    g: Graph, wired: Wired, name: str, known: Environment, own: Sequence[Mapping[str, Array]]
) -> EvaluationContext:
    """Evaluation context of a block: the symbolic inputs of its formulas."""
    mechanism, (states, memory, parameters) = wired.blocks[name].mechanism(), own
    nq = nv = nc = 0
    if mechanism:
        record = wired.models.carried(mechanism)
        nq, nv, nc = len(record.q_names), len(record.v_names), record.nc
    return EvaluationContext(
        g,
        Tensor.inputs(g, "t", ()),
        {port.name: _given(g, wired, name, port) for port in wired.ports[name].inputs},
        {key: Tensor.inputs(g, STATE + key, value.shape) for key, value in states.items()},
        {key: Tensor.inputs(g, MEMORY + key, value.shape) for key, value in memory.items()},
        {key: Tensor.inputs(g, PARAMETER + key, value.shape) for key, value in parameters.items()},
        Tensor.inputs(g, "q", (nq,)),
        Tensor.inputs(g, "v", (nv,)),
        Tensor.inputs(g, "gains", (2 * nc,)),
        lambda model, function, frame="", **groups: wired.models.call(g, model, function, frame, **groups),
        wired.models.solved,
        Tensor.inputs(g, "a", (nv,)),
        Tensor.inputs(g, "lam", (nc,)),
        known,
    )


def _arrays(values: Mapping[str, object]) -> dict[str, Array]:
    return {key: np.asarray(value, dtype=np.float64) for key, value in values.items()}


def _given(g: Graph, wired: Wired, name: str, port: Port) -> Tensor:
    if (name, port.name) in wired.sources or port.default is None:  # Of a diagram that is not whole, not connected.
        return Tensor.inputs(g, INPUT + port.name, port.shape or ())
    return Tensor.numbers(g, np.broadcast_to(np.asarray(port.default, dtype=np.float64), port.shape or ()))


def _fit(wired: Wired, piece: Piece) -> None:
    """Refuse formulas whose shapes are not those declared, and a sample time that the kind of block excludes."""
    name, block = piece.name, piece.block
    shapes = {port.name: port.shape for port in wired.ports[name].outputs}
    given = set() if piece.is_external else shapes.keys() - block.samples().keys()
    _same(name, "outputs", piece.outputs, {key: shapes[key] for key in given})
    _same(name, "rates", piece.rates, {key: value.shape for key, value in piece.states.items()})
    kept = {key: value.shape for key, value in piece.memory.items()}
    _same(name, "memory", piece.updates, {key: kept.get(key, "not stated") for key in piece.updates})
    _same(name, "memory", piece.begins, {key: kept.get(key, "not stated") for key in piece.begins})
    places = {"q": piece.q.shape, "v": piece.v.shape} if block.mechanism() else {}
    changed = kept | {key: value.shape for key, value in piece.states.items()} | places
    for which, jump in piece.jumps.items():
        _same(name, f"crossing '{which}' changes", jump, {key: changed.get(key, "not stated") for key in jump})
    moving = bool(piece.states or block.mechanism() or piece.crossings)
    if piece.is_discrete and moving:
        raise DescriptionError(
            f"block '{name}' is sampled and moves between samples",
            f"period {block.period}",
            "continuous states belong to continuous blocks",
            "leave the period out",
        )
    watched = {*piece.begins, *(key for jump in piece.jumps.values() for key in jump)}
    if not piece.is_discrete and piece.memory.keys() - watched:
        raise DescriptionError(
            f"block '{name}' has memory and no sample time",
            ", ".join(piece.memory),
            "memory changes at samples or at crossings",
            "give a period",
        )
    if piece.is_external and not piece.is_discrete:
        raise DescriptionError(
            f"block '{name}' calls Python and has no sample time",
            "period None",
            "Python is called at samples",
            "give a period",
        )


def _same(name: str, what: str, values: Values, shapes: Mapping[str, object]) -> None:
    for key in sorted(values.keys() | shapes.keys()):
        shape = values[key].shape if key in values else "nothing"
        if key not in shapes or shape != shapes[key]:
            raise DescriptionError(
                f"block '{name}': {what} '{key}'", f"{shape}", f"{shapes.get(key, 'not stated')}", "mend the block"
            )
