"""One field by itself: whether its text is a formula, what it depends on, its value, its place's own rules."""

from __future__ import annotations

from pathlib import Path as File
from typing import Any

from symofros.description import ExpressionError, as_value, parse, symbols
from symofros.description.yaml import YamlFault, scalar_of
from symofros.errors import Problem
from symofros.expr import Expression, evaluate
from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.document.document import refuse_text
from symofros.studio.editor.document.meaning import Analysis
from symofros.studio.editor.editing.data_edits import Edit, EditError, Path, same
from symofros.studio.editor.editing.yaml_edits import apply

Json = dict[str, Any]


def check_field(file: File, text: str, now: Analysis, path: Path, typed: Any, draft: Edit | None = None) -> Json:
    """Check a formula in a field: its names and value, or its error.

    Args:
        file: The document's.
        text: The document's text.
        now: Analysis of the text.
        path: Path of the field; it need not exist yet. Empty: the formula alone is checked.
        typed: Text that was typed.
        draft: Edit that puts the entry which is being filled in into the document, with the field.

    Returns:
        `ok`, `names`, `value` where parameters suffice for one, otherwise `error` with `column` (from 1; 0: the
        whole).
    """
    refuse_text(typed)
    try:
        formula = parse(typed)
    except ExpressionError as error:
        return {"ok": False, "names": [], "error": _error(error.problem_of("formula"), error.position + 1)}
    value = as_value(formula)
    names = sorted(symbols(value))
    answer: Json = {"ok": True, "names": names}
    refused = _in_place(file, text, now, path, typed, draft) if path else None
    if refused is not None:
        at = next((typed.find(name) + 1 for name in names if f"'{name}'" in refused["object"]), 0)
        shown = {"found": refused["object"], "rule": refused["rule"], "remedy": refused["remedy"], "column": at}
        return {"ok": False, "names": names, "error": shown}
    known = {item["name"]: item["number"] for item in now.parameters if item["number"] is not None}
    if known.keys() >= set(names):
        try:
            answer["value"] = evaluate(value if isinstance(value, Expression) else float(value), known)
        except ArithmeticError as error:
            problem = Problem(
                "formula",
                f"{str(error)[:100]}",
                "a formula has a value at the parameters' defaults",
                "mind divisions by zero and domains of functions",
            )
            return {"ok": False, "names": names, "error": _error(problem, 0)}
    return answer


def _in_place(file: File, text: str, now: Analysis, path: Path, typed: str, draft: Edit | None) -> Json | None:
    """The first problem of the field in the document that has the text there."""
    wanted = scalar_of(typed.strip())
    if now.readable and same(_present(now.data, path), wanted):
        tried = now  # A window asks for each of its fields when it opens; reading takes half a second.
    else:
        try:
            tried = analyse(file, apply(text, draft or Edit("set", path, wanted)))
        except (EditError, YamlFault):
            return None  # The field is not in this document: its formula alone can be judged.
    here = list(path)
    return next((problem for problem in tried.problems if problem["path"] == here), None)


def _present(data: Any, path: Path) -> Any:
    """The value at a path; None if there is none."""
    for step in path:
        inside = isinstance(data, dict) or (isinstance(data, list) and isinstance(step, int) and 0 <= step < len(data))
        if not inside or (isinstance(data, dict) and step not in data):
            return None
        data = data[step]
    return data


def _error(problem: Problem, column: int) -> Json:
    return {
        "found": f"{problem.what}: {problem.found}",
        "rule": problem.rule,
        "remedy": problem.remedy,
        "column": column,
    }
