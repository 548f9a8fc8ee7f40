"""The report on the studio: what the browser's tests measure, held against its bars."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from validation.reporting import html
from validation.studies import studio
from validation.studies.studio import compose

LINES: list[dict[str, Any]] = [
    {"what": "session", "name": "a four-bar", "clicks": 12, "keys": 3, "most_clicks": 20, "most_keys": 4},
    {"what": "session", "name": "a four-bar", "clicks": 17, "keys": 1, "most_clicks": 20, "most_keys": 4},
    {"what": "session", "name": "the tour", "clicks": 9, "keys": 3, "most_clicks": 10, "most_keys": 4},
    {"what": "frames", "of": "chain60: drag", "median_ms": 16.7, "most_ms": 17.0},
    {"what": "edits", "model": "chain60", "count": 10, "median_ms": 180.0, "most_ms": 240.0, "answered_ms": 150.0},
    {"what": "first", "diagram_s": 1.2, "picture_s": 2.3},
    {"what": "axe", "findings": []},
    {"what": "axe", "findings": []},
]
SIZES = [{"what": "replay", "bytes": 900_000, "sent": 300_000, "is_file": True, "most": 1_000_000}]


def data(**changed: Any) -> dict[str, Any]:
    found = {**studio.gathered(copy.deepcopy(LINES)), "failed": [], "sizes": copy.deepcopy(SIZES), "load": 1.0}
    return found | changed


def test_the_dearer_of_two_records_of_a_session_counts() -> None:
    found = data()
    assert {row["name"]: row["clicks"] for row in found["sessions"]} == {"a four-bar": 17, "the tour": 9}
    assert found["axe"] == {"looks": 2, "findings": []}


def test_findings_within_the_bars_are_good_and_shown() -> None:
    report = compose(data())
    assert report.ok and report.missed == ()
    values = {fact.label: fact.value for fact in report.facts}
    assert values["frames while a block of 60 is dragged"] == "60 a second"
    assert values["an edit of 60 bodies, 95 % within 240 ms"] == "180 ms"
    assert {"Sessions", "Times", "Sizes"} == {section.title for section in report.sections}


@pytest.mark.parametrize(
    ("what", "change"),
    [
        ("2 sessions", lambda found: found["sessions"][0].update(clicks=21)),
        ("keys", lambda found: found["sessions"][1].update(keys=5)),
        ("1.10 MB", lambda found: found["sizes"][0].update(bytes=1_100_000)),
        ("1 findings of axe", lambda found: found["axe"].update(findings=["color-contrast: a button"])),
        ("fails", lambda found: found["failed"].append("test_sessions.py::test_the_tour")),
    ],
)
def test_misses_of_the_bar_are_stated(what: str, change: Any) -> None:
    found = data()
    change(found)
    report = compose(found)
    assert report.ok is False and report.verdict == ("wrong" if found["failed"] else "missed")
    if what not in ("fails", "keys", "2 sessions"):
        assert any(what in line for line in report.missed)


def test_sizes_are_of_what_is_loaded_and_sent() -> None:
    rows = studio.sizes()
    assert [row["is_file"] for row in rows] == [False, True]
    assert all(0 < row["sent"] < row["bytes"] < 5_000_000 for row in rows)


def test_the_page_has_a_bar_for_each_session() -> None:
    page = html.page(compose(data()))
    assert "Clicks of sessions" in page and page.count("a four-bar") >= 2
