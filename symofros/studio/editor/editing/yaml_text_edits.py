"""Cuts and insertions in a YAML text, at the places of its entries; nothing else in it changes."""

from __future__ import annotations

from typing import Any

from symofros.description.yaml import Node
from symofros.studio.editor.editing.data_edits import Edit, Path, place
from symofros.studio.editor.editing.yaml_rendering import STEP, block, inline, is_block, scalar
from symofros.studio.editor.editing.yaml_spans import Span, YamlText


def with_data(source: YamlText, value: Any) -> str:
    """A text with other data altogether."""
    return source.newline.join([*(block(value, (), 0) if isinstance(value, dict) and value else [inline(value)]), ""])


def with_value(source: YamlText, path: Path, value: Any) -> str:
    """The text with another value at a path."""
    node, owner = source.node(path), source.node(path[:-1])
    assert node is not None and owner is not None
    text, end = source.text, source.end(node)
    flow = _in_flow(source, path)
    keyed = isinstance(owner.value, dict)
    mark = source.after_mark(owner, list(owner.value).index(path[-1]) if keyed else int(path[-1]))
    if keyed and mark == node.key_end:  # A key in braces without a colon.
        return text[:mark] + ": " + inline(value) + text[mark:]
    if not flow and keyed and is_block(value, path, source.column(node.key_end) + 1):
        lines = source.newline.join(block(value, path, source.column(node.key_start) + STEP))
        if node.style == "block":
            return text[: source.line_start(node.start)] + lines + text[end:]
        # A comment at the end of the line stays there.
        line = source.line_end(end)
        return text[:mark] + text[end:line] + source.newline + lines + text[line:]
    new = inline(value, node.style, flow=flow)
    if node.start == node.end:  # Nothing stands there.
        return text[:mark] + " " + new + text[mark:]
    if node.style == "block" and source.leads(node.start):
        # Up to the line of its key, before a comment there.
        first = source.line_end(mark)
        return text[:mark] + " " + new + text[mark:first] + text[end:]
    return text[: node.start] + new + text[end:]


def _in_flow(source: YamlText, path: Path) -> bool:
    """Whether an entry stands within brackets."""
    return any(node is not None and node.style == "flow" for n in range(len(path)) if (node := source.node(path[:n])))


# Inserting.


def with_entry(source: YamlText, path: Path, key: str, value: Any, index: int | None) -> str | None:
    """The text with one more entry in the collection at a path."""
    owner = source.node(path)
    assert owner is not None
    mapping = not isinstance(owner.value, list)
    if not owner.value:
        made = {key: value} if mapping else [value]
        return with_value(source, path, made) if path else with_data(source, made)
    count = len(owner.value)
    at = index if index is not None else place(path, list(owner.value), key) if mapping else count
    if owner.style == "flow":
        new = f"{scalar(key, flow=True, key=True)}: {inline(value)}" if mapping else inline(value)
        return _into_flow(source, owner, at, new)
    lines = block({key: value} if mapping else [value], path, source.column(source.begin(owner, 0)))
    return _into_block(source, owner, at, source.newline.join(lines))


def _into_flow(source: YamlText, owner: Node, at: int, new: str) -> str | None:
    text = source.text
    if text[owner.start] not in "[{":  # A pair in a list, without braces.
        return None
    if at == 0:
        start = source.begin(owner, 0)
        return text[:start] + new + ", " + text[start:]
    end = _flow_end(source, source.children(owner)[at - 1])
    return text[:end] + ", " + new + text[end:]


def _flow_end(source: YamlText, node: Node) -> int:
    return max(source.end(node), node.key_end)


def _into_block(source: YamlText, owner: Node, at: int, lines: str) -> str:
    text, newline = source.text, source.newline
    if at < len(owner.value):
        start = source.begin(owner, at)
        if not source.leads(start):  # The first entry, on the line of a dash.
            return text[:start] + lines.lstrip() + newline + " " * source.column(start) + text[start:]
        first = source.lines_of(owner, at).start
        return text[:first] + lines + newline + text[first:]
    previous, last = source.lines_of(owner, at - 1)
    # Where entries are set apart by blank lines, this one is too.
    apart = newline if at > 1 and _blank_before(source, previous) else ""
    if not text[:last].endswith(("\n", "\r")):
        return text[:last] + newline + apart + lines
    return text[:last] + apart + lines + newline + text[last:]


def _blank_before(source: YamlText, line: int) -> bool:
    return line > 0 and not source.text[source.line_start(line - 1) : line].strip()


# Renaming, removing, moving.


def with_key(source: YamlText, owner: Node, at: int, key: str) -> str:
    """The text with another key of an entry."""
    start, end, new = _new_key(source, owner, source.children(owner)[at], key)
    return source.text[:start] + new + source.text[end:]


def _new_key(source: YamlText, owner: Node, node: Node, key: str) -> tuple[int, int, str]:
    quote = source.text[node.key_start]
    return node.key_start, node.key_end, scalar(key, flow=owner.style == "flow", quote=quote, key=True)


def patch(source: YamlText, edit: Edit) -> tuple[int, int, str]:
    """The piece of text that another scalar or key is put in place of, and its text; (-1, -1, "") if there is none."""
    node, owner = source.node(edit.path), source.node(edit.path[:-1])
    if node is None or owner is None or not edit.path:
        return -1, -1, ""
    if edit.op == "rename":
        return _new_key(source, owner, node, edit.key)
    if isinstance(node.value, (dict, list)) or node.start == node.end:
        return -1, -1, ""
    return node.start, source.end(node), inline(edit.value, node.style, flow=_in_flow(source, edit.path))


def without_entry(source: YamlText, owner: Node, at: int) -> str:
    """The text without an entry."""
    if len(owner.value) == 1:
        return _emptied(source, owner)
    if owner.style == "flow":
        return _out_of_flow(source, owner, at)
    text, (first, last) = source.text, source.lines_of(owner, at)
    if not source.leads(source.begin(owner, at)):  # On the line of a dash: what follows moves up to it.
        return text[:first] + text[last:].lstrip(" ")
    if _blank_before(source, first) and last < len(text) and not text[last : source.line_end(last)].strip():
        last = source.next_line(last)  # One of two blank lines.
    return text[:first] + text[last:]


def _emptied(source: YamlText, owner: Node) -> str:
    text, empty = source.text, "{}" if isinstance(owner.value, dict) else "[]"
    if owner.style == "flow":
        return text[: owner.start] + empty + text[owner.end :]
    span = source.lines_of(owner, 0)
    if owner is source.root:
        return text[: span.start] + empty + source.newline + text[span.end :]
    if owner.key_start < 0 or not source.leads(owner.start):
        return text[: owner.start] + empty + text[source.end(owner) :]
    # Up to the line of its key, before a comment there.
    colon = source.skip(owner.key_end) + 1
    return text[:colon] + " " + empty + text[colon : span.start] + text[span.end :]


def _out_of_flow(source: YamlText, owner: Node, at: int) -> str:
    text, nodes = source.text, source.children(owner)
    if at + 1 == len(nodes):
        return text[: _flow_end(source, nodes[at - 1])] + text[_flow_end(source, nodes[at]) :]
    return text[: source.begin(owner, at)] + text[source.begin(owner, at + 1) :]


def with_entry_moved(source: YamlText, owner: Node, at: int, to: int) -> str:
    """The text with an entry moved within its collection; separators stay in place."""
    text, nodes, flow = source.text, source.children(owner), owner.style == "flow"
    if flow:
        spans = [Span(source.begin(owner, i), _flow_end(source, node)) for i, node in enumerate(nodes)]
    else:
        spans = [source.lines_of(owner, i) for i in range(len(nodes))]
    parts = [text[start:end] for start, end in spans]
    seams = [text[spans[i].end : spans[i + 1].start] for i in range(len(spans) - 1)]
    hanging = not flow and not source.leads(source.begin(owner, 0))  # Its first entry is on the line of a dash.
    if hanging:
        parts[0] = " " * source.column(spans[0].start) + parts[0]
    if not flow and not parts[-1].endswith(("\n", "\r")):
        parts[-1] += source.newline
    parts.insert(to, parts.pop(at))
    middle = "".join(part + seam for part, seam in zip(parts, [*seams, ""], strict=True))
    middle = middle.lstrip(" ") if hanging else middle
    return text[: spans[0].start] + middle + text[spans[-1].end :]
