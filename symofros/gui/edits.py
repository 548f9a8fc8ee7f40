"""Edits of YAML text: only what an edit is about changes; all else keeps its bytes, comments included.

Each edit is cut out of, or put into, the text at the places that the reader found. What comes out is read again and
compared with the same edit of plain data; where they differ (a layout that is not foreseen), the smallest enclosing
entry for which they agree is written anew.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from symofros.description.native.yaml_nodes import Node, YamlFault
from symofros.gui.plain import Edit, Path, edited, fault, place, same
from symofros.gui.rendering import STEP, block, inline, is_block, scalar
from symofros.gui.sheet import Sheet


def apply(text: str, edit: Edit) -> str:
    """The text after an edit.

    Raises:
        EditError: The edit makes no sense for this document.
        YamlFault: The text is not YAML to begin with.
    """
    return _applied(text, edit, [])


def apply_all(text: str, edits: list[Edit]) -> str:
    """The text after several edits, one upon the other; the same errors."""
    for edit in edits:
        text = apply(text, edit)
    return text


def _applied(text: str, edit: Edit, rewritten: list[Path]) -> str:
    """As `apply`; `rewritten` receives the paths of entries that had to be written anew."""
    sheet = Sheet(text)
    before = sheet.root.plain()
    after = edited(before, edit)
    if same(before, after) and edit.op != "rename":
        return text
    done = _checked(lambda: _surgery(sheet, edit, after), after)
    path = edit.path
    while done is None:
        rewritten[:] = [path]
        done = _checked(lambda: _rewritten(sheet, path, after), after)
        if done is None and not path:
            raise fault(edit.path, "a text that does not read back", "edits keep the document readable",
                        "edit the text itself")  # fmt: skip
        path = path[:-1]
    return done


def _checked(make: Callable[[], str | None], wanted: Any) -> str | None:
    """A text, if it means what it should."""
    text = make()
    if text is None:
        return None
    try:
        return text if same(Sheet(text).root.plain(), wanted) else None
    except YamlFault:
        return None


def _rewritten(sheet: Sheet, path: Path, after: Any) -> str | None:
    """The text with the value at a path written anew."""
    for step in path:
        if isinstance(after, dict) and step in after or isinstance(after, list) and step in range(len(after)):
            after = after[step]
        else:
            return None
    if path:
        return _replaced(sheet, path, after) if sheet.node(path) else None
    return sheet.newline.join([*(block(after, (), 0) if after else ["{}"]), ""])


def _surgery(sheet: Sheet, edit: Edit, after: Any) -> str | None:
    if edit.op == "set":
        return _set(sheet, edit.path, edit.value, after)
    if edit.op == "insert":
        return _insert(sheet, edit.path, edit.key, edit.value, edit.index)
    owner = sheet.node(edit.path[:-1])
    assert owner is not None  # The plain edit went through.
    at = _place(owner, edit.path[-1])
    if edit.op == "remove":
        return _remove(sheet, owner, at)
    if edit.op == "rename":
        node = sheet.children(owner)[at]
        sign = sheet.text[node.key_start]
        key = scalar(edit.key, flow=owner.style == "flow", quote=sign, key=True)
        return sheet.text[: node.key_start] + key + sheet.text[node.key_end :]
    return _move(sheet, owner, at, len(owner.value) - 1 if edit.index is None else edit.index)


def _place(owner: Node, step: str | int) -> int:
    return list(owner.value).index(step) if isinstance(owner.value, dict) else int(step)


# Setting.


def _set(sheet: Sheet, path: Path, value: Any, after: Any) -> str | None:
    """Set a value; inside a mapping or list that stays one, only what differs."""
    known = 0
    while known < len(path) and sheet.node(path[: known + 1]) is not None:
        known += 1
    if known < len(path):
        for step in reversed(path[known + 1 :]):
            value = {step: value}
        return _insert(sheet, path[:known], str(path[known]), value, None)
    node = sheet.node(path)
    assert node is not None
    old = node.plain()
    if type(old) is not type(value) or not isinstance(value, (dict, list)) or not old or not value:
        return _replaced(sheet, path, value)
    step = _difference(old, value, path)
    if step is None:
        return _replaced(sheet, path, value)
    # One difference at a time; what is left is found in the text that has it.
    text = _applied(sheet.text, step, rewritten := [])
    return None if rewritten else _set_again(text, path, value)


def _set_again(text: str, path: Path, value: Any) -> str:
    return _applied(text, Edit("set", path, value), [])


def _difference(old: Any, new: Any, path: Path) -> Edit | None:
    """One edit that brings a mapping or list nearer to another; None where nothing is kept."""
    if isinstance(old, list):
        return _list_difference(old, new, path)
    if not any(key in old for key in new):
        return None
    for key in old:
        if key not in new:
            return Edit("remove", (*path, key))
    for i, key in enumerate(new):
        if key not in old:
            return Edit("insert", path, new[key], key, min(i, len(old)))
        if list(old)[i] != key:
            return Edit("move", (*path, key), index=i)
        if not same(old[key], new[key]):
            return Edit("set", (*path, key), new[key])
    return None


def _list_difference(old: list[Any], new: list[Any], path: Path) -> Edit | None:
    start = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if not same(a, b)), min(len(old), len(new)))
    if len(old) == len(new):
        return Edit("set", (*path, start), new[start])
    if len(old) > len(new):
        return Edit("remove", (*path, start))
    return Edit("insert", path, new[start], index=start)


def _replaced(sheet: Sheet, path: Path, value: Any) -> str | None:
    """The text with another value at a path."""
    node = sheet.node(path)
    assert node is not None
    if not path:
        return _rewritten(sheet, (), value)
    owner = sheet.node(path[:-1])
    assert owner is not None
    text, end = sheet.text, sheet.end(node)
    column = sheet.column(sheet.begin(owner, _place(owner, path[-1])))
    flow = _in_flow(sheet, path)
    if not flow and isinstance(owner.value, dict) and is_block(value, path, sheet.column(node.key_end) + 1):
        lines = sheet.newline.join(block(value, path, column + STEP))
        if node.style == "block":
            first = sheet.line_start(node.start)
            return text[:first] + lines + text[end:]
        # A comment at the end of the line stays there.
        line = max(sheet.line_end(end), end)
        return text[: node.start].rstrip(" ") + text[end:line] + sheet.newline + lines + text[line:]
    new = inline(value, node.style, flow=flow)
    if node.style == "block":
        colon = _after_mark(sheet, owner, node, path[-1])
        first = sheet.line_start(node.start)
        if first <= colon:  # On the line of its dash.
            return text[: node.start] + new + text[end:]
        return text[:colon] + " " + new + text[colon : first - len(sheet.newline)] + text[end:]
    if node.style in ("|", ">"):
        return text[: node.start] + new + text[end:]
    if node.start == node.end:  # Nothing stands there.
        mark = _after_mark(sheet, owner, node, path[-1])
        return text[:mark] + " " + new + text[mark:]
    return text[: node.start] + new + text[node.end :]


def _after_mark(sheet: Sheet, owner: Node, node: Node, step: str | int) -> int:
    """The position after the colon of a key, or the dash of an item."""
    if isinstance(owner.value, dict):
        return sheet.text.index(":", node.key_end) + 1
    return sheet.begin(owner, int(step)) + 1


def _in_flow(sheet: Sheet, path: Path) -> bool:
    """Whether an entry stands within brackets."""
    return any(node is not None and node.style == "flow" for n in range(len(path)) if (node := sheet.node(path[:n])))


# Inserting.


def _insert(sheet: Sheet, path: Path, key: str, value: Any, index: int | None) -> str | None:
    owner = sheet.node(path)
    assert owner is not None
    if owner.value is None or not owner.value:
        made = [value] if isinstance(owner.value, list) else {key: value}
        if path and owner.style == "flow" and not _in_flow(sheet, path) and not is_block(made, path, 0):
            new = inline(made)
            return sheet.text[: owner.start] + new + sheet.text[owner.end :]
        return _replaced(sheet, path, made)
    mapping = isinstance(owner.value, dict)
    count = len(owner.value)
    at = index if index is not None else place(path, list(owner.value), key) if mapping else count
    if owner.style == "flow":
        new = f"{scalar(key, flow=True, key=True)}: {inline(value)}" if mapping else inline(value)
        return _into_flow(sheet, owner, at, new)
    made = {key: value} if mapping else [value]
    inner = path if mapping else (*path, at)
    column = sheet.column(sheet.begin(owner, 0))
    lines = sheet.newline.join(block(made, inner if mapping else path, column))
    return _into_block(sheet, owner, at, lines)


def _into_flow(sheet: Sheet, owner: Node, at: int, new: str) -> str:
    text, nodes = sheet.text, sheet.children(owner)
    if at == 0:
        start = sheet.begin(owner, 0)
        return text[:start] + new + ", " + text[start:]
    end = max(sheet.end(nodes[at - 1]), nodes[at - 1].key_end)
    return text[:end] + ", " + new + text[end:]


def _into_block(sheet: Sheet, owner: Node, at: int, lines: str) -> str:
    """Put whole lines into a collection in block style."""
    text, nodes, newline = sheet.text, sheet.children(owner), sheet.newline
    if at < len(nodes):
        start = sheet.begin(owner, at)
        if not sheet.leads(start):  # The first entry, on the line of a dash.
            indent = " " * sheet.column(start)
            return text[:start] + lines.lstrip() + newline + indent + text[start:]
        first = sheet.lines_of(owner, at).start
        return text[:first] + lines + newline + text[first:]
    last = sheet.lines_of(owner, at - 1).end
    # Where entries are set apart by blank lines, this one is too.
    apart = at > 1 and _blank_before(sheet, sheet.lines_of(owner, at - 1).start)
    head = text[:last]
    if not head.endswith(("\n", "\r")):
        return head + newline * (1 + apart) + lines
    return head + newline * apart + lines + newline + text[last:]


def _blank_before(sheet: Sheet, first: int) -> bool:
    before = sheet.line_start(max(first - 1, 0))
    return first > 0 and not sheet.text[before:first].strip()


# Removing and moving.


def _remove(sheet: Sheet, owner: Node, at: int) -> str | None:
    text, nodes = sheet.text, sheet.children(owner)
    if len(nodes) == 1:
        return _emptied(sheet, owner)
    if owner.style == "flow":
        return _out_of_flow(sheet, owner, at)
    first, last = sheet.lines_of(owner, at)
    start = sheet.begin(owner, at)
    if not sheet.leads(start):  # The first entry, on the line of a dash: what follows moves up to it.
        follows = last + len(text[last:]) - len(text[last:].lstrip(" "))
        return text[:start] + text[follows:]
    if last == len(text) and not text.endswith(("\n", "\r")):
        first = len(text[:first].rstrip("\r\n"))
    elif _blank_before(sheet, first) and last < len(text) and not text[last : sheet.line_end(last)].strip():
        last = sheet.next_line(last)  # One of two blank lines.
    return text[:first] + text[last:]


def _emptied(sheet: Sheet, owner: Node) -> str:
    text, empty = sheet.text, "{}" if isinstance(owner.value, dict) else "[]"
    if owner.style == "flow":
        return text[: owner.start] + empty + text[owner.end :]
    start, last = owner.start, sheet.lines_of(owner, 0).end
    first = sheet.line_start(start)
    if not sheet.leads(start):
        return text[:start] + empty + text[sheet.end(owner) :]
    if owner is sheet.root:
        return text[:first] + empty + sheet.newline + text[last:]
    # Up to the line of its key, before a comment there.
    if owner.key_start < 0:
        return text[:start] + empty + text[sheet.end(owner) :]
    colon = text.index(":", owner.key_end) + 1
    first = sheet.lines_of(owner, 0).start
    return text[:colon] + " " + empty + text[colon:first] + text[last:]


def _out_of_flow(sheet: Sheet, owner: Node, at: int) -> str:
    text, nodes = sheet.text, sheet.children(owner)
    start = sheet.begin(owner, at)
    if at + 1 == len(nodes):
        before = nodes[at - 1]
        return text[: max(sheet.end(before), before.key_end)] + text[max(sheet.end(nodes[at]), nodes[at].key_end) :]
    return text[:start] + text[sheet.begin(owner, at + 1) :]


def _move(sheet: Sheet, owner: Node, at: int, to: int) -> str | None:
    text, nodes = sheet.text, sheet.children(owner)
    if owner.style == "flow":
        new = text[sheet.begin(owner, at) : max(sheet.end(nodes[at]), nodes[at].key_end)]
        parts = [text[sheet.begin(owner, i) : max(sheet.end(node), node.key_end)] for i, node in enumerate(nodes)]
        parts.insert(to, parts.pop(at))
        seams = [
            text[max(sheet.end(nodes[i]), nodes[i].key_end) : sheet.begin(owner, i + 1)] for i in range(len(nodes) - 1)
        ]
        middle = "".join(part + seam for part, seam in zip(parts, [*seams, ""], strict=True))
        return text[: sheet.begin(owner, 0)] + middle + text[max(sheet.end(nodes[-1]), nodes[-1].key_end) :]
    if not sheet.leads(sheet.begin(owner, 0)):
        return None
    spans = [sheet.lines_of(owner, i) for i in range(len(nodes))]
    parts = [text[span.start : span.end] for span in spans]
    if not parts[-1].endswith(("\n", "\r")):
        return None
    parts.insert(to, parts.pop(at))
    seams = [text[spans[i].end : spans[i + 1].start] for i in range(len(spans) - 1)]
    middle = "".join(part + seam for part, seam in zip(parts, [*seams, ""], strict=True))
    return text[: spans[0].start] + middle + text[spans[-1].end :]
