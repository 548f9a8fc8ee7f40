"""Programs as text, for golden tests of what forms and rewrites them: a dozen lines in, a dozen out.

A file `NAME.txt` beside a test holds its cases, each a title, the input, and what is expected of it:

    ### A sum starts with a term that is no product.
    f(x):
      early = x[0]*x[1] + x[2]*x[3]
      y: early - x[4]
    ==>
    f(x):
      t1 = x[0]*x[1]
      ...

`python -m pytest FILE --update-golden` rewrites what is expected; read the difference before it is kept.

In text, `name = expression` gives an edge a name, `name! = ...` also labels its node, `name = pack ...` forms a linear
combination of packs, whose lanes are `name[0]`, `name[1]`, ...; `name: a, b` is an output. What is printed has one
operation a line, operands first, under the node's label where it has one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD, DIV, MUL, OPS
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.program import Function, Output, Program

_SIGNS = {ADD: "+", MUL: "*", DIV: "/"}
_TERM = re.compile(r"([+-]?)\s*(\w+(?:\[\d+\])?)\s*\*\s*(\w+|\([^()]*\))\s*")


@dataclass(frozen=True)
class _Value:
    """An edge that Python's operators work on."""

    g: Graph
    edge: Edge

    def edge_of(self, other: Any) -> Edge:
        return other.edge if isinstance(other, _Value) else self.g.constant(other)

    def __add__(self, other: Any) -> _Value:
        return _Value(self.g, self.g.add(self.edge, self.edge_of(other)))

    def __sub__(self, other: Any) -> _Value:
        return _Value(self.g, self.g.sub(self.edge, self.edge_of(other)))

    def __mul__(self, other: Any) -> _Value:
        return _Value(self.g, self.g.mul(self.edge, self.edge_of(other)))

    def __truediv__(self, other: Any) -> _Value:
        return _Value(self.g, self.g.div(self.edge, self.edge_of(other)))

    def __pow__(self, other: Any) -> _Value:
        return _Value(self.g, self.g.power(self.edge, self.edge_of(other)))

    def __radd__(self, other: Any) -> _Value:
        return _Value(self.g, self.edge_of(other)) + self

    def __rsub__(self, other: Any) -> _Value:
        return _Value(self.g, self.edge_of(other)) - self

    def __rmul__(self, other: Any) -> _Value:
        return _Value(self.g, self.edge_of(other)) * self

    def __rtruediv__(self, other: Any) -> _Value:
        return _Value(self.g, self.edge_of(other)) / self

    def __neg__(self) -> _Value:
        return _Value(self.g, -self.edge)


@dataclass(frozen=True)
class _Group:
    """An input group, by whose entries its inputs are created."""

    g: Graph
    name: str

    def __getitem__(self, index: int) -> _Value:
        return _Value(self.g, self.g.input(self.name, index))


class _Parser:
    def __init__(self) -> None:
        self.g = Graph()
        self.packs: dict[str, Pack] = {}
        calls = {name: self.call(name) for name in OPS if name not in _SIGNS}
        self.names: dict[str, Any] = {**calls, "__builtins__": {}}

    def call(self, name: str) -> Callable[..., _Value]:
        return lambda *x: _Value(self.g, self.g.call(name, *(_Value(self.g, ONE).edge_of(one) for one in x)))

    def edges(self, text: str) -> tuple[Edge, ...]:
        values = eval(f"({text},)", self.names)
        return tuple(value.edge if isinstance(value, _Value) else self.g.constant(value) for value in values)

    def group(self, name: str) -> None:
        self.names.setdefault(name, _Group(self.g, name))

    def pack(self, name: str, text: str) -> None:
        terms = []
        for sign, factor, operand in _TERM.findall(text):
            lanes = self.edges(operand[1:-1]) if operand.startswith("(") else self.packs[operand].lanes
            stated = self.packs.get(operand) or Pack(lanes + (ZERO,) * (WIDTH - len(lanes)))
            terms.append((self.edges(factor)[0], (-ONE if sign == "-" else ONE, stated)))
        _, self.packs[name] = linear_combination(self.g, terms)
        self.names[name] = [_Value(self.g, edge) for edge in self.packs[name].lanes]

    def line(self, text: str) -> Output | None:
        """Read a line of a function; an output is returned."""
        if output := re.fullmatch(r"\s+(\w+): (.*)", text):
            edges = self.edges(output[2])
            return Output(output[1], (len(edges),), edges)
        name, _, stated = (part.strip() for part in text.partition("="))
        if stated.startswith("pack "):
            self.pack(name, stated[5:])
            return None
        label = name.rstrip("!")
        self.names[label] = _Value(self.g, self.edges(stated)[0])
        if name != label:
            self.g.name(self.names[label].edge, label)
        return None


def parse_program(text: str) -> Program:
    """The program that a text states; sizes of groups are those that it reads."""
    parser, functions = _Parser(), list[Function]()
    for block in re.split(r"^(?=\w)", text, flags=re.MULTILINE)[1:]:
        head, *lines = block.rstrip().splitlines()
        name, _, groups = head.rstrip("):").partition("(")
        inputs = tuple(group.strip() for group in groups.split(",") if group.strip())
        for group in inputs:
            parser.group(group)
        outputs = tuple(output for line in lines if (output := parser.line(line)) is not None)
        functions.append(Function(name, "", inputs, outputs))
    sizes: dict[str, int] = {}
    for slot in parser.g.slot.values():
        sizes[slot.group] = max(sizes.get(slot.group, 0), slot.index + 1)
    return Program("text", parser.g, sizes, tuple(functions))


class _Printer:
    def __init__(self, program: Program) -> None:
        self.program, self.g, self.names = program, program.graph, dict[int, str]()

    def edge(self, edge: Edge) -> str:
        if self.g.is_constant(edge):
            return f"{self.g.number(edge):.15g}"
        node = abs(edge)
        slot = self.program.pre.get(node) or self.g.slot.get(node)
        name = self.names[node] if slot is None else f"{slot.group}[{slot.index}]"
        return name if edge > 0 else f"-{name}"

    def operation(self, node: int) -> str:
        op, args = self.g.op[node], [self.edge(arg) for arg in self.g.args[node]]
        if op not in _SIGNS:
            return f"{op}({', '.join(args)})"
        if op == ADD and args[1].startswith("-"):
            return f"{args[0]} - {args[1][1:]}"
        return f" {_SIGNS[op]} ".join(args)

    def statements(self, edges: list[Edge], given: Mapping[int, Any]) -> Iterator[str]:
        for node in needed_nodes(self.g, edges, given):
            if node not in self.names:
                label = self.g.label.get(node, "")
                self.names[node] = label or f"t{1 + len(self.names)}"
                yield f"  {self.names[node]}{'!' if label else ''} = {self.operation(node)}"

    def lines(self) -> Iterator[str]:
        if self.program.init:
            yield "init(par):"
            stated, self.program = self.program, Program("init", self.g, {}, ())
            yield from self.statements(list(stated.init), {})
            yield f"  pre: {', '.join(map(self.edge, stated.init))}"
            self.program, self.names = stated, {}
        for function in self.program.functions:
            yield f"{function.name}({', '.join(function.inputs)}):"
            yield from self.statements(function.edges(), self.program.pre)
            for output in function.outputs:
                yield f"  {output.name}: {', '.join(map(self.edge, output.edges))}"
        for pack in self.g.packs:
            lanes = {lane: pack.lanes[lane] for lane in sorted(pack.new_lanes)}
            read = [f"{lane}: {self.edge(edge)}" for lane, edge in lanes.items() if abs(edge) in self.names]
            yield f"pack of lanes {', '.join(read)}"


def program_text(program: Program) -> str:
    """A program as text: the stage `init`, functions, and the lanes of packs that are formed by vectors."""
    return "\n".join(_Printer(program).lines())


@dataclass(frozen=True)
class Case:
    """One case of a golden file."""

    path: Path
    title: str
    stated: str
    expected: str


def golden_cases(test: str, name: str) -> list[Any]:
    """The cases of a file as parameters of a test.

    Args:
        test: Module of the test (`__file__`).
        name: Name of the file beside it, without its suffix.
    """
    path = Path(test).with_name(f"{name}.txt")
    blocks = re.split(r"^### ", path.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    cases = []
    for block in blocks:
        title, _, rest = block.partition("\n")
        stated, _, expected = rest.partition("==>\n")
        cases.append(Case(path, title, stated.rstrip(), expected.rstrip()))
    return [pytest.param(case, id=re.sub(r"\W+", "_", case.title).strip("_")) for case in cases]


def assert_golden(case: Case, rewritten: Callable[[str], str], request: pytest.FixtureRequest) -> None:
    """Compare what becomes of a case's input with what is expected; with --update-golden, write it instead."""
    found = rewritten(case.stated).rstrip()
    if request.config.getoption("--update-golden"):
        text = case.path.read_text(encoding="utf-8")
        block = f"### {case.title}\n{case.stated}\n==>\n"
        before, _, after = text.partition(f"### {case.title}\n")
        following = re.search(r"^### ", after, flags=re.MULTILINE)
        rest, newline = after[following.start() :] if following else "", "\n"
        case.path.write_text(
            f"{before}{block}{found and found + newline}{newline if rest else ''}{rest}", encoding="utf-8"
        )
    else:
        assert found == case.expected
