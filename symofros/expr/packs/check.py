"""The verifier of packs: what their contract asks, from the graph's operations and dependences alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.packs.combine import is_sum
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.program import Program


def check_packs(program: Program) -> None:
    """Verify the packs of a program's graph; the contract is at the top of the folder.

    Raises:
        AssertionError: A pack is not valid; says which, and why.
    """
    graph = program.graph
    homes: dict[int, tuple[int, int]] = {}
    for index, pack in enumerate(graph.packs):
        problem = next(chain(_shape_problems(pack), _lane_problems(graph, pack)), None)
        if problem is not None:
            raise AssertionError(f"pack {index}: {problem}")
        for lane in sorted(pack.new_lanes):
            node = abs(pack.lanes[lane])
            if node in homes:
                other, other_lane = homes[node]
                raise AssertionError(
                    f"pack {index}: lane {lane} holds node {node}, which lane {other_lane} of pack {other} holds, too"
                )
            homes[node] = index, lane
    cycle = _cycle(graph, homes)
    if cycle:
        raise AssertionError(_cycle_text(graph, cycle))


def _shape_problems(pack: Pack) -> Iterator[str]:
    if any(len(one.lanes) != WIDTH for one in (pack, *(operand for _, operand in pack.terms))):
        yield f"a pack and its operands have {WIDTH} lanes each"
    if not pack.terms:
        yield "it is no linear combination"
    if not pack.new_lanes <= pack.exact_lanes <= set(range(WIDTH)):
        yield f"new lanes {sorted(pack.new_lanes)} are not among its exact lanes {sorted(pack.exact_lanes)}"


def _lane_problems(graph: Graph, pack: Pack) -> Iterator[str]:
    for lane in sorted(pack.new_lanes):
        node = abs(pack.lanes[lane])
        if not 0 < node < len(graph) or not graph.args[node]:
            yield f"lane {lane} is dead: its edge {pack.lanes[lane]} is no computed node"
    for lane in sorted(pack.exact_lanes):
        if not is_sum(graph, pack.lanes[lane], pack.operands(lane)):
            yield f"lane {lane} is computed by other operations than the terms of the pack state"


# A node, or -1 - index of a pack.
_Vertex = int


def _cycle(graph: Graph, homes: dict[int, tuple[int, int]]) -> list[_Vertex]:
    """A cycle of dependences with the new lanes of each pack contracted to one vertex; empty if there is none.

    Args:
        graph: The graph.
        homes: (pack, lane) of each new lane, keyed by node.
    """
    read = _reader(graph, homes)
    done: set[_Vertex] = set()
    for root in range(-1, -1 - len(graph.packs), -1):
        path, on_path, pending = [root], {root}, [read(root)]
        while path and root not in done:
            vertex = next((vertex for vertex in pending[-1] if vertex not in done), None)
            if vertex is None:
                pending.pop()
                on_path.discard(path[-1])
                done.add(path.pop())
            elif vertex in on_path:
                return path[path.index(vertex) :]
            else:
                path.append(vertex)
                on_path.add(vertex)
                pending.append(read(vertex))
    return []


def _reader(graph: Graph, homes: dict[int, tuple[int, int]]) -> Callable[[_Vertex], Iterator[_Vertex]]:
    """A function that gives the vertices on which a vertex depends."""
    vertices = {node: -1 - index for node, (index, _) in homes.items()}

    def read(vertex: _Vertex) -> Iterator[_Vertex]:
        edges: Sequence[Edge] = graph.args[vertex] if vertex >= 0 else _read_edges(graph.packs[-1 - vertex])
        return iter([vertices.get(abs(edge), abs(edge)) for edge in edges])

    return read


def _read_edges(pack: Pack) -> list[Edge]:
    """Edges that must be known before a vector is formed: factors, and operands of exact lanes."""
    operands = [operand.lanes[lane] for _, operand in pack.terms for lane in sorted(pack.exact_lanes)]
    return [factor for factor, _ in pack.terms] + operands


def _cycle_text(graph: Graph, cycle: Sequence[_Vertex]) -> str:
    """Message about a dependence cycle, in terms of packs and their lanes."""
    indices = sorted(-1 - vertex for vertex in cycle if vertex < 0)
    if len(indices) > 1:
        return f"packs {', '.join(map(str, indices))} wait for each other"
    pack = graph.packs[indices[0]]
    for lane in sorted(pack.exact_lanes):
        needed = set(needed_nodes(graph, [edge for product in pack.operands(lane) for edge in product]))
        for other in sorted(pack.new_lanes):
            if abs(pack.lanes[other]) in needed:
                return f"pack {indices[0]}: lane {lane} depends on lane {other}"
    raise AssertionError("the cycle has no lane that depends on another")
