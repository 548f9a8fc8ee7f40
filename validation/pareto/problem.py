"""Benchmark problems of the work-precision comparison: contestants, error measures, references, targets."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial

from ..reporting.plain import Number

OURS = "symofros"


@dataclass(frozen=True)
class Measured:
    """One run.

    Attributes:
        error: Against the problem's reference, in its unit; NaN if the run did not come to its end.
        seconds: Time of the processor, stepping only.
        ended: Why it did not come to its end; "" if it did.
    """

    error: float
    seconds: float
    ended: str = ""


@dataclass(frozen=True)
class Contestant:
    """One way through a problem: a model, a method, a step or tolerance.

    Attributes:
        who: OURS, or the engine.
        model: Modes, elements, how loops are closed: what is approximated in space. One colour of a chart.
        method: The integrator.
        setting: Step or tolerance.
        run: Does it once.
    """

    who: str
    model: str
    method: str
    setting: str
    run: Callable[[], Measured]

    @classmethod
    def swept(
        cls, series: tuple[str, str, str], run: Callable[[float], Measured], settings: Iterable[float], adapts: bool
    ) -> list[Contestant]:
        """One for each step [s], or for each relative tolerance of a method that adapts its steps.

        Args:
            series: Engine, model and method.
            run: Step or tolerance -> one run.
            settings: Steps or tolerances.
            adapts: Which of them.
        """
        settings = tuple(settings)
        shown = (f"rtol {x:.0e}".replace("e-0", "e-") if adapts else f"{1e3 * x:.3g} ms" for x in settings)
        return [cls(*series, said, partial(run, x)) for said, x in zip(shown, settings, strict=True)]


@dataclass(frozen=True)
class Point:
    """A contestant that was run.

    Attributes:
        who, model, method, setting: As the contestant states them.
        error: Measured error.
        seconds: Time of the processor, least of the repeats.
        ended: Reason of an early end; "" for none.
    """

    who: str
    model: str
    method: str
    setting: str
    error: Number
    seconds: Number
    ended: str = ""

    @property
    def series(self) -> tuple[str, str, str]:
        """Engine, model and method, which stay the same while the step varies."""
        return self.who, self.model, self.method

    @property
    def by(self) -> str:
        """The method, with the engine that it is of."""
        return self.method if self.who == OURS else f"{self.who}: {self.method}"


@dataclass(frozen=True)
class Target:
    """Factor by which we are to be faster than an engine's best at the same error.

    Attributes:
        engine: The engine whose best is compared with ours.
        error: The error, in the problem's unit.
        ratio: Lower bound of the engine's seconds over ours.
    """

    engine: str
    error: float
    ratio: float


@dataclass(frozen=True)
class Prepared:
    """A problem whose references and models are ready.

    Attributes:
        contestants: Compiled and assembled, so that a run is stepping only.
        agreement: Distance of two independent references, in the unit of errors.
        references: Origin of the references, in words.
        floors: Error that a beam model leaves at any step, by what it retains.
    """

    contestants: tuple[Contestant, ...]
    agreement: float
    references: str
    floors: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class BenchmarkProblem:
    """A moving system on which solvers are compared by work and precision.

    Attributes:
        title: Name of the moving system.
        setting: Start, duration and output interval, in words.
        measure: Definition of the error, in words.
        axis: The same in a few words, with the unit.
        tuned: Tuning of each side, in words.
        prepare: Whether quickly -> what is to run.
        targets: Ratios that are asked for.
        trust: Errors above this must be above the references' disagreement.
        sources: Origins of parameters and references.
        percent: Whether errors are shares, and read best as such.
    """

    title: str
    setting: str
    measure: str
    axis: str
    tuned: str
    prepare: Callable[[bool], Prepared]
    targets: tuple[Target, ...]
    trust: float
    sources: tuple[str, ...]
    percent: bool = False

    def shown(self, error: float) -> str:
        """An error for people."""
        return (
            f"{100 * error:.{3 if error >= 0.995 else 2}g} %" if self.percent else f"{error:.1e}".replace("e-0", "e-")
        )
