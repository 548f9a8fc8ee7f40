"""Faults are planted in what computes, of Python and of C; words, types, comments, declarations stay as they are."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from validation.mutation.c_faults import c_faults
from validation.mutation.python_faults import python_faults

FRAMES = {".py": ("", ""), ".c": ("void f(void) {\n", "\n}\n")}
CASES = [
    [field.replace("\\n", "\n") for field in line.split(" | ")]
    for line in Path(__file__).with_name("faults.txt").read_text().splitlines()[1:]
]


def planted(suffix: str, body: str) -> dict[str, set[str]]:
    """Kind -> texts with one fault."""
    head, tail = FRAMES[suffix]
    text = head + body + tail
    bodies: dict[str, set[str]] = {}
    for fault in (python_faults if suffix == ".py" else c_faults)(f"m{suffix}", text):
        bodies.setdefault(fault.kind, set()).add(fault.planted(text)[len(head) : len(fault.planted(text)) - len(tail)])
    return bodies


@pytest.mark.parametrize(("suffix", "text", "kind", "faulty"), [case for case in CASES if len(case) == 4])
def test_each_kind_of_fault_is_planted(suffix: str, text: str, kind: str, faulty: str) -> None:
    assert faulty in planted(suffix, text)[kind]


@pytest.mark.parametrize(("suffix", "text"), [case for case in CASES if len(case) == 2])
def test_faults_are_not_planted_in_inactive_text(suffix: str, text: str) -> None:
    assert not planted(suffix, text)


def test_every_fault_of_a_file_leaves_python_and_is_planted_in_no_other_text() -> None:
    text = open(ast.__file__, encoding="utf-8").read()[:20000].rpartition("\nclass ")[0]
    faults = python_faults("ast.py", text)
    assert len({fault.id for fault in faults}) == len(faults) > 50
    for fault in faults:
        ast.parse(fault.planted(text))
    with pytest.raises(ValueError, match="the file has changed"):
        faults[0].planted("a = b")
