"""Data as YAML: whatever it holds is read back as it was, on one line and on several."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symofros.studio.editor.editing.data_edits import same
from symofros.studio.editor.editing.yaml_rendering import WIDTH, Typed, block, inline, scalar
from symofros.studio.editor.editing.yaml_spans import YamlText
from tests.studio.editor.texts import KEYS, TROUBLE, values

keys = st.sampled_from([*KEYS, *(text for text in TROUBLE if text != "<<")]) | st.text(min_size=1, max_size=8)


@settings(max_examples=30)
@given(values)
def test_a_value_on_one_line_is_read_back(value: Any) -> None:
    for text, whole in (
        (f"a: {inline(value, flow=False)}\n", value),
        (f"a: [1, {inline(value)}, 2]\n", [1, value, 2]),
        (f"a: {{b: {inline(value)}}}\n", {"b": value}),
    ):
        assert text.count("\n") == 1
        assert same(YamlText(text).root.plain()["a"], whole)


@pytest.mark.slow
@settings(max_examples=75)
@given(st.dictionaries(keys, values, min_size=1, max_size=5))
def test_a_mapping_on_lines_is_read_back(value: dict[str, Any]) -> None:
    try:
        value = {key.encode().decode(): item for key, item in value.items() if len(key) < 100}
    except UnicodeEncodeError:
        return
    if value:
        assert same(YamlText("\n".join([*block(value, ("x",), 0), ""])).root.plain(), value)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1e-5, "1e-05"),
        (float("inf"), ".inf"),
        (10**16, "1e+16"),
        (True, "true"),
        (None, "null"),
        ("L1/2 + 0.1*cos(q1)", "L1/2 + 0.1*cos(q1)"),
        ("-L/2", "-L/2"),
        ("1", "'1'"),
        ("true", "'true'"),
        ("it's: so", "'it''s: so'"),
        ("a\nb", '"a\\nb"'),
        (Typed("8.0e-4"), "8.0e-4"),
    ],
)
def test_scalars_are_written_as_people_write_them(value: Any, text: str) -> None:
    assert scalar(value, flow=False) == text


def test_a_text_keeps_its_quotes_and_a_key_is_a_name_whatever_it_looks_like() -> None:
    assert scalar("cm", flow=False, quote="'") == "'cm'" and scalar("cm", flow=False, quote='"') == '"cm"'
    assert scalar("1", flow=False, key=True) == "1" and scalar("on", flow=True, key=True) == "on"
    assert scalar("a, b", flow=False) == "a, b" and scalar("a, b", flow=True) == "'a, b'"


def test_long_entries_are_written_on_separate_lines() -> None:
    long = {f"entry{i}": "x" * 20 for i in range(6)}
    body = {"joint": {"kind": "fixed"}, "frames": long}
    lines = block({"bodies": {"a": body}}, (), 0)
    assert lines[:5] == ["bodies:", "  a:", "    joint: {kind: fixed}", "    frames:", f"      entry0: {'x' * 20}"]
    assert max(map(len, lines)) <= WIDTH
