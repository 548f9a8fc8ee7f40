"""Program -> tapes: the instructions that native/tape interprets, in place of C text that has to be compiled.

A tape has one instruction for each operation of the graph; a product that one sum alone reads is part of the sum's
instruction, and rounds as if it stood by itself. Registers are given out in the order of the instructions, each again
after its last use.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from heapq import heappop, heappush
from itertools import count
from math import prod
from string import Template

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph, Slot
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD, MUL, STOP_GRADIENT
from symofros.expr.program import Function, Output, Program, Solver
from symofros.generator.codegen import trigonometry
from symofros.generator.codegen.solvers import ROUTINES, routine_work
from symofros.generator.codegen.statements import WIDEST
from symofros.native import native_text
from symofros.runtime.calls.tape import Routine, Tape, TapeFunction, TapeUnit, tape_machine
from symofros.runtime.record import ModelRecord

# Instructions past the earliest one that is left, among which the next one is chosen.
_WINDOW = 128
# Entries of outputs that wait for one instruction to store them.
_STORED_TOGETHER = 16
_TRIGONOMETRIC = ("sin", "cos")


@cache
def machine_text() -> str:
    """C text of the machine that interprets tapes, with the routines that finish functions."""
    sines = trigonometry.routines(["sym_sincos_1(", f"sym_sincos_{WIDEST}("])
    solvers = [native_text(f"model/{name}.c.in") for name in ROUTINES if name != "sparse_system"]
    header = native_text("tape/symofros_tape.h")
    return Template(native_text("tape/tape.c.in")).substitute(header=header, routines="\n".join([*sines, *solvers]))


def tape_functions(program: Program) -> tuple[Tape, list[TapeFunction]]:
    """The parameters' part of a staged program, and its functions, as tapes."""
    init = _tape(program.graph, ("par",), [Output("pre", (len(program.init),), program.init)], {})
    return init, [_function(program, function) for function in program.functions]


def tape_unit(program: Program, record: ModelRecord) -> TapeUnit:
    """The functions of a staged program on tape.

    Raises:
        CompileError: There is no machine, or it holds as many functions as it can.
    """
    return TapeUnit(tape_machine(machine_text()), *tape_functions(program), record)


def _function(program: Program, function: Function) -> TapeFunction:
    own = _tape(program.graph, ("pre", *function.inputs), function.outputs, program.pre)
    inputs = [(name, (program.sizes[name],)) for name in function.inputs]
    routine = None if function.solver is None else _routine(program, function, function.solver, own)
    return TapeFunction(function.name, function.frame, tuple(inputs), function.returns, own, routine)


def _routine(program: Program, function: Function, solver: Solver, terms: Tape) -> Routine:
    """The arguments of the routine that finishes a function; matrices are full."""
    parts = [_tape(program.graph, ("pre", *part.inputs), part.outputs, program.pre) for part in solver.parts]
    by_name = {output.name: output for output in function.outputs}
    nc, nv = by_name["G"].shape if "G" in by_name else (0, by_name["steps"].shape[0])
    nq, extra = 0, 0
    columns: tuple[int, ...] = ()
    match solver.routine:
        case "constrained" | "null_space":
            nq = solver.parts[0].outputs[0].shape[0]
        case "project":
            nq = function.returns[0][1][0]
            extra = len(by_name["facing"].edges) if "facing" in by_name else 0
        case "differentiate":
            columns = tuple(shape[1] for _, shape in function.returns)
            extra = len(columns)
        case "responses":
            extra = function.returns[-1][1][1]
        case "hessian":
            extra = function.returns[0][1][0]
    work = routine_work(function, solver, max(tape.registers for tape in (terms, *parts)))
    return Routine(solver.routine, tuple(parts), nq, nv, nc, extra, columns, solver.tables, work)


def _tape(graph: Graph, inputs: Sequence[str], outputs: Sequence[Output], given: Mapping[int, Slot]) -> Tape:
    writer = _Writer(graph, inputs, outputs, given)
    writer.write()
    return writer.tape()


@dataclass
class _Instruction:
    """One instruction before registers are given out.

    Attributes:
        name: Operation.
        writes: Values that it forms: nodes, or numbers below zero for values that are no node's.
        reads: Values that it reads.
        head: Words behind the operation.
        entries: Entry of an array that each value is read from or stored to; empty for arithmetic.
    """

    name: str
    writes: list[int]
    reads: list[int]
    head: tuple[int, ...] = ()
    entries: list[int] = field(default_factory=list)


class _Writer:
    """Writes the tape of some outputs.

    Args:
        graph: The graph.
        inputs: Input groups, in order.
        outputs: Outputs, in order.
        given: Nodes that are read from a group instead of computed.
    """

    def __init__(
        self, graph: Graph, inputs: Sequence[str], outputs: Sequence[Output], given: Mapping[int, Slot]
    ) -> None:
        self._graph, self._outputs, self._given = graph, outputs, given
        self._inputs = {name: i for i, name in enumerate(inputs)}
        edges = [edge for output in outputs for edge in output.edges if edge != 0]
        self._nodes = needed_nodes(graph, edges, given)
        self._edges = edges
        self._trigonometric = [node for node in self._nodes if graph.op[node] in _TRIGONOMETRIC]
        self._numbers: dict[float, int] = {}
        self._others = count(-1, -1)
        self._instructions: list[_Instruction] = []
        self._loads: dict[int, dict[int, int]] = {}  # Input -> entry -> value.
        self._merged = self._products()
        self._waiting: dict[tuple[int, str], list[tuple[int, int]]] = {}

    def _products(self) -> set[int]:
        """Products that one sum alone reads."""
        graph = self._graph
        uses = Counter(abs(arg) for node in self._nodes for arg in graph.args[node])
        uses.update(map(abs, self._edges))
        computed = set(self._nodes)
        return {
            abs(arg)
            for node in self._nodes
            if graph.op[node] == ADD
            for arg in graph.args[node]
            if abs(arg) in computed and graph.op[abs(arg)] == MUL and uses[abs(arg)] == 1
        }

    def write(self) -> None:
        """All instructions, in order."""
        graph = self._graph
        stores: dict[int, list[tuple[int, int, Edge]]] = {}
        done: set[int] = set()
        for i, output in enumerate(self._outputs):
            for entry, edge in enumerate(output.edges):
                if edge != 0:
                    stores.setdefault(abs(edge), []).append((i, entry, edge))
        for node in self._nodes:
            if node in self._merged or node in done:
                continue
            formed = self._angles(node, done) if graph.op[node] in _TRIGONOMETRIC else [node]
            done.update(formed)
            if graph.op[node] not in _TRIGONOMETRIC:
                self._operation(node)
            for one in formed:
                self._store(stores.pop(one, ()))
        for waiting in stores.values():  # Inputs and numbers.
            self._store(waiting)
        for key in list(self._waiting):
            self._flush(key)

    def _value(self, edge: Edge) -> int:
        """The value of an edge: a register's; a negative one is formed where it is no number."""
        number = self._graph.number(edge)
        if number is not None:
            return self._number(number)
        value = self._leaf(abs(edge))
        if edge > 0:
            return value
        negative = next(self._others)
        self._instructions.append(_Instruction("NEG", [negative], [value]))
        return negative

    def _number(self, number: float) -> int:
        if number not in self._numbers:
            self._numbers[number] = next(self._others)
        return self._numbers[number]

    def _leaf(self, node: int) -> int:
        """A node; if it is an entry of an input, that is loaded."""
        slot = self._given.get(node) or self._graph.slot.get(node)
        if slot is not None:
            self._loads.setdefault(self._inputs[slot.group], {}).setdefault(slot.index, node)
            return self._loads[self._inputs[slot.group]][slot.index]
        return node

    def _operation(self, node: int) -> None:
        graph = self._graph
        name, args = graph.op[node], graph.args[node]
        if name == ADD:
            self._sum(node, *args)
        elif name == STOP_GRADIENT:  # The same number: as a product by one.
            self._add("MUL", node, [self._value(args[0]), self._number(1.0)])
        else:
            self._add(name.upper(), node, [self._value(arg) for arg in args])

    def _sum(self, node: int, a: Edge, b: Edge) -> None:
        """The sum of a, which is positive by construction, and b."""
        first, second = a in self._merged, abs(b) in self._merged
        sign = "ADD" if b > 0 else "SUB"
        if self._graph.number(b) is not None:
            second, sign = False, "ADD"
        factors = [self._value(arg) for of, merged in ((a, first), (b, second)) if merged for arg in self._args(of)]
        if first and second:
            self._add(f"MULS_{sign}", node, factors)
        elif first:
            self._add(f"MUL_{sign}", node, [*factors, self._positive(b)])
        elif second:
            self._add("MUL_ADD" if b > 0 else "SUB_MUL", node, [*factors, self._positive(a)])
        else:
            self._add(sign, node, [self._positive(a), self._positive(b)])

    def _positive(self, edge: Edge) -> int:
        """The value of an operand of a sum, whose sign the operation has; numbers keep theirs."""
        return self._value(edge if self._graph.number(edge) is not None else abs(edge))

    def _args(self, edge: Edge) -> tuple[Edge, ...]:
        return self._graph.args[abs(edge)]

    def _angles(self, node: int, done: set[int]) -> list[int]:
        """Sine and cosine of an angle at once, beside those of other angles that are there already."""
        graph = self._graph
        ready: dict[Edge, dict[str, int]] = {}
        own = graph.args[node][0]
        for other in self._trigonometric:
            angle = graph.args[other][0]
            if other not in done and (angle in (own, *ready) or (len(ready) < WIDEST and self._is_there(angle, done))):
                ready.setdefault(angle, {})[graph.op[other]] = other
        formed, writes, reads = list[int](), list[int](), list[int]()
        chosen = [own, *(angle for angle in ready if angle != own)][:WIDEST]
        for angle in chosen:
            pair = ready[angle]
            reads.append(self._value(angle))
            writes += [pair.get(name) or next(self._others) for name in _TRIGONOMETRIC]
            formed += pair.values()
        self._instructions.append(_Instruction("SINCOS", writes, reads, (len(reads),)))
        return formed

    def _is_there(self, edge: Edge, done: set[int]) -> bool:
        node = abs(edge)
        return node in done or node in self._given or not self._graph.args[node]

    def _add(self, name: str, node: int, reads: list[int]) -> None:
        self._instructions.append(_Instruction(name, [node], reads))

    def _store(self, entries: Iterable[tuple[int, int, Edge]]) -> None:
        for output, entry, edge in entries:
            is_number = self._graph.number(edge) is not None
            key = output, "STORE" if edge > 0 or is_number else "STORE_NEG"
            value = self._value(edge if is_number else abs(edge))
            self._waiting.setdefault(key, []).append((entry, value))
            if len(self._waiting[key]) >= _STORED_TOGETHER:
                self._flush(key)

    def _flush(self, key: tuple[int, str]) -> None:
        waiting = self._waiting.pop(key)
        output, name = key
        entries, values = [entry for entry, _ in waiting], [value for _, value in waiting]
        self._instructions.append(_Instruction(name, [], values, (output, len(waiting)), entries))

    def tape(self) -> Tape:
        """The tape, with registers given out."""
        loads = [
            _Instruction("LOAD", list(entries.values()), [], (i, len(entries)), list(entries))
            for i, entries in self._loads.items()
        ]
        clears = [_Instruction("CLEAR", [], [], (i,)) for i, output in enumerate(self._outputs) if 0 in output.edges]
        instructions = [*clears, *loads, *_scheduled(self._instructions)]
        last = {value: i for i, one in enumerate(instructions) for value in (*one.writes, *one.reads)}
        registers = {value: i for i, value in enumerate(self._numbers.values())}
        fixed, highest, free = set(registers), len(registers), list[int]()
        code: list[tuple[str, list[int]]] = []
        for i, one in enumerate(instructions):
            read = [registers[value] for value in one.reads]
            spare = [registers[value] for value in set(one.reads) if last[value] == i and value not in fixed]
            free += spare if one.name != "SINCOS" else []  # It writes some results before it has read all angles.
            for value in one.writes:
                if not free:
                    free.append(highest)
                    highest += 1
                registers[value] = free.pop()
            written = [registers[value] for value in one.writes]
            free += spare if one.name == "SINCOS" else []
            free += (registers[value] for value in one.writes if last[value] == i)
            words = [*one.head, *_operands(one, written, read)]
            if one.head or not code or code[-1][0] != one.name:
                code.append((one.name, words if one.head else [1, *words]))
            else:  # Another of the same: a run.
                code[-1][1][0] += 1
                code[-1][1].extend(words)
        sizes = tuple(prod(output.shape) for output in self._outputs)
        return Tape(tuple(code), tuple(self._numbers), max(1, highest), len(self._inputs), sizes)


def _scheduled(instructions: Sequence[_Instruction]) -> list[_Instruction]:
    """The same in an order of long runs of one operation, each instruction near where it stood: values live as long."""
    formed = {value: i for i, one in enumerate(instructions) for value in one.writes}
    needs = [{formed[value] for value in one.reads if value in formed} for one in instructions]
    users: list[list[int]] = [[] for _ in instructions]
    for i, before in enumerate(needs):
        for j in before:
            users[j].append(i)
    missing = list(map(len, needs))
    ready: dict[str, list[int]] = {}  # Heaps, by operation, of what may be next.
    beyond = [i for i, count in enumerate(missing) if count == 0]  # A heap of the same past the window.
    done, first, order = [False] * len(instructions), 0, list[_Instruction]()
    name = ""
    while len(order) < len(instructions):
        while beyond and beyond[0] < first + _WINDOW:
            i = heappop(beyond)
            heappush(ready.setdefault(instructions[i].name, []), i)
        if not ready.get(name):
            name = max((key for key, waiting in ready.items() if waiting), key=lambda key: len(ready[key]))
        i = heappop(ready[name])
        done[i] = True
        order.append(instructions[i])
        for user in users[i]:
            missing[user] -= 1
            if missing[user] == 0:
                heappush(beyond, user)
        while first < len(done) and done[first]:
            first += 1
    return order


def _operands(one: _Instruction, written: Sequence[int], read: Sequence[int]) -> Iterator[int]:
    """The words of an instruction behind its head."""
    if one.entries:
        for pair in zip(one.entries, [*written, *read], strict=True):
            yield from pair
    elif one.name == "SINCOS":
        for i, angle in enumerate(read):
            yield from (*written[2 * i : 2 * i + 2], angle)
    else:
        yield from (*written, *read)
