"""What an importer ignored or changed, gathered by kind and said in one line each."""

from __future__ import annotations

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
