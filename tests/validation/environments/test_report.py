"""The report of recorded numbers, and what the command takes of a worker's messages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from validation.environments import worker
from validation.environments.in_jax import JAX
from validation.environments.in_torch import TORCH
from validation.environments.record import NATIVE, OURS, Absent, Record, Row
from validation.environments.report import TOPIC, take
from validation.reporting.command import composed
from validation.reporting.plain import plain
from validation.reporting.record import Report
from validation.timing.worker import Message


def row(who: str, least: float, ratio: float = 1.0, states: int = 1024, **others: Any) -> Row:
    made = Row("jax", "panda", "forward_dynamics", states, who, least, 1.1 * least, ratio, 2e-14)
    return replace(made, **others)


ROWS = [
    row(OURS, 90.0),
    row(NATIVE, 60.0, 0.67, error=0.0),
    row("frax", 6600.0, 73.0),
    row(OURS, 20_000.0, states=1),
    row("frax", 900_000.0, 45.0, states=1),
    row(OURS, 1e6, environment="torch"),
]


def report(ok: bool = True, **of: Any) -> Report:
    record = Record(**{"rows": ROWS, "packages": {"jax": "0.10"}} | of)
    return composed(TOPIC, {"ok": ok, "failures": {}, "unfinished": [], "turns": 3, **plain(record)})


def test_a_record_is_good_where_something_was_measured_and_nothing_differs() -> None:
    assert Record(rows=ROWS).ok and not Record().ok
    assert not Record(rows=[row(OURS, 1.0, error=1e-3)]).ok
    assert not Record(rows=ROWS, failed=[("jax", "f", "frax", "differs")]).ok


def test_messages_of_a_worker_become_a_record() -> None:
    record, said = Record(), list[str]()
    absent = Absent("jax", "frax", "frax is not installed", "pip install frax")
    messages: list[Message] = [
        ("doing", ("panda", "compiling")),
        ("row", ROWS[0]),
        ("absent", absent),
        ("failed", ("jax", "forward_dynamics", "MJX", "differs")),
        ("version", ("jax", "0.10")),
    ]
    for message in messages:
        take(message, record, said.append)
    assert record.rows == ROWS[:1] and said == ["panda: compiling"] and record.packages == {"jax": "0.10"}
    assert record.absent == [absent] and record.failed == [("jax", "forward_dynamics", "MJX", "differs")]


@pytest.mark.parametrize("environment", [JAX, TORCH])
def test_a_missing_framework_is_reported_with_its_command(environment: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> Any:
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(worker, "import_module", absent)
    ((kind, value),) = worker.work(environment.name, ["planar2R"], [1], 1)
    assert kind == "absent" and value.who == OURS and value.remedy.startswith("pip install")
