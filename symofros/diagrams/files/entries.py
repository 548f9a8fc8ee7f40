"""Entries of a file as plain values; each fault is noted with its line, and reading goes on."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from symofros.description.yaml import Node
from symofros.errors import MAX_PROBLEMS, Problem, did_you_mean


class Entries:
    """Reads nodes of one file.

    Args:
        file: File name as it is shown.
        problems: List that receives the faults; the files of one diagram share it.
    """

    def __init__(self, file: str, problems: list[Problem]) -> None:
        self.file, self.problems = file, problems

    def where(self, node: Node, key: bool = False) -> str:
        """Place of a node, or of its key, as "file:line"."""
        return f"{self.file}:{node.key_line if key else node.line}"

    def fault(self, node: Node, what: str, found: object, rule: str, remedy: str) -> None:
        """Note a fault; the list does not grow without bounds."""
        if len(self.problems) < MAX_PROBLEMS:
            self.problems.append(Problem(what, f"{found}"[:80], rule, remedy, self.where(node)))

    def take(self, node: Node, problems: Sequence[Problem], key: bool = False) -> None:
        """Note faults that others found, at a node, or its key, where they have no place."""
        for one in problems[: max(0, MAX_PROBLEMS - len(self.problems))]:
            where = one.where or self.where(node, key)
            self.problems.append(Problem(one.what, one.found, one.rule, one.remedy, where))

    def mapping(self, node: Node, what: str, known: Collection[str] = ()) -> dict[str, Node]:
        """The entries of a mapping, unknown ones noted and left out; nothing where it is none."""
        if node.value is None:
            return {}
        if not isinstance(node.value, dict):
            self.fault(
                node, f"{what} is not a mapping", node.plain(), "entries are name: value", "see docs/diagrams.md"
            )
            return {}
        good = {}
        for key, value in node.value.items():
            if known and key not in known:
                self.fault(
                    value,
                    f"{what}: unknown entry '{key:.60}'",
                    f"'{key:.60}'",
                    f"one of {', '.join(known)}",
                    did_you_mean(key, known),
                )
            else:
                good[key] = value
        return good

    def listed(self, node: Node, what: str) -> list[Node]:
        """The items of a list; nothing where it is none."""
        if isinstance(node.value, list):
            return node.value
        self.fault(node, f"{what} is not a list", node.plain(), "a list in brackets", "write [a, b]")
        return []

    def text(self, node: Node, what: str, longest: int = 200) -> str:
        """A text; "" where it is none."""
        if isinstance(node.value, str) and 0 < len(node.value) <= longest:
            return node.value
        self.fault(
            node, f"{what} is not a name", node.plain(), f"a text of up to {longest} characters", "put it in quotes"
        )
        return ""

    def number(self, node: Node, what: str) -> float:
        """A finite number; NaN where it is none."""
        value = node.value
        if not isinstance(value, bool) and isinstance(value, (int, float)) and math.isfinite(value):
            return float(value)
        self.fault(node, f"{what} is not a number", node.plain(), "a finite number", "such as 0.5")
        return math.nan

    def numbers(self, node: Node, what: str) -> dict[str, float]:
        """A mapping from names to numbers, those that are none left out."""
        values = {key: self.number(item, f"{what}: '{key:.60}'") for key, item in self.mapping(node, what).items()}
        return {key: value for key, value in values.items() if not math.isnan(value)}

    def texts(self, node: Node, what: str) -> dict[str, str]:
        """A mapping from names to texts."""
        return {key: self.text(item, f"{what}: '{key:.60}'") for key, item in self.mapping(node, what).items()}

    def one_of(self, node: Node, what: str, known: Collection[Any]) -> Any:
        """One of some values; None where it is none of them."""
        if not isinstance(node.value, (dict, list)) and node.value in known:
            return node.value
        self.fault(
            node,
            f"{what}: unknown choice",
            node.plain(),
            f"one of {', '.join(map(str, known))}",
            did_you_mean(str(node.value)[:80], list(map(str, known))),
        )
        return None

    def missing(self, node: Node, what: str, name: str, there: Mapping[str, Any], rule: str) -> bool:
        """Whether an entry is missing, which is noted."""
        if name in there:
            return False
        self.fault(node, f"{what}: '{name}' is missing", ", ".join(there) or "nothing", rule, f"add {name}")
        return True
