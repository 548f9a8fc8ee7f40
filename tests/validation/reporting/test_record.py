"""One record, three renderings: nothing is lost, nothing breaks out of its place."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

from validation.reporting import html, markdown
from validation.reporting.command import Run
from validation.reporting.figures import Chart, Curve, Figure, Mark
from validation.reporting.findings import Finding
from validation.reporting.numbers import counted
from validation.reporting.plain import plain, restored
from validation.reporting.provenance import Provenance
from validation.reporting.questions import findings_fold
from validation.reporting.record import Bullets, Cell, Fact, Report, Section, Table, Text, Topic, verdict

LIMIT = Mark("limit", 2.0, "x")
CHART = Chart("t < u", "x  [m]", "y  [s]", (Curve("a", np.array([1.0, np.nan]), np.ones(2), 3),), (LIMIT,))
FINDINGS = (Finding("gap [m]", 2.0, 1.0, reason="asked"), Finding("rate", 1.0, np.inf, 0.5))
SECTION = Section(
    "How | wide?",
    (
        "It is `so`, see [there](#other).",
        Text("Beware.", "bad"),
        Bullets(("one", "two")),
        Table(("who|what", "n"), (("a|b", Cell(verdict(3, False), hint="h")),)),
        Figure("Look.", (CHART,)),
        findings_fold(FINDINGS, "number"),
        Section("Only there", ("hidden",), page_only=True),
    ),
    "how",
    False,
)
REPORT = Report("Title", "1 of 2 missed.", False, ("First.",), (SECTION, Section("Other", ("Last.",), "other")))
NOWHERE = Provenance.of({"date": "2026-11-22", "versions": {"numpy": "2"}})


def test_a_page_shows_everything() -> None:
    page = html.page(REPORT, NOWHERE, "Written by `x`.")
    for text in ("Title", "1 of 2 missed.", "First.", "<code>so</code>", '<a href="#other">there</a>', "Figure 1.1."):
        assert text in page, text
    assert "t &lt; u" in page and "limit: 2" in page and "hidden" in page and "2026-11-22" in page
    assert "details open" in page, "what misses its bounds is not folded away"
    assert 'class="n wrong"' in page and page.count("<b class=bad>missed</b>") == 1


def test_markdown_shows_everything_but_figures() -> None:
    text = markdown.page(REPORT, NOWHERE, "Written by `x`.")
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert "| a\\|b | **missed** 3 |" in rows and "| gap [m] | **missed** 2 |  | 1 | asked |" in rows
    assert "## How | wide?" in text and "Only there" not in text and "svg" not in text and "numpy 2" in text


def test_a_run_stamps_its_data_where_that_does_not_say_otherwise() -> None:
    topic = Topic("t", "g", "q?", lambda data: REPORT)
    data = Run(topic).stamped({"seconds": 3.0})
    assert data["seconds"] == 3.0 and "numpy" in data["versions"] and data["machine"]["processor"] and data["date"]


@pytest.mark.parametrize("text", ["<script>", "[x](javascript:alert)", '[x](#"onclick="y)', "`<b>`", "**<i>**"])
def test_texts_can_not_break_the_page(text: str) -> None:
    shown = html.prose(text)
    assert not re.search(r"<(script|i)>|javascript:alert\"|onclick=\"y\">", shown)


def test_a_chart_survives_its_json() -> None:
    again = restored(Chart, json.loads(json.dumps(plain(CHART), allow_nan=False)))
    assert (again.title, again.marks) == (CHART.title, (LIMIT,))
    assert again.curves[0].color == 3 and np.isnan(again.curves[0].x[1])


def test_a_finding_survives_its_json() -> None:
    assert restored(tuple[Finding, ...], plain(FINDINGS)) == FINDINGS
    lost = restored(Finding, plain(Finding("x", np.nan, 1.0)))
    assert np.isnan(lost.value) and not lost.ok


def test_what_readers_decide_by_and_what_is_missed_come_first() -> None:
    report = Report("T", "s", False, ("Text.",), decisions=("Take this.",), facts=(Fact("1", "bound", False),))
    for text in (html.page(report), markdown.page(report, NOWHERE, "")):
        assert text.index("Take this.") < text.index("1 bound") < text.index("Text.")


@pytest.mark.parametrize(("columns", "cue"), [(2, ""), (9, "phone"), (40, "wide")])
def test_a_table_wider_than_the_page_says_so(columns: int, cue: str) -> None:
    drawn = html.table(Table(("n",) * columns, (("1.0e-10",) * columns,)))
    assert re.findall('class="cue ([a-z]*)"', drawn) == ([cue] if cue else [])


@pytest.mark.parametrize(
    ("number", "says"), [(0, "0 runs"), (1, "1 run"), (9999, "9999 runs"), (1234567, "1 234 567 runs")]
)
def test_numbers_are_read_with_ease(number: int, says: str) -> None:
    assert counted(number, "run") == says


@pytest.mark.parametrize("row", ["a |  | |x| b | ", ("a", "", "|x| b", "")])
def test_a_row_is_a_line_of_markdown_or_its_cells(row: str | tuple[str, ...]) -> None:
    assert Table.of("who | \n what | where | n", [row]) == Table(
        ("who", "what", "where", "n"), (("a", "", "|x| b", ""),)
    )


@pytest.mark.parametrize(
    "text",
    [
        "3",
        "-1.5e-12",
        "12, 40",
        "10 000",
        "+50.0%",
        "3 ms",
        "1.2×",
        "**7**",
        "7 of 9",
        "< 0.1 % (floor)",
        "2026-11-22 17:48",
        "-",
        "NaN",
    ],
)
def test_columns_of_numbers_are_set_as_such(text: str) -> None:
    assert Table.of("n | who", [f"{verdict(text, False)} | a", "2 | 3"]).numeric == [True, False]


def test_a_row_that_misses_a_cell_is_refused() -> None:
    with pytest.raises(ValueError, match="a row of 1 cells"):
        Table.of("who | what", ["a | b", "a"])


@pytest.mark.parametrize("text", ["7 joints", "planar 2R", "x1", "[3](#a)", "2026-11-22 4f984ee5"])
def test_columns_of_words_are_no_numbers(text: str) -> None:
    assert Table.of("who", [[text], ["3"]]).numeric == [False]


def test_a_section_without_content_is_left_out() -> None:
    folded = Section("All", (Bullets(()),))
    empty = Section("Finds", ("These were found:", Table.of("finds", ()), Figure("", ()), folded))
    report = Report("T", "s", True, (), (empty, Section("Words", ("alone.",)), SECTION))
    assert [one.title for one in report.sections] == ["Words", "How | wide?"] and report.first_chart == (CHART,)
    assert "Finds" not in html.page(report) + markdown.page(report, NOWHERE, "")


def test_a_column_in_which_nothing_is_stated_is_left_out() -> None:
    table = Table(("model", "a", "b"), (("x", "-", "1"), ("y", "", "-")))
    assert table.without_empty() == Table(("model", "b"), (("x", "1"), ("y", "-")))


def test_a_page_has_the_name_of_a_group_above_its_rows() -> None:
    table = Table.of(
        "scene | error | method", ("beam | 1 % | rk4", " | 0.1 % | dopri5", "robot | 1 % | rk4"), grouped=True
    )
    page = html.table(table)
    rows = re.findall(r"<tr.*?</tr>", page)
    assert len(rows) == 6 and all(row.count("<td") == 2 for row in rows if 'class="group"' not in row and "<td" in row)
    assert 'colspan="2"><div>beam</div>' in rows[1] and "dopri5" in rows[3] and "robot" in rows[4]
    assert "| beam | 1 % | rk4 |" in markdown.table(table)
