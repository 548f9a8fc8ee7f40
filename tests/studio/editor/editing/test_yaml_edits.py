"""Edits of text: they mean what the same edits of plain data mean, and change nothing else."""

from __future__ import annotations

from functools import reduce
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from symofros.studio.editor.editing.data_edits import Edit, EditError, edited, same
from symofros.studio.editor.editing.yaml_edits import apply, trace
from symofros.studio.editor.editing.yaml_spans import YamlText
from tests.studio.editor.texts import DATA, KEYS, ODD, PATHS, TEXTS, at, values


@st.composite
def cases(draw: Any) -> tuple[str, Edit]:
    """A text, and an edit of it that makes sense."""
    name = draw(st.sampled_from(["odd", "crlf", "open end"]) | st.sampled_from(sorted(TEXTS)))
    text, data, where = TEXTS[name], DATA[name], PATHS[name]
    op = draw(st.sampled_from(["set", "set", "add", "insert", "remove", "rename", "move"]))
    if op == "insert":
        path = draw(st.sampled_from([p for p in where if isinstance(at(data, p), (dict, list))]))
        owner = at(data, path)
        index = draw(st.none() | st.integers(0, len(owner)))
        key = draw(st.sampled_from([k for k in KEYS if k not in owner])) if isinstance(owner, dict) else ""
        return text, Edit("insert", path, draw(values), key, index)
    if op == "add":
        path = draw(st.sampled_from([p for p in where if isinstance(at(data, p), dict)]))
        deeper = draw(st.sampled_from([(), ("deep",), ("deep", "deeper")]))
        return text, Edit("set", (*path, "added", *deeper), draw(values))
    if op in ("rename", "move"):
        path = draw(st.sampled_from([p for p in where if op == "move" or isinstance(p[-1], str)]))
        owner = at(data, path[:-1])
        key = draw(st.sampled_from([k for k in KEYS if k not in owner]))
        return text, Edit(op, path, key=key, index=draw(st.integers(0, len(owner) - 1)))
    path = draw(st.sampled_from(where))
    return text, Edit(op, path, draw(values))


def lines_around(text: str, edit: Edit) -> tuple[str, str]:
    """The text before and after all that an edit may touch."""
    source = YamlText(text)
    path = edit.path
    while source.node(path) is None:
        path = path[:-1]
    # An entry's own lines; of a collection that gets one more, or another order, or none at all, its owner's.
    if edit.op == "move" or (edit.op == "remove" and len(at(source.root.plain(), path[:-1])) == 1):
        path = path[:-1]
    while path:
        owner = source.node(path[:-1])
        assert owner is not None
        if owner.style == "block":
            place = list(owner.value).index(path[-1]) if isinstance(owner.value, dict) else int(path[-1])
            first, last = source.lines_of(owner, place)
            return text[: source.line_start(first)], text[source.line_end(last - 1) :]
        path = path[:-1]
    return "", ""


@settings(max_examples=25)
@given(cases())
def test_an_edit_of_text_is_the_edit_of_its_data_and_of_nothing_else(case: tuple[str, Edit]) -> None:
    text, edit = case
    data = YamlText(text).root.plain()
    done, anew = trace(text, edit)
    assert same(YamlText(done).root.plain(), edited(data, edit))
    assert anew is None, "the entry had to be written anew: its comments and layout are lost"
    before, after = lines_around(text, edit)
    # One of two blank lines goes with what they stood around.
    assert done.startswith(before.rstrip()) and done.rstrip().endswith(after.strip())


@pytest.mark.parametrize("name", sorted(TEXTS))
def test_setting_the_present_value_changes_no_byte(name: str) -> None:
    text, data = TEXTS[name], DATA[name]
    for path in PATHS[name][:: max(1, len(PATHS[name]) // 8)]:
        assert apply(text, Edit("set", path, at(data, path))) == text


def edit(op: Any, *path: str | int, value: Any = None, key: str = "", index: int | None = None) -> Edit:
    return Edit(op, path, value, key, index)


EXAMPLES = YAML(typ="safe").load(Path(__file__).with_name("written.yaml"))


@pytest.mark.parametrize(("op", "path", "more", "old", "new"), EXAMPLES)
def test_edits_write_the_expected_text(
    op: str, path: list[str | int], more: dict[str, Any], old: str, new: str
) -> None:
    done = apply(ODD, edit(op, *path, **more))
    assert ODD.count(old) == 1
    assert done == ODD.replace(old, new)


def test_a_new_section_goes_to_its_place() -> None:
    done = apply(TEXTS["four_bar"], Edit("set", ("inputs", "f"), {"unit": "N"}))
    assert "  L: {value: 1.0, unit: m}\ninputs:\n  f: {unit: N}\nbodies:\n" in done


def test_the_comment_above_an_entry_goes_with_it_and_the_head_stays() -> None:
    text = "# head\nsymofros: 1\nbodies:\n  # first\n  a: {}\n\n  # second\n  b: {}\n"
    assert apply(text, Edit("remove", ("bodies", "a"))) == "# head\nsymofros: 1\nbodies:\n\n  # second\n  b: {}\n"
    assert apply(text, Edit("move", ("bodies", "b"), index=0)) == (
        "# head\nsymofros: 1\nbodies:\n  # second\n  b: {}\n\n  # first\n  a: {}\n"
    )
    assert apply(text, Edit("remove", ("symofros",))).startswith("# head\nbodies:")


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (edit("set", "bodies", "a", "frames", 3, value=1), "no '3'"),
        (edit("remove", "bodies", "zz"), "no 'zz'"),
        (edit("remove"), "whole document"),
        (edit("insert", "bodies", key="a", value={}), "key 'a'"),
        (edit("insert", "system", "name", key="x", value=1), "a str"),
        (edit("insert", "bodies", "b", "loads", value={}, index=9), "index 9"),
        (edit("rename", "bodies", "a", key="b"), "'b'"),
        (edit("rename", "bodies", "b", "loads", 0, key="x"), "an entry of a list"),
        (edit("move", "bodies", "a", index=2), "index 2"),
        (edit("set", "bodies", "a", value=reduce(lambda inner, _: {"a": inner}, range(60), {})), "nesting"),
    ],
)
def test_an_edit_without_sense_is_refused(wrong: Edit, says: str) -> None:
    with pytest.raises(EditError, match="can't be applied") as caught:
        apply(ODD, wrong)
    problem = caught.value.problem
    assert says in problem.found and problem.rule and problem.remedy


def test_other_edits_rewrite_the_smallest_enclosing_entry() -> None:
    text = "symofros: 1\n# kept\nbodies:\n  a: {joint: [kind: fixed, 2]}\n  b: {}  # kept too\n"
    done, anew = trace(text, Edit("insert", ("bodies", "a", "joint", 0), 3, "x"))
    assert anew == ("bodies", "a", "joint", 0)
    assert done == text.replace("[kind: fixed, 2]", "[{kind: fixed, x: 3}, 2]")
