"""Numbers in the sentences of earlier summaries -> a figure of how they went over commits."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ..reporting.figures import Chart, Curve, Figure
from ..reporting.numbers import short
from .history import Stored

_DAY = 86400.0
_AXIS = "time, the newest summary at 0  [days]"
_MARGIN = 1.04  # Of the time, that is shown: marks at its ends are whole.
_SIZE = (285.0, 190.0)  # Of a picture [px]: three beside each other, one on a phone.
_SAME = 0.05  # Of a number: what repeats of a measurement differ by.


@dataclass(frozen=True)
class _Series:
    """A number of a report's sentence.

    Attributes:
        pattern: Finds it in its group.
    """

    label: str
    report: str
    pattern: str

    def value(self, said: str) -> float | None:
        """The number, if the sentence has it."""
        found = re.search(self.pattern, said)
        return float(found[1].replace(" ", "")) if found else None


@dataclass(frozen=True)
class _Trend:
    """One picture: numbers of one unit."""

    title: str
    y: str
    series: tuple[_Series, ...]
    log: bool = False


def _ratio(engine: str) -> _Series:
    return _Series(engine, "timing", rf"over ours: .*\b{engine} ([\d.]+)×")


_TRENDS = (
    _Trend(
        "speed against others",
        "median of their time over ours  [1]",
        tuple(map(_ratio, ("pinocchio", "mujoco", "casadi", "sympy"))),
        log=True,
    ),
    _Trend(
        "targets",
        "number of targets  [1]",
        (
            _Series("timing met", "timing", r"(\d+) of \d+ targets"),
            _Series("timing stated", "timing", r"\d+ of (\d+) targets"),
            _Series("pareto met", "pareto", r"(\d+) of \d+ targets"),
            _Series("pareto stated", "pareto", r"\d+ of (\d+) targets"),
        ),
    ),
    _Trend(
        "faults seen",
        "share of faults planted in our source  [%]",
        (
            _Series("seen by check alone", "mutants", r"`check` alone sees ([\d.]+)%"),
            _Series("seen by check and tests", "mutants", r"tests ([\d.]+)%"),
        ),
    ),
    _Trend(
        "what is compared",
        "number  [1]",
        (
            _Series("comparisons of check", "check", r"(\d[\d ]*) comparisons"),
            _Series("cells of engines that are right", "engines", r"(\d[\d ]*) cells right"),
            _Series("cells that are wrong", "engines", r"(\d[\d ]*) red"),
            _Series("faults planted in our source", "mutants", r"(\d[\d ]*) faults in"),
        ),
        log=True,
    ),
    _Trend(
        "own speed",
        "steps a second and core  [million/s]",
        (_Series("7-joint arm; changes with the machine", "rollouts", r"([\d.]+) million steps a second"),),
    ),
)


def trends(summaries: Sequence[Stored]) -> Figure:
    """How numbers went: a point a measurement, at the commit that brought it.

    Args:
        summaries: The latest first.

    Returns:
        No charts where nothing was measured twice.
    """
    charts, went = [], []
    newest, oldest = (summaries[0].time, summaries[-1].time) if summaries else (0.0, 0.0)
    days = _MARGIN * (oldest - newest) / _DAY, (_MARGIN - 1.0) * (newest - oldest) / _DAY
    for trend in _TRENDS:
        drawn, moved = [], []
        for k, series in enumerate(trend.series):
            times, values = _points(series, summaries)
            if len(values) < 2:
                continue
            drawn.append(Curve(series.label, [(time - newest) / _DAY for time in times], values, k, "steps"))
            if abs(values[-1] - values[0]) > _SAME * abs(values[0]):
                first, last = (short(float(f"{values[end]:.3g}")) for end in (0, -1))
                moved.append(f"{series.label.partition(';')[0]} {first} → {last}")
        if drawn:
            name = f"Over commits: {trend.title}"
            charts.append(
                Chart(name, _AXIS, trend.y, tuple(drawn), log="y" if trend.log else "", range_x=days, size=_SIZE)
            )
            went += [f"{trend.title}: {', '.join(moved)}"] if moved else []
    apart = f"{100 * _SAME:.0f} %"
    said = (
        f"Moved by more than {apart} from first to last: {'; '.join(went)}." if went else f"Nothing moved by {apart}."
    )
    return Figure(f"A point a measurement, at the commit that brought it. {said}", tuple(charts))


def _points(series: _Series, summaries: Sequence[Stored]) -> tuple[list[float], list[float]]:
    """Times [s] and values of a series, the oldest first; a report that was not made anew gives none."""
    times: list[float] = []
    values: list[float] = []
    last = None
    for summary in reversed(summaries):
        line = summary.lines.get(series.report)
        value = series.value(line.said) if line is not None else None
        if line is None or value is None or (line.made or line.said) == last:
            continue
        last = line.made or line.said
        times.append(summary.time)
        values.append(value)
    return times, values
