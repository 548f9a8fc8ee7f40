"""The page that answers whether one may trust all this: each figure is that of a stored report."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from validation.cross_check.record import is_independent
from validation.dashboard.catalogue import TOPICS
from validation.dashboard.gather import Entry, gather
from validation.dashboard.index import headline, index
from validation.dashboard.trust import features_of, trust
from validation.reporting import html
from validation.reporting.record import Report, Search

REPORTS = Path(__file__).parents[3] / "reports"


def stored(name: str) -> Any:
    return json.loads((REPORTS / f"{name}.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def entries() -> dict[str, Entry]:
    return gather(REPORTS, {})


@pytest.fixture(scope="module")
def report(entries: dict[str, Entry]) -> Report:
    return trust(entries)


def rows_of(report: Report) -> dict[str, tuple[str, ...]]:
    blocks = (block for section in report.sections for block in section.blocks)
    (search,) = (block for block in blocks if isinstance(block, Search))
    return {str(row[0]): tuple(map(str, row[1:])) for row in search.table.rows}


def test_its_answers_are_figures_of_the_reports(report: Report) -> None:
    said = html.page(report)
    check, timing = stored("check"), stored("timing")
    assert f"{check['independent']} of {check['independent']} comparisons with independent engines agree" in said
    assert f"{len(check['models'])} models" in said and f"0 of {check['independent']}" not in said
    races = {(row["model"], row["function"], row["peer"]) for row in timing["entries"]}
    assert f"of {len(races)} races" in said
    # Routes to an engine are no further engines.
    engines = {row["engine"].partition("-")[0] for row in check["comparisons"] if is_independent(row["engine"])}
    assert f"models agree with each independent engine that can represent them ({', '.join(sorted(engines))})" in said


def test_its_rows_are_found_by_joint_loop_beam_format_and_engine(report: Report) -> None:
    rows = rows_of(report)
    assert {model["model"] for model in stored("check")["models"]} <= rows.keys()
    found = {word: {name for name, row in rows.items() if word in " ".join((name, *row))} for word in _WORDS}
    assert "stewart" in found["closed loop"] and "pendulum" not in found["closed loop"]
    assert "flexible_arm" in found["beam"] and "ur5" not in found["beam"]
    assert "heavy_top" in found["ball"] and "ur5" in found["URDF"] and "creature" in found["MJCF"]
    assert "urdf: plain" in rows and "ur5" in found["pinocchio"]


_WORDS = ("closed loop", "beam", "ball", "URDF", "MJCF", "pinocchio")


def test_features_of_a_model_are_those_of_the_compared_description() -> None:
    hashes = {model["model"]: model["hash"] for model in stored("check")["models"]}
    assert features_of({"four_bar": hashes["four_bar"]})["four_bar"].parts == ("1 closed loop",)
    assert features_of({"four_bar": "another", "unknown": ""}) == {}


def spoilt(folder: Path, **changes: Any) -> dict[str, Entry]:
    data = stored("check")
    data["comparisons"] = [row for row in data["comparisons"] if row["model"] == "ur5"]
    data["models"] = [model for model in data["models"] if model["model"] == "ur5"]
    data["unsupported"] = []
    for row in data["comparisons"]:
        row |= changes if row["engine"] == "pinocchio" else {}
    (folder / "check.json").write_text(json.dumps(data | {"ok": not changes}))
    return gather(folder, {})


def test_disagreeing_engines_come_first_and_in_red(tmp_path: Path) -> None:
    sound = trust(spoilt(tmp_path))
    assert sound.ok and "pinocchio" in rows_of(sound)["ur5"][1] and "not pinocchio" not in rows_of(sound)["ur5"][1]
    entries = spoilt(tmp_path, ok=False, error=0.5)
    wrong = trust(entries)
    assert wrong.ok is False and "check found something wrong" in wrong.summary
    assert "**not pinocchio**" in rows_of(wrong)["ur5"][1] and rows_of(wrong)["ur5"][3].startswith("0.3 in ")
    assert headline(entries).startswith("Something is wrong in check;")
    page = html.page(index(entries), listed=False)
    assert '<td class="wrong">' in page and '<main class="aims">' not in page


def test_missed_targets_are_yellow_and_nothing_else_is(entries: dict[str, Entry]) -> None:
    missed = [name for name, entry in entries.items() if entry.verdict == "missed"]
    assert all(entries[name].report.aims for name in missed)  # type: ignore[union-attr]
    page = html.page(index(entries), listed=False)
    assert page.count('<td class="short">') == len(missed) and '<td class="wrong">' not in page.partition("<details")[0]
    assert all(name in headline(entries) for name in missed)


def test_every_report_has_one_line_on_the_index(entries: dict[str, Entry]) -> None:
    page = html.page(index(entries), listed=False)
    tables = [table.partition("</table>")[0] for table in page.split("<table>")]
    assert [*TOPICS] in [re.findall(r'<a href="#(\w+)">', table) for table in tables]
