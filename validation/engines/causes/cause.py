"""One cause of red cells: what is wrong in an engine, which cells it explains, and what they offend."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from ..models.covering.edits import parts
from ..verdicts import RED, Cell
from .corrections import CORRECTIONS

FOLDER = Path(__file__).parent / "stated"
# Real faults of releases; what their files say of thread and releases is not stated twice.
_ENTRIES = Path(__file__).parents[2] / "faults" / "entries"
_NO_THREAD = "none found"


@dataclass(frozen=True)
class Cause:
    """What is wrong in an engine, and the rule by which red cells are its consequence.

    The first cause of an engine's file that explains a cell has it. Patterns are matched against whole names.

    Attributes:
        engine: Name of the plug-in; the name of the file.
        name: Name of the cause within its engine.
        what: What is wrong, in one sentence.
        shows: Joints, trees or files that it shows in, in words.
        offends: The line of the engine's documentation, or the derivation, that its answers offend.
        functions: Patterns of the functions' names; what other functions of the same trees answer is not explained.
        trees: Patterns of the trees' names.
        verdicts: Verdicts of the cells.
        words: Pattern that is searched for in the cells' words.
        fault: Name of its entry in `validation/faults/entries`, which has thread and releases; "" where it has none.
        documented: Where the engine says so itself; "" where it does not.
        thread: Public thread; "none found".
        searched: Day on which threads were searched for.
        first: First release that has it, with " or before" where none before it answers; "" where it was not bisected.
        last: Last release that has it; "" where none is right yet, or it was not bisected.
        correction: Name of a correction in `corrections.CORRECTIONS`, which takes the cause out of an answer.
    """

    engine: str
    name: str
    what: str
    shows: str
    offends: str
    functions: tuple[str, ...]
    _: KW_ONLY
    trees: tuple[str, ...] = (".*",)
    verdicts: tuple[str, ...] = RED
    words: str = ""
    fault: str = ""
    documented: str = ""
    thread: str = _NO_THREAD
    searched: str = ""
    first: str = ""
    last: str = ""
    correction: str = ""

    def explains(self, cell: Cell) -> bool:
        """Whether a cell is its consequence."""
        return (
            cell.engine == self.engine
            and cell.verdict in self.verdicts
            and _any(self.functions, cell.function)
            and any(_any(self.trees, name) for name in parts(cell.model))
            and re.search(self.words, cell.words) is not None
        )

    @property
    def known(self) -> str:
        """The public thread, or that none was found, and when it was searched for."""
        thread = self.thread if self.thread != _NO_THREAD else _entry(self.fault).get("thread", _NO_THREAD)
        return f"none found (searched {self.searched})" if thread == _NO_THREAD else thread

    @property
    def releases(self) -> str:
        """The first and last release that have it, as far as they are known."""
        if self.first:
            since = f"{self.first}," if " " in self.first else self.first
            return f"{since} to {self.last}" if self.last else f"{since} on; none is right yet"
        wrong = _entry(self.fault).get("wrong")
        return f"not bisected; {wrong} has it" if wrong else "not bisected"


@cache
def _entry(fault: str) -> dict[str, Any]:
    """What the file of a real fault states; nothing of ""."""
    return _read(_ENTRIES / f"{fault}.yaml") if fault else {}


def _read(path: Path) -> Any:
    return YAML(typ="safe").load(path.read_text(encoding="utf-8"))


def _any(patterns: Iterable[str], name: str) -> bool:
    return any(re.fullmatch(pattern, name) for pattern in patterns)


@cache
def stated() -> tuple[Cause, ...]:
    """All causes, in the order of their files.

    Raises:
        ValueError: A file breaks a rule, with the rule.
    """
    return tuple(cause for path in sorted(FOLDER.glob("*.yaml")) for cause in read(path))


def read(path: Path) -> list[Cause]:
    """The causes that a file states.

    Raises:
        ValueError: The file breaks a rule, with the rule.
    """
    rows: list[dict[str, Any]] = _read(path)
    names = {field.name for field in fields(Cause)} - {"engine"}
    needed = {"name", "what", "shows", "offends", "functions"}
    causes = []
    for row in rows:
        if unknown := row.keys() - names:
            raise ValueError(f"{path.name}: unknown entries: {sorted(unknown)}; a cause has {sorted(names)}")
        if missing := needed - row.keys():
            raise ValueError(f"{path.name}: {row.get('name', 'a cause')}: entries missing: {sorted(missing)}")
        values: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}
        cause = Cause(path.stem, **values)
        for broken, rule in _rules(cause):
            if broken:
                raise ValueError(f"{path.name}: {cause.name}: {rule}")
        causes.append(cause)
    if len({cause.name for cause in causes}) < len(causes):
        raise ValueError(f"{path.name}: each cause has a name of its own")
    return causes


def _rules(cause: Cause) -> list[tuple[bool, str]]:
    """Rules, each with whether it is broken."""
    if cause.fault and not (_ENTRIES / f"{cause.fault}.yaml").exists():
        return [(True, f"`fault` is the name of a file in {_ENTRIES}")]
    return [
        (not cause.known.startswith(("https://", _NO_THREAD)), "a thread is an address"),
        (cause.known.endswith("searched )"), "`searched` says when no thread was found"),
        (bool(cause.correction) and cause.correction not in CORRECTIONS, f"a correction is one of {list(CORRECTIONS)}"),
        (bool(cause.last) and not cause.first, "a last bad release has a first one"),
        (not cause.functions or _any(cause.functions, ""), "a cause names the functions that it shows in"),
    ]
