"""A parameter study as data: a question, two parameters, a criterion, the methods or engines, the verdict."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

import symofros as sf

from ..mechanics.geometry import Array
from ..reporting.findings import Finding

# What an Outcome is called when nothing went wrong, here as in `symofros.Outcome`.
FINISHED = ("finished", "event")
# A description that is not compiled, or a state that is not assembled: an error in words, before anything moves.
REFUSED = "refused"


@dataclass(frozen=True)
class Grid:
    """The values of one parameter.

    Attributes:
        name: Name and unit.
        values: Values of the whole map, rising.
        few: Values of the quick map.
        labels: Names of categories, whose values are 0, 1, 2, ...
        log: Whether it is drawn by its logarithm.
    """

    name: str
    values: tuple[float, ...]
    few: tuple[float, ...]
    labels: tuple[str, ...] = ()
    log: bool = True

    @classmethod
    def of(cls, name: str, labels: tuple[str, ...], few: tuple[str, ...] = ()) -> Grid:
        """A grid axis of categories."""
        return cls(
            name,
            tuple(map(float, range(len(labels)))),
            tuple(float(labels.index(x)) for x in few or labels),
            labels,
            log=False,
        )

    def chosen(self, quick: bool) -> tuple[float, ...]:
        """The values to run."""
        return self.few if quick else self.values

    def label(self, value: float) -> str:
        """A value for people."""
        return self.labels[int(value)] if self.labels else f"{value:.4g}"


def decades(low: float, high: float, each: int) -> tuple[float, ...]:
    """Values from low to high, so many a decade, evenly by their logarithms."""
    count = round(math.log10(high / low) * each)
    return tuple(float(f"{x:.4g}") for x in np.geomspace(low, high, count + 1))


@dataclass(frozen=True)
class Cell:
    """One run.

    Attributes:
        value: Value of the criterion's quantity; NaN if the run did not come to its end.
        ended: The kind of its Outcome, or "refused".
        note: Reason of the end, or first line of the refusal.
    """

    value: float
    ended: str = "finished"
    note: str = ""

    def __post_init__(self) -> None:
        """Check that a completed run has a finite number."""
        if self.ended in FINISHED and not math.isfinite(self.value):
            raise ArithmeticError(f"a run is said to be {self.ended} and has no number: {self.value} {self.note}")


def cell(run: sf.Trajectory, value: Callable[[sf.Trajectory], float]) -> Cell:
    """Cell of a run: its criterion, or NaN with the reason of its failure; notes are kept."""
    outcome = run.outcome
    note = "; ".join((*(() if outcome.ok else (outcome.reason,)), *outcome.notes))
    if not outcome.ok:
        return Cell(math.nan, outcome.kind, note)
    # A criterion that overflows belongs to a run whose states grew without bound, but not to infinity.
    with np.errstate(over="ignore", invalid="ignore"):
        criterion = float(value(run))
    return Cell(criterion if math.isfinite(criterion) else 1e300, outcome.kind, note)


def simulate(model: sf.Model, *given: Any, **settings: Any) -> sf.Trajectory:
    """`sf.simulate`, which makes an outcome of Ctrl-C: here it ends the atlas, not the run alone.

    Beams may bend as they like: the atlas judges by itself where motions fail.
    """
    run = sf.simulate(model, *given, **({"beam_limit": math.inf} | settings))
    if run.outcome.kind == "interrupted" and run.outcome.reason.startswith("Ctrl-C"):
        raise KeyboardInterrupt
    return run


def longest(holds: Callable[[float], bool], low: float, high: float, within: float = 1e-4) -> float:
    """The largest value that holds, by bisection in the logarithm; `low` must hold and `high` must not."""
    while high / low > 1.0 + within:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def refused(error: Exception) -> Cell:
    """The cell of a run that was refused, with the reason."""
    return Cell(math.nan, REFUSED, str(error).splitlines()[0])


@dataclass(frozen=True)
class Limit:
    """A line over the map: a closed form.

    Attributes:
        label: Name in the legend.
        x: Points (n); for categories, between -0.5 and their number - 0.5.
        form: x -> y (n), evaluated when the map is drawn: it may need models.
    """

    label: str
    x: Array
    form: Callable[[Array], Array]


@dataclass(frozen=True)
class Subject:
    """A method, formulation or engine to run over the grid.

    Attributes:
        name: A method, a formulation, or an engine.
        measure: (x, y) -> what the run comes to.
        limits: Closed forms.
    """

    name: str
    measure: Callable[[float, float], Cell]
    limits: tuple[Limit, ...] = ()


@dataclass(frozen=True)
class Map:
    """Results of one subject over the grid.

    Attributes:
        subject: Method, formulation or engine that was run.
        x: Values (nx).
        y: Values (ny).
        cells: Outcome of each run (ny, nx).
        bound: Bound of the criterion.
    """

    subject: Subject
    x: Array
    y: Array
    cells: tuple[tuple[Cell, ...], ...]
    bound: float

    @cached_property
    def values(self) -> Array:
        """(ny, nx), NaN where a run did not come to its end."""
        return np.array([[c.value for c in row] for row in self.cells])

    @cached_property
    def good(self) -> npt.NDArray[np.bool_]:
        """Whether the criterion is met (ny, nx)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.values <= self.bound)

    def count(self, *kinds: str) -> int:
        """Runs that ended so."""
        return sum(c.ended in kinds for row in self.cells for c in row)

    @property
    def stopped(self) -> int:
        """Runs that ended by themselves before their end, with an Outcome, or were refused."""
        return sum(c.ended not in FINISHED for row in self.cells for c in row)

    @property
    def wrong(self) -> int:
        """Runs that came to their end and miss the criterion: nothing but a check of the result tells."""
        return int((~self.good).sum()) - self.stopped

    def at(self, x: float | None = None, y: float | None = None) -> Array:
        """The values of a row, of a column, or of one cell (an array of one)."""
        columns = slice(None) if x is None else [self._index(self.x, x)]
        rows = slice(None) if y is None else [self._index(self.y, y)]
        return np.asarray(self.values[rows][:, columns]).ravel()

    @staticmethod
    def _index(values: Array, value: float) -> int:
        return int(np.argmin(np.abs(values - value)))

    def edge(self, axis: str) -> list[tuple[float, float, float]]:
        """(other parameter, last good, first bad) of each line along an axis that begins good and turns bad."""
        along, across, good = (self.y, self.x, self.good.T) if axis == "y" else (self.x, self.y, self.good)
        edges = []
        for other, line in zip(across, good, strict=True):
            if line[0] and not line.all():
                first = int(np.argmin(line))
                edges.append((float(other), float(along[first - 1]), float(along[first])))
        return edges

    def miss(self, axis: str, limit: Callable[[float], float]) -> float:
        """The largest factor by which a closed form lies outside the steps of the grid where good turns bad.

        Args:
            axis: Axis of the parameter that the closed form bounds.
            limit: The other parameter -> that bound.

        Returns:
            1 where the grid can't tell the edge from the closed form; NaN where there is no edge.
        """
        factors = [max(low / limit(other), limit(other) / high, 1.0) for other, low, high in self.edge(axis)]
        return max(factors, default=math.nan)


@dataclass(frozen=True)
class Verdict:
    """What follows from the maps.

    Attributes:
        statement: Result in words, with its numbers.
        see: Caption of the maps.
        findings: Claims with bounds.
    """

    statement: str
    see: str
    findings: tuple[Finding, ...]


Maps = dict[str, Map]


@dataclass(frozen=True)
class ParameterStudy:
    """Runs over a grid of two parameters, judged against closed forms.

    Attributes:
        question: Question that the maps answer.
        setting: System, start and duration, in words.
        x: Parameter along; y: across.
        quantity: Quantity that the criterion bounds, with its unit.
        bound: Bound of the criterion: at most so much is good.
        subjects: Methods, formulations or engines to run.
        judge: Maps by subject -> verdict.
        advice: Remedy, and methods or models to use instead.
        sources: Origins of closed forms and reference numbers.
    """

    question: str
    setting: str
    x: Grid
    y: Grid
    quantity: str
    bound: float
    subjects: tuple[Subject, ...]
    judge: Callable[[Maps], Verdict]
    advice: str
    sources: tuple[str, ...] = field(default=())

    def runs(self, quick: bool) -> int:
        """Number of runs that the study takes."""
        return len(self.subjects) * len(self.x.chosen(quick)) * len(self.y.chosen(quick))


def survey(study: ParameterStudy, quick: bool, done: Callable[[], None] = lambda: None) -> Maps:
    """Run every cell of every map; `done` is called after each."""
    xs, ys = study.x.chosen(quick), study.y.chosen(quick)

    def measured(subject: Subject, x: float, y: float) -> Cell:
        measured = subject.measure(x, y)
        done()
        return measured

    return {
        subject.name: Map(
            subject,
            np.array(xs),
            np.array(ys),
            tuple(tuple(measured(subject, x, y) for x in xs) for y in ys),
            study.bound,
        )
        for subject in study.subjects
    }
