"""The engine matrix as tests: one for each kind of joint and function of an engine, judged by the truth."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from ..engines.matrix import SEED, Truths, judged, suited
from ..engines.models.kinds import KINDS, tree_of
from ..engines.verdicts import RED, Cell
from ..engines.workers import Job, Worker, registry
from ..reporting.numbers import digits
from .cells import CellFailure, CellItem

# Functions of the smoke tier: what everything else of an engine rests on.
SMOKE = ("mass_matrix", "bias", "gravity", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "link_poses")


@cache
def _worker() -> Worker:
    return Worker()


@cache
def _cells(engine: str, kind: str, functions: tuple[str, ...]) -> dict[str, Cell]:
    """The cells of an engine on the tree of a kind, by function."""
    plugin = registry().plugins[engine]
    job = Job(engine, suited(tree_of(kind), plugin), functions, SEED, further=True)
    return {one.cell.function: one.cell for one in judged(plugin, job, Truths(), _worker())}


class EngineCheck(CellItem):
    """One function of an engine on one kind of joint.

    Args:
        engine: Name of the plug-in.
        kind: Name of the kind of joint.
        function: Name of the function.
        together: Functions that the engine is asked for at once.
        named: Those of `CellItem`.
    """

    def __init__(self, *, engine: str, kind: str, function: str, together: tuple[str, ...], **named: Any) -> None:
        super().__init__(**named)
        self.engine, self.kind, self.wanted, self.together = engine, kind, function, together

    def runtest(self) -> None:
        """Ask the engine, and fail if its answer is wrong, or none."""
        cell = _cells(self.engine, self.kind, self.together)[self.wanted]
        if cell.verdict == "plug-in":
            raise CellFailure(f"{self.engine}, {self.wanted} on {self.kind}: in the plug-in: {cell.words}")
        if cell.verdict in RED:
            stated = cell.words or f"error {digits(cell.error)}"
            raise CellFailure(
                f"{self.engine}, {self.wanted} on {self.kind}: {cell.verdict}: {stated}, "
                f"of the largest entry; rounding explains {digits(cell.tolerance)}"
            )
        if cell.verdict != "right":
            pytest.skip(cell.words or cell.verdict)
        self.user_properties.append(("error", digits(cell.error)))

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Path, line and title of the test in pytest's reports."""
        return Path(self.engine), None, f"symofros::{self.name}"


def engine_checks(parent: Any, engine: str, tier: str) -> Iterator[pytest.Item]:
    """Tests of an engine: of the kinds of joints that it names, or else all, and the functions that it offers."""
    plugin = registry().plugins[engine]
    functions = tuple(name for name in plugin.functions if tier != "smoke" or name in SMOKE)
    for kind in KINDS:
        if not plugin.kinds or kind in plugin.kinds:
            for function in functions:
                name = f"{engine}[{kind}-{function}]".replace(" ", "_")
                made = {"engine": engine, "kind": kind, "function": function, "together": functions, "tier": tier}
                yield EngineCheck.from_parent(parent, name=name, **made)


def finish() -> None:
    """End the process that engines ran in."""
    if _worker.cache_info().currsize:
        _worker().close()
