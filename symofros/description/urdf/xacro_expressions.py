"""Expressions of xacro files, evaluated without Python's `eval`: arithmetic over plain values.

A value is None, a boolean, a number, a text, a list, a tuple, a dictionary, or a namespace of xacro, which holds such.
A function is none: it is called by its name, from the tables of this module, never looked up among what a file defines.
So no expression reaches an attribute of a Python object, or calls what the file names. Standard library only: the
process that expands files loads this module by its path.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

# Elements of a list or characters of a text that one operation may make, and bits of an integer.
MAX_LENGTH = 1 << 24
MAX_BITS = 1 << 12
MAX_DEPTH = 100

_PLAIN = (type(None), bool, int, float, str, list, tuple, dict)
_BINARY: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_UNARY: Mapping[type, Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
_COMPARISONS: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
}


class Refusal(Exception):
    """Raised where a xacro file does or needs what is not allowed, or exceeds a bound.

    Args:
        text: What it is.
        package: Name of a package that is not known, where that is the reason.
    """

    def __init__(self, text: str, package: str = "") -> None:
        super().__init__(text)
        self.package = package


def _bounded(value: Any) -> Any:
    """A value, if it is plain and of bounded size.

    Raises:
        Refusal: It is neither.
    """
    if not isinstance(value, _PLAIN):
        raise Refusal(f"a {type(value).__name__} is no value of an expression")
    if isinstance(value, str | list | tuple | dict):
        _count(len(value))
    if isinstance(value, int) and value.bit_length() > MAX_BITS:
        raise Refusal(f"an integer of {value.bit_length()} bits, more than {MAX_BITS}")
    return value


def _binary(kind: type, a: Any, b: Any) -> Any:
    """Result of a binary operator; its size is bounded before it is computed."""
    if kind not in _BINARY:
        raise Refusal(f"the operator {kind.__name__} is not allowed in an expression")
    if kind is ast.Mult:
        for repeated, times in ((a, b), (b, a)):
            if isinstance(repeated, str | list | tuple) and isinstance(times, int):
                _count(len(repeated) * max(times, 0))
    if kind is ast.Pow and isinstance(a, int) and isinstance(b, int) and b > 0 and a.bit_length() * b > MAX_BITS:
        raise Refusal(f"an integer of some {a.bit_length() * b} bits, more than {MAX_BITS}")
    if kind is ast.Mod and isinstance(a, str) and re.search(r"%(\([^)]*\))?[^%a-zA-Z]*(\*|\d{4})", a):
        raise Refusal("a format with a width of more than three digits")
    return _BINARY[kind](a, b)


def _count(length: int) -> None:
    if length > MAX_LENGTH:
        raise Refusal(f"a value of {length} elements, more than {MAX_LENGTH}")


def _range(*bounds: int) -> list[int]:
    numbers = range(*bounds)
    _count(len(numbers))
    return list(numbers)


def _round(value: Any, digits: int | None = None) -> Any:
    if isinstance(digits, int) and abs(digits) > 400:
        raise Refusal(f"rounding to {digits} digits")
    return round(value, digits)


def _fatal(*arguments: Any) -> None:
    raise Refusal(f"fatal: {' '.join(map(str, arguments)):.300}")


def _tokenize(text: str, sep: str = ",; ", skip_empty: bool = True) -> list[str]:
    """Pieces of a text between any of some characters, as xacro splits it."""
    if not isinstance(text, str) or not isinstance(sep, str) or not sep:
        raise Refusal("tokenize takes a text and the characters that separate its pieces")
    return [piece for piece in re.split(f"[{re.escape(sep)}]", text) if piece or not skip_empty]


def _replace(text: str, old: str, new: str) -> str:
    if not all(isinstance(part, str) for part in (text, old, new)):
        raise Refusal("replace takes texts")
    _count((len(text) + 1) * max(len(new), 1))
    return text.replace(old, new)


def _join(text: str, pieces: Iterable[Any]) -> str:
    parts = [str(piece) for piece in pieces]
    _count(sum(map(len, parts)) + len(text) * len(parts))
    return text.join(parts)


_MATH = {name: value for name, value in vars(math).items() if not name.startswith("_")}
# What an expression of $(eval ...) knows unasked; one of ${...} has them from xacro.
CONSTANTS = {"true": True, "false": False, **{k: v for k, v in _MATH.items() if isinstance(v, float)}}
_LARGE = frozenset({"comb", "factorial", "perm"})  # of little use here, and of unbounded size
_MATH_FUNCTIONS = {name: value for name, value in _MATH.items() if callable(value) and name not in _LARGE}
_PYTHON: Mapping[str, Callable[..., Any]] = {
    "abs": abs,
    "all": all,
    "any": any,
    "bool": bool,
    "dict": dict,
    "divmod": divmod,
    "enumerate": lambda values, start=0: list(enumerate(values, start)),
    "float": float,
    "int": int,
    "len": len,
    "list": list,
    "max": max,
    "min": min,
    "range": _range,
    "reversed": lambda values: list(reversed(values)),
    "round": _round,
    "sorted": sorted,
    "str": str,
    "sum": sum,
    "tuple": tuple,
    "zip": lambda *values: list(zip(*values, strict=False)),
}
_XACRO: Mapping[str, Callable[..., Any]] = {
    "error": lambda *arguments: "",
    "fatal": _fatal,
    "message": lambda *arguments: "",
    "print_location": lambda *arguments: "",
    "tokenize": _tokenize,
    "warning": lambda *arguments: "",
}
_METHODS: Mapping[type, Mapping[str, Callable[..., Any]]] = {
    str: {
        "endswith": str.endswith,
        "join": _join,
        "lower": str.lower,
        "replace": _replace,
        "split": str.split,
        "startswith": str.startswith,
        "strip": str.strip,
        "upper": str.upper,
    },
    dict: {
        "get": dict.get,
        "items": lambda d: list(dict.items(d)),
        "keys": lambda d: list(dict.keys(d)),
        "values": lambda d: list(dict.values(d)),
    },
}


class Evaluator:
    """Evaluates expressions.

    Args:
        symbols: Values by name; a mapping that knows of none raises KeyError.
        functions: Functions of xacro beside those of this module, by name.
        namespace: Type of the values that are namespaces.
    """

    def __init__(self, symbols: Any, functions: Mapping[str, Callable[..., Any]], namespace: type) -> None:
        self._symbols = symbols
        self._functions = {
            "python": _PYTHON,
            "math": _MATH_FUNCTIONS,
            "xacro": {**_XACRO, **functions},
        }
        self._namespace = namespace
        self._depth = 0

    def __call__(self, expression: str) -> Any:
        """The value of an expression.

        Raises:
            Refusal: It does more than compute.
            SyntaxError: It is none.
            NameError: It names what is not defined.
        """
        try:
            return self._value(ast.parse(expression.strip(), mode="eval").body)
        except Refusal as refusal:
            raise Refusal(f"'{expression:.80}': {refusal}", refusal.package) from None

    def _value(self, node: ast.expr) -> Any:
        method = getattr(self, f"_{type(node).__name__.lower()}", None)
        if method is None:
            raise Refusal(f"{type(node).__name__} is not allowed in an expression")
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise Refusal(f"it is nested more than {MAX_DEPTH} deep")
        value = method(node)
        self._depth -= 1
        return value if isinstance(value, self._namespace) else _bounded(value)

    def _constant(self, node: ast.Constant) -> Any:
        return node.value

    def _name(self, node: ast.Name) -> Any:
        if node.id.startswith("_"):
            raise Refusal("names that begin with '_' are not allowed")
        try:
            return self._symbols[node.id]
        except KeyError:
            raise NameError(f"name '{node.id}' is not defined") from None

    def _attribute(self, node: ast.Attribute) -> Any:
        """An entry of a namespace, or of a dictionary by xacro's dots; nothing else has attributes."""
        if node.attr.startswith("_"):
            raise Refusal("names that begin with '_' are not allowed")
        owner = self._value(node.value)
        if not isinstance(owner, dict) or type(owner) is dict:
            raise Refusal(f"a {type(owner).__name__} has no '.{node.attr}'")
        return owner[node.attr]

    def _subscript(self, node: ast.Subscript) -> Any:
        return self._value(node.value)[self._index(node.slice)]

    def _index(self, node: ast.expr) -> Any:
        if not isinstance(node, ast.Slice):
            return self._value(node)
        return slice(*(None if part is None else self._value(part) for part in (node.lower, node.upper, node.step)))

    def _binop(self, node: ast.BinOp) -> Any:
        return _binary(type(node.op), self._value(node.left), self._value(node.right))

    def _unaryop(self, node: ast.UnaryOp) -> Any:
        return _UNARY[type(node.op)](self._value(node.operand))

    def _boolop(self, node: ast.BoolOp) -> Any:
        value: Any = None
        for operand in node.values:
            value = self._value(operand)
            if bool(value) is isinstance(node.op, ast.Or):
                break
        return value

    def _compare(self, node: ast.Compare) -> bool:
        left = self._value(node.left)
        for kind, operand in zip(node.ops, node.comparators, strict=True):
            right = self._value(operand)
            if not _COMPARISONS[type(kind)](left, right):
                return False
            left = right
        return True

    def _ifexp(self, node: ast.IfExp) -> Any:
        return self._value(node.body if self._value(node.test) else node.orelse)

    def _list(self, node: ast.List) -> list[Any]:
        return [self._value(element) for element in node.elts]

    def _tuple(self, node: ast.Tuple) -> tuple[Any, ...]:
        return tuple(self._value(element) for element in node.elts)

    def _dict(self, node: ast.Dict) -> dict[Any, Any]:
        if None in node.keys:
            raise Refusal("'**' is not allowed in an expression")
        return {self._value(k): self._value(v) for k, v in zip(node.keys, node.values, strict=True) if k is not None}

    def _call(self, node: ast.Call) -> Any:
        function, owner = self._function(node.func)
        if any(keyword.arg is None for keyword in node.keywords):
            raise Refusal("'**' is not allowed in an expression")
        arguments = [*owner, *(self._argument(argument) for argument in node.args)]
        return function(*arguments, **{str(k.arg): self._argument(k.value) for k in node.keywords})

    def _argument(self, node: ast.expr) -> Any:
        """A value that a function may have: no namespace, of which `dict` would make one of functions."""
        value = self._value(node)
        if isinstance(value, self._namespace):
            raise Refusal(f"the namespace '{ast.unparse(node):.40}' is no argument")
        return value

    def _function(self, node: ast.expr) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """A function of the tables by its name, with the value of which it is a method."""
        if isinstance(node, ast.Name):
            for table in self._functions.values():
                if node.id in table:
                    return table[node.id], ()
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in self._functions:
            table = self._functions[node.value.id]
            if node.attr in table:
                return table[node.attr], ()
        elif isinstance(node, ast.Attribute):
            owner = self._value(node.value)
            for kind, methods in _METHODS.items():
                if isinstance(owner, kind) and not isinstance(owner, self._namespace) and node.attr in methods:
                    return methods[node.attr], (owner,)
        raise Refusal(f"'{ast.unparse(node):.40}' may not be called")
