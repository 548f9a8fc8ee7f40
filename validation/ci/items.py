"""Cross-checks and the engine matrix as tests.

Of a check one for each model and engine, and one for each model's share of a stored run; of the matrix one for each
kind of joint and function of an engine, judged by the truth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
from symofros.commands.reading import OPTIONS, ReadingOptions, reading_of

from ..adapters import ROUTES, require_engines
from ..checking import ModelResult, Settings
from ..comparison.errors import Comparison
from ..cross_check.baseline import Baseline, BaselineError, Regression, machine_of
from ..cross_check.record import Record, as_data, is_independent
from ..cross_check.speed import Speed, measure
from ..cross_check.tables import failure
from ..engines.matrix import SEED, Truths, judged, suited
from ..engines.models.kinds import KINDS, tree_of
from ..engines.verdicts import RED, Cell
from ..engines.workers import Job, Worker, registry
from ..inputs.cases import Case, named
from ..inputs.sampling import DEFAULT_STATES
from ..reporting.numbers import digits
from ..worker_pool import run_case


class CellFailure(Exception):
    """Cells that are wrong, worse than before, or were not compared at all; the message lists them."""


class CellItem(pytest.Item):
    """A test of one or several cells.

    Args:
        tier: Name of the tier.
        named: Others that pytest sets.
    """

    def __init__(self, *, tier: str, **named: Any) -> None:
        super().__init__(**named)
        self.add_marker("symofros")
        self.add_marker(f"symofros_{tier}")

    def repr_failure(self, excinfo: Any, style: Any = None) -> Any:
        """The cells alone; another exception with its traceback."""
        return str(excinfo.value) if isinstance(excinfo.value, CellFailure) else super().repr_failure(excinfo, style)


# Functions of the smoke tier: what everything else of an engine rests on.
_BASIC = ("mass_matrix", "bias", "gravity", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "link_poses")


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
    functions = tuple(name for name in plugin.functions if tier != "smoke" or name in _BASIC)
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


# Models of the smoke tier, where none is named: each kind of mechanism once, all of them small.
SMOKE = ("double_pendulum", "heavy_top", "cart_pole", "four_bar", "rolling_disc", "flexible_pendulum")


@dataclass(frozen=True)
class Tier:
    """Size of a tier.

    Attributes:
        states: Random states a model.
        models: Names of models where none is named; empty for the standard set.
    """

    states: int
    models: tuple[str, ...] = ()


TIERS = {"smoke": Tier(20, SMOKE), "standard": Tier(200), "full": Tier(DEFAULT_STATES)}


@cache
def _result(case: Case, settings: Settings) -> ModelResult:
    return run_case(case, settings)


@cache
def _speeds(case: Case) -> tuple[Speed, ...]:
    return tuple(measure(case.load()))


class CrossCheck(CellItem):
    """One model by one engine: every quantity that both have.

    Args:
        case: The model.
        settings: States, seed, the one engine.
        named: Those of `CellItem`.
    """

    def __init__(self, *, case: Case, settings: Settings, **named: Any) -> None:
        super().__init__(**named)
        self.case, self.settings = case, settings

    def runtest(self) -> None:
        """Check, and fail with the cells that disagree."""
        result = _result(self.case, self.settings)
        wrong = [row for row in result.comparisons if row.status in ("disagree", "failed") and not row.unconfirmed]
        if wrong:
            raise CellFailure("\n".join(map(_stated, wrong)))
        (engine,) = self.settings.engines or ("",)
        compared = [row for row in result.comparisons if row.engine == engine and row.status == "agree"]
        if not compared:
            reasons = dict.fromkeys(row.note for row in result.comparisons if row.engine == engine and row.note)
            pytest.skip("; ".join(reasons) or f"{engine} has nothing to compare on {self.case.label}")
        self.user_properties += [(row.quantity, digits(row.error)) for row in compared]

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Path, line and title of the test in pytest's reports."""
        return self.case.path or Path(self.case.label), None, f"symofros::{self.name}"


class BaselineCheck(CrossCheck):
    """One model held to a stored run."""

    def __init__(self, *, stored: Baseline, **named: Any) -> None:
        super().__init__(**named)
        self.stored = stored

    def runtest(self) -> None:
        """Check by all engines of the stored run, and fail with the cells that are worse."""
        result = _result(self.case, self.settings)
        speeds = _speeds(self.case) if self.stored.record.speeds and result.sizes else ()
        data = as_data(self.settings, [result], 0.0, (), speeds)
        regressions, notes = self.stored.judge(Record.of(data), machine_of(data))
        mine = [worse for worse in regressions if worse.model == self.case.label]
        if mine:
            raise CellFailure("\n".join(map(_worse, mine)))
        if any(note.startswith(f"{self.case.label}:") for note in notes):
            pytest.skip("; ".join(notes))


class Confirmation(CrossCheck):
    """One model by all engines: agreement with nobody would confirm nothing."""

    def runtest(self) -> None:
        """Fail where no independent engine had anything to compare."""
        asked = [name for name in self.settings.engines or () if is_independent(name)]
        rows = [
            row for name in asked for row in _result(self.case, replace(self.settings, engines=(name,))).comparisons
        ]
        if not any(is_independent(row.engine) for row in rows if row.status == "agree"):
            reasons = dict.fromkeys(f"{row.engine}: {row.note}" for row in rows if row.note and not row.unconfirmed)
            raise CellFailure("\n".join(["no independent engine confirms this model", *reasons]))


class CrossChecks(pytest.Collector):
    """The parent of all cross-checks, the first part of their names."""

    def collect(self) -> list[pytest.Item]:
        """The tests come from `cross_checks`; pytest asks no collector that is not of a file."""
        return []


def _require(engine: str, of_models: bool) -> None:
    """Refuse an engine that there is not, or where models are named the one that they are checked against.

    Raises:
        UsageError: It is of no use; the message says why.
    """
    if engine in ROUTES:
        return
    if of_models or engine not in registry().plugins:
        try:
            require_engines([engine])
        except LookupError as error:
            raise pytest.UsageError(f"--symofros-engine {engine}: {error.args[0]}") from None


def cross_checks(session: Any, config: Any) -> Iterator[pytest.Item]:
    """The tests that the options ask for.

    Raises:
        UsageError: An option is of no use; the message says why.
    """
    tier = config.getoption("--symofros-tier")
    named_models = config.getoption("--symofros-model")
    asked = config.getoption("--symofros-engine") or list(ROUTES)
    engines = [name for name in asked if named_models or name in ROUTES]
    parent = CrossChecks.from_parent(session, name="symofros", nodeid="symofros")
    for engine in asked:
        _require(engine, bool(named_models))
        if not named_models and engine in registry().plugins:
            yield from engine_checks(parent, engine, tier)
    if not engines:
        return
    cases = _cases(list(named_models or TIERS[tier].models), config)
    states = TIERS[tier].states
    stored = _stored(config.getoption("--symofros-baseline"))

    def test(kind: type[CrossCheck], case: Case, suffix: str, settings: Settings, **more: Any) -> pytest.Item:
        name = f"{case.label}[{suffix}]"
        made: pytest.Item = kind.from_parent(parent, name=name, case=case, settings=settings, tier=tier, **more)
        return made

    for case in cases:
        for engine in engines:
            yield test(CrossCheck, case, engine, Settings(states, 0, (engine,)))
        if named_models or not config.getoption("--symofros-engine"):
            yield test(Confirmation, case, "confirmed", Settings(states, 0, tuple(engines)))
        if stored is not None:
            settings = Settings(stored.record.states, stored.record.seed, tuple(stored.record.engines))
            yield test(BaselineCheck, case, "baseline", settings, stored=stored)


def _cases(models: list[str], config: Any) -> list[Case]:
    """The models of some names or files.

    Raises:
        UsageError: There is none of a name, or it can't be read.
    """
    try:
        return named(models, _reading(config))
    except (LookupError, FileNotFoundError) as error:
        raise pytest.UsageError(f"--symofros-model: {error.args[0]}") from None
    except sf.SymofrosError as error:
        raise pytest.UsageError(error.in_shell("--symofros-")) from None


def _reading(config: Any) -> ReadingOptions:
    """Options for reading models, from those of the pytest command line."""
    stated = {item.name: config.getoption(f"--symofros-{item.metadata['flag']}") for item in OPTIONS}
    try:
        return reading_of(**stated, prefix="--symofros-")
    except sf.SymofrosError as error:
        raise pytest.UsageError(str(error)) from None


def _stored(path: str | None) -> Baseline | None:
    if path is None:
        return None
    try:
        return Baseline.read(Path(path))
    except BaselineError as error:
        raise pytest.UsageError(f"--symofros-baseline: {error}") from None


def _stated(row: Comparison) -> str:
    return f"{row.model}, by {row.engine}: {failure(row)}"


def _worse(worse: Regression) -> str:
    by = f" by {worse.engine}" if worse.engine else ""
    return f"{worse.model}, {worse.quantity}{by}: {worse.kind}: {worse.text}"
