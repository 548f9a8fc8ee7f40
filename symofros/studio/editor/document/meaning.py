"""The meaning of a text: its data, what is drawn of it, and everything wrong with it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from typing import Any

from symofros.description import System
from symofros.diagrams.external_block import NativeCode

Json = dict[str, Any]


@dataclass(frozen=True)
class Analysis:
    """A text's meaning.

    Attributes:
        readable: Whether it is YAML at all; if not, there are no data.
        data: The YAML as JSON holds it.
        graph: Bodies and joints of a mechanism.
        problems: Problems as the page shows them.
        parameters: Parameters; those that could not be read have no number.
        inputs: Inputs that could be read.
        system: System that was read; None where nothing could be.
        diagram: Blocks and signals of a diagram; None of a mechanism.
        mechanisms: Name of a block -> system that it moves, of a diagram without problems.
        native: Block -> native code that it runs, of a diagram without problems.
        lines: Name of an element -> its first and last line in the text; empty of a text that is not readable.
    """

    readable: bool
    data: Any = None
    graph: Json = field(default_factory=lambda: {"nodes": [], "edges": []})
    problems: list[Json] = field(default_factory=list)
    parameters: list[Json] = field(default_factory=list)
    inputs: list[Json] = field(default_factory=list)
    system: System | None = None
    diagram: Json | None = None
    mechanisms: dict[str, System] = field(default_factory=dict)
    native: dict[str, NativeCode] = field(default_factory=dict)
    lines: dict[str, tuple[int, int]] = field(default_factory=dict)


def as_json(value: Any) -> Any:
    """Plain data that JSON can hold: a number that is not finite becomes the text that YAML writes for it."""
    if isinstance(value, dict):
        return {key: as_json(item) for key, item in value.items()}
    if isinstance(value, list):
        return [as_json(item) for item in value]
    if isinstance(value, float) and not isfinite(value):
        return ".nan" if value != value else ".inf" if value > 0 else "-.inf"
    return value
