"""The form of messages: what, found, rule, remedy; suggestions; the bound on their number."""

from __future__ import annotations

import ast
import builtins
import pickle
import re
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest

import symofros as sf
from symofros.errors import MAX_PROBLEMS, did_you_mean, first_of, near_name

# Plain texts become problems of one part in two places: where errors are defined, and where any exception is shown.
_PLAIN = {"errors.py", "worker.py"}
SOURCES = sorted(path for path in Path(sf.__file__).parent.rglob("*.py") if path.name not in _PLAIN)


# What takes the parts of a problem: errors of this package, but for those that are made of other things.
_STATED = re.compile(r"(rules\.)?(Problem|YamlFault|[A-Z]\w+Error(\.of_extra)?)")
_OWN = {"AlgebraicLoopError", "ConflictError", "ConsentError", "EngagedApartError", "ExpressionError", "LineError"}
_OTHERS = {"PydanticCustomError", *_OWN, *dir(builtins)}


def statements() -> Iterator[tuple[str, list[ast.expr]]]:
    """Every place in the source that states a problem, with its arguments; an extra stands for its remedy."""
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call) or len(node.args) < 2 or (name := ast.unparse(node.func)) in _OTHERS:
                continue
            if _STATED.fullmatch(name):
                yield f"{path.name}:{node.lineno}", node.args


def test_every_problem_has_its_four_parts() -> None:
    stated = list(statements())
    assert len(stated) > 600
    for place, parts in stated:
        assert len(parts) >= 4, f"{place}: what, found, rule, remedy"
        empty = [i for i, part in enumerate(parts) if isinstance(part, ast.Constant) and part.value == ""]
        assert empty in ([], [4]), f"{place}: an empty part"


@pytest.mark.parametrize(
    ("name", "known", "remedy"),
    [
        ("tpi", ["base", "tip"], "did you mean 'tip'?"),
        ("M", ["L", "m"], "did you mean 'm'?"),
        ("x", ["first", "second"], "use one of: first, second"),
        ("x", [], ""),
        ("zz", [f"name{i}" for i in range(20)], "use one of: " + ", ".join(f"name{i}" for i in range(12)) + ", …"),
    ],
)
def test_misspelt_names_get_a_suggestion(name: str, known: list[str], remedy: str) -> None:
    assert did_you_mean(name, known) == remedy
    assert near_name(name, known) == (remedy if remedy.startswith("did") else "")


def test_problems_beyond_the_limit_are_not_formed() -> None:
    made = count()
    listed = first_of(sf.Problem(f"fault {next(made)}", "f", "r", "m", f"a.yaml:{i}") for i in range(10**9))
    assert len(listed) == MAX_PROBLEMS + 1 and "more faults" in listed[-1].what
    assert next(made) == MAX_PROBLEMS + 1
    assert first_of(listed[:3]) == listed[:3]


def test_errors_take_the_parts_of_a_problem() -> None:
    error = sf.ShapeError("w", "f", "r", "m", "a.yaml:3")
    assert error.problems == sf.ShapeError(sf.Problem("w", "f", "r", "m", "a.yaml:3")).problems
    assert sf.SymofrosError("w").problem == sf.Problem("w")


def test_errors_cross_process_borders() -> None:
    error = sf.DescriptionError([sf.Problem("w", "f", "r", "m", "a.yaml:3"), sf.Problem("x")])
    again = pickle.loads(pickle.dumps(error))
    assert again.problems == error.problems
    assert str(again) == "a.yaml:3: w\n  found:  f\n  rule:   r\n  remedy: m\nx"
