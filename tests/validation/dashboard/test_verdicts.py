"""The report of each topic can turn bad, and says so in its summary."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from validation.dashboard.catalogue import TOPICS
from validation.pareto.figures import MOST
from validation.reporting.command import code

REPORTS = Path(__file__).parents[3] / "reports"


def stored(name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((REPORTS / f"{name}.json").read_text(encoding="utf-8"))
    return data


def spoil_check(data: dict[str, Any]) -> None:
    data["comparisons"][0].update(ok=False, error=None)


def spoil_campaign(data: dict[str, Any]) -> None:
    data["ok"] = data["groups"][0]["agree"] = False


def spoil_mutation(data: dict[str, Any]) -> None:
    data["ok"] = False
    data["models"][0]["survived"] = [{"kind": "sign flipped", "node": 3, "error": 0.1}]


def spoil_oracle(data: dict[str, Any]) -> None:
    data["ok"] = False
    row = data["comparisons"][0]
    row["digits"][next(iter(row["digits"]))] = 3.0


def spoil_fuzz(data: dict[str, Any]) -> None:
    data["ok"] = False
    data["faults"] = [{"kind": "yaml", "number": 7, "what": "RecursionError"}]


def spoil_studies(data: dict[str, Any]) -> None:
    data["ok"] = False
    study = next(iter(data["studies"].values()))
    study["ok"] = False
    study["findings"][0].update(value=None)


def spoil_stability(data: dict[str, Any]) -> None:
    data["ok"] = False
    study = next(iter(data["studies"].values()))
    study["ok"] = False
    study["findings"][0].update(value=None)


def spoil_timing(data: dict[str, Any]) -> None:
    data["failed"].append(["panda", "dynamics", "pinocchio", "no compiler"])


def spoil_pareto(data: dict[str, Any]) -> None:
    data["ok"] = False
    problem = next(iter(data["problems"].values()))
    problem["targets"][0].update(found=None, ok=False)


@pytest.mark.parametrize(
    ("name", "spoil", "says"),
    [
        ("check", spoil_check, "1 of "),
        ("campaign", spoil_campaign, "1 do not agree"),
        ("mutation", spoil_mutation, "faults that matter are caught (99.9"),
        ("oracle", spoil_oracle, "not all agree: "),
        ("fuzz", spoil_fuzz, "1 crashed or hung"),
        ("accuracy", spoil_studies, "1 miss their bounds"),
        ("diagrams", spoil_studies, "1 miss their bounds"),
        ("stability", spoil_stability, "1 miss their bounds"),
        ("timing", spoil_timing, "1 could not be timed"),
        ("pareto", spoil_pareto, "targets met"),
    ],
)
def test_a_report_turns_bad(name: str, spoil: Any, says: str) -> None:
    data = stored(name)
    spoil(data)
    report = TOPICS[name].compose(data)
    assert report.ok is False and code(report) == 1 and says in report.summary


def test_the_index_says_of_timing_what_its_page_says() -> None:
    report = TOPICS["timing"].compose(stored("timing"))
    met = report.facts[0]
    assert report.summary.startswith(f"{met.value} targets are met") and report.ok is met.ok


def test_no_two_methods_look_alike() -> None:
    report = TOPICS["pareto"].compose(stored("pareto"))
    drawings = [c for section in report.sections for block in section.blocks for c in getattr(block, "charts", ())]
    assert len(drawings) == 2 * (len(report.sections) - 1)
    for drawing in drawings:
        axes = Figure().subplots()
        drawing.paint(axes)
        series = axes.get_legend_handles_labels()[0]
        assert 1 <= len({line.get_color() for line in series}) == len({line.get_marker() for line in series}) <= MOST


def test_an_interrupt_comes_before_a_verdict() -> None:
    data = stored("stability") | {"ok": False, "unfinished": ["spin"]}
    report = TOPICS["stability"].compose(data)
    assert code(report) == 130 and "Interrupted: spin not done." in report.summary
