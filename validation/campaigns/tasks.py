"""A batch of a campaign: what a worker is sent, and the rows it makes of it. The same batch gives the same rows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import pyarrow as pa

from ..checking import ModelResult, Settings
from ..inputs.cases import Case
from ..worker_pool import run_case
from .plan import CheckPlan, Plan, SweepPlan, cases
from .sweep import Sweeper

# One row a batch, engine and quantity. `worst_state` counts the states that were compared: with constraints,
# those in reach; `scale` is what the error of that state is relative to, in the unit of the quantity.
CHECKED = pa.schema(
    [
        ("batch", pa.int64()),
        ("model", pa.string()),
        ("first_state", pa.int64()),
        ("states_asked", pa.int64()),
        ("engine", pa.string()),
        ("quantity", pa.string()),
        ("status", pa.string()),
        ("agree", pa.bool_()),
        ("states", pa.int64()),
        ("error", pa.float64()),
        ("worst_state", pa.int64()),
        ("scale", pa.float64()),
        ("tolerance", pa.float64()),
        ("median", pa.float64()),
        ("note", pa.string()),
    ]
)


class Task(Protocol):
    """One batch."""

    @property
    def number(self) -> int:
        """Position of this task's part in the order of results."""
        ...

    @property
    def size(self) -> int:
        """States or points."""
        ...

    @property
    def title(self) -> str:
        """Human-readable title of the task."""
        ...

    def run(self) -> pa.Table:
        """Run the batch."""
        ...


@dataclass(frozen=True)
class CheckTask:
    """Cross-check some states of one model."""

    number: int
    case: Case
    settings: Settings

    @property
    def size(self) -> int:
        """Number of states."""
        return self.settings.states

    @property
    def title(self) -> str:
        """The model and its states."""
        first = self.settings.first
        return f"{self.case.label} {first}…{first + self.size - 1}"

    def run(self) -> pa.Table:
        """Cross-check the model at the batch's states; an exception becomes a row."""
        rows = self._rows(run_case(self.case, self.settings))
        return pa.Table.from_pylist(list(rows), CHECKED)

    def _rows(self, result: ModelResult) -> Iterator[dict[str, Any]]:
        for row in result.comparisons:
            yield {
                "batch": self.number,
                "model": row.model,
                "first_state": self.settings.first,
                "states_asked": self.settings.states,
                "engine": row.engine,
                "quantity": row.quantity,
                "status": row.status,
                "agree": row.ok if row.status in ("agree", "disagree") else None,
                "states": row.states,
                "error": row.error,
                "worst_state": row.worst_state,
                "scale": row.scale,
                "tolerance": row.tolerance,
                "median": row.median,
                "note": row.note,
            }


@dataclass(frozen=True)
class SweepTask:
    """Evaluate some points of a sweep."""

    number: int
    case: Case
    plan: SweepPlan
    first: int
    size: int

    @property
    def title(self) -> str:
        """The model and its points."""
        return f"{self.case.label} {self.first}…{self.first + self.size - 1}"

    def run(self) -> pa.Table:
        """Points that fail say so in `outcome`."""
        return Sweeper(self.plan, self.case).table(self.number, self.first, self.size)


def tasks(plan: Plan) -> list[Task]:
    """The batches, numbered in the order they are handed out.

    Raises:
        PlanError: A model is not there.
    """
    models = cases(plan)
    if isinstance(plan, SweepPlan):
        size = plan.size
        starts = enumerate(range(0, size, plan.batch))
        return [SweepTask(k, models[0], plan, first, min(plan.batch, size - first)) for k, first in starts]
    return [CheckTask(k, case, settings) for k, (case, settings) in enumerate(_shares(plan, models))]


def _shares(plan: CheckPlan, models: list[Case]) -> Iterator[tuple[Case, Settings]]:
    """Each model in turn, so that the time left is guessed from all of them."""
    whole, more = divmod(plan.states, len(models))
    wanted = [whole + (k < more) for k in range(len(models))]
    for first in range(0, max(wanted), plan.batch):
        for case, states in zip(models, wanted, strict=True):
            if first < states:
                count = min(plan.batch, states - first)
                yield case, Settings(count, plan.seed, plan.engines, first)
