"""Renaming a block, a part or a model of a diagram, with every reference to it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from symofros.studio.editor.editing.data_edits import Edit, Path, conditions_of, edited, fault, section_of

_NAME = re.compile(r"[A-Za-z]\w*\Z", re.ASCII)


def renaming_in_diagram(data: dict[str, Any], edit: Edit) -> list[Edit]:
    """The edits that a renaming consists of; the references first, so that all paths are those of the document.

    Args:
        data: Document, a diagram.
        edit: Edit whose op is "rename": `path` is that of a block, part, model or another named entry.

    Raises:
        EditError: There is no such entry, or the name is taken or unusable.
    """
    edited(data, edit)  # Whether it can be done at all.
    section, old, new = edit.path[0], str(edit.path[-1]), edit.key
    if len(edit.path) != 2 or section not in ("blocks", "parts", "models"):
        return [edit]
    others = ("models",) if section == "models" else ("blocks", "parts")
    taken = {name for other in others for name in section_of(data, other)} - {old}
    if not _NAME.match(new) or new in taken:
        stated = f"'{new[:50]}' is taken" if new in taken else f"'{new[:50]}'"
        raise fault(
            edit.path, stated, "a name of its own: letters, digits, underscores, a letter first", "choose another"
        )
    if section == "models":
        return [*_model(data, old, new), edit]
    changed = _reference(old, new)
    edits = [Edit("set", path, after) for path, text in _signals(data) if (after := changed(text)) != text]
    wires = [key for key in section_of(data, "wires") if changed(key) != key]
    return [*edits, *(Edit("rename", ("wires", key), key=changed(key)) for key in wires), edit]


def _reference(old: str, new: str) -> Callable[[str], str]:
    """A signal's name with the block's new one: "old", "old.port", "old/inner.port", "old.port[0]"."""
    pattern = re.compile(rf"{re.escape(old)}(?=\Z|[./])")
    return lambda text: f"{new}{text[match.end() :]}" if (match := pattern.match(text)) else text


def _model(data: dict[str, Any], old: str, new: str) -> Iterator[Edit]:
    for name, block in section_of(data, "blocks").items():
        if isinstance(block, dict) and block.get("model") == old:
            yield Edit("set", ("blocks", name, "model"), new)
    for name in section_of(data, "parts"):
        for inner, model in section_of(section_of(section_of(data, "parts"), name), "models").items():
            if model == old:
                yield Edit("set", ("parts", name, "models", inner), new)


def _signals(data: dict[str, Any]) -> Iterator[tuple[Path, str]]:
    """Every place that names a signal."""
    for section in ("blocks", "parts"):
        for name in section_of(data, section):
            inputs = section_of(section_of(section_of(data, section), name), "inputs")
            yield from _texts(inputs, (section, name, "inputs"))
            yield from _texts(conditions_of(section_of(data, section)[name]), (section, name, "condition"))
    for section in ("wires", "inlets", "outlets"):
        yield from _texts(section_of(data, section), (section,))
    yield from _texts(section_of(data, "simulation").get("plots"), ("simulation", "plots"))


def _texts(value: Any, path: Path) -> Iterator[tuple[Path, str]]:
    words = path[-1] == "title" or (path[0] == "inlets" and path[2:] == ("unit",))
    if isinstance(value, str) and not words:
        yield path, value
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in pairs:
        yield from _texts(item, (*path, key))
