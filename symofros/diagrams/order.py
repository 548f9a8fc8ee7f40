"""In which order signals become known; loops in which a signal needs itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.diagrams.program.lowered_block import STATE, Piece
from symofros.diagrams.wiring import Source, Wired
from symofros.errors import DescriptionError, Problem


class AlgebraicLoopError(DescriptionError):
    """A signal that needs itself at the same instant.

    Attributes:
        path: Outputs along the loop, in the direction of the signals; the first is the last again.
    """

    def __init__(self, problem: Problem, path: Sequence[Source]) -> None:
        super().__init__(problem)
        self.path = tuple(path)


def order_of(wired: Wired, needs: Mapping[str, Mapping[str, frozenset[str]]]) -> list[Source]:
    """All outputs, each after those that it depends on without delay, as if every sampled block were due.

    Args:
        wired: Diagram whose signals are ordered.
        needs: Block -> output -> inputs that it depends on at once.

    Raises:
        AlgebraicLoopError: A signal needs itself.
    """
    before = {(name, port): wired.behind(name, inputs) for name, of in needs.items() for port, inputs in of.items()}
    done: list[Source] = []
    state: dict[Source, int] = {}  # 1: on the path, 2: done.
    for first in before:
        stack = [(first, iter(before[first]))] if first not in state else []
        if stack:
            state[first] = 1
        while stack:
            node, rest = stack[-1]
            nxt = next(rest, None)
            if nxt is None:
                state[node] = 2
                done.append(node)
                stack.pop()
            elif state.get(nxt) == 1:
                path = [item for item, _ in stack]
                raise _loop(wired, path[path.index(nxt) :])
            elif nxt not in state:
                state[nxt] = 1
                stack.append((nxt, iter(before[nxt])))
    return done


def _loop(wired: Wired, path: Sequence[Source]) -> AlgebraicLoopError:
    """The stack runs against the flow of signals."""
    forward = [*reversed(path), path[-1]]
    text = " -> ".join(".".join(source) for source in forward)
    return AlgebraicLoopError(
        Problem(
            f"diagram '{wired.name}': an algebraic loop",
            text,
            "a signal does not depend on itself at the same instant",
            "break the loop by a delay, an integrator or a filter, or sample one of its blocks before the other",
            wired.origin.get(("block", forward[0][0]), ""),
        ),
        forward,
    )


def groups_in_motion(wired: Wired, pieces: Mapping[str, Piece]) -> list[list[str]]:
    """Blocks that move between samples, grouped where their motions are coupled; all in one if events are located.

    What only meets at samples can move apart, each with steps of its own, on a thread of its own.
    """
    moving = [name for name, piece in pieces.items() if piece.states or piece.block.mechanism()]
    parent = {name: name for name in moving}

    def root(name: str) -> str:
        while parent[name] != name:
            name = parent[name]
        return name

    watched = [name for name, piece in pieces.items() if piece.crossings or piece.switching is not None]
    for name in moving:
        piece = pieces[name]
        edges = [*piece.motion_edges(), *(edge for value in piece.rates.values() for edge in value.flat)]
        for other in reached(wired, pieces, name, piece.inputs_of(edges)):
            parent[root(other)] = root(name)
        if watched and moving:  # A crossing stops all motion: it may change what any part depends on.
            parent[root(name)] = root(moving[0])
    groups: dict[str, list[str]] = {}
    for name in moving:
        groups.setdefault(root(name), []).append(name)
    return list(groups.values()) or [[] for _ in watched[:1]]  # Where nothing moves, crossings are looked for still.


def reached(wired: Wired, pieces: Mapping[str, Piece], name: str, inputs: frozenset[str]) -> set[str]:
    """Blocks whose continuous states are behind some inputs of a block, through continuous signals only."""
    reached_ports: set[str] = set()
    seen: set[Source] = set()
    stack = wired.behind(name, inputs)
    while stack:
        source = stack.pop()
        if source in seen:
            continue
        seen.add(source)
        block, port = source
        piece = pieces[block]
        if piece.is_discrete or port in piece.block.samples():
            continue
        groups = piece.groups(piece.outputs[port].flat)
        if any(group in ("q", "v") or group.startswith(STATE) for group in groups):
            reached_ports.add(block)
        stack += wired.behind(block, piece.needs[port])
    return reached_ports
