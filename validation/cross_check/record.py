"""What a check found, as data for JSON, and read back from it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ..adapters import ROUTES, in_order
from ..checking import ModelResult, Settings
from ..comparison.errors import NOBODY, Comparison, Status
from ..comparison.relations import ENGINE as RELATIONS
from ..procedures import ENGINE as FORMULAS
from ..reporting.numbers import finite
from ..reporting.provenance import stamp
from ..reporting.record import Data
from .speed import Speed

SCHEMA = 1
# Where a model was refused before anything was compared.
_BEFORE = ("load", "compile")
# What a comparison states besides its further figures.
_STATED = tuple("model engine quantity states error tolerance ok median worst_state note".split())
# Names in the place of an engine that no engine is behind: our own drift, and what was asked of any of them.
NO_ENGINE = ("symofros", NOBODY, FORMULAS, RELATIONS)
# These, and adapters that are our own code and have no version of their own.
_OURS = frozenset({*NO_ENGINE, *(name for name, route in ROUTES.items() if not route.independent)})


def is_independent(engine: str) -> bool:
    """Whether a name is of an engine that shares no equations with us: not our own C, formulas or readers."""
    return engine not in _OURS


# Quantity -> engine -> states in each bin of BIN_EDGES, all models together.
Distributions = Mapping[str, Mapping[str, Sequence[int]]]


@dataclass(frozen=True)
class Record:
    """One run of the check.

    Attributes:
        models: Results, in the order asked for.
        unfinished: Models that were asked for, but the run was interrupted before.
        states: Random states a model; seed: their seed.
        distributions: Counts of states by error.
        speeds: Speeds of our functions, if they were asked for.
    """

    models: tuple[ModelResult, ...]
    unfinished: tuple[str, ...]
    states: int
    seed: int
    distributions: Distributions
    speeds: tuple[Speed, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether all that was asked for was compared, and nothing disagrees or failed."""
        return bool(self.compared) and all(model.ok for model in self.models) and not self.unfinished

    @property
    def judged(self) -> bool:
        """Whether an engine that shares no equations with us was compared with."""
        return any(is_independent(row.engine) for row in self.compared)

    @property
    def comparisons(self) -> list[Comparison]:
        """All rows."""
        return [row for model in self.models for row in model.comparisons]

    @property
    def compared(self) -> list[Comparison]:
        """The rows with a verdict on numbers."""
        return self.rows("agree", "disagree")

    @property
    def independent(self) -> int:
        """Number of comparisons with engines that share no equations with ours."""
        return sum(is_independent(row.engine) for row in self.compared)

    @property
    def engines(self) -> list[str]:
        """Engines of the comparisons with a verdict on numbers, in the order of reports."""
        return in_order(row.engine for row in self.compared if row.engine not in NO_ENGINE)

    def rows(self, *status: str) -> list[Comparison]:
        """The rows of these statuses."""
        return [row for row in self.comparisons if row.status in status]

    @property
    def refused(self) -> tuple[str, ...]:
        """Models that could not be read or compiled, where nothing else is wrong."""
        wrong = self.rows("disagree", "failed")
        return tuple(row.model for row in wrong) if all(row.quantity in _BEFORE for row in wrong) else ()

    @classmethod
    def of(cls, data: Data) -> Record:
        """The record that `as_data` wrote."""
        rows: dict[str, list[Comparison]] = {model["model"]: [] for model in data["models"]}
        for row in data["comparisons"]:
            rows[row["model"]].append(_comparison(row))
        for row in data["unsupported"]:
            cannot = Comparison(row["model"], row["engine"], row["quantity"], "unsupported", note=row["reason"])
            rows[row["model"]].append(cannot)
        return cls(
            tuple(_model(model, rows[model["model"]]) for model in data["models"]),
            tuple(data["unfinished"]),
            data["settings"]["states"],
            data["settings"]["seed"],
            data.get("distributions", {}),  # Reports of before they were kept have no such figure.
            tuple(Speed(**row) for row in data.get("speeds", ())),
        )


def as_data(
    settings: Settings,
    models: Sequence[ModelResult],
    seconds: float,
    unfinished: Sequence[str],
    speeds: Sequence[Speed] = (),
) -> dict[str, Any]:
    """Everything, for JSON; None where there is no number."""
    rows = [row for model in models for row in model.comparisons]
    counts: dict[str, dict[str, list[int]]] = {}
    for row in rows:
        if row.counts and row.status in ("agree", "disagree"):
            by_engine = counts.setdefault(row.quantity, {})
            before = by_engine.get(row.engine, [0] * len(row.counts))
            by_engine[row.engine] = [a + b for a, b in zip(before, row.counts, strict=True)]
    origin = stamp()
    for model in models:
        origin["versions"] |= {name: version for name, version in model.versions.items() if name not in _OURS}
    compared = any(row.status in ("agree", "disagree") for row in rows)
    return {
        "schema": SCHEMA,
        "ok": compared and all(model.ok for model in models) and not unfinished,
        # Of the comparisons with a verdict on numbers.
        "independent": sum(is_independent(row.engine) for row in rows if row.status in ("agree", "disagree")),
        "comparisons": [_entry(row) for row in rows if row.status != "unsupported"],
        "unsupported": [
            {"model": row.model, "engine": row.engine, "quantity": row.quantity, "reason": row.note}
            for row in rows
            if row.status == "unsupported"
        ],
        "unfinished": list(unfinished),
        "seconds": round(seconds, 1),
        "settings": asdict(settings),
        **origin,
        "models": [
            {
                "model": model.label,
                "hash": model.hash,
                **model.sizes,
                "frames": model.frames,
                "notes": model.notes,
                "seconds": {stage: round(seconds, 3) for stage, seconds in model.seconds.items()},
            }
            for model in models
        ],
        "distributions": counts,
        **({"speeds": [asdict(row) for row in speeds]} if speeds else {}),
    }


def _entry(row: Comparison) -> dict[str, Any]:
    stated = {name: getattr(row, name) for name in _STATED if name != "note" or row.note}
    if row.error is not None:
        stated["error"] = finite(row.error)  # Infinite where nothing was found to compare.
    return stated | {name: finite(value) for name, value in row.extra.items()}


def _comparison(row: Data) -> Comparison:
    """What has no tolerance was not judged: it failed."""
    extra = {name: math.nan if value is None else value for name, value in row.items() if name not in _STATED}
    status: Status = "agree" if row["ok"] else "disagree" if row["tolerance"] else "failed"
    stated = {name: row[name] for name in _STATED if name not in ("ok", "note")}
    return Comparison(**stated, status=status, note=row.get("note", ""), extra=extra)


def _model(data: Data, rows: Sequence[Comparison]) -> ModelResult:
    sizes = {name: data[name] for name in ("nq", "nv", "nu", "bodies") if name in data}
    return ModelResult(
        data["model"],
        tuple(rows),
        data["hash"],
        sizes,
        tuple(data["frames"]),
        tuple(data["notes"]),
        seconds=dict(data["seconds"]),
    )
