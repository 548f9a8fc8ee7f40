"""A run of the check held to a stored one: which cell became less accurate, slower, or is compared no more.

Accuracy: the states are the same (same seed, same description), so that an error moves only with the arithmetic.
Another compiler or processor sums in another order and moves it by a small factor; a fault moves it by decades.
Speed: ratios to a fixed program (`speed`), which tell something only on the same kind of machine; the bound follows
from the noise of both runs.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ..comparison.errors import Comparison
from ..procedures import ENGINE as FORMULAS
from ..reporting.numbers import digits
from ..reporting.record import Data
from .record import SCHEMA, Record
from .speed import Speed

# Errors that rounding alone may reach from nothing: some sums of some hundred terms.
ROUNDING_ERROR = 256 * 2.0**-53
# Growth of an error that another order of summation explains.
GROWTH = 8.0
# Quantities that have a decade or more of their own from run to run: what a search or an extrapolation leaves over,
# as a share of the tolerance that is always allowed. So have all procedures, which iterate.
EXEMPT = {"energy_drift": 1.0, "retained_order": 1.0}
# Slowdown that is always allowed, and how many times the noise of both runs.
MIN_SLOWDOWN, NOISES = 0.10, 2.0
# Slowdown that a comparison is to find; where the noise hides it, the comparison is not decided.
LOOKED_FOR = 0.25
# What must be the same for speeds to be compared.
_MACHINE = ("processor", "system")


class BaselineError(Exception):
    """A file can't serve as the baseline of a run; the message is for people."""


@dataclass(frozen=True)
class Regression:
    """One cell that is worse than in the stored run.

    Attributes:
        model, engine, quantity: Name of the cell; the engine is "" for a speed.
        kind: What became worse.
        text: By how much, and what was allowed.
    """

    model: str
    engine: str
    quantity: str
    kind: str
    text: str


@dataclass(frozen=True)
class Baseline:
    """A stored run.

    Attributes:
        name: Name of its file.
        record: What it found.
        revision: Revision of the source that it was made by; date: when.
        machine: What its speeds depend on.
    """

    name: str
    record: Record
    revision: str
    date: str
    machine: tuple[str, ...]

    @classmethod
    def read(cls, path: Path) -> Baseline:
        """The run that a check.json holds.

        Raises:
            BaselineError: The file can't be read, or is no finished run of the check.
        """
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise BaselineError(f"baseline {path}: it can't be read as JSON: {error}") from None
        if not isinstance(data, dict) or data.get("schema") != SCHEMA or "comparisons" not in data:
            remedy = "give the check.json that `symofros check --report FOLDER` writes"
            raise BaselineError(f"baseline {path}: it is no record of a check of schema {SCHEMA}; {remedy}")
        try:
            record = Record.of(data)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise BaselineError(f"baseline {path}: a record of a check, but damaged: {error!r}") from None
        if record.unfinished:
            raise BaselineError(
                f"baseline {path}: that run was interrupted; {', '.join(record.unfinished)} are missing"
            )
        return cls(path.name, record, data.get("revision", ""), data.get("date", ""), machine_of(data))

    def require(self, states: int, seed: int) -> None:
        """Refuse a run over other states.

        Raises:
            BaselineError: They are others.
        """
        if (states, seed) != (self.record.states, self.record.seed):
            stored = f"--states {self.record.states} --seed {self.record.seed}"
            raise BaselineError(f"baseline {self.name}: its states are others; run the check with {stored}")

    def judge(self, record: Record, machine: tuple[str, ...]) -> tuple[list[Regression], list[str]]:
        """The regressions of a run, and notes on what was not compared or not decided.

        Raises:
            BaselineError: The runs were asked different things.
        """
        self.require(record.states, record.seed)
        notes: list[str] = []
        stored_models = {model.label: model for model in self.record.models}
        same = set()
        for model in record.models:
            if model.label not in stored_models:
                notes.append(f"{model.label}: not in the baseline")
            elif model.hash != stored_models[model.label].hash:
                notes.append(f"{model.label}: its description has changed since; nothing of it is compared")
            else:
                same.add(model.label)
        regressions = list(self._less_accurate(record, same))
        if self.record.speeds and machine != self.machine:
            notes.append(f"speeds: made on another machine ({', '.join(filter(None, self.machine))}); not compared")
        elif self.record.speeds:
            regressions += self._slower(record.speeds, same)
            notes += self._undecided(record.speeds, same)
        return regressions, notes

    def _less_accurate(self, record: Record, models: set[str]) -> Iterator[Regression]:
        now = {_key(row): row for row in record.comparisons}
        for row in self.record.rows("agree"):
            if row.model not in models:
                continue
            if _key(row) not in now:
                yield Regression(*_key(row), "not compared", "it was compared in the baseline, and is no more")
                continue
            fresh = now[_key(row)]
            if fresh.status != "agree" or fresh.error is None or row.error is None:
                said = fresh.note or ("no number" if fresh.error is None else f"error {digits(fresh.error)}")
                yield Regression(*_key(row), fresh.status, f"it agreed with {digits(row.error)}; now: {said}")
                continue
            share = 1.0 if row.engine == FORMULAS else EXEMPT.get(row.quantity, 0.0)
            allowed = max(GROWTH * row.error, ROUNDING_ERROR, share * row.tolerance)
            if fresh.error > allowed:
                text = f"error {digits(fresh.error)}, was {digits(row.error)}; allowed {digits(allowed)}"
                yield Regression(*_key(row), "less accurate", text)

    def _slower(self, speeds: tuple[Speed, ...], models: set[str]) -> Iterator[Regression]:
        now = {(row.model, row.function): row for row in speeds}
        for row in self.record.speeds:
            fresh = now.get((row.model, row.function))
            if row.model in models and fresh is not None and fresh.ratio > slowest(row, fresh):
                growth, allowed = fresh.ratio / row.ratio - 1.0, slowest(row, fresh) / row.ratio - 1.0
                text = f"{growth:.0%} slower than {row.ratio:.3g} yardsticks; allowed {allowed:.0%}"
                yield Regression(row.model, "", row.function, "slower", text)

    def _undecided(self, speeds: tuple[Speed, ...], models: set[str]) -> Iterator[str]:
        """Notes on speeds in whose noise a slowdown above LOOKED_FOR would not show."""
        now = {(row.model, row.function): row for row in speeds}
        for row in self.record.speeds:
            fresh = now.get((row.model, row.function))
            if row.model not in models or fresh is None or fresh.ratio > slowest(row, fresh):
                continue
            hidden = slowest(row, fresh) / row.ratio - 1.0
            if hidden > LOOKED_FOR:
                yield (
                    f"{row.model}, {row.function}: not decided, a slowdown of {hidden:.0%} would not show in the noise"
                    f" ({row.noise:.1%} then, {fresh.noise:.1%} now); run the check on a machine at rest"
                )


def slowest(stored: Speed, fresh: Speed) -> float:
    """The ratio up to which the noise of the two explains a slowdown."""
    return stored.ratio * (1.0 + max(MIN_SLOWDOWN, NOISES * (stored.noise + fresh.noise)))


def machine_of(data: Data) -> tuple[str, ...]:
    """What speeds depend on: processor, system, compiler, flags; "" where the data lacks one."""
    machine = data.get("machine", {})
    return (
        *(str(machine.get(name, "")) for name in _MACHINE),
        str(data.get("compiler", "")),
        str(data.get("flags", "")),
    )


def _key(row: Comparison) -> tuple[str, str, str]:
    return row.model, row.engine, row.quantity
