"""Faults that can be planted in Python: by the syntax tree, in what computes, not in what is said.

Messages, labels, annotations and checks by `assert` are left out: a fault there changes no result.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import accumulate

from .fault import (
    COMPARISON,
    CONSTANT,
    DROPPED,
    FRAME,
    INDEX,
    OPERATOR,
    SIGN,
    SWAPPED,
    SourceFault,
)

_OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.FloorDiv: "*"}
_COMPARISONS = {
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.Is: "is not",
    ast.IsNot: "is",
    ast.In: "not in",
    ast.NotIn: "in",
}
# Names that stand for an operation -> another operation of the same operands.
_CALLED = {
    "add": "sub",
    "sub": "add",
    "mul": "add",
    "div": "mul",
    "min": "max",
    "max": "min",
    "any": "all",
    "all": "any",
    "apply": "apply_inverse",
    "apply_inverse": "apply",
    "sin": "cos",
    "cos": "sin",
}
_SIGNED = {"add", "sub", "mul", "div", "scaled", "dot", "cross", "times", "apply", "apply_inverse"}
_COMMUTING = {"add", "mul", "min", "max", "dot", "zip", "isinstance", "range", "hypot"}
_AXES = {"x": "y", "y": "z", "z": "x", "xx": "yy", "yy": "zz", "zz": "xx", "xy": "xz", "xz": "yz", "yz": "xy"}
# A quantity and the frames it is of: p_WF, R_AB, w_WL_W.
_FRAMED = re.compile(r"(?P<quantity>(?:[RpvwaSJIEFMmr]|mp|alpha|f|n))_(?P<frames>[A-Z]\w*)")
_SPOKEN = re.compile(r".*(Error|Problem|Warning|Remark)|warn|named?|info|debug|join|format|fault|problem|refused?")


def python_faults(module: str, text: str) -> list[SourceFault]:
    """Every fault that can be planted in a file of Python."""
    return list(dict.fromkeys(_Planter(module, text).faults()))


class _Planter:
    def __init__(self, module: str, text: str) -> None:
        self.module, self.text = module, text
        self.lines = text.splitlines(keepends=True)
        self.offsets = [0, *accumulate(map(len, self.lines))]
        self.names: list[set[str]] = [set()]

    def faults(self) -> Iterator[SourceFault]:
        yield from self._child_faults(ast.parse(self.text))

    def _at(self, line: int, column: int) -> int:
        """Offset of a place as the syntax tree states it: columns are in bytes."""
        return self.offsets[line - 1] + len(self.lines[line - 1].encode()[:column].decode())

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self._at(node.lineno, node.col_offset), self._at(node.end_lineno, node.end_col_offset)

    def _source(self, node: ast.expr | ast.stmt) -> str:
        start, end = self._span(node)
        return self.text[start:end]

    def _replaced(self, kind: str, start: int, end: int, after: str) -> SourceFault:
        line = self.text.count("\n", 0, start) + 1
        return SourceFault(self.module, line, kind, start, self.text[start:end], after)

    def _node(self, kind: str, node: ast.expr | ast.stmt, after: str) -> SourceFault:
        return self._replaced(kind, *self._span(node), after)

    def _child_faults(self, node: ast.AST) -> Iterator[SourceFault]:
        for child in ast.iter_child_nodes(node):
            yield from self._of(child)

    def _of(self, node: ast.AST) -> Iterator[SourceFault]:
        if isinstance(node, ast.Raise | ast.Assert | ast.Import | ast.ImportFrom | ast.JoinedStr):
            return
        if isinstance(node, ast.Call) and _SPOKEN.fullmatch(_name(node.func)):
            return
        if isinstance(node, ast.If) and "TYPE_CHECKING" in self._source(node.test):
            return
        if isinstance(node, ast.FunctionDef):
            yield from self._function_faults(node)
            return
        if isinstance(node, ast.AnnAssign):
            if node.value is not None:
                yield from self._of(node.value)
            return
        if isinstance(node, ast.Assign) and any(_name(target).startswith("__") for target in node.targets):
            return
        if isinstance(node, ast.arg):
            return
        yield from self._here(node)
        yield from self._child_faults(node)

    def _function_faults(self, node: ast.FunctionDef) -> Iterator[SourceFault]:
        if node.returns is not None and re.search(r"\bstr\b|Problem", self._source(node.returns)):
            texts = [x for x in ast.walk(node) if isinstance(x, ast.JoinedStr)]
            if texts:  # It returns a text.
                return
        self.names.append({x.id for x in ast.walk(node) if isinstance(x, ast.Name)} | {a.arg for a in node.args.args})
        for default in (*node.args.defaults, *filter(None, node.args.kw_defaults)):
            yield from self._of(default)
        for statement in node.body:
            yield from self._of(statement)
        self.names.pop()

    def _here(self, node: ast.AST) -> Iterator[SourceFault]:
        match node:
            case ast.BinOp():
                yield from self._binary(node)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                if not isinstance(operand, ast.Constant):
                    yield self._node(SIGN, node, self._source(operand))
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                yield self._node(COMPARISON, node, f"({self._source(operand)})")
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                wrong = _COMPARISONS[type(op)]
                yield self._between(COMPARISON, left, right, wrong)
            case ast.BoolOp(op=op, values=[first, second, *_]):
                yield self._between(COMPARISON, first, second, "or" if isinstance(op, ast.And) else "and")
            case _:
                yield from self._operand_faults(node)

    def _operand_faults(self, node: ast.AST) -> Iterator[SourceFault]:
        match node:
            case ast.AugAssign(op=ast.Add() | ast.Sub()):
                yield self._node(DROPPED, node, "pass")
            case ast.Subscript(slice=index):
                yield from self._index(index)
            case ast.Attribute(value=value, attr=attr):
                yield from self._attribute(node, value, attr)
            case ast.Name(ctx=ast.Load()):
                yield from self._framed(node)
            case ast.Call():
                yield from self._call(node)
            case ast.Constant():
                yield from self._constant(node)
            case _:
                pass

    def _between(self, kind: str, left: ast.expr, right: ast.expr, operator: str) -> SourceFault:
        """A fault that replaces the operator between two operands, not parentheses and spaces."""
        start, end = self._span(left)[1], self._span(right)[0]
        piece = self.text[start:end]
        inner = re.search(r"[^\s()#]+(?: (?:not|in))?", piece)
        assert inner is not None
        return self._replaced(kind, start + inner.start(), start + inner.end(), operator)

    def _binary(self, node: ast.BinOp) -> Iterator[SourceFault]:
        left, right = self._source(node.left), self._source(node.right)
        if isinstance(node.op, ast.MatMult):
            yield self._node(FRAME, node, f"({left}).T @ {right}")
            yield self._node(FRAME, node, f"{left} @ ({right}).T")
            yield self._node(SWAPPED, node, f"{right} @ {left}")
            return
        if type(node.op) in _OPERATORS and not _is_text(node.left) and not _is_text(node.right):
            yield self._between(OPERATOR, node.left, node.right, _OPERATORS[type(node.op)])
            yield self._node(DROPPED, node, f"({left})")
            yield self._node(DROPPED, node, f"({right})")

    def _index(self, index: ast.expr) -> Iterator[SourceFault]:
        parts = index.elts if isinstance(index, ast.Tuple) else [index]
        for part in parts:
            ends = (part.lower, part.upper) if isinstance(part, ast.Slice) else (part,)
            for end in ends:
                number = _integer(end)
                if end is not None and number is not None:
                    wrong = (number + 1) % 3 if 0 <= number < 3 else number - 1 if number > 0 else number + 1
                    yield self._node(INDEX, end, str(wrong))

    def _attribute(self, node: ast.Attribute, value: ast.expr, attr: str) -> Iterator[SourceFault]:
        start, end = self._span(value)[1], self._span(node)[1]
        if attr in _AXES:
            yield self._replaced(INDEX, end - len(attr), end, _AXES[attr])
        if attr == "T":
            yield self._replaced(FRAME, start, end, "")

    def _framed(self, node: ast.Name) -> Iterator[SourceFault]:
        match = _FRAMED.fullmatch(node.id)
        if match is not None:
            quantity = match["quantity"]
            others = sorted(
                name
                for name in self.names[-1] - {node.id}
                if (other := _FRAMED.fullmatch(name)) and other["quantity"] == quantity
            )
            yield from (self._node(FRAME, node, other) for other in others[:2])

    def _call(self, node: ast.Call) -> Iterator[SourceFault]:
        name = _name(node.func)
        plain = [arg for arg in node.args if not isinstance(arg, ast.Starred)]
        if name in _CALLED:
            end = self._span(node.func)[1]
            yield self._replaced(OPERATOR, end - len(name), end, _CALLED[name])
        if name == "times" and isinstance(node.func, ast.Attribute):
            end = self._span(node.func.value)[1]
            yield self._replaced(FRAME, end, end, ".T")
        if name in _SIGNED:
            for arg in plain:
                if isinstance(arg, ast.Name | ast.Attribute | ast.Call):
                    yield self._node(SIGN, arg, f"-{self._source(arg)}")
        if name in {"add", "sub", "mul", "div"} and len(plain) == 2:
            yield self._node(DROPPED, node, self._source(plain[0]))
            yield self._node(DROPPED, node, self._source(plain[1]))
        if len(plain) >= 2 and plain == node.args and name not in _COMMUTING:
            first, second = plain[:2]
            one, other = self._source(first), self._source(second)
            if one != other and not _is_text(first) and not _is_text(second):
                start, end = self._span(first)[0], self._span(second)[1]
                between = self.text[self._span(first)[1] : self._span(second)[0]]
                yield self._replaced(SWAPPED, start, end, f"{other}{between}{one}")

    def _constant(self, node: ast.Constant) -> Iterator[SourceFault]:
        value = node.value
        if isinstance(value, bool):
            yield self._node(CONSTANT, node, str(not value))
        elif isinstance(value, int):
            yield self._node(CONSTANT, node, str(value + 1))
        elif isinstance(value, float):
            yield self._node(CONSTANT, node, repr(2.0 * value if value else 1.0))
        elif value in ("sin", "cos"):
            yield self._node(OPERATOR, node, f'"{_CALLED[value]}"')


def _name(node: ast.expr) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def _integer(node: ast.expr | None) -> int | None:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = _integer(node.operand)
        return None if inner is None else -inner
    is_number = isinstance(node, ast.Constant) and isinstance(node.value, int) and not isinstance(node.value, bool)
    return node.value if is_number else None  # type: ignore[union-attr]


def _is_text(node: ast.expr) -> bool:
    """Whether an operand is a text, or a list that others are appended to."""
    if isinstance(node, ast.BinOp):
        return _is_text(node.left) or _is_text(node.right)
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))
