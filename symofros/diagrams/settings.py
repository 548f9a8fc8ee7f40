"""How a diagram asks to be run and shown, where its author says so."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any


@dataclass(frozen=True)
class Plot:
    """Curves that belong in one picture.

    Attributes:
        title: Above it.
        signals: Outputs as "block.port", or "block.port[i]" for one entry.
    """

    title: str
    signals: tuple[str, ...]


@dataclass(frozen=True)
class RunSettings:
    """Settings of a run; None where a diagram leaves one to `run_compiled`.

    Attributes:
        t_end: Where to end [s].
        t0: Where to begin [s].
        dt: Step [s].
        method: As of `run_compiled`.
        record: Interval of recording [s].
        rtol: Of adaptive methods.
        atol: Of adaptive methods.
        realtime: Seconds of motion a second, to keep pace with the clock.
        threads: How many share the parts.
        plots: What to show afterwards.
    """

    t_end: float | None = None
    t0: float | None = None
    dt: float | None = None
    method: str | None = None
    record: float | None = None
    rtol: float | None = None
    atol: float | None = None
    realtime: float | None = None
    threads: int | None = None
    plots: tuple[Plot, ...] = ()

    def keywords(self) -> dict[str, Any]:
        """Those that are stated, as a run takes them; without t_end."""
        names = [item.name for item in fields(self) if item.name not in ("t_end", "plots")]
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}
