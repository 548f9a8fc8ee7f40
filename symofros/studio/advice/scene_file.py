"""A scene's YAML file in. It is as untrusted as a model: bounded, without tags, formulas by the whitelist."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, TypeVar

from symofros.base.arguments import checked
from symofros.description import as_value, read_bytes
from symofros.description.yaml import Node, YamlFault, compose
from symofros.errors import DescriptionError, ShapeError, did_you_mean
from symofros.simulation.inputs import Signal
from symofros.studio.advice.scene import KINDS, Output, Scene

MAX_BYTES = 1 << 20
Made = TypeVar("Made")
_ENTRIES = ("t_end", "outputs", "inputs", "start", "keep", "fixed_step", "samples")
_OUTPUT = (*KINDS, "absolute", "relative")
_SIGNAL = ("t", "values", "kind")


@checked
def load_scene(path: str | os.PathLike[str]) -> Scene:
    """Read a scene.

    Args:
        path: A YAML file, described in docs/advise.md.

    Raises:
        DescriptionError: With the line of the first entry that does not fit.
    """
    file = Path(path)
    try:
        root, repeated = compose(read_bytes(file, MAX_BYTES), str(file))
    except YamlFault as error:
        raise DescriptionError(error.problem) from None
    if repeated:
        raise DescriptionError(repeated)
    return _Reader(str(file)).scene(root)


class _Reader:
    """Nodes to nouns."""

    def __init__(self, file: str) -> None:
        self.file = file

    def fault(self, node: Node, what: str, found: object, rule: str, remedy: str) -> DescriptionError:
        return DescriptionError(f"scene: {what}", f"{found}"[:80], rule, remedy, f"{self.file}:{node.line}")

    def scene(self, root: Node) -> Scene:
        entries = self.mapping(root, "the file", _ENTRIES)
        for needed in ("t_end", "outputs"):
            if needed not in entries:
                raise self.fault(
                    root,
                    f"entry '{needed}' is missing",
                    ", ".join(entries) or "nothing",
                    "a scene says how long it lasts and what matters",
                    f"add {needed}",
                )
        fields: dict[str, Any] = {"t_end": self.number(entries["t_end"], "t_end")}
        outputs = self.mapping(entries["outputs"], "outputs")
        fields["outputs"] = tuple(self.output(name, node) for name, node in outputs.items())
        for section, read in (("inputs", self.input), ("start", self.number)):
            if section in entries:
                given = self.mapping(entries[section], section)
                fields[section] = {name: read(node, f"{section}: '{name}'") for name, node in given.items()}
        if "keep" in entries:
            fields["keep"] = tuple(self.text(item, "keep") for item in self.listed(entries["keep"], "keep"))
        if "fixed_step" in entries:
            fields["fixed_step"] = self.one_of(entries["fixed_step"], "fixed_step", (True, False))
        if "samples" in entries:
            fields["samples"] = int(self.number(entries["samples"], "samples"))
        return self.built(root, lambda: Scene(**fields))

    def output(self, name: str, node: Node) -> Output:
        entries = self.mapping(node, f"output '{name}'", _OUTPUT)
        kinds = [kind for kind in KINDS if kind in entries]
        if len(kinds) != 1:
            raise self.fault(
                node,
                f"output '{name}' is not of one thing",
                ", ".join(entries) or "nothing",
                f"it has one of {', '.join(KINDS)}",
                "for example position: tip",
            )
        sizes = {key: self.number(entries[key], key) for key in ("absolute", "relative") if key in entries}
        of = self.text(entries[kinds[0]], f"output '{name}'")
        return self.built(node, lambda: Output(name, kinds[0], of, **sizes))

    def input(self, node: Node, what: str) -> Any:
        """A number, a formula that parses, or samples."""
        if isinstance(node.value, dict):
            entries = self.mapping(node, what, _SIGNAL)
            arrays = {
                key: [self.number(item, what) for item in self.listed(entries[key], what)]
                for key in ("t", "values")
                if key in entries
            }
            if len(arrays) < 2:
                raise self.fault(node, f"{what}: samples lack a part", ", ".join(entries), "t and values", "give both")
            kind: Any = self.one_of(entries["kind"], what, ("linear", "hold")) if "kind" in entries else "linear"
            return self.built(node, lambda: Signal(arrays["t"], arrays["values"], kind))
        if isinstance(node.value, str):
            self.built(node, lambda: as_value(node.value, what))
            return node.value
        return self.number(node, what)

    def built(self, node: Node, make: Callable[[], Made]) -> Made:
        """Object made by a constructor; an error is raised with the line of its node."""
        try:
            return make()
        except DescriptionError as error:
            one = error.problems[0]
            where = f"{self.file}:{node.line}"
            raise DescriptionError(one.what, one.found, one.rule, one.remedy, where) from None
        except ShapeError as error:
            raise self.fault(
                node, f"{error}", node.plain(), "numbers come as many as are asked for", "state as many entries as that"
            ) from None

    def mapping(self, node: Node, what: str, known: Collection[str] = ()) -> dict[str, Node]:
        if not isinstance(node.value, dict):
            raise self.fault(node, f"{what} is not a mapping", node.plain(), "entries are name: value", "see the docs")
        entries: dict[str, Node] = node.value
        for key, value in entries.items():
            if known and key not in known:
                raise self.fault(
                    value,
                    f"unknown entry '{key}' in {what}",
                    f"'{key}'",
                    f"one of {', '.join(known)}",
                    did_you_mean(key, known),
                )
        return entries

    def listed(self, node: Node, what: str) -> list[Node]:
        if not isinstance(node.value, list):
            raise self.fault(node, f"{what} is not a list", node.plain(), "a list in brackets", "write [a, b]")
        entries: list[Node] = node.value
        return entries

    def number(self, node: Node, what: str) -> float:
        value = node.value
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise self.fault(node, f"{what} is not a number", node.plain(), "a finite number", "such as 0.5")
        return float(value)

    def text(self, node: Node, what: str) -> str:
        if not isinstance(node.value, str):
            raise self.fault(node, f"{what} is not a name", node.plain(), "a name", "put it in quotes")
        return node.value

    def one_of(self, node: Node, what: str, known: tuple[Any, ...]) -> Any:
        if isinstance(node.value, (dict, list)) or node.value not in known:
            raise self.fault(
                node, f"{what}: unknown choice", node.plain(), f"one of {', '.join(map(str, known))}", "choose one"
            )
        return node.value
