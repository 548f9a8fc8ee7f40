"""A request to a worker process: its data, its progress, what its text describes; numbers and tables of the answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import numpy as np

from symofros.description import System, in_order
from symofros.description.yaml import read_yaml
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.reader import read_diagram
from symofros.errors import DescriptionError, SymofrosError
from symofros.mechanics.topology import find_problems

Json = dict[str, Any]
ORDERS = ("pause", "resume", "stop")


@dataclass
class Tell:
    """What a worker tells while it works, and the orders that reach it.

    Attributes:
        say: Function that sends one message to the server.
        orders: Orders that nobody has followed yet, each one of ORDERS.
    """

    say: Callable[[Json], None]
    orders: SimpleQueue[str] = field(default_factory=SimpleQueue)

    def __call__(self, done: int, total: int, text: str, paused: bool = False) -> None:
        """Tell how far the work is."""
        self.say({"progress": {"done": done, "total": total, "text": text, "paused": paused}})


def system_of(request: Json) -> System:
    """The system of a request's text.

    Raises:
        DescriptionError: It is not a mechanism.
    """
    reading = read_yaml(Path(request["file"]), request["text"])
    problems = find_problems(reading.system, reading.broken) if reading.system is not None else []
    if reading.system is None or reading.problems or problems:
        raise DescriptionError(in_order([*reading.problems, *problems]))
    return reading.system


def number_of(given: Any, what: str, from_zero: bool = False) -> float:
    """A finite number of a request; at least zero if `from_zero`.

    Raises:
        SymofrosError: It is none.
    """
    try:
        number = float(given)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number) or (from_zero and number < 0.0):
        rule = "a finite number from zero" if from_zero else "a finite number"
        raise SymofrosError(f"{what} is not a number", f"{given!r:.100}", rule, "mend it")
    return number


def diagram_of(request: Json) -> Diagram:
    """The diagram of a request's text; its blocks run the native code of files that the request has consent to.

    Raises:
        DescriptionError: It can't be read.
    """
    diagram, problems = read_diagram(Path(request["file"]), request["text"], allow_native=request.get("native", {}))
    if problems or diagram is None:
        raise DescriptionError(problems)
    return diagram


def table(caption: str, head: Sequence[str], rows: Sequence[Sequence[Any]]) -> Json:
    """A table of the page; numbers that are not finite are null."""
    cells = [[x if isinstance(x, str) else numbers_for_json([x])[0] for x in row] for row in rows]
    return {"caption": caption, "head": list(head), "rows": cells}


def numbers_for_json(values: Any) -> list[float | None]:
    """Numbers as JSON holds them; None where one is not finite, as after a run that diverged."""
    return [x if math.isfinite(x) else None for x in np.asarray(values, dtype=np.float64).tolist()]
