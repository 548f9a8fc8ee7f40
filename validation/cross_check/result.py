"""The cross-check of one model for programs: `check` of this package, and what it returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import symofros as sf
from symofros.commands.reading import ReadingOptions

from ..adapters import require_engines
from ..checking import ModelResult, Settings, check
from ..comparison.errors import Comparison
from ..contract.interface import Subject
from ..inputs.cases import named
from ..reporting.terminal import plain
from .record import Record, as_data
from .report import compose


@dataclass(frozen=True)
class CheckResult:
    """Outcome of the check of one model: true if an independent engine was asked and everything agrees.

    Attributes:
        settings: States, seed, engines.
        model: The comparisons with sizes, frames, notes, versions and times.
    """

    settings: Settings
    model: ModelResult

    def __bool__(self) -> bool:
        """Whether an independent engine was asked, and nothing disagrees or failed."""
        return self._record.ok and self._record.judged

    @property
    def comparisons(self) -> tuple[Comparison, ...]:
        """All rows with quantity, engine, status, error and tolerance; those that could not be compared have a note."""
        return self.model.comparisons

    @property
    def compared(self) -> list[Comparison]:
        """The rows with a verdict on numbers."""
        return self.model.compared

    @property
    def _record(self) -> Record:
        return Record((self.model,), (), self.settings.states, self.settings.seed, {})

    def __str__(self) -> str:
        """A line for each engine, what was not compared and why, and the verdict."""
        return plain(compose(as_data(self.settings, [self.model], 0.0, ())))


def check_model(
    model: sf.System | str | Path,
    *,
    states: int,
    seed: int,
    engines: Sequence[str] | None,
    floating_base: bool,
    full: bool = False,
) -> CheckResult:
    """The check of one model; arguments are those of `check` of this package."""
    if states < 1:
        raise sf.ArgumentError("check: states", str(states), "at least one state is compared", "states=1 or more")
    try:
        require_engines(engines or ())
    except LookupError as error:
        said, _, known = str(error.args[0]).partition("; there are ")
        raise sf.UnknownNameError(f"check: {said}", said, known, "name one of these") from None
    settings = Settings(states, seed, None if engines is None else tuple(engines), full=full)
    return CheckResult(settings, check(_subject(model, floating_base), settings))


def _subject(model: sf.System | str | Path, floating_base: bool) -> Subject:
    if isinstance(model, sf.System):
        return Subject(model.name, model)
    try:
        (case,) = named([str(model)], ReadingOptions(floating_base))
    except LookupError as error:
        stated = f"check: no model '{model}'", str(error.args[0]), "a system, a file, or a model of the standard set"
        raise sf.UnknownNameError(*stated, "name an existing file") from None
    return case.load()
