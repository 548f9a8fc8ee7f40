"""Formulas: the grammar, and what a hostile file may try."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.description.parser import _OTHERWISE, MAX_DEPTH, MAX_LENGTH, ExpressionError, parse
from symofros.expr.expression import Expression, evaluate

NAMES = {"a": 0.7, "b": -1.3, "c": 2.1}


@st.composite
def expressions(draw: st.DrawFn, depth: int = 4) -> Expression:
    inner = [] if depth == 0 else ["add", "sub", "mul", "neg", "pow", "sin", "max"]
    kinds = ["number", "symbol", *inner]
    kind = draw(st.sampled_from(kinds))
    if kind == "number":
        return Expression("number", number=draw(st.floats(0, 1e6, allow_nan=False)))
    if kind == "symbol":
        return Expression("symbol", name=draw(st.sampled_from(sorted(NAMES))))
    if kind == "pow":
        exponent = Expression("number", number=float(draw(st.integers(0, 3))))
        return Expression("pow", (draw(expressions(depth=depth - 1)), exponent))
    size = 1 if kind in ("neg", "sin") else 2
    return Expression(kind, tuple(draw(expressions(depth=depth - 1)) for _ in range(size)))


@given(expressions())
def test_text_round_trips(expression: Expression) -> None:
    """What is printed reads back as the same value, whatever needs parentheses."""
    again = parse(str(expression))
    assert evaluate(again, NAMES) == evaluate(expression, NAMES)
    assert str(parse(str(again))) == str(again)


def test_expressions_too_long_or_too_deep_are_refused() -> None:
    with pytest.raises(ExpressionError, match=f"longer than {MAX_LENGTH}"):
        parse("1" * (MAX_LENGTH + 1))
    with pytest.raises(ExpressionError, match=f"deeper than {MAX_DEPTH}"):
        parse("(" * (MAX_DEPTH + 1) + "1" + ")" * (MAX_DEPTH + 1))
    assert evaluate(parse("1" + "+1" * 200), {}) == 201


@given(st.text(max_size=60))
def test_random_text_never_crashes(text: str) -> None:
    """Any text is a formula, or is refused as a description's fault where a formula is expected."""
    try:
        value = sf.formula(text)
    except sf.DescriptionError as error:
        problem = error.problems[0]
        assert problem.found and problem.rule and problem.remedy
    else:
        assert isinstance(value, float) or value.symbols() is not None


@pytest.mark.parametrize("written", sorted(set(_OTHERWISE.values())))
def test_names_of_other_functions_are_parsed(written: str) -> None:
    assert parse(written).args
