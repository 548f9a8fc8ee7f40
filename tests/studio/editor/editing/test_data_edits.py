"""Edits of plain data, which edits of text are measured by."""

from __future__ import annotations

from typing import Any

import pytest

from symofros.studio.editor.editing.data_edits import Edit, edited, same

BODIES: dict[str, Any] = {"a": {"x": [1, 2, 3]}, "b": None}
DATA = {"symofros": 1, "bodies": BODIES}


@pytest.mark.parametrize(
    ("edit", "expected"),
    [
        (Edit("set", ("bodies", "a", "x", 1), 5), {"symofros": 1, "bodies": {"a": {"x": [1, 5, 3]}, "b": None}}),
        (Edit("set", ("bodies", "b", "y", "z"), 5), {**DATA, "bodies": {**BODIES, "b": {"y": {"z": 5}}}}),
        (Edit("set", ("inputs", "f"), None), {"symofros": 1, "inputs": {"f": None}, "bodies": BODIES}),
        (Edit("remove", ("bodies", "a")), {"symofros": 1, "bodies": {"b": None}}),
        (Edit("remove", ("bodies", "a", "x", 0)), {"symofros": 1, "bodies": {"a": {"x": [2, 3]}, "b": None}}),
        (Edit("insert", ("bodies",), 1, "c", 0), {"symofros": 1, "bodies": {"c": 1, **BODIES}}),
        (Edit("insert", ("bodies", "a", "x"), 4), {"symofros": 1, "bodies": {"a": {"x": [1, 2, 3, 4]}, "b": None}}),
        (Edit("insert", ("bodies", "b"), 4, "k"), {"symofros": 1, "bodies": {"a": {"x": [1, 2, 3]}, "b": {"k": 4}}}),
        (Edit("rename", ("bodies", "a"), key="c"), {"symofros": 1, "bodies": {"c": {"x": [1, 2, 3]}, "b": None}}),
        (Edit("move", ("bodies", "b"), index=0), {"symofros": 1, "bodies": {"b": None, "a": {"x": [1, 2, 3]}}}),
        (Edit("move", ("bodies", "a", "x", 0)), {"symofros": 1, "bodies": {"a": {"x": [2, 3, 1]}, "b": None}}),
        (Edit("set", (), 3), 3),
    ],
)
def test_edits_change_a_copy_of_the_data(edit: Edit, expected: Any) -> None:
    assert same(edited(DATA, edit), expected)
    assert same(DATA, {"symofros": 1, "bodies": {"a": {"x": [1, 2, 3]}, "b": None}})


@pytest.mark.parametrize(
    ("a", "b", "equal"),
    [
        *((1, 1.0, True), (1, True, False), (0, False, False), (1, "1", False), (None, False, False)),
        (float("nan"), float("nan"), True),
        ({"a": 1, "b": 2}, {"b": 2, "a": 1}, False),
        ([1, [2]], [1, [2.0]], True),
        ({}, [], False),
    ],
)
def test_data_values_are_compared_by_type_and_content(a: Any, b: Any, equal: bool) -> None:
    assert same(a, b) is equal
