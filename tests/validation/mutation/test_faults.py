"""Faults are planted in what computes, of Python and of C; words, types, comments, declarations stay as they are."""

from __future__ import annotations

import ast

import pytest

from validation.mutation.c_faults import c_faults
from validation.mutation.fault import COMPARISON, CONSTANT, DROPPED, FRAME, INDEX, OPERATOR, SIGN, SWAPPED
from validation.mutation.python_faults import python_faults

FRAMES = {".py": ("", ""), ".c": ("void f(void) {\n", "\n}\n")}


def planted(suffix: str, body: str) -> dict[str, set[str]]:
    """Kind -> texts with one fault."""
    head, tail = FRAMES[suffix]
    text = head + body + tail
    bodies: dict[str, set[str]] = {}
    for fault in (python_faults if suffix == ".py" else c_faults)(f"m{suffix}", text):
        bodies.setdefault(fault.kind, set()).add(fault.planted(text)[len(head) : len(fault.planted(text)) - len(tail)])
    return bodies


@pytest.mark.parametrize(
    ("suffix", "text", "kind", "faulty"),
    [
        (".py", "a = b + c", OPERATOR, "a = b - c"),
        (".py", "a = g.add(b, c)", OPERATOR, "a = g.sub(b, c)"),
        (".py", 'a = g.call("sin", x)', OPERATOR, 'a = g.call("cos", x)'),
        (".py", "a = -b", SIGN, "a = b"),
        (".py", "a = g.mul(b, c)", SIGN, "a = g.mul(b, -c)"),
        (".py", "a = q[-4:]", INDEX, "a = q[-3:]"),
        (".py", "a = p.x", INDEX, "a = p.y"),
        (".py", "a = R.T @ b", FRAME, "a = R @ b"),
        (".py", "a = R @ b", FRAME, "a = (R).T @ b"),
        (".py", "a = R_WL.times(b)", FRAME, "a = R_WL.T.times(b)"),
        (".py", "def f(R_AB, R_AC):\n    return R_AB", FRAME, "def f(R_AB, R_AC):\n    return R_AC"),
        (".py", "a = b * c + d", DROPPED, "a = (d)"),
        (".py", "a += b", DROPPED, "pass"),
        (".py", "a = b < c", COMPARISON, "a = b <= c"),
        (".py", "a = b is not c", COMPARISON, "a = b is c"),
        (".py", "a = (b) and (c)", COMPARISON, "a = (b) or (c)"),
        (".py", "a = 0.5 * b", CONSTANT, "a = 1.0 * b"),
        (".py", "f(a, b)", SWAPPED, "f(b, a)"),
        (".c", "a += b;", OPERATOR, "a -= b;"),
        (".c", "a = b * c;", OPERATOR, "a = b / c;"),
        (".c", "a = f(-b);", SIGN, "a = f(b);"),
        (".c", "a = b[1];", INDEX, "a = b[0];"),
        (".c", "a = b + c * d[i];", DROPPED, "a = b ;"),
        (".c", "f(a);", DROPPED, "(void)0;"),
        (".c", "if (a <= b) return;", COMPARISON, "if (a < b) return;"),
        (".c", "if (a && b) return;", COMPARISON, "if (a || b) return;"),
        (".c", "a = 0.5f;", CONSTANT, "a = 1.0f;"),
        (".c", "a = i + 1;", CONSTANT, "a = i + 2;"),
        (".c", "g(a, b[0], c);", SWAPPED, "g(b[0], a, c);"),
    ],
)
def test_each_kind_of_fault_is_planted(suffix: str, text: str, kind: str, faulty: str) -> None:
    assert faulty in planted(suffix, text)[kind]


@pytest.mark.parametrize(
    ("suffix", "text"),
    [
        (".py", 'raise ValueError("a" + str(1 + b))'),
        (".py", "assert a < b + 1"),
        (".py", "def f(a: int = None) -> dict[str, int]: ..."),
        (".py", "Problem(name, a + b)"),
        (".py", "p.named(f'p[{1 + 1}]')"),
        (".py", "if TYPE_CHECKING:\n    a = 1 + 2"),
        (".c", "/* a + 1 < b */ ;"),
        (".c", 's = "1 + 1";'),
        (".c", "double *p, **q;"),
        (".c", "\n#if 1 + 1 > 2\n#endif\n;"),
        (".c", "\n#ifdef _WIN32\na = b + 1;\n#endif\n;"),
    ],
)
def test_what_computes_nothing_is_left_alone(suffix: str, text: str) -> None:
    assert not planted(suffix, text)


def test_every_fault_of_a_file_leaves_python_and_is_planted_in_no_other_text() -> None:
    text = open(ast.__file__, encoding="utf-8").read()[:20000].rpartition("\nclass ")[0]
    faults = python_faults("ast.py", text)
    assert len({fault.id for fault in faults}) == len(faults) > 50
    for fault in faults:
        ast.parse(fault.planted(text))
    with pytest.raises(ValueError, match="the file has changed"):
        faults[0].planted("a = b")
