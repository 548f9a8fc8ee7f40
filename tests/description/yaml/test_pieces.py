"""A text that is read piece by piece has the tree that it has as a whole, or is read as a whole."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symofros.description.yaml import yaml_pieces
from symofros.description.yaml.yaml_nodes import Node, YamlFault, compose_whole
from symofros.description.yaml.yaml_pieces import compose_text

FILES = sorted((Path(__file__).parents[2] / "reference_models").rglob("*.yaml"))
LINES = [
    "a: 1",
    "b:",
    "  c: {x: [1, 2], y: 'it''s'}  # why",
    "  d:",
    "    - e: 1",
    "    -",
    "  f: |",
    "    g: text",
    "  h: two",
    "    lines",
    "# a comment: here",
    "",
    "  # deeper",
    "i: [1,",
    "  2]",
    "}",
    "- j",
    'k: "open',
    'l: 1"',
    "--- ",
    "m: &n 1",
    "c: 3",
    "b: 4",
    "    o: null",
]


def flat(node: Node, path: tuple[object, ...] = ()) -> Iterator[object]:
    """Everything that is known of each node; where a block ends depends on what the scanner looked at."""
    value = node.value
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    own = None if isinstance(value, (dict, list)) else repr(value)
    # What is not written stands at the next token, and what is in block style ends there; nobody relies on it.
    is_written = node.start < node.end or node.style != "plain"
    start, line = (node.start, node.line) if is_written else (None, None)
    end = None if node.style in ("block", "|", ">") or not is_written else node.end
    yield path, own, line, node.key_line, start, end, node.key_start, node.key_end, node.style
    for key, child in inner:
        yield from flat(child, (*path, key))


def agree(text: str) -> None:
    """Both readers say the same, or refuse with the same words."""
    try:
        whole, problems = compose_whole(text, "x")
    except YamlFault as error:
        with pytest.raises(YamlFault) as refused:
            compose_text(text, "x")
        assert refused.value.problems == error.problems
        return
    pieces, repeated = compose_text(text, "x")
    assert list(flat(pieces)) == list(flat(whole)) and repeated == problems


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_reference_models_parse_equally_in_pieces(file: Path) -> None:
    agree(file.read_text())


@given(st.lists(st.sampled_from(LINES), max_size=12), st.sampled_from(["\n", "\r\n"]))
def test_any_lines_parse_equally_in_pieces(lines: list[str], newline: str) -> None:
    agree(newline.join(lines))


@pytest.mark.parametrize("count", [20, 4000], ids=["few", "some thousand"])
def test_only_the_entry_that_changed_is_read_again(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    text = "system: {name: s}\nbodies:\n" + "".join(f"  b{i}:\n    mass: {i}\n" for i in range(count))
    monkeypatch.setattr(yaml_pieces, "_KEPT", yaml_pieces._Kept())
    compose_text(text, "x")
    read: list[str] = []

    def counted(part: str, file: str) -> object:
        read.append(part)
        return compose_whole(part, file)

    monkeypatch.setattr(yaml_pieces, "compose_whole", counted)
    root, _ = compose_text(text.replace("mass: 7\n", "mass: 7.25\n"), "x")
    assert read == ["  b7:\n    mass: 7.25\n"]
    assert root.at(("bodies", f"b{count - 1}", "mass")).line == 2 + 2 * count


def test_the_cache_of_parsed_pieces_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = yaml_pieces._Kept()
    monkeypatch.setattr(yaml_pieces, "MAX_KEPT", 30)
    read: list[str] = []
    monkeypatch.setattr(yaml_pieces, "_read", lambda part: read.append(part) or part)
    parts = ["a: 1\n" * 2, "b: 1\n" * 2, "c: 1\n" * 2]
    for part in (*parts, parts[0], "d: 1\n" * 2, parts[0], parts[1]):
        kept.read(part)
    assert read == [*parts, "d: 1\n" * 2, parts[1]]
