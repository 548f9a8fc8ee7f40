"""What an importer ignored or changed, gathered by kind and said in one line each."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from symofros.description.xml_nodes import Element

EXAMPLES = 3


class Remarks:
    """Kinds of remarks in the order in which they first came up, each with the things it is about."""

    def __init__(self) -> None:
        self._kinds: dict[str, tuple[str, list[str]]] = {}

    def add(self, text: str, noun: str, name: str) -> None:
        """Note that something was ignored or changed, for the thing of that name."""
        names = self._kinds.setdefault(text, (noun, []))[1]
        if name not in names[-1:]:
            names.append(name)

    def notes(self) -> tuple[str, ...]:
        """One line a kind, with the number of things and some of their names."""
        return tuple(note(text, noun, names) for text, (noun, names) in self._kinds.items())


def note(text: str, noun: str, names: list[str]) -> str:
    """One line: what happened, to how many things, and the names of the first few."""
    shown = ", ".join(names[:EXAMPLES]) + (", …" if len(names) > EXAMPLES else "")
    plural = f"{noun.removesuffix('y')}ies" if noun.endswith("y") else f"{noun}s"
    return f"{text}: {len(names)} {noun if len(names) == 1 else plural} ({shown})"


def remark_unread(
    remarks: Remarks,
    element: Element,
    attributes: Mapping[str, Collection[str]],
    several: Collection[str],
    thing: tuple[str, str],
) -> None:
    """Tell of what nothing reads in an element: other attributes than its own, and all but the first of equal children.

    Args:
        remarks: Where it is reported.
        element: An element of a link or joint, or one inside of it.
        attributes: Element -> the attributes that it has.
        several: Elements that may be stated more than once.
        thing: What it belongs to: noun and name.
    """
    for name in element.attributes:
        if name not in attributes.get(element.tag, ()):
            remarks.add(f"attribute '{name:.60}' of <{element.tag}> ignored", *thing)
    tags = [child.tag for child in element.children]
    for tag in dict.fromkeys(tags):
        if tags.count(tag) > 1 and tag not in several:
            remarks.add(f"all but the first <{tag:.60}> of <{element.tag}> ignored", *thing)
