"""Single faults in a generated program, and their effect on its outputs.

A fault replaces one node of the expression graph. Only what depends on it is computed again, so that thousands of
faults take seconds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from symofros.tools import ADD, MUL, OPS, Edge, Function, Graph, Program, needed_nodes

from ..mechanics.geometry import Array

PERTURBATION = 1e-6


@dataclass(frozen=True)
class Fault:
    """One node replaced.

    Attributes:
        kind: Such as "sign flipped".
        node: Index of the node.
        op: Operation that it computes instead.
        args: Operands of that operation.
    """

    kind: str
    node: int
    op: str
    args: tuple[Edge, ...]


def faults_at(graph: Graph, node: int, sizes: Mapping[str, int], rng: np.random.Generator) -> Iterator[Fault]:
    """Every kind of fault that can be planted at a node.

    Args:
        graph: Extended by perturbed constants and other entries of inputs; its nodes keep their meaning.
        node: An operation.
        sizes: Length of each input group.
        rng: Chooses the wrong index.
    """
    op, args = graph.op[node], graph.args[node]
    for i, arg in enumerate(args):
        flipped = (*args[:i], -arg, *args[i + 1 :])
        yield Fault("sign flipped", node, op, flipped)
        number = graph.number(arg)
        if number is not None and number != 0.0:
            wrong = graph.constant(number * (1.0 + PERTURBATION))
            yield Fault("constant perturbed", node, op, (*args[:i], wrong, *args[i + 1 :]))
        slot = graph.slot.get(abs(arg))
        if slot is not None and sizes[slot.group] > 1:
            index = (slot.index + int(rng.integers(1, sizes[slot.group]))) % sizes[slot.group]
            other = graph.input(slot.group, index)
            yield Fault("wrong index", node, op, (*args[:i], other if arg > 0 else -other, *args[i + 1 :]))
    if len(args) == 2:
        for i in range(2):
            yield Fault("term dropped" if op == ADD else "factor dropped", node, ADD, (args[i], 0))
        if op == ADD and args[1] < 0:
            yield Fault("operands swapped", node, ADD, (-args[1], -args[0]))
        elif op not in (ADD, MUL):
            yield Fault("operands swapped", node, op, args[::-1])
    if op in ("sin", "cos"):
        yield Fault("sine and cosine exchanged", node, "cos" if op == "sin" else "sin", args)


class FaultSimulator:
    """Fault simulation of one program: its values over a batch of states, and how they change under a fault.

    Args:
        program: What to plant faults in.
        inputs: Each input group over the states (N, size), `pre` included.
    """

    def __init__(self, program: Program, inputs: Mapping[str, Array]) -> None:
        self.program = program
        self.graph = program.graph
        self.inputs = inputs
        edges = [edge for function in program.functions for edge in function.edges()]
        self.nodes = needed_nodes(self.graph, edges, program.pre)
        self._values: dict[int, Array | float] = dict(self.graph.value)
        for node in self.nodes:
            self._values[node] = self._compute(self.graph.op[node], self.graph.args[node], self._values)
        self._users: dict[int, list[int]] = {}
        for node in self.nodes:
            for arg in self.graph.args[node]:
                self._users.setdefault(abs(arg), []).append(node)
        self._outputs = {f: {abs(edge) for edge in f.edges()} for f in program.functions}

    def _leaf(self, node: int) -> Array | float:
        slot = self.program.pre.get(node) or self.graph.slot.get(node)
        if slot is None:
            return self.graph.value[node]
        return self.inputs[slot.group][:, slot.index]

    def _compute(self, op: str, args: Sequence[Edge], values: Mapping[int, Array | float]) -> Array | float:
        operands = []
        for arg in args:
            node = abs(arg)
            x = 0.0 if node == 0 else values[node] if node in values else self._leaf(node)
            operands.append(x if arg > 0 else -x)
        with np.errstate(all="ignore"):
            result: Array | float = OPS[op].rule(*operands)
        return result

    def affected(self, fault: Fault) -> tuple[list[Function], Callable[[Function], list[Array]]]:
        """The functions whose outputs a fault changes.

        Returns:
            The functions with an output that changes by a single bit, and their outputs under the fault.
        """
        changed: dict[int, Array | float] = {fault.node: self._compute(fault.op, fault.args, self._values)}
        pending = set(self._users.get(fault.node, ()))
        merged = _Overlay(changed, self._values)
        while pending:
            node = min(pending)
            pending.remove(node)
            value = self._compute(self.graph.op[node], self.graph.args[node], merged)
            if not np.array_equal(value, self._values[node], equal_nan=True):
                changed[node] = value
                pending.update(self._users.get(node, ()))
        if np.array_equal(changed[fault.node], self._values[fault.node], equal_nan=True):
            del changed[fault.node]
        touched = [f for f, nodes in self._outputs.items() if not nodes.isdisjoint(changed)]
        return touched, lambda function: self.outputs(function, merged)

    def outputs(self, function: Function, values: Mapping[int, Array | float] | None = None) -> list[Array]:
        """The outputs of a function (N, *shape), with the given values of nodes or the sound ones."""
        source = self._values if values is None else values
        n = len(next(iter(self.inputs.values())))
        results = []
        for output in function.outputs:
            columns = np.empty((n, len(output.edges)))
            for i, edge in enumerate(output.edges):
                columns[:, i] = self._compute(ADD, (edge, 0), source)
            results.append(columns.reshape(n, *output.shape))
        return results

    def mutant(self, fault: Fault) -> Program:
        """The program with the fault in it, for other evaluators."""
        graph = copy(self.graph)
        graph.op, graph.args = list(self.graph.op), list(self.graph.args)
        graph.op[fault.node], graph.args[fault.node] = fault.op, fault.args
        return Program(
            self.program.name, graph, self.program.sizes, self.program.functions, self.program.init, self.program.pre
        )


class _Overlay(Mapping[int, "Array | float"]):
    """Changed values before the sound ones."""

    def __init__(self, changed: Mapping[int, Array | float], sound: Mapping[int, Array | float]) -> None:
        self.changed, self.sound = changed, sound

    def __getitem__(self, node: int) -> Array | float:
        return self.changed[node] if node in self.changed else self.sound[node]

    def __contains__(self, node: object) -> bool:
        return node in self.changed or node in self.sound

    def __iter__(self) -> Iterator[int]:
        return iter({*self.changed, *self.sound})

    def __len__(self) -> int:
        return len({*self.changed, *self.sound})
