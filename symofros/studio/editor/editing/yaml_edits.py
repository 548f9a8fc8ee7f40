"""Edits of YAML text: only what an edit is about changes; all else keeps its bytes, comments included.

Each edit is cut out of, or put into, the text at the spans that the reader gives (yaml_text_edits.py). What comes out
is read again and compared with the same edit of plain data; where they differ (a layout that is not foreseen), the
smallest enclosing entry for which they agree is written anew.
"""

from __future__ import annotations

from typing import Any

from symofros.description.yaml import Node, YamlFault
from symofros.studio.editor.editing.data_edits import Edit, Path, edited, fault, same
from symofros.studio.editor.editing.renaming import renaming
from symofros.studio.editor.editing.yaml_spans import YamlText, yaml_text_of
from symofros.studio.editor.editing.yaml_text_edits import (
    patch,
    with_data,
    with_entry,
    with_entry_moved,
    with_key,
    with_value,
    without_entry,
)


def apply(text: str, edit: Edit) -> str:
    """The text after an edit.

    Raises:
        EditError: The edit makes no sense for this document.
        YamlFault: The text is not YAML to begin with.
    """
    return trace(text, edit)[0]


def with_references(text: str, edits: list[Edit]) -> str:
    """The text after several edits, one upon the other; what is renamed is renamed wherever it is used.

    Raises:
        EditError: One of them makes no sense.
        YamlFault: The text is not YAML to begin with.
    """
    for edit in edits:
        if edit.op == "rename":
            text = _together(text, renaming(yaml_text_of(text).data, edit))
        else:
            text = apply(text, edit)
    return text


def _together(text: str, edits: list[Edit]) -> str:
    """The text after edits apart from each other, read once: a parameter may be used in hundreds of formulas."""
    source = yaml_text_of(text)
    done, after, rest = text, source.data, []
    patches = [(patch(source, edit), edit) for edit in edits]
    # From the end of the text, so that positions and paths stay valid: a key stands before what is in it.
    for (start, end, new), edit in sorted(patches, key=lambda pair: pair[0][:2], reverse=True):
        if start < 0:
            rest.append(edit)
        else:
            done, after = done[:start] + new + done[end:], edited(after, edit)
    meant = _meaning(done, after)
    return _one_by_one(text, edits) if meant is None else _one_by_one(meant, rest)


def _one_by_one(text: str, edits: list[Edit]) -> str:
    for edit in edits:
        text = apply(text, edit)
    return text


def trace(text: str, edit: Edit) -> tuple[str, Path | None]:
    """Apply edits as `apply` does; also the path of the entry that had to be rewritten, if any."""
    source = yaml_text_of(text)
    before = source.data
    after = edited(before, edit)
    if same(before, after):
        return text, None
    done = _meaning(_operated(source, edit), after)
    if done is not None:
        return done, None
    path = edit.path
    while True:
        done = _meaning(_rewritten(source, path, after), after)
        if done is not None:
            return done, path
        if not path:
            raise fault(
                edit.path,
                "what the format refuses, such as nesting of many levels",
                "edits keep the document readable",
                "choose other names",
            )
        path = path[:-1]


def _meaning(text: str | None, wanted: Any) -> str | None:
    """The text if it reads as the wanted data, otherwise None."""
    if text is None:
        return None
    try:
        return text if same(yaml_text_of(text).data, wanted) else None
    except YamlFault:
        return None


def _rewritten(source: YamlText, path: Path, after: Any) -> str | None:
    """The text with the whole value at a path rewritten; None if the path is missing before or after the edit."""
    for step in path:
        if isinstance(after, dict) and step in after:
            after = after[step]
        elif isinstance(after, list) and isinstance(step, int) and step < len(after):
            after = after[step]
        else:
            return None
    if not path:
        return with_data(source, after)
    return with_value(source, path, after) if source.node(path) else None


def _operated(source: YamlText, edit: Edit) -> str | None:
    """The text after one text edit; None where there is no such edit."""
    if edit.op == "set":
        return _set(source, edit.path, edit.value)
    if edit.op == "insert":
        return with_entry(source, edit.path, edit.key, edit.value, edit.index)
    owner = source.node(edit.path[:-1])
    assert owner is not None  # The edit of plain data went through.
    at = place_of(owner, edit.path[-1])
    if edit.op == "remove":
        return without_entry(source, owner, at)
    if edit.op == "rename":
        return with_key(source, owner, at, edit.key)
    return with_entry_moved(source, owner, at, len(owner.value) - 1 if edit.index is None else edit.index)


def place_of(owner: Node, step: str | int) -> int:
    """The number of an entry in its collection."""
    return list(owner.value).index(step) if isinstance(owner.value, dict) else int(step)


def _set(source: YamlText, path: Path, value: Any) -> str | None:
    """Set a value; of a mapping or list that stays one, only what differs."""
    known = 0
    while known < len(path) and source.node(path[: known + 1]) is not None:
        known += 1
    if known < len(path):
        for step in reversed(path[known + 1 :]):
            value = {step: value}
        return with_entry(source, path[:known], str(path[known]), value, None)
    node = source.node(path)
    assert node is not None
    old = node.plain()
    difference: Edit | None = None
    if isinstance(old, dict) and isinstance(value, dict):
        difference = _difference(old, value, path)
    elif isinstance(old, list) and isinstance(value, list) and old and value:
        difference = _list_difference(old, value, path)
    if difference is None:
        return with_value(source, path, value) if path else with_data(source, value)
    # One difference at a time; what is left is found in the text that has it.
    return apply(apply(source.text, difference), Edit("set", path, value))


def _difference(old: dict[str, Any], new: dict[str, Any], path: Path) -> Edit | None:
    """One edit that brings a mapping nearer to another; None where they have nothing in common."""
    if not old.keys() & new.keys() or "" in new:
        return None
    for key in old:
        if key not in new:
            return Edit("remove", (*path, key))
    for i, key in enumerate(new):
        if key not in old:
            return Edit("insert", path, new[key], key, i)
        if list(old)[i] != key:
            return Edit("move", (*path, key), index=i)
        if not same(old[key], new[key]):
            return Edit("set", (*path, key), new[key])
    return None


def _list_difference(old: list[Any], new: list[Any], path: Path) -> Edit:
    """One edit that brings a list nearer to another."""
    pairs = enumerate(zip(old, new, strict=False))
    start = next((i for i, (a, b) in pairs if not same(a, b)), min(len(old), len(new)))
    if len(old) == len(new):
        return Edit("set", (*path, start), new[start])
    if len(old) > len(new):
        return Edit("remove", (*path, start))
    return Edit("insert", path, new[start], index=start)
