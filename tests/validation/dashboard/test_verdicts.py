"""The report of each topic can turn bad, and says so in its summary."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from validation.dashboard.catalogue import TOPICS
from validation.reporting.command import code
from validation.reporting.record import Table

REPORTS = Path(__file__).parents[3] / "reports"


def stored(name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((REPORTS / f"{name}.json").read_text(encoding="utf-8"))
    return data


STUDY = {"ok": False, "studies/*/ok": False, "studies/*/findings/0/value": None}
SURVIVOR = [{"kind": "sign flipped", "node": 3, "error": 0.1}]
CRASH = [{"kind": "yaml", "number": 7, "what": "RecursionError"}]
# Report -> what its summary says, and the entries that make it bad; * is the first of a mapping.
SPOILT: dict[str, tuple[str, dict[str, Any]]] = {
    "check": ("1 of ", {"comparisons/0/ok": False, "comparisons/0/error": None}),
    "campaign": ("1 do not agree", {"ok": False, "groups/0/agree": False}),
    "mutation": ("faults that matter are caught (99.9", {"ok": False, "models/0/survived": SURVIVOR}),
    "oracle": ("not all agree: ", {"ok": False, "comparisons/0/digits/*": 3.0}),
    "fuzz": ("1 crashed or hung", {"ok": False, "faults": CRASH}),
    "accuracy": ("1 miss their bounds", STUDY),
    "diagrams": ("1 miss their bounds", STUDY),
    "stability": ("1 miss their bounds", STUDY),
    "timing": ("1 could not be timed", {"failed": [["panda", "dynamics", "pinocchio", "no compiler"]]}),
    "pareto": ("targets met", {"ok": False, "problems/*/targets/0/found": None, "problems/*/targets/0/ok": False}),
}


@pytest.mark.parametrize("name", SPOILT)
def test_a_report_turns_bad(name: str) -> None:
    data, (says, changes) = stored(name), SPOILT[name]
    for path, value in changes.items():
        at: Any = {"": data}
        key: Any = ""
        for step in path.split("/"):
            at = at[key]
            key = next(iter(at)) if step == "*" else int(step) if isinstance(at, list) else step
        at[key] = value
    report = TOPICS[name].compose(data)
    assert report.ok is False and code(report) == 1 and says in report.summary


def test_an_interrupt_comes_before_a_verdict() -> None:
    data = stored("stability") | {"ok": False, "unfinished": ["energy"]}
    report = TOPICS["stability"].compose(data)
    assert code(report) == 130 and "Interrupted: energy not done." in report.summary


def test_the_first_screen_of_the_stability_atlas_says_what_to_use() -> None:
    data = stored("stability")
    (table,) = TOPICS["stability"].compose(data).decisions
    assert isinstance(table, Table) and len(table.rows) == len(data["studies"])
    assert ("[How do long loops drift without stabilisation?](#long_loops)", "projection.") in table.rows
