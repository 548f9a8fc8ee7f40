"""How a diagram asks to be run and shown, where its author says so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from symofros.base.arguments import check_fields
from symofros.simulation.stepping.methods import METHODS


@dataclass(frozen=True)
class Plot:
    """Curves that belong in one picture.

    Attributes:
        title: Above it.
        signals: Outputs as "block.port", or "block.port[i]" for one entry.
        xy: Whether the second entry of each signal is drawn over its first, at one scale, in place of both over time.
    """

    title: str
    signals: tuple[str, ...]
    xy: bool = False


@dataclass(frozen=True)
class RunSettings:
    """Settings of a run; None where a diagram leaves one to `run_compiled`.

    Attributes:
        t_end: End time [s].
        t0: Start time [s].
        dt: Step [s].
        method: Method as of `run_compiled`.
        record: Interval of recording [s].
        rtol: Relative bound of the local error of adaptive methods.
        atol: Absolute bound of the local error of adaptive methods.
        beam_limit: Estimated error of the beams' theory beyond which a run ends.
        realtime: Seconds of motion a second, to keep pace with the clock.
        threads: Number of threads that share the parts.
        plots: Plots to show afterwards.
    """

    t_end: float | None = None
    t0: float | None = None
    dt: float | None = None
    method: str | None = None
    record: float | None = None
    rtol: float | None = None
    atol: float | None = None
    beam_limit: float | None = None
    realtime: float | None = None
    threads: int | None = None
    plots: tuple[Plot, ...] = ()

    def __post_init__(self) -> None:
        """Refuse values of the wrong type."""
        check_fields(self)

    def keywords(self) -> dict[str, Any]:
        """The stated settings as keywords of a run, without `t_end` and `plots`."""
        names = [item.name for item in fields(self) if item.name not in ("t_end", "plots")]
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def keywords_with(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """The keywords with some replaced; bounds of errors stay behind where a method of fixed steps is chosen."""
        chosen = METHODS.get(str(changes.get("method")))
        left = () if chosen is None or chosen.adaptive else ("rtol", "atol")
        return {name: value for name, value in self.keywords().items() if name not in left} | dict(changes)
