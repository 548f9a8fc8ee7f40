"""Scripts without what the case at hand does not use: definitions of an engine's preamble that nothing calls."""

from __future__ import annotations

import ast
from collections.abc import Iterator


def pruned(script: str) -> str:
    """A script without functions, imports and constants that no other statement of it names.

    Statements that might do something stay, whether their result is named again or not.

    Args:
        script: Text of a module, the statements of whose top level begin on lines of their own.

    Returns:
        The text of the statements that are left, as it was.
    """
    statements = ast.parse(script).body
    names = {id(statement): set(_named(statement)) for statement in statements}
    left = list(statements)
    while True:
        kept = [
            statement
            for statement in left
            if (bound := _bound(statement)) is None
            or any(bound & names[id(other)] for other in left if other is not statement)
        ]
        if len(kept) == len(left):
            break
        left = kept
    gone = {id(statement) for statement in statements} - {id(statement) for statement in left}
    dropped = {
        number
        for statement in statements
        if id(statement) in gone
        for number in range(statement.lineno, (statement.end_lineno or statement.lineno) + 1)
    }
    shared = {statement.lineno for statement in left} & dropped
    assert not shared, f"statements share line {min(shared)}"
    lines = script.splitlines(keepends=True)
    return "".join(line for number, line in enumerate(lines, 1) if number not in dropped)


def _named(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
            yield node.id


def _bound(statement: ast.stmt) -> set[str] | None:
    """Names that a statement binds and does no more; None: it may do more."""
    if isinstance(statement, ast.FunctionDef):
        return None if statement.decorator_list else {statement.name}
    if isinstance(statement, ast.Import):
        return {(alias.asname or alias.name).partition(".")[0] for alias in statement.names}
    if isinstance(statement, ast.ImportFrom):
        bound = {alias.asname or alias.name for alias in statement.names}
        # What "*" binds shows when it runs, and what __future__ does is no name.
        return None if "*" in bound or statement.module == "__future__" else bound
    if isinstance(statement, ast.Assign) and _is_constant(statement.value):
        targets = [target.id for target in statement.targets if isinstance(target, ast.Name)]
        return set(targets) if len(targets) == len(statement.targets) else None
    return None


def _is_constant(value: ast.expr) -> bool:
    try:
        ast.literal_eval(value)
    except ValueError:
        call = isinstance(value, ast.Call) and ast.unparse(value.func) == "np.array" and not value.keywords
        return call and all(_is_constant(argument) for argument in value.args)  # type: ignore[attr-defined]
    return True
