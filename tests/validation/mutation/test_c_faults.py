"""Faults in C are planted in expressions and calls; comments, strings, declarations and the preprocessor stay."""

from __future__ import annotations

import pytest

from validation.mutation.c_faults import c_faults
from validation.mutation.fault import COMPARISON, CONSTANT, DROPPED, INDEX, OPERATOR, SIGN, SWAPPED


def planted(body: str) -> dict[str, set[str]]:
    """Kind -> bodies of a function with one fault."""
    head, tail = "void f(void) {\n", "\n}\n"
    text = head + body + tail
    bodies: dict[str, set[str]] = {}
    for fault in c_faults("m.c", text):
        bodies.setdefault(fault.kind, set()).add(fault.planted(text)[len(head) : -len(tail)])
    return bodies


@pytest.mark.parametrize(
    ("body", "kind", "faulty"),
    [
        ("a = b + c;", OPERATOR, "a = b - c;"),
        ("a += b;", OPERATOR, "a -= b;"),
        ("a = b * c;", OPERATOR, "a = b / c;"),
        ("a = f(-b);", SIGN, "a = f(b);"),
        ("a = b[1];", INDEX, "a = b[0];"),
        ("a = b + c * d[i];", DROPPED, "a = b ;"),
        ("f(a);", DROPPED, "(void)0;"),
        ("if (a <= b) return;", COMPARISON, "if (a < b) return;"),
        ("if (a && b) return;", COMPARISON, "if (a || b) return;"),
        ("a = 0.5f;", CONSTANT, "a = 1.0f;"),
        ("a = i + 1;", CONSTANT, "a = i + 2;"),
        ("g(a, b[0], c);", SWAPPED, "g(b[0], a, c);"),
    ],
)
def test_each_kind_of_fault_is_planted(body: str, kind: str, faulty: str) -> None:
    assert faulty in planted(body)[kind]


@pytest.mark.parametrize(
    "body",
    [
        "/* a + 1 < b */ ;",
        's = "1 + 1";',
        "double *p, **q;",
        "\n#if 1 + 1 > 2\n#endif\n;",
        "\n#ifdef _WIN32\na = b + 1;\n#endif\n;",
    ],
)
def test_what_computes_nothing_is_left_alone(body: str) -> None:
    assert not planted(body)
