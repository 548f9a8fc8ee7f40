"""Vertices of a graph of dependences that wait for themselves."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterator, Mapping
from typing import TypeVar

Vertex = TypeVar("Vertex", bound=Hashable)


def strongly_connected(needs: Mapping[Vertex, Collection[Vertex]]) -> Iterator[list[Vertex]]:
    """The groups of vertices of which each depends on each (Tarjan, 1972), of several or of one that needs itself.

    Args:
        needs: What each vertex depends on; those that depend on nothing may be missing.
    """
    order: dict[Vertex, int] = {}
    lowest: dict[Vertex, int] = {}
    open_ones: list[Vertex] = []
    done: set[Vertex] = set()
    for root in needs:
        path = [(root, iter(needs[root]))] if root not in order else []
        while path:
            vertex, remaining = path[-1]
            if vertex not in order:
                order[vertex] = lowest[vertex] = len(order)
                open_ones.append(vertex)
            following = next((other for other in remaining if other in needs and other not in order), None)
            if following is not None:
                path.append((following, iter(needs[following])))
                continue
            path.pop()
            # Of what belongs to no group yet.
            reached = [lowest[other] for other in needs[vertex] if other in order and other not in done]
            lowest[vertex] = min([order[vertex], *reached])
            if lowest[vertex] == order[vertex]:
                group = [open_ones.pop()]
                while group[-1] != vertex:
                    group.append(open_ones.pop())
                done.update(group)
                if len(group) > 1 or vertex in needs[vertex]:
                    yield group
