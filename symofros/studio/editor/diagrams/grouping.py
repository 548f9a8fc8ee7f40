"""Blocks of a diagram that become a subsystem: a diagram in a file of its own, and a part that stands for them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from symofros.studio.editor.editing.data_edits import Edit, EditError, conditions_of, section_of

Json = dict[str, Any]

# The block or part that a signal begins with, and the rest.
_SIGNAL = re.compile(r"([^./]+)(.*)", re.DOTALL)
_WORDS = re.compile(r"\W+")


class Grouping(NamedTuple):
    """What grouping does.

    Attributes:
        inside: The diagram of the subsystem, as the data of its file.
        edits: Edits of the diagram around it, one step of undo.
    """

    inside: Json
    edits: list[Edit]


def grouped(data: Any, name: str, file: str, chosen: Sequence[str]) -> Grouping:
    """Group blocks and parts of a diagram.

    Each signal that enters becomes an inlet, once however many blocks inside read it; each that leaves an outlet.

    Args:
        data: The document of the diagram as plain data.
        name: Name of the part, which nothing there has.
        file: File of the subsystem as the part names it.
        chosen: Ids of blocks and parts, such as "blocks/pd".

    Raises:
        EditError: Nothing is chosen, something that there is not, or blocks that settings of the run or outlets name.
    """
    sections = {section: section_of(data, section) for section in ("blocks", "parts")}
    inner: dict[str, str] = {}
    for key in chosen:
        section, _, one = key.partition("/")
        if section not in sections or one not in sections[section]:
            raise EditError(
                "nothing to group", f"'{key[:50]}'", "blocks and parts of the diagram", "choose some of them"
            )
        inner[one] = section
    if not inner:
        raise EditError("nothing to group", "no block", "a subsystem has blocks", "choose some on the canvas")
    if name in sections["blocks"] or name in sections["parts"]:
        raise EditError(f"'{name}' is taken", "a block or a part of that name", "names are unique", "choose another")
    if section_of(data, "wires"):
        what, rule = "the diagram has wires of its own", "grouping follows the inputs that blocks state"
        raise EditError(what, "a section 'wires'", rule, "state them as inputs of the blocks, in the text")
    return _Group(data, sections, inner, name, file).made()


class _Group:
    def __init__(self, data: Any, sections: Json, inner: dict[str, str], name: str, file: str) -> None:
        self.data, self.sections, self.inner, self.name, self.file = data, sections, inner, name, file
        self.inlets: dict[str, tuple[str, list[str]]] = {}  # Signal outside -> its inlet, the inputs that it feeds.
        self.outlets: dict[str, str] = {}  # Signal inside -> its outlet.

    def made(self) -> Grouping:
        entries = {one: dict(self.sections[section][one]) for one, section in self.inner.items()}
        for one, entry in entries.items():
            kept = {port: source for port, source in _inputs(entry) if not self.enters(f"{one}.{port}", source)}
            entry.pop("inputs", None)
            if kept:
                entry["inputs"] = kept
            for signal, source in conditions_of(entry).items():
                if self.enters(f"{one}.{signal}", source):
                    entry["condition"] = {**entry["condition"], signal: True}
        rewired = [*self.rewired()]
        inside: Json = {"symofros_diagram": 1, "name": self.name}
        used = {entry.get("model") for entry in entries.values()}
        used |= {outer for entry in entries.values() for outer in dict(entry.get("models") or {}).values()}
        models = {one: entry for one, entry in section_of(self.data, "models").items() if one in used}
        inside |= {"models": models} if models else {}
        for section in ("blocks", "parts"):
            if own := {one: entry for one, entry in entries.items() if self.inner[one] == section}:
                inside[section] = own
        if self.inlets:
            inside["inlets"] = {inlet: targets for inlet, targets in self.inlets.values()}
        if self.outlets:
            inside["outlets"] = {outlet: signal for signal, outlet in self.outlets.items()}
        part: Json = {"file": self.file}
        part |= {"models": {one: one for one in models}} if models else {}
        part |= {"inputs": {inlet: source for source, (inlet, _) in self.inlets.items()}} if self.inlets else {}
        gone = [Edit("remove", (section, one)) for one, section in self.inner.items()]
        return Grouping(inside, [*rewired, *gone, Edit("set", ("parts", self.name), part)])

    def enters(self, target: str, source: Any) -> bool:
        """Whether an input is fed from outside, by an inlet from here on."""
        if not isinstance(source, str) or self.owner(source) in self.inner:
            return False
        inlet = self.inlets.setdefault(source, (_fresh(target.rpartition(".")[2], self.taken()), []))
        inlet[1].append(target)
        return True

    def rewired(self) -> Iterator[Edit]:
        """Edits of what reads a signal from inside: blocks around, outlets, plots."""
        for section, entries in self.sections.items():
            for one, entry in entries.items():
                if one in self.inner:
                    continue
                for port, source in _inputs(entry):
                    if isinstance(source, str) and self.owner(source) in self.inner:
                        yield Edit("set", (section, one, "inputs", port), f"{self.name}.{self.leaves(source)}")
                for signal, source in conditions_of(entries[one]).items():
                    if self.owner(source) in self.inner:
                        yield Edit("set", (section, one, "condition", signal), f"{self.name}.{self.leaves(source)}")
        for outlet, source in section_of(self.data, "outlets").items():
            if isinstance(source, str) and self.owner(source) in self.inner:
                yield Edit("set", ("outlets", outlet), f"{self.name}.{self.leaves(source)}")
        for inlet in section_of(self.data, "inlets"):
            what, rule = "the diagram has inlets of its own", "grouping follows the inputs that blocks state"
            raise EditError(what, f"'{inlet}'", rule, "group before inlets are stated, or edit the text")
        for path, text in _plotted(section_of(self.data, "simulation").get("plots"), ("simulation", "plots")):
            found = _SIGNAL.match(text)
            if found and found[1] in self.inner:
                yield Edit("set", path, f"{self.name}/{text}")

    def leaves(self, source: str) -> str:
        """The outlet of a signal inside."""
        return self.outlets.setdefault(source, _fresh(_WORDS.sub("_", source), self.taken()))

    def taken(self) -> set[str]:
        return {inlet for inlet, _ in self.inlets.values()} | {*self.outlets.values()}

    @staticmethod
    def owner(source: str) -> str:
        found = _SIGNAL.match(source)
        return found[1] if found else ""


def _inputs(entry: Any) -> list[tuple[str, Any]]:
    return [*section_of(entry, "inputs").items()]


def _plotted(plots: Any, path: tuple[Any, ...]) -> Iterator[tuple[tuple[Any, ...], str]]:
    """Each signal that plots name, with its place."""
    if isinstance(plots, str):
        yield path, plots
    elif isinstance(plots, list):
        for k, one in enumerate(plots):
            yield from _plotted(one, (*path, k))
    elif isinstance(plots, dict):
        yield from _plotted(plots.get("signals"), (*path, "signals"))


def _fresh(name: str, taken: set[str]) -> str:
    """A name that is not taken, the given one where that is free."""
    return next(one for one in (name, *(f"{name}{k}" for k in range(2, 10_000))) if one not in taken)
