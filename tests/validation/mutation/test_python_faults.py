"""Faults in Python are planted in what computes, and leave a text that is Python still."""

from __future__ import annotations

import ast

import pytest

from validation.mutation.fault import COMPARISON, CONSTANT, DROPPED, FRAME, INDEX, OPERATOR, SIGN, SWAPPED
from validation.mutation.python_faults import python_faults


def planted(text: str) -> dict[str, set[str]]:
    """Kind -> texts with one fault."""
    texts: dict[str, set[str]] = {}
    for fault in python_faults("m.py", text):
        texts.setdefault(fault.kind, set()).add(fault.planted(text))
    return texts


@pytest.mark.parametrize(
    ("text", "kind", "faulty"),
    [
        ("a = b + c", OPERATOR, "a = b - c"),
        ("a = g.add(b, c)", OPERATOR, "a = g.sub(b, c)"),
        ('a = g.call("sin", x)', OPERATOR, 'a = g.call("cos", x)'),
        ("a = -b", SIGN, "a = b"),
        ("a = g.mul(b, c)", SIGN, "a = g.mul(b, -c)"),
        ("a = q[0]", INDEX, "a = q[1]"),
        ("a = q[-4:]", INDEX, "a = q[-3:]"),
        ("a = p.x", INDEX, "a = p.y"),
        ("a = R.T @ b", FRAME, "a = R @ b"),
        ("a = R @ b", FRAME, "a = (R).T @ b"),
        ("a = R_WL.times(b)", FRAME, "a = R_WL.T.times(b)"),
        ("def f(R_AB, R_AC):\n    return R_AB", FRAME, "def f(R_AB, R_AC):\n    return R_AC"),
        ("a = b * c + d", DROPPED, "a = (d)"),
        ("a += b", DROPPED, "pass"),
        ("a = b < c", COMPARISON, "a = b <= c"),
        ("a = b is not c", COMPARISON, "a = b is c"),
        ("a = (b) and (c)", COMPARISON, "a = (b) or (c)"),
        ("a = 0.5 * b", CONSTANT, "a = 1.0 * b"),
        ("f(a, b)", SWAPPED, "f(b, a)"),
    ],
)
def test_each_kind_of_fault_is_planted(text: str, kind: str, faulty: str) -> None:
    assert faulty in planted(text)[kind]


@pytest.mark.parametrize(
    "text",
    [
        'raise ValueError("a" + str(1 + b))',
        "assert a < b + 1",
        "def f(a: int = None) -> dict[str, int]: ...",
        "Problem(name, a + b)",
        "p.named(f'p[{1 + 1}]')",
        "if TYPE_CHECKING:\n    a = 1 + 2",
    ],
)
def test_words_types_and_assertions_are_left_alone(text: str) -> None:
    assert not planted(text)


def test_every_fault_of_a_file_leaves_python() -> None:
    text = open(ast.__file__, encoding="utf-8").read()[:20000].rpartition("\nclass ")[0]
    faults = python_faults("ast.py", text)
    assert len({fault.id for fault in faults}) == len(faults) > 50
    for fault in faults:
        ast.parse(fault.planted(text))


def test_a_fault_is_not_planted_in_another_text() -> None:
    (fault,) = python_faults("m.py", "a = -b")
    with pytest.raises(ValueError, match="the file has changed"):
        fault.planted("a = b")
