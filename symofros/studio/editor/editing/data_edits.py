"""Edits of plain data: what a set, a removal, an insertion and a move mean, whatever the text looks like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from symofros.errors import Problem, SymofrosError

Path = tuple[str | int, ...]
Op = Literal["set", "remove", "insert", "rename", "move"]

# The order in which a file's sections stand.
SECTIONS = (
    "symofros",
    "include",
    "system",
    "parameters",
    "inputs",
    "bodies",
    "connections",
    "contacts",
    "virtual_power",
    "potentials",
    "closures",
    "couplings",
    "nonholonomic",
    "switches",
    "options",
)
# The same of a diagram's file.
DIAGRAM_SECTIONS = ("symofros_diagram", "name", "models", "simulation", "blocks", "parts", "wires", "inlets", "outlets")
# Entries of the condition of a part that name signals.
_SIGNALS = ("enabled", "triggered")
_ORDER = (*SECTIONS, *DIAGRAM_SECTIONS)


class EditError(SymofrosError):
    """An edit that can't be applied."""


@dataclass(frozen=True)
class Edit:
    """One change.

    Attributes:
        op: "set" a value, whether it exists or not; "remove" an entry; "insert" an entry into the mapping or list at
            `path`; "rename" an entry's key; "move" an entry to another place of its own mapping or list.
        path: Keys and indices from the root.
        value: Value of "set" and "insert": plain data.
        key: Key of "insert" into a mapping, and the new key of "rename".
        index: The place of "insert" and "move"; None is the end.
    """

    op: Op
    path: Path
    value: Any = None
    key: str = ""
    index: int | None = None


def section_of(data: Any, key: str) -> dict[str, Any]:
    """A section of a document's data, or of an entry in it; empty if it is missing or no mapping."""
    section = data.get(key) if isinstance(data, dict) else None
    return section if isinstance(section, dict) else {}


def conditions_of(part: Any) -> dict[str, str]:
    """Signal of the condition that a part of a diagram runs on -> its source, of those that name one."""
    return {key: by for key, by in section_of(part, "condition").items() if key in _SIGNALS and isinstance(by, str)}


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal; order counts in mappings, and true is not 1."""
    if isinstance(a, dict) and isinstance(b, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, bool) or isinstance(b, bool):
        return a is b
    return type(a) is type(b) and a == b or (_numeric(a) and _numeric(b) and (a == b or (a != a and b != b)))


def _numeric(value: Any) -> bool:
    return isinstance(value, (int, float))


def edited(data: Any, edit: Edit) -> Any:
    """The data after an edit; the parts that it does not touch are shared with the original.

    Raises:
        EditError: The path leads nowhere, a key exists already, or an index is out of range.
    """
    if edit.op == "set":
        return _set(data, edit.path, edit.path, edit.value)
    if edit.op == "insert":
        return _at(data, edit.path, edit.path, lambda owner: inserted(owner, edit))
    if not edit.path:
        raise fault(edit.path, f"{edit.op} of the whole document", "an entry is named", "set it instead")
    step = edit.path[-1]
    return _at(data, edit.path[:-1], edit.path, lambda owner: _changed(owner, step, edit))


def inserted(owner: Any, edit: Edit) -> Any:
    """A mapping or list with one more entry."""
    if isinstance(owner, list):
        i = len(owner) if edit.index is None else edit.index
        if not 0 <= i <= len(owner):
            raise fault(edit.path, f"index {i}", f"0 to {len(owner)}", "insert at the end")
        return [*owner[:i], edit.value, *owner[i:]]
    if owner is not None and not isinstance(owner, dict):
        raise fault(edit.path, f"a {type(owner).__name__}", "entries are inserted into mappings and lists", "set it")
    owner = owner or {}
    if not edit.key or edit.key in owner:
        raise fault(edit.path, f"key '{edit.key}'", "a new entry has a name of its own", "choose another name")
    i = place(edit.path, list(owner), edit.key) if edit.index is None else edit.index
    if not 0 <= i <= len(owner):
        raise fault(edit.path, f"index {i}", f"0 to {len(owner)}", "insert at the end")
    items = list(owner.items())
    return dict([*items[:i], (edit.key, edit.value), *items[i:]])


def place(path: Path, keys: Sequence[str], key: str) -> int:
    """Index at which a new key is inserted: a section at its place in the file's order, any other key at the end."""
    if path or key not in _ORDER:
        return len(keys)
    after = _ORDER[: _ORDER.index(key)]
    return max((i + 1 for i, other in enumerate(keys) if other in after), default=0)


def fault(path: Path, found: str, rule: str, remedy: str) -> EditError:
    """The error of an edit at a path."""
    shown = " / ".join(map(str, path))[:200] or "the document"
    return EditError(f"{shown}: the edit can't be applied", found, rule, remedy)


def four_parts(problem: Problem) -> dict[str, str]:
    """A problem as the page gets it."""
    return {"object": problem.what, "found": problem.found, "rule": problem.rule, "remedy": problem.remedy}


def _at(data: Any, path: Path, whole: Path, change: Any) -> Any:
    """A copy of the data with the value at a path changed."""
    if not path:
        return change(data)
    step = path[0]
    inner = _at(_entry(data, step, whole), path[1:], whole, change)
    if isinstance(data, dict):
        return {key: inner if key == step else value for key, value in data.items()}
    return [inner if i == step else value for i, value in enumerate(data)]


def _entry(data: Any, step: str | int, whole: Path) -> Any:
    known = isinstance(data, dict) and step in data
    known |= isinstance(data, list) and isinstance(step, int) and 0 <= step < len(data)
    if not known:
        raise fault(whole, f"no '{step}'", "the path leads to an entry that exists", "reload the document")
    return data[step]


def _set(data: Any, path: Path, whole: Path, value: Any) -> Any:
    if not path:
        return value
    step = path[0]
    if isinstance(step, str) and (data is None or (isinstance(data, dict) and step not in data)):
        made = _set(None, path[1:], whole, value)
        done = whole[: len(whole) - len(path)]
        return inserted(data, Edit("insert", done, made, step))
    return _at(data, (step,), whole, lambda inner: _set(inner, path[1:], whole, value))


def _changed(owner: Any, step: str | int, edit: Edit) -> Any:
    _entry(owner, step, edit.path)
    pairs: list[tuple[Any, Any]] = list(owner.items() if isinstance(owner, dict) else enumerate(owner))
    at = next(i for i, (key, _) in enumerate(pairs) if key == step)
    if edit.op == "remove":
        del pairs[at]
    elif edit.op == "rename":
        if not isinstance(owner, dict):
            raise fault(edit.path, "an entry of a list", "entries of mappings have names", "set it instead")
        if not edit.key or (edit.key in owner and edit.key != step):
            raise fault(edit.path, f"'{edit.key}'", "names of neighbours differ, and are not empty", "choose another")
        pairs[at] = (edit.key, pairs[at][1])
    else:
        to = len(pairs) - 1 if edit.index is None else edit.index
        if not 0 <= to < len(pairs):
            raise fault(edit.path, f"index {to}", f"0 to {len(pairs) - 1}", "give the place it has afterwards")
        pairs.insert(to, pairs.pop(at))
    return dict(pairs) if isinstance(owner, dict) else [value for _, value in pairs]
