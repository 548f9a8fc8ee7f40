"""Scripts in other words that are shorter: names that are used once, lists of which one item counts, imports."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..plugins.writing.source import WIDTH


def picked(script: str, place: Sequence[int]) -> tuple[str, str] | None:
    """A script whose last statement makes `value`, without that statement, and an entry of the value.

    Args:
        script: The script.
        place: Place of the entry; of a list that a comprehension makes, its item alone is worked out.

    Returns:
        The script, and the entry's expression; None where `value` comes in another way.
    """
    statements = _statements(script)
    if not statements:
        return None
    *before, last = statements
    if not isinstance(last, ast.Assign) or [ast.unparse(one) for one in last.targets] != ["value"]:
        return None
    answer = last.value
    if isinstance(answer, ast.Call) and ast.unparse(answer.func) == "np.array" and len(answer.args) == 1:
        answer = answer.args[0]
    columns = _columns(answer)
    if place and columns:
        answer, rest = columns
    generator = answer.generators[0] if isinstance(answer, ast.ListComp) and len(answer.generators) == 1 else None
    if place and isinstance(answer, ast.ListComp) and generator and isinstance(generator.target, ast.Name):
        item: ast.expr = ast.Subscript(generator.iter, ast.Constant(place[0]), ast.Load())
        if isinstance(generator.iter, ast.Name):
            before, item = _one_of(before, generator.iter.id, place[0], generator.target.id, item)
        answer = _substituted(answer.elt, {generator.target.id: item})
        place = place[1:]
        if columns:
            array = ast.Call(ast.parse("np.array", mode="eval").body, [answer], [])
            answer = ast.Subscript(array, ast.Tuple(rest, ast.Load()), ast.Load())
    return _text(before), _entry(answer, place)


def _columns(answer: ast.expr) -> tuple[ast.ListComp, list[ast.expr]] | None:
    """A comprehension in an array of which all items are taken, and what is taken of each."""
    if not isinstance(answer, ast.Subscript) or not isinstance(answer.slice, ast.Tuple):
        return None
    first, *rest = answer.slice.elts
    call = answer.value
    listed = call.args[0] if isinstance(call, ast.Call) and ast.unparse(call.func) == "np.array" else None
    return (listed, rest) if isinstance(listed, ast.ListComp) and ast.unparse(first) == ":" else None


def _one_of(
    statements: list[ast.stmt], name: str, place: int, own: str, item: ast.expr
) -> tuple[list[ast.stmt], ast.expr]:
    """Statements with one item of a list that nothing else uses, and what it is called."""
    for number, one in enumerate(statements):
        listed = isinstance(one, ast.Assign) and isinstance(one.value, ast.List) and ast.unparse(one.targets[0]) == name
        if not listed or any(name in _loaded(other) for other in statements):
            continue
        assert isinstance(one, ast.Assign) and isinstance(one.value, ast.List)
        chosen = one.value.elts[place]
        if isinstance(chosen, ast.Name | ast.Constant):
            return statements[:number] + statements[number + 1 :], chosen
        made = ast.Assign([ast.Name(own, ast.Store())], chosen, lineno=0)
        return [*statements[:number], made, *statements[number + 1 :]], ast.Name(own, ast.Load())
    return statements, item


def _entry(answer: ast.expr, place: Sequence[int]) -> str:
    text = ast.unparse(answer)
    if not place:
        return text
    index = f"[{', '.join(map(str, place))}]"
    if isinstance(answer, ast.List | ast.ListComp | ast.Tuple):
        return f"np.array({text}){index}"
    simple = isinstance(answer, ast.Call | ast.Attribute | ast.Subscript | ast.Name)
    return f"{text}{index}" if simple else f"({text}){index}"


def shortened(script: str) -> str:
    """A script whose plain imports share a line, with vectors and data in the one place that uses them."""
    statements = [_Units().visit(one) for one in _statements(script)]
    while (simpler := _inlined(statements)) is not None:
        statements = simpler
    return with_numpy(_text(_imported(statements)))


def with_numpy(script: str, *, always: bool = False) -> str:
    """A script that imports NumPy as np: where it names np, or `always`, and does not do so."""
    statements = _statements(script)
    aliases = [alias for one in statements if isinstance(one, ast.Import) for alias in one.names]
    bound = any((alias.asname or alias.name) == "np" for alias in aliases)
    if bound or not (always or any("np" in _loaded(one) for one in statements)):
        return script
    later = (one for one in statements if not isinstance(one, ast.ImportFrom) or one.module != "__future__")
    lines, first = script.split("\n"), next(later, None)
    place = len(lines) if first is None else first.lineno - 1
    return "\n".join([*lines[:place], "import numpy as np", *lines[place:]])


def still(script: str) -> str:
    """A script that sets nothing to zero: states are zero where nothing was set."""
    return _text([one for one in _statements(script) if not _sets_zero(one)])


def _sets_zero(one: ast.stmt) -> bool:
    if isinstance(one, ast.Assign) and isinstance(one.targets[0], ast.Tuple) and isinstance(one.value, ast.Tuple):
        parts = all(ast.unparse(target).endswith("[:]") for target in one.targets[0].elts)
        return parts and all(ast.unparse(value).startswith("np.zeros(") for value in one.value.elts)
    if not isinstance(one, ast.Expr) or not isinstance(one.value, ast.Call) or not one.value.args:
        return False
    name = ast.unparse(one.value.func).rpartition(".")[2]
    return name.lower().startswith("set") and ast.unparse(one.value.args[-1]).startswith("np.zeros(")


def _imported(statements: list[ast.stmt]) -> list[ast.stmt]:
    """Those that begin the script, and need nothing said between them, in one statement."""
    count = next((k for k, one in enumerate(statements) if not isinstance(one, ast.Import)), len(statements))
    if count < 2:
        return statements
    names = [alias for one in statements[:count] for alias in one.names]  # type: ignore[attr-defined]
    return [ast.Import(names), *statements[count:]]


def _inlined(statements: list[ast.stmt]) -> list[ast.stmt] | None:
    """The statements with a name less."""
    uses = Counter(name for one in statements for name in _loaded(one))
    stores = Counter(
        node.id
        for one in statements
        for node in ast.walk(one)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    )
    for number, one in enumerate(statements):
        for name, value in _assigned(one).items():
            later = [k for k in range(number + 1, len(statements)) if name in _loaded(statements[k])]
            if (
                uses[name] != 1
                or stores[name] != 1
                or not later
                or not _may_move(value, statements[number + 1 : later[0]])
            ):
                continue
            user = statements[later[0]]
            if isinstance(user, ast.FunctionDef | ast.ClassDef) or (_looped(user, name) and not _is_plain(value)):
                continue
            changed = _substituted(user, {name: value})
            if _height(changed) > _height(user):
                continue
            rest = _without(one, name)
            return [
                *statements[:number],
                *rest,
                *statements[number + 1 : later[0]],
                changed,
                *statements[later[0] + 1 :],
            ]
    return None


def _assigned(one: ast.stmt) -> dict[str, ast.expr]:
    """Names that a statement assigns, each a value of its own."""
    if not isinstance(one, ast.Assign) or len(one.targets) != 1:
        return {}
    target = one.targets[0]
    if isinstance(target, ast.Name):
        return {target.id: one.value}
    if isinstance(target, ast.Tuple) and isinstance(one.value, ast.Tuple):
        pairs = zip(target.elts, one.value.elts, strict=True)
        return {name.id: value for name, value in pairs if isinstance(name, ast.Name) and name.id != "value"}
    return {}


def _without(one: ast.stmt, name: str) -> list[ast.stmt]:
    left = {known: value for known, value in _assigned(one).items() if known != name}
    if not left:
        return []
    names: list[ast.expr] = [ast.Name(known, ast.Store()) for known in left]
    if len(left) == 1:
        return [ast.Assign(names, next(iter(left.values())), lineno=0)]
    return [ast.Assign([ast.Tuple(names, ast.Store())], ast.Tuple(list(left.values()), ast.Load()), lineno=0)]


def _is_plain(value: ast.expr) -> bool:
    """Whether a value is made of numbers and words alone."""
    if isinstance(value, ast.Subscript):
        return _is_plain(value.value) and _is_plain(value.slice)
    if isinstance(value, ast.Call):
        return ast.unparse(value.func) in ("np.array", "np.zeros", "np.eye", "np.diag") and all(
            map(_is_plain, value.args)
        )
    try:
        ast.literal_eval(value)
    except ValueError:
        return False
    return True


def _may_move(value: ast.expr, between: Sequence[ast.stmt]) -> bool:
    """Whether a value is the same after some statements: numbers, and data of a model, made where they are used."""
    if _is_plain(value):
        return not isinstance(value, ast.Constant)
    if not isinstance(value, ast.Call) or not ast.unparse(value.func).endswith((".createData", ".MjData")):
        return False
    return all(_is_plain(part) for one in between for part in _assigned(one).values()) and all(map(_assigned, between))


def _height(one: ast.stmt) -> int:
    """Lines that the first line of a statement takes."""
    return (len(_line(one).split("\n")[0]) - 1) // WIDTH


def _looped(one: ast.stmt, name: str) -> bool:
    parts = (ast.For, ast.ListComp, ast.GeneratorExp, ast.DictComp, ast.Lambda)
    return any(isinstance(node, parts) and name in _loaded(node) for node in ast.walk(one))


def _loaded(one: ast.AST) -> list[str]:
    return [node.id for node in ast.walk(one) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)]


class _Units(ast.NodeTransformer):
    """Unit vectors, zeros and diagonal matrices by their names."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:  # noqa: N802  (ast's name)
        """One list in place of the sum of two."""
        if isinstance(node.op, ast.Add) and isinstance(node.left, ast.List) and isinstance(node.right, ast.List):
            return self.visit_List(ast.List([*node.left.elts, *node.right.elts], ast.Load()))
        self.generic_visit(node)
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:  # noqa: N802  (ast's name)
        """An array by its name."""
        if ast.unparse(node.func) == "np.diag":
            return node
        self.generic_visit(node)
        first = node.args[0] if len(node.args) == 1 and not node.keywords else None
        named = first is not None and ast.unparse(first).startswith(("np.eye(", "np.diag(", "np.zeros("))
        return first if named and first is not None and ast.unparse(node.func) == "np.array" else node

    def visit_List(self, node: ast.List) -> ast.expr:  # noqa: N802  (ast's name)
        """A list of numbers by its name."""
        name = _named(node) if _is_plain(node) else None
        if name is None:
            self.generic_visit(node)
            return node
        made: ast.expr = ast.parse(name, mode="eval").body
        return made


def _named(node: ast.List) -> str | None:
    """What NumPy calls a list of numbers that is mostly zeros."""
    try:
        values = np.array(ast.literal_eval(node), dtype=float)
    except (ValueError, TypeError):
        return None
    n = len(values)
    if values.ndim == 1 and n > 2 and not values.any():
        return f"np.zeros({n})"
    if values.ndim == 1 and n > 1 and sorted(values) == [0.0] * (n - 1) + [1.0]:
        return f"np.eye({n})[{int(values.argmax())}]"
    if values.ndim == 2 and values.shape == (n, n) and n > 1 and np.array_equal(values, np.diag(values.diagonal())):
        unit = np.array_equal(values, np.eye(n))
        return f"np.eye({n})" if unit else f"np.diag({values.diagonal().tolist()!r})"
    return None


class _Substitution(ast.NodeTransformer):
    def __init__(self, values: dict[str, ast.expr]) -> None:
        self._values = values

    def visit_Name(self, node: ast.Name) -> ast.expr:  # noqa: N802  (ast's name)
        """The value of a name that is read."""
        return self._values[node.id] if isinstance(node.ctx, ast.Load) and node.id in self._values else node


def _substituted(node: Any, values: dict[str, ast.expr]) -> Any:
    text = ast.unparse(node)
    fresh = ast.parse(text, mode="eval").body if isinstance(node, ast.expr) else ast.parse(text).body[0]
    return _Substitution(values).visit(fresh)


def _statements(script: str) -> list[ast.stmt]:
    return list(ast.parse(script).body)


def _text(statements: Sequence[ast.stmt]) -> str:
    return "\n".join(map(_line, statements))


def _line(one: ast.stmt) -> str:
    """A statement; where several names are assigned, their values without parentheses."""
    if isinstance(one, ast.Assign) and isinstance(one.value, ast.Tuple) and len(one.value.elts) > 1:
        return f"{', '.join(map(_name, one.targets))} = {', '.join(map(ast.unparse, one.value.elts))}"
    return ast.unparse(one)


def _name(target: ast.expr) -> str:
    return ", ".join(map(ast.unparse, target.elts)) if isinstance(target, ast.Tuple) else ast.unparse(target)
