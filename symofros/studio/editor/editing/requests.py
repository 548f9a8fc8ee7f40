"""Bodies of requests -> edits; whatever a page, or somebody else, sends is checked here."""

from __future__ import annotations

from typing import Any, NamedTuple, get_args

from symofros.description.yaml import MAX_DEPTH, scalar_of
from symofros.studio.editor.editing.data_edits import Edit, EditError, Op, Path
from symofros.studio.editor.editing.yaml_rendering import WHOLE, Typed

MAX_EDITS = 1000
MAX_PATH = 50


def edits_of(given: Any) -> list[Edit]:
    """The edits of a request.

    Raises:
        EditError: They are not what the contract says.
    """
    if not isinstance(given, list) or len(given) > MAX_EDITS:
        raise _malformed("edits", given, f"a list of at most {MAX_EDITS}")
    return [_edit(item) for item in given]


def path_of(given: Any) -> Path:
    """A path of a request.

    Raises:
        EditError: It is not one.
    """
    if not isinstance(given, list) or len(given) > MAX_PATH or not all(type(step) in (str, int) for step in given):
        raise _malformed("path", given, "a list of names and indices")
    return tuple(given)


class Field(NamedTuple):
    """A field that is asked about.

    Attributes:
        path: Path of the field.
        text: What was typed into it.
        draft: Edit that puts the entry that the window shows into the document; None where the document has it.
    """

    path: Path
    text: Any
    draft: Edit | None


def fields_of(given: Any) -> list[Field]:
    """The fields of a request.

    Raises:
        EditError: They are not what the contract says.
    """
    if not isinstance(given, list) or len(given) > MAX_EDITS or not all(isinstance(item, dict) for item in given):
        raise _malformed("fields", given, f"a list of at most {MAX_EDITS} mappings")
    return [Field(path_of(item.get("path", [])), item.get("text"), _draft(item.get("draft"))) for item in given]


def _draft(given: Any) -> Edit | None:
    if given is None:
        return None
    if not isinstance(given, dict):
        raise _malformed("draft", given, "a mapping of path and value")
    return Edit("set", path_of(given.get("path")), _clean(given.get("value")))


def text_of(body: dict[str, Any], key: str) -> str:
    """A text of a request; "" where it has none.

    Raises:
        EditError: It is something else.
    """
    text = body.get(key, "")
    if text is not None and not isinstance(text, str):
        raise _malformed(key, text, "a text")
    return text or ""


def _edit(item: Any) -> Edit:
    if not isinstance(item, dict) or item.get("op") not in get_args(Op):
        raise _malformed("an edit", item, f"a mapping whose op is one of {', '.join(get_args(Op))}")
    path, index, op = path_of(item.get("path")), item.get("index"), item["op"]
    if index is not None and (type(index) is not int or index < 0):
        raise _malformed("index", index, "a number from 0")
    key = item.get("to" if op == "rename" else "key", "")
    if not isinstance(key, str):
        raise _malformed("key", key, "a text")
    value = _clean(item.get("value"))
    if "text" in item:
        value = _typed(item["text"])
    return Edit(op, path, value, key, index)


def _clean(value: Any, depth: int = 0) -> Any:
    """A value as the format holds it: whole numbers of sixteen digits and more are doubles."""
    if depth > MAX_DEPTH:
        raise _malformed("value", f"more than {MAX_DEPTH} levels", "the format needs fewer than ten")
    if isinstance(value, dict):
        return {key: _clean(inner, depth + 1) for key, inner in value.items()}
    if isinstance(value, list):
        return [_clean(inner, depth + 1) for inner in value]
    if isinstance(value, int) and abs(value) >= WHOLE:
        try:
            return float(value)
        except OverflowError:
            raise _malformed("value", "a number of hundreds of digits", "numbers are doubles") from None
    return value


def _typed(text: Any) -> Any:
    """Value of text typed into a field: a number if it reads as one, otherwise text."""
    if not isinstance(text, str):
        raise _malformed("text", text, "a text")
    value = scalar_of(text.strip())
    return Typed(text.strip()) if type(value) in (int, float) else value


def _malformed(what: str, found: Any, rule: str) -> EditError:
    return EditError(f"{what} of the request is malformed", f"{found!r:.100}", rule, "reload the page")
